//! Rays through trees.

pub(super) mod all;
pub(super) mod any;
mod coherent;
pub(super) mod count;
mod deferred;
pub(super) mod dispatch;
mod distant;
pub(super) mod each;
pub(super) mod filtered;
pub(super) mod first;
mod frustum;
mod frustum_leaf;
mod interleaved;
mod masked;
pub(super) mod mesh_packet;
pub(super) mod nearest;
pub(super) mod query;
pub(super) mod single;
pub(super) mod stack;
