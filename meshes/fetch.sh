#!/bin/sh
# Gets real meshes into build/meshes, without root: the models of Debian's glmark2-data and the
# meshes in the data archive of libcgal-demo, as they are, and the former subdivided. With --models
# also, in build/meshes/models, all models of glmark2-data and of assimp-testmodels, some of them
# damaged on purpose. What is there already is kept; remove build/meshes to start again.
#
# SPDX-License-Identifier: MIT
#
# Usage: meshes/fetch.sh [--models] [FOLDER [SUBDIVIDE]]   default: build/meshes build/bin/subdivide
# Exit status: 0 all is there, 1 something could not be had (the rest is still done).
set -u

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
models=no
if [ "${1:-}" = --models ]; then
    models=yes
    shift
fi
folder=${1:-$root/build/meshes}
subdivide=${2:-$root/build/bin/subdivide}
status=0

complain() {
    echo "fetch.sh: $*" >&2
    status=1
}

# get_package NAME: downloads a Debian package and unpacks it into $work/NAME.
get_package() {
    if ! command -v apt-get >/dev/null || ! command -v dpkg >/dev/null; then
        complain "$1: needs apt-get and dpkg (Debian, Ubuntu); see meshes/README.md for other systems"
        return 1
    fi
    echo "downloading $1"
    sandbox=
    if [ "$(id -u)" -eq 0 ]; then sandbox='-o APT::Sandbox::User=root'; fi
    # shellcheck disable=SC2086
    if ! (cd "$work" && apt-get -q $sandbox download "$1") >"$work/log" 2>&1; then
        sed 's/^/    /' "$work/log" >&2
        complain "$1 cannot be downloaded; 'apt-get update' (as root) may help"
        return 1
    fi
    mkdir "$work/$1"
    if ! dpkg -x "$work/$1"_*.deb "$work/$1"; then
        complain "$1 cannot be unpacked"
        return 1
    fi
}

# make_fine NAME FILE TIMES: NAME_x4.ply, NAME_x16.ply, ...: FILE with each triangle cut in four.
make_fine() {
    factor=1
    times=1
    while [ "$times" -le "$3" ]; do
        factor=$((factor * 4))
        fine=$folder/$1_x$factor.ply
        if [ ! -f "$fine" ]; then
            echo "making $fine"
            # The format is known by the ending, so the unfinished file has it too.
            if "$subdivide" "$folder/$2" "$times" "$work/fine.ply"; then
                mv "$work/fine.ply" "$fine"
            else
                complain "$fine cannot be made"
            fi
        fi
        times=$((times + 1))
    done
}

mkdir -p "$folder" || exit 1
work=$(mktemp -d "$folder/.fetch.XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

if [ ! -f "$folder/cat.3ds" ] || [ ! -f "$folder/horse.3ds" ] || [ ! -f "$folder/bunny.obj" ]; then
    if get_package glmark2-data; then
        for name in cat.3ds horse.3ds bunny.obj; do
            if ! cp "$work/glmark2-data/usr/share/glmark2/models/$name" "$folder/"; then
                complain "$name is not in glmark2-data"
            fi
        done
    fi
fi

if [ ! -d "$folder/cgal" ]; then
    if get_package libcgal-demo; then
        archive=$(find "$work/libcgal-demo" -name data.tar.gz | head -n 1)
        if [ -n "$archive" ] && tar -xzf "$archive" -C "$work" && [ -d "$work/data/meshes" ]; then
            mv "$work/data/meshes" "$folder/cgal"
        else
            complain "libcgal-demo has no archive of meshes"
        fi
    fi
fi

# get_models PACKAGE FOLDER: the folder of models in a package becomes models/PACKAGE.
get_models() {
    if [ -d "$folder/models/$1" ]; then return; fi
    # It may have been unpacked above.
    if [ ! -d "$work/$1" ]; then get_package "$1" || return; fi
    if ! { mkdir -p "$folder/models" && cp -R "$work/$1/$2" "$work/models" &&
        mv "$work/models" "$folder/models/$1"; }; then
        complain "$1: there is no folder $2, or it cannot be copied"
    fi
}
if [ "$models" = yes ]; then
    get_models glmark2-data usr/share/glmark2/models
    get_models assimp-testmodels usr/share/assimp/models
fi

if [ ! -x "$subdivide" ]; then
    complain "no subdivided meshes: $subdivide is not built"
else
    if [ -f "$folder/cat.3ds" ]; then make_fine cat cat.3ds 3; fi
    if [ -f "$folder/horse.3ds" ]; then make_fine horse horse.3ds 3; fi
    if [ -f "$folder/bunny.obj" ]; then make_fine bunny bunny.obj 1; fi
fi

if [ "$status" -eq 0 ]; then echo "meshes are in $folder"; fi
exit "$status"
