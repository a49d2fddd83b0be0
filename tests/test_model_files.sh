#!/bin/sh
# Models and records as files: sc-partition -o, sc-query --model, --record and --replay. The answer
# is the one that the mesh gives; files that are damaged, of another mesh or of another kind are
# refused with status 2 and a reason.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
partition=$SC_BIN/sc-partition
if [ ! -x "$query" ] || [ ! -x "$partition" ]; then
    skip "sc-query or sc-partition was not built"
    check "there is something to skip" test ! -x "$query" -o ! -x "$partition"
    finish
fi

# pairs FILE OPTION...: the pairs that sc-query finds, without the name of the file.
pairs() {
    to=$1
    shift
    "$query" --out "$scratch/list" "$@" >"$scratch/table" 2>&1
    [ $? -lt 2 ] || { cat "$scratch/table"; return 1; }
    sed 's/^.*,\([^,]*,[^,]*\)$/\1/' "$scratch/list" >"$to"
}

# same MESH: the model gives what the mesh gives.
same() {
    pairs "$scratch/wanted" "$1" && pairs "$scratch/found" --model "$scratch/model.scm" "$1" &&
        diff "$scratch/wanted" "$scratch/found"
}

# refuses "TEXT" COMMAND...: status 2, and the text on standard error.
refuses() {
    text=$1
    shift
    "$@" >"$scratch/out" 2>"$scratch/err"
    if [ $? -ne 2 ] || ! grep -q -e "$text" "$scratch/err"; then
        cat "$scratch/out" "$scratch/err"
        return 1
    fi
}

make_model() {
    "$partition" -o "$scratch/model.scm" "$@"
}

for mesh in meshes/*.obj; do
    check "$mesh is saved" make_model "$mesh"
    check "$mesh: the model gives its pairs" same "$mesh"
done
if [ "${SC_METIS:-}" = yes ]; then
    check "METIS's patches are saved" make_model --partition metis meshes/roll.obj
    check "METIS's patches: the same pairs" same meshes/roll.obj
else
    skip "METIS is not there"
fi

# A pose that is not the rest pose.
check "a mesh with pairs is saved" make_model meshes/crossing_cloths.obj
cp "$scratch/model.scm" "$scratch/cloths.scm"
awk '$1 == "v" { print "v", $2 + 0.25, $3, $4 * 2; next } { print }' meshes/crossing_cloths.obj \
    >"$scratch/moved.obj"
check "a pose of the model" same "$scratch/moved.obj"
two_poses() {
    "$query" --model "$scratch/cloths.scm" meshes/crossing_cloths.obj "$scratch/moved.obj"
    test $? -eq 1
}
check "two poses, status 1" two_poses

# Which meshes fit.
check "a mesh of another size is refused" refuses "the model 338 and 576" \
    "$query" --model "$scratch/cloths.scm" meshes/sphere.obj
awk '$1 == "f" { print "f", $3, $4, $2; next } { print }' meshes/crossing_cloths.obj \
    >"$scratch/turned.obj"
check "other faces are refused" refuses "faces differ" \
    "$query" --model "$scratch/cloths.scm" "$scratch/turned.obj"
check "a mesh with a seam is saved" make_model meshes/seam_cloth.obj
awk '$1 == "v" { print "v", $2, $3, $4 + ++n; next } { print }' meshes/seam_cloth.obj \
    >"$scratch/torn.obj"
check "welded vertices that part are refused" refuses "at one place in the rest mesh" \
    "$query" --model "$scratch/model.scm" "$scratch/torn.obj"

# Damage. The length of the model's own part is that of the file without the weld map behind it.
cut_off() {
    head -c "$1" "$scratch/cloths.scm" >"$scratch/cut.scm"
}
size=$(wc -c <"$scratch/cloths.scm")
cut_off 0
check "an empty file is refused" refuses "end too early" \
    "$query" --model "$scratch/cut.scm" meshes/sphere.obj
cut_off 1000
check "half a model is refused" refuses "end too early" \
    "$query" --model "$scratch/cut.scm" meshes/sphere.obj
cut_off $((size - 1))
check "half a weld map is refused" refuses "what follows the model is damaged" \
    "$query" --model "$scratch/cut.scm" meshes/sphere.obj
map=$((32 + 4 * 338))
cut_off $((size - map))
check "a model without faces will do" refuses "the model 338 and 576" \
    "$query" --model "$scratch/cut.scm" meshes/sphere.obj
cp "$scratch/cut.scm" "$scratch/model.scm"
check "and gives the pairs" same meshes/crossing_cloths.obj
{ cat "$scratch/cut.scm" && printf 'something else, of more than 32 bytes'; } >"$scratch/model.scm"
check "what others put behind it is ignored" same meshes/crossing_cloths.obj
{ head -c $((size - 8)) "$scratch/cloths.scm" && printf 'abcdefgh'; } >"$scratch/model.scm"
check "a changed weld map is refused" refuses "what follows the model is damaged" \
    "$query" --model "$scratch/model.scm" meshes/crossing_cloths.obj
{ head -c 5000 "$scratch/cloths.scm" && printf 'x' && tail -c +5002 "$scratch/cloths.scm"; } \
    >"$scratch/model.scm"
check "a changed byte is refused" refuses "checksum" \
    "$query" --model "$scratch/model.scm" meshes/crossing_cloths.obj
check "a mesh is no model" refuses "not a saved model" \
    "$query" --model meshes/sphere.obj meshes/sphere.obj
check "an absent file is refused" refuses "No such file" \
    "$query" --model "$scratch/absent.scm" meshes/sphere.obj
check "a directory is refused" refuses "cannot be read" \
    "$query" --model "$scratch" meshes/sphere.obj
check "a place that cannot be written is reported" refuses "cannot be written" \
    "$partition" -o "$scratch/absent/model.scm" meshes/sphere.obj

# Records.
for options in "" "--pairs edge" "--proper --method aabb" "--method aabb-sctt --no-rest-cache" \
    "--contour star --weld none"; do
    # shellcheck disable=SC2086
    check "a record is written ($options)" pairs "$scratch/wanted" $options \
        --record "$scratch/query.scq" meshes/crossing_cloths.obj
    check "and replayed ($options)" pairs "$scratch/found" --replay "$scratch/query.scq"
    check "with the same pairs ($options)" diff "$scratch/wanted" "$scratch/found"
done
record_pose() {
    pairs "$scratch/wanted" --model "$scratch/cloths.scm" --record "$scratch/query.scq" "$scratch/moved.obj"
}
check "a pose of a saved model is recorded" record_pose
check "and replayed" pairs "$scratch/found" --replay "$scratch/query.scq"
check "with its pairs" diff "$scratch/wanted" "$scratch/found"
replay_json() {
    "$query" --replay "$scratch/query.scq" --json --stats >"$scratch/json"
    grep -q '"triangle_pairs":' "$scratch/json" && grep -q '"tasks":' "$scratch/json"
}
check "replayed as JSON" replay_json

# With a filter and a budget. The pairs to ignore are every third of those there are.
"$query" --out "$scratch/list" meshes/crossing_cloths.obj >"$scratch/out"
awk 'NR == 1 || NR % 3 == 0' "$scratch/list" >"$scratch/ignore.csv"
"$query" --pairs edge --out "$scratch/list" meshes/crossing_cloths.obj >"$scratch/out"
awk 'NR == 1 || NR % 3 == 0' "$scratch/list" >"$scratch/ignore_edges.csv"
{ echo "triangle 0-99 1 2" && echo "triangle 100-575 3 3" && echo "vertex 0-9 4 4"; } \
    >"$scratch/groups.txt"
check "pairs" pairs "$scratch/all" meshes/crossing_cloths.obj
for options in "--ignore-rings 3" "--ignore $scratch/ignore.csv" "--groups $scratch/groups.txt" \
    "--pairs edge --ignore $scratch/ignore_edges.csv --groups $scratch/groups.txt --ignore-rings 1"; do
    name=$(echo "$options" | sed "s|$scratch/||g")
    # shellcheck disable=SC2086
    check "a filtered record is written ($name)" pairs "$scratch/wanted" $options \
        --record "$scratch/filtered.scq" meshes/crossing_cloths.obj
    check "it is replayed ($name)" pairs "$scratch/found" --replay "$scratch/filtered.scq"
    check "it has the same pairs ($name)" diff "$scratch/wanted" "$scratch/found"
done
fewer() {
    test -s "$scratch/wanted" && test "$(wc -l <"$scratch/wanted")" -lt "$(wc -l <"$scratch/all")"
}
check "these are fewer than without" fewer
budget() {
    "$query" --budget 50 "$@" >"$scratch/out"
    test $? -eq 3
}
check "a record with a budget" budget --record "$scratch/budget.scq" meshes/crossing_cloths.obj
replayed_budget() {
    "$query" --replay "$scratch/budget.scq" --json >"$scratch/json"
    test $? -eq 3 && grep -q '"budget":50' "$scratch/json"
}
check "runs out of it again" replayed_budget
head -c $(($(wc -c <"$scratch/filtered.scq") - 1)) "$scratch/filtered.scq" >"$scratch/cut.scq"
check "a filtered record without its last byte is refused" refuses "end too early" \
    "$query" --replay "$scratch/cut.scq"
"$query" --any --record "$scratch/any.scq" meshes/sphere.obj >"$scratch/out"
check "a record of --any" "$query" --replay "$scratch/any.scq"
check "has no list" refuses "no list" "$query" --replay "$scratch/any.scq" --out "$scratch/list"
head -c 3000 "$scratch/query.scq" >"$scratch/cut.scq"
check "half a record is refused" refuses "end too early" "$query" --replay "$scratch/cut.scq"
check "a model is no record" refuses "not a record" "$query" --replay "$scratch/cloths.scm"
check "a record is no model" refuses "not a saved model" \
    "$query" --model "$scratch/query.scq" meshes/sphere.obj
check "a record that cannot be written is reported" refuses "cannot be written" \
    "$query" --record "$scratch/absent/query.scq" meshes/sphere.obj

# Of steps and of what is near.
features() {
    to=$1
    shift
    "$query" --out "$scratch/list" "$@" >"$scratch/table" 2>&1
    [ $? -lt 2 ] || { cat "$scratch/table"; return 1; }
    sed -E 's/^.*,(vertex-face|edge-edge),/\1,/;1d' "$scratch/list" >"$to"
    test -s "$to"
}
"$query" --near 0.1 --out "$scratch/list" meshes/crossing_cloths.obj >"$scratch/out"
awk 'NR == 1 || NR % 3 == 0' "$scratch/list" >"$scratch/ignore_near.csv"
for options in "--step --separation 0.05" "--step --separation 0.05 --method two-boxes" \
    "--near 0.1" \
    "--near 0.15 --kinds edge-edge --method sctt --ignore-rings 3" \
    "--near 0.15 --ignore-rest 0.1 --rest meshes/crossing_cloths.obj" \
    "--step --separation 0.1 --ignore $scratch/ignore_near.csv" \
    "--step --separation 0.1 --groups $scratch/groups.txt --ignore-rest 0.05" \
    "--near 0.1 --ignore $scratch/ignore_near.csv --groups $scratch/groups.txt"; do
    name=$(echo "$options" | sed "s|$scratch/||g")
    files=$scratch/moved.obj
    case $options in --step*) files="meshes/crossing_cloths.obj $files" ;; esac
    # shellcheck disable=SC2086
    check "a record is written ($name)" features "$scratch/wanted" $options \
        --record "$scratch/features.scq" $files
    check "and replayed ($name)" features "$scratch/found" --replay "$scratch/features.scq"
    check "with the same pairs ($name)" diff "$scratch/wanted" "$scratch/found"
done
"$query" --step --separation 0.05 --record "$scratch/step.scq" meshes/crossing_cloths.obj "$scratch/moved.obj" \
    >"$scratch/out"
check "a step as JSON" says 1 '"type":"step".*"separation":0.05,' \
    "$query" --replay "$scratch/step.scq" --json --stats
check "a search as JSON" says 1 '"type":"near".*"weld":null' \
    "$query" --replay "$scratch/features.scq" --json --stats
check "no contacts of a step" refuses "no pairs of triangles" \
    "$query" --replay "$scratch/step.scq" --contacts
check "a replay that cannot be written" refuses "cannot be written" \
    "$query" --replay "$scratch/step.scq" --out "$scratch/absent/list"
check "nor of a search" refuses "cannot be written" \
    "$query" --replay "$scratch/features.scq" --out "$scratch/absent/list"
check "a record of a step that cannot be written" refuses "cannot be written" "$query" --step \
    --record "$scratch/absent/x.scq" meshes/crossing_cloths.obj "$scratch/moved.obj"
check "nor one of a search" refuses "cannot be written" \
    "$query" --near 1 --record "$scratch/absent/x.scq" meshes/sphere.obj
for how in "--step --separation 0.05 --any" "--near 1 --any"; do
    files=meshes/crossing_cloths.obj
    case $how in --step*) files="$files $scratch/moved.obj" ;; esac
    # shellcheck disable=SC2086
    "$query" $how --record "$scratch/any.scq" $files >"$scratch/out"
    check "a record of $how" status 1 "$query" --replay "$scratch/any.scq"
    check "has no list ($how)" refuses "no list" \
        "$query" --replay "$scratch/any.scq" --out "$scratch/list"
done
head -c $(($(wc -c <"$scratch/step.scq") - 1)) "$scratch/step.scq" >"$scratch/cut.scq"
check "a step without its last byte is refused" refuses "end too early" \
    "$query" --replay "$scratch/cut.scq"

# What does not go together.
check "--model and --rest" refuses "in place of" \
    "$query" --model "$scratch/cloths.scm" --rest meshes/sphere.obj meshes/sphere.obj
check "--model and --partition" refuses "in place of" \
    "$query" --model "$scratch/cloths.scm" --partition fast meshes/sphere.obj
check "--replay and a mesh" refuses "takes no mesh" \
    "$query" --replay "$scratch/query.scq" meshes/sphere.obj
check "--replay and --method" refuses "asks what the record asks" \
    "$query" --replay "$scratch/query.scq" --method aabb
check "--replay and --ply" refuses "no faces" \
    "$query" --replay "$scratch/query.scq" --ply "$scratch/out.ply"
check "--record and two meshes" refuses "one mesh only" \
    "$query" --record "$scratch/query.scq" meshes/sphere.obj meshes/sphere.obj
check "--scaling and -o" refuses "writes no file" "$partition" --scaling -o "$scratch/model.scm"

finish
