#!/bin/sh
# Runs a peer on scenes, each in a process of its own, and adds lines to a CSV file.
#
#     bench/peers/measure_peer.sh PEER CSV "SCENE..." SC-BENCH COMMAND...
#
# Where no scenes are named, those below are written by sc-bench into build/peers/scenes, once; one
# that cannot be made is skipped with a message. Named scenes are run with one thread and then with
# all. A process that takes more than $LIMIT seconds (30) is ended, and so is one that asks for more
# than $MEMORY GB of address space (8; "unlimited": no limit), where the shell can set such a limit;
# the file says so. Fails as the command does.
#
# SPDX-License-Identifier: MIT
set -u

peer=$1
csv=$2
scenes=$3
bench=$4
shift 4
limit=${LIMIT:-30}
memory=${MEMORY:-8}
case $memory in
unlimited) kilobytes=unlimited ;;
*[!0-9.]* | . | *.*.*)
    echo "MEMORY is a number of GB, or 'unlimited', but not '$memory'" >&2
    exit 2
    ;;
*) kilobytes=$(awk -v gb="$memory" 'BEGIN { printf "%.0f", gb * 1e9 / 1024 }') ;;
esac
here=${0%/*}

# Name, triangles, frames, and whether they are run with all threads as well: whole animations in
# long steps and three timed walks, so that a peer is through in a minute or two. Two of them are
# also the frames of heavy contact in reports.
usual="\
twisted-cloth 65536 6 all
cloth-sphere 80000 6
cat 165000 6 all
bunny 54500 6 all
bunny-bumpy 54500 6
bunny-spiky 54500 6
horse 25000 6
wrinkled-cloth 100352 6
crushed-cloth 92416 6
tight-rods 98304 6
squeezed-rods 98304 6
sphere 81920 4
bunny 70000 2"

# It hands its candidates out as Python lists: of steps only small meshes, and no heavy contact.
[ "$peer" != ipctk ] || usual="\
twisted-cloth 4096 8
bunny 3400 4
twisted-cloth 65536 6
cloth-sphere 80000 6
cat 41000 6
bunny 54500 6
horse 25000 6"

# These take seconds where others take milliseconds.
case $peer in
open3d | python-fcl) usual="\
twisted-cloth 4096 6
bunny 3400 4
horse 6300 6" ;;
esac

# Steps of ipc-toolkit by a part of the way to the next of all frames, for which meshes may be
# large: scene, triangles, frames, and at which frames the steps start: rest, in motion, the last.
# Each is a process of its own.
steps=
parts="1/50 1/10 1"
[ "$peer" != ipctk ] || steps="\
twisted-cloth 65536 60 0 19 39 58
bunny 54500 60 0 29 58
crushed-cloth 92416 60 0 19 39 58"

# Writes a scene, and says in which folder.
write_scene() {
    "$here/write_scene.sh" "$bench" build "$1" "$2" "$3"
}

# What Python, C++ and C libraries say when they get no memory.
out_of_memory() {
    grep -Eqi 'MemoryError|bad_alloc|out of memory|cannot allocate memory'
}

# Its lines go to a file of their own first, so that one that is ended leaves none. $step says which
# step it is.
step=
measure() {
    threads=$1
    scene=$2
    shift 2
    rm -f "$csv.part" "$csv.said"
    guard="timeout $limit"
    command -v timeout >/dev/null 2>&1 || guard=
    # shellcheck disable=SC2086
    (
        ulimit -v "$kilobytes" 2>/dev/null
        exec $guard "$@" --threads "$threads" --csv "$csv.part" "$scene"
    ) </dev/null 2>"$csv.said"
    result=$?
    cat "$csv.said" >&2
    with=$step
    [ "$threads" = 1 ] || with="$step with all threads"
    if [ "$result" -eq 124 ] && [ -n "$guard" ]; then
        "$here/skip.sh" "$csv" "$peer on ${scene##*/}" "took more than $limit s$with"
        result=0
    elif [ "$result" -ne 0 ] && [ "$kilobytes" != unlimited ] && out_of_memory <"$csv.said"; then
        "$here/skip.sh" "$csv" "$peer on ${scene##*/}" "needed more than $memory GB of memory$with"
        result=0
    elif [ -f "$csv.part" ]; then
        if grep -q '^scene,' "$csv"; then
            grep -v '^scene,' "$csv.part" >>"$csv"
        else
            cat "$csv.part" >>"$csv"
        fi
    fi
    rm -f "$csv.part" "$csv.said"
    return $result
}

if [ -z "$scenes" ] && [ ! -x "$bench" ]; then
    echo "no scene to measure: SCENES names folders, see bench/peers/README.md" >&2
    exit 2
fi
mkdir -p "$(dirname "$csv")" && touch "$csv" || exit 2
again=
[ "$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)" -eq 1 ] || again=all
status=0
measured=0
if [ -n "$scenes" ]; then
    for threads in 1 $again; do
        for scene in $scenes; do
            measure "$threads" "$scene" "$@" || status=$?
        done
    done
    exit $status
fi
while read -r name triangles frames also; do
    if scene=$(write_scene "$name" "$triangles" "$frames"); then
        measured=1
        measure 1 "$scene" "$@" --repeats 3 || status=$?
        [ -z "$also" ] || [ -z "$again" ] || measure all "$scene" "$@" --repeats 3 || status=$?
    fi
done <<END
$usual
END
while read -r name triangles frames starts; do
    [ -n "$name" ] && scene=$(write_scene "$name" "$triangles" "$frames") || continue
    for start in $starts; do
        for part in $parts; do
            step=" (step $part from frame $start)"
            measure 1 "$scene" "$@" --repeats 3 --step "$part" --from "$start" || status=$?
        done
    done
done <<END
$steps
END
if [ "$measured" -eq 0 ]; then
    echo "no scene to measure" >&2
    exit 2
fi
exit $status
