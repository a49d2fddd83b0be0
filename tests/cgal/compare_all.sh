#!/bin/sh
# `make test-cgal`: compares triangle pairs with CGAL's, by compare.cpp, on every file below meshes/
# and below what meshes/fetch.sh --models fetched that can be read as a mesh.
#
#     tests/cgal/compare_all.sh COMPARE FOLDER LOG     from the top of the repository
#
# One line for each mesh; see compare.cpp. Files that cannot be read as meshes (most are none) are
# named in LOG with the reason, and counted. Skipped, and named: meshes of more than $limit
# triangles, and those with coordinates that are not finite. A process for each file, so that one
# that crashes or takes more than $seconds counts as one failure.
#
# Last line: "N passed, N failed, N skipped", where meshes are counted; exit status 1 if any failed.
# About a minute.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

compare=$1
folder=$2
log=$3
limit=1000000
seconds=300
passed=0
failed=0
explained=0
not_read=0
skipped=0

scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM

# The comparison notices missing pairs: without the contour test, starcontour misses some here.
"$compare" --contour-none meshes/crossing_cloths.obj >"$scratch/output" 2>&1
if [ $? -ne 1 ]; then
    cat "$scratch/output"
    echo "failed: missing pairs are not noticed"
    failed=1
fi

for part in meshes "$folder/cgal" "$folder/models"; do
    find "$part" -type f ! -name '*.c' ! -name '*.py' ! -name '*.sh' | sort
done >"$scratch/files"
: >"$log"

while IFS= read -r file; do
    timeout "$seconds" "$compare" --limit "$limit" "$file" </dev/null >"$scratch/output" 2>&1
    status=$?
    if [ "$status" -eq 3 ]; then
        not_read=$((not_read + 1))
        cat "$scratch/output" >>"$log"
        continue
    fi
    cat "$scratch/output"
    case $status in
    0)
        passed=$((passed + 1))
        if grep -q '^DIFFERENT' "$scratch/output"; then explained=$((explained + 1)); fi
        ;;
    4) skipped=$((skipped + 1)) ;;
    124) failed=$((failed + 1)); echo "failed    $file: more than $seconds seconds" ;;
    1) failed=$((failed + 1)) ;;
    *) failed=$((failed + 1)); echo "failed    $file: exit status $status" ;;
    esac
done <"$scratch/files"

echo "files that are no meshes or cannot be read: $not_read (see $log)"
echo "meshes where CGAL differs and exact arithmetic agrees with starcontour: $explained"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
