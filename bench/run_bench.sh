#!/bin/sh
# Measures the methods on all scenes and writes a report: CSV files, report.md and plots.
#
#     bench/run_bench.sh full|quick|report [FOLDER]
#
# FOLDER is where results go; by default bench/results/<machine>, and the overview into README.md,
# or, for quick, build/bench-quick. report measures nothing and makes the report anew from the CSV
# files. What sc-bench prints is kept in build/bench/. Peers come from build/peers/peers.csv,
# near.csv, trace.csv, objects.csv, dataset.csv and wasm.csv, if they are there. From make come
# SC_BIN and PYTHON, the interpreter that draws.
#
# Exit status 1 if methods disagree or no report could be made, 2 if nothing could be started.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

SC_BIN=${SC_BIN:-build/bin}
kind=${1:-full}
cores=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)

# With each set of instructions that this machine has; on other systems than Linux only the
# compiler's own.
sets=exact@base,aabb@base
if grep -qw avx2 /proc/cpuinfo 2>/dev/null; then sets=exact@avx2,aabb@avx2,$sets; fi
if grep -qw avx512vl /proc/cpuinfo 2>/dev/null; then sets=exact@avx512,aabb@avx512,$sets; fi
turns=exact,exact@serial,aabb,aabb@serial
near_sets=$(echo "$sets" | sed 's/exact/near/g; s/aabb/near-boxes/g')

# A line a run: scene, triangles, frames, passes, partition, pairs, methods or -, other options. The
# default build, with the built-in partition; pairs of an edge and a triangle, as in the paper. The
# other runs compare partitions (METIS, and the order that the maker of a cloth knows), resolutions,
# kinds of pairs, threads, and repeated queries with single ones; instructions and threads of one
# query; heavy contact, on the frames that peers get; single queries from nothing; steps; and what
# is near, at distances from a twentieth of an edge to two edges.
full="\
twisted-cloth 4096 60 3 fast edge -
twisted-cloth 16384 60 3 fast edge -
twisted-cloth 65536 60 3 fast edge -
twisted-cloth 262144 20 2 fast edge -
twisted-cloth 1048576 8 1 fast edge -
cloth-sphere 20000 60 3 fast edge -
cloth-sphere 80000 60 3 fast edge -
cloth-sphere 320000 20 1 fast edge -
cat 41000 60 3 fast edge -
cat 165000 60 2 fast edge -
cat 656000 2 3 fast edge -
bunny 3400 60 3 fast edge -
bunny 13600 60 3 fast edge -
bunny 54500 60 3 fast edge -
bunny-bumpy 54500 60 3 fast edge -
bunny-spiky 54500 60 3 fast edge -
horse 1600 60 3 fast edge -
horse 6300 60 3 fast edge -
horse 25000 60 3 fast edge -
wrinkled-cloth 100352 60 2 fast edge -
crushed-cloth 92416 60 2 fast edge -
tight-rods 98304 60 2 fast edge -
squeezed-rods 98304 6 3 fast edge -
sphere 20480 20 3 fast edge -
sphere 81920 60 2 fast edge -
sphere 327680 20 1 fast edge -
sphere 1310720 2 3 fast edge -
twisted-cloth 65536 60 2 metis edge exact,star,aabb-sctt,aabb
twisted-cloth 65536 60 2 structure edge exact,star,aabb-sctt,aabb
cloth-sphere 80000 60 2 metis edge exact,star,aabb-sctt,aabb
cloth-sphere 80000 60 2 structure edge exact,star,aabb-sctt,aabb
bunny 54500 60 2 metis edge exact,star,aabb-sctt,aabb
cat 41000 60 2 metis edge exact,star,aabb-sctt,aabb
twisted-cloth 65536 20 3 fast triangle -
cloth-sphere 80000 20 3 fast triangle -
bunny 54500 20 3 fast triangle -
cat 41000 20 3 fast triangle -
wrinkled-cloth 100352 20 2 fast triangle -
twisted-cloth 65536 20 3 fast edge exact,star,aabb --threads $cores
bunny 54500 20 3 fast edge exact,star,aabb --threads $cores
twisted-cloth 65536 20 5 fast edge exact,star,aabb-sctt,aabb --warm
bunny 54500 20 5 fast edge exact,star,aabb-sctt,aabb --warm
twisted-cloth 65536 20 4 fast edge $turns --workers $cores
cloth-sphere 80000 20 4 fast edge $turns --workers $cores
bunny 54500 20 4 fast edge $turns --workers $cores
cat 165000 20 4 fast edge $turns --workers $cores
cat 656000 2 4 fast edge $turns --workers $cores
bunny-spiky 54500 20 4 fast edge $turns --workers $cores
sphere 1310720 2 4 fast edge $turns --workers $cores
wrinkled-cloth 100352 20 4 fast edge $turns --workers $cores
crushed-cloth 92416 6 6 fast edge $turns --workers $cores
tight-rods 98304 6 6 fast edge $turns --workers $cores
squeezed-rods 98304 6 6 fast edge $turns --workers $cores
twisted-cloth 65536 20 3 fast edge $sets
bunny 54500 20 3 fast edge $sets
crushed-cloth 92416 6 5 fast edge $sets
crushed-cloth 92416 6 5 fast edge exact,aabb --near
squeezed-rods 98304 6 5 fast edge exact,aabb --near
horse 25000 60 5 fast edge exact,aabb --one-shot
bunny 54500 20 5 fast edge exact,aabb --one-shot
bunny 54500 20 1 metis edge exact --one-shot
bunny 70000 2 7 fast edge exact,aabb --one-shot
bunny 70000 2 1 metis edge exact --one-shot
twisted-cloth 65536 20 5 fast edge exact,aabb --one-shot
twisted-cloth 65536 20 1 metis edge exact --one-shot
tight-rods 98304 6 3 fast edge exact,aabb --one-shot
sphere 81920 60 3 fast edge exact,aabb --one-shot
cat 165000 60 3 fast edge exact,aabb --one-shot
cat 165000 60 1 metis edge exact --one-shot
cat 656000 2 1 fast edge exact,aabb --one-shot
twisted-cloth 1048576 8 1 fast edge exact,aabb --one-shot
twisted-cloth 1048576 8 1 metis edge exact --one-shot
sphere 1310720 2 1 fast edge exact,aabb --one-shot
twisted-cloth 16384 60 1 fast step -
twisted-cloth 65536 60 1 fast step step,step-none,step-two-boxes
cloth-sphere 80000 60 1 fast step step,step-none,step-two-boxes
cat 41000 60 1 fast step step,step-none,step-two-boxes
bunny 13600 60 1 fast step -
bunny 54500 60 1 fast step step,step-none,step-two-boxes
bunny-bumpy 54500 60 1 fast step step,step-none,step-two-boxes
bunny-spiky 54500 60 1 fast step step,step-none,step-two-boxes
horse 25000 60 1 fast step step,step-none,step-two-boxes
wrinkled-cloth 6272 60 1 fast step -
crushed-cloth 5776 60 1 fast step -
tight-rods 6144 60 1 fast step -
sphere 81920 60 1 fast step step,step-none,step-two-boxes
twisted-cloth 65536 8 2 fast near - --distance 0.05
cloth-sphere 80000 8 2 fast near - --distance 0.05
bunny 54500 8 2 fast near - --distance 0.05
crushed-cloth 92416 6 2 fast near - --distance 0.05
twisted-cloth 65536 8 2 fast near - --distance 0.2
cloth-sphere 80000 8 2 fast near - --distance 0.2
bunny 54500 8 2 fast near - --distance 0.2
crushed-cloth 92416 6 2 fast near - --distance 0.2
twisted-cloth 65536 8 2 fast near - --distance 0.5
cloth-sphere 80000 8 2 fast near - --distance 0.5
bunny 54500 8 2 fast near - --distance 0.5
crushed-cloth 92416 6 2 fast near - --distance 0.5
twisted-cloth 65536 8 2 fast near - --distance 1
cloth-sphere 80000 8 2 fast near - --distance 1
bunny 54500 8 2 fast near - --distance 1
crushed-cloth 92416 6 2 fast near - --distance 1
twisted-cloth 65536 6 1 fast near - --distance 2
bunny 54500 6 1 fast near - --distance 2
crushed-cloth 5776 6 2 fast near - --distance 0.05
crushed-cloth 5776 6 2 fast near - --distance 0.2
crushed-cloth 5776 6 2 fast near - --distance 0.5
crushed-cloth 5776 6 2 fast near - --distance 1
crushed-cloth 5776 6 2 fast near - --distance 2
twisted-cloth 65536 60 2 fast near near,near-boxes --distance 1 --ignore-rings 4
twisted-cloth 65536 8 3 fast near $near_sets --distance 1
crushed-cloth 92416 6 3 fast near $near_sets --distance 0.5
twisted-cloth 65536 8 3 fast near near,near@serial --distance 1 --workers 2
crushed-cloth 92416 6 3 fast near near,near@serial --distance 0.5 --workers 2"

quick="\
twisted-cloth 4096 8 3 fast edge -
twisted-cloth 16384 8 3 fast edge -
twisted-cloth 65536 8 1 fast edge -
cloth-sphere 20000 8 1 fast edge -
cat 41000 8 1 fast edge -
bunny 3400 8 3 fast edge -
bunny 13600 8 1 fast edge -
bunny-bumpy 13600 8 1 fast edge -
bunny-spiky 13600 8 1 fast edge -
horse 1600 8 3 fast edge -
horse 6300 8 3 fast edge -
sphere 81920 4 1 fast edge -
twisted-cloth 16384 8 3 metis edge exact,star,aabb-sctt,aabb
twisted-cloth 16384 8 3 fast triangle -
twisted-cloth 16384 8 3 fast edge exact,star,aabb --threads $cores
bunny 13600 8 3 fast edge exact,star,aabb-sctt,aabb --warm
twisted-cloth 65536 8 1 fast edge $turns --workers $cores
twisted-cloth 16384 8 1 fast edge $sets
crushed-cloth 5776 6 1 fast edge exact,aabb --near
bunny 13600 8 3 fast edge exact,aabb --one-shot
bunny 13600 8 1 metis edge exact --one-shot
twisted-cloth 16384 8 1 fast step -
bunny 13600 8 1 fast step -
twisted-cloth 16384 4 1 fast near - --distance 0.05
twisted-cloth 16384 4 1 fast near - --distance 0.2
twisted-cloth 16384 4 1 fast near - --distance 0.5
twisted-cloth 16384 4 1 fast near - --distance 1
crushed-cloth 5776 6 1 fast near - --distance 0.05
crushed-cloth 5776 6 1 fast near - --distance 0.2
crushed-cloth 5776 6 1 fast near - --distance 0.5
crushed-cloth 5776 6 1 fast near - --distance 1
twisted-cloth 16384 4 1 fast near $near_sets --distance 1"

# The two that the contour test's price, and that of culling in vain, are read from: two methods in
# turn, so that each follows the other. Where all take turns, what follows the hash finds the caches
# full of it.
by_two() {
    awk '$6 == "edge" && $7 == "-" && $2 < 400000 {
        for (i = 0; i < 2; i++)
            print $1, $2, $3, ($4 < 3 ? 3 : $4), $5, $6, (i ? "exact,aabb" : "exact,none")
    }'
}

# What is near, by those that are compared most closely: a still step and inflated boxes, which take
# ten times as long, would leave nothing of theirs in the caches.
near_alone() {
    awk '$6 == "near" && $7 == "-" {
        $4 = $4 < 3 ? 3 : $4
        $7 = "near,near-count,near-boxes"
        print
    }'
}

# Runs that are repeated by the library as other compilers make it, or for other processors: a name
# and what make is told. Each takes its turn, rounds times, in a process of its own.
builds="\
clang CC=clang
plain CPPFLAGS=-DSC_NO_SIMD"
rounds=3
built="\
twisted-cloth 65536 20 1 fast
bunny 54500 20 1 fast
crushed-cloth 92416 6 2 fast"

case $kind in
full | report)
    runs="$full
$(echo "$full" | by_two)
$(echo "$full" | near_alone)"
    readme=
    [ $# -gt 1 ] || readme='--readme README.md'
    results=${2:-bench/results/$(bench/machine.sh)}
    ;;
quick)
    runs="$quick
$(echo "$quick" | by_two)
$(echo "$quick" | near_alone)"
    builds=
    readme=
    results=${2:-build/bench-quick}
    ;;
*)
    echo "usage: bench/run_bench.sh full|quick|report [FOLDER]" >&2
    exit 2
    ;;
esac

# $PYTHON, or the first that can draw, or any: the report is written without plots then.
python=
for candidate in ${PYTHON:-python3 /usr/bin/python3}; do
    command -v "$candidate" >/dev/null 2>&1 || continue
    if "$candidate" -c 'import matplotlib' >/dev/null 2>&1; then
        python=$candidate
        break
    fi
    [ -n "$python" ] || python=$candidate
done
if [ -z "$python" ]; then
    echo "bench: needs python3, and matplotlib for plots: run 'make deps with=bench' first" >&2
    exit 2
fi

mkdir -p "$results" || exit 2
if [ "$kind" != quick ] && [ -f build/peers/peers.csv ]; then
    cp build/peers/peers.csv "$results" || exit 2
fi
if [ "$kind" != quick ] && [ -f build/peers/near.csv ]; then
    cp build/peers/near.csv "$results/near_peers.csv" || exit 2
fi
if [ "$kind" != quick ] && [ -f build/peers/trace.csv ]; then
    cp build/peers/trace.csv "$results/trace_peers.csv" || exit 2
fi
if [ "$kind" != quick ] && [ -f build/peers/objects.csv ]; then
    cp build/peers/objects.csv "$results/objects_peers.csv" || exit 2
fi
if [ "$kind" != quick ] && [ -f build/peers/dataset.csv ]; then
    cp build/peers/dataset.csv "$results/dataset_peers.csv" || exit 2
fi
if [ "$kind" != quick ] && [ -f build/peers/wasm.csv ]; then
    cp build/peers/wasm.csv "$results/wasm.csv" || exit 2
fi
if [ "$kind" = report ]; then
    # shellcheck disable=SC2086
    exec "$python" bench/draw_report.py $readme "$results"
fi

raw=build/bench/$kind
mkdir -p "$raw" || exit 2
rm -f "$raw"/*.jsonl "$raw"/*.shots "$raw"/*.built "$raw"/*.objects "$raw"/*.dataset "$raw"/*.log

# Makes sc-bench as the others of $builds have it, before anything is timed; $others are those that
# can be run.
others=
while read -r name settings; do
    [ -n "$name" ] || continue
    echo "bench: compiling: $name" >&2
    # shellcheck disable=SC2086
    if MAKEFLAGS='' make -j "$cores" BUILD="build/bench-$name" $settings "build/bench-$name/bin/sc-bench" \
        >"$raw/$name.make" 2>&1 </dev/null; then
        others="$others $name"
    else
        echo "bench: skipped: built by $name: make failed, see $raw/$name.make" >&2
        echo "built by $name" >>"$raw/skipped.log"
    fi
done <<END
$builds
END

count=$(echo "$runs" | wc -l)
number=0
status=0
begin=$(date +%s)
while read -r scene triangles frames passes partition pairs methods options; do
    number=$((number + 1))
    if [ "$methods" = - ]; then
        methods=exact,star,none,aabb-sctt,aabb,hash
        [ "$pairs" = step ] && methods=step,step-star,step-none,step-two-boxes,step-swept
        [ "$pairs" = near ] && methods=near,near-count,near-boxes,near-still,near-inflated
    fi
    mode=--once
    end=jsonl
    given=$options
    case $options in
    --warm) mode='' options='' ;;
    --one-shot) mode='' end=shots ;;
    esac
    echo "bench: $number of $count, $(($(date +%s) - begin)) s: $scene $triangles $partition $pairs $given" >&2
    out=$raw/$(printf '%02d' "$number").$end
    # shellcheck disable=SC2086
    "$SC_BIN/sc-bench" --json --scene "$scene" --triangles "$triangles" --frames "$frames" $mode \
        --repeats "$passes" --partition "$partition" --pairs "$pairs" --methods "$methods" $options \
        >"$out" </dev/null
    case $? in
    0) ;;
    1)
        status=1
        echo "bench: $scene: METHODS DISAGREE" >&2
        ;;
    *)
        rm -f "$out"
        echo "bench: skipped: $scene $triangles" >&2
        echo "$scene $triangles $partition $pairs" >>"$raw/skipped.log"
        ;;
    esac
done <<END
$runs
END

if [ -n "$others" ]; then
    round=0
    while [ $((round += 1)) -le "$rounds" ]; do
        while read -r scene triangles frames passes partition; do
            for name in this $others; do
                echo "bench: round $round, $(($(date +%s) - begin)) s: $scene $triangles by $name" >&2
                program=$SC_BIN
                [ "$name" = this ] || program=build/bench-$name/bin
                "$program/sc-bench" --json --once --scene "$scene" --triangles "$triangles" --frames "$frames" \
                    --repeats "$passes" --partition "$partition" --pairs edge --methods exact,aabb \
                    >"$raw/$name.$scene.$round.built" </dev/null || status=1
            done
        done <<END
$built
END
    done
fi

# Several objects, by one thread and by all.
objects_scale=1
[ "$kind" = quick ] && objects_scale=0.05
for workers in $(printf '1\n%s\n' "$cores" | sort -nu); do
    echo "bench: several objects, $workers threads, $(($(date +%s) - begin)) s" >&2
    "$SC_BIN/sc-objects" --scale "$objects_scale" --workers "$workers" --csv "$raw/$workers.objects" \
        >"$raw/$workers.objects.log" </dev/null || status=1
done

# Many poses of one model, by one thread beside two, and beside all.
poses=100000
[ "$kind" = quick ] && poses=2000
for workers in $(printf '2\n%s\n' "$cores" | sort -nu); do
    [ "$workers" -le "$cores" ] || continue
    echo "bench: $poses poses of one model, 1 and $workers threads, $(($(date +%s) - begin)) s" >&2
    "$SC_BIN/sc-dataset" --poses "$poses" --workers "$workers" --csv "$raw/$workers.dataset" \
        >"$raw/$workers.dataset.log" </dev/null || status=1
done

command="make bench"
[ "$kind" = quick ] && command="make bench-quick"
# shellcheck disable=SC2086
"$python" bench/draw_report.py --command "$command" --seconds $(($(date +%s) - begin)) $readme \
    --programs "$SC_BIN" "$results" "$raw" || status=1
exit $status
