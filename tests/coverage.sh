#!/bin/sh
# Sums up which lines and branches of lib/ the tests ran, from what gcov counted.
#
#     tests/coverage.sh OBJECTS        the folder of lib's objects and counts; run at the top by `make coverage`
#
# Prints every line that was not run and every branch that was not taken, then a table. A function
# of a header counts as run if one of its copies was. A branch is a way that a condition can go, and
# each condition of an && or || counts. Exit status 1 if there are any, or if nothing was counted:
# what no test can bring about is marked in the source, see lib/base/assume.h.
#
# SPDX-License-Identifier: MIT
set -eu
export LC_ALL=C

find "$1" -name '*.gcda' | sort >"$1/counted.txt"
if [ ! -s "$1/counted.txt" ]; then
    echo "coverage: nothing was counted in $1" >&2
    exit 1
fi
xargs "${GCOV:-gcov}" --branch-probabilities --branch-counts --relative-only --stdout <"$1/counted.txt" 2>"$1/gcov.log" | awk '
    # "count:line:text"; a line comes once more for each copy of a function of a header
    /^ *[-0-9#=]+\*?: *[0-9]+:/ {
        split($0, part, ":")
        number = part[2] + 0
        text = $0
        sub(/^[^:]*:[^:]*:[ \t]*/, "", text)
        if (number == 0) {
            if (text ~ /^Source:/) {
                file = substr(text, 8)
                if (!(file in lines)) files[++file_count] = file
                lines[file] += 0
            }
            next
        }
        at = file SUBSEP number
        branch = 0
        if (part[1] ~ /-/) next
        if (!(at in text_of)) {
            text_of[at] = text
            order[++line_count] = at
            lines[file]++
        }
        if (part[1] !~ /[#=]/) run[at] = 1
        next
    }
    /^branch / {
        branch++
        if (branch > branches[at]) branches[at] = branch
        if ($3 == "taken" && $4 > 0) taken[at, branch] = 1
    }
    END {
        for (i = 1; i <= line_count; i++) {
            at = order[i]
            split(at, part, SUBSEP)
            file = part[1]
            lines_run[file] += at in run
            for (k = 1; k <= branches[at]; k++) {
                ways[file]++
                if ((at SUBSEP k) in taken) ways_taken[file]++
                else if (at in run) {
                    printf "%s:%d: branch %d of %d not taken: %s\n", file, part[2], k, branches[at], text_of[at]
                    left++
                }
            }
            if (!(at in run)) {
                printf "%s:%d: not run: %s\n", file, part[2], text_of[at]
                left++
            }
        }
        printf "\n%-34s %15s %21s\n", "", "lines", "branches"
        for (i = 1; i <= file_count; i++) {
            file = files[i]
            show(file, lines_run[file], lines[file], ways_taken[file], ways[file])
            a += lines_run[file]; b += lines[file]; c += ways_taken[file]; d += ways[file]
        }
        show("total", a, b, c, d)
        if (left) printf "%d places above are neither tested nor marked as out of reach (lib/base/assume.h)\n", left
        exit left || b == 0
    }
    function show(name, a, b, c, d) {
        printf "%-34s %5d %5d %6.2f %% %7d %5d %6.2f %%\n", name, a, b, b ? 100 * a / b : 100, c, d, d ? 100 * c / d : 100
    }'
