#!/bin/sh
# What a release needs, one step after the other, and a table of how each went: passed, failed, or
# not tried because something is not installed here. Exit status 1 if a step failed.
#
#     tools/release_check.sh FOLDER [STEP...]     from the top of the repository; default: all steps
#
# Each step's output goes to FOLDER/STEP.log. Steps are committed (nothing is left uncommitted),
# version (every file agrees, and CHANGELOG.md has a day), layering, tests (make test), abi (make
# abi-check), wasm (make test-wasm: the package for npm, packed as npm packs it), and a package
# each: the scripts of tests/packages. MAKE: the make to use; EMCC: emscripten's compiler.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

folder=$1
shift
packages=$(for script in tests/packages/*.sh; do basename "$script" .sh; done)
# shellcheck disable=SC2086
[ $# -gt 0 ] || set -- committed version layering tests abi wasm $packages
make=${MAKE:-make}
failures=0
mkdir -p "$folder"
rm -f "$folder/table.txt"

# says LOG: what the sums at the end of a test's output say, of several the last.
says() {
    sed -n -e 's/^.*: \([0-9]* passed, [0-9]* failed, [0-9]* skipped\)$/\1/p' \
        -e 's/^\([0-9]* passed, [0-9]* failed, [0-9]* skipped\)$/\1/p' "$1" | tail -n 1
}

printf '%-12s %8s  %s\n' step seconds result | tee "$folder/table.txt"
for step; do
    began=$(date +%s)
    case $step in
    committed) set -- sh -c 'git status --porcelain | tee /dev/stderr | { ! grep -q .; }' ;;
    version) set -- env SC_RELEASE=1 sh tests/test_version.sh ;;
    layering) set -- sh tools/check_layering.sh ;;
    tests) set -- "$make" --no-print-directory test ;;
    abi) set -- "$make" --no-print-directory abi-check ;;
    wasm)
        if command -v "${EMCC:-emcc}" >/dev/null 2>&1; then
            set -- "$make" --no-print-directory test-wasm
        else
            set -- printf '%s\n' "skipped: no ${EMCC:-emcc}" 'wasm: 0 passed, 0 failed, 1 skipped'
        fi
        ;;
    *) set -- sh "tests/packages/$step.sh" ;;
    esac
    log=$folder/$step.log
    "$@" >"$log" 2>&1
    status=$?
    sums=$(says "$log")
    case $status,$sums in
    0,"0 passed, 0 failed, "*) result="not tried: $(sed -n 's/^.*skipped: //p' "$log" | head -n 1)" ;;
    0,*", 0 skipped") result="passed (${sums%%,*})" ;;
    0,*skipped) result="passed (${sums%%,*}, ${sums##*, })" ;;
    0,) result=passed ;;
    *)
        result="FAILED: see $log"
        failures=$((failures + 1))
        ;;
    esac
    printf '%-12s %8d  %s\n' "$step" $(($(date +%s) - began)) "$result" | tee -a "$folder/table.txt"
done
if [ "$failures" -gt 0 ]; then
    echo "release-check: $failures failed"
    exit 1
fi
echo "release-check: nothing failed"
