#!/bin/sh
# Places and defects by sc-query: pairs joined into places, with their objects, sizes and depths;
# the defects that a checker of assets lists; the colours of --ply; and that --only leaves them out.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi

# box NAME X Y Z SIDE [FLIP]: a closed box, oriented outwards, or inwards with FLIP. The first
# vertex is number $first.
box() {
    awk -v name="$1" -v x="$2" -v y="$3" -v z="$4" -v s="$5" -v flip="${6:-0}" -v first="$first" '
        BEGIN {
            print "o", name
            for (i = 0; i < 8; i++) print "v", x + s * (i % 2), y + s * (int(i / 2) % 2), z + s * int(i / 4)
            n = split("0 2 3 1 4 5 7 6 0 1 5 4 2 6 7 3 0 4 6 2 1 3 7 5", v, " ")
            for (i = 1; i <= n; i += 4)
                if (flip) print "f", v[i + 3] + first, v[i + 2] + first, v[i + 1] + first, v[i] + first
                else print "f", v[i] + first, v[i + 1] + first, v[i + 2] + first, v[i + 3] + first
        }'
    first=$((first + 8))
}

# The member of the first line of JSON that jq's syntax would name; by Python, which has JSON.
python=
for one in python3 /usr/bin/python3; do
    "$one" -c 'import json' >/dev/null 2>&1 && python=$one && break
done
member() {
    "$query" --json "$2" >"$scratch/json" 2>/dev/null
    "$python" -c 'import json, sys
print(eval(sys.argv[2], json.loads(open(sys.argv[1]).readline())))' "$scratch/json" "$1"
}
is() { # WANTED EXPRESSION FILE
    got=$(member "$2" "$3")
    test "$got" = "$1" || { echo "$got instead of $1"; return 1; }
}
have_json=1
[ -n "$python" ] || have_json=0

# ---- places ----

# Two boxes that overlap at a corner, by a quarter in each direction; two that are through each
# other by a half in x, and one apart. The larger pair has the later numbers.
first=1
{
    box far 90 0 0 1
    box one 0 0 0 1
    box two 0.75 0.75 0.75 1
    box big 20 0 0 4
    box peg 23.5 1.25 1.25 1
    box cap 24.25 1.5 1.5 0.5
} >"$scratch/boxes.obj"
check "two places" says 1 "place 2: .* faces, .* pairs, one / two, 0.25 x 0.25 x 0.25 at 0.875 0.875 0.875, about 0.25 deep" \
    "$query" "$scratch/boxes.obj"
check "the largest first" grep -q "place 1: .*, big / peg / cap, " "$scratch/out"
check "no third" sh -c "! grep -q 'place 3' '$scratch/out'"
check "no defects of closed boxes" sh -c "! grep -q closed '$scratch/out'"
if [ $have_json -eq 1 ]; then
    check "two in JSON" is 2 'len(places)' "$scratch/boxes.obj"
    check "their objects" is "['one', 'two']" 'places[1]["objects"]' "$scratch/boxes.obj"
    check "and parts" is "[1, 2]" 'places[1]["parts"]' "$scratch/boxes.obj"
    check "pairs add up" is True 'sum(p["pairs"] for p in places) == triangle_pairs' "$scratch/boxes.obj"
    check "triangles are told" is True \
        'all(12 * p["parts"][0] <= t < 12 * p["parts"][-1] + 12 for p in places for t in p["triangle_numbers"])' \
        "$scratch/boxes.obj"
    check "each once" is True \
        'len(set(t for p in places for t in p["triangle_numbers"])) == sum(p["triangles"] for p in places)' \
        "$scratch/boxes.obj"
    check "faces are the file's" is True 'all(p["faces"] <= p["triangles"] and p["faces"] <= 18 for p in places)' \
        "$scratch/boxes.obj"
    check "closed ones" is "6 True" 'str(closed_parts) + " " + str(places[0]["closed"])' "$scratch/boxes.obj"
else
    skip "places in JSON: there is no python3" 8
fi

# Depths do not depend on the side that triangles show, on where the mesh is, or on another axis.
first=1
{
    box one 0 0 0 1 1
    box two 0.75 0.75 0.75 1 1
} >"$scratch/inward.obj"
check "as deep inside out" says 1 "about 0.25 deep" "$query" "$scratch/inward.obj"
for order in "\$2, \$4, \$3" "\$4, \$2, \$3" "\$3 + 5000, \$4, \$2"; do
    awk "\$1 == \"v\" { print \"v\", $order; next } { print }" "$scratch/boxes.obj" >"$scratch/turned.obj"
    check "as deep with $order" says 1 "place 2: .*, one / two, .* about 0.25 deep" "$query" "$scratch/turned.obj"
done
# A peg through a wall, which no vertex of either is inside of.
first=1
{
    box wall 0 0 0 4
    box peg -1 1 1 6
} | awk '$1 == "v" && ++n > 8 { print "v", $2, 1.5 + ($3 > 3), 1.5 + ($4 > 3); next } { print }' >"$scratch/peg.obj"
check "no vertex is inside" says 1 "place 1: .*, wall / peg, .* at [0-9.]* [0-9.]* [0-9.]*$" "$query" "$scratch/peg.obj"
# An open part in a closed one: its vertex in the middle is 1 below the nearest face.
first=1
{
    box wall 0 0 0 4
    printf 'o leaf\nv 1 2 2\nv 9 1 2\nv 9 3 2\nf 9 10 11\n'
} >"$scratch/leaf.obj"
check "an open part in a closed one" says 1 "about 1 deep" "$query" "$scratch/leaf.obj"
# A tube through itself, of one part; its radius is 0.25 or so.
check "a part in itself" says 1 "^    place 1: 80 faces, 100 pairs, .*, about 0.2[0-9]* deep$" \
    "$query" meshes/figure_eight_tube.obj
check "touching is not deep" says 1 "about 0 deep" "$query" meshes/touching_cubes.obj
check "cloths have no inside" says 1 "place 1: 52 faces, 51 pairs, part 0 / part 1, [^,]*$" \
    "$query" meshes/crossing_cloths.obj
check "nor do they of edges" says 1 "place 1: .* 52 pairs, part 0 / part 1" \
    "$query" --pairs edge meshes/crossing_cloths.obj

# Many places: rows of crossing leaves.
awk 'BEGIN { for (i = 0; i < 9; i++) { x = 10 * i
    print "v", x, 0, 0; print "v", x + 2, 0, 0; print "v", x, 2, 0
    print "v", x + .5, .5, -1; print "v", x + .5, .5, 1; print "v", x + 1, .5, 0
    print "f", 6 * i + 1, 6 * i + 2, 6 * i + 3; print "f", 6 * i + 4, 6 * i + 5, 6 * i + 6 } }' >"$scratch/rows.obj"
check "more than are printed" says 1 "^    and 4 smaller places$" "$query" "$scratch/rows.obj"
check "one triangle each" grep -q "place 5: 2 faces, 1 pairs" "$scratch/out"
[ $have_json -eq 0 ] || check "JSON has all" is "9 1" 'str(len(places)) + " " + str(max(p["pairs"] for p in places))' "$scratch/rows.obj"

# ---- by another program: places and defects of meshes, from their files and lists of pairs ----

cat >"$scratch/oracle.py" <<'EOT'
"""Compares places and defects in JSON with what the mesh and its pairs say, by sets and fractions."""
import collections
import csv
import json
import sys
from fractions import Fraction

mesh, pairs, answer, kind = sys.argv[1:5]
points, faces = [], []
for line in open(mesh, encoding="latin-1"):
    words = line.split()
    if words and words[0] == "v":
        points.append(tuple(float(x) for x in words[1:4]))
    elif words and words[0] == "f":
        corners = [int(x.split("/")[0]) - 1 for x in words[1:]]
        assert len(corners) == 3
        faces.append(corners)
answer = json.loads(open(answer).readline())

at = [tuple(x + 0.0 for x in p) for p in points]  # vertices at equal positions are one
faces = [tuple(at[v] for v in face) for face in faces]


class Sets:
    def __init__(self):
        self.sets = {}

    def find(self, x):
        self.sets.setdefault(x, {x})
        return self.sets[x]

    def join(self, x, y):
        one, other = self.find(x), self.find(y)
        if one is other:
            return
        one |= other
        for z in other:
            self.sets[z] = one

    def all(self):
        return {id(one): one for one in self.sets.values()}.values()


sets, count, by_vertex = Sets(), collections.Counter(), collections.defaultdict(set)
found = []
for row in list(csv.reader(open(pairs)))[1:]:
    a, b = int(row[-2]), int(row[-1])
    a = a // 3 if kind == "edge" else a
    found.append(a)
    sets.join(a, b)
    for t in (a, b):
        for v in faces[t]:
            by_vertex[v].add(t)
for together in by_vertex.values():
    for t in together:
        sets.join(t, min(together))
for a in found:
    count[min(sets.find(a))] += 1
wanted = sorted((tuple(sorted(one)), count[min(one)]) for one in sets.all())
got = sorted((tuple(one["triangle_numbers"]), one["pairs"]) for one in answer["places"])
assert wanted == got, (wanted, got)
sizes = [one["faces"] for one in answer["places"]]
assert sizes == sorted(sizes, reverse=True), sizes

edges, same, parts = collections.defaultdict(list), collections.Counter(), Sets()
flat = 0
for face in faces:
    a, b, c = ([Fraction(x) for x in p] for p in face)
    u, v = ([q - r for q, r in zip(p, a)] for p in (b, c))
    flat += all(u[i] * v[j] == u[j] * v[i] for i, j in ((0, 1), (1, 2), (2, 0)))
    for p in face:
        parts.join(face[0], p)
    if len(set(face)) < 3:
        continue
    same[frozenset(face)] += 1
    for p, q in zip(face, face[1:] + face[:1]):
        edges[frozenset((p, q))].append(p < q)
kinds = collections.Counter(
    "open" if len(sides) == 1 else "many" if len(sides) > 2 else "same" if sides[0] == sides[1] else "fine"
    for sides in edges.values())
defects = answer["defects"]
assert defects["open_edges"] == kinds["open"], (defects, kinds)
assert defects["non_manifold_edges"] == kinds["many"], (defects, kinds)
assert defects["misoriented_edges"] == kinds["same"], (defects, kinds)
assert defects["degenerate_faces"] == flat, (defects, flat)
assert defects["duplicate_faces"] == sum(same.values()) - len(same), (defects, same)
assert answer["components"] == len(parts.all()) == len(answer["parts"])
broken = [edge for edge, sides in edges.items() if len(sides) != 2]
edgy = {id(parts.find(p)) for edge in edges for p in edge}
assert answer["closed_parts"] == len(edgy - {id(parts.find(p)) for edge in broken for p in edge})
print(len(wanted), "places")
EOT
agrees() { # FILE KIND
    "$query" --pairs "$2" --json --out "$scratch/pairs.csv" "$1" >"$scratch/json"
    test $? -le 1 && "$python" "$scratch/oracle.py" "$1" "$scratch/pairs.csv" "$scratch/json" "$2"
}
# soup SEED TRIANGLES GRID: triangles with corners on a grid, so that they touch, repeat and are
# flat.
soup() {
    awk -v seed="$1" -v n="$2" -v grid="$3" 'BEGIN { srand(seed)
        for (i = 0; i < 3 * n; i++) { if (i % 3 == 0) { x = int(rand() * grid); y = int(rand() * grid); z = int(rand() * grid) }
            print "v", x + int(rand() * 3), y + int(rand() * 3), z + int(rand() * 3) }
        for (i = 0; i < n; i++) print "f", 3 * i + 1, 3 * i + 2, 3 * i + 3 }'
}
if [ $have_json -eq 1 ]; then
    for kind in triangle edge; do
        for file in meshes/*.obj "$scratch/rows.obj"; do
            check "$kind pairs of ${file##*/}" agrees "$file" $kind
        done
        for seed in 1 2 3 4 5 6 7 8; do
            soup $seed 150 $((4 * seed)) >"$scratch/soup.obj"
            check "$kind pairs of soup $seed" agrees "$scratch/soup.obj" $kind
        done
    done
else
    skip "places and defects by another program: there is no python3" 50
fi

# Several threads say the same, of places, depths and defects; but for times and settings.
same_by_threads() { # FILE
    for threads in 1 2 3; do
        "$query" --threads $threads --json "$1" | sed 's/"[a-z_]*_ms":[^,]*,//g' >"$scratch/by$threads"
    done
    grep -q '"defects"' "$scratch/by1" && cmp "$scratch/by1" "$scratch/by2" && cmp "$scratch/by1" "$scratch/by3"
}
for file in meshes/*.obj "$scratch/boxes.obj" "$scratch/leaf.obj" "$scratch/rows.obj" "$scratch/inward.obj"; do
    check "${file##*/} by several threads" same_by_threads "$file"
done
for seed in 1 2 3 4; do
    soup $seed 400 $((4 * seed)) >"$scratch/soup.obj"
    check "soup $seed by several threads" same_by_threads "$scratch/soup.obj"
done

# Sizes at the ends of what doubles hold: no depth or a number, and no more.
for scale in 1e300 1e154 1e-160 1e-305; do
    awk -v scale=$scale '$1 == "v" { printf "v %.17g %.17g %.17g\n", $2 * scale, $3 * scale, $4 * scale; next } { print }' \
        meshes/touching_cubes.obj >"$scratch/scaled.obj"
    check "cubes times $scale" says 1 "place 1: 12 faces" "$query" "$scratch/scaled.obj"
    check "as a page" status 1 "$query" --html "$scratch/scaled.html" "$scratch/scaled.obj"
done

# ---- only collisions, and what else leaves them out ----

check "only collisions" status 1 "$query" --only self-collisions "$scratch/rows.obj"
check "is two lines" test "$(wc -l <"$scratch/out")" -eq 2
check "only something else" says 2 "only" "$query" --only places "$scratch/rows.obj"
check "any is one row too" status 1 "$query" --any "$scratch/rows.obj"
check "of two lines" test "$(wc -l <"$scratch/out")" -eq 2
check "not of steps" says 2 "only" "$query" --step --only self-collisions "$scratch/rows.obj" "$scratch/rows.obj"
check "poses of a rest mesh" says 1 "place 1: 52 faces" \
    "$query" --rest meshes/crossing_cloths.obj meshes/crossing_cloths.obj
"$SC_BIN/sc-partition" meshes/crossing_cloths.obj -o "$scratch/cloths.scm" >/dev/null
check "and of a saved model" says 1 "place 1: 52 faces" \
    "$query" --model "$scratch/cloths.scm" meshes/crossing_cloths.obj
check "nothing ignored is a place" sh -c \
    "'$query' --out '$scratch/own.csv' '$scratch/boxes.obj' >/dev/null; '$query' --ignore '$scratch/own.csv' '$scratch/boxes.obj' | grep -c place | grep -qx 0"

# ---- defects ----

# defects FILE WORDS: they are listed, and the exit status is that of collisions alone.
line() {
    "$query" "$1" | grep -e closed | sed 's/^ *//' >"$scratch/line"
    echo "$2" | diff - "$scratch/line"
}
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n' >"$scratch/square.obj"
check "open edges" line "$scratch/square.obj" "open edges 4; 0 of 1 parts closed"
check "are no collision" status 0 "$query" "$scratch/square.obj"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n' >"$scratch/turned.obj"
check "inconsistent orientation" line "$scratch/turned.obj" \
    "open edges 4, misoriented edges 1; 0 of 1 parts closed"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 2 1 5\n' >"$scratch/book.obj"
check "non-manifold edges" line "$scratch/book.obj" \
    "open edges 6, non-manifold edges 1; 0 of 1 parts closed"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nf 1 2 3\nf 3 2 4\n' >"$scratch/twice.obj"
check "duplicate faces, also the other way round, of joined vertices" \
    line "$scratch/twice.obj" "duplicate faces 1; 1 of 1 parts closed"
check "which are not where none are joined" sh -c \
    "'$query' --weld none '$scratch/twice.obj' | grep -q 'open edges 4; 0 of 1'"
# Three points of a line; some that are nearly on one, or that differences in doubles would put
# there or take away from it; and a face with a vertex twice.
printf 'v 0.125 0.25 0.5\nv 0.25 0.5 1\nv 0.5 1 2\nf 1 2 3\n' >"$scratch/flat.obj"
check "degenerate faces" line "$scratch/flat.obj" "open edges 3, degenerate faces 1; 0 of 1 parts closed"
printf 'v 0 0 0\nv 1 1 1e-300\nv 3 3.0000000000000004 0\nf 1 2 3\nv 5 0 0\nv 6 1e-150 0\nv 7 0 0\nf 4 5 6\n' >"$scratch/nearly.obj"
check "nearly flat ones are not" line "$scratch/nearly.obj" "open edges 6; 0 of 2 parts closed"
printf 'v 1 1 0\nv 2 2 0\nv 1e-18 0 0\nf 1 2 3\n' >"$scratch/exact.obj"
check "nor one that rounds to flat" line "$scratch/exact.obj" "open edges 3; 0 of 1 parts closed"
printf 'v 0.10534066161402578 0.31602198484207733 0\nv 0.2753918260135757 0.8261754780407271 0\nv 7.9651518515639985 23.895455554691996 0\nf 1 2 3\n' >"$scratch/line.obj"
check "one that rounds to an area is flat" line "$scratch/line.obj" \
    "open edges 3, degenerate faces 1; 0 of 1 parts closed"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\nf 1 2 3\n' >"$scratch/same.obj"
check "a vertex twice" line "$scratch/same.obj" "open edges 3, degenerate faces 1; 0 of 1 parts closed"
check "a ball has none" sh -c "! '$query' meshes/sphere.obj | grep closed"
check "a strip of Moebius" line meshes/moebius.obj "open edges 120, misoriented edges 4; 0 of 1 parts closed"
first=1
{
    box one 0 0 0 1
    box two 5 0 0 1
    printf 'o lid\nv 9 0 0\nv 10 0 0\nv 9 1 0\nf 17 18 19\n'
} >"$scratch/parts.obj"
check "parts" line "$scratch/parts.obj" "open edges 3; 2 of 3 parts closed"
if [ $have_json -eq 1 ]; then
    check "each part in JSON" is "[('one', True, 12), ('two', True, 12), ('lid', False, 1)]" \
        '[(p["object"], p["closed"], p["triangles"]) for p in parts]' "$scratch/parts.obj"
    check "defects in JSON" is 3 'defects["open_edges"]' "$scratch/parts.obj"
fi

# ---- colours ----

"$query" --ply "$scratch/colored.ply" "$scratch/boxes.obj" >/dev/null
colors() { # what colours faces have, but grey
    tail -c $((16 * 72)) "$1" | od -An -v -tu1 -w16 | awk '{ print $14, $15, $16 }' | grep -v '^200 200 200$' | sort -u
}
check "a colour for each place" test "$(colors "$scratch/colored.ply" | wc -l)" -eq 2
check "the first is red" sh -c "tail -c $((16 * 36)) '$scratch/colored.ply' | od -An -v -tu1 -w16 | grep -q ' 220  30  30$'"
check "also with --only" sh -c "'$query' --only self-collisions --ply '$scratch/only.ply' '$scratch/boxes.obj' >/dev/null
    cmp '$scratch/colored.ply' '$scratch/only.ply'"

finish
