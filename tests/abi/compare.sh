#!/bin/sh
# Do programs that were linked with an older shared library run with a newer one?
#
#     tests/abi/compare.sh NEW_LIBRARY NEW_INCLUDE OLD_LIBRARY OLD_INCLUDE
#     tests/abi/compare.sh NEW_LIBRARY            the old one is the last release: the last tag v[0-9]*
#
# Two opinions: abidiff's (Debian: abigail-tools) on the libraries, where it is installed, and that
# of tests/abi/grown.awk on the headers. abidiff reports all that changed. Members added behind a
# structure that has a struct_size change it, yet break nothing: of such changes grown.awk is the
# judge.
#
# Fails if programs would break while the soname is the same. Without a git checkout, or before the
# first release, it says so and compares nothing. The last line is "abi-check: N passed, N failed, N
# skipped", where opinions are counted.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

new=$1
new_include=${2:-include}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM

if [ $# -eq 4 ]; then
    old=$3
    old_include=$4
else
    tag=$(git describe --tags --abbrev=0 --match 'v[0-9]*' 2>/dev/null)
    if [ -z "$tag" ]; then
        echo "abi-check: skipped: nothing to compare with (no tag v[0-9]*, or no git checkout)"
        echo "abi-check: 0 passed, 0 failed, 2 skipped"
        exit 0
    fi
    echo "abi-check: compares with $tag"
    mkdir "$scratch/$tag"
    git archive "$tag" | tar -xf - -C "$scratch/$tag" || exit 1
    (
        unset MAKEFLAGS MFLAGS MAKELEVEL
        cd "$scratch/$tag" && ${MAKE:-make} BUILD=build build/lib/libstarcontour.so
    ) >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
    old=$scratch/$tag/build/lib/libstarcontour.so
    old_include=$scratch/$tag/include
fi

soname() {
    readelf -d "$1" | sed -n 's/.*(SONAME).*\[\(.*\)\]/\1/p'
}

breaks=0
opinions=1
skipped=0
mkdir "$scratch/old" "$scratch/new"
tests/abi/goldens.sh "$scratch/old" "$old" "$old_include" || exit 1
tests/abi/goldens.sh "$scratch/new" "$new" "$new_include" || exit 1
for interface in "$scratch"/old/interface_*.txt; do
    awk -f tests/abi/grown.awk "$interface" "$scratch/new/$(basename "$interface")" || breaks=1
done
comm -23 "$scratch/old/symbols.txt" "$scratch/new/symbols.txt" >"$scratch/gone"
if [ -s "$scratch/gone" ]; then
    sed 's/^/no longer exported: /' "$scratch/gone"
    breaks=1
fi

if command -v abidiff >/dev/null 2>&1; then
    abidiff --no-added-syms --drop-private-types --headers-dir1 "$old_include" \
        --headers-dir2 "$new_include" "$old" "$new" >"$scratch/report"
    status=$?
    cat "$scratch/report"
    # Bits: 1 and 2 for errors, 4 for a change, 8 for one that breaks for certain.
    if [ $((status & 3)) -ne 0 ]; then
        echo "abi-check: abidiff failed" >&2
        exit 1
    fi
    [ $((status & 8)) -eq 0 ] || breaks=1
    opinions=2
else
    skipped=1
    echo "abi-check: abidiff's opinion is skipped: it is not there (Debian: apt-get install abigail-tools)"
fi

if [ "$breaks" -eq 0 ]; then
    echo "abi-check: programs linked with the old library run with the new one"
elif [ "$(soname "$old")" != "$(soname "$new")" ]; then
    echo "abi-check: would break programs, but for another soname: $(soname "$old"), now $(soname "$new")"
else
    echo "abi-check: programs linked with the old library would break, and the soname is still $(soname "$new")" >&2
    echo "abi-check: 0 passed, $opinions failed, $skipped skipped"
    exit 1
fi
echo "abi-check: $opinions passed, 0 failed, $skipped skipped"
