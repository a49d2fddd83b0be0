//! Compiles the library, which is one C file.
//!
//! SPDX-License-Identifier: MIT

fn main() {
    println!("cargo:rerun-if-changed=core");
    let mut build = cc::Build::new();
    build.file("core/starcontour.c").include("core").define("NDEBUG", None);
    // Whatever the profile: slow queries help nobody to debug Rust.
    build.opt_level(3);
    if build.get_compiler().is_like_msvc() {
        build.flag("/fp:precise");
    } else {
        // The exact predicates and the error bounds count every rounding.
        build.std("c99").flag("-ffp-contract=off").flag("-fno-fast-math");
    }
    build.compile("starcontour");
    // Elsewhere it is part of the C library, which Rust links anyway.
    if std::env::var("CARGO_CFG_TARGET_FAMILY").as_deref() == Ok("unix") {
        println!("cargo:rustc-link-lib=m");
    }
    let folder = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it");
    println!("cargo:include={folder}/core");
}
