#!/bin/sh
# The crates starcontour-sys and starcontour, as tools/packaging/rust puts them together: their
# tests and those in their documents pass, the pairs are those that the library finds in C, and
# `cargo package` packs both and builds what it packed. Needs cargo, and a network for the crate cc.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

PATH=$PATH:$HOME/.cargo/bin
if ! command -v cargo >/dev/null 2>&1; then
    skip "crates: no cargo"
    finish
fi
# Cargo would take make's pipes for a job server of its own, and cc does not know what cc is.
unset CC MAKEFLAGS MFLAGS MAKELEVEL
top=$PWD
export CARGO_TARGET_DIR="$scratch/target" RUSTFLAGS='-D warnings' SC_PRINTED="$scratch/printed"

check "two crates are put together" tools/packaging/rust/make_crates.sh "$scratch/crates"
cd "$scratch/crates" || exit 1
if ! cargo fetch --quiet >"$scratch/log" 2>&1; then
    skip "crates: the crate cc cannot be fetched"
    finish
fi
check "their tests pass" cargo test --quiet
same_pairs() {
    cksum <"$scratch/printed" | cmp - "$top/tests/packages/consumer.cksum"
}
check "the pairs are those of C" same_pairs

# Versions of cargo before 1.90 cannot pack a crate that needs another which is not in the index.
minor=$(cargo --version | sed -n 's/^cargo 1\.\([0-9]*\)\..*/\1/p')
if [ "${minor:-0}" -ge 90 ]; then
    check "cargo package packs both, and builds what it packed" \
        cargo package --workspace --quiet --allow-dirty
    packed=starcontour
else
    check "cargo package packs starcontour-sys, and builds what it packed" \
        cargo package --package starcontour-sys --quiet --allow-dirty
    skip "cargo package of starcontour: cargo is older than 1.90"
    packed=
fi
# What is in a crate: no more than 10 MB, which the index takes, and the license.
fits() {
    file=$(echo "$CARGO_TARGET_DIR"/package/"$1"-[0-9]*.crate)
    test "$(wc -c <"$file")" -lt 10000000 && tar -tzf "$file" | grep '/LICENSE$' &&
        tar -tzf "$file" | grep "/$2\$"
}
check "starcontour-sys holds the library" fits starcontour-sys core/starcontour.c
[ -z "$packed" ] || check "starcontour holds the wrapper" fits starcontour src/scene.rs

cd "$top" || exit 1
finish
