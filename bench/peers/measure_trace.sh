#!/bin/sh
# `make trace-peers`: compares contours of sc_trace with the curves that libigl, CGAL and MeshLib
# find, and times all of them, by trace_curves.py, into a new CSV file.
#
#     bench/peers/measure_trace.sh CSV "SCENES" SC-BENCH LIBRARY CGAL BUILD   from the top
#
# CGAL is the shared library made of trace_cgal.cpp, or "" where there is none. Without SCENES,
# folders as sc-bench --export writes them, sc-bench writes those below. A peer that cannot be had
# is skipped with a message, which the file keeps, and so is one that takes more than $LIMIT seconds
# (900) for a scene. Fails if curves differ from those of libigl or CGAL. The machine ought to be
# quiet.
#
# SPDX-License-Identifier: MIT
set -u

csv=$1
scenes=$2
bench=$3
library=$4
cgal=$5
build=$6
limit=${LIMIT:-900}
here=${0%/*}
guard="timeout $limit"
command -v timeout >/dev/null 2>&1 || guard=

# The small ones are where libigl takes well below a second a frame.
usual="\
bunny 3400 6
crushed-cloth 5776 6
horse 6300 6
bunny 54500 6
crushed-cloth 92416 6
wrinkled-cloth 100352 6"

mkdir -p "${csv%/*}" && echo "# commit: $(git describe --always --abbrev=12 --dirty=+ --exclude='*' \
    2>/dev/null || echo unknown)" >"$csv" || exit 2
if [ -z "$scenes" ]; then
    scenes=$(echo "$usual" | while read -r name triangles frames; do
        "$here/write_scene.sh" "$bench" "$build" "$name" "$triangles" "$frames"
    done)
    if [ -z "$scenes" ]; then
        echo "no scene to measure: SCENES names folders, see bench/peers/README.md" >&2
        exit 2
    fi
fi
status=0
for peer in libigl cgal meshlib; do
    # CGAL needs numpy alone, which comes with libigl.
    package=$peer
    [ "$peer" != cgal ] || package=numpy
    if [ "$peer" = cgal ] && [ ! -f "$cgal" ]; then
        "$here/skip.sh" "$csv" cgal "its headers were not found ('make deps with=cgal')"
        continue
    fi
    "$here/venv.sh" "$build/peers/venv" "$package" "$csv" </dev/null || {
        [ $? -eq 3 ] || status=1
        continue
    }
    for scene in $scenes; do
        # shellcheck disable=SC2086
        $guard "$build/peers/venv/bin/python" "$here/trace_curves.py" --peer "$peer" --lib "$library" \
            --cgal "$cgal" --csv "$csv" "$scene" </dev/null
        case $? in
        0 | 3) ;;
        124) "$here/skip.sh" "$csv" "$peer on ${scene##*/}" "took more than $limit s" ;;
        *) status=1 ;;
        esac
    done
done
exit $status
