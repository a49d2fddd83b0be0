#!/bin/sh
# sc-query --trace: contours of meshes whose contours are known; what it prints and writes, the exit
# status, and what it refuses.
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
solids=meshes/crossing_tetrahedra.obj
sheets=meshes/folded_sheet.obj

# Two triangles that cross: from (1, 1, 0), where an edge of the second goes through the first, to
# (3, 1, 0), where its other edge does or not at all, by the height of its top.
frame() { # FILE HEIGHT
    printf 'v 0 0 0\nv 8 0 0\nv 0 8 0\nv 1 1 %s\nv 1 1 -1\nv 5 1 %s\nf 1 2 3\nf 4 5 6\n' \
        "$2" "$2" >"$1"
}
a=$scratch/f0.obj
b=$scratch/f1.obj
c=$scratch/f2.obj
frame "$a" 1
frame "$b" -2
frame "$c" 3

# ---- what it finds ----

check "one segment, 2 long" says 1 "^    contour 1: length 2, 2 nodes, border to border$" \
    "$query" --trace "$a"
check "its row" says 1 "^ *6  *2  *2  *1  *0  *2  .*f0.obj$" "$query" --trace "$a"
check "nothing" says 0 "^ *6  *2  *0  *0  *0  *0  .*f1.obj$" "$query" --trace "$b"
check "two cloths" says 1 "^    contour 1: length [0-9.]*, [0-9]* nodes, border to border$" \
    "$query" --trace "$cloths"
# Of the slanting face, x + y + z = 4, the corner at (0.5, 0.625, 0.75) cuts an equilateral triangle
# of sides 2.125 times the square root of 2.
check "a closed one" says 1 "^    contour 1: length 9.01561, 3 nodes, closed$" \
    "$query" --trace "$solids"
check "a mesh without" status 0 "$query" --trace meshes/sphere.obj
check "several: the longest five" says 1 "^    and 2 shorter contours$" "$query" --trace "$sheets"
check "or all" says 1 "^    contour 7: " "$query" --trace --list "$sheets"
check "none is left then" sh -c "! '$query' --trace --list '$sheets' | grep -q shorter"
check "the longest first" sh -c "'$query' --trace --list '$sheets' |
    sed -n 's/.*length \([0-9.]*\),.*/\1/p' | sort -g -r -c"
check "ends at vertices" says 1 "border to vertex" "$query" --trace "$sheets"

# Three squares' halves that meet in (0, 1, 2).
printf 'v 0 -4 -4\nv 0 12 -4\nv 0 -4 12\nv -4 1 -4\nv 12 1 -4\nv -4 1 12\n' >"$scratch/three.obj"
printf 'v -4 -4 2\nv 12 -4 2\nv -4 12 2\nf 1 2 3\nf 4 5 6\nf 7 8 9\n' >>"$scratch/three.obj"
check "three sheets" says 1 "^    three sheets meet in 1 point$" "$query" --trace "$scratch/three.obj"
check "where they do" says 1 '"triples":\[{"point":\[0,1,2\],"triangles":\[0,1,2\]}\]}' \
    "$query" --trace --json "$scratch/three.obj"
check "not of two" sh -c "! '$query' --trace '$a' | grep -q 'sheets meet'"
check "nor in JSON" says 1 '"triples":\[\]}' "$query" --trace --json "$a"

# ---- poses ----

check "files, each a mesh of its own" says 1 "^3 files: 1 clean, 2 colliding" \
    "$query" --trace "$a" "$b" "$solids"
check "poses" says 1 "^2 files: 1 clean, 1 colliding, 0 refused; first .*f2.obj" \
    "$query" --trace --rest "$a" "$b" "$c"
check "a pattern" says 1 "^3 files: 1 clean, 2 colliding" "$query" --trace "$scratch/f%d.obj"
if [ -x "$SC_BIN/sc-partition" ]; then
    "$SC_BIN/sc-partition" "$a" -o "$scratch/model" >/dev/null 2>&1
    check "a saved model" says 1 "length 1, 2 nodes" "$query" --trace --model "$scratch/model" "$c"
    check "of another mesh" says 2 "vertices" "$query" --trace --model "$scratch/model" "$solids"
fi
printf 'v 0 0 0\nv 8 0 0\nv 0 8 0\nv 1 1 1\nv 1 1 -1\nv 1 1 1\nv 1 1 -1\nv 5 1 1\n' >"$scratch/seam.obj"
printf 'f 1 2 3\nf 4 5 8\nf 6 8 7\n' >>"$scratch/seam.obj"
check "joined" says 1 "^ *6  *3 " "$query" --trace "$scratch/seam.obj"
check "not joined" says 1 "^ *8  *3 " "$query" --trace --weld none "$scratch/seam.obj"

# ---- what it writes ----

without_times() {
    "$query" --trace --json "$@" | sed 's/"[a-z]*_ms":[^,]*,//g'
}
without_times "$sheets" >"$scratch/one"
check "there are contours" grep -q '"contours":\[{"length":' "$scratch/one"
for threads in 2 3; do
    without_times --threads $threads "$sheets" >"$scratch/more"
    check "the same by $threads threads" cmp "$scratch/one" "$scratch/more"
done
check "JSON" says 1 '"type":"trace".*"status":"contours".*"edge_pairs":2,"closed":0,"length":2,' \
    "$query" --trace --json "$a"
check "and of none" says 0 '"status":"clean".*"contours":\[\]' "$query" --trace --json "$b"
check "lines" status 1 "$query" --trace --ply "$scratch/lines.ply" "$a"
cat >"$scratch/lines" <<'EOT'
ply
format ascii 1.0
comment written by starcontour: contours, the longest first
element vertex 2
property double x
property double y
property double z
element edge 1
property int vertex1
property int vertex2
property int contour
end_header
EOT
check "their head" sh -c "head -n 12 '$scratch/lines.ply' | diff '$scratch/lines' -"
check "their ends" sh -c "sed -n 13,14p '$scratch/lines.ply' | sort | tr '\n' ' ' |
    grep -qx '1 1 0 3 1 0 '"
check "the line" sh -c "sed -n 15p '$scratch/lines.ply' | grep -qx '0 1 0'"
"$query" --trace --ply "$scratch/lines.ply" "$solids" >/dev/null
check "a closed one ends where it begins" sh -c "tail -n 1 '$scratch/lines.ply' | grep -qx '2 0 0'"
check "none to write" status 0 "$query" --trace --ply "$scratch/lines.ply" "$b"
check "an empty file of lines" grep -qx "element edge 0" "$scratch/lines.ply"

page=$scratch/page.html
has() { # COUNT WORDS: so many lines of the page have them
    test "$(grep -c "$2" "$page")" -eq "$1"
}
check "a page" status 1 "$query" --trace --html "$page" "$a" "$b"
check "of two frames" has 2 '^<script type="application/json" data-frame='
check "one with a contour" has 1 '"place_count":1,"places":\[{"length":2,"nodes":2,"begin":"border"'
check "and one without" has 1 '"place_count":0,"places":\[\]'
check "of one mesh" has 1 'data-block="mesh-'
check "poses" status 1 "$query" --trace --html "$page" --rest "$a" "$b" "$c"
check "are frames, too" has 2 'data-block="frame-'
check "so are files of a pattern" status 1 "$query" --trace --html "$page" "$scratch/f%d.obj"
check "all of them" has 3 'data-block="frame-'
check "a file that cannot be done" status 2 "$query" --trace --html "$page" "$scratch/absent.obj" "$a"
check "is left out" has 1 'data-block="frame-'
if [ -x "$SC_BIN/sc-partition" ]; then
    check "of a saved model" status 1 "$query" --trace --html "$page" --model "$scratch/model" "$c"
    check "with its contour" has 1 '"places":\[{"length":1,"nodes":2,'
fi
"$query" --trace --json "$sheets" | sed 's/"[a-z]*_ms":[^,]*,//g' >"$scratch/one"
"$query" --trace --json --html "$page" "$sheets" | sed 's/"[a-z]*_ms":[^,]*,//g' >"$scratch/more"
check "with a page the answer is the same" cmp "$scratch/one" "$scratch/more"

if ! command -v python3 >/dev/null 2>&1; then
    skip "nodes, lines and pages, against each other and the mesh: there is no python3"
else
    cat >"$scratch/nodes.py" <<'EOP'
"""Nodes of a mesh are where edges and triangles meet; lines of the file of --ply are theirs.

nodes.py MESH JSON PLY"""
import json
import math
import sys

points, triangles = [], []
with open(sys.argv[1]) as file:
    for line in file:
        words = line.split()
        if words and words[0] == "v":
            points.append([float(x) for x in words[1:4]])
        if words and words[0] == "f":
            triangles.append([int(word.split("/")[0]) - 1 for word in words[1:4]])
with open(sys.argv[2]) as file:
    answer = json.load(file)
assert answer["contours"] and answer["status"] == "contours"
lengths = [contour["length"] for contour in answer["contours"]]
assert lengths == sorted(lengths, reverse=True), lengths
assert math.isclose(sum(lengths), answer["length"], rel_tol=1e-12)
assert sum(c["begin"] == "closed" for c in answer["contours"]) == answer["closed"]


def mix(weights, corners):
    return [sum(w * points[v][k] for w, v in zip(weights, corners)) for k in range(3)]


used = set()
lines, every = [], []
for number, contour in enumerate(answer["contours"]):
    nodes, first = contour["nodes"], len(every)
    closed = contour["begin"] == "closed"
    assert closed == (contour["end"] == "closed")
    for i, node in enumerate(nodes):
        every.append(node["point"])
        assert (node["sheets"] is None) == (i + 1 == len(nodes) and not closed)
        if "vertex" in node:
            assert node["point"] == points[node["vertex"]]
            continue
        triangle, side = divmod(node["edge"], 3)
        ends = [triangles[triangle][side], triangles[triangle][(side + 1) % 3]]
        for there in (mix([1 - node["along"], node["along"]], ends),
                      mix(node["weights"], triangles[node["triangle"]])):
            assert math.dist(there, node["point"]) < 1e-5, (there, node)
        used.add((node["edge"], node["triangle"]))
    pieces = [(first + i, first + i + 1) for i in range(len(nodes) - 1)]
    if closed:
        pieces.append((first + len(nodes) - 1, first))
    total = sum(math.dist(every[i], every[k]) for i, k in pieces)
    assert math.isclose(total, contour["length"], rel_tol=1e-12)
    lines += [(i, k, number) for i, k in pieces]
assert len(used) <= answer["edge_pairs"], (len(used), answer["edge_pairs"])
with open(sys.argv[3]) as file:
    head, body = file.read().split("end_header\n")
rows = body.splitlines()
for row, point in zip(rows, every):
    assert math.dist([float(x) for x in row.split()], point) <= 1e-14, (row, point)
assert [tuple(map(int, row.split())) for row in rows[len(every):]] == lines
assert f"element vertex {len(every)}\n" in head and f"element edge {len(lines)}\n" in head
EOP
    cat >"$scratch/page.py" <<'EOP'
"""A page has the contours of the answer, and of each vertex and side a region; see page_write.h.

page.py JSON PAGE"""
import base64
import json
import re
import sys
import zlib

with open(sys.argv[1]) as file:
    answer = json.load(file)
with open(sys.argv[2], encoding="utf-8") as file:
    text = file.read()
frame = json.loads(re.search(r'data-frame="0">(.*)</script>', text).group(1))
block = re.search(r'data-block="frame-0">(.*)</script>', text).group(1)
data = iter(zlib.decompress(base64.b64decode(block))[6 * frame["vertices"]:])


def number():
    value = shift = 0
    for byte in data:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            return value
    raise AssertionError("the block is too short")


class Steps:
    """Numbers, each told by its difference from the one before."""

    def __init__(self):
        self.last = 0

    def next(self):
        value = number()
        self.last += -(value + 1) // 2 if value % 2 else value // 2
        return self.last


assert frame["vertices"] == answer["vertices_read"]
assert frame["length"] == answer["length"] and frame["closed"] == answer["closed"]
assert frame["place_count"] == frame["drawn"] == len(answer["contours"])
count = number()
smaller = [number() for _ in range(count)]
assert count == frame["regions"] and sum(smaller) == frame["smaller"] and set(smaller) <= {0, 1}
steps = Steps()
regions = [steps.next() for _ in range(frame["vertices"])]
assert all(0 <= region <= count for region in regions)
# Regions are in the order of their lowest vertices; the last ones have none.
seen = list(dict.fromkeys(region for region in regions if region < count))
assert seen == list(range(len(seen))), seen
assert number() == len(answer["contours"])
sides, named = [Steps() for _ in range(4)], set()
for listed, contour in zip(frame["places"], answer["contours"]):
    closed = contour["begin"] == "closed"
    assert number() == 2 * len(contour["nodes"]) + closed
    around = [side.next() for side in sides]
    assert all(0 <= side <= count for side in around)
    pairs = [around[:2], around[2:]]
    divided = [pair for pair in pairs if pair[0] != pair[1]]
    assert len(listed["areas"]) <= len(divided)
    assert len(listed["areas"]) <= sum(smaller[a] or smaller[b] for a, b in divided)
    named.update(side for pair in divided for side in pair)
    assert listed["length"] == contour["length"] and listed["nodes"] == len(contour["nodes"])
    assert (listed["begin"], listed["end"]) == (contour["begin"], contour["end"])
    for k in range(3):
        row = [node["point"][k] for node in contour["nodes"]]
        assert abs(listed["size"][k] - (max(row) - min(row))) < 1e-12
        assert abs(listed["center"][k] - (max(row) + min(row)) / 2) < 1e-12
assert {region for region in range(count) if smaller[region]} <= named
edge, vertex, sheets = Steps(), Steps(), [Steps(), Steps()]
for contour in answer["contours"]:
    for node in contour["nodes"]:
        if edge.next() == 0:
            assert vertex.next() == node["vertex"]
        else:
            assert edge.last == node["edge"] + 1
            assert abs(number() / 65535 - node["along"]) <= 0.5001 / 65535
        if node["sheets"]:
            assert [sheet.next() for sheet in sheets] == node["sheets"]
assert next(data, None) is None, "there is more in the block"
EOP
    for mesh in "$a" "$cloths" "$solids" "$sheets" meshes/touching_cubes.obj; do
        "$query" --trace --json --ply "$scratch/lines.ply" "$mesh" >"$scratch/json"
        check "nodes of $(basename "$mesh")" \
            python3 "$scratch/nodes.py" "$mesh" "$scratch/json" "$scratch/lines.ply"
        "$query" --trace --html "$page" "$mesh" >/dev/null
        check "the page of $(basename "$mesh")" \
            python3 "$scratch/page.py" "$scratch/json" "$page"
    done
fi

# ---- what is wrong ----

check "no mesh" says 2 "no mesh" "$query" --trace
check "an absent one" says 2 absent "$query" --trace "$scratch/absent.obj"
check "as JSON too" says 2 '"type":"trace".*"status":"error"' \
    "$query" --trace --json "$scratch/absent.obj"
check "the others are done" says 2 "2 files: 0 clean, 1 colliding, 1 refused" \
    "$query" --trace "$scratch/absent.obj" "$a"
check "another mesh" says 2 "not a pose" "$query" --trace --rest "$a" meshes/sphere.obj
check "no rest pose" says 2 '"type":"trace","file":".*absent' \
    "$query" --trace --json --rest "$scratch/absent.obj" "$a"
printf 'v 0 0 0\nv 8 0 0\nv 0 8 0\nv 1 1 nan\nv 1 1 -1\nv 5 1 1\nf 1 2 3\nf 4 5 6\n' >"$scratch/nan.obj"
check "not a number" says 2 "nan.obj: .*vertex 3 is NaN or infinite" \
    "$query" --trace --rest "$a" "$scratch/nan.obj"
for option in --proper "--pairs edge" --step "--near 1" "--replay $scratch/x" --times --contacts \
    --any "--only self-collisions" --no-rest-cache "--contour star" "--method sctt" --stats \
    "--budget 9" "--ignore-rings 1" "--ignore $scratch/x" "--ignore-rest 1" "--groups $scratch/x" \
    "--out $scratch/x" "--record $scratch/x" --stencils \
    --thickness "--kinds both" "--jsonl $scratch/x" --timings; do
    # shellcheck disable=SC2086
    check "not with $option" says 2 "does not go with" "$query" --trace ${option} "$a"
done
check "a list of what" says 2 "of --near and --trace" "$query" --list "$a"
check "no folder to write to" says 2 "cannot be written" "$query" --trace --ply "$scratch/no/x" "$a"
check "one mesh to write" says 2 "one mesh" "$query" --trace --ply "$scratch/x.ply" "$a" "$b"
check "nor all of a pattern" says 2 "one mesh" \
    "$query" --trace --ply "$scratch/x.ply" "$scratch/f%d.obj"
check "no folder for a page" says 2 "cannot be written" \
    "$query" --trace --html "$scratch/no/x" "$a"
check "one mesh for a picture" says 2 "one mesh" "$query" --trace --png "$scratch/x.png" "$a" "$b"
check "nor all of a pattern, either" says 2 "png takes one mesh" \
    "$query" --trace --png "$scratch/x.png" "$scratch/f%d.obj"
check "or a page" says 2 "together" \
    "$query" --trace --png "$scratch/x.png" --html "$scratch/x.html" "$a"
check "a picture needs a browser" says 2 "no browser" \
    env SC_BROWSER="$scratch/absent" "$query" --trace --png "$scratch/x.png" "$a"
check "none of these wrote a file" sh -c "! ls '$scratch'/x.*"
check "not over the mesh" says 2 "is to be read" "$query" --trace --ply "$a" "$a"
cp "$a" "$scratch/g1.obj"
check "nor over one of a pattern" says 2 "g1.obj is to be read" \
    "$query" --trace --ply "$scratch/g1.obj" "$scratch/g%d.obj"
check "nor a page" says 2 "g1.obj is to be read" \
    "$query" --trace --html "$scratch/g1.obj" "$scratch/g%d.obj"
check "which is whole" cmp "$a" "$scratch/g1.obj"
finish
