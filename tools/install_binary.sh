#!/bin/sh
# Strips an installed library or program. Its debug symbols go into a file of their own, in the
# folder .debug beside it, where gdb and others look for it by the link that stays in the stripped
# file.
#
#     tools/install_binary.sh FILE       OBJCOPY: the program for it, from the environment [objcopy]
#
# A static library only loses its debug symbols: they are in the one that was built. Where there is
# no objcopy (OBJCOPY=''), or it cannot read the file (on macOS), the file stays as it is.
#
# SPDX-License-Identifier: MIT
set -u

file=$1
objcopy=${OBJCOPY-objcopy}
command -v "${objcopy:-/}" >/dev/null 2>&1 || exit 0

folder=$(dirname "$file")/.debug
symbols=$folder/$(basename "$file").debug
stripped=$file.stripped
trap 'rm -f "$stripped"' EXIT
trap 'exit 1' HUP INT TERM

case $file in
*.a)
    "$objcopy" --strip-debug "$file" "$stripped" 2>/dev/null || exit 0
    ;;
*)
    mkdir -p "$folder" || exit 1
    if ! { "$objcopy" --only-keep-debug "$file" "$symbols" && chmod 644 "$symbols" &&
        "$objcopy" --strip-unneeded --add-gnu-debuglink="$symbols" "$file" "$stripped"; } 2>/dev/null; then
        rm -f "$symbols"
        rmdir "$folder" 2>/dev/null
        exit 0
    fi
    ;;
esac
# Written over, so that mode and owner stay.
cat "$stripped" >"$file"
