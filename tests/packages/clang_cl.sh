#!/bin/sh
# By MSVC's rules: clang-cl, which keeps the binary interface of Microsoft's compiler and takes its
# options, with the headers and import libraries of mingw-w64 in place of Microsoft's.
# CMakeLists.txt builds as it does with Visual Studio's ClangCL: the static library and the DLL,
# warnings as errors; tests and users are linked with them, and under wine, where that is there, run
# and give the same pairs as here.
#
#     tests/packages/clang_cl.sh [MINGW]      x86_64-w64-mingw32
#
# What it does not show: what Microsoft's own compiler and headers warn of, and its code.
# Debian: clang, lld, llvm, gcc-mingw-w64-x86-64, cmake, wine.
#
# SPDX-License-Identifier: MIT
. tests/script.sh
. tests/portable.sh
. tests/wine.sh
set +u
mingw=${1:-x86_64-w64-mingw32}
set -u
unset MAKEFLAGS MFLAGS MAKELEVEL

libraries=/usr/$mingw/lib
headers=
for folder in "/usr/share/mingw-w64/include" "/usr/$mingw/include"; do
    [ -z "$headers" ] && [ -e "$folder/_mingw.h" ] && headers=$folder
done
missing=
for name in clang-cl lld-link llvm-lib llvm-dlltool llvm-readobj; do
    tool "$name" >/dev/null || missing="$missing $name"
done
command -v cmake >/dev/null 2>&1 || missing="$missing cmake"
[ -n "$headers" ] || missing="$missing mingw-w64's-headers"
[ -e "$libraries/libucrt.a" ] || missing="$missing libucrt.a"
if [ -n "$missing" ]; then
    skip "nothing was built by clang-cl; not there:$missing"
    finish
fi
at=$scratch/made
mkdir "$at"

# ------------------------------------------------------------------------------------------------
# In place of Microsoft's headers and start-up code

# mingw's headers are for gcc first: MSVC has attributes before a declaration, where they have them
# behind, and infinity is a constant.
cat >"$at/as_windows.h" <<'EOC'
#include <_mingw.h>
#undef __MINGW_ATTRIB_NORETURN
#define __MINGW_ATTRIB_NORETURN
#undef __MINGW_ATTRIB_DEPRECATED
#define __MINGW_ATTRIB_DEPRECATED
#undef __MINGW_NOTHROW
#define __MINGW_NOTHROW
#include <math.h>
#undef INFINITY
#undef NAN
#undef HUGE_VAL
#undef HUGE_VALF
#define INFINITY ((float)(1e300 * 1e300))
#define NAN (-(float)(INFINITY * 0.0F))
#define HUGE_VAL ((double)INFINITY)
#define HUGE_VALF INFINITY
EOC
cat >"$at/start.c" <<'EOC'
int _configure_narrow_argv(int mode);
int *__p___argc(void);
char ***__p___argv(void);
void exit(int status);
int main(int count, char **words);
void mainCRTStartup(void);
void mainCRTStartup(void)
{
    _configure_narrow_argv(1);
    exit(main(*__p___argc(), *__p___argv()));
}
EOC
echo 'int _fltused = 1;' >"$at/floats.c"
# What mingw would take from libraries of its own, Windows has in these.
cat >"$at/ntdll.def" <<'EOC'
LIBRARY ntdll.dll
EXPORTS
__chkstk
EOC
{
    printf 'LIBRARY ucrtbase.dll\nEXPORTS\n'
    printf '%s\n' atan2 ceil cos exp floor fmod ldexp pow sin sqrt
} >"$at/ucrtbase.def"
settings="-Wextra -Wno-pass-failed /GS- /D_UCRT /D__USE_MINGW_ANSI_STDIO=0 /imsvc $headers /FI$at/as_windows.h"
clang_cl="$(tool clang-cl) --target=x86_64-pc-windows-msvc"
options="/nologo /c /O2 /W4 /WX /fp:precise /Iinclude /Ilib /Itests $settings"
system="$at/floats.obj $at/ucrtbase.lib $libraries/libucrt.a $libraries/libkernel32.a $at/ntdll.lib"

start_code() {
    for name in ntdll ucrtbase; do
        "$(tool llvm-dlltool)" -m i386:x86-64 -d "$at/$name.def" -l "$at/$name.lib" || return 1
    done
    for name in start floats; do
        $clang_cl /nologo /c /O2 /GS- "$at/$name.c" "/Fo$at/$name.obj" || return 1
    done
}
check "import libraries and start-up code" start_code

# ------------------------------------------------------------------------------------------------
# By CMake

# cmake_build NAME SETTINGS OPTION...: builds into $at/NAME.
cmake_build() {
    folder=$at/$1
    more=$2
    shift 2
    mkdir "$folder" || return 1
    cat >"$folder/toolchain.cmake" <<EOC
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR AMD64)
set(CMAKE_C_COMPILER $(tool clang-cl))
set(CMAKE_C_COMPILER_TARGET x86_64-pc-windows-msvc)
set(CMAKE_LINKER $(tool lld-link))
set(CMAKE_AR $(tool llvm-lib))
set(CMAKE_MT true)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_C_FLAGS_INIT "/W4 /WX $settings $more")
set(CMAKE_SHARED_LINKER_FLAGS_INIT "/nodefaultlib /noentry")
EOC
    cmake -S . -B "$folder" -DCMAKE_TOOLCHAIN_FILE="$folder/toolchain.cmake" -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_C_STANDARD_LIBRARIES="$system" "$@" && cmake --build "$folder" -j "$jobs" --verbose
}
# Versions of MSVC on both sides of 2022, whose rounding is asked for by other options.
check "CMake builds the static library" cmake_build static -fmsc-version=1938
keeps_rounding() {
    grep -q "$2" "$at/$1/CMakeFiles/starcontour.dir/flags.make"
}
check "with /fp:precise" keeps_rounding static /fp:precise
check "CMake builds the DLL" cmake_build dll -fmsc-version=1929 -DBUILD_SHARED_LIBS=ON
check "with /fp:strict" keeps_rounding dll /fp:strict
[ "$checks_failed" -eq 0 ] || finish
static=$at/static/starcontour.lib
dll=$at/dll/starcontour.dll
import=$at/dll/starcontour.lib
ls "$static" "$dll" "$import" >/dev/null || exit 1
exports() {
    "$(tool llvm-readobj)" --coff-exports "$dll" | sed -n 's/^ *Name: \(..*\)$/\1/p' | sort |
        diff tests/abi/symbols.txt -
}
check "the DLL exports what it should" exports
alone() {
    "$(tool llvm-readobj)" --coff-imports "$dll" | sed -n 's/^ *Name: \(.*\.dll\)$/\1/p' >"$scratch/needed"
    grep -q . "$scratch/needed" &&
        ! grep -vi '^kernel32\.dll$\|^ntdll\.dll$\|^ucrtbase\.dll$\|^api-ms-win-crt-' "$scratch/needed"
}
check "the DLL needs none but those of Windows" alone

# ------------------------------------------------------------------------------------------------
# Tests and users

# compile FOLDER OPTION... -- SOURCE...: objects there, warnings as errors.
compile() {
    folder=$1
    shift
    more=
    while [ "$1" != -- ]; do
        more="$more $1"
        shift
    done
    shift
    mkdir -p "$folder"
    for source; do
        echo "$source" "$folder/$(basename "$source" .c).obj"
    done | xargs -n 2 -P "$jobs" sh -c "$clang_cl $options $more"' "$0" "/Fo$1"'
}
# link PROGRAM OBJECT...
link() {
    program=$1
    shift
    # shellcheck disable=SC2086
    "$(tool lld-link)" /nologo /subsystem:console /nodefaultlib "/out:$at/$program.exe" "$@" \
        "$at/start.obj" $system
}
objects() {
    folder=$1
    shift
    for source; do echo "$folder/$(basename "$source" .c).obj"; done
}
# support FOLDER: what tests share, as an archive.
support() {
    # shellcheck disable=SC2046,SC2086
    "$(tool llvm-lib)" /nologo "/out:$1/support.lib" $(objects "$1" $portable_support)
}
# shellcheck disable=SC2086
skip "$(echo $portable_left_out): not built by clang-cl; they need GMP, libccd or POSIX" \
    "$(echo "$portable_left_out" | wc -l)"
# shellcheck disable=SC2086,SC2046
{
    check "tests compile" compile "$at/tests" -- lib/build/partition_metis.c $portable_support \
        $(printf 'tests/test_%s.c ' $portable_tests)
    check "what they share" support "$at/tests"
    for test in $portable_tests; do
        check "test_$test links" link "test_$test" "$at/tests/test_$test.obj" "$at/tests/support.lib" \
            "$at/tests/partition_metis.obj" "$static"
    done
    check "determinism compiles" compile "$at/same" /FItests/packages/same_math.h -- $portable_determinism
    check "determinism links" link determinism $(objects "$at/same" $portable_determinism) "$static"
    check "a user compiles" compile "$at/user" -- tests/packages/consumer.c
    check "a user of the static library links" link consumer "$at/user/consumer.obj" "$static"
    check "a user of the DLL compiles" compile "$at/dll/user" /DSC_SHARED -- tests/packages/consumer.c
    check "a user of the DLL links" link dll/consumer "$at/dll/user/consumer.obj" "$import"
    check "a program of version 0.1 compiles" compile "$at/old" /DSC_SHARED /Itests/abi -- \
        tests/abi/old_caller.c tests/harness.c
    check "a program of version 0.1 links" link dll/old_caller "$at/old/old_caller.obj" \
        "$at/old/harness.obj" "$import"
    check "a C++ program compiles" compile "$at/cxx" /TP -- tests/packages/consumer.c
}
one_file() {
    "$MAKE" --no-print-directory amalgamation BUILD="$at" &&
        compile "$at/one" /clang:-O0 -- "$at/amalgamation/starcontour.c" &&
        link amalgamated "$at/user/consumer.obj" "$at/one/starcontour.obj"
}
check "the amalgamation" one_file

# The layouts of 64 bits, here where long has 32.
layouts_hold "" $clang_cl /nologo /Zs /std:c11 /WX /Iinclude $settings
# ------------------------------------------------------------------------------------------------
# Running

start_wine "by clang-cl"
portable_tests_pass
check "a program of version 0.1 runs with the DLL" windows dll/old_caller
same_pairs() {
    for program in consumer dll/consumer amalgamated; do
        windows $program | plain | cksum | cmp - tests/packages/consumer.cksum || return 1
    done
}
check "the same pairs as everywhere" same_pairs
# Here, as there is one set of instructions there, queries are more: the hash is compared.
same_hash() {
    # shellcheck disable=SC2046,SC2086
    $CC -std=c99 -O1 -ffp-contract=off -include tests/packages/same_math.h -Iinclude -Ilib -Itests \
        $portable_determinism $(grep '^lib/' lib/sources.list) -lm -o "$scratch/determinism" &&
        "$scratch/determinism" meshes/*.obj | sed 's/ .*//' >"$scratch/hash" && test -s "$scratch/hash" &&
        windows determinism meshes/*.obj | plain | sed 's/ .*//' | diff "$scratch/hash" -
}
check "the same pairs as here, by all methods, of meshes in many poses" same_hash
finish
