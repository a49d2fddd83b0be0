#!/bin/sh
# The page that sc-query --html writes, and its picture (--png): looked at in Chromium without a
# window, by playwright-core, where both are there; and that tools/page/page.html is what its
# sources give.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi

# Walls through a floor, a leaf through another, and one alone; then the same apart. Names that
# would end a script, or hide one, if they were written as they are.
make_mesh() { # FILE HEIGHT
    cat >"$1" <<EOT
o </script><b>odd
v 0 0 0
v 4 0 0
v 4 4 0
v 0 4 0
f 1 2 3 4
o two
v 1 1 $2
v 3 1 $2
v 3 1 5
v 1 1 5
f 5 6 7 8
v 1 2 $2
v 3 2 $2
v 3 2 5
v 1 2 5
f 9 10 11 12
o far
v 9 0 1
v 9.5 0 1
v 9 0.5 1
f 13 14 15
o leaf
v 9.1 0.1 $2
v 9.3 0.1 $2
v 9.2 0.2 5
f 16 17 18
o alone
v 6 3 1
v 8 3 1
v 7 4 1
f 19 20 21
EOT
}
hit="$scratch/hit<!--<script>.obj"
clean="$scratch/clean<!--<script>.obj"
make_mesh "$hit" -1
make_mesh "$clean" 2

# Two spikes through a floor, of which two halves are joined, and a wall through it; and all below
# it: for contours.
make_floor() { # FILE TOP-OF-SPIKE TOP-OF-WALL BOTTOM-OF-WALL
    cat >"$1" <<EOT
v 0 0 0
v 8 0 0
v 8 4 0
v 0 4 0
f 1 2 3
v 1 1 -1
v 3 1 -1
v 2 3 -1
v 2 1.7 $2
f 5 7 6
f 5 6 8
f 6 7 8
f 7 5 8
v 6 1 $4
v 6 3 $4
v 6 3 $3
v 6 1 $3
f 9 10 11 12
v 0 0 0
v 8 4 0
f 13 14 4
v 0.5 2.5 -1
v 1.5 2.5 -1
v 1 3.5 -1
v 1 2.8 $2
f 15 17 16
f 15 16 18
f 16 17 18
f 17 15 18
EOT
}
through="$scratch/through.obj"
below="$scratch/below.obj"
make_floor "$through" 2 1 -2
make_floor "$below" -0.5 -1 -4

# ---- without a browser ----

check "a page" status 1 "$query" --html "$scratch/page.html" "$hit" "$clean"
blocks() { # WHAT COUNT
    test "$(grep -c "^<script type=\"[a-z/]*\" $1=" "$scratch/page.html")" -eq "$2"
}
check "one mesh and two frames" blocks data-block 3
check "which are described" blocks data-frame 2
check "names end no script" sh -c "grep '^<script type=\"application/json\"' '$scratch/page.html' |
    sed -e 's/^<[^>]*>//' -e 's/<.script>\$//' | grep -c '<' | grep -qx 0"
check "nothing is fetched" sh -c "! grep -E '(src|href) *= *[\"'\\''](https?:)?//' '$scratch/page.html'"
check "the license of three.js is there" grep -q "Copyright .* three.js authors" "$scratch/page.html"
check "poses of a rest mesh" status 1 "$query" --rest "$hit" --html "$scratch/page.html" "$hit" "$clean"
check "are the same page" blocks data-frame 2
check "other meshes" status 1 "$query" --html "$scratch/page.html" "$hit" meshes/sphere.obj "$clean"
check "follow" blocks data-frame 3
check "each with its faces" blocks data-block 6
check "edges" status 1 "$query" --pairs edge --html "$scratch/edges.html" "$hit"
check "a file that cannot be done is left out" status 2 \
    "$query" --html "$scratch/page.html" "$hit" "$scratch/absent.obj"
check "of the page, too" blocks data-frame 1
check "a budget" status 3 "$query" --budget 1 --html "$scratch/budget.html" "$hit"
check "is told" grep -q '"incomplete":true' "$scratch/budget.html"
check "a folder that is not there" says 2 "cannot be written" "$query" --html "$scratch/no/page.html" "$hit"
check "no list, no page" says 2 "html" "$query" --any --html "$scratch/any.html" "$hit"
check "no page of steps" says 2 "html" "$query" --step --html "$scratch/any.html" "$hit" "$clean"
check "one picture only" says 2 "one mesh" "$query" --png "$scratch/any.png" "$hit" "$clean"
check "or a page" says 2 "together" "$query" --png "$scratch/any.png" --html "$scratch/any.html" "$hit"
check "none of these wrote a file" sh -c "! ls '$scratch'/any.*"
cp "$hit" "$scratch/own.obj"
check "not over the mesh" says 2 "own.obj is to be read" "$query" --html "$scratch/own.obj" "$scratch/own.obj"
check "nor with a picture" says 2 "own.obj is to be read" "$query" --png "$scratch/own.obj" "$scratch/own.obj"
mkdir "$scratch/tmp"
check "a picture needs a browser" says 2 "no browser" \
    env TMPDIR="$scratch/tmp" SC_BROWSER="$scratch/absent" "$query" --png "$scratch/any.png" "$hit"
check "one that draws" says 2 "drew no picture" \
    env TMPDIR="$scratch/tmp" SC_BROWSER=true "$query" --png "$scratch/any.png" "$hit"
check "and nothing is left behind" sh -c "test -z \"\$(ls '$scratch/tmp')\""

# ---- in a browser ----

browser=
for one in chromium chromium-browser google-chrome; do
    [ -z "$browser" ] && browser=$(command -v $one)
done
looks=34
looks_at_contours=43
if [ -z "$browser" ]; then
    skip "pages and pictures: there is no chromium ('make deps with=page')" \
        $((looks + looks_at_contours + 19))
    finish
fi
picture() {
    status 1 env TMPDIR="$scratch/tmp" "$query" --png "$scratch/picture.png" "$hit"
}
check "a picture" picture
check "one of contours" status 1 env TMPDIR="$scratch/tmp" \
    "$query" --trace --png "$scratch/contours.png" "$through"
check "and nothing is left behind" sh -c "test -z \"\$(ls '$scratch/tmp')\""

# What npm fetches goes to build/page, and is asked for once.
modules=build/page
ready() {
    command -v node >/dev/null 2>&1 && command -v npm >/dev/null 2>&1 &&
        tools/page/build.sh --install
}
if ! ready >"$scratch/npm.log" 2>&1; then
    skip "pages in a browser: no node, or npm cannot fetch playwright-core" \
        $((looks + looks_at_contours + 16))
    finish
fi
# look JOB FILE: each line of what it says is a check.
look() {
    node tests/look.mjs "$modules" "$browser" "$@" >"$scratch/looks" 2>"$scratch/look.err"
    check "$1: it looks to the end" test $? -eq 0
    [ -s "$scratch/look.err" ] && sed 's/^/    /' "$scratch/look.err"
    while read -r line; do
        check "$1: ${line#* }" test "${line%% *}" = ok
    done <"$scratch/looks"
}
"$query" --html "$scratch/page.html" "$hit" "$clean" >/dev/null
look page "$scratch/page.html"
seen=$(wc -l <"$scratch/looks")
check "page: all was looked at ($seen)" test "$seen" -eq "$looks"
"$query" --trace --html "$scratch/page.html" "$through" "$below" >/dev/null
look contours "$scratch/page.html"
seen=$(wc -l <"$scratch/looks")
check "contours: all was looked at ($seen)" test "$seen" -eq "$looks_at_contours"
look picture "$scratch/picture.png"
look contour-picture "$scratch/contours.png"
"$query" --html "$scratch/page.html" "$scratch/absent.obj" >/dev/null 2>&1
look nothing "$scratch/page.html"

built() {
    tools/page/build.sh "$scratch/built.html" && cmp tools/page/page.html "$scratch/built.html"
}
check "page.html is what its sources give ('make page')" built

finish
