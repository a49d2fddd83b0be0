#!/bin/sh
# Prints what tests/ffi/golden.txt should hold: the triangle pairs of meshes/crossing_cloths.obj at
# rest and moved (see moved.awk), the vertex-face and edge-edge pairs within 0.045 when it is moved,
# those that collide on the way from one pose to the other, and the contours at rest (contours.awk),
# as sc-query finds them. To update the file after a change:
#
#     tests/ffi/golden.sh > tests/ffi/golden.new && mv tests/ffi/golden.new tests/ffi/golden.txt
#
# SPDX-License-Identifier: MIT
set -eu
export LC_ALL=C

here=$(dirname "$0")
mesh=$here/../../meshes/crossing_cloths.obj
query=${SC_BIN:-$here/../../build/bin}/sc-query
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

awk -f "$here/moved.awk" "$mesh" >"$scratch/moved.obj"
echo "# pose or what is sought, a, b: meshes/crossing_cloths.obj by tests/ffi/golden.sh"
for pose in rest moved; do
    file=$mesh
    [ "$pose" = rest ] || file=$scratch/moved.obj
    status=0
    "$query" --rest "$mesh" --out "$scratch/pairs" "$file" >/dev/null || status=$?
    [ "$status" -eq 1 ]
    sed -n "s/^.*,\([0-9][0-9]*\),\([0-9][0-9]*\)\$/$pose \1 \2/p" "$scratch/pairs"
done

status=0
"$query" --near 0.045 --rest "$mesh" --out "$scratch/pairs" "$scratch/moved.obj" >/dev/null || status=$?
[ "$status" -eq 1 ]
awk -F, 'NR > 1 { print $2 == "vertex-face" ? "nearfaces" : "nearedges", $7, $8 }' "$scratch/pairs"
status=0
"$query" --step --out "$scratch/pairs" "$mesh" "$scratch/moved.obj" >/dev/null || status=$?
[ "$status" -eq 1 ]
awk -F, 'NR > 1 { print $3 == "vertex-face" ? "stepfaces" : "stepedges", $8, $9 }' "$scratch/pairs"
status=0
"$query" --trace --json "$mesh" >"$scratch/contours" || status=$?
[ "$status" -eq 1 ]
echo "# contour: nodes, begin, end, length. node: edge, triangle"
tr '{' '\n' <"$scratch/contours" | awk -f "$here/contours.awk" |
    sort -k1,1n -k2,2n -k3,3n -k4,4n | cut -d ' ' -f 5-
