#!/bin/sh
# Runs test programs, as many at a time as there are processors (or TEST_JOBS), and sums up.
#
#     tests/run.sh PROGRAM...
#
# Of a program that succeeds the last line is printed and what it skipped, of one that fails all it
# said; in the order of the arguments. A program whose last line is not "...: N passed, N failed, N
# skipped" (the last of which may be missing), or whose exit status does not fit that line, counts
# as one more failure: it crashed or gave up. The last line is the sum, alone: "N passed, N failed,
# N skipped". SKIPPED of the environment is the number of programs that the caller left out. Exit
# status 1 if anything failed or nothing passed.
#
# SPDX-License-Identifier: MIT
set -u

jobs=${TEST_JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null)}
logs=$(mktemp -d) || exit 1
trap 'rm -rf "$logs"' EXIT
trap 'kill $! $(cat "$logs"/*.pid) 2>/dev/null; exit 1' HUP INT TERM

# Writes what a program says to N.log; N.status is there when it has ended.
run_one='
    n=$1
    shift
    "$1" >"$0/$n.log" 2>&1 &
    echo $! >"$0/$n.pid"
    exec 2>/dev/null # nothing of the shell itself about signals
    wait $!
    echo $? >"$0/$n.ends"
    rm "$0/$n.pid"
    mv "$0/$n.ends" "$0/$n.status"'
n=0
for program in "$@"; do
    n=$((n + 1))
    printf '%s\0%s\0' "$n" "$program"
done | xargs -0 -n 2 -P "${jobs:-1}" sh -c "$run_one" "$logs" &

passed=0
failed=0
skipped=${SKIPPED:-0}
n=0
for program in "$@"; do
    n=$((n + 1))
    log=$logs/$n.log
    until [ -e "$logs/$n.status" ]; do
        # without xargs nothing will come any more
        kill -0 $! 2>/dev/null || [ -e "$logs/$n.status" ] || echo 127 >"$logs/$n.status"
        sleep 0.1
    done
    status=$(cat "$logs/$n.status")
    last=$(tail -n 1 "$log")
    sums=$(printf '%s\n' "$last" | sed -n -e 's/ failed$/ failed, 0 skipped/' \
        -e 's/^.*: \([0-9][0-9]*\) passed, \([0-9][0-9]*\) failed, \([0-9][0-9]*\) skipped$/\1 \2 \3/p')
    # shellcheck disable=SC2086
    set -- ${sums:-0 0 0}
    p=$1 f=$2 s=$3
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
    skipped=$((skipped + s))
done

printf '%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
