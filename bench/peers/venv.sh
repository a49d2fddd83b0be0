#!/bin/sh
# Sees to it that a package from PyPI is there, in a virtual environment of its own.
#
#     bench/peers/venv.sh DIRECTORY PACKAGE CSV
#
# Versions stand in requirements.txt, or in the file VERSIONS; only wheels are taken. If the package
# cannot be had, that is said, also in the CSV file (see skip.sh), and the exit status is 3.
#
# SPDX-License-Identifier: MIT
set -u

venv=$1
package=$2
csv=$3
here=${0%/*}
versions=${VERSIONS:-$here/requirements.txt}
log=$venv.log

skip() {
    "$here/skip.sh" "$csv" "$package" "$1"
    exit 3
}

command -v python3 >/dev/null 2>&1 || skip "there is no python3 ('make deps with=peers')"
if [ ! -x "$venv/bin/pip" ]; then
    mkdir -p "${venv%/*}"
    python3 -m venv "$venv" >"$log" 2>&1 || skip "python3 -m venv failed, see $log ('make deps with=peers')"
fi
"$venv/bin/python" -c 'import importlib.metadata, sys; importlib.metadata.version(sys.argv[1])' \
    "$package" 2>/dev/null && exit 0
echo "installing $package into $venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check --only-binary :all: -c "$versions" \
    "$package" >"$log" 2>&1 || skip "$(grep -m 1 ERROR "$log" || echo "pip failed, see $log")"
