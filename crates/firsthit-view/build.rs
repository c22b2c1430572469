//! Tells whether `make wasm` has put the WebAssembly module beside the sources. Without it the crate does all but reports and files that are
//! dropped on the page.

use std::path::Path;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(has_module)");
    // The folder is in git: cargo would compile anew each time where it is not there.
    println!("cargo::rerun-if-changed=module");
    if Path::new("module/firsthit.wasm.gz").exists() {
        println!("cargo::rustc-cfg=has_module");
    }
}
