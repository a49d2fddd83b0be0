#!/bin/sh
# sc-query --near --thickness: plates of known thickness, gaps, folds and closed boxes; the
# histogram, percentiles, JSON and colours; and what it refuses. tests/bench/test_thickness.c
# compares single triangles with the definition.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi

# A closed box of A by B by C cells of size S, each of two triangles, or of one square.
box() { # FILE A B C S [square]
    awk -v a="$2" -v b="$3" -v c="$4" -v s="$5" -v square="${6:-}" '
        function v(x, y, z) {
            if (!((x, y, z) in n)) { n[x, y, z] = ++count; print "v", x * s, y * s, z * s }
            return n[x, y, z]
        }
        function face(p, q, r, t) {
            if (square) { print "f", p, q, r, t; return }
            print "f", p, q, r
            print "f", p, r, t
        }
        BEGIN {
            for (k = 0; k < 2; k++) {
                for (x = 0; x < a; x++) for (y = 0; y < b; y++)
                    face(v(x, y, k * c), v(x + 1, y, k * c), v(x + 1, y + 1, k * c), v(x, y + 1, k * c))
                for (x = 0; x < a; x++) for (y = 0; y < c; y++)
                    face(v(x, k * b, y), v(x + 1, k * b, y), v(x + 1, k * b, y + 1), v(x, k * b, y + 1))
                for (x = 0; x < b; x++) for (y = 0; y < c; y++)
                    face(v(k * a, x, y), v(k * a, x + 1, y), v(k * a, x + 1, y + 1), v(k * a, x, y + 1))
            }
        }' >"$1"
}
slab=$scratch/slab.obj
box "$slab" 16 16 2 0.125
box "$scratch/box.obj" 8 8 8 0.125
box "$scratch/squares.obj" 16 16 2 0.125 square
thick() {
    "$query" --thickness --near "$@"
}

# ---- what it finds ----

# A plate of 2 by 2 by 0.25: 1280 triangles, of which 68 a side are within 0.125 of the rim, where
# paths round it are short.
check "a plate a little thicker than the distance" says 1 "more than  *0.249 *1280  ####*$" thick 0.249 "$slab"
check "a plate as thick" says 1 "^    *0.234375 to  *0.25 *1020  ####*$" thick 0.25 "$slab"
check "all but its rim" grep -q "more than  *0.25  *260  ###*$" "$scratch/out"
check "no bin has more" test "$(grep -c "to .* 0$" "$scratch/out")" -eq 15
check "of which there are sixteen" test "$(grep -c "^    .* to " "$scratch/out")" -eq 16
check "percentiles" grep -qx "    percent   *1  *5  *25  *50  *75  *95  *99" "$scratch/out"
check "and their values" grep -qx "    thickness   *0.25  *0.25  *0.25  *0.25  *0.25  *more  *more" "$scratch/out"
check "a larger distance" says 1 "^    *0.24375 to  *0.2625 *780  ###*$" thick 0.3 "$slab"
for distance in 0.1 0.2 0.3 0.5 0.9; do
    check "a closed box within $distance" says 1 "more than  *$distance  *768  ####*$" \
        thick $distance "$scratch/box.obj"
done
check "where nothing is near" says 0 "more than  *0.01  *768  ###*$" thick 0.01 "$scratch/box.obj"
# Two boxes side by side: a gap counts as a wall does, for the 128 triangles on each side of it, and
# for 64 round the corner, which have vertices on its rim.
{ cat "$scratch/box.obj"; awk '$1 == "v" { print "v", $2 + 1.25, $3, $4 }
    $1 == "f" { print "f", $2 + 386, $3 + 386, $4 + 386 }' "$scratch/box.obj"; } >"$scratch/two.obj"
check "a gap" says 1 "0.234375 to  *0.25  *384  ###*$" thick 0.25 "$scratch/two.obj"
# A sheet of 20 cells a side, flat, and folded over with 0.5 between its halves.
sheet() { # FILE FOLD
    awk -v fold="$2" 'BEGIN { n = 20
        for (y = 0; y <= n; y++) for (x = 0; x <= n; x++)
            if (fold && x > 10) print "v", 20.25 - x, y, 0.5; else print "v", x, y, 0
        for (y = 0; y < n; y++) for (x = 1; x <= n; x++) {
            a = y * (n + 1) + x; print "f", a, a + 1, a + n + 1; print "f", a + 1, a + n + 2, a + n + 1 } }' >"$1"
}
sheet "$scratch/flat.obj" 0
sheet "$scratch/fold.obj" 1
check "a flat sheet has no thickness" says 1 "more than  *3  *800  ###*$" thick 3 "$scratch/flat.obj"
check "folded, it has" says 1 "^    *0.5 to  *0.5625  *[1-9][0-9]*  ###*$" thick 1 "$scratch/fold.obj"
check "squares, each once" says 1 "^    *0.234375 to  *0.25 *512  ####*$" thick 0.25 "$scratch/squares.obj"
check "one kind of pair" says 1 "^    *0.234375 to  *0.25 *1020  ####*$" \
    thick 0.25 --kinds vertex-face "$slab"
check "pairs that are left out" says 0 "more than  *0.3  *1280" thick 0.3 --ignore-rings 30 "$slab"
check "pairs of a pose" says 1 "more than  *0.25  *260  ###*$" thick 0.25 --rest "$slab" "$slab"
if [ -x "$SC_BIN/sc-partition" ]; then
    "$SC_BIN/sc-partition" "$slab" -o "$scratch/model" >/dev/null 2>&1
    check "with a saved model" says 1 "more than  *0.25  *260  ###*$" \
        thick 0.25 --model "$scratch/model" "$slab"
fi
# Each triangle with corners of its own, which are joined; and vertices of no triangle before them.
awk '$1 == "v" { v[++n] = $0 } $1 == "f" { for (i = 2; i < 5; i++) print v[$i]; f++ }
    END { for (i = 0; i < f; i++) print "f", 3 * i + 1, 3 * i + 2, 3 * i + 3 }' "$slab" >"$scratch/corners.obj"
check "corners that are joined" says 1 "more than  *0.25  *260  ###*$" thick 0.25 "$scratch/corners.obj"
check "or not: then no path leads on" says 1 "more than  *0.25  *0$" thick 0.25 --weld none "$scratch/corners.obj"
awk '$1 == "v" { v[++n] = $0 } $1 == "f" { f[++m] = $0 }
    END { for (i = 1; i <= n; i++) print v[i]
        for (i = 1; i <= n; i++) print v[i]
        for (i = 1; i <= m; i++) { split(f[i], k); print "f", k[2] + n, k[3] + n, k[4] + n } }' \
    "$slab" >"$scratch/unused.obj"
check "vertices of no triangle at the same places" says 1 "more than  *0.25  *260  ###*$" \
    thick 0.25 "$scratch/unused.obj"

# ---- JSON and colours ----

check "JSON" says 1 '"thickness":{"limits":\[0,.*"counts":\[0,.*,1020\],"more":260,"percentiles":{"1":0.25,.*"95":null,"99":null},"faces":\[' \
    thick 0.25 --json "$slab"
check "a mesh in colours" status 1 thick 0.3125 --ply "$scratch/thick.ply" "$slab"
check "the mesh as it was" says 1 "more than  *0.25  *260  ###*$" thick 0.25 "$scratch/thick.ply"
if ! command -v python3 >/dev/null 2>&1; then
    skip "values and colours of all faces: there is no python3" 2
else
    status 1 thick 0.3125 --json "$slab"
    check "values of all faces" python3 - "$scratch/out" "$slab" "$scratch/thick.ply" <<'EOP'
import json
import math
import struct
import sys

points, faces = [], []
for line in open(sys.argv[2]):
    words = line.split()
    (points if words[0] == "v" else faces).append([float(x) for x in words[1:]])
one = json.load(open(sys.argv[1]))
found = one["thickness"]
values, limits = found["faces"], found["limits"]
assert len(values) == len(faces) == one["faces"]
assert limits == [0.3125 * i / 16 for i in range(17)], limits
for value, face in zip(values, faces):
    corners = [points[int(v) - 1] for v in face]
    middle = [sum(p[k] for p in corners) / 3 for k in range(3)]
    inner = min(middle[0], middle[1], 2 - middle[0], 2 - middle[1])
    if len({p[2] for p in corners}) > 1:  # the rim itself
        assert value is None, (value, corners)
    elif inner > 0.375:
        assert value == 0.25, (value, corners)
    else:
        assert value is None or 0.25 <= value <= 0.3125, (value, corners)
known = sorted(v for v in values if v is not None)
assert found["more"] == values.count(None) > 0
for i, count in enumerate(found["counts"]):
    assert count == sum(limits[i] <= v < limits[i + 1] or (i == 15 and v == limits[16]) for v in known)
ranked = known + [None] * found["more"]
for name, value in found["percentiles"].items():
    assert value == ranked[math.ceil(len(ranked) * int(name) / 100) - 1], name
head, body = open(sys.argv[3], "rb").read().split(b"end_header\n", 1)
body = body[len(points) * 3 * (8 if b"double x" in head else 4):]
for t, value in enumerate(values):
    color = struct.unpack("<BIIIBBB", body[16 * t:16 * t + 16])[4:]
    part = None if value is None else value / 0.3125
    wanted = (200,) * 3 if value is None else tuple(
        int(a + part * (b - a) + 0.5) for a, b in ((200, 255), (0, 255), (0, 150)))
    assert color == wanted, (t, value, color, wanted)
EOP
fi

# ---- what is wrong ----

check "without --near" says 2 "are of --near" "$query" --thickness "$slab"
check "any" says 2 "takes all pairs" thick 1 --any "$slab"
check "a budget" says 2 "takes all pairs" thick 1 --budget 9 "$slab"
check "no distance" says 2 "more than 0" thick 0 "$slab"
check "an absent mesh" says 2 "absent" thick 1 "$scratch/absent.obj"

finish
