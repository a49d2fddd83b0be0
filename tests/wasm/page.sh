#!/bin/sh
# The package and the page in Chromium without a window: the same answers as the library gives here,
# and a cloth that is pulled. Run by `make test-wasm`.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

build=${BUILD:-build}
wasm=$build/wasm
browser=
for one in chromium chromium-browser google-chrome; do
    [ -z "$browser" ] && browser=$(command -v $one)
done
looks=27
ready() {
    command -v node >/dev/null 2>&1 && command -v npm >/dev/null 2>&1 && [ -n "$browser" ] &&
        tools/npm/make_package.sh page
}
if ! BUILD=$build ready >"$scratch/npm.log" 2>&1; then
    skip "in a browser: no chromium, node or npm, or npm cannot fetch ('make deps with=wasm')" $((looks + 5))
    finish
fi

# The same answers.
here() {
    # shellcheck disable=SC2086
    $CC -std=c99 -O2 -ffp-contract=off -Iinclude -Itests tests/wasm/answers.c tests/harness.c \
        tests/inputs.c tests/oracle_weld.c tests/shapes.c tests/soups.c "$SC_LIB/libstarcontour.a" \
        $SC_FLAGS -lm -o "$scratch/answers" &&
        "$scratch/answers" "$scratch" meshes/*.obj >"$scratch/native.txt" && test -s "$scratch/native.txt"
}
there() {
    node tests/wasm/looks.mjs "$build/page" "$browser" answers "$wasm/package" meshes/*.obj \
        >"$scratch/browser.txt" && diff "$scratch/native.txt" "$scratch/browser.txt"
}
check "answers here" here
check "the same in Chromium" there

# Two triangles, apart and through each other, as text of three kinds; and one that is wrong.
make_obj() { # FILE HEIGHT
    cat >"$1" <<EOT
v 0 0 0
v 4 0 0
v 0 4 0
v 1 1 $2
v 2 1 1
v 1 2 1
f 1 2 3
f 4/1 -2 6//2
EOT
}
make_obj "$scratch/f1.obj" 1
make_obj "$scratch/f2.obj" -1
{
    printf 'ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n'
    printf 'element face 2\nproperty list uchar int vertex_indices\nend_header\n'
    printf '0 0 0\n4 0 0\n0 4 0\n1 1 -1\n2 1 1\n1 2 1\n3 0 1 2\n3 3 4 5\n'
} >"$scratch/two.ply"
{
    echo 'solid two'
    for corners in '0 0 0,4 0 0,0 4 0' '1 1 -1,2 1 1,1 2 1'; do
        printf 'facet normal 0 0 1\nouter loop\n'
        echo "$corners" | tr ',' '\n' | sed 's/^/vertex /'
        printf 'endloop\nendfacet\n'
    done
    echo 'endsolid two'
} >"$scratch/two.stl"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n' >"$scratch/bad.obj"

node tests/wasm/looks.mjs "$build/page" "$browser" page "$wasm/page.html" meshes/touching_cubes.obj \
    "$scratch/f2.obj" "$scratch/f1.obj" "$scratch/two.ply" "$scratch/two.stl" "$scratch/bad.obj" \
    >"$scratch/looks" 2>"$scratch/look.err"
check "it looks to the end" test $? -eq 0
[ -s "$scratch/look.err" ] && sed 's/^/    /' "$scratch/look.err"
while read -r line; do
    check "${line#* }" test "${line%% *}" = ok
done <"$scratch/looks"
seen=$(wc -l <"$scratch/looks")
check "all was looked at ($seen)" test "$seen" -eq "$looks"
finish
