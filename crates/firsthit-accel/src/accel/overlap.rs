//! Finds the boxes of a [`Bvh`] that may overlap a box.

use super::bvh::Bvh;
use super::node::{LEAF, Node, WIDTH};
use crate::geometry::{Bounds, arrays};

impl Bvh {
    /// Calls `visit` with the index of each box that overlaps `bounds` or touches it, and of a few
    /// that only come near, until it returns `true`. The order depends on the boxes alone. Returns
    /// whether `visit` ended it. `stack` is memory to be used again.
    #[doc(hidden)]
    pub fn any_overlapping(
        &self,
        bounds: Bounds,
        stack: &mut Vec<u32>,
        mut visit: impl FnMut(u32) -> bool,
    ) -> bool {
        // Rounded as the boxes are: rounding keeps the order of numbers, so that what overlaps does
        // so still.
        let [low, high] = self.space.outwards(bounds);
        let overlapping = |node: &Node| {
            let mut overlaps: [bool; WIDTH] = arrays::from_fn(|k| !node.is_vacant(k));
            for (axis, planes) in node.planes.chunks_exact(2).enumerate() {
                for k in 0..WIDTH {
                    overlaps[k] &= planes[0][k] <= high[axis] && low[axis] <= planes[1][k];
                }
            }
            overlaps
        };
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push(0);
        }
        while let Some(child) = stack.pop() {
            if child & LEAF == 0 {
                let node = &self.nodes[child as usize];
                let all = node.children.iter().zip(overlapping(node)).rev();
                stack.extend(all.filter(|(_, overlaps)| *overlaps).map(|(child, _)| child));
            } else if visit(child & !LEAF) {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::DVec3;

    #[test]
    fn no_box_that_overlaps_is_missed() {
        let corner = |k: u32, step: u32| {
            let along = |prime: u32| f64::from(k.wrapping_mul(prime) % 997) / 10.0;
            DVec3::new(along(7919 + step), along(104_729 + step), along(1_299_709 + step))
        };
        let bounds = |k: u32| {
            let low = corner(k, 0) + 1e7;
            let high = low + 0.05 * corner(k, 2);
            Bounds { low, high }
        };
        let bvh = Bvh::build(1000, bounds, 0.0);
        let mut stack = Vec::new();
        for k in 0..1000 {
            let query = bounds(k);
            let mut found = vec![false; 1000];
            let ended = bvh.any_overlapping(query, &mut stack, |index| {
                assert!(!std::mem::replace(&mut found[index as usize], true));
                false
            });
            assert!(!ended && found[k as usize]);
            for other in 0..1000 {
                let Bounds { low, high } = bounds(other);
                let overlaps = low.cmple(query.high).all() && query.low.cmple(high).all();
                assert!(!overlaps || found[other as usize], "{k} {other}");
            }
            // Some, not all.
            assert!(found.iter().filter(|&&found| found).count() < 500);
        }
    }
}
