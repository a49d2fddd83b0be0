#!/bin/sh
# sc-bench: what it lists, its JSON Lines and CSV, that methods agree on it, that what it exports is
# the same scene, that it says what is wrong; and the report made of its output.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

bench=$SC_BIN/sc-bench
if [ ! -x "$bench" ]; then
    skip "sc-bench was not built"
    check "the paper's table has all its columns" \
        awk -F, '!/^#/ && NF != 19 { exit 1 }' bench/paper_table1.csv
    finish
fi

# run OPTION...: sc-bench on a small scene, kept in the scratch directory.
run() {
    "$bench" --cache "$scratch/scenes" "$@"
}
small() {
    run --scene twisted-cloth --triangles 2048 --frames 3 --repeats 1 "$@"
}
# refuses TEXT OPTION...: fails with status 2 and says TEXT, on standard error alone.
refuses() {
    text=$1
    shift
    run "$@" >"$scratch/out" 2>"$scratch/err"
    status=$?
    cat "$scratch/err"
    [ $status -eq 2 ] && [ ! -s "$scratch/out" ] && grep -q -e "$text" "$scratch/err"
}

# ------------------------------------------------------------------------------------------------
# Lists and messages

"$bench" --list >"$scratch/list"
for name in twisted-cloth cloth-sphere cat bunny bunny-bumpy bunny-spiky horse wrinkled-cloth sphere \
    squeezed-rods exact star none aabb-sctt aabb hash; do
    check "--list names $name" grep -q "^  $name " "$scratch/list"
done
for option in scene triangles frames methods pairs proper partition threads repeats once near one-shot json csv list \
    export export-obj frame scene-dir; do
    "$bench" --help >"$scratch/help"
    check "--help explains --$option" grep -q -e "--$option" "$scratch/help"
done
check "--version" "$bench" --version

check "no scene" refuses "no scene given"
check "two scenes" refuses "at a time" --scene sphere meshes/sphere.obj
check "an unknown scene" refuses "no scene 'cube'" --scene cube
check "an unknown method" refuses "fast: there is no such method" meshes/sphere.obj --methods star,fast
check "a method twice" refuses "twice" meshes/sphere.obj --methods star,star
check "no method" refuses "no method" meshes/sphere.obj --methods ''
check "an unknown kind of pairs" refuses "is not one of" meshes/sphere.obj --pairs vertex
check "no frames" refuses "whole number" --scene sphere --frames 0
check "no threads" refuses "whole number" meshes/sphere.obj --threads 0
check "sizes of a file" refuses "only generated scenes" meshes/sphere.obj --triangles 100
check "no order in a file" refuses "without an order" meshes/sphere.obj --partition structure
check "an absent folder" refuses "absent" --scene-dir "$scratch/absent"
check "an absent file" refuses "absent" meshes/absent.obj
check "another mesh as a frame" refuses "not a pose" meshes/sphere.obj meshes/roll.obj
check "what the hash cannot do" refuses "names a vertex twice" meshes/degenerate_soup.obj
check "an option that does not exist" refuses "--quickly" --quickly

# ------------------------------------------------------------------------------------------------
# Output

check "a table" small
check "JSON Lines" sh -c "'$bench' --cache '$scratch/scenes' --scene twisted-cloth --triangles 2048 \
    --frames 3 --repeats 1 --once --json >'$scratch/json'"
check "CSV" sh -c "'$bench' --cache '$scratch/scenes' --scene twisted-cloth --triangles 2048 \
    --frames 3 --repeats 1 --once --csv >'$scratch/csv'"

cat >"$scratch/lines.py" <<'END'
import json, sys
lines = [json.loads(line) for line in open(sys.argv[1])]
first, records = lines[0], lines[1:]
for key in ("commit", "compiler", "flags", "cpu", "build_ms", "model_bytes", "workspace_bytes",
            "floor_ns_per_triangle", "mode", "partition", "repeats"):
    assert key in first, key
assert first["compiler"] and "-ffp-contract=off" in first["flags"] and first["mode"] == "once"
assert first["floor_ns_per_triangle"] > 0 and first["cpu_share"] > 0
methods = ["exact", "star", "none", "aabb-sctt", "aabb", "hash"]
assert [(r["frame"], r["method"]) for r in records] == [(f, m) for f in range(3) for m in methods]
tasks = [t + "_ms" for t in ("update_boxes", "update_normals", "orientation", "boxes_orientation",
         "primitives_orientation", "update_contours", "contour", "boxes_contour",
         "primitives_contour")]
keys = ["scene", "triangles", "frame", "method", "pairs_kind", "threads", "ms", "ms_min", "pairs",
        "missed", "extra", "times_floor"] + tasks + ["nodes", "boxes", "primitives", "ms_max"]
for r in records:
    assert not set(keys) - set(r), set(keys) - set(r)
    assert r["scene"] == "twisted-cloth" and r["triangles"] == first["triangles"]
    assert r["ms_max"] >= r["ms"] >= r["ms_min"] > 0 and r["times_floor"] > 0
    assert r["pairs_kind"] == "triangle" and r["threads"] == 1
    assert (r["method"] == "hash") == (r["nodes"] is None)
for f in range(3):
    own = [r for r in records if r["frame"] == f]
    sound = [r for r in own if r["method"] != "none"]
    assert len({r["pairs"] for r in sound}) == 1 and not any(r["missed"] for r in sound)
    assert not any(r["extra"] for r in own)
    none = next(r for r in own if r["method"] == "none")
    assert none["pairs"] + none["missed"] == sound[0]["pairs"]
assert records[-1]["pairs"] > 0, "the last frame should collide"
assert any(r["missed"] for r in records), "without the contour test pairs should be missed"
print([r["pairs"] for r in records if r["method"] == "star"])
END
cat >"$scratch/columns.py" <<'END'
import csv, json, sys
rows = [r for r in csv.DictReader(l for l in open(sys.argv[2]) if not l.startswith("#"))]
records = [json.loads(line) for line in open(sys.argv[1])][1:]
assert len(rows) == len(records) and list(rows[0]) == list(records[0])
for row, record in zip(rows, records):
    assert row["method"] == record["method"] and float(row["pairs"]) == record["pairs"]
    assert (row["nodes"] == "") == (record["nodes"] is None)
assert any(l.startswith("# commit: ") for l in open(sys.argv[2]))
END
if command -v python3 >/dev/null 2>&1; then
    check "JSON Lines hold what they should" python3 "$scratch/lines.py" "$scratch/json"
    check "CSV holds the same" python3 "$scratch/columns.py" "$scratch/json" "$scratch/csv"
else
    skip "JSON and CSV in detail: there is no python3"
fi
check "no bar where standard error is no terminal" test -z "$(small 2>&1 >/dev/null)"
check "each frame's methods are in turn" test "$(grep -c '"method":"star"' "$scratch/json")" -eq 3

# ------------------------------------------------------------------------------------------------
# Methods agree, whatever is asked for (sc-bench compares sorted pairs and fails otherwise)

for mesh in crossing_tetrahedra crossing_cloths duplicates touching_cubes corner_on_face folded_sheet \
    moebius roll seam_cloth figure_eight_tube; do
    for pairs in triangle edge; do
        check "$mesh: $pairs" run meshes/$mesh.obj --pairs $pairs --repeats 1
        check "$mesh: $pairs, proper" run meshes/$mesh.obj --pairs $pairs --proper --repeats 1
    done
done
check "the order of the scene" small --partition structure
[ -z "${SC_METIS:-}" ] || check "METIS" small --partition metis
check "two threads" small --threads 2 --once
check "two workers" small --workers 2 --once
check "not both" refuses "one of them" meshes/sphere.obj --workers 2 --threads 2
check "no workers" refuses "whole number" meshes/sphere.obj --workers 0
check "passes over the animation" small --once --repeats 2
sets=base
for set in avx2 avx512f; do
    ! grep -qw "$set" /proc/cpuinfo 2>/dev/null || sets="$sets ${set%f}"
done
for set in $sets; do
    check "@$set finds the same" small --once --methods "exact,exact@$set,aabb@$set"
done
check "@serial beside two workers" small --once --workers 2 --methods exact,exact@serial
check "an unknown @" refuses "none of base" meshes/sphere.obj --methods exact@fast
check "a method twice, with @" refuses "twice" meshes/sphere.obj --methods exact@base,exact@base
check "@ on what is not the library's" refuses "only queries of the library" meshes/sphere.obj \
    --methods hash@base
for mesh in crossing_cloths folded_sheet corner_on_face roll; do
    for distance in 0.05 1; do
        check "$mesh: within $distance edges" run meshes/$mesh.obj --pairs near --distance $distance --repeats 1
    done
done
within_edges() {
    small --once --pairs near --distance 0.5 --json >"$scratch/within" &&
        grep -q '"distance_edges":0.5,"distance":[0-9]' "$scratch/within" &&
        grep -q '"method":"near-count".*"pairs":[1-9][0-9]*,"missed":0,"extra":0' "$scratch/within" &&
        grep -q '"method":"near-inflated".*"pairs":[1-9][0-9]*,"missed":0' "$scratch/within"
}
check "what is near, by every method" within_edges
rings() {
    pairs=$(small --once --pairs near --methods near --csv "$@" | awk -F, '/,near,/ { n += $9 } END { print n }')
}
fewer_with_rings() {
    rings
    all=$pairs
    rings --ignore-rings 2 && echo "$all, without 2 rings $pairs" && test "$all" -gt "$pairs"
}
check "rings are left out" fewer_with_rings
check "what is near, on two workers" small --once --pairs near --workers 2 --methods near,near@serial,near-boxes@base
check "near-still alone is compared, too" small --once --pairs near --methods near-still
check "no --distance of others" refuses "of --pairs near only" meshes/sphere.obj --distance 1
check "no --ignore-rings of others" refuses "of --pairs near only" meshes/sphere.obj --ignore-rings 1
check "no distance 0" refuses "above 0" meshes/sphere.obj --pairs near --distance 0
check "no distance below 0" refuses "distance" meshes/sphere.obj --pairs near --distance -1
check "no method of others" refuses "knows no distance" meshes/sphere.obj --pairs near --methods exact
check "nor near elsewhere" refuses "is of what is near" meshes/sphere.obj --methods near
check "near-still is as it is" refuses "only queries of the library" meshes/sphere.obj --pairs near \
    --methods near-still@base
check "no proper nearness" refuses "need not cross" meshes/sphere.obj --pairs near --proper
check "no --one-shot of what is near" refuses "pairs that meet" meshes/sphere.obj --one-shot --pairs near
near_pairs() {
    small --near --json --methods exact >"$scratch/near" &&
        ! sed 1d "$scratch/near" | grep -qv '"near_pairs":[0-9]' && grep -q '"near_pairs":[1-9]' "$scratch/near"
}
check "--near counts" near_pairs
check "and only --near" grep -q '"near_pairs":null' "$scratch/json"
one_shot() {
    small --one-shot --repeats 2 --methods exact,aabb,exact@base --json >"$scratch/shots" &&
        test "$(grep -c '"build_ms":[0-9.]*,"workspace_ms":[0-9.]*,"query_ms":[0-9.]*,"total_ms":[0-9]' \
            "$scratch/shots")" -eq 3
}
check "--one-shot" one_shot
check "--one-shot as a table" small --one-shot
check "--one-shot with pairs" run meshes/crossing_cloths.obj --one-shot --repeats 1
check "--one-shot needs an order, too" refuses "without an order" meshes/sphere.obj --one-shot --partition structure
check "no --one-shot of steps" refuses "a step is none" meshes/sphere.obj --one-shot --pairs step
check "no --one-shot of the hash" refuses "methods of the library" meshes/sphere.obj --one-shot --methods hash

pairs_of() {
    "$@" --json --methods star --repeats 1 | sed -n 's/.*"pairs":\([0-9]*\).*/\1/p'
}
counted() {
    counts=$(pairs_of run meshes/crossing_tetrahedra.obj --pairs "$1")
    echo "$counts"
    [ "$counts" = "$2" ]
}
triangle=$(sed -n 's/^crossing_tetrahedra,[^,]*,[^,]*,\([0-9]*\),.*/\1/p' meshes/expected.csv)
edge=$(sed -n 's/^crossing_tetrahedra,[^,]*,[^,]*,[^,]*,\([0-9]*\),.*/\1/p' meshes/expected.csv)
check "known triangle pairs" counted triangle "$triangle"
check "known pairs of edge and triangle" counted edge "$edge"

misses_pairs() {
    run meshes/crossing_tetrahedra.obj meshes/crossing_tetrahedra.obj --json --methods none \
        --repeats 1 | tail -n 1 | grep -q "\"pairs\":.*\"missed\":"
}
check "none alone is compared with a complete set" misses_pairs

# ------------------------------------------------------------------------------------------------
# Exports

same_pairs() {
    pairs_of small >"$scratch/pairs"
    grep -q '[1-9]' "$scratch/pairs" && pairs_of "$@" | diff "$scratch/pairs" -
}
check "--export" small --export "$scratch/folder"
for part in meta.txt tris.u32 frames.f64; do
    check "--export writes $part" test -s "$scratch/folder/$part"
done
check "--scene-dir has the same pairs" same_pairs run --scene-dir "$scratch/folder"
check "--scene-dir has the scene's order" run --scene-dir "$scratch/folder/" --partition structure \
    --repeats 1
check "--export-obj" small --export-obj "$scratch/obj"
check "files have the same pairs" same_pairs run "$scratch"/obj/*.obj
one_of_them() {
    small --export-obj "$scratch/one" --frame 1 && test "$(ls "$scratch/one")" = frame_0001.obj &&
        diff "$scratch/obj/frame_0001.obj" "$scratch/one/frame_0001.obj"
}
check "--frame: one of them" one_of_them
check "a frame that is not there" refuses "frames are 0 to 2" --scene-dir "$scratch/folder" --export-obj "$scratch/none" \
    --frame 3
check "--frame of others" refuses "of --export-obj only" --scene sphere --frame 1
# Two triangles that cross in the numbers of the file, and not in floats; before them a frame of
# floats.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 2 0\nv 3 2 0\nv 2 3 0\nf 1 2 3\nf 4 5 6\n' >"$scratch/near.obj"
printf 'v 500000.155 5400000.362 100.080\nv 500000.208 5400000.167 100.355
v 500000.397 5400000.115 100.197\nv 500000.358 5400000.218 100.086
v 500000.304 5400000.135 100.194\nv 500000.003 5400000.396 100.263\nf 1 2 3\nf 4 5 6\n' >"$scratch/far.obj"
check "files of doubles" says 0 "^far.obj,2,0,exact,triangle,1,[^,]*,[^,]*,1," \
    "$bench" --csv --methods exact,aabb --repeats 1 "$scratch/far.obj"
check "after a file of floats" says 0 ",2,1,exact,triangle,1,[^,]*,[^,]*,1," \
    "$bench" --csv --methods exact,aabb --repeats 1 "$scratch/near.obj" "$scratch/far.obj"
mkfifo "$scratch/pipe.obj"
check "a pipe is not measured" says 2 "pipe.obj: a pipe" timeout 20 "$bench" "$scratch/pipe.obj"
check "a pattern has the same pairs" same_pairs run "$scratch/obj/frame_%04d.obj"
shorter() {
    test "$(pairs_of run --scene-dir "$scratch/folder" --frames 2 | wc -l)" -eq 2
}
check "--frames shortens it" shorter
head -c 100 "$scratch/folder/frames.f64" >"$scratch/short"
cp "$scratch/short" "$scratch/folder/frames.f64"
check "a short file" refuses "frames.f64" --scene-dir "$scratch/folder"

# ------------------------------------------------------------------------------------------------
# The report

check "the machine's name can be a folder's" sh -c 'bench/machine.sh | grep -qx "[a-z0-9-]*"'
check "run_bench.sh refuses what it does not know" sh -c '! bench/run_bench.sh some 2>/dev/null'
if command -v python3 >/dev/null 2>&1; then
    mkdir "$scratch/raw" "$scratch/results"
    small --once --json --pairs edge >"$scratch/raw/1.jsonl"
    run --scene twisted-cloth --triangles 512 --frames 3 --repeats 1 --once --json --pairs edge \
        >"$scratch/raw/2.jsonl"
    small --once --json --threads 2 --methods star --pairs edge >"$scratch/raw/3.jsonl"
    small --once --json --workers 2 --methods exact,exact@serial --pairs edge >"$scratch/raw/4.jsonl"
    small --once --json --near --methods exact,aabb --pairs edge >"$scratch/raw/5.jsonl"
    small --one-shot --json >"$scratch/raw/6.shots"
    for methods in exact,none exact,aabb; do
        small --once --json --pairs edge --methods $methods >"$scratch/raw/$methods.jsonl"
    done
    for distance in 0.2 1; do
        small --once --json --pairs near --distance $distance >"$scratch/raw/near.$distance.jsonl"
    done
    small --once --json --pairs near --workers 2 --methods near,near@serial >"$scratch/raw/near.jsonl"
    for name in this other; do
        small --once --json --methods exact --pairs edge >"$scratch/raw/$name.twisted-cloth.1.built"
    done
    "$SC_BIN/sc-dataset" --poses 20 --triangles 3000 --csv "$scratch/raw/2.dataset" >"$scratch/out"
    check "a report" python3 bench/draw_report.py "$scratch/results" "$scratch/raw"
    for section in "Contour test" "Threads of one query" Compilers "Builds and single queries"; do
        check "it has $section" grep -q "^## $section" "$scratch/results/report.md"
    done
    check "it has the price of the contour test, by two methods in turn" \
        grep -Eq "^\| twisted-cloth \| [0-9,]+ (\| [0-9.]+ ){2}(\| [^|]+ ){4}\|$" "$scratch/results/report.md"
    check "it has worst frames, likewise" \
        grep -Eq "^\| twisted-cloth \| [0-9,]+ (\| [0-9.]+ ){7}\| – \| – \|$" \
        "$scratch/results/report.md"
    check "it has what is near, by all methods" \
        grep -Eq "^\| twisted-cloth \| [0-9,]+ \| 1\.0 \| [0-9,]+ (\| [0-9.]+ ){8}\|$" "$scratch/results/report.md"
    check "and what is to be reached" \
        grep -Eq "^\| two workers: speed-up \| ≥ 1.80 \| [0-9.]+ \| twisted-cloth, 1.0 edges \| (met|\*\*not met\*\*) \|$" \
        "$scratch/results/report.md"
    check "what was not measured is not met" grep -q "^| closed meshes .*not measured |$" "$scratch/results/report.md"
    check "it has many poses, by one worker" grep -Eq \
        "^\| [23],[0-9]{3} \| 20 \| 1 (\| [0-9.]+ ){4}\| 1\.00 (\| [0-9.]+ ){2}\| same \|$" "$scratch/results/report.md"
    check "and by two" grep -Eq \
        "^\| [23],[0-9]{3} \| 20 \| 2 (\| [0-9.]+ ){7}\| same \|$" "$scratch/results/report.md"
    check "of which there were too few" \
        grep -q "^| 25,000 triangles: .* not measured |$" "$scratch/results/report.md"
    for part in summary.csv frames.csv turns.csv shots.csv built.csv near.csv dataset.csv report.md; do
        check "with $part" test -s "$scratch/results/$part"
    done
    cp "$scratch/results/report.md" "$scratch/first.md"
    check "a report from its CSV files" python3 bench/draw_report.py "$scratch/results"
    check "which is the same" diff "$scratch/first.md" "$scratch/results/report.md"
    mkdir "$scratch/twice" "$scratch/plots"
    for triangles in 512 1152 2048; do
        run --scene twisted-cloth --triangles $triangles --frames 3 --repeats 2 --once --json --pairs edge \
            >"$scratch/twice/$triangles.jsonl"
    done
    for distance in 0.2 1; do
        run --scene twisted-cloth --triangles 2048 --frames 3 --repeats 2 --once --json --pairs near \
            --distance $distance >"$scratch/twice/near.$distance.jsonl"
    done
    check "a report of three sizes, two passes" python3 bench/draw_report.py "$scratch/plots" "$scratch/twice"
    plots() {
        python3 tests/bench/look_at_plots.py "$scratch/plots" bench/results/*/ >"$scratch/plots.log" 2>&1
        plots_status=$?
        cat "$scratch/plots.log"
        [ $plots_status -eq 0 ] || [ $plots_status -eq 77 ]
    }
    check "plots: legends cover no line, repeats have bands, scenes have pictures" plots
    [ $plots_status -ne 77 ] || skip "what plots look like: there is no matplotlib"
    cat >"$scratch/results/peers.csv" <<'END'
# commit: abc
# skipped: libigl: no wheel
# skipped: cgal on horse: not a manifold
# skipped: ipctk on rod: needed more than 8 GB of memory (step 1 from frame 5)
scene,triangles,frame,peer,version,what,threads,ms,pairs,matches,ms_min,missing,extra,beside,processors
rod,500,0,fcl,0.7.0,refitted,1,6,2,yes,6,0,0,fcl,1
rod,500,1,fcl,0.7.0,refitted,1,10,2,no,10,3,0,fcl,1
rod,500,0,starcontour,0.1.0,exact,1,2,4,yes,2,0,0,fcl,1
rod,500,1,starcontour,0.1.0,exact,1,2,6,yes,2,0,0,fcl,1
rod,500,0,starcontour,0.1.0,star,1,9,4,yes,9,0,0,fcl,1
rod,500,0,cgal,5.5.1,swept,1,30,4,yes,30,0,0,cgal,1
rod,500,0,starcontour,0.1.0,exact,1,3,4,yes,3,0,0,cgal,1
rod,500,0,cgal,5.5.1,swept,2,20,4,yes,20,0,0,cgal,2
rod,500,0,starcontour,0.1.0,exact,1,5,4,yes,1,0,0,cgal,2
rod,500,0,trueform,1.0,tree rebuilt,1,20,4,yes,20,0,0,trueform,1
rod,500,0,starcontour,0.1.0,exact,1,3,4,yes,2,0,0,trueform,1
rod,500,0,starcontour,0.1.0,one shot,1,15,4,yes,15,0,0,trueform,1
rod,500,0,ipctk,1.6.1,step: LBVH,1,40,100,yes,40,0,0,ipctk,1
rod,500,1,ipctk,1.6.1,step: LBVH,1,60,300,unknown,60,0,0,ipctk,1
rod,500,0,starcontour,0.1.0,step: candidates,1,5,10,yes,5,0,0,ipctk,1
rod,500,1,starcontour,0.1.0,step: candidates,1,5,10,yes,5,0,0,ipctk,1
rod,500,3,ipctk,1.6.1,step 1/50: time of impact: tight inclusion,1,60,0.25,yes,60,0,0,ipctk,1
rod,500,3,ipctk,1.6.1,step 1/50: candidates: LBVH,1,40,1500,yes,40,0,0,ipctk,1
rod,500,3,starcontour,0.1.0,step 1/50: candidates,1,4,30,yes,4,0,0,ipctk,1
rod,500,3,starcontour,0.1.0,step 1/50: time of impact,1,5,0.2504,yes,5,0,0,ipctk,1
rod,500,3,starcontour,0.1.0,step 1/50: pairs at the start,1,1,7,yes,1,0,0,ipctk,1
rod,500,3,ipctk,1.6.1,step 1: time of impact: tight inclusion,1,90,1,no,90,1,0,ipctk,1
rod,500,3,ipctk,1.6.1,step 1: candidates: LBVH,1,80,9000,no,80,2,0,ipctk,1
rod,500,3,starcontour,0.1.0,step 1: candidates,1,8,60,yes,8,0,0,ipctk,1
rod,500,3,starcontour,0.1.0,step 1: time of impact,1,9,0.5,yes,9,0,0,ipctk,1
rod,500,3,starcontour,0.1.0,step 1: pairs at the start,1,1,0,yes,1,0,0,ipctk,1
rod,500,4,ipctk,1.6.1,step 1: time of impact: tight inclusion,1,90,1,yes,90,0,0,ipctk,1
rod,500,4,ipctk,1.6.1,step 1: candidates: LBVH,1,80,9000000,unknown,80,0,0,ipctk,1
rod,500,4,starcontour,0.1.0,step 1: candidates,1,8,60,yes,8,0,0,ipctk,1
rod,500,4,starcontour,0.1.0,step 1: time of impact,1,9,0,no,9,0,1,ipctk,1
rod,500,4,starcontour,0.1.0,step 1: pairs at the start,1,1,0,yes,1,0,0,ipctk,1
rod,500,5,ipctk,1.6.1,step 1: time of impact: tight inclusion,1,90,1,yes,90,0,0,ipctk,1
END
    cat >"$scratch/results/turns.csv" <<'END'
what,scene,triangles,partition,workers,frame,method,ms,ms_min,pairs,near_pairs
threads,rod,500,fast,2,0,exact,2,2,4,
threads,rod,500,fast,2,0,exact@serial,4,4,4,
threads,rod,500,fast,2,1,exact,0.4,0.4,6,
threads,rod,500,fast,2,1,exact@serial,0.5,0.5,6,
instructions,rod,500,fast,1,0,exact@avx512,1,1,4,
instructions,rod,500,fast,1,0,exact@avx2,1.25,1.25,4,
instructions,rod,500,fast,1,0,exact@base,2,2,4,
contact,rod,500,fast,1,0,exact,1,1,4,9
contact,rod,500,fast,1,0,aabb,1,1,4,9
contact,rod,500,fast,1,1,exact,6,6,6,600000
contact,rod,500,fast,1,1,aabb,12,12,6,600000
END
    cat >"$scratch/results/shots.csv" <<'END'
scene,triangles,partition,method,repeats,build_ms,workspace_ms,query_ms,total_ms,pairs,model_bytes,workspace_bytes,peak_bytes
rod,500,fast,exact,1,0.5,0,1,1.5,4,50000,45000,150000
rod,500,fast,aabb,1,0.25,0,2,2.25,4,50000,45000,150000
rod,500,metis,exact,1,4,0,1,5,4,50000,45000,150000
END
    cat >"$scratch/results/built.csv" <<'END'
by,compiler,scene,triangles,partition,frame,method,ms_min
this,cc,rod,500,fast,0,exact,2
this,cc,rod,500,fast,1,exact,4
clang,clang,rod,500,fast,0,exact,4
clang,clang,rod,500,fast,1,exact,2
END
    cat >"$scratch/results/near_peers.csv" <<'END'
scene,triangles,frame,edges,peer,version,what,ms,ms_min,pairs,missing,extra
crushed-cloth,500,0,0.2,starcontour,0.1.0,near,1,1,900,0,0
crushed-cloth,500,0,0.2,starcontour,0.1.0,near; merged,2,2,300,0,0
crushed-cloth,500,0,0.2,ipctk,1.6.1,Candidates,8,8,2000,0,0
crushed-cloth,500,0,0.2,ipctk,1.6.1,NormalCollisions,16,16,304,1,4
crushed-cloth,500,0,0.5,starcontour,0.1.0,near,2,2,4000,0,0
crushed-cloth,500,0,0.5,starcontour,0.1.0,near; merged,4,4,600,0,0
crushed-cloth,500,0,0.5,ipctk,1.6.1,Candidates,8,8,6000,2,1
crushed-cloth,500,0,0.5,ipctk,1.6.1,NormalCollisions,20,20,700,,
END
    cat >"$scratch/results/dataset.csv" <<'END'
triangles,poses,chunk,workers,ms,ms_median,cpu_share,colliding,pairs,checked,differs
24992,100000,256,1,0.5,0.5,1,25000,600000,1000,0
24992,100000,256,2,0.25,0.25,0.9,25000,600000,1000,0
24992,100000,256,1,0.8,0.8,1,25000,600000,1000,1
24992,100000,256,4,0.2,0.2,1,25000,600000,1000,1
END
    cat >"$scratch/results/dataset_peers.csv" <<'END'
# commit: def
# skipped: open3d: no such wheel
scene,peer,version,what,threads,triangles,poses,ms,ours_ms,mean,ours_mean,colliding,wrong,missing,extra,unequal
poses,meshlib,3.1,refitted,1,24992,200,50,0.5,50,0.8,90,3,40,2,7
poses,meshlib,3.1,refitted,2,24992,200,30,0.5,30,0.5,90,3,40,2,7
rounded,libigl,2.6.3,rebuilt,1,24992,200,100,0.4,100,0.4,90,0,0,0,0
END
    cat >"$scratch/results/wasm.csv" <<'END'
# commit: efd
# node: v20
scene,triangles,frames,pairs,best_ms,base_ms,wasm_ms,same
twisted-cloth,65536,60,1000,1,2,4,1
sphere,81920,60,0,0.2,0.5,2.5,0
END
    cat >"$scratch/results/objects.csv" <<'END'
scene,question,objects,workers,way,pairs,ms
body,query,2,1,objects,2000,1
body,query,2,1,cut,2000,0.8
body,query,2,1,merged,2000,3
body,query,2,1,alone,0,0.5
END
    cat >"$scratch/results/objects_peers.csv" <<'END'
# commit: fed
# skipped: fcl on crowd: took more than 300 s
scene,triangles,frame,peer,version,what,threads,ms,pairs,matches,ms_min,missing,extra,beside,processors
body,500,0,embree,3.13.5,two scenes: refitted,1,20,100,yes,20,0,0,embree,1
body,500,1,embree,3.13.5,two scenes: refitted,1,40,300,yes,40,0,0,embree,1
body,500,0,embree,3.13.5,two scenes: rebuilt,1,60,100,yes,20,0,0,embree,1
body,500,1,embree,3.13.5,two scenes: rebuilt,1,60,298,no,40,3,2,embree,1
body,500,0,starcontour,0.1.0,objects,1,2,110,yes,2,0,0,embree,1
body,500,1,starcontour,0.1.0,objects,1,4,310,yes,4,0,0,embree,1
body,500,0,embree,3.13.5,two scenes: refitted,2,9,100,yes,20,0,0,embree,2
body,500,0,starcontour,0.1.0,objects,2,3,110,yes,2,0,0,embree,2
body,500,0,ipctk,1.6.1,one mesh: Candidates,1,90,500,yes,90,0,0,ipctk near,1
body,500,0,ipctk,1.6.1,one mesh: NormalCollisions,1,80,200,unknown,80,0,0,ipctk near,1
body,500,0,starcontour,0.1.0,objects,1,4,400,yes,4,0,0,ipctk near,1
END
    cat >"$scratch/results/trace_peers.csv" <<'END'
# commit: dcf
# skipped: cgal: its headers were not found
scene,triangles,frame,peer,version,what,ms,ms_min,pairs,closed,open,length,off,verdict,beside
bunny,500,0,starcontour,0.1.0,pairs,2,2,300,,,,,,libigl
bunny,500,0,starcontour,0.1.0,sc_trace,1,1,300,2,1,5,,,libigl
bunny,500,0,libigl,2.6.3,remesh,90,90,300,2,1,5,2e-15,match,libigl
bunny,500,1,starcontour,0.1.0,pairs,2,2,100,,,,,,libigl
bunny,500,1,starcontour,0.1.0,sc_trace,3,3,100,2,1,5,,,libigl
bunny,500,1,libigl,2.6.3,remesh,70,30,100,1,3,5,0.1,differ,libigl
bunny,500,0,starcontour,0.1.0,pairs,2,2,300,,,,,,meshlib
bunny,500,0,starcontour,0.1.0,sc_trace,1,1,300,2,1,5,,,meshlib
bunny,500,0,meshlib,3.1,pairs alone,6,6,300,,,,,,meshlib
bunny,500,0,meshlib,3.1,contours,36,36,300,2,1,,,match,meshlib
bunny,500,1,starcontour,0.1.0,pairs,2,2,50,,,,,,meshlib
bunny,500,1,starcontour,0.1.0,sc_trace,9,9,50,2,1,5,,,meshlib
bunny,500,1,meshlib,3.1,pairs alone,6,6,50,,,,,,meshlib
bunny,500,1,meshlib,3.1,contours,8,8,50,2,1,,,degenerate,meshlib
END
    check "a report with peers" python3 bench/draw_report.py "$scratch/results"
    near_row="| crushed-cloth | 500 | 0.20 | 900 | 1.00 | 2.00 | 8.00 | 16.0 | 8.00 | 16.0 | 8.00 | right | 1 and 4 of 304 |"
    check "what is near, beside ipc-toolkit" grep -Fq "$near_row" "$scratch/results/report.md"
    check "wrong candidates are told" grep -q "| 3 wrong | – |$" "$scratch/results/report.md"
    check "a target that is met" grep -Fq "× NormalCollisions | ≥ 15.0 | 16.0 | crushed-cloth, 500 | met |" \
        "$scratch/results/report.md"
    check "a target that is not met" grep -Fq \
        "× NormalCollisions | ≥ 20.0 | 10.0 | crushed-cloth, 500 | **not met** |" "$scratch/results/report.md"
    for line in "| 24,992 | 100,000 | 2 | 0.250 | 0.500 | 0.450 | 90 | 2.00 | 25 | 6.00 | same |" \
        "| 24,992 | 100,000 | 4 | 0.200 | 0.800 | 0.800 | 100 | 4.00 | 25 | 6.00 | differ |" \
        "| 25,000 triangles: ms a pose and core | ≤ 0.600 | 0.800 | one worker | **not met** |" \
        "| two workers: throughput | ≥ 1.90 | 2.00 | 100,000 poses | met |" \
        "had less than 95 % of their processors" "other programs ran at the same time, so that single" \
        "| poses | meshlib 3.1 | refitted | 200 | 50.0 | 0.500 | 100.0 | 30.0 | 60.0 | 3 of 200 | 40 missing, 2 extra in 7 |" \
        "| rounded | libigl 2.6.3 | rebuilt | 200 | 100 | 0.400 | 250.0 | – | – | 0 of 200 | – |" \
        "| bunny | 500 | libigl 2.6.3 | remesh | 200 | 2.00 | 2.00 | 1.00 | 80.0 | 20.0 | 1 differ, 1 match | 2.0e-15 |" \
        "| bunny | 500 | meshlib 3.1 | pairs alone | 175 | 2.00 | 5.00 | 2.50 | 6.00 | 0.86 | – | – |" \
        "| bunny | 500 | meshlib 3.1 | contours | 175 | 2.00 | 5.00 | 2.50 | 22.0 | 3.14 | 1 degenerate, 1 match | – |" \
        "| sc_trace: × the query that finds its pairs | ≤ 1.30 | 1.50 | bunny, 500, frame 1 | **not met** |" \
        "| query and sc_trace: × MeshLib | ≥ 10.0 | 12.0 | bunny, 500, frame 0 | met |" \
        "| query and sc_trace: × libigl | ≥ 20.0 | 14.0 | bunny, 500, frame 1 | **not met** |" \
        "made by \`make trace-peers\` at commit dcf" "- cgal: its headers were not found" \
        "| body | intersections | 1 | 2,000 | 1.00 | 0.800 | 1.25 | 3.00 | 3.00 | 0.500 |" \
        "| objects ÷ cut | ≤ 1.20 | 1.25 | body, intersections, 1 thread | **not met** |" \
        "| body | embree 3.13.5 | two scenes: refitted | 1 | 200 | 30.0 | 3.00 | 10.0 | match |" \
        "| body | embree 3.13.5 | two scenes: rebuilt | 1 | 199 | 60.0 | 3.00 | 20.0 | 5 wrong |" \
        "| body | embree 3.13.5 | two scenes: refitted | 2 | 100 | 9.00 | 3.00 | 3.00 | match |" \
        "| body | ipctk 1.6.1 | one mesh: Candidates | 1 | 500 | 90.0 | 4.00 | 22.5 | match |" \
        "| body | ipctk 1.6.1 | one mesh: NormalCollisions | 1 | 200 | 80.0 | 4.00 | 20.0 | – |" \
        "made by \`make objects-peers\` at commit fed" "- fcl on crowd: took more than 300 s" \
        "by \`make dataset-peers\` at commit def" "- open3d: no such wheel" \
        "| twisted-cloth | 65,536 | 1,000 | 1.00 | 2.00 | 4.00 | 0.50 | match |" \
        "| sphere | 81,920 | 0 | 0.200 | 0.500 | 2.50 | 0.20 | differ |" \
        "| part of SSE2's speed | ≥ 0.250 | 0.200 | sphere, 81,920 | **not met** |" \
        "by \`make bench-wasm\` at commit efd" \
        "| rod | 500 | 2 | 5 | 8.00 | 2.00 | 4.00 | – | – | – | 3 missing in 1 of 2 frames |" \
        "| rod | 500 | 1 | 4 | 30.0 | 3.00 | 10.0 | 20.0 | 5.00 | 4.00 | match |" \
        "| cgal 5.5.1 | swept | 1 | 10.0 | 4.00 | match |" \
        "| rod | 500 | 3 | 1/50 | 7 | 1,500 | 30 | 40.0 | 4.00 | 10.0 | 0.250 | 0.250 | 60.0 | 5.00 | 12.0 | right |" \
        "| rod | 500 | 3 | 1 | 0 | 9,000 | 60 | 80.0 | 8.00 | 10.0 | 1 | 0.500 | 90.0 | 9.00 | 10.0 | 2 collisions not in its candidates; its time is after the first contact |" \
        "| 200 | 10 | 5.00 | 50.0 | 5.00 | 10.0 | hold all collisions; not looked through in 1 steps |" \
        "| 1 | 0 | 90.0 | 9.00 | 10.0 | candidates not looked through; our time is less than 1 though nothing meets |" \
        "- ipctk on rod: needed more than 8 GB of memory (step 1 from frame 5)" "- ipctk: no results" \
        "| rod | 500 | 10.0 | 10.0 | – | – | – | – | 3.00 | 4.00 | – | – | – | – |" \
        "| rod | 500 | trueform 1.0 | 20.0 | 15.0 | 0.75 |" \
        "| rod | 500 | exact | 2 | 1 of 2 | 4.00 | 2.00 | 2.00 | 2.00 | 2.00 |" \
        "| rod | 500 | exact | 1.00 | 1.25 | 2.00 | 0.80 | 0.50 | 1.00 | 1.25 | 2.00 | 0.80 | 0.50 |" \
        "| rod | 500 | 1 | 600,000 | 6 | 6.00 | 12.0 | 10.0 | 20.0 | 2.00 |" \
        "| rod | 1 | fcl 0.7.0 | refitted | 6 | 10.0 | 2.00 | 5.00 |" \
        "| rod | 500 | 1.00 | 8.00 | 100 | 90 | 190 | 300 | 0.500 | 190 | 2.25 | 1.50 |" \
        "| rod | 500 | exact | clang | 2.00 | 4.00 | 0.50 | 3.00 | 3.00 | 1.00 |" \
        "the medians of \`exact\` are 1.5 times its minima" "- libigl: no wheel" "- cgal on horse: not a manifold" "- embree: no results"; do
        check "it says: $line" grep -qF -e "$line" "$scratch/results/report.md"
    done
    rm "$scratch/results/peers.csv"
    nothing_there() {
        ! bench/run_bench.sh report "$scratch/empty" 2>"$scratch/err" && grep -q "make bench" "$scratch/err"
    }
    check "a report of nothing" nothing_there
    check "it names the commit" grep -q "at commit $(sed -n 's/^# commit: //p' "$scratch/csv")" \
        "$scratch/results/report.md"
else
    skip "the report: there is no python3"
fi

# ---- several objects ----

objects=$SC_BIN/sc-objects
check "several objects" says 0 "crowd *step *100 *2" "$objects" --scale 0.01 --frames 2 --rounds 1 \
    --workers 2 --csv "$scratch/2.objects"
check "a line for each way" test "$(grep -c '^\(body\|crowd\|layers\),\(query\|near\|step\),' "$scratch/2.objects")" -eq 30
check "some pairs" grep -q '^layers,near,2,2,objects,[1-9]' "$scratch/2.objects"
check "one scene" says 0 "layers" "$objects" --scene layers --scale 0.01 --frames 1 --rounds 1
check "and no other" test "$(grep -c "^body" "$scratch/out")" -eq 0
check "no such scene" says 2 "no scene 'sea'" "$objects" --scene sea
check "no such scale" says 2 "0.001" "$objects" --scale 0
check "where nothing can be written" says 2 "cannot be written" "$objects" --csv "$scratch/absent/a.csv"
check "scenes for others" "$objects" --scale 0.01 --frames 2 --export "$scratch/objects"
check "a list of objects" test "$(cat "$scratch/objects/body/objects.txt")" = "$(printf '0 1\n1 0')"
check "one that moves" test "$(cut -d' ' -f 1,3 "$scratch/objects/body/0/meta.txt")" = "200 2"
check "and one that does not" test "$(cut -d' ' -f 3 "$scratch/objects/body/1/meta.txt")" -eq 1
check "a hundred of them" test "$(wc -l <"$scratch/objects/crowd/objects.txt")" -eq 100
check "where no scene can be written" says 2 "absent" "$objects" --scale 0.01 --export "$scratch/absent/deep"

# ---- many poses ----

dataset=$SC_BIN/sc-dataset
check "many poses by two threads" says 0 "all answers are the same" "$dataset" --poses 40 --triangles 3000 \
    --chunk 16 --check 7 --csv "$scratch/dataset"
check "a line for each number of workers" test "$(cut -d, -f 2-4 "$scratch/dataset" | tr '\n' ' ')" = \
    "poses,chunk,workers 40,16,1 40,16,2 "
check "with the same pairs, which there are some of" awk -F, '
    NR == 2 { colliding = $8; pairs = $9 }
    NR > 1 && !($5 > 0 && $6 > 0 && $7 > 0 && $8 == colliding && $9 == pairs && $8 > 5 && $8 < 40 &&
        $9 > $8 && $10 == 6 && $11 == 0) { exit 1 }' "$scratch/dataset"
pairs_of_dataset=$(awk -F, 'NR == 2 { print $9 }' "$scratch/dataset")
check "by one alone" says 0 " 40 *1 .* $pairs_of_dataset$" "$dataset" --poses 40 --triangles 3000 --workers 1
check "of which there is one row" test "$(grep -c '^ *[0-9]* *40 ' "$scratch/out")" -eq 1
check "rounded coordinates" says 0 "all answers are the same" "$dataset" --poses 40 --triangles 3000 \
    --grid 64 --check 1
more_pairs() {
    awk -v before="$pairs_of_dataset" '$2 == 40 && $3 == 2 { more = $NF > before } END { exit !more }' "$scratch/out"
}
check "touch more often" more_pairs
check "the poses as a scene" "$dataset" --poses 40 --triangles 3000 --export "$scratch/poses"
check "with the rest pose before them" test "$(cut -d' ' -f 3 "$scratch/poses/meta.txt")" -eq 41
check "and all pairs in them" test "$pairs_of_dataset" -eq "$("$SC_BIN/sc-bench" --scene-dir "$scratch/poses" \
    --once --repeats 1 --methods aabb --pairs triangle --json |
    sed -n 's/.*"pairs":\([0-9]*\).*/\1/p' | awk '{ sum += $1 } END { print sum }')"
check "too few triangles" says 2 "2000 to" "$dataset" --triangles 500
check "no poses" says 2 "--poses" "$dataset" --poses 0
check "no such argument" says 2 "'poses' is no option" "$dataset" poses
check "where no scene can be written" says 2 "absent" "$dataset" --poses 1 --triangles 2000 \
    --export "$scratch/absent/deep/poses"
check "where no lines can be written" says 2 "cannot be written" "$dataset" --poses 1 --triangles 2000 \
    --csv "$scratch/absent/a.csv"

# ---- two builds of the library against each other ----

against=$SC_BIN/sc-against
library=$SC_LIB/libstarcontour.so
if [ "$SC_CONFIG" = sanitize ] || [ ! -e "$library" ]; then
    skip "sc-against: a library with sanitizers cannot be loaded by it, or there is none"
else
    cp "$library" "$scratch/other.so"
    check "a scene" small --export "$scratch/scene"
    check "a library against itself" says 0 "geometric mean *step\*2" \
        "$against" --ways exact,aabb@base,step*2 --frames 2 --rounds 1 \
        "$scratch/other.so" "$library" "$scratch/scene"
    check "a row for each way" test "$(grep -c '^scene  *\(exact\|aabb@base\|step\*2\) ' "$scratch/out")" -eq 3
    check "no such way" says 2 "no method 'exakt'" "$against" --ways exakt "$library" "$library" "$scratch/scene"
    check "no such set" says 2 "'neon'" "$against" --ways exact@neon "$library" "$library" "$scratch/scene"
    check "no such library" says 2 "absent.so" "$against" "$scratch/absent.so" "$library" "$scratch/scene"
    check "no library" says 2 "scene" "$against" "$scratch/scene" "$library" "$scratch/scene"
    check "no such scene" says 2 "absent" "$against" "$library" "$library" "$scratch/absent"
    check "no scene" says 2 "are wanted" "$against" "$library" "$library"
    # A library that counts one pair more than there are.
    cat >"$scratch/wrong.c" <<'EOT'
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include "starcontour.h"
static void *find(const char *name)
{
    static void *handle;
    if (!handle) handle = dlopen(getenv("SC_RIGHT"), RTLD_NOW | RTLD_LOCAL);
    return dlsym(handle, name);
}
#define CALL(type, name, list, ...)                                                                \
    __attribute__((visibility("default"))) type name list                                          \
    {                                                                                              \
        type(*call) list;                                                                          \
        void *found = find(#name);                                                                 \
        memcpy(&call, &found, sizeof(found));                                                      \
        return call(__VA_ARGS__);                                                                  \
    }
CALL(sc_status, sc_build, (const sc_mesh *m, const sc_build_options *o, sc_model **r), m, o, r)
CALL(void, sc_model_free, (sc_model * m), m)
CALL(sc_status, sc_workspace_create_for,
     (const sc_model *m, const sc_workspace_options *o, sc_workspace **w), m, o, w)
CALL(void, sc_workspace_free, (sc_workspace * w), w)
CALL(sc_status, sc_query_step,
     (const sc_model *m, sc_workspace *w, const sc_pose *a, const sc_pose *b,
      const sc_step_options *o, sc_step_result *r), m, w, a, b, o, r)
sc_status sc_query(const sc_model *m, sc_workspace *w, const sc_pose *p, const sc_query_options *o,
                   sc_result *r)
{
    sc_status (*call)(const sc_model *, sc_workspace *, const sc_pose *, const sc_query_options *,
                      sc_result *);
    void *found = find("sc_query");
    sc_status status;
    memcpy(&call, &found, sizeof(found));
    status = call(m, w, p, o, r);
    ++r->count;
    return status;
}
EOT
    # shellcheck disable=SC2086
    if $CC -shared -fPIC -Iinclude $SC_FLAGS -o "$scratch/wrong.so" "$scratch/wrong.c" 2>"$scratch/wrong.log"; then
        SC_RIGHT=$library
        export SC_RIGHT
        check "numbers of pairs that differ" says 1 "frame 0, exact: .* pairs, and" \
            "$against" --ways exact --frames 1 --rounds 1 "$library" "$scratch/wrong.so" "$scratch/scene"
    else
        skip "a library that counts wrongly: it cannot be built here"
    fi
fi

finish
