#!/bin/sh
# The same pairs in Node as on this machine, by tests/runs/determinism.c, with and without vectors
# of 128 bits (SIMD128). Run by `make test-wasm`, which builds the libraries.
#
# Both get the same input: shapes that need a sine take it from sine.c.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

wasm=${BUILD:-build}/wasm
emcc=${EMCC:-emcc}
if ! command -v node >/dev/null 2>&1; then
    skip "pairs in Node: there is no node ('make deps with=wasm')" 3
    finish
fi

sources="tests/runs/determinism.c tests/harness.c tests/inputs.c tests/oracle_weld.c tests/shapes.c
    tests/soups.c tests/wasm/sine.c"

# build COMPILER LIBRARY PROGRAM FLAGS...: nothing is computed by the compiler's own sine.
build() {
    compiler=$1 library=$2 program=$3
    shift 3
    # shellcheck disable=SC2086
    $compiler -std=c99 -O2 -ffp-contract=off -fno-builtin -Iinclude -Itests "$@" $sources "$library" \
        -lm -o "$program"
}
here() {
    # shellcheck disable=SC2086
    build "$CC" "$SC_LIB/libstarcontour.a" "$scratch/here" $SC_FLAGS &&
        "$scratch/here" meshes/*.obj >"$scratch/here.txt" && grep -q ' pairs$' "$scratch/here.txt"
}
# Number of queries and so of pairs differ: here there are more kinds of instructions.
there() { # LIBRARY
    # Of what follows the program's name, SINGLE_FILE keeps newer Nodes from fetching a file by URL;
    # without -O the link needs none of the JavaScript packages that Debian's node alone finds.
    build "$emcc" "$wasm/$1/libstarcontour.a" "$scratch/$1.cjs" -O1 -sNODERAWFS -sSINGLE_FILE \
        -sALLOW_MEMORY_GROWTH -sEXIT_RUNTIME &&
        node "$scratch/$1.cjs" meshes/*.obj >"$scratch/$1.txt"
    cat "$scratch/$1.txt" "$scratch/here.txt"
    [ "$(cut -d ' ' -f 1 "$scratch/$1.txt")" = "$(cut -d ' ' -f 1 "$scratch/here.txt")" ]
}
check "queries here" here
check "the same pairs in Node, with SIMD128" there simd
check "and without" there plain
cat "$scratch/here.txt" "$scratch/simd.txt" "$scratch/plain.txt"
finish
