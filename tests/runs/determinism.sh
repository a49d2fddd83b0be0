#!/bin/sh
# The same pairs from every compiler and optimisation, with and without SIMD (single instruction,
# multiple data) code. Run by `make test-determinism`.
#
#     tests/runs/determinism.sh DIRECTORY OBJECT...
#
# OBJECTs are tests/runs/determinism.c and what it needs, compiled once, so that all get the same
# input; the library is compiled anew each time, in DIRECTORY. SC_CC: the compilers. Prints a line
# for each build, and last "N passed, N failed, N skipped", where builds are counted; exit status 1
# if hashes differ or there was only one build.
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
passed=0
failed=0
skipped=0
first=
for compiler in ${SC_CC:-gcc clang}; do
    if ! command -v "$compiler" >/dev/null 2>&1; then
        echo "skipped: 8 builds by $compiler, which is not there"
        skipped=$((skipped + 8))
        continue
    fi
    for flags in -O0 -O1 -O2 -O3 '-O3 -march=native' '-O2 -DSC_NO_SIMD' '-O3 -DSC_NO_SIMD' \
        '-O3 -DSC_NO_SIMD -DSC_NO_VECTORS'; do
        # shellcheck disable=SC2086
        hash=$(one "$compiler" $flags) || hash="failed: $hash"
        echo "$compiler $flags: $hash"
        [ -n "$first" ] || first=${hash%% *}
        # without SIMD there are fewer queries
        if [ "${hash%% *}" = "$first" ] && [ "$first" != failed: ]; then
            passed=$((passed + 1))
        else
            failed=$((failed + 1))
        fi
    done
done
echo "determinism: $passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ] && [ "$passed" -ge 2 ]
