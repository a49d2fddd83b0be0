#!/bin/sh
# The same pairs from every compiler and optimisation, with and without SIMD (single instruction,
# multiple data) code. Run by `make test-determinism`.
#
#     tests/runs/determinism.sh DIRECTORY OBJECT...
#
# OBJECTs are tests/runs/determinism.c and what it needs, compiled once, so that all get the same input;
# the library is compiled anew each time, in DIRECTORY. SC_CC: the compilers. Prints a line for each
# build; exit status 1 if hashes differ or there was only one build.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

at=$1
shift
mkdir -p "$at" || exit 2
sources=$(sed -e 's/#.*//' lib/sources.list)

# one COMPILER FLAGS...: builds, runs and prints the hash.
one() {
    rm -rf "$at/build"
    mkdir "$at/build"
    for source in $sources; do
        "$@" -std=c99 -ffp-contract=off -Iinclude -Ilib -c "$source" \
            -o "$at/build/$(basename "$source" .c).o" || return 1
    done
    # shellcheck disable=SC2086
    "$1" $objects "$at"/build/*.o -lgmp -lm -o "$at/determinism" &&
        "$at/determinism" meshes/*.obj
}

objects=$*
builds=0
first=
bad=0
for compiler in ${SC_CC:-gcc clang}; do
    if ! command -v "$compiler" >/dev/null 2>&1; then
        echo "determinism: no $compiler here: left out"
        continue
    fi
    for flags in -O0 -O1 -O2 -O3 '-O3 -march=native' '-O2 -DSC_NO_SIMD' '-O3 -DSC_NO_SIMD' \
        '-O3 -DSC_NO_SIMD -DSC_NO_VECTORS'; do
        # shellcheck disable=SC2086
        hash=$(one "$compiler" $flags) || { bad=1 && hash="failed: $hash"; }
        echo "$compiler $flags: $hash"
        builds=$((builds + 1))
        [ -n "$first" ] || first=${hash%% *}
        [ "${hash%% *}" = "$first" ] || bad=1 # without SIMD there are fewer queries
    done
done
if [ "$bad" -ne 0 ] || [ "$builds" -lt 2 ]; then
    echo "determinism: $builds builds do not agree"
    exit 1
fi
echo "determinism: $builds builds, one hash"
