#!/bin/sh
# The Debian packages: dpkg-buildpackage builds them from the archive of `make dist`, lintian finds
# nothing, and what they install passes their own tests. With SC_TESTBED, autopkgtest runs these
# there:
#
#     SC_TESTBED='chroot /srv/bookworm' tests/run.sh tests/packages/debian.sh
#     SC_TESTBED=null ...                     on this machine, where packages stay installed
#
# Needs debhelper, lintian and what the programs need (make deps with=packages).
#
# SPDX-License-Identifier: MIT
. tests/script.sh

for program in dh dpkg-buildpackage lintian; do
    if ! command -v $program >/dev/null 2>&1; then
        skip "Debian packages: no $program"
        finish
    fi
done
if ! dpkg-checkbuilddeps tools/packaging/debian/control >"$scratch/log" 2>&1; then
    skip "Debian packages: $(cat "$scratch/log")"
    finish
fi
unset CC CFLAGS CPPFLAGS LDFLAGS MAKEFLAGS MFLAGS MAKELEVEL
top=$PWD
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
version=$(sed -n 's/^starcontour (\([^)]*\)).*/\1/p' tools/packaging/debian/changelog | head -n 1)
source=$scratch/starcontour-${version%-*}

check "the source package is put together" tools/packaging/debian/make_source.sh "$scratch"
builds() {
    cd "$source" && dpkg-buildpackage -us -uc "-j${SC_JOBS:-$jobs}"
    status=$?
    cd "$top" && return $status
}
check "dpkg-buildpackage builds it" builds
changes=$(echo "$scratch/starcontour_${version}"_*.changes)
# Left out: that a first upload closes a wish in Debian's tracker, and that there is a home page.
# There are none.
clean() {
    lintian --info --pedantic --fail-on error,warning,pedantic --suppress-tags \
        initial-upload-closes-no-bugs,no-homepage-field "$changes"
}
check "lintian finds nothing" clean

root=$scratch/root
mkdir "$root"
# deb NAME: the file of a package; that of its debug symbols is another.
deb() {
    find "$scratch" -maxdepth 1 -name "${1}_${version}_*.deb"
}
library=$(sed -n 's/^Package: \(libstarcontour[0-9.]*\)$/\1/p' tools/packaging/debian/control)
unpacks() {
    for name in "$library" libstarcontour-dev starcontour-tools; do
        dpkg-deb -x "$(deb "$name")" "$root" || return 1
    done
}
check "there is a library, its development files and tools" unpacks
libdir=$(dirname "$(find "$root/usr/lib" -name 'libstarcontour.so.*' -type f)")
# Their own tests, on what was unpacked.
own() {
    cd "$source" && PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_PATH=$libdir/pkgconfig LD_LIBRARY_PATH=$libdir \
        PKG_CONFIG_ALLOW_SYSTEM_CFLAGS=1 PKG_CONFIG_ALLOW_SYSTEM_LIBS=1 PATH=$root/usr/bin:$PATH \
        AUTOPKGTEST_TMP=$scratch "debian/tests/$1"
    status=$?
    cd "$top" && return $status
}
check "a program that uses the library works" own compile-consumer
check "the tools work" own ask-sc-query
exports() {
    dpkg-deb -I "$(deb "$library")" symbols | sed -n 's/^ \([^@]*\)@.*/\1/p' |
        diff tests/abi/symbols.txt -
}
check "the symbols are those of tests/abi" exports

if [ -n "${SC_TESTBED:-}" ] && command -v autopkgtest >/dev/null 2>&1; then
    # shellcheck disable=SC2086
    check "autopkgtest passes" autopkgtest --setup-commands='apt-get -q update' "$changes" -- $SC_TESTBED
else
    skip "autopkgtest: it runs where SC_TESTBED says"
fi
finish
