//! The boxes of a [`Bvh`] that are nearest to a point.
//!
//! A box is nearer by the margin that a ray has too (`bvh.rs`): it covers the rounding of the
//! distance, and that of the shape's own.

use super::bvh::{Bvh, WalkStack};
use super::node::{LEAF, Node, WIDTH};
use crate::geometry::DVec3;

/// A search from a point.
#[doc(hidden)]
pub struct Nearby<'a> {
    bvh: &'a Bvh,
    /// The point and the margin, in the tree's space.
    at: DVec3,
    margin: f64,
}

impl Bvh {
    /// The boxes around a point, one after the other.
    #[doc(hidden)]
    pub fn nearby(&self, point: DVec3, stack: &mut WalkStack) -> Nearby<'_> {
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push((0, 0.0));
        }
        Nearby {
            bvh: self,
            at: self.space.point(point),
            margin: self.margin(point) * self.space.scale,
        }
    }
}

impl Nearby<'_> {
    /// The next box of which a point may be at a distance with a square of at most `limit`, roughly
    /// the nearest first. `limit` is not larger than in the call before, and `stack` is the same.
    pub fn next(&self, limit: f64, stack: &mut WalkStack) -> Option<u32> {
        loop {
            let (child, squared) = stack.pop()?;
            if squared > limit {
                continue;
            }
            if child & LEAF != 0 {
                return Some(child & !LEAF);
            }
            let node = &self.bvh.nodes[child as usize];
            let bottom = stack.len();
            let all = node.children.into_iter().zip(self.squared(node));
            stack.extend(all.filter(|&(_, squared)| squared <= limit));
            stack[bottom..].sort_unstable_by(|a, b| b.1.total_cmp(&a.1));
        }
    }

    /// Lower bounds of the squares of the distances to a node's boxes, NaN where there is none.
    /// Where a bound is NaN or leaves float64, zero.
    fn squared(&self, node: &Node) -> [f64; WIDTH] {
        let mut squared = [0.0; WIDTH];
        for (planes, at) in node.planes.chunks_exact(2).zip(self.at.to_array()) {
            let [low, high] = [&planes[0], &planes[1]];
            for k in 0..WIDTH {
                let gap = (f64::from(low[k]) - at).max(at - f64::from(high[k]));
                let gap = ((gap - self.margin) / self.bvh.space.scale).max(0.0);
                squared[k] += gap * gap;
            }
        }
        for (k, squared) in squared.iter_mut().enumerate() {
            let below = *squared * (1.0 - 8.0 * f64::EPSILON);
            *squared = if node.is_vacant(k) {
                f64::NAN
            } else if below < f64::INFINITY {
                below
            } else {
                0.0
            };
        }
        squared
    }
}
