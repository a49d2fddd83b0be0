#!/bin/sh
# The package for NuGet, unpacked: the program of tests/ffi/csharp, compiled with its assembly,
# passes with its native library, and so does README.md's example. Needs Mono, Debian's nuget and
# Python 3; `dotnet pack` is taken where there is dotnet.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

for program in mcs mono nuget python3; do
    if ! command -v $program >/dev/null 2>&1; then
        skip "NuGet: no $program"
        finish
    fi
done
case $(uname -sm) in
'Linux x86_64') ;;
*)
    skip "NuGet: the package is for 64-bit Linux"
    finish
    ;;
esac
unset MAKEFLAGS MFLAGS MAKELEVEL
export TERM="${TERM:-dumb}"
version=$(sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' include/starcontour.h |
    paste -sd. -)
library=$SC_LIB/libstarcontour.so
[ -e "$library" ] || "$MAKE" --no-print-directory "$library" >"$scratch/log" 2>&1

check "it is packed" tools/packaging/nuget/make_nupkg.sh "$scratch/package" "$library"
unpacks() {
    python3 -m zipfile -e "$scratch/package/Starcontour.$version.nupkg" "$scratch/unpacked"
}
check "it is an archive named by its version" unpacks
native=$scratch/unpacked/runtimes/linux-x64/native
assembly=$(find "$scratch/unpacked/lib" -name Starcontour.dll)
check "with an assembly, a library, a license and a manual" test -s "$assembly" -a \
    -s "$native/libstarcontour.so" -a -s "$scratch/unpacked/LICENSE" -a -s "$scratch/unpacked/README.md"

mkdir "$scratch/user" && cp "$assembly" "$scratch/user"
# compiles NAME FILE: to a program beside the assembly.
compiles() {
    mcs -unsafe -warnaserror -r:"$assembly" -out:"$scratch/user/$1.exe" "$2"
}
with_package() {
    LD_LIBRARY_PATH=$native mono "$@"
}
layout() {
    awk -f tests/abi/interface.awk include/starcontour.h >"$scratch/interface.c" &&
        $CC -std=c99 -Iinclude -o "$scratch/interface" "$scratch/interface.c" &&
        "$scratch/interface" | sed -n -e 's/^struct \([a-z_0-9]*\): \([0-9]*\) bytes.*/struct \1 \2/p' \
            -e 's/^\(sc_[a-z_0-9]*\)\.\([a-z_0-9]*\): at \([0-9]*\), \([0-9]*\) bytes.*/member \1 \2 \3 \4/p' \
            -e 's/^\(SC_[A-Z_0-9]*\) = \(.*\)/value \1 \2/p' >"$scratch/layout.txt"
}
check "the header's structures are listed" layout
check "the program of tests/ffi is compiled with it" compiles ffi tests/ffi/csharp/FfiCsharp.cs
check "and passes" with_package "$scratch/user/ffi.exe" meshes/crossing_cloths.obj tests/ffi/golden.txt \
    "$scratch/layout.txt"

{
    echo 'static class Example { static void Main() {'
    awk '/^```csharp$/ { inside = 1; next } /^```$/ { inside = 0 } inside' \
        "$scratch/unpacked/README.md"
    echo '} }'
} >"$scratch/Example.cs"
check "its manual's example compiles" compiles example "$scratch/Example.cs"
says_it() {
    with_package "$scratch/user/example.exe" | grep -x 'triangles 0 and 1 intersect'
}
check "and finds the pair" says_it

finish
