//! glTF and GLB: what comes out against numbers by hand, against what other programs packed, and against attacks.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::disallowed_methods,
    reason = "a test may panic, its numbers are small, and the last bit of a sine decides nothing here"
)]

mod builder;
mod geometry;
mod hostile;
mod looks;
mod materials;
mod memory;
mod names;
mod packed;
mod scene;
