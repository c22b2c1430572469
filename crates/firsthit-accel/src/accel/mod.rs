//! Acceleration structures: [`Bvh`] is a tree over boxes, [`MeshTree`] one over the triangles of a
//! mesh.
//!
//! Float32 only rules out; the float64 tests of `shape` decide. So the answer depends neither on
//! the tree nor on the instruction set, and brute force leads to the same bits.
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
mod packet_walk;
mod rays;
mod space;
mod stored;
mod tile;
mod traverse;
mod walks;

pub use crate::simd::InstructionSet;
pub use bvh::Bvh;
#[doc(hidden)]
pub use bvh::WalkStack;
#[doc(hidden)]
pub use eight_crossings::{Corners, RayBundle, SharedTriangle, eight_crossings};
pub use mesh_tree::MeshTree;
#[doc(hidden)]
pub use meshlet::Meshlet;
#[doc(hidden)]
pub use nearby::Nearby;
#[doc(hidden)]
pub use node::Node;
#[doc(hidden)]
pub use packet_walk::PacketWalk;
#[doc(hidden)]
pub use rays::enter::product_along;
#[doc(hidden)]
pub use rays::packet::{Packet, RAYS, WorldRays};
#[doc(hidden)]
pub use rays::trees::{TreePerRay, Trees};
#[doc(hidden)]
pub use stored::{TreeFacts, TreeParts};
#[doc(hidden)]
pub use tile::frustum::{TileCamera, TileFrustum};
#[doc(hidden)]
pub use tile::traverse::{TileScratch, fill_buffer};
#[doc(hidden)]
pub use tile::visibility::{
    BLOCK, Displacements, ExactTest, TILE, TriangleId, VisibilityBuffer, block_and_lane,
    row_and_column,
};
#[doc(hidden)]
pub use traverse::all::{All, CrossingList};
#[doc(hidden)]
pub use traverse::any::Any;
#[doc(hidden)]
pub use traverse::count::Count;
#[doc(hidden)]
pub use traverse::dispatch::{Traversal, TraversalMemory};
#[doc(hidden)]
pub use traverse::each::{END, EachCandidate};
#[doc(hidden)]
pub use traverse::filtered::FilteredQuery;
#[doc(hidden)]
pub use traverse::first::First;
#[doc(hidden)]
pub use traverse::mesh_packet::{FEWEST, IsAfter, MeshPacket, SettleExactly};
#[doc(hidden)]
pub use traverse::nearest::each_near;
#[doc(hidden)]
pub use traverse::query::{MeshQuery, Sink};
#[doc(hidden)]
pub use traverse::single::{Scratch, query_mesh, query_mesh_filtered};
#[doc(hidden)]
pub use walks::Walks;
