#!/bin/sh
# What the programs print as JSON is what tools/starcontour.schema.json says, with no member that it
# does not know; and which faces and objects of a file pairs are told by.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
partition=$SC_BIN/sc-partition
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi

# Two objects: a face of four corners, and two that go through it; and the second one moved away.
make_car() { # FILE HEIGHT [NAME]
    cat >"$1" <<EOT
o body
v 0 0 0
v 4 0 0
v 4 4 0
v 0 4 0
f 1 2 3 4
o ${3:-wheel}
v 1 1 $2
v 2 1 $2
v 2 1 5
v 1 1 5
f 5 6 7 8
v 1 2 $2
v 2 2 $2
v 2 2 5
v 1 2 5
f 9 10 11 12
EOT
}
make_car "$scratch/hit.obj" -1
make_car "$scratch/clean.obj" 1
make_car "$scratch/odd.obj" -1 'a,"b'
make_car "$scratch/latin.obj" -1 "$(printf 'wh\351\303\251l')"
grep -v '^o ' "$scratch/hit.obj" >"$scratch/plain.obj"
echo "v 0 0" >"$scratch/broken.obj"
cloths=meshes/crossing_cloths.obj

# ---- faces and objects ----

check "pairs by objects" says 1 "^    body / wheel 6$" "$query" "$scratch/hit.obj"
check "none where there is no pair" status 0 "$query" "$scratch/clean.obj"
check "and no line" test "$(grep -c wheel "$scratch/out")" -eq 0
check "none of a file without objects" status 1 "$query" "$scratch/plain.obj"
check "and no line either" test "$(grep -c "^    [a-z]* / " "$scratch/out")" -eq 0
check "contacts" says 1 "^    0 2 segment .* faces 0 1 of body / wheel$" \
    "$query" --contacts "$scratch/hit.obj"
check "contacts of a file without objects" says 1 "^    0 2 segment .* faces 0 1$" \
    "$query" --contacts "$scratch/plain.obj"
check "pairs to a file" status 1 "$query" --out "$scratch/list" "$scratch/hit.obj"
check "its head" grep -qx "file,object_a,face_a,object_b,face_b,triangle_a,triangle_b" "$scratch/list"
check "its pairs" grep -qx ".*hit.obj,body,0,wheel,2,1,5" "$scratch/list"
check "six of them" test "$(wc -l <"$scratch/list")" -eq 7
check "a list is read again" status 0 "$query" --ignore "$scratch/list" "$scratch/hit.obj"
check "of edges" status 1 "$query" --pairs edge --out "$scratch/list" "$scratch/hit.obj"
check "their head" grep -qx "file,object_a,face_a,object_b,face_b,edge,triangle" "$scratch/list"
awk -F, 'NR > 1 { edge = $6; triangle = $7
    face = edge < 6 ? 0 : edge < 12 ? 1 : 2; other = triangle < 2 ? 0 : triangle < 4 ? 1 : 2
    if ($3 != face || $5 != other || $2 != (face ? "wheel" : "body")) exit 1 }' "$scratch/list"
check "faces of edges and triangles" test $? -eq 0
check "names with a comma" status 1 "$query" --out "$scratch/list" "$scratch/odd.obj"
check "are quoted" grep -q ',body,0,"a,""b",1,' "$scratch/list"
check "and the list is read again" status 0 "$query" --ignore "$scratch/list" "$scratch/odd.obj"
check "names that are not UTF-8 become it" says 1 "\"b\":\"$(printf 'wh\303\251\303\251l')\"" \
    "$query" --json "$scratch/latin.obj"
check "with --rest" says 1 "body / wheel 6" "$query" --rest "$scratch/clean.obj" "$scratch/hit.obj"
check "the model of a car" status 0 "$partition" "$scratch/clean.obj" -o "$scratch/car.scm"
check "with --model" says 1 "body / wheel 6" "$query" --model "$scratch/car.scm" "$scratch/hit.obj"
check "of steps" says 1 "^    body / wheel" "$query" --step "$scratch/clean.obj" "$scratch/hit.obj"
check "of steps to a file" status 1 \
    "$query" --step --out "$scratch/list" "$scratch/clean.obj" "$scratch/hit.obj"
check "vertices have an object and no face" grep -q ",vertex-face,wheel,,body,0,4,0," "$scratch/list"
check "edges have both" grep -q ",edge-edge,body,0,wheel,1,2,6," "$scratch/list"

# ---- the end of a run ----

check "a run over files" says 2 \
    "^4 files: 1 clean, 2 colliding, 1 refused; first .*hit.obj; worst .*crossing_cloths.obj ([0-9]* pairs)$" \
    "$query" "$scratch/clean.obj" "$scratch/hit.obj" "$cloths" "$scratch/broken.obj"
check "incomplete ones" says 3 "^2 files: 1 clean, 0 colliding, 1 incomplete, 0 refused" \
    "$query" --budget 300 "$cloths" "$scratch/clean.obj"
check "--any knows no worst" says 1 "^2 files: 1 clean, 1 colliding, 0 refused; first .*hit.obj$" \
    "$query" --any "$scratch/clean.obj" "$scratch/hit.obj"
check "no line after one file" status 0 "$query" --only self-collisions "$scratch/clean.obj"
check "but its own" test "$(wc -l <"$scratch/out")" -eq 2
check "near pairs by objects" says 1 "body / wheel [0-9]*$" "$query" --near 2 "$scratch/clean.obj"
check "steps" says 1 "^2 steps: 1 clean, 1 colliding, 0 refused; first .*clean.obj to .*hit.obj; worst" \
    "$query" --step "$scratch/clean.obj" "$scratch/clean.obj" "$scratch/hit.obj"

# ---- JSON ----

python=
for one in python3 /usr/bin/python3; do
    "$one" -c 'import jsonschema; jsonschema.Draft202012Validator' >/dev/null 2>&1 && python=$one && break
done
if [ -z "$python" ]; then
    skip "JSON against its schema: there is no python3 with jsonschema 4"
    finish
fi

cat >"$scratch/validate.py" <<'EOT'
import json
import sys

import jsonschema

with open(sys.argv[1], encoding="utf-8") as file:
    schema = json.load(file)
jsonschema.Draft202012Validator.check_schema(schema)


def close(part):
    """Allows no members but those that the schema names."""
    if isinstance(part, dict):
        if isinstance(part.get("properties"), dict) and "oneOf" not in part:
            part.setdefault("additionalProperties", False)
        for value in part.values():
            close(value)
    elif isinstance(part, list):
        for value in part:
            close(value)


close(schema)
validator = jsonschema.Draft202012Validator(schema)
kinds = []
with open(sys.argv[2], encoding="utf-8") as file:
    for line in file:
        one = json.loads(line)
        validator.validate(one)
        kinds.append(one["type"] + ("-" + one["status"] if "status" in one else ""))
print(" ".join(kinds))
sys.exit(" ".join(kinds) != sys.argv[3])
EOT

# valid KINDS COMMAND...: whether it prints objects of these types and statuses, all as the schema
# says.
valid() {
    kinds=$1
    shift
    "$@" >"$scratch/json"
    "$python" "$scratch/validate.py" tools/starcontour.schema.json "$scratch/json" "$kinds"
}

check "JSON of files" valid "mesh-clean mesh-collides mesh-error summary" \
    "$query" --json "$scratch/clean.obj" "$scratch/hit.obj" "$scratch/broken.obj"
check "of a name that is not UTF-8" valid "mesh-collides" "$query" --json "$scratch/latin.obj"
check "of contacts and statistics" valid "mesh-collides" \
    "$query" --json --contacts --stats --method sctt "$scratch/hit.obj"
check "of contacts without objects" valid "mesh-collides" \
    "$query" --json --contacts --pairs edge "$cloths"
check "of any" valid "mesh-clean mesh-collides summary" \
    "$query" --json --any "$scratch/clean.obj" "$scratch/hit.obj"
check "of filters" valid "mesh-collides" "$query" --json --ignore-rings 1 "$cloths"
check "of the pairs alone" valid "mesh-collides" "$query" --json --only self-collisions "$cloths"
check "in which nothing else is" sh -c "! grep -q -e places -e defects '$scratch/json'"
check "of no list" valid "mesh-collides" "$query" --json --pairs none "$cloths"
check "of edges" valid "mesh-collides" "$query" --json --pairs edge "$scratch/hit.obj"
check "of a budget" valid "mesh-incomplete" "$query" --json --budget 10 "$cloths"
check "of a rest pose" valid "mesh-collides" "$query" --json --rest "$scratch/clean.obj" "$scratch/hit.obj"
check "of a rest pose that is not there" valid "mesh-error" \
    "$query" --json --rest "$scratch/absent.obj" "$scratch/hit.obj"
check "of a model" valid "mesh-collides" "$query" --json --model "$scratch/car.scm" "$scratch/hit.obj"
echo "0,2" >"$scratch/ignored.csv"
check "of a list that is not there" valid "mesh-error" \
    "$query" --json --ignore "$scratch/absent.csv" "$scratch/hit.obj"
check "of groups that are not there" valid "mesh-error" \
    "$query" --json --ignore "$scratch/ignored.csv" --groups "$scratch/absent.txt" "$scratch/hit.obj"
check "which are named" grep -q '"file":"[^"]*absent.txt"' "$scratch/json"
check "a record" status 1 "$query" --record "$scratch/one.scq" "$scratch/hit.obj"
check "of a replay" valid "mesh-collides" "$query" --json --replay "$scratch/one.scq" --contacts
check "a record of a step" status 1 "$query" --step --record "$scratch/one.scq" \
    "$scratch/hit.obj" "$scratch/hit.obj"
check "of its replay" valid "step-collides" "$query" --json --replay "$scratch/one.scq"
check "a record of what is near" status 1 "$query" --near 1 --record "$scratch/one.scq" \
    "$scratch/hit.obj"
check "of that one's replay" valid "near-near" "$query" --json --replay "$scratch/one.scq"
check "of steps" valid "step-clean step-collides step-error step-error summary" \
    "$query" --step --json --times --stats "$scratch/clean.obj" "$scratch/clean.obj" \
    "$scratch/hit.obj" "$scratch/broken.obj" "$scratch/hit.obj"
check "of closest points in steps" valid "step-collides" \
    "$query" --step --json --stencils "$scratch/clean.obj" "$scratch/hit.obj"
check "of points that touch at both ends" valid "step-collides" \
    "$query" --step --json --stencils meshes/corner_on_face.obj meshes/corner_on_face.obj
check "of any in steps" valid "step-collides" \
    "$query" --step --json --any "$scratch/clean.obj" "$scratch/hit.obj"
check "of steps by boxes" valid "step-collides" \
    "$query" --step --json --method swept --tolerance 0.01 "$scratch/clean.obj" "$scratch/hit.obj"
check "of steps that cannot begin" valid "step-error" \
    "$query" --step --json "$scratch/broken.obj" "$scratch/hit.obj"
check "of what is near" valid "near-clean near-near near-error summary" \
    "$query" --near 0 --json --list "$scratch/clean.obj" meshes/folded_sheet.obj "$scratch/broken.obj"
check "of closest points" valid "near-near" \
    "$query" --near 2 --json --stencils --stats --method sctt "$scratch/hit.obj"
check "of thickness" valid "near-near" "$query" --near 2 --json --thickness "$scratch/hit.obj"
check "of any that is near" valid "near-near" "$query" --near 2 --json --any "$scratch/hit.obj"
check "of near poses" valid "near-near" \
    "$query" --near 2 --json --model "$scratch/car.scm" --budget 100000 "$scratch/hit.obj"
check "of near pairs, not all" valid "near-incomplete" "$query" --near 2 --json --budget 1 "$cloths"
check "near what has no rest pose" valid "near-error" \
    "$query" --near 2 --json --rest "$scratch/absent.obj" "$scratch/hit.obj"
check "of contours" valid "trace-clean trace-contours trace-error summary" \
    "$query" --trace --json "$scratch/clean.obj" meshes/folded_sheet.obj "$scratch/broken.obj"
check "of closed ones" valid "trace-contours" "$query" --trace --json meshes/crossing_tetrahedra.obj
check "of contours of poses" valid "trace-contours" \
    "$query" --trace --json --model "$scratch/car.scm" "$scratch/hit.obj"
check "of contours that have no rest pose" valid "trace-error" \
    "$query" --trace --json --rest "$scratch/absent.obj" "$scratch/hit.obj"
check "of a partition" valid "partition" "$partition" --json "$cloths"

# Numbers in an object are those of the table.
"$query" --json "$scratch/clean.obj" "$scratch/hit.obj" "$scratch/broken.obj" >"$scratch/json" 2>/dev/null
check "the sum of a run" "$python" -c '
import json, sys
lines = [json.loads(line) for line in open(sys.argv[1])]
end = lines[-1]
assert (end["files"], end["clean"], end["colliding"], end["refused"]) == (3, 1, 1, 1), end
assert end["first"] == end["worst"] and end["first"]["index"] == 1 and end["first"]["pairs"] == 6, end
assert lines[1]["object_pairs"] == [{"a": "body", "b": "wheel", "pairs": 6}], lines[1]
assert (lines[1]["faces"], lines[1]["objects"], lines[1]["triangles"]) == (3, 2, 6), lines[1]
' "$scratch/json"
finish
