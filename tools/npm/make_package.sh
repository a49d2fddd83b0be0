#!/bin/sh
# Makes the package for npm, or packs it. The Makefile calls it, which
# compiles build/wasm/starcontour.wasm before.
#
#     tools/npm/make_package.sh package VERSION   build/wasm/package
#     tools/npm/make_package.sh pack              build/wasm/starcontour-VERSION.tgz; needs npm
#
# SPDX-License-Identifier: MIT
set -eu

here=tools/npm
work=${BUILD:-build}/wasm
package=$work/package

case $1 in
package)
    rm -rf "$package"
    mkdir -p "$package"
    cp "$here/index.js" "$here/index.d.ts" "$here/README.md" LICENSE "$package"
    # Inside a module, so that no bundler, server or folder has to find a file.
    {
        printf "export default '"
        base64 <"$work/starcontour.wasm" | tr -d '\n'
        printf "';\n"
    } >"$package/starcontour.wasm.js"
    # Last, as its time is that of the package.
    sed -e "s|@version@|$2|" "$here/package.json.in" >"$package/package.json"
    ;;
pack)
    command -v npm >/dev/null 2>&1 || { echo "make wasm-pack needs npm" >&2; exit 1; }
    (cd "$package" && npm pack --silent --pack-destination ..) >/dev/null
    ls "$work"/*.tgz
    ;;
esac
