#!/bin/sh
# `make dataset-peers`: times libraries from PyPI beside ours on poses of sc-dataset's character,
# and on the same poses with coordinates rounded to multiples of 1/512, by dataset.py, into a new
# CSV file. Wrong answers are no failure, but what the file is about.
#
#     bench/peers/measure_dataset.sh CSV SC-DATASET LIBRARY BUILD     from the top of the repository
#
# A peer that cannot be installed is skipped with a message, which the file keeps. Those that take
# seconds a pose get fewer poses: the first ones of the same. $POSES: no peer gets more. Those that
# can use more than one thread are run with all as well. The machine ought to be quiet.
#
# SPDX-License-Identifier: MIT
set -u

csv=$1
dataset=$2
library=$3
build=$4
here=${0%/*}
poses=${POSES:-200}

mkdir -p "${csv%/*}" && echo "# commit: $(git describe --always --abbrev=12 --dirty=+ --exclude='*' \
    2>/dev/null || echo unknown)" >"$csv" || exit 2
scenes=$build/peers/scenes/$poses-poses
for scene in poses rounded; do
    [ ! -d "$scenes/$scene" ] || continue
    grid=0
    [ "$scene" = poses ] || grid=512
    rm -rf "$scenes/$scene.new"
    mkdir -p "$scenes" &&
        "$dataset" --poses "$poses" --grid "$grid" --export "$scenes/$scene.new" </dev/null &&
        mv "$scenes/$scene.new" "$scenes/$scene" || exit 2
done
again=
[ "$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)" -eq 1 ] || again=all
status=0
# Peer, poses at most, and whether it can use all threads.
while read -r peer most also; do
    [ "$most" -le "$poses" ] || most=$poses
    "$here/venv.sh" "$build/peers/venv" "$peer" "$csv" </dev/null || {
        [ $? -eq 3 ] || status=1
        continue
    }
    for scene in poses rounded; do
        for threads in 1 ${also:+$again}; do
            "$build/peers/venv/bin/python" "$here/dataset.py" --peer "$peer" --poses "$most" \
                --threads "$threads" --lib "$library" --csv "$csv" "$scenes/$scene" </dev/null ||
                [ $? -eq 3 ] || status=1
        done
    done
done <<END
libigl 200
meshlib 200 all
trueform 200 all
pymeshlab 200
python-fcl 40
open3d 40 all
END
exit $status
