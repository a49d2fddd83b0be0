#!/bin/sh
# Plants the faults of faults.txt one at a time in a copy of the tree and looks which test fails.
#
#     tests/mutants/mutants.sh [WORD...]      all, or those whose names contain a word
#     tests/mutants/mutants.sh --check        only whether each still fits the sources
#
# A fault is killed if a test program that `make test` runs fails, crashes or hangs with it: then
# `make test` fails as well, and so it is not run to its end. The tests that faults.txt names come
# first, then all others, one function at a time, quick programs first; scripts are not run.
# Everything is compiled with -O1 instead of -O3, which changes no answer, and each change compiles only
# what depends on it.
#
# Prints a table, and as the last line "killed N, survived M". Exit status 1 if any survived, does not
# fit or does not compile, or if a test fails without any fault. Some 20 seconds a fault: hours for all.
# CC and MAKE are taken from the environment.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
top=$(cd "$here/../.." && pwd)
faults=$here/faults.txt
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM
tree=$scratch/tree
tests=$tree/build/release/tests

make_in_copy() {
    "${MAKE:-make}" -s -C "$tree" -j"$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)" \
        CC="${CC:-cc}" CFLAGS=-O1 config=release BUILD=build WERROR=0 "$@" >"$scratch/make.log" 2>&1
}

# run_test PROGRAM [NAME]: one test function, or all; it may take five minutes and 8 GB.
run_test() {
    ( # not exec: so that this shell, whose output goes to the log, is the one to speak of crashes
        ulimit -c 0
        ulimit -t 300
        ulimit -v 8000000 2>/dev/null
        cd "$tree" || exit 1
        SC_LIB=build/lib "build/release/tests/$1" ${2:+"$2"}
        exit $?
    ) >"$scratch/test.log" 2>&1
}

# Which function of a program failed, or that it could not say.
reason() {
    failing=$(sed -n 's/^FAILED \([a-z0-9_]*\):.*/\1/p' "$scratch/test.log" | head -n 1)
    echo "$1: ${failing:-crashed}"
}

# Quick programs first; new ones last.
order_programs() {
    for program in predicates primitives input structures memory oracle ccd metis contours; do
        [ -f "$tree/tests/test_$program.c" ] && echo "test_$program"
    done
    for source in "$tree"/tests/test_*.c; do
        program=$(basename "$source" .c)
        case $program in
        test_predicates | test_primitives | test_input | test_structures | test_memory | test_oracle) ;;
        test_ccd | test_metis | test_contours | test_culling | test_pairs) ;;
        *) echo "$program" ;;
        esac
    done
    echo test_culling
    echo test_pairs
}

# try PROGRAM NAME: builds and runs; 0 if the test failed, with the reason in $killer. If there is no
# such program or test, or the fault does not compile, $killer is empty.
try() {
    killer=
    make_in_copy "build/release/tests/$1" || return 0
    run_test "$@" && return 1
    if grep -q ': no such test$' "$scratch/test.log"; then
        echo "$1: no test $2" >"$scratch/make.log"
    else
        killer=$(reason "$1")
    fi
    return 0
}

# The tests to try first, then all functions of all programs. 0 if one failed.
hunt() {
    for hint in $1; do
        try "${hint%%:*}" "${hint#*:}" && return 0
    done
    for program in $(order_programs); do
        if ! make_in_copy all "build/release/tests/$program"; then
            killer=
            return 0
        fi
        for one in $("$tests/$program" --list); do
            if ! run_test "$program" "$one"; then
                killer=$(reason "$program")
                return 0
            fi
        done
    done
    return 1
}

mkdir "$tree" || exit 1
for entry in "$top"/*; do
    [ "$(basename "$entry")" = build ] || cp -R "$entry" "$tree/" || exit 1
done
mkdir -p "$tree/build"
[ -d "$top/build/meshes" ] && ln -s "$top/build/meshes" "$tree/build/meshes"
cp -R "$top/lib" "$scratch/lib"
unset MAKEFLAGS MFLAGS MAKELEVEL

check=0
if [ "${1:-}" = --check ]; then
    check=1
    shift
fi
awk -f "$here/plant.awk" "$faults" >"$scratch/all" || exit 1
if [ $# -eq 0 ]; then
    cp "$scratch/all" "$scratch/list"
else
    for word in "$@"; do echo "^[^ ]*$word"; done >"$scratch/words"
    grep -f "$scratch/words" "$scratch/all" >"$scratch/list"
fi

if [ $check -eq 0 ] && [ $# -eq 0 ]; then
    if ! make_in_copy all $(order_programs | sed 's|^|build/release/tests/|'); then
        cat "$scratch/make.log"
        echo "does not build without any fault"
        exit 1
    fi
    for program in $(order_programs); do
        run_test "$program" && continue
        cat "$scratch/test.log"
        echo "$program fails without any fault"
        exit 1
    done
fi

killed=0
survived=0
broken=0
while read -r name hints; do
    begin=$(date +%s)
    if ! changed=$(awk -f "$here/plant.awk" -v name="$name" -v root="$tree" "$faults"); then
        result="DOES NOT FIT"
        broken=$((broken + 1))
        changed=
    elif [ $check -eq 1 ]; then
        result=fits
    elif hunt "$hints" </dev/null; then
        result=$killer
        if [ -z "$result" ]; then
            result="DOES NOT COMPILE OR HAS NO SUCH TEST"
            broken=$((broken + 1))
            sed 's/^/    /' "$scratch/make.log" | head -n 20
        else
            killed=$((killed + 1))
        fi
    else
        result=SURVIVED
        survived=$((survived + 1))
    fi
    printf '%-28s %-50s %4d s\n' "$name" "$result" $(($(date +%s) - begin))
    for file in $changed; do cp "$scratch/$file" "$tree/$file"; done
done <"$scratch/list"

[ $broken -eq 0 ] || echo "$broken do not fit or do not compile"
[ $check -eq 0 ] && echo "killed $killed, survived $survived"
[ $survived -eq 0 ] && [ $broken -eq 0 ]
