#!/bin/sh
# Prints a name for this machine that can be a folder's: its processor and the number of cores.
#
# SPDX-License-Identifier: MIT
set -eu
export LC_ALL=C

cpu=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo 2>/dev/null | head -n 1)
[ -n "$cpu" ] || cpu=$(uname -m)
cores=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
printf '%s %s cores\n' "$cpu" "$cores" | sed -e 's/([RTMrtm]*)//g' -e 's/ CPU / /' -e 's/ @ .*GHz//' |
    tr '[:upper:]' '[:lower:]' | tr -c 'a-z0-9\n' '-' | sed -e 's/--*/-/g' -e 's/^-//' -e 's/-$//'
