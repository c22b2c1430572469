//! The top-level tree: a binary tree over boxes, and one ray through it.
//!
//! 1. Compute where the ray enters the boxes of both children of a node; the ray is as wide as all rounding together
//!    ([`WideRay`]).
//! 2. Go on with the nearer child, and put the other onto the stack.
//! 3. At a leaf, give out its boxes' indices one by one; the caller may shorten the ray between two of them.
//!
//! Ize, "Robust BVH Ray Traversal", Journal of Computer Graphics Techniques 2(2), 2013. It departs in that it widens
//! the boxes by a share of the coordinates and not of the distances along the ray, which would be nothing near the
//! local origin.
//!
//! # Error bounds
//!
//! Three roundings must not lose a candidate. Each is a share of the coordinates relative to the ray's start, which are
//! at most `R = |o| + extent`:
//!
//! - the slab test: 2 `EPSILON` R at each end;
//! - the shape's test, which may accept a ray that passes the shape at a distance of its rounding;
//! - the `t` of the shape's test, which is compared with where the ray enters a box.
//!
//! [`Bvh::OBJECTS`] is more than all three. A box that is wider by `margin = slack * R` makes up for them, as it is
//! also entered earlier: by at least `margin / |d|` along the axis of the largest `d`. The margin costs no time: it is
//! added to the origin.

use bytemuck::{Pod, Zeroable};

use crate::geometry::{Bounds, DVec3, Ray, arrays};

/// A bounding volume hierarchy: a binary tree of float32 boxes around a local origin.
///
/// The boxes are rounded outwards, and the ray has a width that covers all other rounding. So nothing that the float64
/// test would accept is left out.
#[derive(Debug, Clone)]
pub struct Bvh {
    /// The middle of most boxes: far from the world's origin, float32 still resolves them.
    pub(super) origin: DVec3,
    /// The largest distance of a box from `origin` along an axis.
    pub(super) extent: f64,
    /// See [`Bvh::build`].
    pub(super) slack: f64,
    /// The root first; the children of a node stand side by side.
    pub(super) nodes: Vec<Node>,
    /// The indices of the boxes, those of a leaf side by side.
    pub(crate) order: Vec<u32>,
    /// Where each box is; made when one is first [moved](Self::refit).
    pub(super) places: Option<Places>,
}

/// Where boxes are in a tree.
#[derive(Debug, Clone)]
pub(super) struct Places {
    /// The leaf of each box; any for one that is not in the tree.
    pub(super) leaves: Vec<u32>,
    /// The parent of each node; the root is its own.
    pub(super) parents: Vec<u32>,
}

/// A box, and what is in it: `count` entries of the order from `first` on, or, when `count` is 0, the
/// two nodes from `first` on. Two nodes fill one cache line.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Node {
    pub(super) low: [f32; 3],
    pub(super) first: u32,
    pub(super) high: [f32; 3],
    pub(super) count: u32,
}

impl Bvh {
    /// The least `slack` for objects. Transforms can need more.
    pub const OBJECTS: f64 = f64::EPSILON * 4096.0;

    /// See [`Bvh::build`].
    pub(crate) fn slack(&self) -> f64 {
        self.slack
    }

    /// How many nodes a ray that meets the root's box is expected to meet, by their surfaces: Goldsmith and Salmon, "Automatic Creation of
    /// Object Hierarchies for Ray Tracing", IEEE Computer Graphics and Applications 7(5), 1987.
    pub(crate) fn expected_visits(&self) -> f64 {
        let surface = |node: &Node| {
            let [x, y, z] =
                arrays::from_fn(|axis| f64::from(node.high[axis]) - f64::from(node.low[axis]));
            x * y + y * z + z * x
        };
        let all: f64 = self.nodes.iter().map(surface).sum();
        self.nodes.first().map_or(0.0, |root| all / surface(root))
    }

    /// What the tree takes in memory, but for what it keeps once a box has moved.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.order.capacity() * size_of::<u32>()
    }
}

/// The corners of a box around `bounds`, relative to `origin`, however far that is. It is a float32 step wider on each side, which
/// covers the rounding of the difference too.
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding is what this is for"
)]
pub(super) fn outwards(bounds: Bounds, origin: DVec3) -> [[f32; 3]; 2] {
    let single = |point: DVec3| (point - origin).to_array().map(|x| x as f32);
    [
        single(bounds.low).map(f32::next_down),
        single(bounds.high).map(f32::next_up),
    ]
}

/// A ray's way through a [`Bvh`].
pub(crate) struct Walk<'a> {
    bvh: &'a Bvh,
    ray: WideRay,
    /// What is left of a leaf.
    leaf: &'a [u32],
}

/// Memory for a [`Walk`], to be used again: nodes to be visited, and where the ray enters them.
pub(crate) type WalkStack = Vec<(u32, f64)>;

impl Bvh {
    /// The boxes that `ray` may meet, one after the other.
    pub(crate) fn walk(&self, ray: &Ray, stack: &mut WalkStack) -> Walk<'_> {
        let wide_ray = WideRay::new(self, ray);
        stack.clear();
        if let Some(root) = self.nodes.first()
            && !wide_ray.entry(root).is_nan()
        {
            stack.push((0, wide_ray.first));
        }
        Walk {
            bvh: self,
            ray: wide_ray,
            leaf: &[],
        }
    }
}

impl Walk<'_> {
    /// The next box that the ray may meet at a parameter of at most `t_max`, roughly the nearest first. `t_max` is not
    /// larger than in the call before, and `stack` is the same.
    pub(crate) fn next(&mut self, t_max: f64, stack: &mut WalkStack) -> Option<u32> {
        loop {
            if let Some((&index, rest)) = self.leaf.split_first() {
                self.leaf = rest;
                return Some(index);
            }
            let (index, entry) = stack.pop()?;
            // A hit since it was put there may have made it too far.
            if entry <= t_max {
                self.open(self.bvh.nodes[index as usize], t_max, stack);
            }
        }
    }

    fn open(&mut self, node: Node, t_max: f64, stack: &mut WalkStack) {
        if node.count > 0 {
            self.leaf = &self.bvh.order[node.first as usize..(node.first + node.count) as usize];
            return;
        }
        let entry = |index: u32| (index, self.ray.entry(&self.bvh.nodes[index as usize]));
        let (left, right) = (entry(node.first), entry(node.first + 1));
        let [near, far] = if right.1 < left.1 {
            [right, left]
        } else {
            [left, right]
        };
        for child in [far, near] {
            // Not where it is NaN: the ray passes the box.
            if child.1 <= t_max {
                stack.push(child);
            }
        }
    }
}

/// A ray made ready for boxes, as wide as all rounding together; see the error bounds above.
struct WideRay {
    /// The origin, moved by the margin so that low ends of boxes are lower, and high ends higher.
    low_origin: DVec3,
    high_origin: DVec3,
    inverse: DVec3,
    /// Where the ray begins, or its origin if that comes first.
    first: f64,
}

impl WideRay {
    fn new(bvh: &Bvh, ray: &Ray) -> Self {
        let origin = ray.origin - bvh.origin;
        let margin = DVec3::splat(bvh.slack * (origin.abs().max_element() + bvh.extent));
        Self {
            low_origin: origin + margin,
            high_origin: origin - margin,
            inverse: ray.direction.recip(),
            first: ray.t_min.min(0.0),
        }
    }

    /// The smallest `t` in the box, of the ray or of all that is ahead of its origin; NaN, which fails every
    /// comparison, when the ray passes the box.
    ///
    /// Along an axis with a zero direction the distances are infinite. One is NaN when the origin is on the border of
    /// the widened box, where nothing is: `min` and `max` then take the other, infinite one.
    #[inline]
    fn entry(&self, node: &Node) -> f64 {
        let low = (DVec3::from(arrays::map(node.low, f64::from)) - self.low_origin) * self.inverse;
        let high =
            (DVec3::from(arrays::map(node.high, f64::from)) - self.high_origin) * self.inverse;
        let mut entry = self.first;
        let mut exit = f64::INFINITY;
        for axis in 0..3 {
            entry = entry.max(low[axis].min(high[axis]));
            exit = exit.min(low[axis].max(high[axis]));
        }
        if entry <= exit { entry } else { f64::NAN }
    }
}
