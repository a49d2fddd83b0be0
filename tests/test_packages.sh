#!/bin/sh
# The ways in which others take the library along: as one file, by CMake, as an archive; and that
# MSVC could compile it. tests/packages/consumer.c is the user; what it prints has to be the same
# each time. What takes longer is in tests/packages/ (make test-packages).
#
# SPDX-License-Identifier: MIT
. tests/script.sh

if [ "$SC_CONFIG" != release ]; then
    skip "packages: once is enough, with config=release"
    check "there is a user of packages" test -s tests/packages/consumer.c
    finish
fi

remake() {
    "$MAKE" --no-print-directory -j1 config=release "$@"
}
CXX=${CXX:-g++}
top=$PWD
version=$(sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' include/starcontour.h |
    paste -sd. -)

# same PROGRAM: it prints what it prints with the library of this build.
same() {
    "$@" >"$scratch/printed" && cmp "$scratch/expected" "$scratch/printed"
}
reference() {
    # shellcheck disable=SC2086
    $CC -std=c99 -Iinclude tests/packages/consumer.c "$SC_LIB/libstarcontour.a" -lm $SC_FLAGS \
        -o "$scratch/reference" && "$scratch/reference" >"$scratch/expected" &&
        grep -q '^wound: [1-9]' "$scratch/expected"
}
check "the user runs with the library of this build" reference
check "and prints what it does everywhere" \
    sh -c 'cksum <"$1" | cmp - tests/packages/consumer.cksum' - "$scratch/expected"

# ------------------------------------------------------------------------------------------------
# Amalgamation

one=$scratch/one
warnings='-Wall -Wextra -Wpedantic -Wshadow -Wundef -Wvla -Wcast-qual -Wcast-align -Wwrite-strings
    -Wmissing-prototypes -Wstrict-prototypes -Wconversion -Wdouble-promotion -Wc++-compat -Werror'
check "make amalgamation" remake amalgamation BUILD="$one"
alone() {
    test "$(ls "$one/amalgamation")" = "starcontour.c
starcontour.h" && mkdir "$scratch/alone" &&
        cp "$one/amalgamation/starcontour.c" "$one/amalgamation/starcontour.h" "$scratch/alone" &&
        cd "$scratch/alone" || return 1
    # shellcheck disable=SC2086
    $CC -std=c99 -ffp-contract=off -O0 $warnings $SC_FLAGS -c starcontour.c
    status=$?
    cd "$top" && return $status
}
check "both files alone compile, without a warning (names that clash: rename one in lib/)" alone
exports_all() {
    nm -g "$scratch/alone/starcontour.o" | sed -n 's/.* T _*\(sc_[a-z0-9_]*\)$/\1/p' | sort |
        comm -13 - tests/abi/symbols.txt >"$scratch/absent" && test ! -s "$scratch/absent"
}
check "all calls are in it" exports_all
if command -v "$CXX" >/dev/null 2>&1; then
    in_cxx() {
        # shellcheck disable=SC2086
        $CXX -Wall -Wextra -Wpedantic -Werror -I"$scratch/alone" -x c++ tests/packages/consumer.c \
            -x none "$scratch/alone/starcontour.o" $SC_FLAGS -o "$scratch/in_cxx" && same "$scratch/in_cxx"
    }
    check "a C++ program uses it" in_cxx
else
    skip "the amalgamation in C++: no $CXX"
fi

# ------------------------------------------------------------------------------------------------
# MSVC's restrictions: clang, as if it were MSVC, with no headers but those of tests/packages/libc.
# No variable length arrays, no GNU syntax; nothing of the C library but what is there.

# shellcheck disable=SC2086
like_msvc() {
    clang --target=x86_64-pc-windows-msvc -std=c99 -ffreestanding -nostdlibinc -U__SSE2__ \
        -isystem tests/packages/libc -I"$one/amalgamation" "$@"
}
accepted() {
    like_msvc -fsyntax-only -Wpedantic -Wgnu -Wvla -Werror "$1"
}
# Builtins and attributes that no #if keeps from MSVC; clang has offsetof and what is in stdarg.h as
# such.
no_builtins() {
    like_msvc -E -P "$1" | sed -e 's/__builtin_va_[a-z]*//g' | grep -n -v -e '^#' |
        grep -e __attribute__ -e __int128 -e __asm__ -e __typeof \
        -e '__builtin_[a-np-z]' >"$scratch/builtins"
    cat "$scratch/builtins"
    test ! -s "$scratch/builtins"
}
refused() {
    cp "$one/amalgamation/starcontour.c" "$scratch/gnu.c" && echo "$1" >>"$scratch/gnu.c" &&
        ! { accepted "$scratch/gnu.c" && no_builtins "$scratch/gnu.c"; }
}
if command -v clang >/dev/null 2>&1; then
    check "MSVC's restrictions are kept" accepted "$one/amalgamation/starcontour.c"
    check "no builtins or attributes" no_builtins "$one/amalgamation/starcontour.c"
    check "an array of variable length is refused" refused 'int f(int n); int f(int n) { char a[n]; return a[0]; }'
    check "a statement expression is refused" refused 'int f(int n); int f(int n) { return ({ n; }); }'
    check "a builtin is refused" refused 'int f(unsigned n); int f(unsigned n) { return __builtin_ctz(n); }'
    check "POSIX is refused" refused '#include <unistd.h>'
else
    skip "MSVC's restrictions: no clang"
fi

# ------------------------------------------------------------------------------------------------
# make dist

dist_is_reproducible() {
    name=starcontour-$version
    mkdir "$scratch/unpacked" &&
        tar -xzf "$scratch/dist/$name.tar.gz" -C "$scratch/unpacked" &&
        test "$(ls "$scratch/unpacked")" = "$name" &&
        (cd "$scratch/unpacked/$name" && unset MAKEFLAGS && "$MAKE" --no-print-directory BUILD=build dist) &&
        cmp "$scratch/dist/$name.tar.gz" "$scratch/unpacked/$name/build/$name.tar.gz"
}
# shellcheck disable=SC2044
has_sources() {
    for file in Makefile LICENSE README.md CMakeLists.txt $(find include lib -type f) \
        tests/harness.h meshes/sphere.obj; do
        cmp "$file" "$scratch/unpacked/starcontour-$version/$file" || return 1
    done
    test -z "$(cd "$scratch/unpacked" && find . \( -name '*.o' -o -name '*.a' -o -name .git \) -print)"
}
case $(tar --version 2>/dev/null) in
*GNU*)
    check "make dist" remake dist BUILD="$scratch/dist"
    check "the archive, unpacked, packs the same archive" dist_is_reproducible
    check "the archive holds the sources (new ones: git add) and nothing built" has_sources
    ;;
*) skip "make dist: no GNU tar" ;;
esac

# ------------------------------------------------------------------------------------------------
# CMake

if ! command -v cmake >/dev/null 2>&1; then
    skip "CMake: not installed"
    finish
fi

# user NAME LINES: a project of the user's.
user() {
    mkdir "$scratch/$1" && cat >"$scratch/$1/CMakeLists.txt" <<EOF
cmake_minimum_required(VERSION 3.14)
project(user LANGUAGES C)
$2
add_executable(user $top/tests/packages/consumer.c)
target_link_libraries(user PRIVATE starcontour::starcontour)
EOF
}
# builds NAME OPTION...: configures, builds and runs it.
builds() {
    at=$scratch/$1
    shift
    rm -rf "$at/build"
    cmake -S "$at" -B "$at/build" -DCMAKE_C_COMPILER="$CC" "$@" && cmake --build "$at/build" &&
        same "$at/build/user"
}
# As one unit each: quicker, and that works as well.
quick='-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 -DCMAKE_C_FLAGS=-O0'

user inside "add_subdirectory($top starcontour)"
echo 'install(TARGETS user RUNTIME DESTINATION bin)' >>"$scratch/inside/CMakeLists.txt"
# shellcheck disable=SC2086
check "add_subdirectory" builds inside $quick
inside_installs() {
    cmake --install "$scratch/inside/build" --prefix "$scratch/inside/installed" &&
        test "$(ls "$scratch/inside/installed")" = bin
}
check "it installs only what is the user's" inside_installs

if [ -d "$scratch/unpacked" ]; then
    user fetched "include(FetchContent)
FetchContent_Declare(starcontour URL $scratch/dist/starcontour-$version.tar.gz)
FetchContent_MakeAvailable(starcontour)"
    # shellcheck disable=SC2086
    check "FetchContent, of the archive and as a shared library" builds fetched $quick \
        -DCMAKE_BUILD_TYPE=Debug -DBUILD_SHARED_LIBS=ON
else
    skip "FetchContent: no archive"
fi

# The soname's number, and the next version that breaks the interface.
case $version in
0.*) abi=${version%.*} newer=0.$((${abi#0.} + 1)) ;;
*) abi=${version%%.*} newer=$((abi + 1)) ;;
esac
# finds PREFIX REQUIREMENT...: and the user runs.
finds() {
    prefix=$1
    shift
    rm -rf "$scratch/found"
    user found "find_package(starcontour $* REQUIRED)" &&
        builds found -DCMAKE_PREFIX_PATH="$prefix" -DBUILD_SHARED_LIBS="${shared:-OFF}"
}
not_found() {
    rm -rf "$scratch/found"
    user found "find_package(starcontour $2 REQUIRED)" || return 1
    ! cmake -S "$scratch/found" -B "$scratch/found/build" -DCMAKE_C_COMPILER="$CC" \
        -DCMAKE_PREFIX_PATH="$1" >"$scratch/refusal" 2>&1 &&
        grep -q "version: $version" "$scratch/refusal"
}

check "make install" remake install DESTDIR="$scratch/root" PREFIX=/opt/sc
# Moved, too: nothing in it may name its first place.
mv "$scratch/root/opt/sc" "$scratch/moved"
check "find_package after make install: the static library" finds "$scratch/moved" "$abi"
standing_user() { # the project that stands in the repository
    cmake -S tests/packages -B "$scratch/standing" -DCMAKE_C_COMPILER="$CC" \
        -DCMAKE_PREFIX_PATH="$scratch/moved" && cmake --build "$scratch/standing" &&
        same "$scratch/standing/consumer"
}
check "the project in tests/packages, likewise" standing_user
uses_static() {
    ! grep -q 'libstarcontour\.so' "$scratch/found/build/CMakeFiles/user.dir/link.txt"
}
[ ! -f "$scratch/found/build/CMakeFiles/user.dir/link.txt" ] || check "is linked" uses_static
shared=ON
check "find_package after make install: the shared library" finds "$scratch/moved" "$version" EXACT
uses_shared() {
    grep -q "libstarcontour\.[sd].*$version" "$scratch/found/build/CMakeFiles/user.dir/link.txt"
}
[ ! -f "$scratch/found/build/CMakeFiles/user.dir/link.txt" ] || check "is linked" uses_shared
check "a later version is not found" not_found "$scratch/moved" "$newer"
check "an earlier soname is not found" not_found "$scratch/moved" 0.0.1

# What CMake installs: with the projects above, which have built the library already, static and
# shared.
for name in inside fetched; do
    [ -d "$scratch/$name/build" ] || continue
    tree=$scratch/$name/installed_too
    shared=OFF
    [ $name = inside ] || shared=ON
    check "CMake may install it along, shared $shared" cmake -S "$scratch/$name" \
        -B "$scratch/$name/build" -DSTARCONTOUR_INSTALL=ON -DCMAKE_INSTALL_PREFIX="$tree"
    check "CMake installs" cmake --build "$scratch/$name/build" --target install
    check "find_package after CMake's install" finds "$tree" "$version"
    documents=$tree/share/doc/starcontour
    has_documents() {
        cmp LICENSE "$documents/LICENSE" && cmp include/EMBEDDING.md "$documents/EMBEDDING.md" &&
            cmp CHANGELOG.md "$documents/CHANGELOG.md" &&
            cmp tests/ffi/cxx/starcontour.hpp "$tree/include/starcontour.hpp" &&
            cmp tests/ffi/rust/src/raw.rs "$documents/bindings/rust/src/raw.rs" &&
            test -z "$(find "$documents" -name '*.sh' -o -name '*.awk')" &&
            $CC -std=c99 -fsyntax-only -I"$tree/include" "$documents"/examples/*.c
    }
    check "CMake installs documents, examples and bindings" has_documents
    if [ "$shared" = ON ] && command -v readelf >/dev/null 2>&1 && command -v objcopy >/dev/null 2>&1; then
        stripped() {
            library=$(find "$tree" -name "libstarcontour.so.$version") &&
                ! readelf -S -W "$library" | grep -q '\.debug_info' &&
                readelf -S -W "${library%/*}/.debug/libstarcontour.so.$version.debug" | grep -q '\.debug_info'
        }
        check "CMake installs a stripped library, and its debug symbols beside it" stripped
    fi
done
check "a later version is not found" not_found "$tree" "$newer"
if command -v pkg-config >/dev/null 2>&1; then
    by_pkg_config() {
        PKG_CONFIG_PATH=$(dirname "$(find "$tree" -name starcontour.pc)")
        export PKG_CONFIG_PATH
        test "$(pkg-config --modversion starcontour)" = "$version" &&
            $CC -std=c99 tests/packages/consumer.c $(pkg-config --cflags --libs starcontour) \
                -Wl,-rpath,"$(pkg-config --variable=libdir starcontour)" -o "$scratch/by_pkg_config" &&
            same "$scratch/by_pkg_config"
    }
    check "pkg-config after CMake's install" by_pkg_config
else
    skip "pkg-config: not installed"
fi

finish
