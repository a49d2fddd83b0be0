#!/bin/sh
# Built for Windows by mingw-w64: the static library, the DLL, the programs and tests that need
# neither assimp nor GMP nor POSIX. Under wine, where that is there, they run, and give the same
# pairs as here.
#
#     tests/packages/mingw.sh [PREFIX [FOLDER]]      x86_64-w64-mingw32, build/mingw
#
# Debian: gcc-mingw-w64-x86-64, wine64.
#
# SPDX-License-Identifier: MIT
. tests/script.sh
. tests/portable.sh
. tests/wine.sh
set +u
prefix=${1:-x86_64-w64-mingw32}
at=${2:-build/mingw}
set -u
cross=$prefix-gcc

if ! command -v "$cross" >/dev/null 2>&1; then
    skip "nothing was built for Windows: no $cross"
    finish
fi
unset MAKEFLAGS MFLAGS MAKELEVEL
mkdir -p "$at"

# cross_make FOLDER CPPFLAGS TARGET...; not warned of: mingw's isfinite converts, and its formats
# are not those of the printf that is asked for.
cross_make() {
    folder=$1
    flags=$2
    shift 2
    "$MAKE" --no-print-directory "-j$jobs" CC="$cross" AR="$prefix-ar" WERROR=1 config=release \
        BUILD="$folder" CPPFLAGS="$flags" CFLAGS='-Wno-float-conversion -Wno-format' LDFLAGS= "$@"
}
link() {
    program=$1
    shift
    "$cross" -std=c99 -ffp-contract=off -O2 -D__USE_MINGW_ANSI_STDIO=1 -Iinclude "$@" \
        -o "$at/$program.exe" -lm
}

# shellcheck disable=SC2086
skip "$(echo $portable_left_out): not built for Windows; they need GMP, libccd or POSIX, which are not there" \
    "$(echo "$portable_left_out" | wc -l)"
# objects SOURCE...: theirs, as make names them
objects() {
    for file; do echo "$at/release/obj/${file%.c}.o"; done
}

static=$at/lib/libstarcontour.a
# shellcheck disable=SC2046,SC2086
{
    check "static library, make-meshes, objects of tests" cross_make "$at" -D__USE_MINGW_ANSI_STDIO=1 \
        "$static" "$at/lib/libstarcontour_metis.a" "$at/bin/make-meshes" \
        $(objects $portable_support $(printf 'tests/test_%s.c ' $portable_tests))
    [ "$checks_failed" -eq 0 ] || finish
    rm -f "$at/support.a"
    check "what tests share" "$prefix-ar" rcs "$at/support.a" $(objects $portable_support)
    for test in $portable_tests; do
        check "test_$test links" link "test_$test" $(objects "tests/test_$test.c") "$at/support.a" \
            "$at/lib/libstarcontour_metis.a" "$static"
    done
}
same_input="-include tests/packages/same_math.h -Ilib -Itests $portable_determinism"
# shellcheck disable=SC2086
check "determinism links" link determinism $same_input "$static"
check "a user of the static library links" link consumer tests/packages/consumer.c "$static"

# The DLL exports what the shared library here exports.
dll() {
    cross_make "$at/dll" '-DSC_SHARED -DSC_BUILDING' "$at/dll/lib/libstarcontour.a" &&
        "$cross" -shared -o "$at/starcontour.dll" \
            -Wl,--whole-archive "$at/dll/lib/libstarcontour.a" -Wl,--no-whole-archive \
            -Wl,--out-implib,"$at/libstarcontour.dll.a" -lm
}
check "the DLL" dll
exports() {
    "$prefix-objdump" -p "$at/starcontour.dll" | sed -n '/^\[Ordinal\/Name Pointer\]/,/^$/p' |
        sed -n 's/^.*[] ]\(sc_[a-z0-9_]*\)$/\1/p' | sort | diff tests/abi/symbols.txt -
}
check "exports what it should" exports
check "a program of version 0.1 links with it" link old_caller -DSC_SHARED -Itests/abi -Itests \
    tests/abi/old_caller.c tests/harness.c "$at/libstarcontour.dll.a"
imports() {
    "$prefix-objdump" -p "$at/old_caller.exe" | grep 'DLL Name: starcontour.dll'
}
check "imports it" imports
alone() {
    ! "$prefix-objdump" -p "$at/starcontour.dll" | sed -n 's/.*DLL Name: //p' |
        grep -vi '^kernel32\.dll$\|^msvcrt\.dll$\|^ucrtbase\.dll$\|^api-ms-win-crt-'
}
check "the DLL needs none but those of Windows" alone

amalgamated() {
    "$MAKE" --no-print-directory amalgamation BUILD="$at" &&
        "$cross" -std=c99 -ffp-contract=off -O1 -Wall -Wextra -Werror -c "$at/amalgamation/starcontour.c" \
            -o "$at/amalgamation/starcontour.o" &&
        link amalgamated tests/packages/consumer.c "$at/amalgamation/starcontour.o"
}
check "the amalgamation" amalgamated

# ------------------------------------------------------------------------------------------------
# Running

start_wine "for Windows"
portable_tests_pass
check "a program of version 0.1 runs with the DLL" windows old_caller
# here PROGRAM SOURCE...: the same, compiled for this system.
here() {
    program=$1
    shift
    # shellcheck disable=SC2046
    $CC -std=c99 -O1 -ffp-contract=off -Iinclude -Ilib "$@" $(grep '^lib/' lib/sources.list) -lm \
        -o "$scratch/$program"
}
same_pairs() {
    here consumer tests/packages/consumer.c && "$scratch/consumer" >"$scratch/pairs" &&
        grep -q '^wound: [1-9]' "$scratch/pairs" || return 1
    for program in consumer amalgamated; do
        windows $program | plain | cmp - "$scratch/pairs" || return 1
    done
}
check "the same pairs as here" same_pairs
same_hash() {
    # shellcheck disable=SC2086
    here determinism $same_input && "$scratch/determinism" meshes/*.obj >"$scratch/hash" &&
        grep ' pairs$' "$scratch/hash" && windows determinism meshes/*.obj | plain | diff "$scratch/hash" -
}
check "the same pairs as here, by all methods, of meshes in many poses" same_hash
same_meshes() {
    mkdir "$scratch/made" && "$wine" "$at/bin/make-meshes.exe" "$scratch/made" 2>/dev/null || return 1
    for mesh in meshes/*.obj; do
        plain <"$scratch/made/$(basename "$mesh")" | cmp - "$mesh" || return 1
    done
}
check "make-meshes writes the same meshes" same_meshes
finish
