#!/bin/sh
# sc-query --near: what it finds, against all pairs one by one in exact fractions; what it prints
# and writes, the exit status, and what it refuses.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi

# Two triangles; a corner of the second is at height z over or under the first.
frame() {
    printf 'v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 %s\nv 2 1 2\nv 1 2 2\nf 1 2 3\nf 4 5 6\n' "$2" >"$1"
}
a=$scratch/f0.obj
b=$scratch/f1.obj
c=$scratch/f2.obj
frame "$a" 1
frame "$b" 0.25
frame "$c" 0.5
frame "$scratch/below.obj" -1
frame "$scratch/g0.obj" 0.25
frame "$scratch/g1.obj" 0.5
frame "$scratch/g2.obj" 0.125

# ---- what it finds ----

check "a corner over a face" says 1 " 1 .* 0 .* -  .*f2.obj$" "$query" --near 0.5 "$c"
check "no farther" says 0 " 0 .* 0 " "$query" --near 0.4999999999999999 "$c"
check "touching" says 1 " 1 " "$query" --near 0 meshes/corner_on_face.obj
check "any" says 1 "yes" "$query" --near 0.5 --any "$c"
check "none of any" says 0 "no" "$query" --near 0.4 --any "$c"
check "one kind" says 1 " 1  *- " "$query" --near 0.5 --kinds vertex-face "$c"
check "the other" says 0 " -  *0 " "$query" --near 0.5 --kinds edge-edge "$c"
for method in auto sctt boxes; do
    check "method $method" says 1 " 1 .* 0 " "$query" --near 0.5 --method $method "$c"
done
check "files, each a mesh of its own" says 1 "^3 files: 1 clean, 2 colliding" \
    "$query" --near 0.5 "$a" "$b" meshes/corner_on_face.obj
check "poses" says 1 "^2 files: 1 clean, 1 colliding, 0 refused; first .*f1.obj" \
    "$query" --near 0.5 --rest "$c" "$a" "$b"
check "a pattern" says 1 "^3 files: 1 clean, 2 colliding" "$query" --near 0.5 "$scratch/f%d.obj"
check "statistics" says 1 "orientation tests" "$query" --near 0.5 --stats "$c"
check "rings leave out neighbours" says 0 " 0 .* 0 " \
    "$query" --near 0.3 --ignore-rings 3 meshes/sphere.obj
check "which are near" status 1 "$query" --near 0.3 meshes/sphere.obj
echo "triangle 1 1 2" >"$scratch/groups"
echo "triangle 0 4 8" >>"$scratch/groups"
check "groups" says 0 " 0 .* 0 " "$query" --near 0.5 --groups "$scratch/groups" "$c"
check "what is near at rest" says 0 " 0 .* 0 " "$query" --near 0.5 --ignore-rest 1 --rest "$a" "$b"
check "or not" says 1 " 1 .* 0 " "$query" --near 0.5 --ignore-rest 0.9999 --rest "$a" "$b"
check "at rest in the first frame" says 0 "^3 files: 3 clean" \
    "$query" --near 0.5 --ignore-rest 0.25 "$scratch/g%d.obj"
check "and in no other" says 1 "^3 files: 0 clean, 3 colliding" \
    "$query" --near 0.5 --ignore-rest 0.2 "$scratch/g%d.obj"
status 1 "$query" --near 0.5 --out "$scratch/known" --stencils "$c" 2>/dev/null
check "a list of what is known" says 0 " 0 .* 0 " "$query" --near 0.5 --ignore "$scratch/known" "$c"
"$query" --step --out "$scratch/known" "$a" "$scratch/below.obj" >/dev/null
check "of a step" says 0 " 0 .* 0 " "$query" --near 0.5 --ignore "$scratch/known" "$c"
"$query" --near 1 --out "$scratch/known" "$a" >/dev/null
check "of what is near, in a step" says 0 " 0 .* 0 " \
    "$query" --step --ignore "$scratch/known" "$a" "$scratch/below.obj"
if [ -x "$SC_BIN/sc-partition" ]; then
    "$SC_BIN/sc-partition" "$a" -o "$scratch/model" >/dev/null 2>&1
    check "a saved model" says 1 " 1 .* 0 " "$query" --near 0.5 --model "$scratch/model" "$c"
    check "at rest in the first file" says 1 " 0 .* 0 .*f2.obj" \
        "$query" --near 0.5 --ignore-rest 0.25 --model "$scratch/model" "$c" "$b"
    check "of another mesh" says 2 "vertices" "$query" --near 1 --model "$scratch/model" meshes/sphere.obj
fi

by_threads() {
    status 1 "$query" --near 0.3 --out "$scratch/near.$1" --threads "$1" meshes/crossing_cloths.obj
}
check "pairs by one thread" by_threads 1
check "of which there are many" test "$(wc -l <"$scratch/near.1")" -gt 500
for threads in 2 3 8; do
    check "pairs by $threads threads" by_threads $threads
    check "are the same" cmp "$scratch/near.1" "$scratch/near.$threads"
done

# ---- what it prints ----

check "a list" says 1 "^    vertex-face 3 0 0.5$" "$query" --near 0.5 --list "$c"
check "the smallest distance" says 1 " 0.5  .*f2.obj$" "$query" --near 7 --list "$c"
check "closest points" says 1 \
    "^    vertex-face 3 0 0.5 vertex-face 3:-1 0:0.5 1:0.25 2:0.25 vector 0 0 -0.5$" \
    "$query" --near 0.5 --stencils "$c"
check "JSON" says 1 '"type":"near".*"status":"near","near":true.*"vertex_face_pairs":1,"edge_edge_pairs":0,"nearest":null' \
    "$query" --near 0.5 --json "$c"
check "JSON of a list" says 1 '"nearest":0.5,.*"kind":"vertex-face","a":3,"b":0,"distance":0.5,"face_a":null' \
    "$query" --near 0.5 --json --list "$c"
check "JSON of closest points" says 1 '"feature":"vertex-face","parallel":false,"vertices":\[3,0,1,2\]' \
    "$query" --near 0.5 --json --stencils "$c"
check "JSON of one kind" says 1 '"edge_edge_pairs":null' "$query" --near 0.5 --json --kinds vertex-face "$c"
check "pairs to a file" status 1 "$query" --near 0.5 --out "$scratch/pairs.csv" "$c"
check "its heading" grep -qx "file,kind,object_a,face_a,object_b,face_b,a,b,distance" "$scratch/pairs.csv"
check "its pair" grep -qx ".*f2.obj,vertex-face,,,,0,3,0,0.5" "$scratch/pairs.csv"
check "a budget" says 3 "+" "$query" --near 1 --budget 1 meshes/folded_sheet.obj
check "a mesh in colours" status 1 "$query" --near 1 --ply "$scratch/near.ply" "$c"
check "the mesh as it was" says 1 " 0.5  .*near.ply$" "$query" --near 7 --list "$scratch/near.ply"

# ---- against all pairs, one by one ----

if ! command -v python3 >/dev/null 2>&1; then
    skip "the answer of brute force: there is no python3"
else
    cat >"$scratch/brute.py" <<'EOP'
"""Compares what sc-query --near prints with all pairs of a mesh, decided in fractions.

brute.py QUERY DISTANCE RINGS MESH MINIMUM: at least so many pairs have to be there."""
import csv
import json
import subprocess
import sys
from fractions import Fraction

query, distance, rings, path, minimum = sys.argv[1:]
limit = Fraction(float(distance)) ** 2


def minus(p, q):
    return [x - y for x, y in zip(p, q)]


def dot(p, q):
    return sum(x * y for x, y in zip(p, q))


def cross(p, q):
    return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]


def point_segment(p, a, b):
    along, offset = minus(b, a), minus(p, a)
    length = dot(along, along)
    t = min(max(dot(offset, along) / length, 0), 1) if length else 0
    gap = [x - t * y for x, y in zip(offset, along)]
    return dot(gap, gap)


def point_triangle(p, a, b, c):
    best = min(point_segment(p, a, b), point_segment(p, b, c), point_segment(p, c, a))
    n = cross(minus(b, a), minus(c, a))
    if any(n) and all(dot(cross(minus(y, x), minus(p, x)), n) >= 0 for x, y in ((a, b), (b, c), (c, a))):
        best = min(best, dot(minus(p, a), n) ** 2 / dot(n, n))
    return best


def segments(a, b, c, d):
    best = min(point_segment(a, c, d), point_segment(b, c, d), point_segment(c, a, b),
               point_segment(d, a, b))
    e, f, w = minus(b, a), minus(d, c), minus(c, a)
    n = cross(e, f)
    if any(n):
        s, t = dot(cross(w, f), n) / dot(n, n), dot(cross(w, e), n) / dot(n, n)
        if 0 <= s <= 1 and 0 <= t <= 1:
            best = min(best, dot(w, n) ** 2 / dot(n, n))
    return best


points, triangles, first = [], [], {}
with open(path) as file:
    for line in file:
        words = line.split()
        if words and words[0] == "v":
            points.append([Fraction(float(x)) for x in words[1:4]])
        if words and words[0] == "f":
            triangles.append([int(word.split("/")[0]) - 1 for word in words[1:4]])
joined = [first.setdefault(tuple(p), i) for i, p in enumerate(points)]
triangles = [[joined[v] for v in t] for t in triangles]
used = sorted({v for t in triangles for v in t})
sides = {tuple(sorted((t[k], t[(k + 1) % 3]))) for t in triangles for k in range(3)}
edges = sorted(side for side in sides if side[0] != side[1])
next_to = {v: set() for v in used}
for u, v in edges:
    next_to[u].add(v)
    next_to[v].add(u)


def within(start, steps):
    """What can be reached by fewer than so many edges."""
    seen, rim = set(start), set(start)
    for _ in range(steps - 1):
        rim = {v for u in rim for v in next_to[u]} - seen
        seen |= rim
    return seen if steps else set()


def apart(one, other):
    """Whether boxes say that two sets of points are farther apart than that."""
    for axis in range(3):
        lows = [min(points[v][axis] for v in part) for part in (one, other)]
        highs = [max(points[v][axis] for v in part) for part in (one, other)]
        gap = max(lows[0] - highs[1], lows[1] - highs[0])
        if gap > 0 and gap * gap > limit:
            return True
    return False


balls = {v: within({v}, int(rings)) for v in used}
wanted = {}
for v in used:
    for t, corners in enumerate(triangles):
        if v in corners or balls[v] & set(corners) or apart([v], corners):
            continue
        square = point_triangle(points[v], *(points[u] for u in corners))
        if square <= limit:
            wanted["vertex-face", v, t] = square
for i, one in enumerate(edges):
    for other in edges[i + 1:]:
        if set(one) & set(other) or (balls[one[0]] | balls[one[1]]) & set(other) or apart(one, other):
            continue
        square = segments(*(points[v] for v in one + other))
        if square <= limit:
            wanted["edge-edge", one, other] = square


def named(edge):
    t, k = divmod(edge, 3)
    return tuple(sorted((triangles[t][k], triangles[t][(k + 1) % 3])))


command = [query, "--near", distance, "--json", "--stencils", path]
if int(rings):
    command[3:3] = ["--ignore-rings", rings]
answer = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=False).stdout)
found, order = {}, []
for pair in answer["pairs"]:
    a, b = pair["a"], pair["b"]
    order.append((pair["kind"] == "edge-edge", a, b))
    if pair["kind"] == "edge-edge":
        assert a < b, pair
        key = ("edge-edge", *sorted((named(a), named(b))))
    else:
        key = ("vertex-face", a, b)
    assert key not in found, pair
    found[key] = pair
assert order == sorted(order)
assert set(found) == set(wanted), (sorted(set(found) ^ set(wanted))[:5], len(found), len(wanted))
assert len(wanted) >= int(minimum), len(wanted)
assert answer["vertex_face_pairs"] + answer["edge_edge_pairs"] == len(wanted), answer
assert answer["near"] == bool(wanted)
size = max((abs(x) for p in points for x in p), default=0)
for key, pair in found.items():
    square = wanted[key]
    assert abs(Fraction(pair["distance"]) ** 2 - square) <= square / 10**14, (pair, float(square))
    vector = [Fraction(x) for x in pair["vector"]]
    assert abs(dot(vector, vector) - square) <= square / 10**14, pair
    for axis in range(3):
        there = sum(Fraction(w) * points[v][axis] for w, v in zip(pair["weights"], pair["vertices"]))
        assert abs(there - vector[axis]) <= size / 10**14, pair
if wanted:
    assert abs(Fraction(answer["nearest"]) ** 2 - min(wanted.values())) <= min(wanted.values()) / 10**14
EOP
    against() { # DISTANCE RINGS MESH MINIMUM
        check "all pairs of $(basename "$3") within $1, rings $2" \
            python3 "$scratch/brute.py" "$query" "$1" "$2" "$3" "$4"
    }
    # A sheet of integers, whose distances are exactly 1, 2 or square roots, and one with a wave.
    sheet() { # FILE CELLS HEIGHT: that as a function of x and y
        awk -v n="$2" 'function h(x, y) { return '"$3"' } BEGIN {
            for (y = 0; y <= n; y++) for (x = 0; x <= n; x++) print "v", x, y, h(x, y)
            for (y = 0; y < n; y++) for (x = 1; x <= n; x++) {
                a = y * (n + 1) + x; print "f", a, a + 1, a + n + 1; print "f", a + 1, a + n + 2, a + n + 1 } }' >"$1"
    }
    sheet "$scratch/flat.obj" 6 0
    sheet "$scratch/wave.obj" 7 '1.5 * sin(x * 1.3 + y / 3)'
    awk 'BEGIN { srand(7); for (i = 0; i < 60; i++) { for (k = 0; k < 3; k++)
        print "v", rand() + k % 2 / 3, rand() + k / 7, rand(); print "f", 3 * i + 1, 3 * i + 2, 3 * i + 3 } }' >"$scratch/soup.obj"
    against 1 0 "$scratch/flat.obj" 500
    against 0.9999999999999999 0 "$scratch/flat.obj" 1
    against 2 2 "$scratch/flat.obj" 20
    against 2 2 "$scratch/wave.obj" 20
    against 1.5 0 "$scratch/wave.obj" 500
    against 0.02 0 "$scratch/soup.obj" 50
    against 0 0 meshes/folded_sheet.obj 50
    against 0 0 meshes/touching_cubes.obj 6
    against 0.5 0 meshes/crossing_tetrahedra.obj 1
    against 0.1 0 meshes/degenerate_soup.obj 1
    against 0.2 2 meshes/seam_cloth.obj 0
    against 0.3 0 meshes/corner_on_face.obj 1
    check "brute force notices a pair too many" sh -c '! python3 "$1" "$2" 0.5 0 "$3" 2' - \
        "$scratch/brute.py" "$query" "$c"

    # Colours: the face below the corner and the corner's own are at half of the way to yellow.
    cat >"$scratch/colors.py" <<'EOP'
import struct
import sys

data = open(sys.argv[1], "rb").read()
head, body = data.split(b"end_header\n", 1)
colors = [struct.unpack("<BIIIBBB", body[-32 + 16 * t:][:16])[4:] for t in range(2)]
assert colors == [(228, 128, 75)] * 2, colors
EOP
    check "colours" python3 "$scratch/colors.py" "$scratch/near.ply"
    # The same with each vertex there twice, of which faces take the second.
    { grep '^v' "$c"; grep '^v' "$c"; printf 'f 7 8 9\nf 10 11 12\n'; } >"$scratch/twice.obj"
    status 1 "$query" --near 1 --ply "$scratch/twice.ply" "$scratch/twice.obj"
    check "colours behind vertices of no face" python3 "$scratch/colors.py" "$scratch/twice.ply"
fi

# ---- what is wrong ----

check "no mesh" says 2 "no mesh" "$query" --near 1
check "an absent one" says 2 absent "$query" --near 1 "$scratch/absent.obj"
check "as JSON too" says 2 '"type":"near".*"status":"error"' "$query" --near 1 --json "$scratch/absent.obj"
check "the others are done" says 2 "2 files: 0 clean, 1 colliding, 1 refused" \
    "$query" --near 0.5 "$scratch/absent.obj" "$c"
check "another mesh" says 2 "not a pose" "$query" --near 1 --rest "$a" meshes/sphere.obj
printf 'v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 nan\nv 2 1 2\nv 1 2 2\nf 1 2 3\nf 4 5 6\n' >"$scratch/nan.obj"
check "not a number" says 2 "nan.obj: .*vertex 3 is NaN or infinite" \
    "$query" --near 1 --rest "$a" "$scratch/nan.obj"
for value in -1 nan inf 1e999 x 0.5e ''; do
    check "distance '$value'" says 2 "near" "$query" --near "$value" "$a"
done
check "a kind that is none" says 2 "vertex-face" "$query" --near 1 --kinds faces "$a"
check "a method of queries" says 2 "boxes" "$query" --near 1 --method aabb "$a"
check "without --near" says 2 "of --near" "$query" --kinds both "$a"
check "any has no list" says 2 "no list" "$query" --near 1 --any --list "$a"
check "nor a file" says 2 "no list" "$query" --near 1 --any --out "$scratch/x" "$a"
for option in --proper "--pairs edge" --step "--replay $scratch/x" --times \
    --contacts --no-rest-cache "--contour star" "--separation 1" "--tolerance 1"; do
    # shellcheck disable=SC2086
    check "not with $option" says 2 "does not go with" "$query" --near 1 $option "$a"
done
check "groups that are not there" says 2 '"type":"near","file":".*absent"' \
    "$query" --near 1 --json --groups "$scratch/absent" "$a"
check "no list of pairs" says 2 "line 1: not a pair" "$query" --near 1 --ignore "$scratch/groups" "$a"
check "a rest pose without --near" says 2 "of --step and --near" "$query" --ignore-rest 1 "$a"
check "no distance at rest" says 2 "ignore-rest" "$query" --near 1 --ignore-rest -1 "$a"
check "no folder to write to" says 2 "cannot be written" "$query" --near 1 --out "$scratch/no/x" "$a"
check "nor to paint" says 2 "cannot be written" "$query" --near 1 --ply "$scratch/no/x" "$a"
check "one mesh to paint" says 2 "one mesh" "$query" --near 1 --ply "$scratch/x.ply" "$a" "$b"
check "one mesh to record" says 2 "one mesh" "$query" --near 1 --record "$scratch/x" "$a" "$b"
check "and of a pattern" says 2 "one mesh" "$query" --near 1 --record "$scratch/x" "$scratch/f%d.obj"
check "not over the mesh" says 2 "is to be read" "$query" --near 1 --record "$a" "$a"
check "nor all of a pattern" says 2 "one mesh" "$query" --near 1 --ply "$scratch/x.ply" "$scratch/f%d.obj"
cp "$a" "$scratch/g1.obj"
check "not over a mesh" says 2 "g1.obj is to be read" \
    "$query" --near 1 --out "$scratch/g1.obj" "$scratch/g%d.obj"
check "which is whole" cmp "$a" "$scratch/g1.obj"

finish
