#!/bin/sh
# Fuzzes: each target for some time, as many at once as there are processors, from what earlier runs
# and meshes/ gave. Run by `make fuzz`.
#
#     tests/fuzz/fuzz.sh DIRECTORY SECONDS [TARGET...]
#
# DIRECTORY has the programs and gets the corpora (corpus/TARGET) and logs (TARGET.log). What a
# target finds is kept in tests/fuzz/reproducers/, where tests/test_reproducers.c replays it. Prints
# a summary for each target; exit status 1 if one found something.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

at=$1
seconds=$2
shift 2
[ $# -gt 0 ] || set -- fuzz_build fuzz_query fuzz_near fuzz_options fuzz_load fuzz_trace
case $seconds in
'' | *[!0-9]*)
    echo "fuzz: SECONDS=$seconds: must be a number" >&2
    exit 2
    ;;
esac
jobs=${FUZZ_JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)}
reproducers=tests/fuzz/reproducers
mkdir -p "$at/corpus/seeds" "$reproducers" || exit 2
"$at/make_seeds" "$at/corpus/seeds" meshes/*.obj || exit 2

# run TARGET
run() {
    mkdir -p "$at/corpus/$1"
    longest=4096
    [ "$1" != fuzz_load ] || longest=16384 # a saved model has some 5000 bytes at least
    "$at/$1" -max_total_time="$seconds" -max_len="$longest" -timeout=60 -report_slow_units=60 \
        -rss_limit_mb=4096 -print_final_stats=1 -artifact_prefix="$reproducers/$1-" \
        "$at/corpus/$1" "$at/corpus/seeds" >"$at/$1.log" 2>&1
    echo $? >"$at/$1.status"
}

running=
for target in "$@"; do
    rm -f "$at/$target.status"
    # Waits for the one that started first when as many run as may.
    # shellcheck disable=SC2086
    set -- $running
    if [ $# -ge "$jobs" ]; then
        wait "$1"
        shift
        running=$*
    fi
    echo "fuzz: $target for $seconds seconds"
    run "$target" &
    running="$running $!"
    all="${all:-} $target"
done
wait

bad=0
for target in $all; do
    status=$(cat "$at/$target.status" 2>/dev/null || echo none)
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$at/$target.log")
    covered=$(sed -n 's/.*\(cov: [0-9]* ft: [0-9]* corp: [0-9]*\).*/\1/p' "$at/$target.log" | tail -n 1)
    echo "fuzz: $target: exit status $status, ${runs:-no} inputs, ${covered:-no coverage}"
    if [ "$status" != 0 ]; then
        bad=1
        grep -e 'FUZZ_CHECK' -e 'ERROR:' -e 'runtime error' -e 'Test unit written' -e 'Base64' "$at/$target.log" |
            sed 's/^/    /'
        echo "    the whole of it: $at/$target.log"
    fi
done
exit $bad
