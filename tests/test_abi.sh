#!/bin/sh
# The binary interface: it is what was committed (tests/abi/*.txt), a program compiled for an
# earlier version runs with this library, and what compares a release with the next sees what it has
# to see.
#
# After a change that is meant: `make abi-update`, and review the diff.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

shared=$SC_LIB/libstarcontour.so
if [ ! -e "$shared" ]; then
    skip "no $shared, and other formats than ELF are not read"
    check "goldens are there" test -s tests/abi/interface_64.txt
    finish
fi

# ------------------------------------------------------------------------------------------------
# Goldens

mkdir "$scratch/now"
check "the interface can be listed" tests/abi/goldens.sh "$scratch/now" "$shared"
for golden in symbols.txt interface_64.txt interface_32.txt; do
    if [ -e "$scratch/now/$golden" ]; then
        check "$golden (if the change is meant: make abi-update)" \
            diff "tests/abi/$golden" "$scratch/now/$golden"
    else
        skip "$golden: $CC does not compile for it (-m32 takes Debian's gcc-multilib)"
    fi
done
constants() {
    tail -n +2 "$1" | grep ' = '
}
same_constants() {
    constants tests/abi/interface_32.txt >"$scratch/constants" &&
        constants tests/abi/interface_64.txt | diff - "$scratch/constants"
}
check "enumerators are the same for 32 and 64 bits" same_constants

# Every function of the core's header is exported, and nothing else.
declared() {
    sed -n 's/^[a-z].*[ *]\(sc_[a-z_0-9]*\)(.*)$/\1/p' "$scratch"/now/interface_??.txt |
        grep -v -x sc_metis_bisect | sort -u | diff - "$scratch/now/symbols.txt"
}
check "what the header declares is what is exported" declared

# ------------------------------------------------------------------------------------------------
# A program of version 0.1

old_caller() {
    # shellcheck disable=SC2086
    $CC -std=c99 -Itests/abi -Itests tests/abi/old_caller.c tests/harness.c "$1/libstarcontour.so" \
        -o "$scratch/old_caller" $2 && LD_LIBRARY_PATH=$1 "$scratch/old_caller"
}
check "a program of version 0.1 runs" old_caller "$SC_LIB" "$SC_FLAGS"

# ------------------------------------------------------------------------------------------------
# Changes, planted in copies of the library

# library NAME SONAME EDIT: a copy of the library whose header EDIT (for sed) has changed, and which
# has a further function.
library() {
    mkdir "$scratch/$1" && cp -R include lib "$scratch/$1" &&
        sed -e "$3" -e 's/^SC_API uint32_t sc_version(void);/&\
SC_API uint32_t sc_added(void);/' include/starcontour.h >"$scratch/$1/include/starcontour.h" || return 1
    (
        cd "$scratch/$1" || exit 1
        echo 'uint32_t sc_added(void) { return 1; }' >>lib/starcontour.c
        # shellcheck disable=SC2046
        $CC -std=c99 -O0 -g -ffp-contract=off -fPIC -fvisibility=hidden -Iinclude -Ilib -shared \
            -Wl,-soname,"$2" $(grep '^lib/' lib/sources.list) -o "$2" -lm &&
            ln -s "$2" libstarcontour.so
    )
}
# compare NAME: would programs linked with the library as it is run with that copy?
compare() {
    tests/abi/compare.sh "$scratch/$1/libstarcontour.so" "$scratch/$1/include" "$shared" include
}
breaks() {
    compare "$1" >"$scratch/compared" 2>&1
    status=$?
    cat "$scratch/compared"
    [ $status -eq 1 ] && grep -q "$2" "$scratch/compared"
}

if [ "$SC_CONFIG" != release ]; then
    skip "planted changes: once is enough, with config=release"
    finish
fi
command -v abidiff >/dev/null 2>&1 ||
    skip "abidiff's opinion on planted changes: it is not there (make deps with=packages)"
soname=$(readelf -d "$shared" | sed -n 's/.*(SONAME).*\[\(.*\)\]/\1/p')

check "the library is like itself" tests/abi/compare.sh "$shared" include "$shared" include

grow='/^} sc_\(mesh\|pose\|build_options\|model_info\|level_info\|query_options\|stats\|result\);/i\
    uint64_t added; void *and_a_pointer;'
check "structures that grow at their ends, and a function" library grown "$soname" "$grow"
check "have grown" grep -q 'added; void' "$scratch/grown/include/starcontour.h"
check "growth breaks nothing" compare grown
check "a program of version 0.1 runs with grown structures" old_caller "$scratch/grown" ''
shrunk() {
    ! tests/abi/compare.sh "$shared" include "$scratch/grown/libstarcontour.so" \
        "$scratch/grown/include" >"$scratch/compared" 2>&1 &&
        grep -q '^no longer exported: sc_added' "$scratch/compared"
}
check "a function that goes is seen" shrunk

wider='s/^    uint32_t method; .*/    uint64_t method;/'
check "a member of another size and another soname" library wider libstarcontour.so.next "$wider"
check "are allowed" compare wider

# What is only in the header needs no other library.
for_header() {
    mkdir "$scratch/$1" "$scratch/$1/include" && cp include/*.h "$scratch/$1/include" &&
        sed "$2" include/starcontour.h >"$scratch/$1/include/starcontour.h" &&
        ln -s "$shared_path" "$scratch/$1/libstarcontour.so"
}
shared_path=$(cd "$SC_LIB" && pwd)/libstarcontour.so
check "a member of another size" for_header method "$wider"
check "is seen" breaks method 'gone or changed: sc_query_options.method'
check "a reserved member that gets a meaning" for_header taken \
    '/^typedef struct sc_mesh {/,/^}/s/uint32_t reserved;/uint32_t taken;/'
check "is allowed" compare taken
check "has one" grep -q 'uint32_t taken;' "$scratch/taken/include/starcontour.h"
check "growth without struct_size" for_header pair 's/^    uint32_t a, b;/    uint32_t a, b, c;/'
check "is seen" breaks pair 'sc_pair: grows, but has no struct_size'
check "an enumerator with another value" for_header value 's/SC_ERROR_NULL = 1,/SC_ERROR_NULL = 91,/'
check "is seen" breaks value 'gone or changed: SC_ERROR_NULL = 1$'
check "another parameter" for_header call 's/\(sc_workspace_size(const sc_model \*model, \)uint64_t/\1uint32_t/'
check "is seen" breaks call 'gone or changed: sc_status sc_workspace_size'
check "a member in what was padding" for_header filled \
    's/^typedef struct sc_tree_node {/typedef struct sc_filled {\
    uint32_t struct_size; char c;\
    uint64_t d;\
} sc_filled;\
&/'
padded() {
    for_header padding 's/^typedef struct sc_tree_node {/typedef struct sc_filled {\
    uint32_t struct_size;\
    uint64_t d;\
} sc_filled;\
&/'
    ! tests/abi/compare.sh "$shared" "$scratch/filled/include" \
        "$shared" "$scratch/padding/include" >"$scratch/compared" 2>&1 &&
        grep -q 'sc_filled.c: lies within' "$scratch/compared"
}
check "is seen" padded
unreadable() {
    for_header odd 's/^typedef struct sc_tree_node {/typedef union sc_odd { int a; float b; } sc_odd;\
&/'
    ! tests/abi/goldens.sh "$scratch/odd" "$shared" "$scratch/odd/include"
}
check "what cannot be read is not passed over" unreadable

finish
