//! The builders: a binary tree, and the trees that are made from it.

pub(super) mod binary;
mod binned_sah;
mod collapse;
mod fill;
mod mesh;
mod objects;
mod refit;
mod weld;
