#!/bin/sh
# Packs the binding for C# (tests/ffi/csharp) and the native library for 64-bit Linux for NuGet.
#
#     tools/packaging/nuget/make_nupkg.sh FOLDER LIBRARY     from the top of the repository
#
# LIBRARY is the shared library. In FOLDER the package is put together, and
# Starcontour.VERSION.nupkg is written. By `dotnet pack` where there is dotnet (not tried); else by
# mcs and nuget (Debian: mono-mcs, nuget).
#
# SPDX-License-Identifier: MIT
set -eu

folder=$1
native=$folder/runtimes/linux-x64/native
here=tools/packaging/nuget
binding=tests/ffi/csharp/Starcontour.cs
rm -rf "$folder"
mkdir -p "$native"
"${OBJCOPY:-objcopy}" --strip-unneeded "$2" "$native/libstarcontour.so"
cp $here/README.md $here/Starcontour.csproj $here/starcontour.nuspec LICENSE "$folder"
if command -v dotnet >/dev/null 2>&1; then
    cp $binding "$folder"
    rm "$folder/starcontour.nuspec"
    (cd "$folder" && dotnet pack --configuration Release --output .)
else
    mkdir -p "$folder/lib/net45"
    mcs -unsafe -optimize -warnaserror -target:library -out:"$folder/lib/net45/Starcontour.dll" $binding
    (cd "$folder" && HOME=$PWD nuget pack starcontour.nuspec -NoPackageAnalysis)
fi
ls "$folder"/Starcontour.*.nupkg
