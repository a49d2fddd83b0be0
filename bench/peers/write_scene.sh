#!/bin/sh
# Sees to it that sc-bench has written a scene, and says in which folder it is.
#
#     bench/peers/write_scene.sh SC-BENCH BUILD NAME TRIANGLES FRAMES
#
# SPDX-License-Identifier: MIT
set -u

scene=$2/peers/scenes/$4-$5/$3
if [ ! -d "$scene" ]; then
    rm -rf "$scene.new"
    mkdir -p "${scene%/*}" && "$1" --scene "$3" --triangles "$4" --frames "$5" --cache "$2/scenes" \
        --export "$scene.new" </dev/null >&2 && mv "$scene.new" "$scene" || {
        echo "skipped: $3, $4 triangles: sc-bench could not write it" >&2
        exit 1
    }
fi
echo "$scene"
