//! The builder of binary trees: top down, by the surface area heuristic over bins, in parallel.
//!
//! 1. Make a leaf of a range of boxes if it fits one; part it where it is [large and mostly
//!    empty](parts_of_leaf).
//! 2. Split the range where a ray's expected cost is least (`binned_sah.rs`).
//! 3. Where no plane separates the boxes' middles, leave out items that are in the place of others,
//!    or halve the range.
//! 4. Build both parts, large ones by two threads.
//!
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE Symposium on
//! Interactive Ray Tracing 2007. It departs in step 3, and in that the tree does not depend on the
//! number of threads: bins are counts and unions of boxes, whose order does not matter, and ranges
//! are forked by their size alone.

use super::binned_sah::{self, Block, Box32, Item, Split, around};
use crate::memory;

/// The depth from which on ranges are halved. The heuristic alone can split off one box at a time,
/// and make a tree as deep as it has boxes.
pub(in crate::accel) const SAH_DEPTH: u32 = 64;
/// The largest depth of a tree: from [`SAH_DEPTH`] on the number of items, which is below 2^32, is
/// halved.
pub(super) const DEEPEST: u32 = SAH_DEPTH + 32;
/// Below this a range is built by one thread.
const FORK: usize = 8192;

/// A box, and what is in it: `count` entries of the order from `first` on, or, when `count` is 0,
/// the two nodes from `first` on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BinaryNode {
    pub(super) bounds: Box32,
    pub(super) first: u32,
    pub(super) count: u32,
}

/// A binary tree: the root first. The children of a node stand side by side; after them comes all
/// that is below the first, then all that is below the second.
pub(super) struct Binary {
    pub(super) nodes: Vec<BinaryNode>,
    /// The items' indices, those of a leaf side by side.
    pub(super) order: Vec<u32>,
}

/// The properties of the items that the builder needs.
pub(super) trait Primitives: Sync {
    /// The number of items that a ray tests at once.
    fn block(&self) -> Block;
    /// Whether items can be a leaf; one always can.
    fn is_leaf(&self, items: &[Item]) -> bool;
    /// The half surface from which on a leaf is large.
    fn large(&self) -> f64 {
        f64::INFINITY
    }
    /// Leaves out items that lose every tie to another in the same place: puts the others in front
    /// and returns their number. Called only for ranges that would be halved.
    fn distinct(&self, items: &mut [Item]) -> usize {
        items.len()
    }
    /// Told of items that a subtree has been built over.
    fn advance(&self, _items: usize) {}
    /// Whether to give up: what is built then is of no use.
    fn is_stopped(&self) -> bool {
        false
    }
}

/// The tree over `items`, which are put in order for it.
pub(super) fn binary(items: &mut [Item], primitives: &impl Primitives) -> Binary {
    let all = around(items);
    let Subtree { root, mut nodes } = subtree(items, all, [0, 0], primitives);
    let mut order = memory::room(items.len());
    order.extend(items.iter().map(Item::index));
    nodes.insert(0, root);
    for node in &mut nodes {
        *node = shift(*node, 1);
    }
    Binary { nodes, order }
}

/// The nodes of a range: its root, and all others, with `first` counted from the start of `nodes`.
struct Subtree {
    root: BinaryNode,
    nodes: Vec<BinaryNode>,
}

/// The node after its subtree has moved by `offset`.
fn shift(node: BinaryNode, offset: u32) -> BinaryNode {
    if node.count == 0 { BinaryNode { first: node.first + offset, ..node } } else { node }
}

/// The tree over a range that starts at `start`, at a depth.
fn subtree(
    items: &mut [Item],
    around: Box32,
    [start, depth]: [u32; 2],
    primitives: &impl Primitives,
) -> Subtree {
    let mut nodes = Vec::new();
    if primitives.is_stopped() {
        let root = inner(around, start);
        return Subtree { root, nodes };
    }
    if items.len() < FORK {
        let root = append(items, around, [start, depth], primitives, &mut nodes);
        primitives.advance(items.len());
        return Subtree { root, nodes };
    }
    let Some(parts) = split(items, depth, primitives.block()) else {
        return match primitives.distinct(items) {
            kept if kept < items.len() => {
                subtree(&mut items[..kept], around, [start, depth], primitives)
            }
            _ => join(items, around, &halves(items), [start, depth], primitives),
        };
    };
    join(items, around, &parts, [start, depth], primitives)
}

/// The tree over the two parts of a range.
fn join(
    items: &mut [Item],
    around: Box32,
    parts: &Split,
    [start, depth]: [u32; 2],
    primitives: &impl Primitives,
) -> Subtree {
    let mut nodes = Vec::new();
    let (left, right) = items.split_at_mut(parts.middle);
    let right_start = start + index(parts.middle);
    let (left, right) = rayon::join(
        || subtree(left, parts.left, [start, depth + 1], primitives),
        || subtree(right, parts.right, [right_start, depth + 1], primitives),
    );
    let left_at = 2;
    let right_at = 2 + index(left.nodes.len());
    nodes.reserve_exact(2 + left.nodes.len() + right.nodes.len());
    nodes.extend([shift(left.root, left_at), shift(right.root, right_at)]);
    nodes.extend(left.nodes.into_iter().map(|node| shift(node, left_at)));
    nodes.extend(right.nodes.into_iter().map(|node| shift(node, right_at)));
    Subtree { root: inner(around, 0), nodes }
}

/// Appends the nodes below a range's root, which it returns. The recursion ends, as ranges are
/// halved from [`SAH_DEPTH`] on.
fn append(
    items: &mut [Item],
    around: Box32,
    [start, depth]: [u32; 2],
    primitives: &impl Primitives,
    nodes: &mut Vec<BinaryNode>,
) -> BinaryNode {
    let is_leaf = primitives.is_leaf(items);
    let parts = if is_leaf {
        parts_of_leaf(items, around, depth, primitives)
    } else {
        split(items, depth, primitives.block())
    };
    let parts = match parts {
        Some(parts) => parts,
        None if is_leaf => {
            return BinaryNode { count: index(items.len()), ..inner(around, start) };
        }
        None => match primitives.distinct(items) {
            kept if kept < items.len() => {
                return append(&mut items[..kept], around, [start, depth], primitives, nodes);
            }
            _ => halves(items),
        },
    };
    let (left, right) = items.split_at_mut(parts.middle);
    let at = nodes.len();
    let placeholder = inner(around, 0);
    nodes.extend([placeholder, placeholder]);
    let right_start = start + index(parts.middle);
    nodes[at] = append(left, parts.left, [start, depth + 1], primitives, nodes);
    nodes[at + 1] = append(right, parts.right, [right_start, depth + 1], primitives, nodes);
    inner(around, index(at))
}

fn inner(bounds: Box32, first: u32) -> BinaryNode {
    BinaryNode { bounds, first, count: 0 }
}

/// Counts stay below 2^32: there are at most two nodes for each item, and items have an `i32`
/// identifier.
fn index(count: usize) -> u32 {
    u32::try_from(count).expect("identifiers are signed 32-bit")
}

/// The two parts of a range, which is put in order for them; `None` where it has to be halved.
fn split(items: &mut [Item], depth: u32, block: Block) -> Option<Split> {
    (depth < SAH_DEPTH).then(|| binned_sah::split(items, block)).flatten()
}

/// The two parts of a range that fits a leaf, where two leaves are better: floor and ceiling of a
/// room, whose one leaf every ray within the room would visit. The heuristic counts rays from
/// outside, and would keep them together. Rays that begin and end anywhere visit a box as often as
/// its volume and a quarter of its surface times their length say. Here they are as long as the
/// mean chord of the box around both parts, four times its volume by its surface. Aila, Karras and
/// Laine, "On Quality Metrics of Bounding Volume Hierarchies", High Performance Graphics 2013, tell
/// how far the surface alone is off.
fn parts_of_leaf(
    items: &mut [Item],
    around: Box32,
    depth: u32,
    primitives: &impl Primitives,
) -> Option<Split> {
    /// The most visits of two leaves, as a share of those of one.
    const MOST_VISITS: f64 = 0.9;
    if items.len() < 2 || around.half_area() < primitives.large() {
        return None;
    }
    let parts = split(items, depth, primitives.block())?;
    let share = |size: fn(Box32) -> f64| (size(parts.left) + size(parts.right)) / size(around);
    // A flat box has no volume, and is not parted: the share is not a number.
    let visits = 0.5 * (share(Box32::volume) + share(Box32::half_area));
    (visits < MOST_VISITS).then_some(parts)
}

fn halves(items: &[Item]) -> Split {
    let middle = items.len() / 2;
    let (left, right) = items.split_at(middle);
    Split { middle, left: around(left), right: around(right) }
}
