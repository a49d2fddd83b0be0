#!/bin/sh
# sc-query --step: what it finds between frames, what it prints, the exit status, and frames that
# cannot be read.
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
frame "$b" -1
frame "$c" 0.5

# ---- what it finds ----

check "a corner passes a face" says 1 " 1 .* 0 .* 0\.\(4999\|5000\)" "$query" --step "$a" "$b"
check "nothing between one frame and itself" status 0 "$query" --step "$a" "$a"
check "nothing that stays on its side" status 0 "$query" --step "$a" "$c"
check "two steps" says 1 "f1.obj to .*f2.obj" "$query" --step "$a" "$b" "$c"
check "a line for each" test "$(grep -c "^ .* to " "$scratch/out")" -eq 2
check "of three frames" status 1 "$query" --step "$a" "$c" "$b"
check "a pattern" says 1 "f1.obj to .*f2.obj" "$query" --step "$scratch/f%d.obj"
check "nearer than half" status 1 "$query" --step --separation 0.5 "$a" "$c"
check "not nearer than a third" status 0 "$query" --step --separation 0.33 "$a" "$c"
check "any" says 1 "yes" "$query" --step --any "$a" "$b"
check "none of any" says 0 "no" "$query" --step --any "$a" "$c"
for method in sctt two-boxes swept; do
    check "method $method" says 1 " 1 .* 0 " "$query" --step --method $method "$a" "$b"
done
check "star contours" status 1 "$query" --step --contour star "$a" "$b"
check "no contour test: a note" says 0 "can miss" "$query" --step --contour none "$a" "$b"
check "the rest pose of another file" status 1 "$query" --step --rest "$c" "$a" "$b"
check "statistics" says 1 "orientation tests" "$query" --step --stats "$a" "$b"
if [ -x "$SC_BIN/sc-partition" ]; then
    "$SC_BIN/sc-partition" "$a" -o "$scratch/model" >/dev/null 2>&1
    check "a saved model" status 1 "$query" --step --model "$scratch/model" "$a" "$b"
    check "of another mesh" says 2 "vertices" "$query" --step --model "$scratch/model" \
        meshes/sphere.obj meshes/sphere.obj
fi

# ---- threads ----

# A cloth whose right half is folded over the left one, at a slope.
fold() {
    awk -v slope="$2" 'BEGIN { n = 60; for (y = 0; y <= n; y++) for (x = 0; x <= n; x++) {
            u = x / n; b = u - 0.5; if (b < 0) b = 0
            print "v", u - 1.97 * b, y / n, slope * b + (y / n - 0.4) * b / 5 }
        for (y = 0; y < n; y++) for (x = 1; x <= n; x++) {
            a = y * (n + 1) + x; print "f", a, a + 1, a + n + 1; print "f", a + 1, a + n + 2, a + n + 1 } }' >"$1"
}
fold "$scratch/fold0.obj" 0.3
fold "$scratch/fold1.obj" -0.02
by_threads() {
    status 1 "$query" --step --times --out "$scratch/steps.$1" --threads "$1" "$scratch/fold0.obj" \
        "$scratch/fold1.obj"
}
check "pairs by one thread" by_threads 1
check "of which there are many" test "$(wc -l <"$scratch/steps.1")" -gt 500
for threads in 2 3 8; do
    check "pairs by $threads threads" by_threads $threads
    check "are the same, at the same times" cmp "$scratch/steps.1" "$scratch/steps.$threads"
done

# ---- what is left out ----

# A flat cloth with cells of 1.
awk 'BEGIN { n = 30; for (y = 0; y <= n; y++) for (x = 0; x <= n; x++) print "v", x, y, 0
    for (y = 0; y < n; y++) for (x = 1; x <= n; x++) {
        a = y * (n + 1) + x; print "f", a, a + 1, a + n + 1; print "f", a + 1, a + n + 2, a + n + 1 } }' \
    >"$scratch/flat.obj"
thick() {
    "$query" --step --separation 2 "$@" "$scratch/flat.obj" "$scratch/flat.obj"
}
check "a thick cloth at rest" says 1 " 0.0000000 " thick
check "is free but for its rest shape" says 0 " 0  *0 .* 1.0000000 " thick --ignore-rest 2.001
check "nearly" says 1 " 0.0000000 " thick --ignore-rest 1.9
check "with rings" says 0 " 0  *0 .* 1.0000000 " thick --ignore-rings 6
check "with few" says 1 " 0.0000000 " thick --ignore-rings 2
check "JSON says so" says 0 '"ignore_rings":7,.*"ignore_rest":0.5' \
    thick --json --ignore-rings 7 --ignore-rest 0.5
check "a rest shape of another file" says 1 " 1 .* 0 " \
    "$query" --step --ignore-rest 0.1 --rest "$c" "$a" "$b"
check "in which they are near" status 0 "$query" --step --ignore-rest 0.6 --rest "$c" "$a" "$b"
printf 'triangle 0 1 2\ntriangle 1 4 4\n' >"$scratch/groups"
check "groups" says 0 " 0 .* 0 " "$query" --step --groups "$scratch/groups" "$a" "$b"
printf 'vertex 3 1 1\nvertex 0-2 1 1\n' >"$scratch/groups"
check "groups that collide" status 1 "$query" --step --groups "$scratch/groups" "$a" "$b"
printf 'vertex 9 1 1\n' >"$scratch/groups"
check "a group of no vertex" says 2 "no vertex 9" "$query" --step --groups "$scratch/groups" "$a" "$b"
"$query" --step --out "$scratch/all.csv" "$scratch/fold0.obj" "$scratch/fold1.obj" >/dev/null
check "pairs that were found before" status 0 "$query" --step --ignore "$scratch/all.csv" \
    "$scratch/fold0.obj" "$scratch/fold1.obj"
sed '2d' "$scratch/all.csv" >"$scratch/less.csv"
check "all but one" says 1 ' \(1  *0\|0  *1\) ' "$query" --step --ignore "$scratch/less.csv" \
    "$scratch/fold0.obj" "$scratch/fold1.obj"
check "no list of a step" says 2 "line 1: not a pair as --step" \
    "$query" --step --ignore "$scratch/groups" "$a" "$b"
check "an absent list" says 2 "absent" "$query" --step --ignore "$scratch/absent" "$a" "$b"
check "no distance" says 2 "not a number" "$query" --step --ignore-rest x "$a" "$b"
check "only of steps" says 2 "is of --step and --near" "$query" --ignore-rest 1 "$a"

# ---- what it prints ----

check "times" says 1 "vertex-face 3 0 0\.\(4999\|5\)" "$query" --step --times "$a" "$b"
check "JSON" says 1 '"vertex_face_pairs":1,"edge_edge_pairs":0,"collisions":1' \
    "$query" --step --json --times "$a" "$b"
cp "$scratch/out" "$scratch/json"
for key in candidates earliest separation tolerance query_ms candidates_ms method contour start end \
    '"status":"collides"' '"kind":"vertex-face","a":3,"b":0,"time":0.'; do
    check "JSON has $key" grep -q "$key" "$scratch/json"
done
check "closest points" says 1 \
    "^    vertex-face 3 0 0\.[0-9]* start 1 vertex-face 3:-1 0:0.5 1:0.25 2:0.25 vector 0 0 -1 impact [0-9.e-]* vertex-face 3:-1 0:0.5 1:0.25 2:0.25 vector 0 0 -[0-9.e-]* normal 0 0 -1 side 1 approaches$" \
    "$query" --step --stencils "$a" "$b"
check "and once, with times" test "$(grep -c "^    vertex-face" "$scratch/out")" -eq 1
check "from the other side" says 1 " normal 0 0 1 side -1 approaches$" "$query" --step --stencils "$b" "$a"
check "of what stays as near" says 1 " normal 0 0 -1 side 1$" \
    "$query" --step --stencils --separation 0.5 "$c" "$c"
check "JSON of closest points" says 1 \
    '"start":{"distance":1,"feature":"vertex-face","parallel":false,"vertices":\[3,0,1,2\],"weights":\[-1,0.5,0.25,0.25\],"vector":\[0,0,-1\]},"impact":{"distance":.*},"normal":\[0,0,-1\],"side":1,"approaches":true' \
    "$query" --step --json --stencils "$a" "$b"
check "a file of pairs has times alone" status 1 \
    "$query" --step --stencils --out "$scratch/with.csv" "$a" "$b"
status 1 "$query" --step --out "$scratch/without.csv" "$a" "$b"
check "as without closest points" cmp "$scratch/with.csv" "$scratch/without.csv"
check "JSON without collision" says 0 '"status":"clean".*"earliest":1,' "$query" --step --json "$a" "$c"
check "JSON of any" says 1 '"earliest":null' "$query" --step --json --any "$a" "$b"
check "pairs to a file" status 1 "$query" --step --out "$scratch/pairs.csv" "$a" "$b"
check "its heading" grep -qx "start,end,kind,object_a,face_a,object_b,face_b,a,b,time" "$scratch/pairs.csv"
check "its pair" grep -q ",vertex-face,,,,0,3,0,0\." "$scratch/pairs.csv"
check "a budget" says 3 "+" "$query" --step --budget 1 meshes/folded_sheet.obj meshes/folded_sheet.obj

# ---- what is wrong ----

check "one frame" says 2 "two frames" "$query" --step "$a"
check "no frame" says 2 "no mesh" "$query" --step
check "a pattern of nothing" says 2 "number 0 or 1" "$query" --step "$scratch/g%d.obj"
check "no pattern" says 2 "not a pattern" "$query" --step "$scratch/g%s.obj"
check "an absent frame" says 2 absent "$query" --step "$a" "$scratch/absent.obj"
check "an absent first frame" says 2 absent "$query" --step "$scratch/absent.obj" "$a"
check "another mesh" says 2 "not a pose" "$query" --step "$a" meshes/sphere.obj
check "the other steps are done" says 2 "f0.obj to .*f1.obj" \
    "$query" --step "$c" "$scratch/absent.obj" "$a" "$b"
check "each step that it spoils fails" test "$(grep -c absent "$scratch/err")" -eq 2
printf 'v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 nan\nv 2 1 2\nv 1 2 2\nf 1 2 3\nf 4 5 6\n' >"$scratch/nan.obj"
check "not a number" says 2 "nan.obj: vertex 3 is NaN or infinite at the end" \
    "$query" --step --json "$a" "$scratch/nan.obj"
check "as JSON too" grep -q '"status":"error"' "$scratch/out"
check "a mesh that is through itself all the time: no pair" status 0 \
    "$query" --step meshes/crossing_cloths.obj meshes/crossing_cloths.obj
cp "$a" "$scratch/g0.obj"
cp "$b" "$scratch/g1.obj"
check "not over a frame" says 2 "g1.obj is to be read" \
    "$query" --step --out "$scratch/g1.obj" "$scratch/g%d.obj"
check "the frame is whole" cmp "$b" "$scratch/g1.obj"
printf 'v 0 0' >"$scratch/cut.obj"
check "a truncated frame" status 2 "$query" --step "$a" "$scratch/cut.obj"
head -c 300 /dev/urandom >"$scratch/noise.obj"
check "noise" status 2 "$query" --step "$a" "$scratch/noise.obj"
for value in -1 nan inf 1e999 x ''; do
    check "separation '$value'" says 2 "separation" "$query" --step --separation "$value" "$a" "$b"
    check "tolerance '$value'" says 2 "tolerance" "$query" --step --tolerance "$value" "$a" "$b"
done
check "no tolerance" says 2 "tolerance" "$query" --step --tolerance 0 "$a" "$b"
check "a method of queries" says 2 "two-boxes" "$query" --step --method aabb "$a" "$b"
check "a method of steps" says 2 "aabb-sctt" "$query" --method swept "$a"
check "without --step" says 2 "of --step" "$query" --separation 1 "$a"
check "any has no closest points" says 2 "no list" "$query" --step --any --stencils "$a" "$b"
check "closest points of what is sought neither way" says 2 "of --near and --step" \
    "$query" --stencils "$a"
check "any has no times" says 2 "no times" "$query" --step --any --times "$a" "$b"
for option in --proper "--pairs edge" "--ply $scratch/x.ply" \
    "--replay $scratch/x" --contacts --no-rest-cache; do
    # shellcheck disable=SC2086
    check "not with $option" says 2 "does not go with" "$query" --step $option "$a" "$b"
done
check "one step to record" says 2 "two frames" "$query" --step --record "$scratch/x" "$a" "$b" "$a"
check "no folder to write to" says 2 "cannot be written" "$query" --step --out "$scratch/no/x" "$a" "$b"

finish
