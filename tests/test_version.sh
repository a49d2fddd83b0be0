#!/bin/sh
# Everything that names the version names the one in include/starcontour.h: the built library,
# packages for each manager, CHANGELOG.md, and what README.md tells CMake users to ask for. Files
# that read the header (Makefile, CMakeLists.txt, setup.py, the Conan recipe) must go on doing so.
#
# With SC_RELEASE=1, CHANGELOG.md must say on which day this version was released.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

# header_version TOP: what the header there says.
header_version() {
    sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' "$1/include/starcontour.h" | paste -sd. -
}
version=$(header_version .)
# The number that the soname and requirements end in: see "Versions" in the header.
abi_of() {
    case $1 in
    0.*) echo "${1%.*}" ;;
    *) echo "${1%%.*}" ;;
    esac
}

# Where a version is written out: FILE, and what of the line is before it, as an extended regular
# expression. The first such line counts. A file that is not there, or has no such line, is wrong.
written='
tools/packaging/vcpkg/starcontour/vcpkg.json|^ *"version": "
tests/ffi/rust/Cargo.toml|^version = "
tests/ffi/rust/Cargo.lock|^version = "
tools/packaging/rust/starcontour-sys.toml|^version = "
tools/packaging/rust/starcontour.toml|^version = "
tools/packaging/rust/starcontour.toml|^starcontour-sys = \{ version = "=
tools/packaging/nuget/starcontour.nuspec| *<version>
tools/packaging/nuget/Starcontour.csproj| *<Version>
tools/packaging/debian/changelog|^starcontour \(
CHANGELOG.md|^## +
README.md|^Version +'
# The same of what ends in the soname's number.
written_abi='
README.md|.*find_package\(starcontour +
README.md|^. apt .*libstarcontour
tests/packages/CMakeLists.txt|.*find_package\(starcontour +
tools/packaging/debian/control|^Package: libstarcontour
tools/packaging/debian/control|^Depends: libstarcontour
tools/packaging/debian/libstarcontour0.1.symbols|^libstarcontour.so.
tools/packaging/debian/libstarcontour0.1.symbols|.* libstarcontour'

# first FILE WORDS: the number behind the first of these words.
first() {
    sed -nE "s/$2([0-9]+(\.[0-9]+)*).*/\1/p" "$1" 2>/dev/null | head -n 1
}
# disagreeing TOP: the files there that name another version, a line each.
disagreeing() {
    wanted=$(header_version "$1")
    printf '%s\n' "$written" | while IFS='|' read -r file words; do
        [ -z "$file" ] || [ "$(first "$1/$file" "$words")" = "$wanted" ] || echo "$file"
    done
    wanted=$(abi_of "$wanted")
    printf '%s\n' "$written_abi" | while IFS='|' read -r file words; do
        [ -z "$file" ] || [ "$(first "$1/$file" "$words")" = "$wanted" ] || echo "$file"
    done
}
agree() {
    disagreeing . >"$scratch/disagreeing"
    cat "$scratch/disagreeing"
    test ! -s "$scratch/disagreeing"
}
names() {
    printf '%s\n%s\n' "$written" "$written_abi" | sed -n 's/|.*//p' | sort -u
}
check "the header has a version" test -n "$version"
check "files that write the version out agree with the header ($version)" agree

# All of them are noticed when the header goes on alone.
next=$scratch/next
mkdir "$next"
for file in $(names) include/starcontour.h; do
    mkdir -p "$(dirname "$next/$file")"
    cp "$file" "$next/$file" || true
done
noticed() {
    sed "s/^\(#define SC_VERSION_$1\) .*/\1 77/" include/starcontour.h >"$next/include/starcontour.h"
    disagreeing "$next" | sort -u >"$scratch/noticed"
    "$2" | sort -u | diff - "$scratch/noticed"
}
names_in_full() {
    printf '%s\n' "$written" | sed -n 's/|.*//p'
}
check "another patch number in the header is noticed in each file" noticed PATCH names_in_full
check "so is another minor number" noticed MINOR names

# No other file of a package says "version": it belongs into the list above.
unlisted() {
    find tools tests/ffi tests/packages -type f \( -name '*.json' -o -name '*.toml' -o -name '*.nuspec' \
        -o -name '*.csproj' -o -name 'changelog' \) -not -path '*/node_modules/*' \
        -not -name package-lock.json -exec grep -lE \
        '^ *"?version"? *[:=] *"[0-9]|<[Vv]ersion>[0-9.]+<|^starcontour \([0-9]' {} + |
        while read -r file; do names | grep -qxF "$file" || echo "$file"; done >"$scratch/unlisted"
    cat "$scratch/unlisted"
    test ! -s "$scratch/unlisted"
}
check "no other package writes it out (if one does, add it to this script)" unlisted

# What reads the header.
reads() {
    grep -q 'SC_VERSION_' "$1" && ! grep -nE '(^|[^0-9.])'"$version"'([^0-9.]|$)' "$1"
}
for file in CMakeLists.txt tools/python/setup.py tools/packaging/conan/conanfile.py; do
    check "$file reads the header" reads "$file"
done
# The package for npm is told it by the Makefile; what stands in for the module is empty here.
npm_says() {
    mkdir -p "$scratch/npm/wasm" && : >"$scratch/npm/wasm/starcontour.wasm" &&
        grep -q "make_package.sh package '\$(version)'" Makefile &&
        BUILD="$scratch/npm" sh tools/npm/make_package.sh package "$version" &&
        ! grep -E '"version": "[0-9]' tools/npm/package.json.in &&
        grep -x "  \"version\": \"$version\"," "$scratch/npm/wasm/package/package.json"
}
check "the package for npm says $version" npm_says
make_says() {
    "$MAKE" --no-print-directory help 2>/dev/null | head -n 1 | grep -qx "starcontour $version"
}
check "make help says starcontour $version" make_says

# What was built.
cat >"$scratch/version.c" <<'EOC'
#include <starcontour.h>
#include <stdio.h>
int main(void)
{
    printf("%s %u %u\n", sc_version_string(), (unsigned)sc_version(), (unsigned)SC_VERSION_NUMBER);
    return 0;
}
EOC
library_says() {
    number=$(echo "$version" | awk -F. '{ print $1 * 10000 + $2 * 100 + $3 }')
    # shellcheck disable=SC2086
    $CC -std=c99 -Iinclude "$scratch/version.c" "$SC_LIB/libstarcontour.a" -lm $SC_FLAGS \
        -o "$scratch/version" && "$scratch/version" | grep -x "$version $number $number"
}
check "the library says $version" library_says
if [ -x "$SC_BIN/sc-query" ]; then
    check "so does sc-query --version" says 0 "$version" "$SC_BIN/sc-query" --version
else
    skip "sc-query: it was not built"
fi

# The day of the release, or that it is not released.
dated() {
    grep -m 1 '^## ' CHANGELOG.md | grep -Ex "## $version \\(($1)\\)"
}
day='20[0-9][0-9]-[01][0-9]-[0-3][0-9]'
if [ "${SC_RELEASE:-0}" = 1 ]; then
    check "CHANGELOG.md says when $version was released" dated "$day"
else
    check "CHANGELOG.md says when $version was released, or that it was not" dated "$day|unreleased"
fi

finish
