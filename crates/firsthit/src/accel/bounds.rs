//! The glossary of the error bounds: what float32 may be off, in the space of a tree.
//!
//! Float32 may rule out a box or a triangle, or call a triangle certain, only where no rounding could make that wrong.
//! So every number that decides has a bound for its error. This file has the words and the constants; where a constant
//! comes from is derived under `# Error bounds` in the file that uses it. All bounds are first-order sums of roundings,
//! each constant rounded up to cover the terms of higher orders.
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | depth | a length along the axis on which the ray's direction is longest; in a tile, along its camera's axis |
//! | reach | the most by which a coordinate of the tree and one of the ray's start differ; at least 1 |
//! | blur | the part of a ray's error that does not shrink near its start: float64's rounding, and that of inexact vertices |
//! | margin | how far a box or a plane is moved outwards |
//! | bound | what a side of an edge may be off |
//! | error | what any other number may be off |
//! | slack | what a depth may be off; of the top-level tree, rounding as a share of coordinates |
//! | side | twice the area of the triangle between the ray and an edge; its sign tells on which side of the edge the ray passes |
//!
//! # Tests
//!
//! A bound that is too small loses a hit or takes a miss for one. `tests/kernels` compares every kernel with brute
//! force, bit by bit. The last line of each constant says which of its tests fails when the constant is made smaller,
//! and from which factor on. Where it names none, the tests do not come near the worst case; the derivation alone
//! stands for it.
//!
//! # Bounds elsewhere
//!
//! | bound | where |
//! |---|---|
//! | `Bvh::OBJECTS`, the slack of the top-level tree | `bvh.rs` |
//! | the exact test: `doubt`, `Plain::error`, `SURE` | `shape/triangle.rs`, `shape/triangle/place/` |
//! | `SHARE`, of rays in twice the digits | `traverse/distant.rs` |

/// The unit of float32's rounding, 2^-24: half of `f32::EPSILON`.
pub(super) const U: f32 = f32::EPSILON / 2.0;

// Distances. The tree is in the cube from -1 to 1.

/// A ray's start that is farther away than this, along an axis, is moved towards the tree in float64. So the reach is 9
/// at most.
///
/// Used in `rays/prepare.rs`.
pub(super) const FAR: f64 = 8.0;

/// A ray's start that is farther away than this is moved in twice the digits: up to here, the last digit of a float64
/// is less than the last of a float32 at 1.
///
/// Used in `rays/prepare.rs` and `space.rs`.
pub(super) const DISTANT: f64 = (1_u64 << 27) as f64;

// Every ray.

/// What float64 rounds when it makes a ray ready, as a share of the coordinates: the largest part of a ray's blur.
///
/// Used in `rays/prepare.rs`.
pub(super) const BLUR: f64 = 1e-15;

/// How many blurs a sheared coordinate or a depth may be off.
///
/// Used in `filter.rs`, `rays/limits.rs` and `traverse/frustum.rs`.
pub(super) const BLURS: f32 = 3.0;

/// How far a box is moved outwards for a single ray, as a share of the reach; beside two blurs.
///
/// Used in `rays/prepare.rs`.
pub(super) const BOX: f32 = 12.0 * U;

/// How far from a box a ray may pass that the box lets through, beside its blurs: [`BOX`] and the rounding of the test,
/// at the largest reach.
///
/// Used in `filter.rs`.
pub(super) const BOX_MARGIN: f32 = 150.0 * U;
const _: () = assert!((BOX + 2.0 * U) as f64 * (FAR + 1.0) < BOX_MARGIN as f64);

/// What a sheared coordinate of a vertex may be off, as a share of its depth and of the triangle's extent.
///
/// Used in `filter.rs`.
pub(super) const VERTEX: f32 = 6.5 * U;

/// How far a triangle extends across a ray, as a multiple of its extent along an axis: at most twice, but for rounding.
///
/// Used in `filter.rs`.
pub(super) const EXTENT_ACROSS: f32 = 2.02;

/// What a side may be off, as a multiple of what its coordinates may be off, times their size.
///
/// Used in `filter.rs` and `traverse/frustum_leaf.rs`.
pub(super) const SIDE_BY_ERROR: f32 = 4.3;

/// What a side may be off by its own rounding, as a multiple of the square of its coordinates.
///
/// Used in `filter.rs` and `traverse/frustum_leaf.rs`.
pub(super) const SIDE_BY_SIZE: f32 = 9.2 * U;

/// What the depth between a triangle's corners may be off, as a multiple of what a side may be off (in `filter.rs`: of
/// what its coordinates may), times the spread of the corners' depths over the sum of the sides.
///
/// Used in `filter.rs`, `traverse/frustum_leaf.rs` and `tile/edge_test.rs`.
pub(super) const MEAN: f32 = 2.1;

/// The same by the sides' own rounding.
///
/// Used in `filter.rs`.
pub(super) const MEAN_BY_SIZE: f32 = 9.0 * U;

/// What a corner's depth may be off, as a share of it; of `t_min` and `t_max`, as a share of the reach.
///
/// Used in `filter.rs`, `rays/limits.rs`, `traverse/frustum.rs` and `traverse/frustum_leaf.rs`.
pub(super) const DEPTH: f32 = 24.0 * U;

/// What a depth that float64 knows may be off in float32, as a share of it.
///
/// Used in `rays/limits.rs` and `tile/raster.rs`.
pub(super) const ROUNDED_DEPTH: f32 = 4.0 * U;

// The frustum of a packet.

/// How far the planes around a packet are moved outwards, as a share of the reach; beside four blurs.
///
/// Used in `traverse/frustum.rs`.
pub(super) const PACKET_PLANES: f32 = 40.0 * U;

/// How far the two planes along the packet's normal are moved outwards, as a multiple of the margin of the others.
///
/// Used in `traverse/frustum.rs`.
pub(super) const PACKET_NORMAL: f32 = 4.0;

/// By how much more those planes open towards the depth.
///
/// Used in `traverse/frustum.rs`.
pub(super) const PACKET_SPREAD: f32 = 16.0 * U;

/// What a ray's start may be off, as a share of how far starts are apart.
///
/// Used in `traverse/frustum.rs`.
pub(super) const PACKET_START: f32 = 20.0 * U;

/// What a sheared coordinate of a vertex may be off, as a share of its depth; beside [`PACKET_START`].
///
/// Used in `traverse/frustum_leaf.rs`.
pub(super) const PACKET_VERTEX: f32 = 5.5 * U;

/// The same as a share of the triangle's extent.
///
/// Used in `traverse/frustum_leaf.rs`.
pub(super) const PACKET_EXTENT: f32 = 3.5 * U;

// The box around the segments of a packet.

/// How far that box is moved outwards, as a share of the largest depth of a ray in a tree.
///
/// Used in `traverse/masked.rs`.
pub(super) const SEGMENT: f32 = 16.0 * U;

// The frustum of a tile. X and Y are in pixels, Z is the depth; see `tile/frustum.rs`.

/// What a sheared coordinate of a vertex may be off, as a share of the leaf's extent.
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_VERTEX: f64 = 7.2 * U as f64;

/// What X and Y of a vertex may be off, as a share of Z (of parallel rays, in pixels), times the skewness of the
/// pixels.
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_PIXEL: f64 = 45.0 * U as f64;

/// What Z may be off, as a share of the reach.
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_DEPTH: f64 = 60.0 * U as f64;

/// The same as a share of the depth that the start of parallel rays was moved by.
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_MOVED: f64 = 16.0 * U as f64;

/// The part of a vertex' wrong depth that moves it on the picture, as a share of the reach.
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_SIDEWAYS: f64 = 16.0 * U as f64;

/// How far the planes around a tile are moved outwards, as a share of the reach; beside what X and Y may be off.
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_PLANES: f64 = 8.0 * U as f64;

/// What a side may be off, as a multiple of what X and Y may be off, times the size of the triangle.
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_SIDE_BY_ERROR: f64 = 2.15;

/// What a side may be off by rounding, as a multiple of the square of the triangle's size: this, and for each unit that
/// the matrix is skew, [`TILE_SIDE_BY_SKEW`].
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_SIDE_BY_SIZE: f64 = 8.0 * U as f64;

/// See [`TILE_SIDE_BY_SIZE`].
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_SIDE_BY_SKEW: f64 = 12.0 * U as f64;
