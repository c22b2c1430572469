//! The builder: binned surface area heuristic, top down, in parallel.
//!
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE Symposium on Interactive
//! Ray Tracing 2007. Nothing depends on the number of threads: the bins are sums of integers and unions
//! of boxes, whose order does not matter, and the forks follow the sizes alone.

use rayon::prelude::*;

use super::Bvh;
use super::bvh::Node;
use crate::geometry::{Bounds, DVec3};

/// From this depth on ranges are halved: geometry can make the heuristic peel off one box at a time.
pub(super) const SAH_DEPTH: usize = 64;
const BINS: usize = 16;
const LEAF: usize = 4;
/// Below this a range is built by one thread.
const FORK: usize = 8192;
/// How many boxes one task takes of a large range.
const CHUNK: usize = 65_536;

/// A box relative to the local origin, and whose it is.
#[derive(Clone, Copy)]
struct Item {
    low: [f32; 3],
    high: [f32; 3],
    index: u32,
}

/// A range's nodes: its root, and all others with `first` counted from their own start.
struct Subtree {
    root: Node,
    nodes: Vec<Node>,
}

pub(super) fn build(count: u32, bounds: impl Fn(u32) -> Bounds + Sync, slack: f64) -> Bvh {
    let all = (0..count)
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(&bounds)
        .reduce(|| Bounds::EMPTY, Bounds::union);
    if all.is_empty() {
        return Bvh {
            origin: DVec3::ZERO,
            extent: 0.0,
            slack,
            nodes: Vec::new(),
            order: Vec::new(),
        };
    }
    let origin = all.centre();
    let mut items: Vec<Item> = (0..count)
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(|index| (index, bounds(index)))
        .filter(|(_, bounds)| !bounds.is_empty())
        .map(|(index, bounds)| Item {
            low: rounded_down(bounds.low - origin),
            high: rounded_up(bounds.high - origin),
            index,
        })
        .collect();
    let Subtree { root, nodes } = subtree(&mut items, 0, 0);
    let shifted = nodes.into_iter().map(|node| shift(node, 1));
    let nodes: Vec<Node> = std::iter::once(shift(root, 1)).chain(shifted).collect();
    let order = items.into_iter().map(|item| item.index).collect();
    Bvh {
        origin,
        extent: (all.high - origin).max(origin - all.low).max_element(),
        slack,
        nodes,
        order,
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding is what this is for"
)]
fn rounded_down(point: DVec3) -> [f32; 3] {
    point.to_array().map(|x| (x as f32).next_down())
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding is what this is for"
)]
fn rounded_up(point: DVec3) -> [f32; 3] {
    point.to_array().map(|x| (x as f32).next_up())
}

/// The same node after its subtree moved by `offset`.
fn shift(node: Node, offset: u32) -> Node {
    if node.count == 0 {
        Node {
            first: node.first + offset,
            ..node
        }
    } else {
        node
    }
}

fn subtree(items: &mut [Item], start: u32, depth: usize) -> Subtree {
    let mut nodes = Vec::new();
    if items.len() < FORK {
        let root = append(items, start, depth, &mut nodes);
        return Subtree { root, nodes };
    }
    let around = around(items);
    let middle = split(items, depth);
    let (left, right) = items.split_at_mut(middle);
    let (left, right) = rayon::join(
        || subtree(left, start, depth + 1),
        || subtree(right, start + index(middle), depth + 1),
    );
    let left_at = 2;
    let right_at = 2 + index(left.nodes.len());
    nodes.reserve_exact(2 + left.nodes.len() + right.nodes.len());
    nodes.extend([shift(left.root, left_at), shift(right.root, right_at)]);
    nodes.extend(left.nodes.into_iter().map(|node| shift(node, left_at)));
    nodes.extend(right.nodes.into_iter().map(|node| shift(node, right_at)));
    Subtree {
        root: inner(around, 0),
        nodes,
    }
}

/// Appends the nodes below a range's root; the recursion ends, because from [`SAH_DEPTH`] on it halves.
fn append(items: &mut [Item], start: u32, depth: usize, nodes: &mut Vec<Node>) -> Node {
    let (low, high) = around(items);
    if items.len() <= LEAF {
        return Node {
            low,
            high,
            first: start,
            count: index(items.len()),
        };
    }
    let middle = split(items, depth);
    let (left, right) = items.split_at_mut(middle);
    let at = nodes.len();
    let placeholder = inner((low, high), 0);
    nodes.extend([placeholder, placeholder]);
    nodes[at] = append(left, start, depth + 1, nodes);
    nodes[at + 1] = append(right, start + index(middle), depth + 1, nodes);
    inner((low, high), index(at))
}

fn inner((low, high): ([f32; 3], [f32; 3]), first: u32) -> Node {
    Node {
        low,
        high,
        first,
        count: 0,
    }
}

/// Counts stay below 2^32: there are at most two nodes for each item, and items have an `i32` identifier.
fn index(count: usize) -> u32 {
    u32::try_from(count).expect("identifiers are signed 32-bit")
}

fn around(items: &[Item]) -> ([f32; 3], [f32; 3]) {
    let one = |items: &[Item]| {
        items
            .iter()
            .fold(([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), |all, item| {
                union(all, (item.low, item.high))
            })
    };
    if items.len() < CHUNK {
        return one(items);
    }
    items
        .par_chunks(CHUNK)
        .map(one)
        .reduce(|| ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), union)
}

fn union(a: ([f32; 3], [f32; 3]), b: ([f32; 3], [f32; 3])) -> ([f32; 3], [f32; 3]) {
    (
        std::array::from_fn(|k| a.0[k].min(b.0[k])),
        std::array::from_fn(|k| a.1[k].max(b.1[k])),
    )
}

/// Reorders a range so that it falls into two parts, and returns where the second one starts.
fn split(items: &mut [Item], depth: usize) -> usize {
    let half = items.len() / 2;
    if depth >= SAH_DEPTH {
        return half;
    }
    let Some(grid) = Grid::new(items) else {
        return half;
    };
    let bins = grid.fill(items);
    let Some((axis, plane)) = cheapest(&bins) else {
        return half;
    };
    let middle = partition(items, |item| grid.bin(item, axis) < plane);
    if middle == 0 || middle == items.len() {
        half
    } else {
        middle
    }
}

fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) -> usize {
    let (mut low, mut high) = (0, items.len());
    while low < high {
        if is_left(&items[low]) {
            low += 1;
        } else {
            high -= 1;
            items.swap(low, high);
        }
    }
    low
}

#[derive(Clone, Copy)]
struct Bin {
    count: u32,
    bounds: ([f32; 3], [f32; 3]),
}

type Bins = [[Bin; BINS]; 3];

const NO_BINS: Bins = [[Bin {
    count: 0,
    bounds: ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]),
}; BINS]; 3];

/// How the middles of a range's boxes fall into bins along each axis.
struct Grid {
    low: [f32; 3],
    scale: [f32; 3],
}

impl Grid {
    /// `None` when all middles are at one point.
    fn new(items: &[Item]) -> Option<Self> {
        let one = |items: &[Item]| {
            items
                .iter()
                .fold(([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), |all, item| {
                    let middle = middle(item);
                    union(all, (middle, middle))
                })
        };
        let (low, high) = if items.len() < CHUNK {
            one(items)
        } else {
            items
                .par_chunks(CHUNK)
                .map(one)
                .reduce(|| ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), union)
        };
        // A scale of zero puts everything into one bin, which leaves nothing to split along that axis.
        let scale: [f32; 3] = std::array::from_fn(|k| {
            let scale = BINS as f32 / (high[k] - low[k]);
            if scale.is_finite() { scale } else { 0.0 }
        });
        (scale != [0.0; 3]).then_some(Self { low, scale })
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast of a float saturates"
    )]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        let place = (middle(item)[axis] - self.low[axis]) * self.scale[axis];
        (place as usize).min(BINS - 1)
    }

    fn fill(&self, items: &[Item]) -> Bins {
        let one = |items: &[Item]| {
            let mut bins = NO_BINS;
            for item in items {
                for (axis, bins) in bins.iter_mut().enumerate() {
                    let bin = &mut bins[self.bin(item, axis)];
                    bin.count += 1;
                    bin.bounds = union(bin.bounds, (item.low, item.high));
                }
            }
            bins
        };
        if items.len() < CHUNK {
            return one(items);
        }
        items.par_chunks(CHUNK).map(one).reduce(|| NO_BINS, merge)
    }
}

#[expect(
    clippy::large_types_passed_by_value,
    reason = "the form of a rayon reduction"
)]
fn merge(mut a: Bins, b: Bins) -> Bins {
    for (a, b) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        *a = Bin {
            count: a.count + b.count,
            bounds: union(a.bounds, b.bounds),
        };
    }
    a
}

/// Twice the middle: the factor cancels.
fn middle(item: &Item) -> [f32; 3] {
    std::array::from_fn(|k| item.low[k] + item.high[k])
}

/// The axis, and the first bin of the right side, with the lowest expected cost; on a tie the first.
fn cheapest(bins: &Bins) -> Option<(usize, usize)> {
    let mut best = (f64::INFINITY, None);
    for (axis, bins) in bins.iter().enumerate() {
        let mut right_costs = [0.0; BINS];
        let mut right = NO_BINS[0][0];
        for k in (1..BINS).rev() {
            right = Bin {
                count: right.count + bins[k].count,
                bounds: union(right.bounds, bins[k].bounds),
            };
            right_costs[k] = cost(&right);
        }
        let mut left = NO_BINS[0][0];
        for k in 1..BINS {
            left = Bin {
                count: left.count + bins[k - 1].count,
                bounds: union(left.bounds, bins[k - 1].bounds),
            };
            let cost = cost(&left) + right_costs[k];
            let splits = left.count > 0 && bins[k..].iter().any(|bin| bin.count > 0);
            if splits && cost < best.0 {
                best = (cost, Some((axis, k)));
            }
        }
    }
    best.1
}

fn cost(bin: &Bin) -> f64 {
    if bin.count == 0 {
        return 0.0;
    }
    // In float64: the product of two coordinates of 1e30 is nothing that float32 holds.
    let [x, y, z] =
        std::array::from_fn(|k| f64::from(bin.bounds.1[k]) - f64::from(bin.bounds.0[k]));
    (x * y + y * z + z * x) * f64::from(bin.count)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let bvh = Bvh::build(20_000, |_| bounds, Bvh::TRIANGLES);
        assert_eq!(bvh.order.len(), 20_000);
        assert!(depth(&bvh) <= 14, "{}", depth(&bvh));
    }

    /// Sizes that shrink by a constant factor make the heuristic peel off one box after the other.
    #[test]
    fn no_geometry_makes_the_tree_deeper_than_the_stack() {
        let spiral = |k: u32| {
            let x = libm::pow(0.7, f64::from(k % 250));
            Bounds::of([DVec3::splat(x), DVec3::splat(x * 1.01)])
        };
        let bvh = Bvh::build(50_000, spiral, Bvh::TRIANGLES);
        assert!(depth(&bvh) <= SAH_DEPTH + 32, "{}", depth(&bvh));
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
            pool.install(|| Bvh::build(100_000, bounds, Bvh::TRIANGLES))
        });
        for tree in &trees[1..] {
            assert_eq!(tree.nodes, trees[0].nodes);
            assert_eq!(tree.order, trees[0].order);
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
