//! The top-level tree: a tree of 16-wide nodes over boxes, and one ray through it.
//!
//! 1. Find the point of the ray's line that is nearest to the tree's origin. Depths are counted
//!    from there.
//! 2. Test the sixteen boxes of a node, and continue with those that are met: `walks.rs` for rays
//!    that go alone, `packet_walk.rs` for neighbours.
//!
//! Ize, "Robust BVH Ray Traversal", Journal of Computer Graphics Techniques 2(2), 2013. It departs
//! in that it widens the boxes by a share of the coordinates and not of the distances along the
//! ray, which would be nothing near the local origin.
//!
//! # Error bounds
//!
//! Three roundings of float64 must not lose a candidate. Each is a share of the coordinates
//! relative to the ray's start, which are at most `R = |o| + extent`:
//!
//! - that of the start, of the nearest point and of its depth: 8 `EPSILON` R;
//! - the shape's test, which may accept a ray that passes the shape at a distance of its rounding;
//! - the `t` of the shape's test, which is compared with where the ray enters a box.
//!
//! [`Bvh::OBJECTS`] is more than all three. A box that is wider by `margin = slack * R` makes up
//! for them, as it is also entered earlier: by at least `margin / |d|` along the axis of the
//! largest `d`. The margin costs no time: it is in the ends of the slab test.
//!
//! The slab test is done in float32. With coordinates b of a box and p of the point of step 1,
//! `b / d - p / d` is off by at most 3 [`U`] |b| and 3 [`U`] |p|, in units of the coordinates. The
//! boxes are wider by [`BOX_ROUNDING`] of their own coordinates, and the ray by as much of p. So
//! float32's rounding grows neither with the extent nor with the distance of the start; the margin
//! does. Too small: `no_box_that_a_ray_meets_is_missed`.

use super::bounds::U;
use super::node::Node;
use super::rays::slabs::Slabs;
use crate::geometry::{Bounds, DVec3, Ray, arrays};
use crate::simd::{LANES, set_bits};

/// A bounding volume hierarchy: 16-wide nodes of float32 boxes around a local origin. A leaf is one
/// box.
///
/// The boxes are rounded outwards, and the ray has a width that covers all other rounding. So
/// nothing that the float64 test would accept is left out.
#[derive(Debug, Clone)]
pub struct Bvh {
    pub(super) space: BoxSpace,
    /// The largest distance of a box from the origin along an axis.
    pub(super) extent: f64,
    /// See [`Bvh::build`].
    pub(super) slack: f64,
    /// The root first. With [`LEAF`] a child is the index of a box.
    pub(super) nodes: Vec<Node>,
    /// The place of each box; made when one first [changes](Self::refit).
    pub(super) places: Option<Places>,
}

/// The tree's space: moved, and scaled by a power of two so that the boxes are in the cube from -1
/// to 1 when it is built.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoxSpace {
    /// The middle of most boxes: far from the world's origin, float32 still resolves them.
    pub(super) origin: DVec3,
    pub(super) scale: f64,
}

/// Places in a tree: sixteen times the index of a node, and the place among its children.
#[derive(Debug, Clone)]
pub(super) struct Places {
    /// The place of each box; [`NOWHERE`] for one that is not in the tree.
    pub(super) boxes: Vec<u32>,
    /// The place of each node in its parent.
    pub(super) nodes: Vec<u32>,
}

/// The place of a box that is not in the tree.
pub(super) const NOWHERE: u32 = u32::MAX;

/// The widening of boxes, and of rays, as a share of their coordinates.
pub(super) const BOX_ROUNDING: f64 = 6.0 * U as f64;

/// Boxes may move as far as this from the origin, in units of the tree, before it is built anew.
pub(super) const FARTHEST_BOX: f64 = 65_536.0;

impl Bvh {
    /// The least `slack` for objects. Transforms can need more.
    pub const OBJECTS: f64 = f64::EPSILON * 4096.0;

    /// See [`Bvh::build`].
    #[doc(hidden)]
    #[inline]
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// The size in bytes, without the tables that `refit` adds.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }

    /// The widening of boxes for a point, or for a ray that starts there, in units of the scene.
    #[inline(always)]
    pub(super) fn margin(&self, point: DVec3) -> f64 {
        let reach = (point - self.space.origin).abs().max_element() + self.extent;
        self.slack * reach
    }
}

impl BoxSpace {
    /// The space of boxes that reach up to `extent` from an origin.
    pub(super) fn new(origin: DVec3, extent: f64) -> Self {
        // Smaller ones would take a ray's coordinates out of float64's range, larger ones the
        // scale.
        let reach = extent.clamp(1e-150, 1e300);
        let scale = 1.0 / f64::from_bits(reach.to_bits() & 0x7ff << 52) / 2.0;
        Self { origin, scale }
    }

    #[inline(always)]
    pub(super) fn point(&self, point: DVec3) -> DVec3 {
        (point - self.origin) * self.scale
    }

    /// The corners of a box around `bounds`, wide enough for the test of a ray.
    #[expect(clippy::cast_possible_truncation, reason = "rounding is what this is for")]
    pub(super) fn outwards(&self, bounds: Bounds) -> [[f32; 3]; 2] {
        // A float32 step more covers the rounding of the difference too.
        let (low, high) = (self.point(bounds.low), self.point(bounds.high));
        let low = (low - BOX_ROUNDING * low.abs()).to_array();
        let high = (high + BOX_ROUNDING * high.abs()).to_array();
        [arrays::map(low, |x| (x as f32).next_down()), arrays::map(high, |x| (x as f32).next_up())]
    }
}

/// The radius of a ball around a tree, in units of its extent. All boxes are in a cube, and that in
/// a ball of the square root of 3. The rest is for rounding.
pub(super) const BALL: f64 = 1.75;

/// The boxes still to be visited by a packet, by their places in the tree, each with the depth
/// where it begins. Memory to be used again.
#[doc(hidden)]
pub type WalkStack = Vec<(u32, f64)>;

/// The beginning of a ray's way through a [`Bvh`].
pub(super) struct Walk {
    pub(super) slabs: Slabs,
    /// The depth at which the ray begins, or its origin if that comes first.
    pub(super) first: f32,
    /// The depth of the ray's origin, and that of a `t` of 1 from there.
    pub(super) depth_of_origin: f64,
    pub(super) depth_per_t: f64,
}

impl Bvh {
    /// The way of `ray`, and whether it may meet anything.
    pub(super) fn walk(&self, ray: &Ray) -> (Walk, bool) {
        let start = self.space.point(ray.origin);
        let length = ray.direction.abs().max_element();
        let direction = ray.direction / length;
        let origin_to_nearest = -start.dot(direction) / direction.length_squared();
        let nearest = start + origin_to_nearest * direction;
        let margin = self.margin(ray.origin) * self.space.scale;
        if margin > FARTHEST_BOX {
            return (everywhere(direction), !self.nodes.is_empty());
        }
        let reach = self.extent * self.space.scale + margin;
        let passes = !self.nodes.is_empty() && nearest.length() <= BALL * reach;
        let rounding = BOX_ROUNDING * nearest.abs().max_element();
        let depth_per_t = (length * self.space.scale).max(f64::MIN_POSITIVE);
        let depth_of_origin = -origin_to_nearest;
        let first = ray.t_min.min(0.0) * depth_per_t + depth_of_origin;
        let slabs = Slabs::new(nearest, direction, margin + rounding);
        let first = narrowed(first).next_down();
        (Walk { slabs, first, depth_of_origin, depth_per_t }, passes)
    }
}

/// Through all boxes, for a ray from so far away that float64 does not tell where it passes them.
#[cold]
fn everywhere(direction: DVec3) -> Walk {
    Walk {
        // Beyond all boxes of float64, and finite after the division by the smallest component.
        slabs: Slabs::new(DVec3::ZERO, direction, 2e8),
        first: f32::NEG_INFINITY,
        depth_of_origin: f64::INFINITY,
        depth_per_t: 1.0,
    }
}

/// Puts the boxes of a node that are met onto the stack, by what stands for each, the farthest
/// first. Hardly ever more than a few are met.
#[inline(always)]
pub(super) fn push_nearest_last(
    stack: &mut WalkStack,
    met: u16,
    depths: &[f32; LANES],
    name: impl Fn(usize) -> u32,
) {
    let bottom = stack.len();
    for k in set_bits(met) {
        let entry = (name(k), f64::from(depths[k]));
        let farther = stack[bottom..].iter().take_while(|other| other.1 >= entry.1);
        let place = bottom + farther.count();
        stack.insert(place, entry);
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the caller goes a step further")]
#[inline(always)]
pub(super) fn narrowed(x: f64) -> f32 {
    x as f32
}
