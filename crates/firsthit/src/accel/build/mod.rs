//! Trees: the binary builder, and what it is used for.

mod binary;
mod binned_sah;
mod collapse;
mod fill;
mod mesh;
mod objects;
mod refit;
mod weld;
