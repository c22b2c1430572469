//! From a binary tree to one of 16-wide nodes.
//!
//! Wald, Benthin and Boulos, "Getting Rid of Packets", IEEE Symposium on Interactive Ray Tracing 2008: of the
//! children gathered so far, the one with the largest surface is replaced by its own two, until sixteen are
//! there. (They weigh costs; with leaves as large as these, the largest surface does as well.)

use super::build::BinaryNode;
use crate::memory;
use crate::simd::LANES;

/// How many children a node has at most.
pub(super) const WIDTH: usize = LANES;
/// Marks a child that is a leaf.
pub(super) const LEAF: u32 = 1 << 31;

/// Boxes side by side, and what is in them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// The boxes' ends: low x, high x, low y, high y, low z, high z. Of a child that is not there the low end
    /// is at plus infinity and the high end at minus infinity, which no ray passes.
    pub(super) planes: [[f32; WIDTH]; 6],
    /// The index of a node or, with [`LEAF`], of a leaf.
    pub(super) children: [u32; WIDTH],
}

/// The wide nodes, and each leaf's range of the order: where it starts, and how many triangles it has.
pub(super) struct Wide {
    pub(super) nodes: Vec<Node>,
    pub(super) ranges: Vec<(u32, u32)>,
}

const EMPTY: Node = Node {
    planes: [
        [f32::INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
        [f32::INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
        [f32::INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
    ],
    children: [LEAF; WIDTH],
};

/// The wide tree of a binary one, whose root is first; children stand behind their parents.
pub(super) fn collapse(binary: &[BinaryNode]) -> Wide {
    let mut wide = Wide {
        nodes: vec![EMPTY],
        ranges: Vec::new(),
    };
    // Binary nodes to be made wide, and the places for them.
    let mut open = vec![(0_u32, 0_usize)];
    while let Some((root, at)) = open.pop() {
        let mut node = EMPTY;
        for (k, child) in gather(binary, root).enumerate() {
            let BinaryNode {
                bounds,
                first,
                count,
            } = binary[child as usize];
            for axis in 0..3 {
                node.planes[2 * axis][k] = bounds.low()[axis];
                node.planes[2 * axis + 1][k] = bounds.high()[axis];
            }
            node.children[k] = if count > 0 {
                wide.ranges.push((first, count));
                LEAF | index(wide.ranges.len() - 1)
            } else {
                wide.nodes.push(EMPTY);
                open.push((child, wide.nodes.len() - 1));
                index(wide.nodes.len() - 1)
            };
        }
        wide.nodes[at] = node;
    }
    let nodes = memory::copy(&wide.nodes);
    Wide { nodes, ..wide }
}

/// The children of the wide node in place of a binary one: itself if it is a leaf.
fn gather(binary: &[BinaryNode], root: u32) -> impl Iterator<Item = u32> {
    let mut children = [root; WIDTH];
    let mut areas = [f64::NEG_INFINITY; WIDTH];
    let area = |child: u32| {
        let node = &binary[child as usize];
        if node.count > 0 {
            f64::NEG_INFINITY
        } else {
            node.bounds.half_area()
        }
    };
    areas[0] = area(root);
    let mut count = 1;
    while count < WIDTH {
        let (largest, &size) = areas[..count]
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(b.1))
            .unwrap_or((0, &f64::NEG_INFINITY));
        if size == f64::NEG_INFINITY {
            break;
        }
        let first = binary[children[largest] as usize].first;
        (children[largest], children[count]) = (first, first + 1);
        (areas[largest], areas[count]) = (area(first), area(first + 1));
        count += 1;
    }
    children.into_iter().take(count)
}

/// There are fewer nodes than triangles, and of these at most `i32::MAX`.
fn index(count: usize) -> u32 {
    u32::try_from(count).expect("fewer than triangles")
}
