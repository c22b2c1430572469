//! Makes a binary tree better: takes subtrees out, and puts each where it enlarges the boxes least.
//!
//! 1. Of all nodes take a twentieth, those whose parents are most larger than they are: the others
//!    have little to gain.
//! 2. For each, find the node beside which it is best put: from its parent up to the root, and down
//!    into the sibling of each node on the way, as long as that can still gain more than the best
//!    place so far (branch and bound). All threads search in the tree as it is.
//! 3. Carry out the moves, those that gain most first. One that touches a node of a move before it
//!    is left out.
//! 4. Do that three times at most.
//!
//! Bittner, Hapala and Havran, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies",
//! Computer Graphics Forum 32 (1), 2013; Meister and Bittner, "Parallel Reinsertion for Bounding
//! Volume Hierarchy Optimization", Computer Graphics Forum 37 (2), 2018. It departs in step 1, and
//! in that a move must gain the subtree's own surface: smaller gains are lost again where nodes of
//! sixteen children are made. Equal gains are in the order of the nodes, so the tree is the same
//! for any number of threads.

use super::binary::{BinaryNode, DEEPEST};
use crate::memory;
use crate::parallel;

const ROUNDS: usize = 3;
/// The inverse of the share of nodes for which a better place is searched.
const ONE_OF: usize = 20;
/// The most nodes that a search looks at. Where everything overlaps it would look at all.
const MOST_VISITS: usize = 64;
/// The number of searches in one task.
const TASK: usize = 512;

/// The tree with better places for some of its subtrees; for fewer when it is stopped. The leaves
/// are the same.
pub(super) fn reinsert(nodes: Vec<BinaryNode>, is_stopped: impl Fn() -> bool) -> Vec<BinaryNode> {
    let mut tree = Tree::new(&nodes);
    for _ in 0..ROUNDS {
        let moves = tree.moves();
        if moves.is_empty() || is_stopped() {
            break;
        }
        tree.carry_out(&moves);
    }
    tree.in_order().unwrap_or(nodes)
}

struct Tree {
    /// Children stand side by side, in no order else.
    nodes: Vec<BinaryNode>,
    /// The parent of each node; the root is its own.
    parents: Vec<u32>,
}

/// A subtree that is to be the sibling of `beside`, and by how much half surfaces become less.
#[derive(Clone, Copy)]
struct Move {
    root: u32,
    beside: u32,
    gain: f64,
}

/// Children stand at 1 and 2, at 3 and 4, and so on.
fn sibling(node: u32) -> u32 {
    ((node - 1) ^ 1) + 1
}

impl Tree {
    fn new(nodes: &[BinaryNode]) -> Self {
        let mut parents = memory::room(nodes.len());
        parents.resize(nodes.len(), 0);
        for (node, k) in nodes.iter().zip(0..).filter(|(node, _)| node.count == 0) {
            parents[node.first as usize..][..2].fill(k);
        }
        Self { nodes: memory::copy(nodes), parents }
    }

    fn node(&self, node: u32) -> BinaryNode {
        self.nodes[node as usize]
    }

    fn parent(&self, node: u32) -> u32 {
        self.parents[node as usize]
    }

    fn surface(&self, node: u32) -> f64 {
        self.node(node).bounds.half_area()
    }

    /// The best move of each subtree that may gain most, where there is one; those that gain most
    /// first.
    fn moves(&self) -> Vec<Move> {
        let excess = |node: u32| self.surface(self.parent(node)) - self.surface(node);
        let roots = (0..).zip(&self.nodes).skip(1).map(|(root, _)| root);
        let mut worst: Vec<(f64, u32)> = roots.map(|root| (excess(root), root)).collect();
        let count = worst.len().div_ceil(ONE_OF);
        if count == 0 {
            return Vec::new();
        }
        let by_excess = |a: &(f64, u32), b: &(f64, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
        worst.select_nth_unstable_by(count - 1, by_excess);
        worst.truncate(count);
        let mut moves = parallel::gather(worst.chunks(TASK), |roots| {
            let moves = roots.iter().map(|&(_, root)| self.best_move(root));
            moves.flatten().collect()
        });
        moves.sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.root.cmp(&b.root)));
        moves
    }

    fn best_move(&self, root: u32) -> Option<Move> {
        let bounds = self.node(root).bounds;
        let own = bounds.half_area();
        let parent = self.parent(root);
        let mut best = Move { root, beside: 0, gain: own };
        // Gained by taking it out, less what putting it below the node would enlarge above that.
        let mut gained = self.surface(parent);
        // The node on the way up, and the box around what is left below it.
        let mut way = parent;
        let mut left = self.node(sibling(root)).bounds;
        let mut visits = 0;
        let mut open = Vec::new();
        while way != 0 {
            let beside = sibling(way);
            way = self.parent(way);
            open.push((gained, beside));
            while let Some((gained, beside)) = open.pop() {
                if gained - own <= best.gain || visits == MOST_VISITS {
                    continue;
                }
                visits += 1;
                let other = self.node(beside);
                let gain = gained - other.bounds.union(bounds).half_area();
                if gain > best.gain {
                    best = Move { root, beside, gain };
                }
                if other.count == 0 {
                    let gained = gain + other.bounds.half_area();
                    open.extend([(gained, other.first), (gained, other.first + 1)]);
                }
            }
            left = left.union(self.node(beside).bounds);
            gained += self.surface(way) - left.half_area();
        }
        (best.beside != 0).then_some(best)
    }

    fn carry_out(&mut self, moves: &[Move]) {
        let mut is_touched = vec![false; self.nodes.len()];
        for &Move { root, beside, .. } in moves {
            let parents = [self.parent(root), self.parent(beside)];
            let touched = [root, sibling(root), parents[0], beside, parents[1]];
            if touched.iter().any(|&node| is_touched[node as usize]) {
                continue;
            }
            for node in touched {
                is_touched[node as usize] = true;
            }
            self.put(root, beside);
        }
    }

    /// Moves a node beside another: its sibling replaces its parent, and `beside` takes the
    /// sibling's place.
    fn put(&mut self, root: u32, beside: u32) {
        let (place, parent) = (sibling(root), self.parent(root));
        let (left, other) = (self.node(place), self.node(beside));
        self.nodes[parent as usize] = left;
        self.nodes[place as usize] = other;
        self.nodes[beside as usize] = BinaryNode { first: root.min(place), count: 0, ..other };
        for (node, at) in [(left, parent), (other, place)] {
            if node.count == 0 {
                self.parents[node.first as usize..][..2].fill(at);
            }
        }
        self.parents[root as usize] = beside;
        self.parents[place as usize] = beside;
        self.fit(beside);
        self.fit(parent);
    }

    /// Fits the boxes from a node up to the root.
    fn fit(&mut self, mut node: u32) {
        loop {
            let BinaryNode { first, count, .. } = self.node(node);
            if count == 0 {
                let around = self.node(first).bounds.union(self.node(first + 1).bounds);
                self.nodes[node as usize].bounds = around;
            }
            if node == 0 {
                return;
            }
            node = self.parent(node);
        }
    }

    /// The nodes as [`Binary`](super::binary::Binary) has them; `None` where the tree has become
    /// too deep.
    fn in_order(&self) -> Option<Vec<BinaryNode>> {
        let mut nodes = memory::room(self.nodes.len());
        nodes.extend(self.nodes.first());
        // Places of nodes whose children are to come, and their depths.
        let mut open = vec![(0_usize, 0_u32)];
        while let Some((at, depth)) = open.pop() {
            let BinaryNode { first, count, .. } = *nodes.get(at)?;
            if count == 0 {
                if depth == DEEPEST {
                    return None;
                }
                let place = nodes.len();
                nodes[at].first = u32::try_from(place).ok()?;
                nodes.extend([self.node(first), self.node(first + 1)]);
                open.extend([(place + 1, depth + 1), (place, depth + 1)]);
            }
        }
        Some(nodes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::build::binned_sah::Box32;

    /// A small box at a place along a line.
    fn leaf(number: u32, place: f32) -> BinaryNode {
        BinaryNode {
            bounds: Box32::new([place, 0.0, 0.0], [place + 1.0, 1.0, 1.0]),
            first: number,
            count: 1,
        }
    }

    /// A tree over leaves, where `first` chooses the number of leaves in the first part of each
    /// node.
    fn tree(leaves: &[BinaryNode], first: &mut impl FnMut(usize) -> usize) -> Vec<BinaryNode> {
        let mut nodes = vec![leaves[0]];
        let mut open = vec![(0, leaves)];
        while let Some((at, leaves)) = open.pop() {
            let around = leaves.iter().map(|leaf| leaf.bounds);
            let place = nodes.len();
            nodes[at] = match leaves {
                [leaf] => *leaf,
                _ => BinaryNode {
                    bounds: around.fold(Box32::EMPTY, Box32::union),
                    first: u32::try_from(place).unwrap(),
                    count: 0,
                },
            };
            if leaves.len() > 1 {
                let (left, right) = leaves.split_at(first(leaves.len()));
                nodes.extend([left[0], right[0]]);
                open.extend([(place + 1, right), (place, left)]);
            }
        }
        nodes
    }

    fn surfaces(nodes: &[BinaryNode]) -> f64 {
        nodes.iter().map(|node| node.bounds.half_area()).sum()
    }

    fn leaves(nodes: &[BinaryNode]) -> Vec<u32> {
        let leaves = nodes.iter().filter(|node| node.count == 1);
        let mut leaves: Vec<u32> = leaves.map(|leaf| leaf.first).collect();
        leaves.sort_unstable();
        leaves
    }

    #[test]
    fn a_subtree_goes_to_its_neighbours() {
        // Two of 99 here stand among those far away, and the other way round.
        let mut places: Vec<f32> =
            (0..200).map(|k| k as f32 + if k < 100 { 0.0 } else { 1e4 }).collect();
        places.swap(50, 150);
        places.swap(20, 120);
        let all: Vec<_> = (0..).zip(&places).map(|(k, &place)| leaf(k, place)).collect();
        let sorted = {
            let mut all = all.clone();
            all.sort_by(|a, b| a.bounds.low()[0].total_cmp(&b.bounds.low()[0]));
            tree(&all, &mut |count| count / 2)
        };
        let nodes = tree(&all, &mut |count| count / 2);
        let better = reinsert(nodes.clone(), || false);
        assert!(
            surfaces(&better) < 1.1 * surfaces(&sorted),
            "{} {}",
            surfaces(&better),
            surfaces(&sorted)
        );
        assert!(surfaces(&nodes) > 2.0 * surfaces(&sorted));
    }

    #[test]
    fn leaves_stay_and_boxes_are_around_them() {
        let mut state = 1_u64;
        let mut random = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize % below
        };
        for count in [1, 2, 3, 4, 5, 40, 3000] {
            let all: Vec<_> = (0..count).map(|k| leaf(k, random(1000) as f32)).collect();
            let nodes = tree(&all, &mut |count| count / 4 + 1 + random(count / 2));
            let better = reinsert(nodes.clone(), || false);
            assert_eq!(leaves(&better), leaves(&nodes));
            assert!(surfaces(&better) <= surfaces(&nodes));
            let mut next = 1;
            let mut open = vec![0_usize];
            while let Some(at) = open.pop() {
                let BinaryNode { bounds, first, count } = better[at];
                if count == 0 {
                    // All below the first child stand before what is below the second.
                    assert_eq!(first as usize, next);
                    let both = better[next].bounds.union(better[next + 1].bounds);
                    assert!(bounds == both);
                    open.extend([next + 1, next]);
                    next += 2;
                }
            }
            assert_eq!(next, better.len());
        }
    }

    #[test]
    fn a_tree_that_is_too_deep_stays_as_it_is() {
        let all: Vec<_> = (0..200).map(|k| leaf(k, (k * 77 % 200) as f32)).collect();
        let nodes = tree(&all, &mut |_| 1);
        assert!(reinsert(nodes.clone(), || false) == nodes);
    }
}
