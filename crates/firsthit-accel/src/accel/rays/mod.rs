//! Rays made ready for trees.

pub(super) mod enter;
pub(super) mod limits;
pub(super) mod packet;
pub(super) mod prepare;
mod root;
pub(super) mod slabs;
pub(super) mod tree_ray;
pub(super) mod trees;
