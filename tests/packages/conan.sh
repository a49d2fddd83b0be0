#!/bin/sh
# The Conan recipe in tools/packaging/conan builds the checkout, and a CMake project that requires
# the package finds it and works; static and shared. Needs CMake, and Conan 2 or a network, from
# which it comes into build/conan.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

if ! command -v conan >/dev/null 2>&1; then
    [ -x build/conan/bin/conan ] || {
        python3 -m venv build/conan && build/conan/bin/python -m pip install --quiet conan
    } >"$scratch/log" 2>&1
    PATH=$PATH:$PWD/build/conan/bin
fi
for program in conan cmake; do
    if ! command -v $program >/dev/null 2>&1; then
        skip "the Conan recipe is untested here: no $program"
        finish
    fi
done

version=$(sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' include/starcontour.h |
    paste -sd. -)
top=$PWD
export CONAN_HOME="$scratch/home"
# Conan does not know what cc is; by itself it finds gcc or clang.
unset CC MAKEFLAGS MFLAGS MAKELEVEL

check "conan finds a compiler" conan profile detect
mkdir "$scratch/user"
cat >"$scratch/user/CMakeLists.txt" <<EOF
cmake_minimum_required(VERSION 3.15)
project(user LANGUAGES C)
find_package(starcontour $version REQUIRED)
add_executable(user $top/tests/packages/consumer.c)
target_link_libraries(user PRIVATE starcontour::starcontour)
EOF
for shared in False True; do
    option="-o starcontour/*:shared=$shared"
    at=$scratch/shared_$shared
    # shellcheck disable=SC2086
    check "conan create, shared $shared" conan create tools/packaging/conan --no-remote $option
    # From another folder: it leaves presets in one that has a CMakeLists.txt.
    install() {
        # shellcheck disable=SC2086
        (cd "$scratch" && conan install --requires "starcontour/$version" --no-remote $option \
            -g CMakeDeps -g CMakeToolchain -g VirtualRunEnv --output-folder "$at")
    }
    check "conan install" install
    check "CMake finds it" cmake -S "$scratch/user" -B "$at/build" -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_TOOLCHAIN_FILE="$at/conan_toolchain.cmake"
    check "a user of it builds" cmake --build "$at/build"
    # shellcheck disable=SC1091
    works() {
        (
            set +u
            . "$at/conanrun.sh"
            "$at/build/user" | grep '^wound: [1-9]'
        )
    }
    check "and works" works
done
finish
