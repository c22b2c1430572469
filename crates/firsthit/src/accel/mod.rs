//! Which of many things may a ray meet? [`Bvh`] sees boxes, never shapes; [`MeshTree`] sees triangles.
//!
//! Float32 only ever rules out; the shapes' own float64 tests decide. So the answer depends neither on the tree
//! nor on the instruction set, and brute force leads to the same bits.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod beam;
mod bins;
mod build;
mod bvh;
mod distant;
mod filter;
mod frame;
mod goal;
mod masked;
mod mesh_tree;
mod meshlet;
mod packet;
mod ray;
mod refit;
mod search;
mod sharing;
mod sides;
mod tile;
mod verdict;
mod visit;
mod waiting;
mod walk;
mod wave;
mod wide;

pub use crate::simd::InstructionSet;
pub use bvh::Bvh;
pub(crate) use bvh::{Walk, WalkStack};
pub(crate) use frame::{Bundle, Frame};
pub(crate) use goal::{Any, First, Question, Settling};
pub use mesh_tree::MeshTree;
pub(crate) use packet::{Packet, RAYS, turned};
pub(crate) use search::{Answers, Search, Searcher};
pub(crate) use tile::{Arbiter, BLOCK, TILE, Tile, Winner, fill, pixel, place};
pub(crate) use verdict::{Common, Corners, InLanes, Pencil, verdict};
pub(crate) use walk::{END, Scratch, ask, each};
