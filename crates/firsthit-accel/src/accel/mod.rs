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
pub use mesh_tree::MeshTree;
#[doc(hidden)]
pub use {
    bvh::WalkStack,
    eight_crossings::{Corners, RayBundle, SharedTriangle, eight_crossings},
    meshlet::Meshlet,
    nearby::Nearby,
    node::Node,
    packet_walk::PacketWalk,
    rays::enter::product_along,
    rays::packet::{Packet, RAYS, WorldRays, lowest},
    rays::trees::{TreePerRay, Trees},
    stored::{TreeFacts, TreeParts},
    tile::frustum::{TileCamera, TileFrustum},
    tile::traverse::{TileScratch, fill_buffer},
    tile::visibility::{
        BLOCK, Displacements, ExactTest, TILE, TriangleId, VisibilityBuffer, block_and_lane,
        row_and_column,
    },
    traverse::all::{All, CrossingList},
    traverse::any::Any,
    traverse::count::Count,
    traverse::dispatch::{Traversal, TraversalMemory},
    traverse::each::{END, EachCandidate},
    traverse::filtered::FilteredQuery,
    traverse::first::First,
    traverse::mesh_packet::{FEWEST, IsAfter, MeshPacket, SettleExactly},
    traverse::nearest::each_near,
    traverse::query::{MeshQuery, Sink},
    traverse::single::{Scratch, query_mesh, query_mesh_filtered},
    walks::Walks,
};
