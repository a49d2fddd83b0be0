#!/bin/sh
# Runs a peer on scenes, in one thread and then in all, and adds lines to a CSV file.
#
#     bench/peers/measure_peer.sh CSV "SCENE..." SC-BENCH COMMAND...
#
# Where no scenes are named, those below are written by sc-bench into build/peers/scenes, once. Fails as
# the command does.
#
# SPDX-License-Identifier: MIT
set -u

csv=$1
scenes=$2
bench=$3
shift 3

# Name, triangles, frames.
usual="\
twisted-cloth 16384 12
twisted-cloth 65536 12
cloth-sphere 20000 12
cat 41000 12
bunny 13600 12
horse 6300 12
sphere 81920 4"

if [ -z "$scenes" ]; then
    if [ ! -x "$bench" ]; then
        echo "no scene to measure: SCENES names folders, see bench/peers/README.md" >&2
        exit 2
    fi
    folder=build/peers/scenes
    mkdir -p "$folder" || exit 2
    while read -r name triangles frames; do
        scene=$folder/$triangles/$name
        if [ ! -d "$scene" ]; then
            mkdir -p "$folder/$triangles" || exit 2
            "$bench" --scene "$name" --triangles "$triangles" --frames "$frames" \
                --export "$scene.new" </dev/null && mv "$scene.new" "$scene" || exit 2
        fi
        scenes="$scenes $scene"
    done <<END
$usual
END
fi

mkdir -p "$(dirname "$csv")" || exit 2
counts=1
[ "$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)" -eq 1 ] || counts="1 all"
for threads in $counts; do
    # shellcheck disable=SC2086
    "$@" --threads "$threads" --csv "$csv" $scenes || exit
done
