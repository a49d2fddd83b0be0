#!/bin/sh
# Says that a peer is not measured, and adds a line that says so to a CSV file, for the report.
#
#     bench/peers/skip.sh CSV PEER REASON
#
# SPDX-License-Identifier: MIT
set -u

echo "skipped: peer-$2: $3"
case $1 in
*/*) [ -d "${1%/*}" ] || mkdir -p "${1%/*}" || exit ;;
esac
echo "# skipped: $2: $3" >>"$1"
