#!/bin/sh
# Builds tools/page/page.html, which sc-query carries inside: template.html with main.js, what it
# imports of this folder, and what they use of three.js as one script, behind the license of three.js.
#
#     tools/page/build.sh [FILE]      from the top of the repository; needs node and npm
#     tools/page/build.sh --install   only fetches what package-lock.json names, for this and tests
#
# What npm fetches goes to build/page. The same sources and versions give the same bytes.
#
# SPDX-License-Identifier: MIT
set -eu

here=tools/page
work=${BUILD:-build}/page
mkdir -p "$work"
cp "$here/package.json" "$here/package-lock.json" "$work"
if ! cmp -s "$here/package-lock.json" "$work/installed"; then
    (cd "$work" && npm ci --no-audit --no-fund --loglevel=error)
    cp "$here/package-lock.json" "$work/installed"
fi
[ "${1:-}" != --install ] || exit 0

cp "$here"/*.js "$work"
(cd "$work" && node_modules/.bin/esbuild main.js --bundle --minify --format=iife --target=es2020 \
    --legal-comments=none --log-level=warning --outfile=bundle.js)
{
    sed '/^\/\* SCRIPT \*\/$/,$d' "$here/template.html"
    printf '/*! Uses three.js:\n'
    cat "$work/node_modules/three/LICENSE"
    printf '*/\n'
    cat "$work/bundle.js"
    sed '1,/^\/\* SCRIPT \*\/$/d' "$here/template.html"
} >"$work/page.html"
cp "$work/page.html" "${1:-$here/page.html}"
