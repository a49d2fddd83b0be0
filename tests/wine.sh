# Sourced, after script.sh and portable.sh, by those of tests/packages/ that build for Windows: runs
# what they built under wine. $at is the folder with their programs.
#
#     start_wine WHO              finishes the script, with a word of what WHO built, if there is no wine
#     windows PROGRAM ARGUMENT... runs $at/PROGRAM.exe
#     plain                       filter: lines as they end here
#     portable_tests_pass         a check that wine starts, and one for each of $portable_tests
#
# SPDX-License-Identifier: MIT
start_wine() {
    wine=
    for candidate in wine64 wine; do
        [ -n "$wine" ] || ! command -v "$candidate" >/dev/null 2>&1 || wine=$candidate
    done
    if [ -z "$wine" ]; then
        skip "nothing built $1 was run, only linked: no wine"
        finish
    fi
    export WINEPREFIX="$scratch/wine" WINEDEBUG=-all
    # The server stays for some seconds after a program ends; without it each would wait for a new
    # one.
    trap '$(command -v wineserver || echo true) -k 2>/dev/null; rm -rf "$scratch"' EXIT
}
windows() {
    program=$1
    shift
    "$wine" "$at/$program.exe" "$@" 2>/dev/null
}
plain() {
    tr -d '\r'
}
portable_tests_pass() {
    check "wine starts" windows test_base --list
    for test in $portable_tests; do
        check "test_$test passes" windows "test_$test" --scale 20
    done
}
