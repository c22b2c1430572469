//! The glossary of the error bounds: the words, the constants, and the tests that fail without
//! them.
//!
//! Float32 may rule out a box or a triangle, or call a triangle certain, only where no rounding
//! could make that wrong. So every number that decides has a bound for its error. A kernel derives
//! its bounds under `# Error bounds` at the end of its head: sums of roundings, in multiples of
//! [`U`]. The constants here are those sums, rounded up for the terms of higher orders. All are for
//! the space of a tree, which is in the cube from -1 to 1.
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | depth | a length along the axis on which the ray's direction is longest; in a tile along the camera's axis |
//! | reach | a number that no coordinate of the tree differs from the ray's start by more than; at least 1 |
//! | blur | the error of a ray that does not shrink near its start: float64's rounding, and that of inexact vertices |
//! | margin | the distance that a box or a plane is moved outwards |
//! | side | twice the area of the triangle between the ray and an edge; its sign says where the ray passes the edge |
//! | bound | the largest error of a side |
//! | error | the largest error of any other number |
//! | slack | the largest error of a depth; in the top-level tree, rounding as a share of coordinates |
//!
//! # Tests
//!
//! A bound that is too small loses a hit, or takes a miss for one. `tests/it/kernels` compares
//! every kernel with brute force, bit by bit, and a test in `filter.rs` compares that with the
//! exact test. "Too small" names the tests that fail when the constant is multiplied by 3/4, 1/2,
//! 1/4, 1/10 or 0, and the largest such factor. The bounds are for the worst case, which random
//! rays hardly come near: mostly it is 0. Where no test fails, others make up for the constant, or
//! only its derivation stands for it.
//!
//! # Bounds elsewhere
//!
//! - `Bvh::OBJECTS`, the slack of the top-level tree (`bvh.rs`). Too small: no test, not even at 0.
//! - `BOX_ROUNDING`, by which boxes of the top-level tree and rays are wider, and `BALL`,
//!   the ball around them (`bvh.rs`).
//! - The bound of the exact test's sides (`shape/triangle.rs`). Too small: `fans_over_edges` and
//!   `rays_from_very_far_away`, among others, at 0.
//! - `Plain::error`, where float64 is enough for `t` (`shape/triangle/place/plain.rs`). Too small:
//!   `fans_over_edges` and `cameras_on_soups`, among others, from three quarters down.
//! - `SURE`, where twice the digits are (`shape/triangle/place/double.rs`). Too small:
//!   `short_rays_from_neighbours` and `soups_of_every_scale_and_place`, among others, at 0.
//! - `SHARE`, of rays in twice the digits (`traverse/distant.rs`). Too small: no test, not even at
//!   0.
//! - The pad of a triangle's bounding box in a tile (`tile/raster.rs`). Too small: no test, not
//!   even at 0.
//! - 4 errors of a depth: the triangles of a leaf that begins nearer have no bounding boxes in a
//!   tile (`tile/raster.rs`). Too small: not tried.
//! - The size of coordinates across a ray, for the error of a side: 2.1 times their error in
//!   `filter.rs`, 4.2 times and 1.01 times the extent in `traverse/frustum_leaf.rs`. Too small: not
//!   tried.
//! - `OFF`, how far a ray's start is off the point that it leaves (`shape/triangle/departure.rs`).
//!   Too small: not tried.
//! - `ROUNDED`, how far a point of a surface is off it after transforms (`shoot/filter.rs`). It is
//!   a promise to users, not a bound.
//! - The sphere around the tree, `BALL`, and 4 errors: what a ray from far away must meet
//!   (`traverse/distant.rs`). Too small: not tried.

/// The unit of float32's rounding, 2^-24: half of `f32::EPSILON`.
pub(super) const U: f32 = f32::EPSILON / 2.0;

// Distances of a ray's start from the tree's origin, along an axis. Neither can be too small: a
// start that is nearer than it could be is only moved for nothing.

/// A start that is farther away than this is moved towards the tree in float64. So the reach is 9
/// at most.
///
/// Used in `rays/prepare.rs` and `traverse/masked.rs`. Too large: the assertions there and at
/// [`BOX_MARGIN`] fail to compile.
pub(super) const FAR: f64 = 8.0;

/// A start that is farther away than this is moved in twice the digits. Up to here the last digit
/// of a float64 is less than the last of a float32 at 1.
///
/// Used in `rays/prepare.rs` and `space.rs`.
pub(super) const DISTANT: f64 = (1_u64 << 27) as f64;

// Every ray.

/// The rounding of float64 when it makes a ray ready, as a share of the coordinates: a ray's blur.
/// Where float32 does not hold the vertices, `U` is added, and is mostly larger.
///
/// Used in `rays/prepare.rs` and `tile/frustum.rs`. Too small: no test, not even at 0.
pub(super) const BLUR: f64 = 1e-15;

/// The number of blurs in the error of a sheared coordinate, and in that of a depth.
///
/// Used in `filter.rs`, `rays/limits.rs` and `traverse/frustum.rs`. Too small:
/// `starts_far_apart_just_above_small_triangles` and `soups_of_every_scale_and_place`, at 0.
pub(super) const BLURS: f32 = 3.0;

/// The margin of a box for a single ray, as a share of the reach; two blurs come to it.
///
/// Used in `rays/prepare.rs`. Too small: `fans_over_edges` and `short_rays_from_neighbours`, among
/// others, at 0.
pub(super) const BOX: f32 = 12.0 * U;

/// The largest distance from a box of a ray that the box lets through, beside its blurs: [`BOX`]
/// and the rounding of the test, at the largest reach.
///
/// Used in `filter.rs`. Too small: no test, not even at 0.
pub(super) const BOX_MARGIN: f32 = 150.0 * U;
const _: () = assert!((BOX + 2.0 * U) as f64 * (FAR + 1.0) < BOX_MARGIN as f64);

/// The error of a sheared coordinate of a vertex, as a share of its depth and of the triangle's
/// extent.
///
/// Used in `filter.rs`. Too small: `small_triangles_of_a_large_mesh` and
/// `soups_of_every_scale_and_place`, at 0.
pub(super) const VERTEX: f32 = 6.5 * U;

/// The extent of a triangle across a ray, as a multiple of its extent along an axis: at most twice,
/// but for rounding.
///
/// Used in `filter.rs`. Too small: `fans_over_edges` and `points_are_not_met`, among others, at 0.
pub(super) const EXTENT_ACROSS: f32 = 2.02;

/// The error of a side by that of its coordinates, as a multiple of that and of their size.
///
/// Used in `filter.rs` and `traverse/frustum_leaf.rs`. Too small: `fans_over_edges` and
/// `soups_of_every_scale_and_place`, among others, at 0.
pub(super) const SIDE_BY_ERROR: f32 = 4.3;

/// The error of a side by its own rounding, as a multiple of the square of its coordinates' size.
///
/// Used in `filter.rs` and `traverse/frustum_leaf.rs`. Too small: no test, not even at 0.
pub(super) const SIDE_BY_SIZE: f32 = 9.2 * U;

/// The error of the depth between a triangle's corners, as a multiple of the bound of a side (in
/// `filter.rs`: of the error of its coordinates and their size), times the spread of the corners'
/// depths over the sum of the sides.
///
/// Used in `filter.rs`, `traverse/frustum_leaf.rs` and `tile/edge_test.rs`. Too small: no test, not
/// even at 0.
pub(super) const MEAN: f32 = 2.1;

/// The error of a mean depth by the sides' own rounding, as a multiple of the square of their
/// coordinates' size.
///
/// Used in `filter.rs`. Too small: no test, not even at 0.
pub(super) const MEAN_BY_SIZE: f32 = 9.0 * U;

/// The error of a corner's depth, as a share of that; of the depths of `t_min` and `t_max`, as a
/// share of the reach.
///
/// Used in `filter.rs`, `rays/limits.rs`, `traverse/frustum.rs` and `traverse/frustum_leaf.rs`.
/// Too small: `the_filter_agrees_with_the_exact_test`, at 0.
pub(super) const DEPTH: f32 = 24.0 * U;

/// The error of a depth that is rounded from float64, as a share of it.
///
/// Used in `rays/limits.rs` and `tile/raster.rs`. Too small: `fans_over_edges` and
/// `rays_from_very_far_away`, among others, at 0.
pub(super) const ROUNDED_DEPTH: f32 = 4.0 * U;

// The nearest point.

/// The error of the distance to a box or a triangle, as a share of the largest coordinate of the
/// point plus 1, for the vertices.
///
/// Used in `traverse/nearest.rs`. Too small: `soups_of_every_scale_and_place` and
/// `trees_with_levels` of `tests/it/nearest`, among others, at 0, with [`NEAR_SQUARED`] at 0 too.
pub(super) const NEAR: f32 = 10.0 * U;

/// The error of the square of a distance, as a share of it.
///
/// Used in `traverse/nearest.rs`. Too small: not tried alone.
pub(super) const NEAR_SQUARED: f32 = 16.0 * U;

/// The square of the shortest direction that is trusted: below, products leave float32. No bound:
/// any larger number is safe.
///
/// Used in `traverse/nearest.rs`.
pub(super) const NEAR_LEAST: f32 = 1e-30;

/// The largest coordinate with a float32 test: beyond, every triangle is asked, so that the squares
/// of squares stay in float32. No bound: any smaller number is safe.
///
/// Used in `traverse/nearest.rs`.
pub(super) const NEAR_FARTHEST: f64 = (1_u64 << 30) as f64;

// The frustum of a packet.

/// The margin of the planes around a packet, as a share of the reach; four blurs come to it.
///
/// Used in `traverse/frustum.rs`. Too small: `a_grid_looked_at_through_its_corners`, at 0.
pub(super) const PACKET_PLANES: f32 = 40.0 * U;

/// The margin of the two planes along the packet's normal, as a multiple of that of the others.
///
/// Used in `traverse/frustum.rs`. Too small: no test, not even at 0.
pub(super) const PACKET_NORMAL: f32 = 4.0;

/// The opening of the two planes along the packet's normal for a depth of 1.
///
/// Used in `traverse/frustum.rs`. Too small: no test, not even at 0.
pub(super) const PACKET_SPREAD: f32 = 16.0 * U;

/// The error of where a ray is at the packet's depth 0, as a share of how far it is from the
/// packet's reference.
///
/// Used in `traverse/frustum.rs`. Too small: no test, not even at 0.
pub(super) const PACKET_START: f32 = 20.0 * U;

/// The error of a sheared coordinate of a vertex, as a share of its depth; [`PACKET_START`] and
/// [`PACKET_EXTENT`] come to it.
///
/// Used in `traverse/frustum_leaf.rs`. Too small: `small_triangles_of_a_large_mesh`, at 0.
pub(super) const PACKET_VERTEX: f32 = 5.5 * U;

/// The error of a sheared coordinate of a vertex, as a share of the triangle's extent.
///
/// Used in `traverse/frustum_leaf.rs`. Too small: no test, not even at 0.
pub(super) const PACKET_EXTENT: f32 = 3.5 * U;

// The box around the segments of a packet.

/// The margin of that box, as a share of the largest depth of a ray in a tree.
///
/// Used in `traverse/masked.rs`. Too small: no test, not even at 0.
pub(super) const SEGMENT: f32 = 16.0 * U;

// The frustum of a tile. X and Y are in pixels, Z is the depth; see `tile/frustum.rs`.

/// The error of a sheared coordinate of a vertex, as a share of the leaf's extent.
///
/// Used in `tile/frustum.rs`. Too small: `small_triangles_of_a_large_mesh`, at 0.
pub(super) const TILE_VERTEX: f64 = 7.2 * U as f64;

/// The error of X and Y of a vertex, as a share of Z (of parallel rays in pixels), times the
/// skewness of the pixels.
///
/// Used in `tile/frustum.rs`. Too small: `triangles_smaller_than_a_pixel`, at 0.
pub(super) const TILE_PIXEL: f64 = 51.0 * U as f64;

/// The error of Z, as a share of the reach.
///
/// Used in `tile/frustum.rs`. Too small: no test, not even at 0.
pub(super) const TILE_DEPTH: f64 = 60.0 * U as f64;

/// The error of Z, as a share of the depth by which the start of parallel rays was moved.
///
/// Used in `tile/frustum.rs`. Too small: `arrays_of_a_cameras_rays`, at 0.
pub(super) const TILE_MOVED: f64 = 16.0 * U as f64;

/// The part of the error of Z that moves a vertex on the picture, as a share of the reach.
///
/// Used in `tile/frustum.rs`. Too small: no test, not even at 0.
pub(super) const TILE_SIDEWAYS: f64 = 16.0 * U as f64;

/// The pixels from the tile's middle for which a side allows that error of Z; a sample is at most
/// 8.5 from there. For each unit of the pixels' skewness [`TILE_LEVER_BY_SKEWNESS`] comes to it.
///
/// Used in `tile/frustum.rs`. Too small: not tried.
pub(super) const TILE_LEVER: f64 = 12.0;

/// The multiples of [`TILE_PIXEL`] of the largest Z that the lever's error of Z covers.
///
/// Used in `tile/frustum.rs`. Too small: not tried.
pub(super) const TILE_LEVER_BY_SKEWNESS: f64 = 7.0;

/// As [`TILE_LEVER`], for the planes around a tile; they are 7.52 pixels from its middle.
///
/// Used in `tile/frustum.rs`. Too small: not tried.
pub(super) const TILE_LEVER_OF_PLANES: f64 = 8.0;

/// As [`TILE_LEVER`], for the question whether a tile is too blurred. No bound: any number is safe.
///
/// Used in `tile/frustum.rs`.
pub(super) const TILE_LEVER_OF_WIDTH: f64 = 16.0;

/// The stand-in for [`TILE_VERTEX`] where no leaf is at hand, as a share of a coordinate of 1.
///
/// Used in `tile/frustum.rs`. Too small: not tried.
pub(super) const TILE_ANY_VERTEX: f64 = 4.0 * U as f64;

/// The margin of the planes around a tile, as a share of the reach; the error of X and Y comes to
/// it.
///
/// Used in `tile/frustum.rs`. Too small: no test, not even at 0.
pub(super) const TILE_PLANES: f64 = 8.0 * U as f64;

/// The error of a side by that of X and Y, as a multiple of that and of the triangle's size.
///
/// Used in `tile/frustum.rs`. Too small: `arrays_of_a_cameras_rays` and
/// `triangles_smaller_than_a_pixel`, among others, at 0.
pub(super) const TILE_SIDE_BY_ERROR: f64 = 2.15;

/// The error of a side by rounding, as a multiple of the square of the triangle's size: this, and
/// for each unit of the matrix' skew [`TILE_SIDE_BY_SKEW`].
///
/// Used in `tile/frustum.rs`. Too small: no test, not even at 0.
pub(super) const TILE_SIDE_BY_SIZE: f64 = 8.0 * U as f64;

/// See [`TILE_SIDE_BY_SIZE`].
///
/// Used in `tile/frustum.rs`. Too small: no test, not even at 0.
pub(super) const TILE_SIDE_BY_SKEW: f64 = 12.0 * U as f64;
