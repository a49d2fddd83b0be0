#!/bin/sh
# What `make dist` packs is built by plain `make`, as someone would who has unpacked it, and works.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

version=$(sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' include/starcontour.h |
    paste -sd. -)
# The surrounding make's variables are not theirs.
unset MAKEFLAGS MFLAGS MAKELEVEL
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)

packed() {
    "$MAKE" --no-print-directory dist BUILD="$scratch/dist" &&
        tar -xzf "$scratch/dist/starcontour-$version.tar.gz" -C "$scratch"
}
check "make dist" packed
cd "$scratch/starcontour-$version" || exit 1
check "make" "$MAKE" "-j$jobs"
used() {
    $CC -std=c99 -Iinclude tests/packages/consumer.c build/lib/libstarcontour.a -lm -o used &&
        ./used | grep '^wound: [1-9]'
}
check "the library works" used
meshes() {
    mkdir made && build/bin/make-meshes made && cmp made/sphere.obj meshes/sphere.obj
}
check "make-meshes works" meshes
if [ -x build/bin/sc-query ]; then
    collides() {
        build/bin/sc-query meshes/crossing_cloths.obj
        test $? -eq 1
    }
    check "sc-query works" collides
else
    skip "sc-query: what it needs is not installed"
fi
cd / || exit 1
finish
