#!/bin/sh
# PLY files by sc-query: text and binary, all line ends, what is skipped; and files that are cut
# short, or say what is not so, which are refused at once.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi
obj=meshes/crossing_tetrahedra.obj # 8 vertices, 8 triangles, coordinates in eighths

pairs() {
    "$query" --weld none --out "$scratch/list" "$1" >"$scratch/table" || test $? -eq 1 || return 1
    sed -n '2,$s/^.*,\([0-9]*,[0-9]*\)$/\1/p' "$scratch/list"
}
same_pairs() {
    pairs "$1" >"$scratch/pairs" && diff "$scratch/wanted" "$scratch/pairs"
}
pairs "$obj" >"$scratch/wanted"
check "there are pairs" grep -q , "$scratch/wanted"

# header FORMAT TYPE: with properties and an element that are to be skipped, and words in comments.
header() {
    printf '%s\n' "ply" "format $1 1.0" "comment end_header" "obj_info element vertex 3" \
        "element vertex 8" "property uchar tag" "property $2 x" "property $2 y" "property $2 z" \
        "property list uchar uchar some" \
        "element edge 1" "property list uchar int vertex_indices" "comment TextureFile none" \
        "element face 8" "property list uchar int vertex_indices" "end_header"
}
text() {
    header ascii float
    awk '$1 == "v" { print 7, $2, $3, $4, 2, 255, 0; next } $1 != "f" { next }
        !edge++ { print 2, 0, 1 } { print 3, $2 - 1, $3 - 1, $4 - 1 }' "$obj"
}
# Numbers of two and four bytes, the high one first.
binary() {
    # shellcheck disable=SC2059
    printf "$(awk 'function put(size, n) {
            while (--size >= 0) printf "\\%03o", size < 2 ? int(n / 256 ^ size) % 256 : 0 }
        $1 == "v" { put(1, 7); for (k = 2; k <= 4; k++) put(2, 8 * $k)
            put(1, 2); put(1, 255); put(1, 0) }
        $1 != "f" { next } !edge++ { put(1, 2); put(4, 0); put(4, 1) }
        { put(1, 3); for (k = 2; k <= 4; k++) put(4, $k - 1) }' "$obj")"
}

# ---- files that are read ----

text >"$scratch/lf.ply"
check "text" same_pairs "$scratch/lf.ply"
text | tr '\n' '\r' >"$scratch/cr.ply"
check "lines that end in CR" same_pairs "$scratch/cr.ply"
text | awk '{ printf "%s\r\n", $0 }' >"$scratch/crlf.PLY"
check "in CR and LF" same_pairs "$scratch/crlf.PLY"
text | awk '{ printf "%s\n\n", $0 }' >"$scratch/blank.ply"
check "with empty lines between" same_pairs "$scratch/blank.ply"
cp "$scratch/lf.ply" "$scratch/unnamed"
check "a name without an ending" same_pairs "$scratch/unnamed"
"$query" --ply "$scratch/little.ply" "$obj" >/dev/null
check "little-endian, as --ply writes it" same_pairs "$scratch/little.ply"
(header binary_big_endian short; binary) >"$scratch/lf.ply"
check "big-endian" same_pairs "$scratch/lf.ply"
(header binary_big_endian short | awk '{ printf "%s\r\n", $0 }'; binary) >"$scratch/crlf.ply"
check "in CR and LF" same_pairs "$scratch/crlf.ply"

# ply NUMBER LINES DATA: a file that says that it has so many vertices, which are three.
ply() {
    printf '%s\n' "ply" "format ascii 1.0" "element vertex $1" "property double x" \
        "property double y" "property double z" "$2" "property list int int vertex_index" \
        "end_header" "0 0 0" "1 0 0" "0 1 0" "$3" >"$scratch/small.ply"
}
triangles() {
    "$query" --json "$scratch/small.ply" >"$scratch/json"
    grep "\"triangles\":$1," "$scratch/json"
}
ply 3 "element face 1" "3 2 1 0"
check "a triangle" triangles 1
ply 3 "element face 2" "$(printf '2 0 1\n4 0 1 2 1')"
check "a line, and a polygon" triangles 2

# ---- files that are not ----

# refuses WORDS: in a moment, with the name of the file.
refuses() {
    (ulimit -t 20 && says 2 "small.ply: .*$1" "$query" "$scratch/small.ply")
}
for number in -1 1.5 x 4294967295 99999999999999999999; do
    ply $number "element face 1" "3 0 1 2"
    check "$number vertices" refuses "without a number that the file can hold"
done
ply 4000000000 "element face 1" "3 0 1 2"
check "more vertices than lines" refuses "truncated"
ply 3 "element face 4000000000" "3 0 1 2"
check "more faces than lines" refuses "truncated"
if [ "$SC_CONFIG" = sanitize ]; then
    skip "faces for which assimp asks for gigabytes: AddressSanitizer ends a program for that"
else
    ply 3 "element face 1" "4000000000 0 1 2"
    check "a face of more corners than there are" refuses "cannot be read"
    ply 3 "element face 1" "-3 0 1 2"
    check "of less than none" refuses "cannot be read"
fi
for corner in 3 -1 4294967295; do
    ply 3 "element face 1" "3 0 1 $corner"
    check "a corner $corner" refuses "names"
done
ply 3 "element vertex 1" "3 0 1 2"
check "vertices twice" refuses "vertices or faces twice"
ply 3 "$(printf 'property half w\nelement face 1')" "3 0 1 2"
check "an unknown type" refuses "an unknown type"
ply 3 "element face 1" "3 0 1 2"
cp "$scratch/small.ply" "$scratch/whole.ply"
for line in 1 2 3; do
    sed "${line}d" "$scratch/whole.ply" >"$scratch/small.ply"
    check "without line $line" refuses ""
done
for word in "comment end_header" "obj_info end_header" "end_headers" "endheader"; do
    awk -v word="$word" '/end_header/ { print word; next } { print }' "$scratch/whole.ply" \
        >"$scratch/small.ply"
    check "a header that does not end: $word" refuses ""
    awk -v word="$word" '/end_header/ { print word; exit } { print }' "$scratch/whole.ply" \
        >"$scratch/small.ply"
    check "nor after that" refuses ""
done
for word in "ply end_header" "plyend_header" "ply 1"; do
    sed "1s/.*/$word/" "$scratch/whole.ply" >"$scratch/small.ply"
    check "a first line $word" refuses "begins with a line ply"
done
begin() {
    sed '/end_header/,$d' "$scratch/whole.ply"
}
begin >"$scratch/small.ply"
check "one that is cut" refuses "the header does not end"
size=$(wc -c <"$scratch/lf.ply")
kept=$(header binary_big_endian short | wc -c)
while [ "$kept" -lt "$size" ]; do
    head -c "$kept" "$scratch/lf.ply" >"$scratch/small.ply"
    check "binary data cut after $kept bytes" refuses "truncated"
    kept=$((kept + 13))
done
(begin; yes "comment that says nothing" | head -n 1000000) >"$scratch/small.ply"
check "a million comments" refuses "the header does not end"
(begin; yes "property int a" | head -n 300000; echo end_header) >"$scratch/small.ply"
check "very many properties" refuses "truncated"

finish
