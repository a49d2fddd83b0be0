#!/bin/sh
# Calls the shared library from other languages: builds and runs the programs beside this file.
#
#     tests/ffi/ffi.sh LIBRARY_FOLDER WORK_FOLDER [LANGUAGE...]       default: all languages
#
# Each program is run on meshes/crossing_cloths.obj with the pairs and contours it should find and
# the structures as a C compiler lays them out; then with some of them changed, which it has to
# notice. What misses its toolchain is skipped and counted as that. The last line is the sum: "N
# passed, N failed, N skipped". Exit status 1 if anything failed or nothing ran. CC, CXX, PYTHON:
# what to use for these.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

top=$(cd "$(dirname "$0")/../.." && pwd)
SC_LIB=$(cd "$1" && pwd) || exit 1
mkdir -p "$2" && work=$(cd "$2" && pwd) || exit 1
shift 2
languages=$*
cd "$top" || exit 1
export SC_LIB

CC=${CC:-cc}
CXX=${CXX:-g++}
here=$top/tests/ffi
mesh=$top/meshes/crossing_cloths.obj
header=$top/include/starcontour.h
library=$SC_LIB/libstarcontour.so
[ -e "$library" ] || library=$SC_LIB/libstarcontour.dylib
export LD_LIBRARY_PATH="$SC_LIB${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
export DYLD_LIBRARY_PATH="$SC_LIB${DYLD_LIBRARY_PATH:+:$DYLD_LIBRARY_PATH}"
export PYTHONDONTWRITEBYTECODE=1

log=$work/log
passed=0
failed=0
skipped=0

fail() {
    failed=$((failed + 1))
    sed 's/^/    /' "$log"
    echo "$1"
}

skip() {
    skipped=$((skipped + 1))
    echo "$1: skipped: needs $2 ('make deps-ffi')"
}

wanted() {
    [ -z "$languages" ] && return 0
    for language in $languages; do
        [ "$language" = "$1" ] && return 0
    done
    return 1
}

# has PROGRAM...: whether all are there; $missing is the first that is not.
has() {
    for missing; do
        command -v "$missing" >/dev/null 2>&1 || return 1
    done
}

# build NAME COMMAND...: a step before the program's run.
build() {
    build_name=$1
    shift
    "$@" >"$log" 2>&1 && return
    fail "$build_name: does not build"
    return 1
}

# run NAME COMMAND...: a program, given MESH, GOLDEN and LAYOUT at the end. Its last line must be
# "...: N passed, N failed" and its exit status fit it; and it must fail on the damaged pairs and,
# but for LÖVE, which has none, contours.
run() {
    name=$1
    shift
    "$@" "$mesh" "$here/golden.txt" "$work/layout.txt" >"$log" 2>&1
    status=$?
    sums=$(tail -n 1 "$log" | sed -n 's/^.*: \([0-9][0-9]*\) passed, \([0-9][0-9]*\) failed$/\1 \2/p')
    if [ -z "$sums" ]; then
        fail "$name: crashed or gave up (exit status $status)"
        return
    fi
    passed=$((passed + ${sums% *}))
    failed=$((failed + ${sums#* }))
    if [ "$status" -ne 0 ] || [ "${sums#* }" -ne 0 ]; then
        [ "$status" -ne 0 ] && [ "${sums#* }" -ne 0 ] || failed=$((failed + 1))
        cat "$log"
        echo "$name: ${sums% *} passed, ${sums#* } failed (exit status $status)"
        return
    fi
    if "$@" "$mesh" "$work/damaged.txt" "$work/layout.txt" >"$log" 2>&1 ||
        ! grep -q '^failed: pairs' "$log" ||
        { [ "$name" != love ] && ! grep -q '^failed: contours at rest' "$log"; }; then
        fail "$name: does not notice wrong pairs or contours"
    else
        passed=$((passed + 1))
        echo "$name: $((${sums% *} + 1)) passed, 0 failed"
    fi
    return 0
}

# ------------------------------------------------------------------------------------------------
# What all programs are given.

# Structures, members and enumerators as a C compiler has them, a line each:
#     struct NAME BYTES
#     member STRUCT NAME OFFSET BYTES
#     value NAME NUMBER
awk -f tests/abi/interface.awk "$header" >"$work/interface.c" &&
    $CC -std=c99 -Iinclude -o "$work/interface" "$work/interface.c" ||
    { echo "the interface cannot be listed" >&2; exit 1; }
"$work/interface" | sed -n -e 's/^struct \([a-z_0-9]*\): \([0-9]*\) bytes.*/struct \1 \2/p' \
    -e 's/^\(sc_[a-z_0-9]*\)\.\([a-z_0-9]*\): at \([0-9]*\), \([0-9]*\) bytes.*/member \1 \2 \3 \4/p' \
    -e 's/^\(SC_[A-Z_0-9]*\) = \(.*\)/value \1 \2/p' >"$work/layout.txt"
sed 's/^\([a-z]* [0-9]*\)5 /\16 /' "$here/golden.txt" >"$work/damaged.txt"

if [ -x "$SC_LIB/../bin/sc-query" ]; then
    if SC_BIN=$SC_LIB/../bin "$here/golden.sh" >"$work/golden.txt" &&
        diff "$here/golden.txt" "$work/golden.txt" >"$log"; then
        passed=$((passed + 1))
    else
        fail "golden.txt: not what sc-query finds"
    fi
else
    skip golden.txt sc-query
fi

# ------------------------------------------------------------------------------------------------
# The languages.

if wanted cxx; then
    if has "${CXX%% *}"; then
        # shellcheck disable=SC2086
        build "c++17" $CXX -std=c++17 -O2 -Wall -Wextra -Wpedantic -Wshadow -Wold-style-cast \
            -Wconversion -Werror -Iinclude -I"$here/cxx" -o "$work/ffi_cxx" "$here/cxx/ffi_cxx.cpp" -L"$SC_LIB" \
            -lstarcontour -pthread && run "c++17" "$work/ffi_cxx"
    else
        skip "c++17" "$missing"
    fi
fi

# python_with MODULE...: sets $python to one that has these.
python_with() {
    for python in ${PYTHON:-python3 /usr/bin/python3}; do
        "$python" -c "import $1" >/dev/null 2>&1 && return
    done
    return 1
}

# A wheel from SOURCE, installed in a folder of its own. The source tree stays as it was.
from_source() {
    rm -rf "$work/site"
    find tools/python lib include | sort >"$work/before"
    "$python" -m pip install --quiet --disable-pip-version-check --no-index --no-deps \
        --no-build-isolation --root-user-action=ignore --target "$work/site" "$1" &&
        find tools/python lib include | sort | diff "$work/before" -
}

distribution() {
    rm -rf "$work/sdist"
    (cd tools/python && "$python" -c "import sys, setuptools.build_meta as b; b.build_sdist(sys.argv[1])" \
        "$work/sdist") && mv "$work"/sdist/starcontour-*.tar.gz "$work/sdist/starcontour.tar.gz"
}

# The example of tools/python/README.md prints what is said there.
readme() {
    awk '/^```python$/ { inside = 1; next } /^```$/ { inside = 0 } inside' tools/python/README.md \
        >"$work/readme.py"
    awk '/^```text$/ { inside = 1; next } /^```$/ { inside = 0 } inside' tools/python/README.md \
        >"$work/readme.txt"
    test -s "$work/readme.txt" &&
        PYTHONPATH=$work/site "$python" "$work/readme.py" | diff "$work/readme.txt" - &&
        passed=$((passed + 1))
}

if wanted python; then
    if python_with numpy; then
        run python env PYTHONPATH="$top/tools/python" STARCONTOUR_LIBRARY="$library" \
            "$python" "$here/python/ffi_python.py"
    else
        skip python "Python 3 with numpy"
    fi
    # setuptools makes wheels since 70.1, before that with the help of wheel.
    if python_with "setuptools.command.bdist_wheel, pip, numpy" ||
        python_with "setuptools, wheel, pip, numpy"; then
        build "python, pip install ./tools/python" from_source ./tools/python &&
            run "python, pip install ./tools/python" env PYTHONPATH="$work/site" \
                "$python" "$here/python/ffi_python.py" && build "tools/python/README.md" readme
        build "python, source distribution" distribution &&
            build "python, source distribution" from_source "$work/sdist/starcontour.tar.gz" &&
            run "python, source distribution" env PYTHONPATH="$work/site" \
                "$python" "$here/python/ffi_python.py"
    else
        skip "python, pip install ./tools/python" "Python 3 with numpy, pip, setuptools and wheel"
        skip "python, source distribution" "the same"
    fi
fi

if wanted luajit; then
    if has luajit; then
        run luajit luajit "$here/luajit/ffi_luajit.lua" "$header" "$library"
    else
        skip luajit luajit
    fi
fi

if wanted love; then
    if has love timeout; then
        run love env -u DISPLAY -u WAYLAND_DISPLAY timeout 120 love "$here/love" "$here/luajit" \
            "$header" "$library"
    else
        skip love "$missing"
    fi
fi

if wanted csharp; then
    if has mcs mono; then
        build "c#" mcs -unsafe -optimize -warnaserror -out:"$work/ffi_csharp.exe" \
            "$here/csharp/Starcontour.cs" "$here/csharp/FfiCsharp.cs" &&
            run "c#" mono "$work/ffi_csharp.exe"
    else
        skip "c#" "$missing"
    fi
fi

if wanted rust; then
    if has cargo rustc; then
        rust() {
            (cd "$here/rust" && RUSTFLAGS="-D warnings" cargo build --quiet --offline --locked \
                --release --target-dir "$work/rust")
        }
        build rust rust && run rust "$work/rust/release/ffi_rust"
    else
        skip rust "$missing"
    fi
fi

if wanted go; then
    if has go; then
        go_build() {
            (cd "$here/go" && CC=$CC GOFLAGS=-buildvcs=false GOPROXY=off GOTOOLCHAIN=local \
                CGO_ENABLED=1 GOCACHE="$work/go-cache" CGO_CFLAGS="-O2 -I$top/include" \
                CGO_LDFLAGS="-L$SC_LIB" go build -o "$work/ffi_go" .)
        }
        build go go_build && run go "$work/ffi_go"
    else
        skip go "$missing"
    fi
fi

if wanted java; then
    jna=${JNA:-/usr/share/java/jna.jar}
    if ! has javac java; then
        skip java "$missing"
    elif [ ! -e "$jna" ]; then
        skip java "JNA ($jna)"
    else
        build java javac -Xlint:all,-serial -Werror -cp "$jna" -d "$work/java" \
            "$here/java/FfiJava.java" &&
            run java java -cp "$jna:$work/java" -Djna.library.path="$SC_LIB" FfiJava
    fi
fi

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
