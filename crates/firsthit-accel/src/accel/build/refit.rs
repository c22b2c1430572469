//! Fits the tree of a mesh to vertices that have moved.
//!
//! 1. Fill the leaves anew with the same triangles (`fill.rs`). Give up where vertices that were in
//!    one place have parted, and are now too many for a leaf.
//! 2. From the last node to the first, which stands before its children: take each box from what is
//!    below it.
//! 3. Give up if a ray through the root now costs half as much again as when the tree was built.
//!
//! The caller then builds anew. Any tree gives the same answers.
//!
//! Lauterbach, Yoon, Tuft and Manocha, "RT-DEFORM: Interactive Ray Tracing of Dynamic Scenes using
//! BVHs", IEEE Symposium on Interactive Ray Tracing 2006. It departs in the measure of step 3,
//! which is the expected cost of the whole tree.

use rayon::prelude::*;

use super::binned_sah::Box32;
use super::weld::Sharing;
use crate::accel::mesh_tree::MeshTree;
use crate::accel::meshlet::Meshlet;
use crate::accel::node::{LEAF, Node, WIDTH};
use crate::accel::space::Space;
use crate::memory::{self, Storage};
use crate::parallel;
use crate::shape::Mesh;

/// The largest cost of a ray after refitting, as a multiple of the cost when the tree was built.
const WORST: f64 = 1.5;

impl MeshTree {
    /// The tree of `mesh`, which has the triangles of this tree's mesh, with their vertices
    /// elsewhere. `None` where the tree must be built anew: where a ray would cost half as much
    /// again as when it was built, where vertices of a leaf have parted and are too many for it,
    /// and where the tree left out triangles that were in one place.
    pub fn refit(&self, mesh: &Mesh) -> Option<Self> {
        // Where triangles were in one place, only the first of them is in the tree.
        let known = self.leaves.iter().map(|leaf| leaf.filled.count_ones());
        if self.nodes.is_empty() || known.sum::<u32>() as usize != mesh.triangles().len() {
            return None;
        }
        let space = Space::new(mesh.into())?;
        let points = space.points(mesh);
        let sharing =
            Sharing { triangles: mesh.triangles(), points: &points, is_welded: self.is_welded };
        let of_leaf = |leaf: &Meshlet| {
            let first = leaf.first as usize;
            &self.order[first..first + leaf.filled.count_ones() as usize]
        };
        let fits = |leaf: &Meshlet| sharing.fits(of_leaf(leaf).iter().copied());
        if !parallel::all(self.leaves.chunks(1024), |leaves| leaves.iter().all(fits)) {
            return None;
        }
        let leaf = |leaf: &Meshlet| Meshlet::new(&sharing, of_leaf(leaf), leaf.first);
        let mut leaves = memory::room(self.leaves.len());
        self.leaves.par_iter().with_min_len(1024).map(leaf).collect_into_vec(&mut leaves);
        let mut nodes = memory::copy(&self.nodes);
        // Children stand behind their parents.
        for k in (0..nodes.len()).rev() {
            for child in 0..WIDTH {
                if let Some(around) = around_child(&nodes, &leaves, &nodes[k], child) {
                    nodes[k].set_child_box(child, around);
                }
            }
        }
        let tree = Self {
            is_exact: space.is_exact(mesh, &points),
            is_welded: self.is_welded,
            space,
            nodes: nodes.into(),
            leaves: leaves.into(),
            order: memory::copy(&self.order).into(),
            copies: Storage::default(),
            present: None,
            children_left: None,
            cost: self.cost,
            is_quick: self.is_quick,
        };
        (tree.expected_cost() <= WORST * self.cost).then_some(tree)
    }

    /// See [`expected_visits`].
    pub(super) fn expected_cost(&self) -> f64 {
        expected_visits(&self.nodes)
    }
}

/// The expected number of nodes and leaves that a ray through the root's box meets: the sum of the
/// surfaces of their boxes, as shares of the root's. Goldsmith and Salmon, "Automatic Creation of
/// Object Hierarchies for Ray Tracing", IEEE Computer Graphics and Applications 7(5), 1987.
pub(super) fn expected_visits(nodes: &[Node]) -> f64 {
    let Some(root) = nodes.first() else {
        return 0.0;
    };
    let sum: f64 = nodes.iter().map(half_areas).sum();
    let all = boxes(root).reduce(Box32::union);
    sum / all.map_or(1.0, Box32::half_area).max(f64::MIN_POSITIVE)
}

/// The boxes of the children that a node has.
pub(super) fn boxes(node: &Node) -> impl Iterator<Item = Box32> {
    (0..WIDTH).filter_map(|child| node.child_box(child))
}

/// The box around what is now below a child; `None` for a child that is not there.
fn around_child(nodes: &[Node], leaves: &[Meshlet], node: &Node, child: usize) -> Option<Box32> {
    node.child_box(child)?;
    let index = node.children[child];
    if index & LEAF == 0 {
        return boxes(&nodes[index as usize]).reduce(Box32::union);
    }
    Some(leaves[(index & !LEAF) as usize].bounds())
}

/// Half the surfaces of a node's boxes.
fn half_areas(node: &Node) -> f64 {
    boxes(node).map(Box32::half_area).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::build::mesh::tests::apart;
    use crate::shape::Positions;

    fn sheet(side: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
        Mesh::sheet(side, |x, y| [x, y, height(x, y)])
    }

    fn is_around(tree: &MeshTree) -> bool {
        tree.nodes.iter().all(|node| {
            (0..WIDTH).all(|child| {
                around_child(&tree.nodes, &tree.leaves, node, child).is_none_or(|inner| {
                    let own = node.child_box(child);
                    own.map(|own| own.union(inner)) == own
                })
            })
        })
    }

    #[test]
    fn boxes_are_around_what_has_moved() {
        let flat = sheet(40, |_, _| 0.0);
        let built = MeshTree::build(&flat);
        let moved = sheet(40, |x, y| 0.3 * libm::sin(x) + 0.1 * y + 1e3);
        let refitted = built.refit(&moved).unwrap();
        assert_eq!(refitted.order, built.order);
        assert!(is_around(&built) && is_around(&refitted));
        assert!(refitted.expected_cost() >= MeshTree::build(&moved).cost);
        // Of the mesh as it was, the tree as it was.
        let same = refitted.refit(&flat).unwrap();
        assert_eq!((same.nodes, same.leaves), (built.nodes, built.leaves));
    }

    #[test]
    fn what_is_all_over_the_place_is_built_anew() {
        let built = MeshTree::build(&sheet(40, |_, _| 0.0));
        let scattered = sheet(40, |x, y| libm::fmod(7919.0 * x * x + 104_729.0 * y * x * y, 40.0));
        assert!(built.refit(&scattered).is_none());
    }

    /// Leaves that hold a vertex once for all that were in its place are no leaves when these part;
    /// that they do by so little that the tree would be as good as before.
    #[test]
    fn what_was_together_may_part() {
        let sheet = |lift: f64| sheet(40, |x, y| 0.1 * x * y + lift);
        let built = MeshTree::build(&apart(&sheet(0.0), 0.0));
        assert!(built.is_welded);
        let together = built.refit(&apart(&sheet(3.0), 0.0)).unwrap();
        assert!(is_around(&together));
        assert!(built.refit(&apart(&sheet(0.0), 1e-5)).is_none());
    }

    /// The tree has but one of two triangles that were in one place.
    #[test]
    fn what_was_left_out_is_not_forgotten() {
        let at = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
        let twice = |up: f64| {
            let positions = [at(0.0), at(up)].concat().into();
            let triangles = (0..40).map(|k| if k % 2 == 0 { [0, 1, 2] } else { [3, 4, 5] });
            Mesh::new(Positions::Double(positions), triangles.collect()).unwrap()
        };
        let built = MeshTree::build(&twice(0.0));
        assert!(built.refit(&twice(1.0)).is_none());
    }
}
