#!/bin/sh
# Plants the faults of faults.txt one at a time in a copy of the tree and looks which test fails.
#
#     tests/mutants/mutants.sh [--jobs N] [--shard I/N] [WORD...]
#     tests/mutants/mutants.sh --check                only whether each still fits the sources
#
# With words: the faults whose names contain one of them; else all. --shard 2/3: of these the
# second, fifth, eighth and so on, for runs on several machines. --jobs: how many at a time (by
# default as many as there are processors), each in a copy of its own of a tree that is built once.
#
# A fault is killed if a test program that `make test` runs fails, crashes or hangs with it: then
# `make test` fails as well, and so it is not run to its end. The tests that faults.txt names come
# first, then all others, one function at a time, quick programs first; scripts are not run.
# lib/ is compiled with -Og instead of -O3, which changes no answer, and each change compiles only
# what depends on it; after a fault, what it changed is copied back, so nothing is compiled twice.
# Kernels take the longest to compile. So the tests that are named run first with a library in which
# the kernels of this machine's best instruction set stand for those of all; what they do not notice
# there is planted in a whole one. A test that fails has to pass without the fault, in a library of
# the same kind.
#
# A fault that needs instructions which this machine does not have is not planted, and is counted in
# a line of its own: such a run is not whole.
#
# Prints a line for each fault when its fate is known, and as the last line "killed N, survived M".
# Exit status 1 if any survived, does not fit or does not compile, or if a test fails without it as
# well. CC and MAKE are taken from the environment.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
top=$(cd "$here/../.." && pwd)
faults=$here/faults.txt
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
shard=1/1
while [ $# -gt 0 ]; do
    case $1 in
    --check) exec awk -f "$here/plant.awk" -v root="$top" "$faults" ;;
    --jobs) jobs=${2:?} && shift ;;
    --shard) shard=${2:?} && shift ;;
    --*) echo "mutants.sh: unknown option $1" >&2 && exit 2 ;;
    *) break ;;
    esac
    shift
done

scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
trap 'kill $(jobs -p) 2>/dev/null; exit 1' HUP INT TERM
whole=$scratch/whole # a tree without faults
brief=$scratch/brief # the same, with the kernels of one instruction set
tests=build/release/tests
unset MAKEFLAGS MFLAGS MAKELEVEL

# make_in TREE JOBS TARGET...
make_in() (
    tree=$1 threads=$2
    shift 2
    exec "${MAKE:-make}" -s -C "$tree" -j"$threads" CC="${CC:-cc}" config=release BUILD=build WERROR=0 \
        mode='-Og -w -DNDEBUG' test_mode='-O1 -w' "$@" >"$tree.make.log" 2>&1
)

# run_test TREE PROGRAM NAME: one test function, to the first check that fails; it may take two
# minutes of a processor and 8 GB.
run_test() {
    ( # not exec: so that this shell, whose output goes to the log, is the one to speak of crashes
        ulimit -c 0
        ulimit -t 120
        ulimit -v 8000000 2>/dev/null
        cd "$1" || exit 1
        SC_LIB=build/lib "$tests/$2" --first "$3"
        exit $?
    ) >"$1.test.log" 2>&1
}

# Which function of a program failed, or that it could not say.
reason() {
    failing=$(sed -n 's/^FAILED \([a-z0-9_]*\):.*/\1/p' "$1.test.log" | head -n 1)
    echo "$2: ${failing:-crashed}"
}

# Quick programs first; new ones last. Not how much stack calls take, which is more than promised
# where nothing is optimised.
order_programs() {
    quick="predicates primitives input structures memory oracle ccd metis contours"
    for program in $quick; do
        [ -f "$whole/tests/test_$program.c" ] && echo "test_$program"
    done
    for source in "$whole"/tests/test_*.c; do
        program=$(basename "$source" .c)
        case " $quick culling pairs stack " in
        *" ${program#test_} "*) ;;
        *) echo "$program" ;;
        esac
    done
    echo test_culling
    echo test_pairs
}

# passes PRISTINE PROGRAM NAME: whether a test passes without any fault. Each is run once.
passes() {
    known=$scratch/passed/$(basename "$1"):$2:$3
    [ -f "$known" ] && return 0
    run_test "$1" "$2" "$3" && touch "$known"
}

# try PRISTINE PROGRAM [NAME]: builds and runs one test function in $tree, or each by itself; 0 if
# one failed, with the reason in $killer. If there is no such program or test, or the fault does not
# compile, $killer is empty.
try() {
    killer=
    make_in "$tree" 1 "$tests/$2" || return 0
    for one in ${3:-$("$tree/$tests/$2" --list)}; do
        run_test "$tree" "$2" "$one" && continue
        if grep -q ': no such test$' "$tree.test.log"; then
            echo "$2: no test $3" >"$tree.make.log"
        elif ! passes "$1" "$2" "$one"; then
            echo "$2: $one fails without any fault" >"$tree.make.log"
        else
            killer=$(reason "$tree" "$2")
        fi
        return 0
    done
    return 1
}

# plant TREE NAME
plant() {
    awk -f "$here/plant.awk" -v name="$2" -v root="$1" "$faults" >/dev/null
}

# hunt TREE HINTS: the tests to try first, then all functions of all programs. 0 if one failed.
hunt() {
    tree=$1.brief
    for hint in $2; do
        try "$brief" "${hint%%:*}" "${hint#*:}" && return 0
    done
    tree=$1
    killer=
    make_in "$tree" 1 all || return 0
    for hint in $2; do
        try "$whole" "${hint%%:*}" "${hint#*:}" && return 0
    done
    for program in $(order_programs); do
        try "$whole" "$program" && return 0
    done
    return 1
}

# restore PRISTINE TREE: makes it again what PRISTINE is, modification times included.
restore() {
    find "$2" -type f -newer "$2.marker" >"$2.changed"
    while read -r file; do
        if [ -f "$1/${file#"$2"/}" ]; then
            cp -p "$1/${file#"$2"/}" "$file"
        else
            rm -f "$file"
        fi
    done <"$2.changed"
}

# one_fault TREE NAME HINTS: prints its line and leaves its fate in a file of its name.
one_fault() {
    begin=$(date +%s)
    fate=broken
    needed=
    hints=$3
    case $hints in
    needs:*) needed=${hints%% *} hints=${hints#"$needed"} needed=${needed#needs:} ;;
    esac
    if ! plant "$1" "$2"; then
        result="DOES NOT FIT"
    elif [ -n "$needed" ] && [ "$needed" != "$best" ]; then
        result="cannot be seen without $needed"
        fate=unseen
    elif plant "$1.brief" "$2" && hunt "$1" "$hints" </dev/null; then
        result=$killer
        if [ -z "$result" ]; then
            result="DOES NOT COMPILE OR IS NOT TESTED"
            sed 's/^/    /' "$tree.make.log" | head -n 20
        else
            fate=killed
        fi
    else
        result=SURVIVED
        fate=survived
    fi
    printf '%-28s %-50s %4d s\n' "$2" "$result" $(($(date +%s) - begin))
    echo "$fate" >"$scratch/fates/$2"
    restore "$whole" "$1"
    restore "$brief" "$1.brief"
}

# worker TREE: takes the next fault that nobody has taken, until none is left.
worker() {
    cp -Rp "$whole" "$1" && cp -Rp "$brief" "$1.brief" || exit 1
    touch "$1.marker" "$1.brief.marker"
    sleep 1
    while read -r name hints; do
        mkdir "$scratch/taken/$name" 2>/dev/null || continue
        one_fault "$1" "$name" "$hints"
    done <"$scratch/list"
}

# one_set TREE: makes the kernels of this machine's best instruction set stand for those of all.
one_set() {
    echo '#include <stdio.h>
        #include "simd/isa.h"
        int main(void) { return SC_ISA_X86 ? !printf("%d", (int)sc_isa_best()) : 0; }' |
        "${CC:-cc}" -I"$1/lib" -x c -o "$1.best" - || exit 1
    case $("$1.best") in
    1) best=base others='avx2 avx512' ;;
    2) best=avx2 others='base avx512' ;;
    3) best=avx512 others='base avx2' ;;
    *) best= && return ;;
    esac
    for set in $others; do
        echo 'typedef int sc_kernels_are_elsewhere;' >"$1/lib/simd/kernels_$set.c"
        echo "extern const sc_kernels sc_kernels_$set __attribute__((alias(\"sc_kernels_$best\")));"
    done >>"$1/lib/simd/kernels_$best.c"
}

# build_clean TREE: without any fault.
build_clean() {
    make_in "$1" "$jobs" all $(order_programs | sed "s|^|$tests/|") && return
    cat "$1.make.log"
    echo "does not build without any fault"
    exit 1
}

mkdir "$whole" "$scratch/fates" "$scratch/taken" "$scratch/passed" || exit 1
for entry in "$top"/*; do
    [ "$(basename "$entry")" = build ] || cp -Rp "$entry" "$whole/" || exit 1
done
mkdir -p "$whole/build"
[ -d "$top/build/meshes" ] && ln -s "$top/build/meshes" "$whole/build/meshes"

awk -f "$here/plant.awk" "$faults" >"$scratch/all" || exit 1
for word in "$@"; do echo "^[^ ]*$word"; done >"$scratch/words"
[ $# -gt 0 ] || echo . >"$scratch/words"
grep -f "$scratch/words" "$scratch/all" |
    awk -v part="${shard%/*}" -v of="${shard#*/}" '(NR - part) % of == 0' >"$scratch/list"

build_clean "$whole"
cp -Rp "$whole" "$brief" || exit 1
one_set "$brief"
build_clean "$brief"

i=0
while [ $i -lt "$jobs" ]; do
    i=$((i + 1))
    worker "$scratch/tree$i" &
done
wait

# how_many FATE
how_many() { cat "$scratch"/fates/* /dev/null | grep -c "^$1\$"; }
lost=$(($(wc -l <"$scratch/list") - $(how_many '.*')))
broken=$(($(how_many broken) + lost))
[ $broken -eq 0 ] || echo "$broken do not fit or do not compile"
[ "$(how_many unseen)" -eq 0 ] || echo "$(how_many unseen) cannot be seen on this machine"
echo "killed $(how_many killed), survived $(how_many survived)"
[ "$(how_many survived)" -eq 0 ] && [ $broken -eq 0 ]
