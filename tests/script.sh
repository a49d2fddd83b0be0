# What the test scripts share: sourced by tests/test_*.sh, from the top of the repository.
#
#     check "what should be true" command [argument...]
#     skip "what was not checked, and why" [number of checks or tests, if not 1]
#     status N command [argument...]     whether the command ends with status N
#     says N "words" command...          whether it does, and prints the words
#     finish                             last: prints "<script>: N passed, N failed, N skipped" and exits
#
# A command's output is shown only if it fails. $scratch is a directory that is removed at the end.
# From `make test` come CC, SC_CONFIG, SC_BIN, SC_LIB, SC_METIS (yes if METIS is there) and SC_FLAGS
# (flags that whatever is linked with this build of the library needs); by hand, the release build
# is taken.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

CC=${CC:-cc}
MAKE=${MAKE:-make}
SC_CONFIG=${SC_CONFIG:-release}
SC_BIN=${SC_BIN:-build/bin}
SC_LIB=${SC_LIB:-build/lib}
SC_FLAGS=${SC_FLAGS:-}
export CC MAKE SC_CONFIG SC_BIN SC_LIB SC_FLAGS

checks_passed=0
checks_failed=0
checks_skipped=0
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM

check() {
    check_name=$1
    shift
    if "$@" >"$scratch/check.log" 2>&1; then
        checks_passed=$((checks_passed + 1))
    else
        checks_failed=$((checks_failed + 1))
        echo "failed: $check_name"
        sed 's/^/    /' "$scratch/check.log"
    fi
}

skip() {
    checks_skipped=$((checks_skipped + ${2:-1}))
    echo "skipped: $1"
}

status() {
    wanted=$1
    shift
    "$@" >"$scratch/out" 2>"$scratch/err"
    got=$?
    [ $got -eq "$wanted" ] || { echo "status $got"; cat "$scratch/out" "$scratch/err"; return 1; }
}

says() {
    wanted=$1
    text=$2
    shift 2
    status "$wanted" "$@" || return 1
    grep -q -e "$text" "$scratch/out" "$scratch/err" ||
        { cat "$scratch/out" "$scratch/err"; return 1; }
}

finish() {
    echo "$(basename "$0" .sh): $checks_passed passed, $checks_failed failed, $checks_skipped skipped"
    [ "$checks_failed" -eq 0 ] && [ $((checks_passed + checks_skipped)) -gt 0 ]
    exit
}
