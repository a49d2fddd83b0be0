#!/bin/sh
# The vcpkg port in tools/packaging/vcpkg. With vcpkg: it is installed from the checkout, and a
# CMake project finds it. Without: its steps are walked through with stand-ins for vcpkg's
# functions, which shows that the sources are found and installed, not that vcpkg takes the port.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

port=tools/packaging/vcpkg/starcontour
version=$(sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' include/starcontour.h |
    paste -sd. -)
unset MAKEFLAGS MFLAGS MAKELEVEL
check "the port has the header's version" grep -q "\"version\": \"$version\"" $port/vcpkg.json
if command -v python3 >/dev/null 2>&1; then
    check "vcpkg.json is JSON" python3 -m json.tool $port/vcpkg.json
fi

if ! command -v cmake >/dev/null 2>&1; then
    skip "the vcpkg port is untested here: no cmake"
elif command -v vcpkg >/dev/null 2>&1; then
    check "vcpkg install" vcpkg install starcontour --overlay-ports=tools/packaging/vcpkg \
        --x-install-root="$scratch/installed"
    mkdir "$scratch/user"
    cat >"$scratch/user/CMakeLists.txt" <<EOF
cmake_minimum_required(VERSION 3.15)
project(user LANGUAGES C)
find_package(starcontour $version REQUIRED)
add_executable(user $PWD/tests/packages/consumer.c)
target_link_libraries(user PRIVATE starcontour::starcontour)
EOF
    prefix=$(dirname "$(dirname "$(find "$scratch/installed" -path '*/include/starcontour.h')")")
    check "find_package" cmake -S "$scratch/user" -B "$scratch/user/build" -DCMAKE_PREFIX_PATH="$prefix"
    check "a user of it builds" cmake --build "$scratch/user/build"
    check "and works" "$scratch/user/build/user"
else
    skip "the vcpkg port is untested by vcpkg itself, which is not here"
    cat >"$scratch/stand_in.cmake" <<'EOF'
set(CURRENT_PORT_DIR ${PORT})
set(CURRENT_PACKAGES_DIR ${AT}/package)
function(run)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE result)
    if(result)
        message(FATAL_ERROR "failed: ${ARGV}")
    endif()
endfunction()
function(vcpkg_cmake_configure)
    cmake_parse_arguments(arg "" "SOURCE_PATH" "" ${ARGN})
    run(${CMAKE_COMMAND} -S ${arg_SOURCE_PATH} -B ${AT}/tree -DCMAKE_UNITY_BUILD=ON
        -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 -DCMAKE_INSTALL_PREFIX=${CURRENT_PACKAGES_DIR}
        -DCMAKE_INSTALL_LIBDIR=lib)
endfunction()
function(vcpkg_cmake_install)
    run(${CMAKE_COMMAND} --build ${AT}/tree --target install)
endfunction()
function(vcpkg_copy_pdbs)
endfunction()
function(vcpkg_cmake_config_fixup)
    cmake_parse_arguments(arg "" "CONFIG_PATH" "" ${ARGN})
    file(GLOB found ${CURRENT_PACKAGES_DIR}/${arg_CONFIG_PATH}/*-config.cmake)
    if(NOT found)
        message(FATAL_ERROR "no configuration in ${arg_CONFIG_PATH}")
    endif()
endfunction()
function(vcpkg_fixup_pkgconfig)
    if(NOT EXISTS ${CURRENT_PACKAGES_DIR}/lib/pkgconfig/starcontour.pc)
        message(FATAL_ERROR "no starcontour.pc")
    endif()
endfunction()
function(vcpkg_install_copyright)
    cmake_parse_arguments(arg "" "" "FILE_LIST" ${ARGN})
    foreach(file IN LISTS arg_FILE_LIST)
        if(NOT EXISTS ${file})
            message(FATAL_ERROR "no ${file}")
        endif()
    endforeach()
endfunction()
include(${PORT}/portfile.cmake)
EOF
    check "the port's steps, with stand-ins" cmake -DPORT="$PWD/$port" -DAT="$scratch/at" \
        -P "$scratch/stand_in.cmake"
    check "install the header" cmp include/starcontour.h "$scratch/at/package/include/starcontour.h"
fi
finish
