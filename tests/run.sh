#!/bin/sh
# Runs test programs one after the other and sums up.
#
#     tests/run.sh PROGRAM...
#
# Of a program that succeeds the last line is printed and what it skipped, of one that fails all it said. A program whose
# last line is not "...: N passed, N failed", or whose exit status does not fit that line, counts as
# one more failure: it crashed or gave up. The last line is the sum, alone: "N passed, N failed".
# Exit status 1 if anything failed or nothing ran.
#
# SPDX-License-Identifier: MIT
set -u

log=$(mktemp) || exit 1
trap 'rm -f "$log"' EXIT
trap 'exit 1' HUP INT TERM

passed=0
failed=0
for program in "$@"; do
    "$program" >"$log" 2>&1
    status=$?
    last=$(tail -n 1 "$log")
    sums=$(printf '%s\n' "$last" | sed -n 's/^.*: \([0-9][0-9]*\) passed, \([0-9][0-9]*\) failed$/\1 \2/p')
    p=0
    f=0
    if [ -n "$sums" ]; then
        p=${sums% *}
        f=${sums#* }
    fi
    broken=0
    if [ -z "$sums" ]; then
        broken=1
    elif [ "$f" -eq 0 ] && [ "$status" -ne 0 ]; then
        broken=1
    elif [ "$f" -ne 0 ] && [ "$status" -eq 0 ]; then
        broken=1
    fi
    if [ "$status" -eq 0 ] && [ "$broken" -eq 0 ]; then
        grep '^skipped: ' "$log"
        printf '%s\n' "$last"
    else
        cat "$log"
        [ "$broken" -eq 0 ] || printf '%s: crashed or gave up (exit status %d)\n' "$program" "$status"
    fi
    passed=$((passed + p))
    failed=$((failed + f + broken))
done

printf '%d passed, %d failed\n' "$passed" "$failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
