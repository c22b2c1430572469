use crate::geometry::{DVec3, Ray};

/// A bounding volume hierarchy: a binary tree of float32 boxes around a local origin.
///
/// The boxes are rounded outwards, and the ray is given a width that covers all rounding on the way
/// (see `Slab` below), so nothing that the float64 test would accept is ever left out.
#[derive(Debug, Clone)]
pub struct Bvh {
    /// The middle of everything: far from the world's origin, float32 still resolves the boxes.
    pub(super) origin: DVec3,
    /// The largest distance of a box from `origin` along an axis.
    pub(super) extent: f64,
    /// See [`Bvh::build`].
    pub(super) slack: f64,
    /// The root first; the children of a node stand side by side.
    pub(super) nodes: Vec<Node>,
    /// The indices of the boxes, those of a leaf side by side.
    pub(super) order: Vec<u32>,
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub(super) low: [f32; 3],
    pub(super) first: u32,
    pub(super) high: [f32; 3],
    pub(super) count: u32,
}

impl Bvh {
    /// What objects need at least as `slack`, see `Slab` below. Transforms can ask for more.
    pub const OBJECTS: f64 = f64::EPSILON * 4096.0;

    /// See [`Bvh::build`].
    pub(crate) fn slack(&self) -> f64 {
        self.slack
    }

    /// What the tree takes in memory.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.order.capacity() * size_of::<u32>()
    }
}

/// A ray's way through a [`Bvh`].
pub(crate) struct Walk<'a> {
    bvh: &'a Bvh,
    slab: Slab,
    /// What is left of a leaf.
    leaf: &'a [u32],
}

/// Memory for a [`Walk`], to be used again: nodes to be visited, and where the ray enters them.
pub(crate) type WalkStack = Vec<(u32, f64)>;

impl Bvh {
    /// The boxes that `ray` may meet, one after the other.
    pub(crate) fn walk(&self, ray: &Ray, stack: &mut WalkStack) -> Walk<'_> {
        let slab = Slab::new(self, ray);
        stack.clear();
        if let Some(root) = self.nodes.first()
            && !slab.entry(root).is_nan()
        {
            stack.push((0, slab.first));
        }
        Walk {
            bvh: self,
            slab,
            leaf: &[],
        }
    }
}

impl Walk<'_> {
    /// The next box that the ray may meet at a parameter of at most `t_max`, roughly the nearest first;
    /// `t_max` is not larger than the time before, and `stack` the same.
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
        let entry = |index: u32| (index, self.slab.entry(&self.bvh.nodes[index as usize]));
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

/// A ray made ready for boxes, as wide as all rounding together.
///
/// Three roundings must never lose a candidate: that of the slab test, that of the shape's test (which may accept a ray that passes
/// at the distance of its rounding), and that of the `t` it gives (which the tree compares with the box's). All
/// are shares of the coordinates relative to the ray's start, which are at most `R = |o| + extent`. The slab test
/// rounds by 2 `EPSILON * R` at each end, shapes by up to what [`Bvh::OBJECTS`] says. Widening every box by `margin = slack * R`
/// covers them; it also moves each entry forwards by `margin / |d|` along the axis of the largest `d`, at
/// least, so no box is entered after the `t` of a hit in it.
/// The margin costs nothing: it is in the two origins. (Ize, "Robust BVH Ray Traversal", Journal of
/// Computer Graphics Techniques 2(2), 2013, widens by relative amounts; that fails at the local origin.)
struct Slab {
    /// The origin moved so far forwards, or backwards, that the boxes seem wider.
    low_origin: DVec3,
    high_origin: DVec3,
    inverse: DVec3,
    /// Where the ray begins, or its origin if that comes first.
    first: f64,
}

impl Slab {
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

    /// The smallest `t` of the ray, or from its origin on, in the box; NaN, which no comparison lets through, when the ray passes it.
    ///
    /// Along an axis with a zero direction the distances are infinite, or NaN when the origin is on the
    /// border of the widened box, where nothing is: `min` and `max` then take the other, infinite one.
    #[inline]
    fn entry(&self, node: &Node) -> f64 {
        let low = (DVec3::from(node.low.map(f64::from)) - self.low_origin) * self.inverse;
        let high = (DVec3::from(node.high.map(f64::from)) - self.high_origin) * self.inverse;
        let mut entry = self.first;
        let mut exit = f64::INFINITY;
        for axis in 0..3 {
            entry = entry.max(low[axis].min(high[axis]));
            exit = exit.min(low[axis].max(high[axis]));
        }
        if entry <= exit { entry } else { f64::NAN }
    }
}
