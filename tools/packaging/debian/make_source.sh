#!/bin/sh
# Makes the Debian source package: the archive of `make dist`, unpacked, with this folder as
# debian/.
#
#     tools/packaging/debian/make_source.sh FOLDER     from the top of the repository
#
# In FOLDER are then starcontour_VERSION.orig.tar.gz and starcontour-VERSION, in which
# `dpkg-buildpackage -us -uc` builds all packages. Whoever uploads them to an archive puts an
# address of their own into control and changelog, and for Debian's own the sources of three.js into
# debian/missing-sources (see debian/source/lintian-overrides).
#
# SPDX-License-Identifier: MIT
set -eu

folder=$1
version=$(sed -n 's/^starcontour (\([0-9.]*\)-.*/\1/p' tools/packaging/debian/changelog | head -n 1)
mkdir -p "$folder"
tools/dist.sh "$version" "$folder" >&2
mv "$folder/starcontour-$version.tar.gz" "$folder/starcontour_$version.orig.tar.gz"
rm -rf "$folder/starcontour-$version"
tar -xzf "$folder/starcontour_$version.orig.tar.gz" -C "$folder"
cp -R tools/packaging/debian "$folder/starcontour-$version/debian"
rm "$folder/starcontour-$version/debian/make_source.sh"
echo "$folder/starcontour-$version"
