#!/bin/sh
# Runs a peer on scenes, in one thread and then in all, and adds lines to a CSV file.
#
#     bench/peers/measure_peer.sh CSV "SCENE..." SC-BENCH COMMAND...
#
# Where no scenes are named, those below are written by sc-bench into build/peers/scenes, once; one that
# cannot be made is skipped with a message. Fails as the command does.
#
# SPDX-License-Identifier: MIT
set -u

csv=$1
scenes=$2
bench=$3
shift 3

# Name, triangles, frames: whole animations in long steps, so that all peers are through in minutes.
usual="\
twisted-cloth 16384 8
twisted-cloth 65536 6
cloth-sphere 20000 8
cat 41000 8
bunny 13600 8
horse 6300 8
sphere 81920 4"

# Writes a scene, and says in which folder.
write_scene() {
    scene=build/peers/scenes/$2-$3/$1
    if [ ! -d "$scene" ]; then
        rm -rf "$scene.new"
        mkdir -p "${scene%/*}" && "$bench" --scene "$1" --triangles "$2" --frames "$3" \
            --export "$scene.new" </dev/null >&2 && mv "$scene.new" "$scene" || return
    fi
    echo "$scene"
}

if [ -z "$scenes" ]; then
    if [ ! -x "$bench" ]; then
        echo "no scene to measure: SCENES names folders, see bench/peers/README.md" >&2
        exit 2
    fi
    while read -r name triangles frames; do
        if scene=$(write_scene "$name" "$triangles" "$frames"); then
            scenes="$scenes $scene"
        else
            echo "skipped: $name, $triangles triangles: sc-bench could not write it" >&2
        fi
    done <<END
$usual
END
    if [ -z "$scenes" ]; then
        echo "no scene to measure" >&2
        exit 2
    fi
fi

mkdir -p "$(dirname "$csv")" || exit 2
counts=1
[ "$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)" -eq 1 ] || counts="1 all"
status=0
for threads in $counts; do
    # shellcheck disable=SC2086
    "$@" --threads "$threads" --csv "$csv" $scenes || status=$?
done
exit $status
