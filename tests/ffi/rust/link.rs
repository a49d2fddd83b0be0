//! Links with the shared library, looked for in the folder that SC_LIB names.
//!
//! SPDX-License-Identifier: MIT

fn main() {
    println!("cargo:rerun-if-env-changed=SC_LIB");
    if let Ok(folder) = std::env::var("SC_LIB") {
        println!("cargo:rustc-link-search=native={folder}");
    }
    println!("cargo:rustc-link-lib=dylib=starcontour");
}
