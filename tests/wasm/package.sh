#!/bin/sh
# The package for npm, packed and unpacked as npm does it: what it answers in Node is, bit for bit,
# what the library answers here, and what it refuses it names. Run by `make test-wasm`.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

wasm=${BUILD:-build}/wasm
if ! command -v node >/dev/null 2>&1; then
    skip "the package: there is no node ('make deps with=wasm')" 60
    finish
fi

# As installed: from the packed file if there is npm.
package=$wasm/package
packed() {
    BUILD="${BUILD:-build}" tools/npm/make_package.sh pack && tar -xzf "$wasm"/starcontour-*.tgz -C "$scratch"
}
if command -v npm >/dev/null 2>&1; then
    check "npm packs it" packed
    for file in LICENSE README.md index.d.ts index.js package.json starcontour.wasm.js; do
        check "with $file" test -s "$scratch/package/$file"
    done
    check "and nothing else" test "$(find "$scratch/package" -type f | wc -l)" -eq 6
    package=$scratch/package
else
    skip "packing: there is no npm" 8
fi

here() {
    # shellcheck disable=SC2086
    $CC -std=c99 -O2 -ffp-contract=off -Iinclude -Itests tests/wasm/answers.c tests/harness.c \
        tests/inputs.c tests/oracle_weld.c tests/shapes.c tests/soups.c "$SC_LIB/libstarcontour.a" \
        $SC_FLAGS -lm -o "$scratch/answers" &&
        "$scratch/answers" "$scratch" meshes/*.obj >"$scratch/native.txt"
}
check "answers here" here

node tests/wasm/package.mjs "$package/index.js" "$scratch" meshes/*.obj >"$scratch/seen" 2>"$scratch/seen.err"
check "it looks to the end" test $? -eq 0
[ -s "$scratch/seen.err" ] && sed 's/^/    /' "$scratch/seen.err"
while read -r line; do
    check "${line#* }" test "${line%% *}" = ok
done <"$scratch/seen"

# The example of the manual prints what it says, and its names are in the types.
example() {
    awk '/^```/ { inside = $0 == "```js"; next } inside' tools/npm/README.md |
        sed "s|'starcontour'|'$package/index.js'|" >"$scratch/example.mjs"
    awk '/^```/ { inside = $0 == "```text"; next } inside' tools/npm/README.md >"$scratch/expected"
    node "$scratch/example.mjs" | diff "$scratch/expected" -
}
check "the example prints what README.md says" example
names() {
    awk '/^export class Model/ { inside = 1 } inside' tools/npm/index.js |
        sed -n 's/^    \(static \|get \)\{0,1\}\([a-z][A-Za-z]*\)(.*) {$/\2/p'
    sed -n 's/^export \(class\|const\|function\) \([A-Za-z]*\).*/\2/p' tools/npm/index.js
}
for name in $(names | grep -v -x -e if -e for); do
    check "$name has a type" grep -q -w -e "$name" tools/npm/index.d.ts
done
finish
