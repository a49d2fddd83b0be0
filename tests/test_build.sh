#!/bin/sh
# The build itself: `make help`, the bare compile, `make install` and what is linked with it.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

# The surrounding make, if any, has handed its variables down in MAKEFLAGS: this is the same build.
remake() {
    "$MAKE" --no-print-directory -j1 config="$SC_CONFIG" "$@"
}

# ------------------------------------------------------------------------------------------------
# make help

remake help 2>/dev/null |
    sed -n -e '/^Targets:/,/^Variables:/s/^  \([a-z0-9-]*\) .*/\1/p' | sort >"$scratch/listed"
sed -n 's/^\.PHONY: //p' Makefile | tr ' ' '\n' | grep -v -x -e FORCE -e after-deps -e '\$.*' |
    sort -u >"$scratch/phony"
remake -p -n -q help 2>/dev/null | sed -n 's/^\([a-z][a-z0-9-]*\):.*/\1/p' | sort -u >"$scratch/rules"

check "make help lists targets" test -s "$scratch/listed"
check "each target that make help lists exists" \
    test -z "$(comm -23 "$scratch/listed" "$scratch/rules")"
check "make help lists all targets" diff "$scratch/phony" "$scratch/listed"

says_how_long() {
    for target in bench bench-quick coverage mutants peers soak test test-cgal test-determinism test-ffi \
        test-ipctk test-memory-clang test-packages test-thread test-valgrind; do
        remake help 2>/dev/null | grep -q "^  $target .*\(minute\|hour\)" ||
            { echo "$target: not how long it takes"; return 1; }
    done
}
check "make help says about how long the long targets take" says_how_long

variables_exist() {
    for variable in $(remake help 2>/dev/null |
        sed -n -e '1,/^Variables:/d' -e 's/^  \([A-Za-z]*\) .*/\1/p'); do
        grep -q "\$($variable)" Makefile || { echo "$variable is not used"; return 1; }
    done
}
check "each variable that make help lists is used" variables_exist

wrong_config() {
    "$MAKE" --no-print-directory -n config=fastest all 2>&1 | grep -q 'must be release, debug or sanitize'
}
check "a wrong config is refused" wrong_config

# ------------------------------------------------------------------------------------------------
# No build system at all.

bare() {
    root=$PWD
    mkdir "$scratch/bare"
    # shellcheck disable=SC2086
    (cd "$scratch/bare" && $CC -std=c99 -O2 -I"$root/include" -I"$root/lib" \
        -c "$root"/lib/*.c "$root"/lib/*/*.c) &&
        ar rcs "$scratch/bare.a" "$scratch"/bare/*.o &&
        $CC -std=c99 -Iinclude "$scratch/use.c" "$scratch/bare.a" -lm -o "$scratch/use_bare" &&
        "$scratch/use_bare"
}
cat >"$scratch/use.c" <<'END'
#include <starcontour.h>
#include <string.h>
int main(void)
{
    const float at[] = {0, 0, 0, 2, 0, 0, 0, 2, 0, 0.5f, 0.5f, -1, 0.5f, 0.5f, 1, 3, 3, 1};
    const uint16_t triangles[] = {0, 1, 2, 3, 4, 5};
    const sc_mesh mesh = {.struct_size = sizeof(mesh), .vertex_count = 6, .triangle_count = 2,
                          .positions = at, .index_type = SC_UINT16, .indices = triangles};
    const sc_pose pose = {.struct_size = sizeof(pose), .vertex_count = 6, .positions = at};
    sc_result result = {.struct_size = sizeof(result)};
    sc_model *model;
    sc_workspace *workspace;
    if (sc_version() != SC_VERSION_NUMBER) return 1;
    if (sc_build(&mesh, NULL, &model)) return 2;
    if (sc_workspace_create(model, NULL, &workspace)) return 3;
    if (sc_query(model, workspace, &pose, NULL, &result) != SC_ERROR_SHORT_BUFFER) return 4;
    sc_workspace_free(workspace);
    sc_model_free(model);
    return result.count == 1 ? 0 : 5;
}
END
check "one bare cc compiles the library" bare

# ------------------------------------------------------------------------------------------------
# The small meshes

if [ -x "$SC_BIN/make-meshes" ]; then
    same_meshes() {
        mkdir "$scratch/meshes"
        "$SC_BIN/make-meshes" "$scratch/meshes" || return 1
        for mesh in meshes/*.obj; do
            cmp "$mesh" "$scratch/meshes/$(basename "$mesh")" || return 1
        done
    }
    check "make-meshes writes the meshes in meshes/" same_meshes
else
    skip "make-meshes: it was not built"
fi

# ------------------------------------------------------------------------------------------------
# make install

version=$(sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' include/starcontour.h |
    paste -sd. -)
root=$scratch/root
check "make install" remake install DESTDIR="$root" PREFIX=/opt/sc
home=$root/opt/sc
check "only PREFIX is written to" test "$(ls "$root")$(ls "$root/opt")" = optsc
check "the header is installed" cmp include/starcontour.h "$home/include/starcontour.h"
check "the C++ header is installed" cmp tests/ffi/cxx/starcontour.hpp "$home/include/starcontour.hpp"
check "the static library is installed" test -s "$home/lib/libstarcontour.a"
for program in sc-query sc-partition; do
    [ ! -x "$SC_BIN/$program" ] ||
        check "$program is installed" test -x "$home/bin/$program"
done

# What is installed is stripped; the debug symbols are beside it, and the link to them is right.
if command -v readelf >/dev/null 2>&1 && command -v objcopy >/dev/null 2>&1 &&
    readelf -h "$SC_LIB/libstarcontour.so" >/dev/null 2>&1; then
    # debug_of FILE: lists its sections of debug symbols.
    debug_of() {
        readelf -S -W "$1" 2>/dev/null | grep -o '\.debug_info'
    }
    has_debug() {
        debug_of "$1" && ! readelf -S -W "$1" 2>/dev/null | grep -q '\.text  *PROGBITS'
    }
    is_stripped() {
        test -s "$1" && ! debug_of "$1"
    }
    links_to() {
        readelf -p .gnu_debuglink "$1" | grep -q " $2\$"
    }
    names() {
        nm "$1" 2>/dev/null | grep -q ' T sc_query$'
    }
    if debug_of "$SC_LIB/libstarcontour.so" >"$scratch/debug"; then
        shared=libstarcontour.so.$version
        for file in "lib/$shared" bin/sc-query bin/sc-partition; do
            [ -e "$home/$file" ] || continue
            symbols=$home/${file%/*}/.debug/${file##*/}.debug
            check "$file is stripped" is_stripped "$home/$file"
            check "its debug symbols are beside it" has_debug "$symbols"
            check "it names them" links_to "$home/$file" "${file##*/}.debug"
            check "they are no program" test ! -x "$symbols"
        done
        check "the shared library has no names but those it exports" test -z "$(nm "$home/lib/$shared" 2>/dev/null)"
        check "the static library is stripped" is_stripped "$home/lib/libstarcontour.a"
        check "and can be linked" names "$home/lib/libstarcontour.a"
        as_built() {
            remake install DESTDIR="$scratch/as_built" PREFIX=/opt/sc OBJCOPY= &&
                cmp "$SC_LIB/$shared" "$scratch/as_built/opt/sc/lib/$shared" &&
                cmp "$SC_LIB/libstarcontour.a" "$scratch/as_built/opt/sc/lib/libstarcontour.a" &&
                test -z "$(find "$scratch/as_built" -name .debug)"
        }
        check "without objcopy all is installed as it was built" as_built
        rm -rf "$scratch/as_built"
    else
        skip "stripped libraries: this build has no debug symbols"
    fi
else
    skip "stripped libraries: no readelf, no objcopy or no ELF library"
fi

# Documents, examples, and bindings for other languages.
documents=$home/share/doc/starcontour
for file in LICENSE CHANGELOG.md include/EMBEDDING.md; do
    check "${file##*/} is installed" cmp "$file" "$documents/${file##*/}"
done
same_bindings() {
    (cd tests/ffi && find . -type f ! -path './[a-z]*.sh' ! -path './golden*' ! -name '*.awk' \
        ! -name '*.pyc') | sort >"$scratch/bindings"
    (cd "$documents/bindings" && find . -type f) | sort | diff "$scratch/bindings" - || return 1
    while read -r file; do
        cmp "tests/ffi/$file" "$documents/bindings/$file" || return 1
    done <"$scratch/bindings"
}
check "all bindings are installed" same_bindings

no_build_paths() {
    ! grep -r -F -e "$root" -e "$PWD" "$home/lib/pkgconfig"
}
check "pkg-config files name no directory of this build" no_build_paths

if command -v readelf >/dev/null 2>&1 && [ -e "$home/lib/libstarcontour.so" ]; then
    soname=$(readelf -d "$home/lib/libstarcontour.so" | sed -n 's/.*(SONAME).*\[\(.*\)\]/\1/p')
    case $version in
    0.*) expected=libstarcontour.so.${version%.*} ;;
    *) expected=libstarcontour.so.${version%%.*} ;;
    esac
    check "the soname is $expected, not $soname" test "$soname" = "$expected"
    check "the soname can be loaded" test -e "$home/lib/$soname"
else
    skip "soname: no readelf or no ELF library"
fi

# link_with NAME FLAGS...: builds and runs a program against the installed library.
link_with() {
    name=$1
    shift
    # shellcheck disable=SC2086
    $CC -std=c99 -o "$scratch/$name" "$@" $SC_FLAGS &&
        LD_LIBRARY_PATH=$home/lib "$scratch/$name"
}

if command -v pkg-config >/dev/null 2>&1; then
    config() {
        PKG_CONFIG_PATH=$home/lib/pkgconfig pkg-config --define-variable=prefix="$home" \
            --define-variable=includedir="$home/include" --define-variable=libdir="$home/lib" "$@"
    }
    check "pkg-config knows the version" test "$(config --modversion starcontour)" = "$version"
    # shellcheck disable=SC2046
    check "the shared library works by pkg-config" \
        link_with use_shared "$scratch/use.c" $(config --cflags --libs starcontour)
    [ ! -e "$home/lib/libstarcontour_metis.a" ] ||
        check "pkg-config knows starcontour_metis" config --exists starcontour_metis
else
    skip "pkg-config: not installed"
fi
check "the static library works" link_with use_static "$scratch/use.c" -I"$home/include" "$home/lib/libstarcontour.a" -lm

for example in first_query engine; do
    check "the installed example $example works" link_with "$example" -x c \
        "$documents/examples/$example.c" -x none -I"$home/include" "$home/lib/libstarcontour.a" -pthread -lm
done
if command -v "${CXX:-g++}" >/dev/null 2>&1; then
    in_cxx() {
        "${CXX:-g++}" -std=c++17 -Wall -Wextra -Werror -I"$home/include" -fsyntax-only -x c++ \
            "$home/include/starcontour.hpp" -Wno-pragma-once-outside-header
    }
    check "the installed C++ header compiles" in_cxx
else
    skip "the C++ header: no ${CXX:-g++}"
fi

check "make uninstall" remake uninstall DESTDIR="$root" PREFIX=/opt/sc
check "nothing is left" test -z "$(find "$root" ! -type d)"
check "no folder of its own is left" test -z "$(find "$root" -name '*starcontour*' -o -name .debug)"

finish
