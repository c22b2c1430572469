//! glTF and GLB: what comes out against numbers by hand, against what other programs packed, and
//! against attacks.
#![allow(clippy::disallowed_methods, reason = "the last bit of a sine decides nothing here")]

mod builder;
mod geometry;
mod hostile;
mod looks;
mod materials;
mod memory;
mod names;
mod packed;
mod scene;
