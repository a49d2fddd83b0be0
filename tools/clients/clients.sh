#!/bin/sh
# `make test-clients`: programs that people already use, with the library inside.
#
#     tools/clients/clients.sh LIBRARY BUILD     from the top of the repository
#
#     SC_QUERY   the program to compare with, if it is there
#     ADDON      the add-on for Blender
#
# Each comes from PyPI, into a virtual environment below BUILD; what cannot be had is said and counted
# as skipped. Last line: "N passed, N failed, N skipped".
#
# SPDX-License-Identifier: MIT
set -u

library=$1
build=$2
passed=0
failed=0
skipped=0

mkdir -p "$build/clients" || exit 2

# An absolute path.
absolute() {
    case $1 in
    /*) echo "$1" ;;
    *) echo "$PWD/$1" ;;
    esac
}

# Runs a test of a client in an environment that has a package: name, package, script, arguments.
client() {
    bench/peers/venv.sh "$build/clients/$1" "$2" "$build/clients/$1.skipped"
    case $? in
    0) ;;
    3)
        echo "skipped: $1: $2 cannot be had from PyPI"
        skipped=$((skipped + 1))
        return
        ;;
    *) exit 1 ;;
    esac
    if STARCONTOUR_LIBRARY=$(absolute "$library") PYTHONPATH="$PWD/tools/python" \
        "$build/clients/$1/bin/python" "$3" ${4+"$4" "$5"}; then
        echo "passed: $1"
        passed=$((passed + 1))
    else
        echo "failed: $1"
        failed=$((failed + 1))
    fi
}

client ipctk ipctk tools/clients/ipctk/test_client.py
if [ -x "${SC_QUERY-}" ]; then
    export VERSIONS=tools/clients/blender/requirements.txt
    client blender bpy tools/clients/blender/test_addon.py "$ADDON" "$SC_QUERY"
    unset VERSIONS
else
    echo "skipped: blender: there is no sc-query to compare with ('make deps')"
    skipped=$((skipped + 1))
fi

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
