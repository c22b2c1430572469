//! The boxes of a [`Bvh`] that are nearest to a point.
//!
//! A box is nearer by the margin that a ray has too (`bvh.rs`): it covers the rounding of the distance, and that of the
//! shape's own.

use super::bvh::{Bvh, Node, WalkStack};
use crate::geometry::DVec3;

/// A search from a point.
pub(crate) struct Nearby<'a> {
    bvh: &'a Bvh,
    /// The point, from the tree's origin.
    at: DVec3,
    margin: f64,
    /// What is left of a leaf.
    leaf: &'a [u32],
}

impl Bvh {
    /// The boxes around a point, one after the other.
    pub(crate) fn nearby(&self, point: DVec3, stack: &mut WalkStack) -> Nearby<'_> {
        let at = point - self.origin;
        let margin = self.slack * (at.abs().max_element() + self.extent);
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push((0, 0.0));
        }
        Nearby {
            bvh: self,
            at,
            margin,
            leaf: &[],
        }
    }
}

impl Nearby<'_> {
    /// The next box of which a point may be at a distance with a square of at most `limit`, roughly the nearest first. `limit` is
    /// not larger than in the call before, and `stack` is the same.
    pub(crate) fn next(&mut self, limit: f64, stack: &mut WalkStack) -> Option<u32> {
        loop {
            if let Some((&index, rest)) = self.leaf.split_first() {
                self.leaf = rest;
                return Some(index);
            }
            let (index, squared) = stack.pop()?;
            if squared <= limit {
                self.open(self.bvh.nodes[index as usize], limit, stack);
            }
        }
    }

    fn open(&mut self, node: Node, limit: f64, stack: &mut WalkStack) {
        if node.count > 0 {
            self.leaf = &self.bvh.order[node.first as usize..(node.first + node.count) as usize];
            return;
        }
        let squared = |index: u32| (index, self.squared(&self.bvh.nodes[index as usize]));
        let (left, right) = (squared(node.first), squared(node.first + 1));
        let [near, far] = if right.1 < left.1 {
            [right, left]
        } else {
            [left, right]
        };
        for child in [far, near] {
            if child.1 <= limit {
                stack.push(child);
            }
        }
    }

    /// A lower bound of the square of the distance to a box. Where it is NaN or leaves float64, zero.
    fn squared(&self, node: &Node) -> f64 {
        let low = DVec3::from(node.low.map(f64::from)) - self.at;
        let high = self.at - DVec3::from(node.high.map(f64::from));
        let gap = (low.max(high) - self.margin).max(DVec3::ZERO);
        let squared = gap.length_squared() * (1.0 - 8.0 * f64::EPSILON);
        if squared < f64::INFINITY {
            squared
        } else {
            0.0
        }
    }
}
