//! The builder: binned surface area heuristic, top down, in parallel.
//!
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE Symposium on Interactive
//! Ray Tracing 2007. Nothing depends on the number of threads: the bins are sums of integers and unions
//! of boxes, whose order does not matter, and the forks follow the sizes alone.

use rayon::prelude::*;

use super::Bvh;
use super::bins::{self, Block, Box32, Item, Split, around};
use super::bvh::Node;
use crate::geometry::{Bounds, DVec3};
use crate::memory;

/// From this depth on ranges are halved: geometry can make the heuristic peel off one box at a time.
pub(super) const SAH_DEPTH: u32 = 64;
const LEAF: usize = 4;
/// Below this a range is built by one thread.
const FORK: usize = 8192;
/// How many boxes one task makes.
pub(super) const CHUNK: usize = 65_536;

/// A box, and what is in it: `count` entries of the order from `first` on, or, when `count` is 0, the
/// two nodes from `first` on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BinaryNode {
    pub(super) bounds: Box32,
    pub(super) first: u32,
    pub(super) count: u32,
}

/// A binary tree: the root first, the children of a node side by side, after them all that is below the first, then all
/// that is below the second.
pub(super) struct Binary {
    pub(super) nodes: Vec<BinaryNode>,
    /// The items' indices, those of a leaf side by side.
    pub(super) order: Vec<u32>,
}

/// What a builder has to know about what it puts in order.
pub(super) trait Kind: Sync {
    /// How many items a ray tests at once.
    fn block(&self) -> Block;
    /// Whether items can be a leaf; one always can.
    fn is_leaf(&self, items: &[Item]) -> bool;
    /// Puts those in front that are not in the place of others, which win over them, and says how many they are.
    /// Asked only where no plane separates the middles.
    fn distinct(&self, items: &mut [Item]) -> usize {
        items.len()
    }
}

/// Boxes of which nothing else is known.
struct Boxes;

impl Kind for Boxes {
    fn block(&self) -> Block {
        Block(0)
    }

    fn is_leaf(&self, items: &[Item]) -> bool {
        items.len() <= LEAF
    }
}

/// The tree over `items`, which are put in order for it.
pub(super) fn binary(items: &mut [Item], kind: &impl Kind) -> Binary {
    let all = around(items);
    let Subtree { root, nodes } = subtree(items, all, [0, 0], kind);
    let mut order = memory::room(items.len());
    order.extend(items.iter().map(Item::index));
    Binary {
        nodes: std::iter::once(root)
            .chain(nodes)
            .map(|node| shift(node, 1))
            .collect(),
        order,
    }
}

/// A range's nodes: its root, and all others with `first` counted from their own start.
struct Subtree {
    root: BinaryNode,
    nodes: Vec<BinaryNode>,
}

pub(super) fn build(count: u32, bounds: impl Fn(u32) -> Bounds + Sync, slack: f64) -> Bvh {
    let indices = || (0..count).into_par_iter().with_min_len(CHUNK);
    let all = indices()
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
    let item = |index: u32| {
        let bounds = bounds(index);
        (!bounds.is_empty()).then(|| Item::new(rounded_outwards(bounds, origin), index))
    };
    let mut items: Vec<Item> = indices().filter_map(item).collect();
    let Binary { nodes, order } = binary(&mut items, &Boxes);
    Bvh {
        origin,
        extent: (all.high - origin).max(origin - all.low).max_element(),
        slack,
        nodes: nodes.into_iter().map(Node::from).collect(),
        order,
    }
}

/// A box around `bounds`, relative to `origin`: a whole float32 step wider, which covers the difference's
/// rounding too.
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding is what this is for"
)]
fn rounded_outwards(bounds: Bounds, origin: DVec3) -> Box32 {
    let single = |point: DVec3| (point - origin).to_array().map(|x| x as f32);
    Box32::new(
        single(bounds.low).map(f32::next_down),
        single(bounds.high).map(f32::next_up),
    )
}

/// The same node after its subtree moved by `offset`.
fn shift(node: BinaryNode, offset: u32) -> BinaryNode {
    if node.count == 0 {
        BinaryNode {
            first: node.first + offset,
            ..node
        }
    } else {
        node
    }
}

/// The tree over a range that starts at `start`, at a depth.
fn subtree(
    items: &mut [Item],
    around: Box32,
    [start, depth]: [u32; 2],
    kind: &impl Kind,
) -> Subtree {
    let mut nodes = Vec::new();
    if items.len() < FORK {
        let root = append(items, around, [start, depth], kind, &mut nodes);
        return Subtree { root, nodes };
    }
    let Some(parts) = split(items, depth, kind.block()) else {
        return match kind.distinct(items) {
            kept if kept < items.len() => subtree(&mut items[..kept], around, [start, depth], kind),
            _ => join(items, around, &halves(items), [start, depth], kind),
        };
    };
    join(items, around, &parts, [start, depth], kind)
}

/// The tree over the two parts of a range.
fn join(
    items: &mut [Item],
    around: Box32,
    parts: &Split,
    [start, depth]: [u32; 2],
    kind: &impl Kind,
) -> Subtree {
    let mut nodes = Vec::new();
    let (left, right) = items.split_at_mut(parts.middle);
    let right_start = start + index(parts.middle);
    let (left, right) = rayon::join(
        || subtree(left, parts.left, [start, depth + 1], kind),
        || subtree(right, parts.right, [right_start, depth + 1], kind),
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
fn append(
    items: &mut [Item],
    around: Box32,
    [start, depth]: [u32; 2],
    kind: &impl Kind,
    nodes: &mut Vec<BinaryNode>,
) -> BinaryNode {
    if kind.is_leaf(items) {
        return BinaryNode {
            count: index(items.len()),
            ..inner(around, start)
        };
    }
    let parts = match split(items, depth, kind.block()) {
        Some(parts) => parts,
        None => match kind.distinct(items) {
            kept if kept < items.len() => {
                return append(&mut items[..kept], around, [start, depth], kind, nodes);
            }
            _ => halves(items),
        },
    };
    let (left, right) = items.split_at_mut(parts.middle);
    let at = nodes.len();
    let placeholder = inner(around, 0);
    nodes.extend([placeholder, placeholder]);
    let right_start = start + index(parts.middle);
    nodes[at] = append(left, parts.left, [start, depth + 1], kind, nodes);
    nodes[at + 1] = append(right, parts.right, [right_start, depth + 1], kind, nodes);
    inner(around, index(at))
}

fn inner(bounds: Box32, first: u32) -> BinaryNode {
    BinaryNode {
        bounds,
        first,
        count: 0,
    }
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

/// Counts stay below 2^32: there are at most two nodes for each item, and items have an `i32` identifier.
fn index(count: usize) -> u32 {
    u32::try_from(count).expect("identifiers are signed 32-bit")
}

/// The two parts of a range, which is put in order for them; `None` where it has to be halved.
fn split(items: &mut [Item], depth: u32, block: Block) -> Option<Split> {
    (depth < SAH_DEPTH)
        .then(|| bins::split(items, block))
        .flatten()
}

fn halves(items: &[Item]) -> Split {
    let middle = items.len() / 2;
    let (left, right) = items.split_at(middle);
    Split {
        middle,
        left: around(left),
        right: around(right),
    }
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
        let bvh = Bvh::build(20_000, |_| bounds, Bvh::OBJECTS);
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
