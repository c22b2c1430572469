//! Acceleration structures: [`Bvh`] is a tree over boxes, [`MeshTree`] one over the triangles of a
//! mesh.
//!
//! Float32 only rules out; the float64 tests of `shape` decide. So the answer depends neither on the tree nor on the
//! instruction set, and brute force leads to the same bits.
//!
//! | folder | job |
//! |---|---|
//! | `build/` | makes trees |
//! | `rays/` | makes rays ready for a tree |
//! | `traverse/` | rays through trees: one, many, many alike |
//! | `tile/` | a camera's tile through a tree |

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod bounds;
mod build;
mod bvh;
mod edges;
mod eight_crossings;
mod eight_pairs;
mod extent;
mod filter;
mod mesh_tree;
mod meshlet;
mod nearby;
mod node;
mod overlap;
mod rays;
mod space;
mod stored;
mod tile;
mod traverse;

pub use crate::simd::InstructionSet;
pub use bvh::Bvh;
pub(crate) use bvh::{Walk, WalkStack};
pub(crate) use eight_crossings::{Corners, RayBundle, SharedTriangle, eight_crossings};
pub use mesh_tree::MeshTree;
pub(crate) use meshlet::Meshlet;
pub(crate) use nearby::Nearby;
pub(crate) use node::Node;
pub(crate) use rays::enter::product_along;
pub(crate) use rays::packet::{Packet, RAYS};
pub(crate) use rays::trees::{TreePerRay, Trees};
pub(crate) use stored::{TreeFacts, TreeParts};
pub(crate) use tile::frustum::{TileCamera, TileFrustum};
pub(crate) use tile::traverse::{TileScratch, fill_buffer};
pub(crate) use tile::visibility::{
    BLOCK, Displacements, ExactTest, TILE, TriangleId, VisibilityBuffer, block_and_lane,
    row_and_column,
};
pub(crate) use traverse::all::{All, CrossingList};
pub(crate) use traverse::any::Any;
pub(crate) use traverse::count::Count;
pub(crate) use traverse::dispatch::Dispatcher;
pub(crate) use traverse::each::{END, EachCandidate};
pub(crate) use traverse::filtered::FilteredQuery;
pub(crate) use traverse::first::First;
pub(crate) use traverse::mesh_packet::{FEWEST, IsAfter, MeshPacket, SettleExactly};
pub(crate) use traverse::nearest::each_near;
pub(crate) use traverse::query::{MeshQuery, Sink};
pub(crate) use traverse::single::{Scratch, query_mesh, query_mesh_filtered};
