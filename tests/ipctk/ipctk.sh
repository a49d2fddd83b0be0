#!/bin/sh
# `make test-ipctk`: compares steps with those of ipc-toolkit, by compare.py, and what is near, by
# compare_near.py, on all scenes of sc-bench.
#
#     tests/ipctk/ipctk.sh SC-BENCH LIBRARY BUILD     from the top of the repository
#
# ipc-toolkit comes from PyPI, into a virtual environment below BUILD; if it cannot be had, the
# comparison is skipped with a message. Scenes are small: ipc-toolkit's candidates, hundreds of
# thousands, are gone through in Python; of 60 frames every tenth step is taken, and for what is
# near two poses. Scenes whose meshes were not fetched are skipped, too. Last line: "N passed, N
# failed, N skipped", where scenes are counted, each of them for steps and for what is near. Some
# minutes.
#
# SPDX-License-Identifier: MIT
set -u

bench=$1
library=$2
build=$3

mkdir -p "$build/ipctk" || exit 2
bench/peers/venv.sh "$build/peers/venv" ipctk "$build/ipctk/skipped" || {
    test $? -eq 3 || exit 1
    echo "0 passed, 0 failed, 1 skipped"
    exit 0
}

# Name, triangles, frames.
scenes=
skipped=0
while read -r name triangles frames; do
    scene=$build/ipctk/$triangles-$frames/$name
    if [ ! -d "$scene" ]; then
        rm -rf "$scene.new"
        mkdir -p "${scene%/*}"
        if ! "$bench" --scene "$name" --triangles "$triangles" --frames "$frames" \
            --cache "$build/scenes" --export "$scene.new" </dev/null || ! mv "$scene.new" "$scene"; then
            echo "skipped: $name: sc-bench could not write it"
            skipped=$((skipped + 1))
            continue
        fi
    fi
    scenes="$scenes $scene"
done <<END
twisted-cloth 4096 60
cloth-sphere 5000 60
wrinkled-cloth 6272 60
crushed-cloth 5776 60
cat 5200 60
bunny 3400 60
bunny-bumpy 3400 60
bunny-spiky 3400 60
horse 1600 60
sphere 5120 60
tight-rods 6144 60
END
if [ -z "$scenes" ]; then
    echo "skipped: no scene to compare on"
    echo "0 passed, 0 failed, $skipped skipped"
    exit 0
fi
compare() {
    "$build/peers/venv/bin/python" tests/ipctk/compare.py --lib "$library" --every 10 "$@"
}
# The comparison notices what is missing: without the contour test, a collision of the wrinkled
# cloth is.
wrinkled=$build/ipctk/6272-60/wrinkled-cloth
if [ -d "$wrinkled" ]; then
    compare --contour-none "$wrinkled" >"$build/ipctk/none.log"
    if [ $? -ne 1 ]; then
        cat "$build/ipctk/none.log"
        echo "failed: missing collisions are not noticed"
        echo "0 passed, 1 failed, $skipped skipped"
        exit 1
    fi
fi
compare_near() {
    "$build/peers/venv/bin/python" tests/ipctk/compare_near.py --lib "$library" --every 30 "$@"
}
# It notices what is missing, and what is too much: a distance that is off by a thousandth.
crushed=$build/ipctk/5776-60/crushed-cloth
for shift in 0.999 1.001; do
    [ -d "$crushed" ] || continue
    compare_near --shift $shift "$crushed" >"$build/ipctk/shift.log"
    if [ $? -ne 1 ]; then
        cat "$build/ipctk/shift.log"
        echo "failed: a wrong distance is not noticed"
        echo "0 passed, 1 failed, $skipped skipped"
        exit 1
    fi
done
# Both, and one last line for them.
status=0
log=$build/ipctk/all.log
: >"$log"
for what in compare compare_near; do
    # shellcheck disable=SC2086
    $what --skipped "$skipped" $scenes >"$build/ipctk/$what.log" || status=1
    grep -Ev '^[0-9]+ passed, ' "$build/ipctk/$what.log"
    cat "$build/ipctk/$what.log" >>"$log"
done
awk '/^[0-9]+ passed, / { passed += $1; failed += $3; skipped += $5 }
    END { printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped }' "$log"
exit $status
