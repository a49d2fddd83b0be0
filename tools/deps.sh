#!/bin/sh
# Installs what is missing to build and test everything. Says first what that is, asks nothing.
#
#     tools/deps.sh      CC, CXX, CPPFLAGS: the compilers and flags that look for headers
#                        WITH: groups of what is needed beyond building and testing, see below
#
# Debian and Ubuntu: by apt-get, through sudo only if need be. Elsewhere: prints the names of the
# packages, and fails if something is missing.
#
# SPDX-License-Identifier: MIT
set -u

CC=${CC:-cc}
CXX=${CXX:-g++}

# What is needed: how it is looked for; its package in Debian, Fedora, Arch Linux and Homebrew (a
# dash: it comes with the system's compilers, or is not offered there).
needs="\
compiler CC gcc gcc gcc -
compiler CXX g++ gcc-c++ gcc -
program pkg-config pkg-config pkgconf-pkg-config pkgconf pkgconf
header metis.h libmetis-dev metis-devel metis metis
header assimp/cimport.h libassimp-dev assimp-devel assimp assimp
header cjson/cJSON.h libcjson-dev cjson-devel cjson cjson
header zlib.h zlib1g-dev zlib-devel zlib zlib
module jsonschema python3-jsonschema python3-jsonschema python-jsonschema -
header ccd/ccd.h libccd-dev libccd-devel libccd libccd
header gmp.h libgmp-dev gmp-devel gmp gmp"

# What groups need: `make deps with="analysis cgal"`.
group_cgal="\
header CGAL/version.h libcgal-dev CGAL-devel cgal cgal"
group_analysis="\
program clang clang clang clang llvm
program clang-tidy clang-tidy clang-tools-extra clang llvm
program cppcheck cppcheck cppcheck cppcheck cppcheck
program valgrind valgrind valgrind valgrind -
sanitizers clang libclang-rt-dev compiler-rt compiler-rt -"
group_batch="\
program parallel parallel parallel parallel parallel
program munged munge munge munge -
program slurmctld slurm-wlm slurm-slurmctld,slurm-slurmd slurm-llnl -
module venv,ensurepip python3-venv python3 python python"
group_bench="\
module matplotlib python3-matplotlib python3-matplotlib python-matplotlib python-matplotlib"
group_docs="\
program doxygen doxygen doxygen doxygen doxygen
program mandoc mandoc mandoc mandoc mandoc"
group_ffi="\
module setuptools,wheel,pip,numpy python3-setuptools,python3-wheel,python3-pip,python3-numpy \
    python3-setuptools,python3-wheel,python3-pip,python3-numpy \
    python-setuptools,python-wheel,python-pip,python-numpy numpy
program luajit luajit luajit luajit luajit
program love love love love -
program mcs mono-mcs mono-devel mono mono
program mono mono-runtime mono-core mono mono
program cargo cargo cargo rust rust
program go golang-go golang go go
program javac default-jdk-headless java-devel jdk-openjdk openjdk
file /usr/share/java/jna.jar libjna-java jna - -"
group_page="\
program chromium chromium chromium chromium -
program npm npm,nodejs nodejs-npm npm,nodejs node"
group_packages="\
program cmake cmake cmake cmake cmake
program clang clang clang clang llvm
program abidiff abigail-tools libabigail - -
program x86_64-w64-mingw32-gcc gcc-mingw-w64-x86-64 mingw64-gcc mingw-w64-gcc mingw-w64
program wine wine wine wine -
program ld.lld lld lld lld lld
program llvm-lib llvm llvm llvm llvm
program aarch64-linux-gnu-gcc gcc-aarch64-linux-gnu,libc6-dev-arm64-cross - - -
program arm-linux-gnueabihf-gcc gcc-arm-linux-gnueabihf,libc6-dev-armhf-cross - - -
program s390x-linux-gnu-gcc gcc-s390x-linux-gnu,libc6-dev-s390x-cross - - -
program qemu-aarch64 qemu-user qemu-user qemu-user -
module venv,ensurepip python3-venv python3 python python
module numpy python3-numpy python3-numpy python-numpy numpy
program cargo cargo cargo rust rust
program dh debhelper debhelper - -
program lintian lintian lintian - -
program autopkgtest autopkgtest - - -
program mcs mono-mcs mono-devel mono mono
program mono mono-runtime mono-core mono mono
program nuget nuget nuget - -"
group_peers="\
header CGAL/version.h libcgal-dev CGAL-devel cgal cgal
header tbb/scalable_allocator.h libtbb-dev tbb-devel onetbb tbb
header embree3/rtcore.h libembree-dev - - -
header fcl/config.h libfcl-dev fcl-devel fcl fcl
module ensurepip python3-venv python3 python python"
group_wasm="\
program emcc emscripten emscripten emscripten emscripten
program chromium chromium chromium chromium -
program npm npm,nodejs nodejs-npm npm,nodejs node"
for group in ${WITH:-}; do
    case $group in
    analysis | batch | bench | cgal | docs | ffi | packages | page | peers | wasm) ;;
    *)
        echo "make deps: with=$group: the groups are analysis, batch, bench, cgal, docs, ffi, packages, page, peers, wasm" >&2
        exit 2
        ;;
    esac
    eval "more=\$group_$group"
    # shellcheck disable=SC2154
    [ -z "$more" ] || needs="$needs
$more"
done

there() {
    case $1 in
    compiler)
        # Without the options it may hold.
        eval "set -- \$$2"
        command -v "$1" >/dev/null 2>&1
        ;;
    program) command -v "$2" >/dev/null 2>&1 ;;
    file) test -e "$2" ;;
    module)
        # Several are imported in this order.
        for python in python3 /usr/bin/python3; do
            "$python" -c "import $2" >/dev/null 2>&1 && return 0
        done
        return 1
        ;;
    header) echo "#include <$2>" | $CC ${CPPFLAGS:-} -E -x c - >/dev/null 2>&1 ;;
    sanitizers) echo "int main(void) { return 0; }" | "$2" -fsanitize=memory -x c -o /dev/null - 2>/dev/null ;;
    esac
}

# The packages, in the system's column, of all that is missing. What Debian calls libclang-rt-dev
# comes with clang in older releases.
missing() {
    echo "$needs" | while read -r kind what debian fedora arch brew; do
        there "$kind" "$what" </dev/null && continue
        eval "package=\$$1"
        [ "$kind $1" = "sanitizers debian" ] && ! apt-cache show "$package" >/dev/null 2>&1 && continue
        [ "$package" = - ] || printf ' %s' "$package" | tr ',' ' '
    done
}

found=$(echo "$needs" | while read -r kind what rest; do
    there "$kind" "$what" </dev/null && continue
    [ "$kind" = compiler ] && eval "what=\$$what"
    [ "$kind" = sanitizers ] && what="sanitizers of $what"
    printf ' %s' "$what"
done)
if [ -z "$found" ]; then
    echo "make deps: nothing is missing"
    exit 0
fi
echo "make deps: missing:$found"

if ! command -v apt-get >/dev/null 2>&1; then
    echo "make deps: this is neither Debian nor Ubuntu; please install with your system's means:"
    echo "  Fedora:     dnf install$(missing fedora)"
    echo "  Arch Linux: pacman -S$(missing arch)"
    echo "  Homebrew:   brew install$(missing brew)"
    exit 1
fi

run='env DEBIAN_FRONTEND=noninteractive'
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null 2>&1; then
        echo "make deps: not root, and there is no sudo; as root: apt-get install$(missing debian)" >&2
        exit 1
    fi
    run="sudo $run"
fi

# Old lists are better than none: whether they suffice, install will say.
$run apt-get update -q || echo "make deps: apt-get update failed; using old lists" >&2
packages=$(missing debian)
echo "make deps: installs$packages"
echo "make deps: by $run apt-get install --no-install-recommends"
# shellcheck disable=SC2086
$run apt-get install -q -y --no-install-recommends $packages </dev/null || {
    echo "make deps: apt-get install failed" >&2
    exit 1
}

left=$(missing debian)
if [ -n "$left" ]; then
    echo "make deps: installed, yet not found by $CC:$left" >&2
    exit 1
fi
