#!/bin/sh
# Makes the package for npm, packs it, or makes the page with it. The Makefile calls it, which
# compiles build/wasm/starcontour.wasm before.
#
#     tools/npm/make_package.sh package VERSION   build/wasm/package
#     tools/npm/make_package.sh pack              build/wasm/starcontour-VERSION.tgz; needs npm
#     tools/npm/make_package.sh page              build/wasm/page.html; needs node and npm, and
#                                                 fetches what tools/page/package-lock.json names
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
page)
    command -v npm >/dev/null 2>&1 || { echo "make wasm-page needs node and npm" >&2; exit 1; }
    tools/page/build.sh --install
    modules=${BUILD:-build}/page
    cp "$here/page"/*.js tools/page/view.js "$package"/*.js "$modules"
    (cd "$modules" && node_modules/.bin/esbuild cloth.js --bundle --minify --format=esm \
        --target=es2022 --legal-comments=none --log-level=warning --outfile=cloth_bundle.js)
    {
        sed '/^\/\* SCRIPT \*\/$/,$d' "$here/page/cloth.html"
        printf '/*! Uses three.js:\n'
        cat "$modules/node_modules/three/LICENSE"
        printf '*/\n'
        cat "$modules/cloth_bundle.js"
        sed '1,/^\/\* SCRIPT \*\/$/d' "$here/page/cloth.html"
    } >"$work/page.html"
    ls "$work/page.html"
    ;;
esac
