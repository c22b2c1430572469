//! Makes a tree of 16-wide nodes of a binary tree: the one with the smallest sum of the surfaces of
//! all wide nodes.
//!
//! As a multiple of the root's surface, that sum is how many nodes a ray visits on average.
//!
//! 1. From the leaves up: for each binary node and each number of places from 1 to 16, find what
//!    its subtree costs at least if it takes up that many places among the children of a wide node
//!    (dynamic programming). With one place it is a wide node itself.
//! 2. Keep how many of the places go to the first part ([`Plan`]).
//! 3. From the root down: follow the plans, and gather the children of each wide node.
//!
//! Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs", High Performance Graphics 2017. It departs in that leaves are those of the binary tree:
//! their cost depends on no choice, so only nodes count. Costs are float32, so a choice is the best
//! but for their rounding.

use super::binary::BinaryNode;
use super::binned_sah::Box32;
use crate::accel::node::{LEAF, Node, WIDTH};
use crate::geometry::arrays;
use crate::memory;

/// The wide nodes, and each leaf's range of the order: where it starts, and how many triangles it
/// has.
pub(super) struct Wide {
    pub(super) nodes: Vec<Node>,
    pub(super) ranges: Vec<(u32, u32)>,
}

/// The wide tree of a binary one, whose root is first; children stand behind their parents. Where
/// `is_stopped` says so, and it must say so from then on, the tree is not whole.
pub(super) fn collapse(binary: Vec<BinaryNode>, is_stopped: impl Fn() -> bool + Sync) -> Wide {
    /// The number of nodes between two questions whether to stop.
    const CHUNK: usize = 1 << 12;
    let plans = plans(&binary, &is_stopped);
    let mut wide = Wide { nodes: vec![Node::EMPTY], ranges: Vec::new() };
    // Binary nodes to be made wide, and the places for them.
    let mut open = vec![(0_u32, 0_usize)];
    while let Some((root, at)) = open.pop() {
        if at.is_multiple_of(CHUNK) && is_stopped() {
            break;
        }
        let mut node = Node::EMPTY;
        for (k, child) in gather(&binary, &plans, root).enumerate() {
            let BinaryNode { bounds, first, count } = binary[child as usize];
            node.set_child_box(k, bounds);
            node.children[k] = if count > 0 {
                wide.ranges.push((first, count));
                LEAF | index(wide.ranges.len() - 1)
            } else {
                wide.nodes.push(Node::EMPTY);
                open.push((child, wide.nodes.len() - 1));
                index(wide.nodes.len() - 1)
            };
        }
        wide.nodes[at] = node;
    }
    drop((binary, plans));
    let nodes = memory::copy(&wide.nodes);
    Wide { nodes, ..wide }
}

impl Node {
    /// The box of a child; `None` where there is none, whose low end is above the high one.
    pub(super) fn child_box(&self, child: usize) -> Option<Box32> {
        let end = |side: usize| arrays::from_fn::<_, 3>(|axis| self.planes[2 * axis + side][child]);
        (!self.is_vacant(child)).then(|| Box32::new(end(0), end(1)))
    }

    pub(super) fn set_child_box(&mut self, child: usize, bounds: Box32) {
        for axis in 0..3 {
            self.planes[2 * axis][child] = bounds.low()[axis];
            self.planes[2 * axis + 1][child] = bounds.high()[axis];
        }
    }
}

/// The plan of an inner node of a binary tree: the split of a wide node's places between its parts.
///
/// At index `p - 1`, for 2 to 16 places p among the children of a wide node: how many of them go to
/// its first part (the others go to the second), or 0 if it becomes a wide node itself, which takes
/// one place. With one place it always becomes one. So index 0 has something else: as a wide node,
/// how many of its own sixteen places go to its first part.
type Plan = [u8; WIDTH];

/// The cost of a subtree among the children of a wide node: the surfaces of the wide nodes in it.
struct Costs {
    /// The cost by the number of places that it may take up, less one.
    by_places: [f32; WIDTH],
    /// The number of leaves, or sixteen if more. With a place for each leaf the cost is 0.
    leaves: usize,
}

/// Whether to give up.
type IsStopped<'a> = dyn Fn() -> bool + Sync + 'a;

/// Fewer nodes are planned by one thread.
const FORK: usize = 16_384;

fn plans(binary: &[BinaryNode], is_stopped: &IsStopped<'_>) -> Vec<Plan> {
    let mut plans = memory::room(binary.len());
    plans.resize(binary.len(), [0; WIDTH]);
    if let Some((plan, below)) = plans.split_first_mut() {
        weigh(binary, 0, plan, below, is_stopped);
    }
    plans
}

/// Makes the plans of a node and of those `below` it, which stand together. The recursion is no
/// deeper than the tree.
fn weigh(
    binary: &[BinaryNode],
    node: u32,
    plan: &mut Plan,
    below: &mut [Plan],
    is_stopped: &IsStopped<'_>,
) -> Costs {
    let [left, right, below @ ..] = below else {
        return Costs::LEAF;
    };
    let BinaryNode { bounds, first, .. } = binary[node as usize];
    let of_right = &binary[first as usize + 1];
    let middle = match of_right.count {
        0 => (of_right.first - first) as usize - 2,
        _ => below.len(),
    };
    let is_large = below.len() >= FORK;
    if is_large && is_stopped() {
        return Costs::LEAF;
    }
    let (below_left, below_right) = below.split_at_mut(middle);
    let mut by_left = || weigh(binary, first, left, below_left, is_stopped);
    let mut by_right = || weigh(binary, first + 1, right, below_right, is_stopped);
    let (left, right) =
        if is_large { rayon::join(by_left, by_right) } else { (by_left(), by_right()) };
    Costs::join(&left, &right, surface(bounds), plan)
}

/// The cost of a wide node: its surface and a little more, so that of boxes without a surface fewer
/// nodes are cheaper too.
#[expect(
    clippy::cast_possible_truncation,
    reason = "of two that cost nearly the same, either will do"
)]
fn surface(bounds: Box32) -> f32 {
    bounds.half_area() as f32 + 1e-30
}

impl Costs {
    const LEAF: Self = Self { by_places: [0.0; WIDTH], leaves: 1 };

    /// The costs of a node with two parts; its plan goes to `plan`.
    fn join(left: &Self, right: &Self, surface: f32, plan: &mut Plan) -> Self {
        let leaves = (left.leaves + right.leaves).min(WIDTH);
        let mut by_places = [0.0; WIDTH];
        for places in 2..=WIDTH {
            // With more places than leaves there is nothing to gain.
            let fewest = places.saturating_sub(right.leaves).clamp(1, left.leaves);
            let mut best = (f32::INFINITY, fewest);
            for of_left in fewest..=left.leaves.min(places - 1) {
                let of_right = places - of_left;
                let cost = left.by_places[of_left - 1] + right.by_places[of_right - 1];
                if cost < best.0 {
                    best = (cost, of_left);
                }
            }
            by_places[places - 1] = best.0;
            plan[places - 1] = u8::try_from(best.1).expect("at most sixteen");
        }
        let whole = surface + by_places[WIDTH - 1];
        plan[0] = plan[WIDTH - 1];
        by_places[0] = whole;
        for places in 1..WIDTH {
            if whole < by_places[places] {
                by_places[places] = whole;
                plan[places] = 0;
            }
        }
        Self { by_places, leaves }
    }
}

/// The children of the wide node in place of a binary one: itself if it is a leaf.
fn gather(binary: &[BinaryNode], plans: &[Plan], root: u32) -> impl Iterator<Item = u32> {
    let mut children = [root; WIDTH];
    let mut count = 0;
    // Nodes and the places they may take up, of which there are sixteen in all.
    let mut open = [(root, WIDTH); WIDTH];
    let mut left = 1;
    while left > 0 {
        left -= 1;
        let (node, places) = open[left];
        let plan = &plans[node as usize];
        let of_first = match places {
            _ if node == root => plan[0],
            1 => 0,
            _ => plan[places - 1],
        };
        if of_first == 0 {
            children[count] = node;
            count += 1;
        } else {
            let first = binary[node as usize].first;
            let of_first = usize::from(of_first);
            open[left] = (first + 1, places - of_first);
            open[left + 1] = (first, of_first);
            left += 2;
        }
    }
    children.into_iter().take(count)
}

/// Converts a count of nodes, of which there are fewer than triangles: at most `i32::MAX`.
fn index(count: usize) -> u32 {
    u32::try_from(count).expect("fewer than triangles")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree over `leaves` leaves, split anywhere; appends the nodes below its root, which it
    /// returns.
    fn tree(
        random: &mut impl FnMut() -> u32,
        leaves: u32,
        below: &mut Vec<BinaryNode>,
    ) -> BinaryNode {
        let size = (random() % 1000) as f32;
        let bounds = Box32::new([0.0; 3], [size, 1.0, 0.0]);
        if leaves == 1 {
            return BinaryNode { bounds, first: 0, count: 1 };
        }
        let first = below.len();
        let nothing = BinaryNode { bounds, first: 0, count: 0 };
        below.extend([nothing, nothing]);
        let of_left = 1 + random() % (leaves - 1);
        below[first] = tree(random, of_left, below);
        below[first + 1] = tree(random, leaves - of_left, below);
        BinaryNode { bounds, first: index(first) + 1, count: 0 }
    }

    /// The least that the surfaces of wide nodes can come to: of all choices of inner nodes the
    /// cheapest of which none has more children than there is room for.
    fn least(binary: &[BinaryNode]) -> f64 {
        let inner: Vec<usize> = (1..binary.len()).filter(|&k| binary[k].count == 0).collect();
        let cost_of = |choice: u32| {
            let is_wide = |node: usize| {
                inner.iter().position(|&k| k == node).is_some_and(|k| choice >> k & 1 == 1)
            };
            let mut sum = 0.0;
            let mut open = vec![0];
            while let Some(root) = open.pop() {
                sum += binary[root].bounds.half_area();
                let first = binary[root].first as usize;
                let mut between = vec![first, first + 1];
                let mut children = 0;
                while let Some(node) = between.pop() {
                    if is_wide(node) {
                        open.push(node);
                        children += 1;
                    } else if binary[node].count > 0 {
                        children += 1;
                    } else {
                        let first = binary[node].first as usize;
                        between.extend([first, first + 1]);
                    }
                }
                if children > WIDTH {
                    return f64::INFINITY;
                }
            }
            sum
        };
        (0..1 << inner.len()).map(cost_of).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn no_other_choice_of_nodes_is_cheaper() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as u32
        };
        for leaves in [2, 15, 16, 17, 18, 18, 18, 18, 19, 19] {
            let mut below = Vec::new();
            let root = tree(&mut random, leaves, &mut below);
            let binary: Vec<_> = std::iter::once(root).chain(below).collect();
            let Wide { nodes, ranges } = collapse(binary.clone(), || false);
            assert_eq!(ranges.len(), leaves as usize);
            // All boxes begin at zero, and all but their width are equal.
            let mut surfaces = root.bounds.half_area();
            for (k, node) in nodes.iter().enumerate() {
                for child in 0..WIDTH {
                    let is_there = node.planes[0][child] <= node.planes[1][child];
                    if is_there && node.children[child] & LEAF == 0 {
                        assert!(node.children[child] as usize > k);
                        surfaces += f64::from(node.planes[1][child]);
                    }
                }
            }
            assert_eq!(surfaces, least(&binary), "{leaves} leaves");
        }
    }
}
