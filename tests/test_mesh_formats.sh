#!/bin/sh
# How sc-query takes meshes: OBJ, OFF and STL, what gzip packed, pipes and standard input, and what
# assimp rounds or does not play; files that are cut short, and what is said of them. PLY has a test
# of its own.
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

# Nothing here waits: what does, hangs.
run() {
    timeout 30 "$query" "$@"
}
# pairs FILE OPTION...: the pairs of triangles, of a file or of what comes in.
pairs() {
    run --out "$scratch/list" "$@" >"$scratch/table" || test $? -eq 1 || return 1
    sed -n '2,$s/^.*,\([0-9]*,[0-9]*\)$/\1/p' "$scratch/list"
}
same_pairs() {
    pairs "$@" >"$scratch/pairs" && diff "$scratch/wanted" "$scratch/pairs"
}
piped() {
    # shellcheck disable=SC2002
    cat "$scratch/mesh.$1" | same_pairs --format "$1" -
}
# refuses FILE WORDS
refuses() {
    says 2 "${1##*/}: .*$2" timeout 30 "$query" "$1"
}
pairs "$obj" >"$scratch/wanted"
check "there are pairs" grep -q , "$scratch/wanted"

# ---- STL ----

stl_text() {
    echo "solid two words"
    awk '$1 == "v" { v[++n] = $2 " " $3 " " $4 } $1 == "f" {
        print "  facet normal 0 0 0\n    outer loop"
        for (k = 2; k <= 4; k++) print "      vertex", v[$k]
        print "    endloop\n  endfacet" }' "$obj"
    echo "endsolid two words"
}
# The float of a whole number of eighths, the low byte first.
stl_binary() {
    printf '%-80s' "$1"
    # shellcheck disable=SC2059
    printf "$(awk 'function float(x,   sign, e, m) {
            if (!x) return "\\000\\000\\000\\000"
            sign = x < 0; if (sign) x = -x
            for (e = 127; x >= 2; e++) x /= 2
            while (x < 1) { x *= 2; e-- }
            m = int((x - 1) * 128)
            return sprintf("\\000%s\\%03o\\%03o", sprintf("\\%03o", ((x - 1) * 128 - m) * 256),
                (e % 2) * 128 + m, sign * 128 + int(e / 2)) }
        $1 == "v" { v[++n] = float($2) float($3) float($4) }
        $1 == "f" { t++; out = out "\\000\\000\\000\\000\\000\\000\\000\\000\\000\\000\\000\\000" \
            v[$2] v[$3] v[$4] "\\000\\000" }
        END { printf "\\%03o\\000\\000\\000%s", t, out }' "$obj")"
}
stl_text >"$scratch/text.stl"
check "text" same_pairs "$scratch/text.stl"
tr '[:lower:]' '[:upper:]' <"$scratch/text.stl" | awk '{ printf "%s\r\n", $0 }' >"$scratch/upper.STL"
check "in capitals, lines that end in CR and LF" same_pairs "$scratch/upper.STL"
(stl_text | head -n 30 | sed '$d'; echo "endsolid"; echo "solid"; stl_text | tail -n +30) >"$scratch/solids.stl"
check "of two solids" same_pairs "$scratch/solids.stl"
stl_binary "a header" >"$scratch/binary.stl"
check "binary" same_pairs "$scratch/binary.stl"
stl_binary "solid header" >"$scratch/solid.stl"
check "binary, though it begins with solid" same_pairs "$scratch/solid.stl"
check "its vertices are those of its facets" says 1 '"vertices_read":24' "$query" --json "$scratch/solid.stl"
for file in binary solid; do
    size=$(wc -c <"$scratch/$file.stl")
    kept=$((size - 3))
    while [ $kept -ge 84 ]; do
        head -c $kept "$scratch/$file.stl" >"$scratch/cut.stl"
        check "binary, cut after $kept bytes" refuses "$scratch/cut.stl" \
            "of 8 triangles, of which it has $(((kept - 84) / 50)); is it truncated"
        kept=$((kept - 61))
    done
    head -c 83 "$scratch/$file.stl" >"$scratch/cut.stl"
    check "before the number of triangles" refuses "$scratch/cut.stl" "truncated"
done
lines=$(wc -l <"$scratch/text.stl")
for kept in 1 2 3 5 7 8 $((lines - 1)); do
    head -n "$kept" "$scratch/text.stl" >"$scratch/cut.stl"
    check "text, cut after $kept lines" refuses "$scratch/cut.stl" "truncated"
done
sed 's/vertex [^ ]*/vertex zero/' "$scratch/text.stl" >"$scratch/bad.stl"
check "a word for a number" refuses "$scratch/bad.stl" "line 4: a vertex needs three numbers"
sed '4s/vertex [^ ]*/vertex 1e999/' "$scratch/text.stl" >"$scratch/bad.stl"
check "a number too large" refuses "$scratch/bad.stl" "line 4: vertex 0: 1e999 is too large"
sed '4s/vertex [^ ]*/vertex nan/' "$scratch/text.stl" >"$scratch/bad.stl"
check "one that is none" refuses "$scratch/bad.stl" "vertex 0 is NaN"

(cat "$scratch/text.stl"; printf '%1100s\000\n' ' '; cat "$scratch/text.stl") \
    >"$scratch/bad.stl"
check "a byte of value 0" refuses "$scratch/bad.stl" "line $((lines + 1)): a byte of value 0"
(cat "$scratch/binary.stl"; printf '%50s' ' ') >"$scratch/bad.stl"
check "binary, with a facet more" refuses "$scratch/bad.stl" "of 8 triangles, but with room for 9"
(cat "$scratch/binary.stl"; printf '%49s' ' ') >"$scratch/more.stl"
check "binary, with some bytes more" same_pairs "$scratch/more.stl"

# ---- packed, piped ----

"$query" --ply "$scratch/mesh.ply" "$obj" >/dev/null
cp "$obj" "$scratch/mesh.obj"
cp "$scratch/text.stl" "$scratch/mesh.stl"
awk '$1 == "v" { v[n++] = $2 " " $3 " " $4 } $1 == "f" { f[m++] = "3 " $2 - 1 " " $3 - 1 " " $4 - 1 }
    END { print "OFF"; print n, m, 0; for (i = 0; i < n; i++) print v[i]
        for (i = 0; i < m; i++) print f[i] }' "$obj" >"$scratch/mesh.off"
# In each text format: how lines end, and the mark that some editors put before UTF-8.
for format in obj off stl; do
    tr '\n' '\r' <"$scratch/mesh.$format" >"$scratch/cr.$format"
    check "$format, lines that end in CR" same_pairs "$scratch/cr.$format"
    awk '{ printf "%s\r\n", $0 }' "$scratch/mesh.$format" >"$scratch/crlf.$format"
    check "$format, in CR and LF" same_pairs "$scratch/crlf.$format"
    printf '%s' "$(cat "$scratch/mesh.$format")" >"$scratch/open.$format"
    check "$format, without an end of the last line" same_pairs "$scratch/open.$format"
    (printf '\357\273\277'; cat "$scratch/mesh.$format") >"$scratch/mark.$format"
    check "$format, behind a mark of UTF-8" same_pairs "$scratch/mark.$format"
done
grep '^[vf]' "$obj" >"$scratch/bare.obj"
(printf '\357\273\277'; cat "$scratch/bare.obj") >"$scratch/mark.obj"
check "before a vertex" same_pairs "$scratch/mark.obj"
sed 's/ \([^ ]*\)$/ \\\n\1/' "$scratch/bare.obj" | tr '\n' '\r' >"$scratch/cr.obj"
check "lines that go on behind a CR" same_pairs "$scratch/cr.obj"
sed 's/^f \([^ ]*\)/f \1\/\/-7/' "$obj" >"$scratch/slash.obj"
check "corners with normals" same_pairs "$scratch/slash.obj"
for corner in 1x 1.7 1/2x 1+2; do
    (cat "$obj"; echo "f $corner 2 3") >"$scratch/bad.obj"
    check "a corner $corner" refuses "$scratch/bad.obj" "vertices must be numbers"
done
lines=$(wc -l <"$scratch/bare.obj")
for zero in '' '# '; do
    (cat "$scratch/bare.obj"; printf '%s\000\nf 1 2 3\n' "$zero") >"$scratch/bad.obj"
    check "a byte of value 0" refuses "$scratch/bad.obj" "line $((lines + 1)): a byte of value 0"
done
(cat "$scratch/mesh.off"; echo "# the end") >"$scratch/more.off"
check "OFF, a comment at the end" same_pairs "$scratch/more.off"
(cat "$scratch/mesh.off"; echo "3 0 1 2") >"$scratch/bad.off"
check "OFF, a face more than it says" refuses "$scratch/bad.off" "goes on behind its last face"
(cat "$scratch/mesh.off"; printf '\000') >"$scratch/bad.off"
check "OFF, a byte of value 0" refuses "$scratch/bad.off" "a byte of value 0"
# AC3D, for what assimp reads.
ac() {
    printf 'AC3Db\nMATERIAL "" rgb 1 1 1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\n'
    printf 'OBJECT world\nkids 1\nOBJECT poly\nname "box"\n'
    awk '$1 == "v" { v[n++] = $2 " " $3 " " $4 } $1 == "f" { f[m++] = $0 }
        END { print "numvert", n; for (i = 0; i < n; i++) print v[i]; print "numsurf", m
            for (i = 0; i < m; i++) { split(f[i], c, " "); print "SURF 0x10\nmat 0\nrefs 3"
                for (k = 2; k <= 4; k++) print c[k] - 1, 0, 0 } print "kids 0" }' "$obj"
}
ac >"$scratch/mesh.ac"
for format in ply obj off stl; do
    gzip -c "$scratch/mesh.$format" >"$scratch/packed.$format.gz"
    check "$format, packed" same_pairs "$scratch/packed.$format.gz"
    cp "$scratch/packed.$format.gz" "$scratch/packed.$format"
    check "$format, packed, though its name does not say so" same_pairs "$scratch/packed.$format"
    check "$format from standard input" same_pairs --format $format - <"$scratch/mesh.$format"
    check "$format from a pipe" piped $format
    cp "$scratch/mesh.$format" "$scratch/nameless"
    check "$format without a name for it" same_pairs --format $format "$scratch/nameless"
    head -c 100 "$scratch/packed.$format.gz" >"$scratch/cut.$format.gz"
    check "$format, packed and cut short" refuses "$scratch/cut.$format.gz" "cut short"
done
check "packed, what assimp reads" sh -c "gzip -c '$scratch/mesh.ac' >'$scratch/packed.ac.gz' &&
    timeout 30 '$query' '$scratch/packed.ac.gz' | grep 'coordinates rounded'"
(head -c 300 "$obj" | gzip; tail -c +301 "$obj" | gzip) >"$scratch/parts.obj.gz"
check "packed in two pieces" same_pairs "$scratch/parts.obj.gz"
(head -c 30 "$scratch/packed.ply.gz"; echo "this is not what was packed"; tail -c +60 "$scratch/packed.ply.gz") \
    >"$scratch/bad.ply.gz"
check "packed and damaged" says 2 "bad.ply.gz: " timeout 30 "$query" "$scratch/bad.ply.gz"
gzip </dev/null >"$scratch/nothing.obj.gz"
check "nothing, packed" refuses "$scratch/nothing.obj.gz" "the file is empty"
check "packed, from standard input" same_pairs --format obj - <"$scratch/packed.obj.gz"
check "PLY is known by itself" same_pairs - <"$scratch/mesh.ply"
check "and so is text STL" same_pairs - <"$scratch/mesh.stl"
check "OBJ is not" says 2 "content tells the format: --format" timeout 30 "$query" - <"$obj"
check "nothing comes in" says 2 "the file is empty" timeout 30 "$query" --format obj - </dev/null
check "twice the same input" says 2 "can be read only once" \
    timeout 30 "$query" --format obj - - <"$obj"
check "an unknown format" says 2 "'fbx' is not one of: obj, off, ply, stl" "$query" --format fbx -
check "poses from standard input" same_pairs --rest "$obj" --format obj - <"$obj"
check "steps" status 0 timeout 30 "$query" --step --format obj - "$obj" <"$obj"
"$SC_BIN/sc-partition" -o "$scratch/model.scm" "$obj" >/dev/null
check "a model" same_pairs --model "$scratch/model.scm" --format obj - <"$obj"
check "sc-partition" says 0 "8 triangles" timeout 30 "$SC_BIN/sc-partition" --format obj - <"$obj"
mkfifo "$scratch/fifo.obj" "$scratch/fifo.ac"
# fifo FILE PIPE STATUS ARGUMENT...
fifo() {
    timeout 30 cat "$1" >"$2" &
    wanted=$3
    shift 3
    status "$wanted" timeout 30 "$query" "$@"
}
check "a named pipe" fifo "$obj" "$scratch/fifo.obj" 1 "$scratch/fifo.obj"
check "of what assimp reads" fifo "$scratch/mesh.ac" "$scratch/fifo.ac" 1 "$scratch/fifo.ac"
check "as the first of two frames" fifo "$obj" "$scratch/fifo.obj" 0 --step "$scratch/fifo.obj" "$obj"
check "as the second" fifo "$obj" "$scratch/fifo.obj" 0 --step "$obj" "$scratch/fifo.obj"
check "and of a saved model" fifo "$obj" "$scratch/fifo.obj" 0 --step --model "$scratch/model.scm" \
    "$scratch/fifo.obj" "$obj"

# ---- what was read ----

# coordinates KIND OPTION...: as JSON says.
coordinates() {
    kind=$1
    shift
    run --json "$@" >"$scratch/json"
    test $? -lt 2 && grep "\"coordinates\":\"$kind\"" "$scratch/json"
}
sed '1,/^v/s/^v \([^ ]*\)/v \1000000001/' "$obj" | sed 's/^v -*0 /v 0.1 /' >"$scratch/double.obj"
check "floats" coordinates float "$obj"
check "doubles" coordinates double "$scratch/double.obj"
check "steps: either has doubles" coordinates double --step "$obj" "$scratch/double.obj"
check "rounded" coordinates rounded "$scratch/mesh.ac"
check "and the table says so" says 1 "mesh.ac (coordinates rounded)$" "$query" "$scratch/mesh.ac"
check "not of others" says 1 "double.obj$" "$query" "$scratch/double.obj"
check "as poses" coordinates rounded --rest "$scratch/mesh.ac" "$scratch/mesh.ac"
check "steps" coordinates rounded --step "$scratch/mesh.ac" "$scratch/mesh.ac"
check "and their table" says 0 "mesh.ac (coordinates rounded)$" \
    "$query" --step "$scratch/mesh.ac" "$scratch/mesh.ac"
check "sc-partition" says 0 '"coordinates":"rounded"' "$SC_BIN/sc-partition" --json "$scratch/mesh.ac"
check "and its table" says 0 "coordinates rounded" "$SC_BIN/sc-partition" "$scratch/mesh.ac"
awk '$1 == "v" { printf "v %s %.4f %s\n", $2, $3 + 5400000.0625, $4; next } { print }' "$obj" \
    >"$scratch/far.obj"
check "contacts far from the origin have their digits" says 1 " 5400002.8125 0.75 " \
    "$query" --contacts "$scratch/far.obj"

# boxes EAST NORTH: two boxes of 10 cm that cross, there.
boxes() {
    awk -v east="$1" -v north="$2" 'function box(x, y, z, first,   i) {
            for (i = 0; i < 8; i++) printf "v %.3f %.3f %.3f\n", east + x + i % 2 * 0.1, \
                north + y + int(i / 2) % 2 * 0.1, 100 + z + int(i / 4) * 0.1
            n = split("1 3 4 2 5 6 8 7 1 2 6 5 3 7 8 4 1 5 7 3 2 4 8 6", c, " ")
            for (i = 1; i <= n; i += 4) print "f", c[i] + first, c[i + 1] + first, \
                c[i + 2] + first, c[i + 3] + first }
        BEGIN { box(0.155, 0.362, 0.08, 0); box(0.201, 0.407, 0.123, 8) }'
}
boxes 0 0 >"$scratch/near_boxes.obj"
boxes 500000 5400000 >"$scratch/far_boxes.obj"
same_boxes() {
    pairs "$scratch/near_boxes.obj" >"$scratch/near_pairs"
    pairs "$scratch/far_boxes.obj" | diff "$scratch/near_pairs" - && grep , "$scratch/near_pairs"
}
check "boxes far from the origin collide as near it" same_boxes
replayed() {
    timeout 30 "$query" --record "$scratch/record" --out "$scratch/list" "$1" >/dev/null
    # the pairs alone: a record has no faces of a file
    sed -n 's/^.*,\([0-9]*,[0-9]*\)$/\1/p' "$scratch/list" >"$scratch/asked"
    timeout 30 "$query" --json --replay "$scratch/record" >"$scratch/json"
    grep '"coordinates":"double"' "$scratch/json" || return 1
    timeout 30 "$query" --replay "$scratch/record" --out "$scratch/list" >/dev/null
    sed -n 's/^.*,\([0-9]*,[0-9]*\)$/\1/p' "$scratch/list" | diff "$scratch/asked" - &&
        grep , "$scratch/asked"
}
sed 's/5400000[0-9.]*/&1/' "$scratch/far.obj" | sed 's/^v 0 /v 0.1 /' >"$scratch/double_far.obj"
check "a record keeps doubles" replayed "$scratch/double_far.obj"

# gltf NODE ANIMATIONS: two triangles that cross, of floats.
gltf() {
    data=$(printf '\000\000\000\000\000\000\000\000\000\000\000\000\000\000\200\077\000\000\000\000\000\000\000\000\000\000\000\000\000\000\200\077\000\000\000\000\000\000\200\076\000\000\200\076\000\000\200\277\000\000\200\076\000\000\200\076\000\000\200\077\000\000\000\077\000\000\000\077\000\000\000\000' |
        base64 | tr -d '\n')
    cat <<END
{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"box","mesh":0$1}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[0,0,-1],"max":[1,1,1]},
{"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},
{"bufferView":0,"componentType":5126,"count":2,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":72},{"buffer":0,"byteOffset":8,"byteLength":8}],
"buffers":[{"byteLength":72,"uri":"data:application/octet-stream;base64,$data"}]$2}
END
}
gltf "" "" >"$scratch/still.gltf"
check "glTF has floats" coordinates float "$scratch/still.gltf"
gltf ',"translation":[0.1,0,0]' "" >"$scratch/moved.gltf"
check "that nodes move" coordinates rounded "$scratch/moved.gltf"
gltf "" ',"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],
    "samplers":[{"input":1,"output":2}]}]' >"$scratch/animated.gltf"
check "an animation" says 1 '"animation":"not played"' "$query" --json "$scratch/animated.gltf"
check "in the table" says 1 "animated.gltf (animation not played)$" "$query" "$scratch/animated.gltf"
check "of steps" says 1 '"animation":"not played"' \
    "$query" --json --step "$scratch/animated.gltf" "$scratch/animated.gltf"
check "of a pose" says 1 '"animation":"not played"' \
    "$query" --json --rest "$scratch/still.gltf" "$scratch/animated.gltf"
if "$query" --json "$scratch/still.gltf" | grep -q animation; then still=said; else still=quiet; fi
check "and none where there is none" test $still = quiet

# ---- short options ----

for program in sc-query sc-partition sc-bench sc-demo subdivide make-meshes; do
    check "$program -h" says 0 "Usage: $program" "$SC_BIN/$program" -h
    check "$program -V" says 0 "^$program (starcontour) [0-9]" "$SC_BIN/$program" -V
    check "$program --version" says 0 "^$program (starcontour) [0-9]" "$SC_BIN/$program" --version
done

finish
