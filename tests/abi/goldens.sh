#!/bin/sh
# Writes what callers were compiled against, as text, into FOLDER:
#
#     tests/abi/goldens.sh FOLDER LIBRARY [INCLUDE]      from the top of the repository
#
#     symbols.txt                  what the shared library LIBRARY exports
#     interface_64.txt, _32.txt    structures, enumerators and calls of the public headers (INCLUDE, else
#                                  include), for pointers of so many bits: CC's own, and 32 if CC
#                                  can (-m32)
#
# `make abi-update` writes the goldens in tests/abi/, to be reviewed as a diff; tests/test_abi.sh
# compares with them. tests/abi/grown.awk says which differences break callers.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

CC=${CC:-cc}
folder=$1
library=$2
include=${3:-include}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM

nm -D --defined-only "$library" >"$scratch/nm" || exit 1
# Without section symbols, and without the version that nm may append.
awk '$2 != "A" { sub(/@.*/, "", $NF); print $NF }' "$scratch/nm" | sort >"$folder/symbols.txt"

awk -f tests/abi/interface.awk "$include/starcontour.h" "$include/starcontour_metis.h" \
    >"$scratch/interface.c" || exit 1
echo 'int main(void) { return sizeof(void *) == 4 ? 32 : 64; }' >"$scratch/bits.c"
for option in '' -m32; do
    # shellcheck disable=SC2086
    if ! $CC $option "$scratch/bits.c" -o "$scratch/bits" 2>/dev/null; then
        [ -n "$option" ] && continue
        echo "goldens.sh: $CC does not compile" >&2
        exit 1
    fi
    "$scratch/bits"
    bits=$?
    # Where programs of 32 bits are compiled but do not run.
    if [ "$bits" -ne 32 ] && [ "$bits" -ne 64 ]; then
        [ -n "$option" ] && continue
        exit 1
    fi
    # shellcheck disable=SC2086
    $CC -std=c99 $option -I"$include" "$scratch/interface.c" -o "$scratch/interface" || exit 1
    "$scratch/interface" >"$folder/interface_$bits.txt" || exit 1
done
