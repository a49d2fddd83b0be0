#!/bin/sh
# Packs starcontour-VERSION.tar.gz, the same bytes for the same files: sorted, owned by nobody,
# dated by the last commit.
#
#     tools/dist.sh VERSION FOLDER        from the top of the repository; needs GNU tar
#
# In a git checkout: the tracked files, as they are now. In an unpacked archive: all files but
# build/, dated as they are, which gives that archive again.
#
# SPDX-License-Identifier: MIT
set -eu
export LC_ALL=C

version=$1
folder=$2
name=starcontour-$version

case $(tar --version 2>/dev/null) in
*GNU*) ;;
*)
    echo "make dist needs GNU tar" >&2
    exit 1
    ;;
esac
mkdir -p "$folder"
list=$(mktemp)
trap 'rm -f "$list"' EXIT
trap 'exit 1' HUP INT TERM

# A checkout of its own, not one that this folder happens to lie in.
if [ -e .git ] && git ls-files >"$list" 2>/dev/null && [ -s "$list" ]; then
    date=$(git log -1 --format=%ct)
    git diff --quiet HEAD -- || echo "dist: some changes are not committed; they are packed as well"
else
    find . -path ./build -prune -o -type f -print | sed 's|^\./||' >"$list"
    date=$(date -r CHANGELOG.md +%s)
fi

sort -o "$list" "$list"
tar --create --file=- --format=ustar --mtime="@${SOURCE_DATE_EPOCH:-$date}" \
    --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX --transform="s|^|$name/|" \
    --files-from="$list" | gzip -n -9 >"$folder/$name.tar.gz"
echo "$folder/$name.tar.gz"
