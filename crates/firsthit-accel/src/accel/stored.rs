//! The arrays of a tree, and the assembly of a tree from untrusted arrays.
//!
//! Traversals index nodes, leaves and triangles by what nodes and leaves say, and continue for as
//! long as there are children. So what is read must be a tree whose every index is there:
//!
//! 1. Each node but the root is the child of exactly one node, which stands before it. So no
//!    traversal visits a node twice.
//! 2. No node is deeper than a traversal's stack allows.
//! 3. Each child that is a leaf, each leaf's part of the order, each corner's vertex and each
//!    triangle of the order is there.
//!
//! 4. A leaf has a triangle, and its vertices are in the cube from -1 to 1, as rasterization takes
//!    for granted.
//!
//! Boxes are not checked: wrong ones make wrong answers and no more.

use super::mesh_tree::MeshTree;
use super::meshlet::{MOST_LEAVES, Meshlet};
use super::node::{LEAF, Node};
use super::space::Space;
use super::traverse::stack::LEVELS;
use crate::geometry::DVec3;
use crate::memory::{self, Storage};
use crate::parallel;
use crate::shape::{Meshes, are_below};
use crate::simd::LANES;

/// The arrays of a tree as they are written.
#[derive(Debug)]
#[doc(hidden)]
pub struct TreeArrays<'a> {
    pub nodes: &'a [Node],
    pub leaves: &'a [Meshlet],
    pub order: &'a [u32],
    pub copies: &'a [[u32; 2]],
}

/// The parts that a tree is assembled from.
#[derive(Debug)]
#[doc(hidden)]
pub struct TreeParts {
    pub nodes: Storage<Node>,
    pub leaves: Storage<Meshlet>,
    pub order: Storage<u32>,
    pub copies: Storage<[u32; 2]>,
    pub facts: TreeFacts,
}

/// The facts about a tree that its arrays do not hold.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct TreeFacts {
    pub is_exact: bool,
    pub is_welded: bool,
    pub cost: f64,
}

impl MeshTree {
    /// The arrays of the tree.
    #[doc(hidden)]
    pub fn arrays(&self) -> TreeArrays<'_> {
        TreeArrays {
            nodes: &self.nodes,
            leaves: &self.leaves,
            order: &self.order,
            copies: &self.copies,
        }
    }

    /// The facts beside the arrays.
    #[doc(hidden)]
    pub fn facts(&self) -> TreeFacts {
        TreeFacts { is_exact: self.is_exact, is_welded: self.is_welded, cost: self.cost }
    }

    /// The tree over `mesh` that has these parts; see [the module](self). Checked by all threads of
    /// the current rayon pool.
    ///
    /// # Errors
    ///
    /// In words, what is wrong.
    #[doc(hidden)]
    pub fn from_parts(mesh: Meshes<'_>, parts: TreeParts) -> Result<Self, &'static str> {
        let TreeParts { nodes, leaves, order, copies, facts } = parts;
        let triangles = mesh.count();
        let space = if nodes.is_empty() {
            if !leaves.is_empty() || order.len() != triangles {
                return Err("a tree without nodes has leaves, or not all triangles");
            }
            Space { origin: DVec3::ZERO, scale: 1.0, unscale: 1.0 }
        } else {
            Space::new(mesh).ok_or("a tree is over a mesh that is out of range")?
        };
        if leaves.len() > MOST_LEAVES {
            return Err("a tree has too many leaves");
        }
        check_nodes(&nodes, leaves.len())?;
        let is_whole = |leaf: &Meshlet| is_whole(leaf, order.len());
        if !parallel::all(leaves.chunks(4096), |leaves| leaves.iter().all(is_whole)) {
            return Err("a leaf has a triangle or a vertex that is not there");
        }
        if !are_below(&order, triangles) || !are_below(copies.as_flattened(), triangles) {
            return Err("a tree has a triangle that is not there");
        }
        if !copies.is_sorted() {
            return Err("a tree's copies are out of order");
        }
        Ok(Self {
            space,
            is_exact: facts.is_exact,
            is_welded: facts.is_welded,
            nodes,
            leaves,
            order,
            copies,
            present: None,
            children_left: None,
            cost: facts.cost,
            is_quick: false,
        })
    }
}

/// See points 1 and 2 of [the module](self), and the first of 3.
fn check_nodes(nodes: &[Node], leaves: usize) -> Result<(), &'static str> {
    const NO_ROOM: &str = "there is no memory to check a tree";
    // The level of each node that is a child of one before it.
    let mut levels: Vec<u8> = memory::filled(nodes.len(), 0).map_err(|_| NO_ROOM)?;
    if let Some(root) = levels.first_mut() {
        *root = 1;
    }
    for (k, node) in nodes.iter().enumerate() {
        let level = levels[k];
        if level == 0 {
            return Err("a node of a tree has no parent before it");
        }
        if usize::from(level) > LEVELS {
            return Err("a tree is too deep");
        }
        for child in node.children {
            let index = (child & !LEAF) as usize;
            if child & LEAF != 0 {
                if index >= leaves {
                    return Err("a node has a leaf that is not there");
                }
                continue;
            }
            match levels.get_mut(index) {
                Some(of_child) if *of_child == 0 && index > k => *of_child = level + 1,
                _ => return Err("a node has a child that is not there, or another's"),
            }
        }
    }
    Ok(())
}

/// Whether a leaf has triangles, which stand within an order of that length, its corners are lanes,
/// and its vertices in the cube.
fn is_whole(leaf: &Meshlet, order: usize) -> bool {
    let count = leaf.filled.trailing_ones();
    let corners = leaf.corners.as_flattened();
    let largest = corners.iter().fold(0, |all, corner| all | corner);
    let vertices = leaf.vertices.as_flattened();
    count > 0
        && u32::from(leaf.filled).checked_shr(count).unwrap_or(0) == 0
        // A sum that 32 bits may not hold.
        && u64::from(leaf.first) + u64::from(count) <= order as u64
        && usize::from(largest) < LANES
        && vertices.iter().fold(true, |all, x| all & (x.abs() <= 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Block;
    use crate::shape::{Mesh, Positions};
    use std::sync::Arc;

    fn mesh() -> Mesh {
        let side = 30_u32;
        let point = |k: u32| [f64::from(k % side), f64::from(k / side), f64::from(k * 7 % 5)];
        let squares = (0..side * side).filter(|k| k % side + 1 < side && k / side + 1 < side);
        let cells = squares.flat_map(|a| [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]);
        Mesh::new(Positions::compact((0..side * side).map(point).collect()), cells.collect())
            .unwrap()
    }

    fn shared<T: bytemuck::Pod>(values: &[T]) -> Storage<T> {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        let block = Arc::new(Block::read(bytes, bytes.len()).unwrap());
        Storage::part(&block, 0..bytes.len()).unwrap()
    }

    fn parts(tree: &MeshTree) -> TreeParts {
        TreeParts {
            nodes: shared(&tree.nodes),
            leaves: shared(&tree.leaves),
            order: shared(&tree.order),
            copies: shared(&tree.copies),
            facts: tree.facts(),
        }
    }

    #[test]
    fn a_tree_survives_being_taken_apart() {
        let mesh = mesh();
        let tree = MeshTree::build(&mesh);
        let again = MeshTree::from_parts((&mesh).into(), parts(&tree)).unwrap();
        assert_eq!(format!("{again:?}"), format!("{tree:?}"));
        assert!(again.nodes.is_shared());
    }

    /// A change to nodes, leaves and order.
    type Change<'a> = &'a dyn Fn(&mut [Node], &mut [Meshlet], &mut [u32]);

    /// Each change makes an index out of range, a loop, a node with two parents, or one with none.
    #[test]
    fn what_is_no_tree_is_refused() {
        let mesh = mesh();
        let tree = MeshTree::build(&mesh);
        let (nodes, leaves, order) =
            (tree.nodes.to_vec(), tree.leaves.to_vec(), tree.order.to_vec());
        assert!(nodes.len() > 4);
        let refused = |change: Change<'_>| {
            let mut changed = (nodes.clone(), leaves.clone(), order.clone());
            change(&mut changed.0, &mut changed.1, &mut changed.2);
            let changed = TreeParts {
                nodes: changed.0.into(),
                leaves: changed.1.into(),
                order: changed.2.into(),
                ..parts(&tree)
            };
            MeshTree::from_parts((&mesh).into(), changed).unwrap_err()
        };
        let inner = |nodes: &[Node]| {
            let is_inner = |k: &usize| nodes[0].children[*k] & LEAF == 0;
            (0..LANES).find(is_inner).unwrap()
        };
        let last = u32::try_from(nodes.len()).unwrap();
        for child in [0, last, 3 * last] {
            let why = refused(&|nodes, _, _| {
                let k = inner(nodes);
                nodes[0].children[k] = child;
            });
            assert_eq!(why, "a node has a child that is not there, or another's");
        }
        refused(&|nodes, _, _| {
            let k = inner(nodes);
            nodes[0].children[k] = LEAF;
        });
        refused(&|nodes, leaves, _| {
            nodes[1].children[0] = LEAF | u32::try_from(leaves.len()).unwrap();
        });
        refused(&|_, leaves, order| leaves[3].first = u32::try_from(order.len()).unwrap());
        refused(&|_, leaves, _| leaves[3].first = u32::MAX);
        refused(&|_, leaves, _| leaves[3].filled = 5);
        refused(&|_, leaves, _| leaves[3].filled = 0);
        for wrong in [1.01, -2.0, 3e38, f32::INFINITY, f32::NAN] {
            refused(&|_, leaves, _| leaves[3].vertices[2][15] = wrong);
        }
        refused(&|_, leaves, _| leaves[3].corners[1][2] = 16);
        refused(&|_, _, order| order[7] = 2 * 29 * 29);
    }

    #[test]
    fn a_tree_that_is_deeper_than_a_stack_is_refused() {
        let mesh = mesh();
        let tree = MeshTree::build(&mesh);
        let chain = |length: u32| {
            let node = |k: u32| {
                let mut node = Node::EMPTY;
                if k + 1 < length {
                    node.children[0] = k + 1;
                }
                node
            };
            let nodes = (0..length).map(node).collect();
            let parts = TreeParts { nodes, ..parts(&tree) };
            MeshTree::from_parts((&mesh).into(), parts).map(drop)
        };
        let most = u32::try_from(LEVELS).unwrap();
        assert_eq!(chain(most), Ok(()));
        assert_eq!(chain(most + 1), Err("a tree is too deep"));
    }
}
