#!/bin/sh
# Puts two crates together: starcontour-sys, the library as one C file with its declarations in
# Rust, and starcontour, the safe wrapper. Both are made of tests/ffi/rust, which is tested against
# the shared library as well; so there is one binding.
#
#     tools/packaging/rust/make_crates.sh FOLDER       from the top of the repository
#
# FOLDER is a workspace of both: there `cargo package --workspace` works with cargo 1.90 or newer,
# as should `cargo publish --workspace`. An older one has to publish the first before it can pack
# the second.
#
# SPDX-License-Identifier: MIT
set -eu
export LC_ALL=C

here=tools/packaging/rust
binding=tests/ffi/rust/src
folder=$1
sys=$folder/starcontour-sys
safe=$folder/starcontour
rm -rf "$sys" "$safe"
mkdir -p "$sys/core" "$sys/src" "$safe/src" "$safe/tests"

cat >"$folder/Cargo.toml" <<'END'
[workspace]
members = ["starcontour-sys", "starcontour"]
resolver = "2"
END
cp $here/starcontour-sys.toml "$sys/Cargo.toml"
cp $here/compile.rs "$sys/build.rs"
awk -f tools/amalgamate.awk lib/sources.list >"$sys/core/starcontour.c"
cp include/starcontour.h "$sys/core"
cp $binding/raw.rs "$sys/src/lib.rs"
cat >"$sys/README.md" <<'END'
# starcontour-sys

The C library starcontour, which finds every self-collision of a deforming triangle mesh, compiled
along (a C compiler is needed, nothing else), and its declarations in Rust: those that the crate
`starcontour`, a safe wrapper, needs. `core/starcontour.h` is the manual. Dependent build scripts
get the header's folder as `DEP_STARCONTOUR_INCLUDE`.
END

cp $here/starcontour.toml "$safe/Cargo.toml"
cp $binding/lib.rs $binding/scene.rs "$safe/src"
cat >>"$safe/src/lib.rs" <<'END'

// The example of README.md is a test, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
END
cat >"$safe/src/raw.rs" <<'END'
//! starcontour.h as Rust sees it.
//!
//! SPDX-License-Identifier: MIT

pub use starcontour_sys::*;
END
cp $here/wound_sheet.rs "$safe/tests"
cp $here/README.md "$safe/README.md"
cp LICENSE "$sys"
cp LICENSE "$safe"
ls -d "$sys" "$safe"
