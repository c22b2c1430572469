//! Makes the nodes over leaves that stand along a curve.
//!
//! 1. Make nodes of neighbouring leaves, cut where the curve leaves the largest cube: the lowest
//!    ones, which are most of a tree. A leaf that is large beside the others stays alone: every ray
//!    near it would visit its neighbours' node too.
//! 2. Build a tree over those and the large leaves, and collapse it, as the full build does over
//!    all leaves.
//!
//! Pantaleoni and Luebke, "HLBVH: Hierarchical LBVH Construction for Real-Time Ray Tracing", High
//! Performance Graphics 2010.

use std::ops::Range;

use super::binary::{self, Binary, Primitives};
use super::binned_sah::{Block, Box32, Item};
use super::collapse;
use super::reinsert::reinsert;
use crate::accel::node::{LEAF, Node, WIDTH};
use crate::memory;

/// A leaf as a node knows it, and its place on the curve.
#[derive(Clone, Copy)]
pub(super) struct LeafOnCurve {
    pub(super) bounds: Box32,
    /// The size of the cube between it and the leaf before: the number of bits of
    /// [`gap`](super::morton::Curve::gap).
    pub(super) gap: u32,
}

/// The number of items of a `run` of neighbours that belong together: more than half of them, up to
/// the largest of the gaps before the others and before the item after the run; of equal gaps the
/// last.
pub(super) fn cut(run: usize, gap: impl Fn(usize) -> u32) -> usize {
    let places = run / 2 + 1..=run;
    places.max_by_key(|&k| gap(k)).unwrap_or(run)
}

/// The nodes over leaves, the root first, children after their parents. The index of a leaf is that
/// in `leaves`. Those above the half surface `large` are large.
pub(super) fn nodes(leaves: &[LeafOnCurve], large: f64) -> Vec<Node> {
    let is_large = |leaf: &LeafOnCurve| leaf.bounds.half_area() > large;
    let mut groups = Vec::new();
    let mut at = 0;
    while at < leaves.len() {
        let next = &leaves[at..(at + WIDTH).min(leaves.len())];
        let run = next.iter().position(is_large);
        let count = match run {
            Some(run) => run.max(1),
            None if at + next.len() == leaves.len() => next.len(),
            None => cut(WIDTH, |k| leaves[at + k].gap),
        };
        groups.push(at..at + count);
        at += count;
    }
    let lowest = |group: &Range<usize>| {
        let mut node = Node::EMPTY;
        for (k, leaf) in group.clone().enumerate() {
            node.set_child_box(k, leaves[leaf].bounds);
            node.children[k] = LEAF | index(leaf);
        }
        node
    };
    if let [all] = &groups[..] {
        return vec![lowest(all)];
    }
    let item = |(group, k): (&Range<usize>, u32)| {
        let boxes = leaves[group.clone()].iter().map(|leaf| leaf.bounds);
        Item::new(boxes.fold(Box32::EMPTY, Box32::union), k)
    };
    let mut items: Vec<Item> = groups.iter().zip(0..).map(item).collect();
    let Binary { nodes: binary, order } = binary::binary(&mut items, &Groups);
    let upper = collapse::collapse(reinsert(binary, || false), || false);
    // Of groups of several leaves, whose nodes come after those above.
    let mut place = index(upper.nodes.len());
    let child = |group: &Range<usize>| {
        if group.len() == 1 {
            return LEAF | index(group.start);
        }
        place += 1;
        place - 1
    };
    let places: Vec<u32> = groups.iter().map(child).collect();
    let mut nodes = memory::room(place as usize);
    nodes.extend(upper.nodes);
    for node in &mut nodes {
        for k in 0..WIDTH {
            let child = node.children[k];
            if child & LEAF != 0 && node.child_box(k).is_some() {
                let (first, _) = upper.ranges[(child & !LEAF) as usize];
                node.children[k] = places[order[first as usize] as usize];
            }
        }
    }
    nodes.extend(groups.iter().filter(|group| group.len() > 1).map(lowest));
    nodes
}

/// Lowest nodes and large leaves, of which a leaf of the tree over them is one.
struct Groups;

impl Primitives for Groups {
    fn block(&self) -> Block {
        Block(0)
    }

    fn is_leaf(&self, items: &[Item]) -> bool {
        items.len() == 1
    }
}

/// Converts a count of triangles, which is at most `i32::MAX`.
pub(super) fn index(count: usize) -> u32 {
    u32::try_from(count).expect("fewer than triangles")
}
