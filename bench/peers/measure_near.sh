#!/bin/sh
# `make near-peers`: times ipc-toolkit beside what is near, by near.py, into a new CSV file.
#
#     bench/peers/measure_near.sh CSV "SCENES" SC-BENCH LIBRARY BUILD   from the top
#
# Without SCENES, folders as sc-bench --export writes them, sc-bench writes those below into
# BUILD/peers/scenes. ipc-toolkit comes from PyPI, into a virtual environment below BUILD; if it
# cannot be had, that is said and nothing is measured.
#
# SPDX-License-Identifier: MIT
set -u

csv=$1
scenes=$2
bench=$3
library=$4
build=$5
here=${0%/*}

mkdir -p "${csv%/*}" && rm -f "$csv" || exit 2
"$here/venv.sh" "$build/peers/venv" ipctk "$csv.skipped" || {
    test $? -eq 3 && exit 0
    exit 1
}

# A scene and distances. Each is a process of its own.
status=0
near() {
    "$build/peers/venv/bin/python" "$here/near.py" --lib "$library" --csv "$csv" --distances "$2" "$1" ||
        status=1
}
if [ -n "$scenes" ]; then
    for scene in $scenes; do
        near "$scene" 0.05,0.2,0.5,1,2
    done
    exit $status
fi
# Name, triangles, frames, distances; the largest lists have some ten million pairs.
while read -r name triangles frames distances; do
    scene=$("$here/write_scene.sh" "$bench" "$build" "$name" "$triangles" "$frames") || continue
    near "$scene" "$distances" </dev/null
done <<END_OF_SCENES
twisted-cloth 65536 6 0.05,0.2,0.5,1,2
cloth-sphere 80000 6 0.05,0.2,0.5,1
bunny 54500 6 0.05,0.2,0.5,1
crushed-cloth 5776 6 0.05,0.2,0.5,1,2
crushed-cloth 92416 6 0.05,0.2,0.5,1
END_OF_SCENES
exit $status
