#!/bin/sh
# starcontour.batch by numpy, Dask and Ray Data, workers of which are killed in the middle.
#
#     tests/batch/python.sh [FOLDER]      a virtual environment, build/batch/venv
#
# Python packages that are missing are installed into that environment by pip (ray[data],
# dask[distributed], some 500 MB); what cannot be installed is skipped.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

venv=${1:-build/batch/venv}
library=$(cd "$SC_LIB" && pwd)/libstarcontour.so
[ -e "$library" ] || library=$(cd "$SC_LIB" && pwd)/libstarcontour.dylib
PYTHONPATH=$(pwd)/tools/python:$(pwd)/tests/batch
export PYTHONPATH STARCONTOUR_LIBRARY="$library" PYTHONDONTWRITEBYTECODE=1
export RAY_USAGE_STATS_ENABLED=0 RAY_DEDUP_LOGS=0

[ -x "$venv/bin/python" ] || python3 -m venv "$venv" >"$scratch/venv.log" 2>&1 || rm -rf "$venv"
# engine NAME MODULE PACKAGE
engine() {
    if ! "$venv/bin/python" -c "import $2" >/dev/null 2>&1; then
        "$venv/bin/python" -m pip install --quiet --disable-pip-version-check numpy "$3" \
            >"$scratch/pip.log" 2>&1
    fi
    if ! "$venv/bin/python" -c "import $2" >/dev/null 2>&1; then
        skip "batches by $1: no virtual environment with $3 could be made"
        return
    fi
    mkdir -p "$scratch/$1"
    check "batches by $1" timeout 300 "$venv/bin/python" tests/batch/batches.py "$1" "$scratch/$1"
}
engine numpy numpy numpy
engine dask distributed "dask[distributed]"
engine ray ray.data "ray[data]"
finish
