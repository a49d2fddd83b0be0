#!/bin/sh
# sc-query's filters, contacts and budget: what they leave of the pairs, what they print, the exit
# status, and files that cannot be read.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi
cloths=meshes/crossing_cloths.obj
sheet=meshes/folded_sheet.obj

# pairs FILE OPTION...: the triangle pairs that are left.
pairs() {
    to=$1
    shift
    "$query" --out "$scratch/list" "$@" >/dev/null 2>&1
    [ $? -lt 2 ] && sed -n '2,$s/^.*,\([0-9]*,[0-9]*\)$/\1/p' "$scratch/list" >"$to"
}
fewer() {
    pairs "$scratch/fewer" "$@" && test "$(wc -l <"$scratch/fewer")" -lt "$(wc -l <"$scratch/all")"
}

# ---- what is left out ----

check "all pairs" pairs "$scratch/all" "$sheet"
check "there are pairs" test "$(wc -l <"$scratch/all")" -gt 20
check "one ring: fewer" fewer --ignore-rings 1 "$sheet"
cp "$scratch/fewer" "$scratch/ring1"
check "five rings: fewer still" fewer --ignore-rings 5 "$sheet"
check "than with one" test "$(wc -l <"$scratch/fewer")" -lt "$(wc -l <"$scratch/ring1")"
check "too many rings" says 2 "33" "$query" --ignore-rings 33 "$sheet"

# Without the pairs that share a vertex, as awk finds them.
awk '$1 == "f" { t = n++; for (i = 2; i <= 4; i++) { split($i, v, "/"); corner[t, i] = v[1] } next }
    FILENAME != last { last = FILENAME }
    /^[0-9]+,/ { split($0, p, ","); shares = 0
        for (i = 2; i <= 4; i++) for (k = 2; k <= 4; k++)
            if (corner[p[1], i] == corner[p[2], k]) shares = 1
        if (!shares) print }' "$sheet" "$scratch/all" >"$scratch/disjoint"
check "one ring: those that share no vertex" diff "$scratch/disjoint" "$scratch/ring1"

"$query" --out "$scratch/own.csv" "$sheet" >/dev/null
check "its own pairs ignored: clean" status 0 "$query" --ignore "$scratch/own.csv" "$sheet"
check "also in reverse order" sh -c "sed '1!G;h;\$!d' '$scratch/own.csv' | grep -v file >'$scratch/r.csv' &&
    '$query' --ignore '$scratch/r.csv' '$sheet'"
head -n 3 "$scratch/own.csv" >"$scratch/two.csv"
check "two ignored" fewer --ignore "$scratch/two.csv" "$sheet"
check "two ignored: two fewer" test $(($(wc -l <"$scratch/all") - $(wc -l <"$scratch/fewer"))) -eq 2
check "another kind of pair" says 2 "line 1" "$query" --pairs edge --ignore "$scratch/own.csv" "$sheet"
"$query" --pairs edge --out "$scratch/edges.csv" "$sheet" >/dev/null
check "edges ignored: clean" status 0 "$query" --pairs edge --ignore "$scratch/edges.csv" "$sheet"
echo "no,numbers" >"$scratch/bad.csv"
check "no numbers" says 2 "bad.csv: line 1" "$query" --ignore "$scratch/bad.csv" "$sheet"
echo "1,4000000" >"$scratch/bad.csv"
check "no such triangle" says 2 "no pair of this model" "$query" --ignore "$scratch/bad.csv" "$sheet"
check "no such file" says 2 absent "$query" --ignore "$scratch/absent.csv" "$sheet"

# ---- files that are not read, and files that are not written over ----

printf 'v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n' >"$scratch/inf.obj"
check "which vertex is not finite" says 2 "inf.obj: vertex 2 is NaN" "$query" "$scratch/inf.obj"
mkfifo "$scratch/pipe.obj"
from_pipe() {
    timeout 20 cat "$1" >"$scratch/pipe.obj" &
    timeout 20 "$query" --out "$scratch/piped.csv" "$scratch/pipe.obj" >/dev/null
    test $? -eq 1 && "$query" --out "$scratch/file.csv" "$1" >/dev/null
    sed 's/^[^,]*,//' "$scratch/piped.csv" >"$scratch/piped"
    sed 's/^[^,]*,//' "$scratch/file.csv" | diff - "$scratch/piped"
}
check "a pipe is read as a file is" from_pipe "$sheet"
check "a device" says 2 "a device" "$query" /dev/null
ln -s /dev/null "$scratch/null.obj"
check "with a name" says 2 "a device" "$query" "$scratch/null.obj"
echo 'v 1e300 -1e300 0
v 0 1e300 0
v 1e-300 0 1e300
f 1 2 3' >"$scratch/large.obj"
check "numbers that only doubles hold" says 0 "large.obj" "$query" "$scratch/large.obj"
printf 'v 0 0 0\nv 0 -1e400 0\nv 0 0 0\nf 1 2 3\n' >"$scratch/large.obj"
check "and that not even they do" says 2 "line 2: vertex 1: -1e400 is too large for a double" \
    "$query" "$scratch/large.obj"
printf 'OFF\n3 1 0\n0 0 0\n0 0 1e400\n0 1 0\n3 0 1 2\n' >"$scratch/large.off"
check "also in OFF" says 2 "line 4: vertex 1: 1e400 is too large" "$query" "$scratch/large.off"
printf 'ply\nformat ascii 1.0\nelement vertex 3\nend_head' >"$scratch/cut.ply"
check "a PLY file cut in its header" says 2 "the header does not end" "$query" "$scratch/cut.ply"
cp "$sheet" "$scratch/own.obj"
for option in --out --ply --record; do
    check "not over the mesh: $option" says 2 "own.obj is to be read" \
        "$query" $option "$scratch/../${scratch##*/}/own.obj" "$scratch/own.obj"
done
check "not over the rest mesh" says 2 "own.obj is to be read" \
    "$query" --rest "$scratch/own.obj" --out "$scratch/own.obj" "$sheet"
check "nor by sc-partition" says 2 "own.obj is to be read" \
    "$SC_BIN/sc-partition" -o "$scratch/own.obj" "$scratch/own.obj"
check "the mesh is whole" cmp "$sheet" "$scratch/own.obj"
check "over a list that was read" status 0 \
    "$query" --ignore "$scratch/own.csv" --out "$scratch/own.csv" "$sheet"

# Two cloths of 288 triangles that cross: apart as groups, or each alone.
printf '# two\ntriangle 0-287 1 2\n\ntriangle 288-575 0x2 0x1 # the other\n' >"$scratch/groups"
check "all pairs of the cloths" pairs "$scratch/all" "$cloths"
check "groups that collide" pairs "$scratch/between" --groups "$scratch/groups" "$cloths"
check "all pairs are between the cloths" diff "$scratch/all" "$scratch/between"
printf 'triangle 0-287 1 1\ntriangle 288-575 2 2\n' >"$scratch/groups"
check "groups that do not" status 0 "$query" --groups "$scratch/groups" "$cloths"
printf 'vertex 0-337 0 0\n' >"$scratch/groups"
check "vertices of no category" status 0 "$query" --groups "$scratch/groups" "$cloths"
for wrong in "triangle 0-576 1 1" "triangle 3-2 1 1" "triangle 0 1" "point 0 1 1" "vertex 0 1 4294967296" \
    "triangle 0 1 1 1" "triangle 01 2"; do
    echo "$wrong" >"$scratch/groups"
    check "groups: '$wrong'" says 2 "groups: " "$query" --groups "$scratch/groups" "$cloths"
done

# ---- contacts ----

check "contacts" says 1 "3 4 segment 0.5 2.75 0.75 2.625 0.625 0.75" \
    "$query" --contacts meshes/crossing_tetrahedra.obj
check "as JSON" says 1 '"kind":"point","points":\[\[0,0,0\],\[0,0,0\]\],"weights_a":\[\[1,0,0\]' \
    "$query" --json --contacts meshes/corner_on_face.obj
check "areas" says 1 " area " "$query" --contacts "$sheet"
check "edges meet in points" says 1 " point " "$query" --pairs edge --proper --contacts "$cloths"
check "no list, no contacts" says 2 "contacts" "$query" --any --contacts "$cloths"

# ---- budget ----

check "a small budget" says 3 "+" "$query" --budget 10 "$cloths"
check "as JSON" says 3 '"status":"incomplete"' "$query" --json --budget 10 "$cloths"
check "a large one is enough" status 1 "$query" --budget 4000000000 "$cloths"
check "--any: not known" says 3 unknown "$query" --any --budget 10 "$cloths"
check "no budget" says 2 "budget" "$query" --budget 0 "$cloths"
check "a failure counts for more" status 2 "$query" --budget 10 "$cloths" meshes/absent.obj
check "and what is not known more than a collision" status 3 \
    "$query" --budget 10 "$cloths" meshes/corner_on_face.obj

# ---- threads ----

fold() {
    awk 'BEGIN { n = 60; for (y = 0; y <= n; y++) for (x = 0; x <= n; x++) {
            u = x / n; if (u > 0.5) print "v", 1 - u, y / n, (y / n - 0.4) / 10; else print "v", u, y / n, 0 }
        for (y = 0; y < n; y++) for (x = 1; x <= n; x++) {
            a = y * (n + 1) + x; print "f", a, a + 1, a + n + 1; print "f", a + 1, a + n + 2, a + n + 1 } }'
}
fold >"$scratch/fold.obj"
by_threads() {
    "$query" --pairs "$2" --weld none --out "$scratch/pairs.$1" --threads "$1" "$scratch/fold.obj"
    test $? -eq 1
}
for kind in triangle edge; do
    check "$kind pairs by one thread" by_threads 1 $kind
    for threads in 2 3 8; do
        check "$kind pairs by $threads threads" by_threads $threads $kind
        check "are the same" cmp "$scratch/pairs.1" "$scratch/pairs.$threads"
    done
done
check "of which there are many" test "$(wc -l <"$scratch/pairs.1")" -gt 50
check "no threads" says 2 "threads" "$query" --threads 0 "$cloths"
check "too many threads" says 2 "threads" "$query" --threads 257 "$cloths"

finish
