#!/bin/sh
# `make test-clients`: programs that people already use, with the library inside.
#
#     tools/clients/clients.sh LIBRARY BUILD     from the top of the repository
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

# Runs a test of a client in an environment that has some packages: name, packages, script.
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
        "$build/clients/$1/bin/python" "$3"; then
        echo "passed: $1"
        passed=$((passed + 1))
    else
        echo "failed: $1"
        failed=$((failed + 1))
    fi
}

client ipctk ipctk tools/clients/ipctk/test_client.py

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
