#!/bin/sh
# README.md tells the truth: its C example compiles without a warning, runs and prints what is said
# there; targets, options and files that it names exist; sc-query's exit status is as it says.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

# block LANGUAGE: the first code block of that language.
block() {
    awk -v fence='```'"$1" '
        !inside && $0 == fence && !done { inside = 1; next }
        inside && $0 == "```" { inside = 0; done = 1 }
        inside' README.md
}

block c >"$scratch/example.c"
block text >"$scratch/expected"
check "there is an example" grep -q 'sc_query(' "$scratch/example.c"
check "it says what it prints" test -s "$scratch/expected"
check "it has about 20 lines" test "$(grep -c '[a-z0-9]' "$scratch/example.c")" -le 24

compile() {
    # shellcheck disable=SC2086
    $CC -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror -Iinclude "$scratch/example.c" \
        "$SC_LIB/libstarcontour.a" -lm -o "$scratch/example" $SC_FLAGS
}
run() {
    "$scratch/example" >"$scratch/printed" && diff "$scratch/expected" "$scratch/printed"
}
check "it compiles" compile
check "it prints what README.md says" run

"${MAKE:-make}" --no-print-directory help 2>/dev/null |
    sed -n -e '/^Targets:/,/^Variables:/s/^  \([a-z-]*\) .*/\1/p' >"$scratch/targets"
for target in $(grep -o '`make [^`]*`' README.md | tr -d '`' | tr ' ' '\n' |
    grep -v -e '=' -e '^make$' -e '^-' | sort -u) \
    $(block sh | sed -n 's/^make \([^#]*\).*/\1/p' | tr ' ' '\n' | grep -v -e '=' -e '^-' | sort -u); do
    check "make $target exists" grep -qx "$target" "$scratch/targets"
done

# Whoever has other machines need only push: Linux runs what has to pass, and targets exist.
workflow=.github/workflows/test.yml
check "the workflow runs .ci/run" grep -qxF '      - run: .ci/run' $workflow
for target in $(sed -nE 's/^ *(- run: )?(PATH=[^ ]* )?make (.*)$/\3/p' $workflow | sed 's/"[^"]*"//g' |
    tr ' ' '\n' | grep '^[a-z]' | grep -v = | sort -u); do
    check "make $target, which the workflow runs, exists" grep -qx "$target" "$scratch/targets"
done

for file in $(grep -o '`[a-z]*/[a-z_./]*`' README.md | tr -d '`' | grep -v '^build/' | sort -u); do
    check "$file exists" test -e "$file"
done

if [ -x "$SC_BIN/sc-query" ]; then
    "$SC_BIN/sc-query" --help >"$scratch/help" 2>&1
    check "sc-query --help succeeds" "$SC_BIN/sc-query" --help
    for option in $(sed -n '/^## sc-query/,/^## [^s]/p' README.md | grep -o -e '--[a-z][a-z-]*' | sort -u); do
        check "sc-query has $option" grep -q -e "$option" "$scratch/help"
    done
    exit_status() {
        "$SC_BIN/sc-query" "$2"
        test $? -eq "$1"
    }
    check "sc-query's status is 0 for a clean mesh" exit_status 0 meshes/sphere.obj
    check "1 for one that hits itself" exit_status 1 meshes/crossing_cloths.obj
    check "2 for none" exit_status 2 meshes/absent.obj
else
    skip "sc-query: it was not built"
fi

finish
