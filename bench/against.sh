#!/bin/sh
# Builds another commit and compares its speed with this tree's, on the same frames, in turns.
#
#     bench/against.sh REV SC-AGAINST SC-BENCH NEW.so [OPTION...]     options of sc-against
#
# The other commit's library is built in build/against/COMMIT, once. Scenes are some of sc-bench's
# own, written to build/against/scenes, once, and all folders in SCENE_DIRS (a list) that are there.
# Exit status as sc-against has it.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

rev=${1:-}
if [ $# -lt 4 ] || [ -z "$rev" ]; then
    echo "usage: make bench-against REV=COMMIT [AGAINST='options of sc-against']" >&2
    exit 2
fi
against=$2
bench=$3
new=$4
shift 4
commit=$(git rev-parse --verify --quiet --short=12 "$rev^{commit}") || {
    echo "against.sh: there is no commit $rev" >&2
    exit 2
}

# Without what the caller's make was told, but for compiler and flags: both are built alike.
built=build/against/$commit
if [ ! -e "$built/build/lib/libstarcontour.so" ]; then
    echo "building $commit" >&2
    rm -rf "$built" && mkdir -p "$built" && git archive "$commit" | tar -xf - -C "$built" &&
        (unset MAKEFLAGS MFLAGS MAKELEVEL && cd "$built" &&
            "${MAKE:-make}" -s -j2 CC="${CC:-cc}" CFLAGS="${CFLAGS:-}" build/lib/libstarcontour.so) >&2 ||
        exit 2
fi

# Name, triangles, frames.
scenes=
while read -r name triangles frames; do
    scene=build/against/scenes/$name-$triangles
    if [ ! -d "$scene" ]; then
        mkdir -p build/against/scenes
        if ! "$bench" --scene "$name" --triangles "$triangles" --frames "$frames" \
            --export "$scene.new" </dev/null >/dev/null 2>build/against/scenes.log; then
            echo "skipped: $name: $(tail -n 1 build/against/scenes.log)"
            rm -rf "$scene.new"
            continue
        fi
        mv "$scene.new" "$scene" || exit 2
    fi
    scenes="$scenes $scene"
done <<END
twisted-cloth 65536 12
cloth-sphere 80000 12
bunny 54500 12
bunny-spiky 54500 12
cat 41000 12
horse 25000 12
wrinkled-cloth 100352 12
crushed-cloth 92416 12
tight-rods 98304 12
sphere 81920 6
END
for folder in ${SCENE_DIRS:-../shared/scenes}; do
    for scene in "$folder"/*/; do
        [ ! -e "$scene/meta.txt" ] || scenes="$scenes $scene"
    done
done

echo "old: $commit; new: $(git describe --always --abbrev=12 --dirty=+ --exclude='*')"
# shellcheck disable=SC2086
exec "$against" "$@" "$built/build/lib/libstarcontour.so" "$new" $scenes
