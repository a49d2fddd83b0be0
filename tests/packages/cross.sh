#!/bin/sh
# Built for other processors by Debian's cross compilers, and run by QEMU's emulators where they are
# there: 64-bit ARM (NEON, by the compiler's vector types), 32-bit ARM, and s390x, where numbers
# have their bytes the other way round. The same pairs as here, and tests that need neither GMP nor
# libccd.
#
#     tests/packages/cross.sh [MACHINE...]     aarch64-linux-gnu arm-linux-gnueabihf s390x-linux-gnu
#
# Debian: gcc-aarch64-linux-gnu, gcc-arm-linux-gnueabihf, gcc-s390x-linux-gnu, qemu-user. A machine
# takes some minutes.
#
# SPDX-License-Identifier: MIT
machines=${*:-aarch64-linux-gnu arm-linux-gnueabihf s390x-linux-gnu}
. tests/script.sh
. tests/portable.sh

flags='-std=c99 -D_POSIX_C_SOURCE=200809L -O2 -ffp-contract=off -Iinclude -Ilib -Itests'
core="$(grep '^lib/' lib/sources.list) lib/build/partition_metis.c"
same_input="-include tests/packages/same_math.h $portable_determinism"

# compile COMPILER FOLDER SOURCE...: their objects, as many at a time as there are processors.
compile() {
    compiler=$1
    folder=$2
    shift 2
    mkdir -p "$folder" || return 1
    for source; do
        echo "$source" "$folder/$(echo "$source" | tr / _).o"
    done | xargs -n 2 -P "$jobs" sh -c "$compiler $flags -Werror -Wall -Wextra -c"' "$0" -o "$1"'
}
# library COMPILER FOLDER; support COMPILER FOLDER ARCHIVER: what tests share, as an archive
library() {
    # shellcheck disable=SC2086
    compile "$1" "$2" $core
}
support() {
    # shellcheck disable=SC2086
    compile "$1" "$2/support" $portable_support && "$3" rcs "$2/support.a" "$2"/support/*.o
}
# link COMPILER FOLDER PROGRAM SOURCE...
link() {
    compiler=$1
    folder=$2
    program=$3
    shift 3
    # shellcheck disable=SC2086
    $compiler $flags "$@" "$folder"/*.o -o "$folder/$program" -lm
}

check "the library here" library "$CC" "$scratch/here"
# shellcheck disable=SC2086
check "determinism here" link "$CC" "$scratch/here" determinism $same_input
# Elsewhere there is one set of instructions, and so fewer queries.
hash() {
    "$@" meshes/*.obj | sed 's/ .*//'
}
expected=$(hash "$scratch/here/determinism")
check "a hash of pairs" test -n "$expected"

same_hash() {
    [ "$(hash "$emulator" "$at/determinism")" = "$expected" ]
}
# Runs all tests, as many at a time as there are processors.
run_tests() {
    # shellcheck disable=SC2086
    printf '%s\n' $portable_tests | xargs -n 1 -P "$jobs" sh -c \
        '"$0" "$1/test_$2" --scale 20 >"$1/$2.log" 2>&1 && touch "$1/$2.passed"; true' \
        "$emulator" "$at"
}
has_passed() {
    cat "$at/$1.log"
    [ -e "$at/$1.passed" ]
}
for machine in $machines; do
    cross=$machine-gcc
    emulator=qemu-${machine%%-*}
    at=$scratch/$machine
    if ! command -v "$cross" >/dev/null 2>&1; then
        skip "nothing was built for $machine: no $cross"
        continue
    fi
    check "$machine: the library" library "$cross" "$at"
    # shellcheck disable=SC2086
    check "$machine: determinism links" link "$cross -static" "$at" determinism $same_input
    check "$machine: what tests share" support "$cross" "$at" "$machine-ar"
    # shellcheck disable=SC2046
    check "$machine: tests compile" compile "$cross" "$at/tests" \
        $(for test in $portable_tests; do echo "tests/test_$test.c"; done)
    for test in $portable_tests; do
        check "$machine: test_$test links" link "$cross -static" "$at" "test_$test" \
            "$at/tests/tests_test_$test.c.o" "$at/support.a"
    done
    if ! command -v "$emulator" >/dev/null 2>&1; then
        skip "nothing built for $machine was run: no $emulator"
        continue
    fi
    check "$machine: the same pairs as here, by all methods, of meshes in many poses" same_hash
    run_tests
    for test in $portable_tests; do
        check "$machine: test_$test passes" has_passed "$test"
    done
done
finish
