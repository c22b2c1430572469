//! A ray made ready for a [`MeshTree`]: float32, in the tree's space, with bounds for all rounding.
//!
//! Lengths along the ray are *depths*: coordinates along the axis on which the direction is longest, counted
//! from the ray's start forwards. So the direction's components are at most 1 and nothing leaves the range
//! of float32. A ray that starts far away is first moved, in float64, to where the tree is near.
//!
//! Bounds are in units of `u = 2^-24`, half of `f32::EPSILON`, and of `reach`, which no difference of a
//! coordinate of the tree and one of the ray's start exceeds. It is at least 1, so that products of what is
//! smaller than float32 can hold are far below every bound.

use super::mesh_tree::MeshTree;
use super::wide::Node;
use crate::geometry::{DVec3, Ray};
use crate::shape::triangle::Shear;
use crate::simd::Lanes;

pub(super) const U: f32 = f32::EPSILON / 2.0;

/// Starts beyond this are moved. The tree is in the cube from -1 to 1.
const FAR: f64 = 8.0;

#[derive(Debug, Clone, Copy)]
pub(super) struct TreeRay {
    pub(super) ray: Ray,
    pub(super) shear: Shear,
    /// The axes of `shear`.
    pub(super) axes: [usize; 3],
    /// The start in two parts, along those axes.
    pub(super) start: [[f32; 2]; 3],
    /// What the ray moves along the first two of them for a depth of 1.
    pub(super) slope: [f32; 2],
    /// Which way it goes along the third: 1 or -1.
    pub(super) forwards: f32,
    /// `reach`, see above.
    pub(super) reach: f32,
    /// What rounding comes to that does not shrink near the start: that of the start itself in float64, and
    /// that of the vertices where float32 does not hold them.
    pub(super) blur: f32,
    /// For each axis of space, which planes of a node are met first, and which last.
    planes: [[usize; 2]; 3],
    /// The start as those planes see it: moved so that boxes seem wider, which makes up for all rounding.
    starts: [[f32; 2]; 3],
    inverse: [f32; 3],
    /// Depth in a unit of `t`.
    depth_per_t: f64,
    /// The depth that the start was moved by.
    moved: f64,
}

impl TreeRay {
    /// `None` when the ray cannot meet anything.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the rounding is allowed for"
    )]
    pub(super) fn new(tree: &MeshTree, ray: &Ray, shear: &Shear) -> Option<Self> {
        let axes = shear.axes();
        let [x, y, z] = axes;
        let mut start = (ray.origin - tree.space.origin) * tree.space.scale;
        let along = ray.direction[z];
        let sign = 1.0_f64.copysign(along);
        let mut direction = DVec3::ZERO;
        direction[x] = sign * shear.slope().x;
        direction[y] = sign * shear.slope().y;
        direction[z] = sign;
        let mut moved = 0.0;
        let mut largest = start.abs().max_element();
        let mut blur = 1e-15 * (ray.origin.abs().max_element() * tree.space.scale + 100.0);
        if !tree.is_exact {
            blur += f64::from(U);
        }
        if largest > FAR {
            // To two units before the point nearest to the middle of the tree.
            moved = (-start.dot(direction) / direction.length_squared() - 2.0).max(0.0);
            start += moved * direction;
            blur += 1e-15 * (largest + moved);
            largest = start.abs().max_element();
            // Written so that a NaN fails. The ray passes the tree, or leaves it behind.
            let is_near = largest <= FAR;
            if !is_near {
                return None;
            }
        }
        let (reach, blur) = (largest as f32 * 1.000_001 + 1.0, blur as f32);
        // A node's test rounds the start by 1, the difference by 1, the direction's reciprocal and the
        // product by 1 each, and the tree rounded the vertices by 1.
        let margin = f64::from(12.0 * U * reach + 2.0 * blur);
        let mut planes = [[0; 2]; 3];
        let mut starts = [[0.0; 2]; 3];
        let mut inverse = [0.0; 3];
        for axis in 0..3 {
            let is_back = usize::from(direction[axis].is_sign_negative());
            planes[axis] = [2 * axis + is_back, 2 * axis + (1 - is_back)];
            let wider = if is_back == 1 { -margin } else { margin };
            starts[axis] = [(start[axis] + wider) as f32, (start[axis] - wider) as f32];
            inverse[axis] = reciprocal(direction[axis] as f32);
        }
        Some(Self {
            ray: *ray,
            shear: *shear,
            axes,
            start: [
                two_parts(start[x]),
                two_parts(start[y]),
                two_parts(start[z]),
            ],
            slope: [direction[x] as f32, direction[y] as f32],
            forwards: sign as f32,
            reach,
            blur,
            planes,
            starts,
            inverse,
            depth_per_t: along.abs() * tree.space.scale,
            moved,
        })
    }

    /// What a float32 depth of the ray is off by at most, and twice as much again.
    #[inline(always)]
    pub(super) fn depth_error(&self) -> f32 {
        24.0 * U * self.reach + 3.0 * self.blur
    }

    /// A depth that is not smaller than that of `t`, nor is that of a hit there as the filter sees it.
    #[inline(always)]
    pub(super) fn depth_above(&self, t: f64) -> f32 {
        let depth = self.depth(t);
        depth + depth.abs() * (4.0 * U) + self.depth_error()
    }

    /// A depth that is not larger than that of `t`.
    #[inline(always)]
    pub(super) fn depth_below(&self, t: f64) -> f32 {
        let depth = self.depth(t);
        if depth == f32::INFINITY {
            // Written out: infinity less a part of infinity is NaN.
            return depth;
        }
        depth - depth.abs() * (4.0 * U) - self.depth_error()
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the rounding is allowed for"
    )]
    fn depth(&self, t: f64) -> f32 {
        (t * self.depth_per_t - self.moved) as f32
    }

    /// Which of a node's boxes the ray may meet at a depth of at most `limit`, and at which depths.
    ///
    /// Ize, "Robust BVH Ray Traversal", Journal of Computer Graphics Techniques 2(2), 2013, widens by
    /// relative amounts after the test; here the two starts carry a margin, which costs nothing.
    #[inline(always)]
    pub(super) fn boxes<L: Lanes>(&self, l: L, node: &Node, limit: f32) -> (u16, L::Floats) {
        let [x, y, z] = self.planes;
        macro_rules! end {
            ($axis:literal, $planes:ident, $side:literal) => {{
                let plane = l.load(&node.planes[$planes[$side] % 6]);
                let moved = l.sub(plane, l.splat(self.starts[$axis][$side]));
                l.mul(moved, l.splat(self.inverse[$axis]))
            }};
        }
        let entry = l.max(
            l.max(end!(0, x, 0), end!(1, y, 0)),
            l.max(end!(2, z, 0), l.splat(0.0)),
        );
        let exit = l.min(
            l.min(end!(0, x, 1), end!(1, y, 1)),
            l.min(end!(2, z, 1), l.splat(limit)),
        );
        (l.le(entry, exit), entry)
    }
}

/// A float64 number as a float32 one and the rest.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the rest is kept")]
fn two_parts(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

/// One over a component of the direction, finite: along an axis where the ray moves by less than all
/// margins it is parallel, and a huge number tells inside from outside.
#[inline(always)]
fn reciprocal(x: f32) -> f32 {
    const SMALLEST: f32 = 1e-30;
    if x.abs() < SMALLEST {
        (1.0 / SMALLEST).copysign(x)
    } else {
        1.0 / x
    }
}
