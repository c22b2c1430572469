//! Sets `cfg(unoptimised)` at opt-level 0. There every inlined function keeps its own stack slots,
//! so that kernels have frames of more than a megabyte; see `simd/stack.rs`.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(unoptimised)");
    if std::env::var_os("OPT_LEVEL").is_some_and(|level| level == "0") {
        println!("cargo::rustc-cfg=unoptimised");
    }
}
