#!/bin/sh
# Many meshes by sc-query --near --jsonl: what lines say, against --json; the same bytes by several
# processes, in shards and in runs that are killed; and files that are not gone on with. What holds
# for lines of either question is in test_batches.sh.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi
query=$(cd "$SC_BIN" && pwd)/sc-query
top=$(pwd)
out=$scratch/out.jsonl
list=$scratch/list
whole=$scratch/whole.jsonl

# 60 meshes: five of them again and again, and one that is not there.
for i in $(seq 10); do
    for mesh in crossing_cloths sphere folded_sheet touching_cubes moebius; do
        echo "$top/meshes/$mesh.obj"
    done
    echo "$scratch/absent.obj"
done >"$list"
batch() { # FILE OPTION...
    to=$1
    shift
    "$query" --near 0.1 --thickness --jsonl "$to" --manifest "$list" "$@"
}

# ---- lines ----

check "all meshes" says 2 \
    "^60 files: [0-9]* clean, [0-9]* colliding, 10 refused; first .*cloths.obj; worst .* pairs)" batch "$whole"
check "nothing on standard error" test ! -s "$scratch/err"
check "a line each" test "$(wc -l <"$whole")" -eq 60
check "in order" sh -c "sed 's/.*\"file\":\"\([^\"]*\)\".*/\1/' '$whole' | cmp - '$list'"
check "all of one type" test "$(grep -c '"type":"near"' "$whole")" -eq 60
check "refused ones say why" grep -q 'absent.obj","status":"error","error":"[^"]*No such file' "$whole"
check "no times" sh -c "! grep _ms '$whole'"
check "neither pairs nor values of faces" sh -c "! grep -e '\"pairs\":\[' -e '\"faces\":\[' '$whole'"
check "the status of one" status 0 "$query" --near 0.01 --jsonl "$scratch/one.jsonl" meshes/sphere.obj
check "the sum as JSON" says 1 '"files":2,"clean":0,"colliding":2,.*"worst":{"index":1,.*"pairs":248}' \
    "$query" --near 0.3 --json --jsonl "$scratch/two.jsonl" meshes/corner_on_face.obj meshes/folded_sheet.obj
check "of both kinds" grep -q '"vertex_face_pairs":59,"edge_edge_pairs":189,' "$scratch/two.jsonl"
check "any" says 1 "^2 files: 1 clean, 1 colliding, 0 refused; first .*cubes.obj$" "$query" --near 0.01 \
    --any --jsonl "$scratch/any.jsonl" meshes/sphere.obj meshes/touching_cubes.obj
check "counts nothing" grep -q '"vertex_face_pairs":null,"edge_edge_pairs":null,"nearest":null' "$scratch/any.jsonl"
check "poses of a mesh" says 1 "^2 files: 0 clean, 2 colliding" "$query" --near 0.3 --rest meshes/sphere.obj \
    --ignore-rest 0.1 --jsonl "$scratch/poses.jsonl" meshes/sphere.obj meshes/sphere.obj
check "which lines name" grep -q '"rest":"meshes/sphere.obj","ignore_rest":0.1' "$scratch/poses.jsonl"
check "a rest mesh that is not there" says 2 "absent.obj: No such file" \
    "$query" --near 1 --rest "$scratch/absent.obj" --jsonl "$scratch/none.jsonl" meshes/sphere.obj
check "ends the run before it begins" test ! -s "$scratch/out" -a ! -e "$scratch/none.jsonl"
check "a budget" says 3 ", 2 incomplete" "$query" --near 1 --budget 1 \
    --jsonl "$scratch/budget.jsonl" meshes/folded_sheet.obj meshes/corner_on_face.obj
check "has no smallest distance" grep -q '"status":"incomplete".*"nearest":null.*"budget":1' "$scratch/budget.jsonl"
check "times, if asked for" status 1 \
    "$query" --near 1 --jsonl "$scratch/times.jsonl" --timings --stats meshes/sphere.obj
check "and statistics" grep -q '"build_ms":.*"stats":' "$scratch/times.jsonl"
if command -v python3 >/dev/null 2>&1; then
    cat >"$scratch/compare.py" <<'EOP'
"""Whether the first six lines are objects of --json --list, but for what is too long."""
import json
import subprocess
import sys

query, path = sys.argv[1:]
for line in list(open(path))[:6]:
    got = json.loads(line)
    command = [query, "--near", "0.1", "--thickness", "--json", "--list", got["file"]]
    answer = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    expected = json.loads(answer.stdout)
    for name in ("build_ms", "query_ms"):
        expected.pop(name, None)
    pairs = expected.pop("pairs", None)
    if pairs is not None:
        assert len(pairs) == got["vertex_face_pairs"] + got["edge_edge_pairs"]
        assert got["nearest"] == min((pair["distance"] for pair in pairs), default=None)
        expected["thickness"].pop("faces")
    assert got == expected, (got, expected)
EOP
    check "lines are what --json says" python3 "$scratch/compare.py" "$query" "$whole"
else
    skip "lines against --json: there is no python3"
fi
python=
for one in python3 /usr/bin/python3; do
    "$one" -c 'import jsonschema; jsonschema.Draft202012Validator' >/dev/null 2>&1 && python=$one && break
done
if [ -z "$python" ]; then
    skip "lines against their schema: there is no python3 with jsonschema 4"
else
    cat "$whole" "$scratch/any.jsonl" "$scratch/poses.jsonl" "$scratch/budget.jsonl" \
        "$scratch/times.jsonl" >"$scratch/lines"
    check "lines are as the schema says" "$python" -c 'import json, sys, jsonschema
validator = jsonschema.Draft202012Validator(json.load(open("tools/starcontour.schema.json")))
for line in open(sys.argv[1]): assert validator.is_valid(json.loads(line)), line' "$scratch/lines"
fi

# ---- the same bytes ----

fresh() {
    rm -f "$out"
    status 2 batch "$out" "$@" && cmp "$out" "$whole"
}
check "again the same bytes" fresh
check "by several processes" fresh --jobs 5
shards() { # N
    rm -f "$scratch"/shard.*
    for i in $(seq "$1"); do
        batch "$scratch/shard.$i" --shard "$i/$1" >/dev/null 2>&1
        test $? -lt 3 || return 1
    done
    for i in $(seq "$1"); do cat "$scratch/shard.$i"; done | cmp - "$whole"
}
check "seven shards" shards 7
# lines FILE N: waits until it has so many.
lines() {
    for wait in $(seq 400); do
        [ -e "$1" ] && [ "$(wc -l <"$1")" -ge "$2" ] && return 0
        sleep 0.05
    done
    echo "waited $wait times for line $2"
    return 1
}
killed() { # JOBS
    rm -f "$out"
    for stop in 1 7 30 59; do
        "$query" --near 0.1 --thickness --jsonl "$out" --manifest "$list" --jobs "$1" --resume \
            >/dev/null 2>&1 &
        lines "$out" $stop || return 1
        kill -KILL $!
        wait $!
        cut=$(wc -c <"$out")
        cmp -n "$cut" "$out" "$whole" || return 1
    done 2>/dev/null
    says 2 "^60 files: .* 10 refused; first .*cloths.obj; worst" batch "$out" --resume --jobs "$1" &&
        cmp "$out" "$whole"
}
check "killed four times" killed 1
check "killed four times, of three processes" killed 3
status 2 batch "$scratch/sum.jsonl"
cp "$scratch/out" "$scratch/sum"
check "resumed when all is done" status 2 batch "$out" --resume
check "the sum is that of one run" cmp "$scratch/out" "$scratch/sum"
head -c 500 "$whole" >"$out"
check "a file that was cut" status 2 batch "$out" --resume
check "is whole again" cmp "$out" "$whole"

# ---- files that are not gone on with ----

head -n 30 "$whole" >"$out"
kept() { # MESSAGE OPTION...
    message=$1
    shift
    cp "$out" "$scratch/before"
    says 2 "$message" "$query" --jsonl "$out" --manifest "$list" --resume "$@" && cmp "$out" "$scratch/before"
}
check "with another distance" kept "line 1: .*other options" --near 0.2 --thickness
check "without thickness" kept "line 1: .*other options" --near 0.1
check "with other kinds" kept "line 1: .*other options" --near 0.1 --thickness --kinds edge-edge
check "with rings" kept "line 1: .*other options" --near 0.1 --thickness --ignore-rings 1
check "with what is near at rest" kept "line 1: .*other options" --near 0.1 --thickness --ignore-rest 0.1
check "with times" kept "line 1: .*other options" --near 0.1 --thickness --timings
check "of another question" kept "line 1: .*no line of this version" --only self-collisions
check "a list of pairs" says 2 "too long for lines" batch "$scratch/x.jsonl" --list
check "closest points" says 2 "too long for lines" batch "$scratch/x.jsonl" --stencils
check "pairs to a file" says 2 "does not go with" batch "$scratch/x.jsonl" --out "$scratch/x.csv"
check "a rest pose of a saved model" says 2 "no rest pose" \
    batch "$scratch/x.jsonl" --model "$scratch/x.scm" --ignore-rest 1
check "steps" says 2 "does not go with" "$query" --step --jsonl "$scratch/x.jsonl" meshes/sphere.obj
finish
