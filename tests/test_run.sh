#!/bin/sh
# The sums at the end of a run of tests: what passed, failed and was skipped, from each kind of
# program to the last line, and on to CI's. What ran nothing must not pass for a success.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

top=$PWD

# program NAME LINES STATUS: a stand-in for a test.
program() {
    printf '#!/bin/sh\ncat <<END\n%s\nEND\nexit %d\n' "$2" "$3" >"$scratch/$1" && chmod +x "$scratch/$1"
}
program good 'good: 3 passed, 0 failed, 0 skipped' 0
program partly 'skipped: something
partly: 2 passed, 0 failed, 5 skipped' 0
program nothing 'skipped: all of it
nothing: 0 passed, 0 failed, 1 skipped' 0
program two 'two: 4 passed, 0 failed' 0
program bad 'bad: 1 passed, 2 failed, 1 skipped' 1
program liar 'liar: 1 passed, 0 failed, 0 skipped' 1
program silent 'something else' 0

# ends STATUS LAST PROGRAM...: tests/run.sh on these.
ends() {
    wanted=$1
    text=$2
    shift 2
    for one in "$@"; do set -- "$@" "$scratch/$one"; shift; done
    tests/run.sh "$@" >"$scratch/run.log" 2>&1
    got=$?
    cat "$scratch/run.log"
    [ $got -eq "$wanted" ] && [ "$(tail -n 1 "$scratch/run.log")" = "$text" ]
}
prints() {
    grep -qx "$1" "$scratch/run.log"
}
check "sums of what passed" ends 0 '7 passed, 0 failed, 0 skipped' good two
check "sums of what was skipped" ends 0 '5 passed, 0 failed, 6 skipped' good partly nothing
check "it says what" prints 'skipped: something'
check "and of which program" prints 'partly: 2 passed, 0 failed, 5 skipped'
check "a failure" ends 1 '4 passed, 2 failed, 1 skipped' good bad
check "a status that does not fit" ends 1 '4 passed, 1 failed, 0 skipped' good liar
check "no sum" ends 1 '3 passed, 1 failed, 0 skipped' good silent
check "nothing but what was skipped is no success" ends 1 '0 passed, 0 failed, 1 skipped' nothing
left_out() {
    SKIPPED=7 ends 0 '3 passed, 0 failed, 8 skipped' good nothing
}
check "what the caller left out" left_out

# Scripts and programs as the tests are.
script() {
    printf '. tests/script.sh\n%s\nfinish\n' "$1" >"$scratch/as_script.sh"
    sh "$scratch/as_script.sh" >"$scratch/run.log"
    got=$?
    cat "$scratch/run.log"
    [ $got -eq "$2" ] && [ "$(tail -n 1 "$scratch/run.log")" = "as_script: $3" ]
}
check "a script counts skips" script 'check x true; skip y; skip z 3' 0 '1 passed, 0 failed, 4 skipped'
check "a script that skips all" script 'skip y' 0 '0 passed, 0 failed, 1 skipped'
check "a script that does nothing" script ':' 1 '0 passed, 0 failed, 0 skipped'
check "a script that fails" script 'check x false; skip y' 1 '0 passed, 1 failed, 1 skipped'

cat >"$scratch/in_c.c" <<'END'
#include "harness.h"
static void good(void) { CHECK(1); }
static void partly(void) { CHECK(1); test_skip("%d", 1); }
static void nothing(void) { test_skip("all of it"); }
static void empty(void) {}
SC_TEST_MAIN(SC_TEST(good), SC_TEST(partly), SC_TEST(nothing), SC_TEST(empty))
END
in_c() {
    "$scratch/in_c" $3 >"$scratch/run.log"
    got=$?
    cat "$scratch/run.log"
    [ $got -eq "$1" ] && [ "$(tail -n 1 "$scratch/run.log")" = "in_c: $2" ]
}
# shellcheck disable=SC2086
check "a program compiles" $CC -std=c99 -Itests -o "$scratch/in_c" "$scratch/in_c.c" tests/harness.c $SC_FLAGS
check "a program counts skips" in_c 0 '2 passed, 0 failed, 2 skipped' 'good partly nothing'
check "it says what" prints 'skipped: nothing: all of it'
check "a test that does nothing fails" in_c 1 '0 passed, 1 failed, 0 skipped' empty

# CI reads sums with skips and without; its own last line is "N passed, N failed".
ci() {
    printf '%s\n' "$1" >"$scratch/log"
    (
        passed=10 failed=20 skipped=30
        eval "$(sed -n '/^count() {$/,/^}$/p' "$top/.ci/run")" && count "$scratch/log" "$2" &&
            echo "$passed $failed $skipped"
    ) >"$scratch/counted" 2>&1
    cat "$scratch/counted"
    [ "$(tail -n 1 "$scratch/counted")" = "$3" ]
}
if [ -e .ci/run ]; then
    check "CI counts skips" ci 'x: 9 passed, 9 failed, 9 skipped
1 passed, 0 failed, 2 skipped' 0 '11 20 32'
    check "CI reads sums without" ci '1 passed, 2 failed' 1 '11 22 30'
    check "CI: a status that does not fit" ci '1 passed, 0 failed, 2 skipped' 1 '11 21 32'
    check "CI: nothing passed" ci '0 passed, 0 failed, 2 skipped' 0 '10 21 32'
    # shellcheck disable=SC2016
    check "CI's last line" grep -qx 'echo "$passed passed, $failed failed"' .ci/run
else
    skip "CI's sums: it is not in this copy"
fi

finish
