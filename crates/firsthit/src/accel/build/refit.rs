//! Fits the tree of a mesh to vertices that have moved.
//!
//! 1. Fill the leaves anew with the same triangles (`fill.rs`). Give up where vertices that were in one place have
//!    parted, and are now too many for a leaf.
//! 2. From the last node to the first, which stands before its children: take each box from what is below it.
//! 3. Give up if a ray through the root now costs half as much again as when the tree was built.
//!
//! The caller then builds anew. Any tree gives the same answers.
//!
//! Lauterbach, Yoon, Tuft and Manocha, "RT-DEFORM: Interactive Ray Tracing of Dynamic Scenes using BVHs", IEEE
//! Symposium on Interactive Ray Tracing 2006. It departs in the measure of step 3, which is the expected cost of the
//! whole tree.

use rayon::prelude::*;

use super::weld::Sharing;
use crate::accel::mesh_tree::MeshTree;
use crate::accel::meshlet::Meshlet;
use crate::accel::node::{LEAF, Node};
use crate::accel::space::Space;
use crate::memory;
use crate::shape::Mesh;
use crate::simd::LANES;

/// How much more a ray may cost than when the tree was built.
const WORST: f64 = 1.5;

/// The low and the high end of a box along each axis.
type Ends = [[f32; 2]; 3];

impl MeshTree {
    /// The tree of `mesh`, which has the triangles of this tree's mesh, with their vertices elsewhere. `None` where the
    /// tree must be built anew: where a ray would cost half as much again as when it was built, where vertices of a leaf
    /// have parted and are too many for it, and where the tree left out triangles that were in one place.
    pub fn refit(&self, mesh: &Mesh) -> Option<Self> {
        // Where triangles were in one place, only the first of them is in the tree.
        let known = self.leaves.iter().map(|leaf| leaf.filled.count_ones());
        if self.nodes.is_empty() || known.sum::<u32>() as usize != mesh.triangles().len() {
            return None;
        }
        let space = Space::new(mesh)?;
        let points = space.points(mesh);
        let sharing = Sharing {
            triangles: mesh.triangles(),
            points: &points,
            is_welded: self.is_welded,
        };
        let of_leaf = |leaf: &Meshlet| {
            let first = leaf.first as usize;
            &self.order[first..first + leaf.filled.count_ones() as usize]
        };
        let fits = |leaf: &Meshlet| sharing.fits(of_leaf(leaf).iter().copied());
        if !self.leaves.par_iter().with_min_len(1024).all(fits) {
            return None;
        }
        let leaf = |leaf: &Meshlet| Meshlet::new(&sharing, of_leaf(leaf), leaf.first);
        let mut leaves = memory::room(self.leaves.len());
        self.leaves
            .par_iter()
            .with_min_len(1024)
            .map(leaf)
            .collect_into_vec(&mut leaves);
        let mut nodes = memory::copy(&self.nodes);
        // Children stand behind their parents.
        for k in (0..nodes.len()).rev() {
            for child in 0..LANES {
                if let Some(ends) = ends(&nodes, &leaves, &nodes[k], child) {
                    set(&mut nodes[k], child, ends);
                }
            }
        }
        let tree = Self {
            is_exact: space.is_exact(mesh, &points),
            is_welded: self.is_welded,
            space,
            nodes,
            leaves,
            order: memory::copy(&self.order),
            copies: Vec::new(),
            cost: self.cost,
        };
        (tree.expected_cost() <= WORST * self.cost).then_some(tree)
    }

    /// How many nodes and leaves a ray through the root's box meets on average: the sum of the surfaces of their boxes,
    /// as shares of the root's.
    pub(super) fn expected_cost(&self) -> f64 {
        let Some(root) = self.nodes.first() else {
            return 0.0;
        };
        let all = (0..LANES).filter(|&child| is_there(root, child));
        let all = all.map(|child| box_of(root, child)).reduce(union);
        let sum: f64 = self.nodes.iter().map(surfaces).sum();
        sum / all.map_or(1.0, surface).max(f64::MIN_POSITIVE)
    }
}

/// Whether a node has the child; of others the low end is above the high one.
fn is_there(node: &Node, child: usize) -> bool {
    node.planes[0][child] <= node.planes[1][child]
}

fn box_of(node: &Node, child: usize) -> Ends {
    [0, 1, 2].map(|axis| [0, 1].map(|side| node.planes[2 * axis + side][child]))
}

fn set(node: &mut Node, child: usize, ends: Ends) {
    for (axis, [low, high]) in ends.into_iter().enumerate() {
        node.planes[2 * axis][child] = low;
        node.planes[2 * axis + 1][child] = high;
    }
}

fn union(a: Ends, b: Ends) -> Ends {
    [0, 1, 2].map(|axis| [a[axis][0].min(b[axis][0]), a[axis][1].max(b[axis][1])])
}

/// The box around a child's own; `None` for one that is not there.
fn ends(nodes: &[Node], leaves: &[Meshlet], node: &Node, child: usize) -> Option<Ends> {
    if !is_there(node, child) {
        return None;
    }
    let index = node.children[child];
    if index & LEAF == 0 {
        let below = &nodes[index as usize];
        let all = (0..LANES).filter(|&child| is_there(below, child));
        return all.map(|child| box_of(below, child)).reduce(union);
    }
    // Unused lanes repeat a vertex.
    let leaf = &leaves[(index & !LEAF) as usize];
    let end = |values: &[f32; LANES]| {
        let first = values[0];
        let low = values.iter().copied().fold(first, f32::min);
        [low, values.iter().copied().fold(first, f32::max)]
    };
    Some(leaf.vertices.each_ref().map(end))
}

/// The surfaces of a node's boxes.
fn surfaces(node: &Node) -> f64 {
    let all = (0..LANES).filter(|&child| is_there(node, child));
    all.map(|child| surface(box_of(node, child))).sum()
}

/// Half of a box's surface.
fn surface(ends: Ends) -> f64 {
    let [x, y, z] = ends.map(|[low, high]| f64::from(high) - f64::from(low));
    x * y + y * z + z * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::build::mesh::tests::apart;
    use crate::shape::Positions;

    fn sheet(side: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
        let point = |k: u32| {
            let (x, y) = (f64::from(k % side), f64::from(k / side));
            [x, y, height(x, y)]
        };
        let positions = (0..side * side).map(point).collect();
        let cell = |k: u32| {
            let a = k / (side - 1) * side + k % (side - 1);
            [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]
        };
        let triangles = (0..(side - 1) * (side - 1)).flat_map(cell).collect();
        Mesh::new(Positions::Double(positions), triangles).unwrap()
    }

    fn is_around(tree: &MeshTree) -> bool {
        tree.nodes.iter().all(|node| {
            (0..LANES).all(|child| {
                ends(&tree.nodes, &tree.leaves, node, child)
                    .is_none_or(|inner| union(inner, box_of(node, child)) == box_of(node, child))
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
        let scattered = sheet(40, |x, y| {
            libm::fmod(7919.0 * x * x + 104_729.0 * y * x * y, 40.0)
        });
        assert!(built.refit(&scattered).is_none());
    }

    /// Leaves that hold a vertex once for all that were in its place are no leaves when these part; that they do by so
    /// little that the tree would be as good as before.
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
            let positions = [at(0.0), at(up)].concat();
            let triangles = (0..40).map(|k| if k % 2 == 0 { [0, 1, 2] } else { [3, 4, 5] });
            Mesh::new(Positions::Double(positions), triangles.collect()).unwrap()
        };
        let built = MeshTree::build(&twice(0.0));
        assert!(built.refit(&twice(1.0)).is_none());
    }
}
