//! The triangles of a mesh that may be nearest to a point.
//!
//! 1. Bring the point into the tree's space, and the square of the largest distance that still
//!    matters: the limit.
//! 2. At a node, compute the squares of the distances to its sixteen boxes at once. Go on with the
//!    nearest, and put the others onto the stack, in order.
//! 3. At a leaf, compute a lower bound of the distance to each of its sixteen triangles at once:
//!    find about where the nearest point is, and how far the triangle is at least along the way
//!    there.
//! 4. Show the triangles that may be within the limit to the caller, the nearest first, who
//!    computes their distances in float64 and lowers the limit.
//! 5. Take the next from the stack that is within the limit.
//!
//! Roussopoulos, Kelley and Vincent, "Nearest Neighbor Queries", SIGMOD 1995. It departs in the
//! leaves: a distance in float32 can be too large, but the extent of a triangle along any direction
//! is a lower bound, however that direction was found.
//!
//! # Error bounds
//!
//! In units of `U` (see `bounds.rs`), in the space of the tree. R is the largest coordinate of the
//! point plus 1, which is for the vertices. All errors are lengths, and make the limit larger
//! (`NEAR`, `NEAR_SQUARED`); boxes and triangles are compared as they come out.
//!
//! - **A coordinate** of a vertex relative to the point is off by 2 R: the point's own rounding,
//!   the vertex', and that of the difference.
//! - **A box** is therefore nearer by at most 3.5 R than it seems: the errors along three axes
//!   together.
//! - **A product** of a direction of length 1 with a vertex is off by 5.2 R of its own rounding, as
//!   the sum of the products' sizes is at most 1.8 R, and by 3.5 R with the vertex'. In all 8.7 R;
//!   `NEAR` is 10 R.
//! - **Squares** and their sums are off by 6 units of themselves; `NEAR_SQUARED` is 16.
//!
//! Float64's errors are lengths too, in the space of the mesh, and go the same way:
//!
//! - The point, taken to the mesh by a transform, is off by 6 times the transform's rounding, times
//!   the coordinates that it is made from. A corner, taken to the world and rounded there, is off
//!   by as much as 2 times that rounding of the mesh's own coordinates. The limit has room for 8 of
//!   each.
//! - The distance is off by less than 2^-40 of itself.
//!
//! The map from the world to the mesh stretches lengths by at most its largest singular value,
//! whose square is at most the infinity norm of the Gram matrix, and is that where angles are kept.

use super::single::Scratch;
use super::stack::Stack;
use crate::accel::bounds::{NEAR, NEAR_FARTHEST, NEAR_LEAST, NEAR_SQUARED};
use crate::accel::mesh_tree::MeshTree;
use crate::accel::meshlet::Meshlet;
use crate::accel::node::LEAF;
use crate::geometry::{Bounds, DMat3, DVec3, Transform, single};
use crate::shape::Meshes;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// A point in the space of a tree, and what its limit is there.
struct TreePoint {
    at: [f32; 3],
    /// The largest length in the tree of a unit of the world.
    stretch: f64,
    /// The error of lengths.
    off: f64,
}

impl TreePoint {
    /// `None` for a point that is so far away that float32 tells nothing apart.
    #[inline(always)]
    fn new((tree, mesh): (&MeshTree, Meshes<'_>), point: DVec3, place: &Transform) -> Option<Self> {
        let space = &tree.space;
        let (in_mesh, stretch, off) = if place.is_identity() {
            (point, 1.0, 0.0)
        } else {
            let back = &place.object_from_world().matrix3;
            let moved = place.world_from_object().translation;
            let Bounds { low, high } = mesh.bounds();
            let from = point.abs().max_element() + 2.0 * moved.abs().max_element();
            let own = low.abs().max(high.abs()).max_element();
            // Twice: of three axes together.
            let off = 16.0 * place.rounding() * (largest_row(back) * from + own);
            (*back * (point - moved), largest_stretch(back), off)
        };
        let at = (in_mesh - space.origin) * space.scale;
        let reach = at.abs().max_element() + 1.0;
        let off = f64::from(NEAR) * reach + off * space.scale;
        // Written so that a NaN is far away.
        let is_near = reach < NEAR_FARTHEST && off < NEAR_FARTHEST;
        is_near.then(|| Self { at: at.to_array().map(single), stretch: stretch * space.scale, off })
    }

    /// The limit on squares of distances in the tree, from a limit in the world.
    #[inline(always)]
    fn limit(&self, squared: f64) -> f32 {
        let length = squared.sqrt() * self.stretch * (1.0 + f64::EPSILON * 4096.0) + self.off;
        let limit = length * length * f64::from(1.0 + NEAR_SQUARED);
        // A box that is not there is infinitely far.
        single(limit).next_up().min(f32::MAX)
    }
}

/// The largest sum of a row's sizes.
fn largest_row(m: &DMat3) -> f64 {
    (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()).max_element()
}

/// The largest factor by which a map lengthens vectors; see the error bounds.
fn largest_stretch(map: &DMat3) -> f64 {
    largest_row(&(map.transpose() * *map)).sqrt() * (1.0 + 64.0 * f64::EPSILON)
}

/// Calls `visit` with each triangle of a mesh whose distance from `point` may have a square of at
/// most `limit`, in any order, and perhaps with others. `place` takes the mesh to the world, where
/// the point and the distances are. `visit` returns the limit to continue with, not larger than
/// before.
///
/// The lowest of triangles in one place is among them. The others are for sure only `with_copies`.
#[inline(always)]
#[doc(hidden)]
pub fn each_near<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, Meshes<'_>),
    (point, place, with_copies): (DVec3, &Transform, bool),
    limit: f64,
    mut visit: impl FnMut(u32, [DVec3; 3]) -> f64,
) {
    let near = TreePoint::new((tree, mesh), point, place).filter(|_| tree.has_nodes());
    let Some(point) = near else {
        for &triangle in tree.all_present().iter() {
            visit(triangle, mesh.corners(triangle));
        }
        return;
    };
    let stack = &mut scratch.stack;
    stack.clear();
    let mut limit = point.limit(limit);
    let mut index = 0_u32;
    loop {
        if index & LEAF == 0 {
            push_children(l, stack, &point, tree, index, limit);
        } else {
            let index = index & !LEAF;
            let leaf = &tree.leaves[index as usize];
            let Bounded { mut possible, low } = bounded(l, &point, leaf, limit);
            possible = tree.present(index, possible);
            while possible != 0 {
                let lane = nearest_lane(&low.0, possible);
                possible &= !(1 << lane);
                if low.0[lane] > limit {
                    break;
                }
                let triangle = tree.triangle(leaf, lane);
                let corners = tree.corners(mesh, leaf, lane);
                let mut squared = visit(triangle, corners);
                if with_copies {
                    for &[_, copy] in tree.copies_of(triangle) {
                        squared = visit(copy, corners);
                    }
                }
                limit = point.limit(squared);
            }
        }
        let Some((_, next)) = stack.pop_within(limit) else {
            return;
        };
        index = next;
    }
}

/// The lane of the smallest number among those in a mask; of equal ones the first.
#[inline(always)]
fn nearest_lane(of: &[f32; LANES], mask: u16) -> usize {
    let mut best = mask.trailing_zeros() as usize % LANES;
    for lane in set_bits(mask & (mask - 1)) {
        if of[lane] < of[best] {
            best = lane;
        }
    }
    best
}

/// Puts the children of a node that are within the limit onto the stack, the nearest on top.
#[inline(always)]
fn push_children<L: Lanes>(
    l: L,
    stack: &mut Stack,
    point: &TreePoint,
    tree: &MeshTree,
    index: u32,
    limit: f32,
) {
    let node = &tree.nodes[index as usize];
    let [x, y, z] = point.at;
    let (x, y, z) = (l.splat(x), l.splat(y), l.splat(z));
    macro_rules! gap {
        ($at:ident, $axis:literal) => {{
            let low = l.sub(l.load(&node.planes[2 * $axis]), $at);
            let high = l.sub($at, l.load(&node.planes[2 * $axis + 1]));
            l.max(l.max(low, high), l.splat(0.0))
        }};
    }
    let (x, y, z) = (gap!(x, 0), gap!(y, 1), gap!(z, 2));
    let squared = l.mul_add(x, x, l.mul_add(y, y, l.mul(z, z)));
    let within = tree.children_left(index) & l.le(squared, l.splat(limit));
    let mut all = Aligned([0.0; LANES]);
    l.store(squared, &mut all.0);
    let base = stack.len();
    for child in set_bits(within) {
        let key = u64::from(all.0[child].to_bits()) << 32 | u64::from(node.children[child]);
        stack.insert(base, key);
    }
}

/// The triangles of a leaf that may be within a limit, and lower bounds of the squares of their
/// distances.
struct Bounded {
    possible: u16,
    low: Aligned<[f32; LANES]>,
}

/// A vector in each lane.
type Vectors<L> = [<L as Lanes>::Floats; 3];

#[inline(always)]
fn minus<L: Lanes>(l: L, a: Vectors<L>, b: Vectors<L>) -> Vectors<L> {
    [l.sub(a[0], b[0]), l.sub(a[1], b[1]), l.sub(a[2], b[2])]
}

#[inline(always)]
fn dot<L: Lanes>(l: L, a: Vectors<L>, b: Vectors<L>) -> L::Floats {
    l.mul_add(a[0], b[0], l.mul_add(a[1], b[1], l.mul(a[2], b[2])))
}

#[inline(always)]
fn cross<L: Lanes>(l: L, a: Vectors<L>, b: Vectors<L>) -> Vectors<L> {
    [
        l.mul_sub(a[1], b[2], l.mul(a[2], b[1])),
        l.mul_sub(a[2], b[0], l.mul(a[0], b[2])),
        l.mul_sub(a[0], b[1], l.mul(a[1], b[0])),
    ]
}

/// About the offset of the point of a segment that is nearest to the origin, and the square of its
/// length.
#[inline(always)]
fn offset<L: Lanes>(l: L, a: Vectors<L>, edge: Vectors<L>) -> (Vectors<L>, L::Floats) {
    let share = l.div(dot(l, a, edge), dot(l, edge, edge));
    // Of an edge without a length it is NaN, and then 1, which leads to the same point.
    let share = l.max(l.min(l.sub(l.splat(0.0), share), l.splat(1.0)), l.splat(0.0));
    let offset = [
        l.mul_add(share, edge[0], a[0]),
        l.mul_add(share, edge[1], a[1]),
        l.mul_add(share, edge[2], a[2]),
    ];
    (offset, dot(l, offset, offset))
}

#[inline(always)]
fn select<L: Lanes>(l: L, mask: u16, a: Vectors<L>, b: Vectors<L>) -> Vectors<L> {
    [l.select(mask, a[0], b[0]), l.select(mask, a[1], b[1]), l.select(mask, a[2], b[2])]
}

/// See [the module](self), step 3.
#[inline(always)]
fn bounded<L: Lanes>(l: L, point: &TreePoint, leaf: &Meshlet, limit: f32) -> Bounded {
    let relative = [
        l.sub(l.load(&leaf.vertices[0]), l.splat(point.at[0])),
        l.sub(l.load(&leaf.vertices[1]), l.splat(point.at[1])),
        l.sub(l.load(&leaf.vertices[2]), l.splat(point.at[2])),
    ];
    macro_rules! corner {
        ($k:literal) => {{
            let places = l.load_places(&leaf.corners[$k]);
            [
                l.permute_by(relative[0], places),
                l.permute_by(relative[1], places),
                l.permute_by(relative[2], places),
            ]
        }};
    }
    let (a, b, c) = (corner!(0), corner!(1), corner!(2));
    let (ab, bc, ca) = (minus(l, b, a), minus(l, c, b), minus(l, a, c));
    let (mut way, mut least) = offset(l, a, ab);
    for (corner, edge) in [(b, bc), (c, ca)] {
        let (other, squared) = offset(l, corner, edge);
        let nearer = l.lt(squared, least);
        way = select(l, nearer, other, way);
        least = l.select(nearer, squared, least);
    }
    let normal = cross(l, ca, ab);
    let zero = l.splat(0.0);
    let above = l.lt(zero, dot(l, normal, cross(l, a, ab)))
        & l.lt(zero, dot(l, normal, cross(l, b, bc)))
        & l.lt(zero, dot(l, normal, cross(l, c, ca)))
        & l.lt(l.splat(NEAR_LEAST), dot(l, normal, normal));
    let is_behind = l.lt(dot(l, normal, a), zero);
    let back = minus(l, [zero; 3], normal);
    let way = select(l, above, select(l, is_behind, back, normal), way);
    let length = dot(l, way, way);
    // All of the triangle is so far along the way, at least.
    let least = l.min(l.min(dot(l, a, way), dot(l, b, way)), dot(l, c, way));
    let squared = l.mul(least, least);
    let is_told = l.lt(zero, least) & l.lt(l.splat(NEAR_LEAST), length);
    let beyond = l.lt(l.mul(l.splat(limit), length), squared);
    let mut low = Aligned([0.0; LANES]);
    l.store(l.select(is_told, l.div(squared, length), zero), &mut low.0);
    Bounded { possible: leaf.filled & !(is_told & beyond), low }
}
