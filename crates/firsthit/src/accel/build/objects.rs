//! Makes the top-level tree over boxes, and fits it to boxes that move.

use super::binary::{Binary, BinaryNode, Primitives, binary};
use super::binned_sah::{Block, Box32, Item};
use crate::accel::bvh::{Bvh, Node, Places, outwards};
use crate::accel::space::CHUNK;
use crate::geometry::{Bounds, DVec3};
use crate::parallel;

/// Leaves have up to this many boxes. A ray comes to all boxes of a leaf, and to enter the mesh of one takes longer than to test two more
/// boxes of the tree.
const MOST_IN_LEAF: usize = 1;

/// Boxes without anything in them that the builder must know.
struct Boxes;

impl Primitives for Boxes {
    fn block(&self) -> Block {
        Block(0)
    }

    fn is_leaf(&self, items: &[Item]) -> bool {
        items.len() <= MOST_IN_LEAF
    }
}

impl Bvh {
    /// The tree over the boxes `bounds(0)` to `bounds(count - 1)`, which are finite. Empty ones are left out. `bounds`
    /// is called once for each. `slack` is what the test of a candidate rounds, as a share of the coordinates it works
    /// with.
    ///
    /// Built by all threads of the current rayon pool, and the same for any number of them. Fewer than 65,536 boxes are
    /// the calling thread's alone, and need no pool.
    pub fn build(count: u32, bounds: impl Fn(u32) -> Bounds + Sync, slack: f64) -> Self {
        let indices: Vec<u32> = (0..count).collect();
        let boxes: Vec<Bounds> = parallel::gather(indices.chunks(CHUNK), |indices| {
            indices.iter().copied().map(&bounds).collect()
        });
        let all = boxes.iter().copied().fold(Bounds::EMPTY, Bounds::union);
        if all.is_empty() {
            return Self {
                origin: DVec3::ZERO,
                extent: 0.0,
                slack,
                nodes: Vec::new(),
                order: Vec::new(),
                places: None,
            };
        }
        let origin = middle(&boxes);
        let filled = (0..count)
            .zip(boxes)
            .filter(|(_, bounds)| !bounds.is_empty());
        let mut items: Vec<Item> = filled
            .map(|(index, bounds)| Item::new(rounded_outwards(bounds, origin), index))
            .collect();
        let Binary { nodes, order } = binary(&mut items, &Boxes);
        Self {
            origin,
            extent: (all.high - origin).max(origin - all.low).max_element(),
            slack,
            nodes: nodes.into_iter().map(Node::from).collect(),
            order,
            places: None,
        }
    }

    /// Fits the tree to one box that has moved, to a finite place. `bounds` is as for [`Bvh::build`]. The boxes around
    /// it change, from its leaf up to the root.
    pub(crate) fn refit(&mut self, moved: u32, bounds: impl Fn(u32) -> Bounds) {
        let places = self.places.take().unwrap_or_else(|| self.find_places());
        let new = bounds(moved);
        let reach = (new.high - self.origin).max(self.origin - new.low);
        self.extent = self.extent.max(reach.max_element());
        let mut index = places.leaves[moved as usize] as usize;
        loop {
            let node = self.nodes[index];
            let around = if node.count > 0 {
                let first = node.first as usize;
                let members = &self.order[first..first + node.count as usize];
                let boxes = members
                    .iter()
                    .map(|&k| rounded_outwards(bounds(k), self.origin));
                boxes.reduce(Box32::union)
            } else {
                let child = |k: usize| self.nodes[node.first as usize + k];
                let [left, right] =
                    [child(0), child(1)].map(|node| Box32::new(node.low, node.high));
                Some(left.union(right))
            };
            let Some(around) = around else { break };
            let node = &mut self.nodes[index];
            (node.low, node.high) = (around.low(), around.high());
            if index == 0 {
                break;
            }
            index = places.parents[index] as usize;
        }
        self.places = Some(places);
    }

    fn find_places(&self) -> Places {
        let last = self.order.iter().max().map_or(0, |&last| last as usize + 1);
        let mut places = Places {
            leaves: vec![0; last],
            parents: vec![0; self.nodes.len()],
        };
        for (index, node) in (0..).zip(&self.nodes) {
            let first = node.first as usize;
            if node.count > 0 {
                for &member in &self.order[first..first + node.count as usize] {
                    places.leaves[member as usize] = index;
                }
            } else {
                places.parents[first..first + 2].fill(index);
            }
        }
        places
    }
}

/// How many boxes the middle is found by.
const SAMPLE: usize = 1021;

/// Where most boxes are: along each axis the median of their centres, or of those of a sample. The centre of everything may be far
/// from all of them but one, where float32 could not tell the others apart. At least one box is not empty.
fn middle(boxes: &[Bounds]) -> DVec3 {
    let filled = || boxes.iter().filter(|bounds| !bounds.is_empty());
    let step = filled().count().div_ceil(SAMPLE).max(1);
    let sample: Vec<DVec3> = filled().step_by(step).map(Bounds::centre).collect();
    let median = |axis: usize| {
        let mut along: Vec<f64> = sample.iter().map(|centre| centre[axis]).collect();
        let half = along.len() / 2;
        *along.select_nth_unstable_by(half, f64::total_cmp).1
    };
    DVec3::new(median(0), median(1), median(2))
}

fn rounded_outwards(bounds: Bounds, origin: DVec3) -> Box32 {
    let [low, high] = outwards(bounds, origin);
    Box32::new(low, high)
}

impl From<BinaryNode> for Node {
    fn from(node: BinaryNode) -> Self {
        Self {
            low: node.bounds.low(),
            high: node.bounds.high(),
            first: node.first,
            count: node.count,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::build::binary::SAH_DEPTH;
    use crate::geometry::Ray;

    fn depth(bvh: &Bvh) -> usize {
        let mut deepest = 0;
        let mut stack = vec![(0_u32, 1_usize)];
        while let Some((index, depth)) = stack.pop() {
            let node = bvh.nodes[index as usize];
            deepest = deepest.max(depth);
            if node.count == 0 {
                stack.extend([(node.first, depth + 1), (node.first + 1, depth + 1)]);
            }
        }
        deepest
    }

    #[test]
    fn identical_boxes_make_a_balanced_tree() {
        let bounds = Bounds::of([DVec3::ZERO, DVec3::ONE]);
        let bvh = Bvh::build(20_000, |_| bounds, Bvh::OBJECTS);
        assert_eq!(bvh.order.len(), 20_000);
        assert!(depth(&bvh) <= 16, "{}", depth(&bvh));
    }

    /// Sizes that shrink by a constant factor make the heuristic peel off one box after the other.
    #[test]
    fn no_geometry_makes_the_tree_deeper_than_the_stack() {
        let spiral = |k: u32| {
            let x = libm::pow(0.7, f64::from(k % 250));
            Bounds::of([DVec3::splat(x), DVec3::splat(x * 1.01)])
        };
        let bvh = Bvh::build(50_000, spiral, Bvh::OBJECTS);
        assert!(depth(&bvh) <= SAH_DEPTH as usize + 32, "{}", depth(&bvh));
    }

    #[test]
    fn the_tree_is_the_same_for_any_number_of_threads() {
        let bounds = |k: u32| {
            let x = DVec3::new(f64::from(k % 1009), f64::from(k % 997), f64::from(k % 89));
            Bounds::of([x, x + DVec3::splat(f64::from(k % 13))])
        };
        let trees = [1, 2, 7].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| Bvh::build(100_000, bounds, Bvh::OBJECTS))
        });
        for tree in &trees[1..] {
            assert_eq!(tree.nodes, trees[0].nodes);
            assert_eq!(tree.order, trees[0].order);
        }
    }

    /// A box at 1e8 left float32 steps of 8 for all the others, so that they were one to every ray.
    #[test]
    fn one_box_far_away_does_not_blur_the_others() {
        let bounds = |k: u32| {
            let low = match k {
                0 => DVec3::ZERO,
                5000 => DVec3::new(1e8, -1e8, 1e8),
                _ => DVec3::new(f64::from(k % 100), f64::from(k / 100), 0.0),
            };
            Bounds::of([low, low + 0.9])
        };
        let bvh = Bvh::build(10_000, bounds, Bvh::OBJECTS);
        let mut stack = Vec::new();
        for k in (1..10_000).step_by(37).filter(|&k| k != 5000) {
            let start = bounds(k).centre() + DVec3::new(0.0, 0.0, 9.0);
            let mut walk = bvh.walk(&Ray::new(start, DVec3::NEG_Z), &mut stack);
            let met: Vec<u32> =
                std::iter::from_fn(|| walk.next(f64::INFINITY, &mut stack)).collect();
            assert!(
                met.contains(&k) && met.len() <= MOST_IN_LEAF,
                "{k}: {met:?}"
            );
            let mut candidates = 0;
            bvh.any_overlapping(bounds(k), &mut Vec::new(), |_| {
                candidates += 1;
                false
            });
            assert!(candidates <= 4 * MOST_IN_LEAF, "{k}: {candidates}");
        }
        let mut walk = bvh.walk(
            &Ray::new(bounds(5000).centre() + 9.0, -DVec3::ONE),
            &mut stack,
        );
        assert!(std::iter::from_fn(|| walk.next(f64::INFINITY, &mut stack)).any(|k| k == 5000));
    }

    /// Wherever the origin is, also where float32 has no digit left for a box, or the distance leaves its range.
    #[test]
    fn boxes_far_from_the_origin_are_rounded_outwards() {
        for scale in [1e-50, 1e-30, 1.0, 1e8, 1e30, 1e50, 1e300] {
            for k in 0..200 {
                let x = scale * (1.0 + f64::from(k) / 7.0);
                let low = DVec3::new(x, -x, x / 3.0);
                let bounds = Bounds::of([low, low + 0.01 * f64::from(k % 3)]);
                for origin in [DVec3::ZERO, DVec3::splat(0.1), -low, DVec3::splat(-1e20)] {
                    let [a, b] = outwards(bounds, origin).map(|end| end.map(f64::from));
                    // The difference is rounded here too.
                    let low = (bounds.low - origin).map(f64::next_down);
                    let high = (bounds.high - origin).map(f64::next_up);
                    assert!(DVec3::from(a).cmple(low).all(), "{bounds:?} {origin}");
                    assert!(high.cmple(DVec3::from(b)).all(), "{bounds:?} {origin}");
                }
            }
        }
    }

    #[test]
    fn empty_boxes_are_left_out() {
        let bvh = Bvh::build(
            3,
            |k| {
                if k == 1 {
                    Bounds::of([DVec3::ONE])
                } else {
                    Bounds::EMPTY
                }
            },
            0.0,
        );
        assert_eq!(bvh.order, [1]);
        assert!(Bvh::build(0, |_| Bounds::EMPTY, 0.0).nodes.is_empty());
    }
}
