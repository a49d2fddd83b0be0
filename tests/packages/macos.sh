#!/bin/sh
# By macOS's binary interface, for Intel and ARM: the Makefile, told that it is on macOS, builds the
# static and the shared library by clang and LLVM's linker. Nothing of it can run here. What is
# seen: it compiles without a warning and links; what the shared library exports, under which names,
# and what it needs; structures, enumerators and calls are those of tests/abi.
#
#     tests/packages/macos.sh [SDK]      a folder with usr/include and usr/lib of macOS
#
# Without an SDK it is that of zig (a program, or Python's module ziglang), which carries macOS's
# own headers and the list of what libSystem has. Without zig there are stand-ins: the headers of
# tests/packages/libc, and a list of what the library calls of libSystem; tests are left out then.
#
# Debian: clang, lld, llvm. zig: pip install 'ziglang==0.13.*'; clang 14 does not read the headers
# that 0.15 and newer ones have. Stand-ins then, too.
#
# SPDX-License-Identifier: MIT
. tests/script.sh
. tests/portable.sh
set +u
given=$1
set -u
unset MAKEFLAGS MFLAGS MAKELEVEL

missing=
for name in ld64.lld llvm-ar llvm-nm llvm-objdump; do
    tool "$name" >/dev/null || missing="$missing $name"
done
if [ -n "$missing" ]; then
    skip "nothing was built for macOS; not there:$missing"
    finish
fi
version=$(sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' include/starcontour.h | paste -sd. -)
case $version in
0.*) soname=${version%.*} ;;
*) soname=${version%%.*} ;;
esac

# ------------------------------------------------------------------------------------------------
# SDKs

stand_ins=$scratch/stand_ins
stand_in_sdk() {
    mkdir -p "$1/usr/lib" && cp -R tests/packages/libc "$1/usr/include" &&
        cat >"$1/usr/lib/libSystem.tbd" <<'EOC' && cp "$1/usr/lib/libSystem.tbd" "$1/usr/lib/libm.tbd"
--- !tapi-tbd
tbd-version: 4
targets: [ x86_64-macos, arm64-macos ]
install-name: '/usr/lib/libSystem.B.dylib'
exports:
  - targets: [ x86_64-macos, arm64-macos ]
    symbols: [ _bzero, _memchr, _memcmp, _memcpy, _memmove, _memset, ___bzero, _strlen, _malloc, _free,
               _clock_gettime, _vsnprintf, _atan2, _frexp, _ldexp, _floor, _ceil, _fmin, _fmax,
               dyld_stub_binder, _memset_pattern16, ___stack_chk_fail, ___stack_chk_guard, ____chkstk_darwin ]
...
EOC
}
# zig_sdk FOLDER: that of zig, if there is one.
zig_sdk() {
    from=$(zig env 2>/dev/null || python3 -m ziglang env 2>/dev/null) || return 1
    from=$(printf '%s\n' "$from" | sed -n 's/^.*lib_dir"*[:= ]*"\(.*\)".*$/\1/p' | head -n 1)/libc
    headers=$from/include/any-macos-any
    [ -d "$headers" ] || headers=$from/include/any-darwin-any # of newer ones
    [ -e "$from/darwin/libSystem.tbd" ] && mkdir -p "$1/usr/lib" &&
        ln -s "$headers" "$1/usr/include" &&
        cp "$from/darwin/libSystem.tbd" "$1/usr/lib" && cp "$from/darwin/libSystem.tbd" "$1/usr/lib/libm.tbd"
}
# can_be_used FOLDER: whether the clang and the linker that are here read it.
can_be_used() {
    for machine in arm64 x86_64; do
        printf '#include <math.h>\nint main(int n, char **v)\n{\n    return (int)ldexp(n, !v);\n}\n' |
            clang "--target=$machine-apple-macos11" -isysroot "$1" -fuse-ld=lld -x c - -o "$scratch/main" \
                >"$scratch/main.log" 2>&1 || return 1
    done
}
if [ -n "$given" ]; then
    sdk=$given
elif zig_sdk "$scratch/zig" && can_be_used "$scratch/zig"; then
    sdk=$scratch/zig
else
    without="no SDK was given, and there is no zig"
    [ ! -e "$scratch/zig" ] || without="clang does not read those of this zig"
    check "stand-ins for an SDK" stand_in_sdk "$stand_ins"
    sdk=$stand_ins
    skip "macOS's own headers, tests and a user: $without"
fi

# ------------------------------------------------------------------------------------------------
# For each processor

# Of clang's run-time library for macOS, which Debian does not have: where __builtin_cpu_supports
# looks.
echo '__attribute__((visibility("hidden"))) struct { unsigned kind[3], features[1]; } __cpu_model;' \
    >"$scratch/cpu_model.c"
mkdir "$scratch/bin"
printf '#!/bin/sh\necho Darwin\n' >"$scratch/bin/uname"
chmod +x "$scratch/bin/uname"

# build GOAL...: by the Makefile, as it is on macOS
build() {
    for goal; do
        set -- "$@" "$at/$goal"
        shift
    done
    PATH=$scratch/bin:$PATH "$MAKE" --no-print-directory "-j$jobs" BUILD="$at" WERROR=1 config=release \
        CC="$compiler" AR="$(tool llvm-ar)" CPPFLAGS= CFLAGS=-Wno-pass-failed LDFLAGS=-fuse-ld=lld \
        LDLIBS="$at/cpu_model.o" "$@"
}
exports() {
    sed 's/^/_/' tests/abi/symbols.txt >"$scratch/symbols"
    "$(tool llvm-nm)" -g --defined-only "$dylib" | sed -n 's/^[0-9a-f]* [TDSBC] //p' | sort |
        diff "$scratch/symbols" -
}
# In the static library, what is not exported is hidden (private external).
hidden() {
    "$(tool llvm-nm)" -m --defined-only "$at/lib/libstarcontour.a" >"$scratch/names" 2>/dev/null &&
        grep -q ' private external _sc_' "$scratch/names" &&
        sed -n '/ private external /d; s/^.*) external //p' "$scratch/names" | sort | diff "$scratch/symbols" -
}
named() {
    "$(tool llvm-objdump)" --macho --dylib-id "$dylib" | tail -n 1 |
        grep -x "/usr/local/lib/libstarcontour.$soname.dylib"
}
alone() {
    "$(tool llvm-objdump)" --macho --dylibs-used "$dylib" | sed -n 's/^.*\t\(.*\) (.*$/\1/p' |
        grep -v libstarcontour | sort -u >"$scratch/used"
    echo /usr/lib/libSystem.B.dylib | diff - "$scratch/used"
}
one_file() {
    "$MAKE" --no-print-directory amalgamation BUILD="$at" &&
        $compiler -std=c99 -ffp-contract=off -O0 -Wall -Wextra -Werror -Wno-pass-failed \
            -c "$at/amalgamation/starcontour.c" -o "$at/one.o" &&
        "$(tool llvm-nm)" -g --defined-only "$at/one.o" | sed -n 's/^.* T //p' | sort |
        comm -13 - "$scratch/symbols" | { ! grep .; }
}
support() {
    # shellcheck disable=SC2086
    build $(printf 'release/obj/%s\n' $portable_support $(printf 'tests/test_%s.c ' $portable_tests) |
        sed 's/c$/o/') && (cd "$at/release/obj" && "$(tool llvm-ar)" rcs "$at/support.a" \
        $(printf '%s\n' $portable_support | sed 's/c$/o/'))
}
link() {
    program=$1
    shift
    $compiler -fuse-ld=lld "$@" "$at/cpu_model.o" "$at/lib/libstarcontour_metis.a" \
        "$at/lib/libstarcontour.a" -o "$at/$program"
}

for machine in arm64 x86_64; do
    at=$scratch/$machine
    compiler="clang --target=$machine-apple-macos11 -isysroot $sdk"
    mkdir "$at"
    check "$machine: clang makes objects" $compiler -c "$scratch/cpu_model.c" -o "$at/cpu_model.o"
    dylib=$at/lib/libstarcontour.$version.dylib
    check "$machine: make builds the libraries" build lib/libstarcontour.a lib/libstarcontour.dylib \
        lib/libstarcontour_metis.a
    [ -e "$dylib" ] || continue
    check "$machine: the shared library exports what it should" exports
    check "$machine: what else is in the static library is hidden" hidden
    check "$machine: the shared library has its name" named
    check "$machine: it needs libSystem alone" alone
    layouts_hold "$machine: " $compiler -std=c11 -Wall -Wextra -Werror -fsyntax-only -Iinclude
    check "$machine: the amalgamation" one_file
    [ "$sdk" != "$stand_ins" ] || continue
    check "$machine: a user links" link consumer -std=c99 -Iinclude tests/packages/consumer.c
    check "$machine: tests compile" support
    for test in $portable_tests; do
        check "$machine: test_$test links" link "test_$test" "$at/release/obj/tests/test_$test.o" "$at/support.a"
    done
done
skip "nothing built for macOS was run"
finish
