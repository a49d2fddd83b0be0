#!/bin/sh
# `make bench-wasm`: times the package for npm, in Node, beside the library itself on the same
# frames, into a new CSV file.
#
#     bench/wasm_times.sh CSV SC-BENCH PACKAGE FOLDER [SCENE:TRIANGLES...]
#
# From the top of the repository. Scenes are written into FOLDER once. FRAMES of the environment:
# how many frames of each are taken; RUNS: how often each program runs, in turns, of which the least
# time counts. Fails if numbers of pairs differ. The machine ought to be quiet.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

csv=$1
bench=$2
package=$3
folder=$4
shift 4
[ $# -gt 0 ] || set -- twisted-cloth:65536 crushed-cloth:92416 sphere:81920 squeezed-rods:98304
frames=${FRAMES:-60}
runs=${RUNS:-3}

command -v node >/dev/null 2>&1 || { echo "make bench-wasm needs node ('make deps with=wasm')" >&2; exit 1; }
mkdir -p "${csv%/*}" "$folder" || exit 2

# native SCENE METHOD: prints the mean of the frames' medians, and the number of pairs in all.
native() {
    "$bench" --scene-dir "$1" --frames "$frames" --methods "$2" --once --repeats 3 --csv | awk -F, '
        /^#/ { next }
        !("ms" in column) { for (i = 1; i <= NF; ++i) column[$i] = i; next }
        { sum += $column["ms"]; pairs += $column["pairs"]; ++count }
        END { if (!count) exit 1; printf "%.4f %d\n", sum / count, pairs }'
}

{
    echo "# commit: $(git describe --always --abbrev=12 --dirty=+ --exclude='*' 2>/dev/null || echo unknown)"
    echo "# node: $(node --version)"
    echo "scene,triangles,frames,pairs,best_ms,base_ms,wasm_ms,same"
} >"$csv"
status=0
for scene in "$@"; do
    name=${scene%:*}
    at=$folder/$name-${scene#*:}-$frames
    if [ ! -d "$at" ]; then
        rm -rf "$at.new"
        "$bench" --scene "$name" --triangles "${scene#*:}" --frames "$frames" --export "$at.new" >/dev/null &&
            mv "$at.new" "$at" || { status=1; continue; }
    fi
    i=0
    : >"$folder/times"
    while [ "$i" -lt "$runs" ]; do
        for way in exact exact@base; do
            echo "$way $(native "$at" "$way")" >>"$folder/times"
        done
        echo "wasm $(node bench/wasm_times.mjs "$package" "$at" "$frames" 3)" >>"$folder/times"
        i=$((i + 1))
    done
    read -r triangles _ <"$at/meta.txt"
    awk -v name="$name" -v triangles="$triangles" -v frames="$frames" '
        NF != 3 { bad = 1 }
        !($1 in least) || $2 < least[$1] { least[$1] = $2 }
        { pairs[$3] = 1; found = $3 }
        END {
            for (number in pairs) ++answers
            if (bad) exit 2
            printf "%s,%d,%d,%d,%s,%s,%s,%d\n", name, triangles, frames, found, least["exact"],
                least["exact@base"], least["wasm"], answers == 1
            exit answers != 1
        }' "$folder/times" >>"$csv" || status=1
    tail -n 1 "$csv" | awk -F, '{ printf "%-16s %9s triangles: best %s, SSE2 %s, WebAssembly %s ms a frame, %.2f of the speed of SSE2\n",
        $1, $2, $5, $6, $7, $6 / $7 }'
done
exit $status
