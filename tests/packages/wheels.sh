#!/bin/sh
# `make wheels`: a wheel with a manylinux tag and a source distribution that builds without a
# network. Each is installed into a virtual environment of its own, and finds what the library finds
# in C. Needs Python 3 with venv and numpy, and a network for setuptools and auditwheel.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

for python in ${PYTHON:-python3 /usr/bin/python3} none; do
    "$python" -c 'import ensurepip, numpy, venv' >/dev/null 2>&1 && break
done
if [ "$python" = none ]; then
    skip "wheels: no Python 3 with venv and numpy"
    finish
fi
unset MAKEFLAGS MFLAGS MAKELEVEL
version=$(sed -n 's/^#define SC_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' include/starcontour.h |
    paste -sd. -)
# Kept between runs: the tools take longer to fetch than the wheel to build.
wheels=${SC_WHEELS:-$PWD/build/wheels}

if ! "$MAKE" --no-print-directory wheels PYTHON="$python" BUILD="${wheels%/wheels}" >"$scratch/log" 2>&1 &&
    grep -q -i -e 'no matching distribution' -e 'connection' "$scratch/log"; then
    skip "wheels: the tools that make them cannot be fetched"
    finish
fi
check "make wheels" sh -c 'tail -n 2 "$1" | grep -q "\.whl$" || { cat "$1"; exit 1; }' - "$scratch/log"
wheel=$(echo "$wheels"/starcontour-"$version"-*.whl)
check "there is one wheel, and it is there" test -f "$wheel"
check "one for every Python 3" sh -c 'case ${1##*/} in *-py3-none-*) ;; *) exit 1 ;; esac' - "$wheel"
[ "$(uname)" != Linux ] ||
    check "with a manylinux tag" sh -c 'case $1 in *manylinux*) ;; *) exit 1 ;; esac' - "$wheel"
sources=$wheels/starcontour-$version.tar.gz
check "there is a source distribution" test -f "$sources"

# installs NAME FILE: into a new environment that sees numpy of this Python; without a network.
installs() {
    "$python" -m venv --system-site-packages "$scratch/$1" &&
        "$scratch/$1/bin/python" -m pip install --quiet --disable-pip-version-check --no-index \
            --no-deps --force-reinstall "$2"
}
# finds PYTHON: the same pairs as consumer.c.
finds() {
    (cd "$scratch" && env -u PYTHONPATH -u STARCONTOUR_LIBRARY "$1" "$OLDPWD/tests/packages/try_wheel.py" \
        "$version") >"$scratch/printed" && cksum <"$scratch/printed" | cmp - tests/packages/consumer.cksum
}
check "the wheel installs" installs wheel "$wheel"
check "and finds the same pairs" finds "$scratch/wheel/bin/python"

# The source distribution, where there is setuptools and neither this repository nor a network.
offline() {
    mkdir "$scratch/apart" "$scratch/built" && cp "$sources" "$scratch/apart" && cd "$scratch/apart" &&
        unshare="" && { unshare -rn true 2>/dev/null && unshare='unshare -rn'; true; } &&
        $unshare "$wheels/venv/bin/python" -m pip wheel --quiet --no-index --no-deps --no-build-isolation \
            --wheel-dir "$scratch/built" "starcontour-$version.tar.gz"
    status=$?
    cd "$OLDPWD" && return $status
}
check "the source distribution builds offline" offline
check "its wheel installs" installs sources "$(echo "$scratch"/built/*.whl)"
check "and finds the same pairs" finds "$scratch/sources/bin/python"

finish
