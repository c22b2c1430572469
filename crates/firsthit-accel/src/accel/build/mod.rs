//! The builders: a binary tree, and the trees that are made from it.

pub(super) mod binary;
mod binned_sah;
mod collapse;
mod fill;
mod lowest;
mod mesh;
mod morton;
mod objects;
mod quick;
mod refit;
mod reinsert;
mod weld;
