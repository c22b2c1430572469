//! Rays made ready for trees.

pub(super) mod limits;
pub(super) mod packet;
pub(super) mod tree_ray;
