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
# Numbers of two and four bytes, the high one first. TAG: the first byte of each vertex.
binary() {
    # shellcheck disable=SC2059
    printf "$(awk 'function put(size, n) {
            while (--size >= 0) printf "\\%03o", size < 2 ? int(n / 256 ^ size) % 256 : 0 }
        $1 == "v" { put(1, '"${1:-7}"'); for (k = 2; k <= 4; k++) put(2, 8 * $k)
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
(printf '\357\273\277'; text) >"$scratch/mark.ply"
check "behind a mark of UTF-8" same_pairs "$scratch/mark.ply"
cp "$scratch/lf.ply" "$scratch/unnamed"
check "a name without an ending" same_pairs "$scratch/unnamed"
"$query" --ply "$scratch/little.ply" "$obj" >/dev/null
check "little-endian, as --ply writes it" same_pairs "$scratch/little.ply"
(header binary_big_endian short; binary) >"$scratch/lf.ply"
check "big-endian" same_pairs "$scratch/lf.ply"
(header binary_big_endian short | awk '{ printf "%s\r\n", $0 }'; binary) >"$scratch/crlf.ply"
check "in CR and LF" same_pairs "$scratch/crlf.ply"

for end in lf cr crlf; do
    for byte in 10 13 32; do
        case $end in
        lf) header binary_big_endian int16 ;;
        cr) header binary_big_endian int16 | tr '\n' '\r' ;;
        crlf) header binary_big_endian int16 | awk '{ printf "%s\r\n", $0 }' ;;
        esac >"$scratch/first.ply"
        binary $byte >>"$scratch/first.ply"
        check "data that begin with byte $byte, header's lines end in $end" \
            same_pairs "$scratch/first.ply"
    done
done

# typed FORMAT TYPE: coordinates of that type, eight times as large, corners of the last integer
# type.
typed() {
    printf '%s\n' "ply" "format $1 1.0" "element face 8" "property $2 tag" \
        "property list uint32 $3 vertex_index" "element vertex 8" "property list $3 $2 more" \
        "property $2 z" "property $2 y" "property $2 x" "end_header"
}
# What a number is in octal bytes; floats of whole numbers, for which a table will do.
typed_data() {
    # shellcheck disable=SC2059
    printf "$(awk -v little="$1" -v type="$2" -v index_type="$3" '
        function out(bytes, n,   k) {
            for (k = 1; k <= n; k++) printf "\\%03o", bytes[little ? n + 1 - k : k] }
        function whole(n, value,   k, b) {
            if (value < 0) value += 256 ^ n
            for (k = n; k >= 1; k--) { b[k] = value % 256; value = int(value / 256) }
            out(b, n) }
        function real(n, value,   sign, e, k, b, m) {
            sign = value < 0; if (sign) value = -value
            for (k = 1; k <= n; k++) b[k] = 0
            if (value) {
                for (e = 0; value >= 2; e++) value /= 2
                while (value < 1) { value *= 2; e-- }
                m = (value - 1) * (n == 4 ? 128 : 16); e += n == 4 ? 127 : 1023
                if (n == 4) { b[1] = int(e / 2); b[2] = (e % 2) * 128 + int(m)
                    b[3] = (m - int(m)) * 256 }
                else { b[1] = int(e / 16); b[2] = (e % 16) * 16 + int(m); m = (m - int(m)) * 256
                    b[3] = int(m); b[4] = (m - int(m)) * 256 }
                if (sign) b[1] += 128
            }
            out(b, n) }
        function put(t, value) {
            if (t ~ /float|double/) real(t ~ /32|^float$/ ? 4 : 8, value)
            else whole(t ~ /8|char/ ? 1 : t ~ /16|short/ ? 2 : 4, value) }
        $1 == "v" { for (k = 2; k <= 4; k++) at[v, k] = 8 * $k; v++ }
        $1 == "f" { put(type, 1); whole(4, 3); for (k = 2; k <= 4; k++) put(index_type, $k - 1) }
        END { for (i = 0; i < v; i++) { put(index_type, 2); put(type, 3); put(type, 0)
            for (k = 4; k >= 2; k--) put(type, at[i, k]) } }' "$obj")"
}
# Away from negative numbers, which half of the types have not.
awk '$1 == "v" { print "v", $2 + 3, $3 + 3, $4 + 3; next } { print }' "$obj" >"$scratch/moved.obj"
for type in char uchar short ushort int uint float double int8 uint8 int16 uint16 int32 uint32 float32 \
    float64; do
    case $type in
    u*) obj=$scratch/moved.obj ;;
    *) obj=meshes/crossing_tetrahedra.obj ;;
    esac
    case $type in
    float* | double) corner=int ;;
    *) corner=$type ;;
    esac
    (typed binary_big_endian $type $corner; typed_data 0 $type $corner) >"$scratch/big.ply"
    check "$type, big-endian" same_pairs "$scratch/big.ply"
    (typed binary_little_endian $type $corner; typed_data 1 $type $corner) >"$scratch/little.ply"
    check "$type, little-endian" same_pairs "$scratch/little.ply"
    (typed ascii $type $corner
    awk '$1 == "f" { print 1, 3, $2 - 1, $3 - 1, $4 - 1 } $1 == "v" { at[v++] = 8 * $4 " " 8 * $3 " " 8 * $2 }
        END { for (i = 0; i < v; i++) print 2, 3, 0, at[i] }' "$obj") >"$scratch/text.ply"
    check "$type, text" same_pairs "$scratch/text.ply"
done
obj=meshes/crossing_tetrahedra.obj

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
sed 's/^element face.*/element tristrips 1/; $d' "$scratch/small.ply" | sed '$d' >"$scratch/strips.ply"
echo "9 0 1 2 0 -1 2 1 0 1" >>"$scratch/strips.ply"
mv "$scratch/strips.ply" "$scratch/small.ply"
check "strips of triangles" triangles 4

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
ply 3 "element face 1" "4000000000 0 1 2"
check "a face of more corners than there are" refuses "cannot be read"
ply 3 "element face 1" "-3 0 1 2"
check "of less than none" refuses "cannot be read"
ply 3 "element face 1" "2.5 0 1 2"
check "of parts of them" refuses "cannot be read"
ply 3 "element face 1" "3 0 1"
check "of fewer than it says" refuses "truncated"
ply 3 "element face 1" "3 0 1 two"
check "a word in place of a number" refuses "line 13: two is not a number"
ply 3 "element face 1" "3 0 1 2"
sed 's/^1 0 0$/1e400 0 0/' "$scratch/small.ply" >"$scratch/changed.ply"
mv "$scratch/changed.ply" "$scratch/small.ply"
check "a number too large" refuses "line 11: 1e400 is too large for a double"
ply 3 "element face 1" "3 0 1 2"
echo "3 0 2 1" >>"$scratch/small.ply"
check "a face more than it says" refuses "line 14: 3 stands behind all that the header says"
ply 3 "element face 0" ""
check "no faces" refuses "no triangles in it"
ply 3 "element edge 1" "2 0 1"
check "nor a word of them" refuses "no triangles in it"
for line in 4 5 6 8; do
    ply 3 "element face 1" "3 0 1 2"
    sed "${line}d" "$scratch/small.ply" >"$scratch/changed.ply"
    mv "$scratch/changed.ply" "$scratch/small.ply"
    check "without property $line" refuses "have no"
done
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
