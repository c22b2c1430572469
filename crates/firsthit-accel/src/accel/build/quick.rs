//! Makes the leaves and nodes of a mesh's tree along a curve, in a fraction of the time of
//! `binary.rs` and `collapse.rs`.
//!
//! 1. Put the triangles in the order of a curve (`morton.rs`).
//! 2. Make leaves of neighbours on it: as many as fit, cut in their second half where the curve
//!    leaves the largest cube.
//! 3. Make the lowest nodes of neighbouring leaves in the same way, and a tree over those
//!    (`lowest.rs`).
//!
//! The full build makes leaves of triangles that are more than a leaf has room for in one cell of
//! the curve, as a small thing in a large scene and copies are, and of those that would be one
//! large leaf: a wall among the small things beside it.
//!
//! Lauterbach and others, "Fast BVH Construction on GPUs", Computer Graphics Forum 28 (2), 2009,
//! from which it departs in step 2: the hierarchy of cells would leave leaves half empty.

use super::binary::{self, Primitives};
use super::binned_sah::{Box32, Item};
use super::fill::Filling;
use super::lowest::{LeafOnCurve, cut, index, nodes};
use super::mesh::{Parts, Triangles};
use super::morton::Curve;
use super::weld::Sharing;
use crate::accel::meshlet::Meshlet;
use crate::accel::node::WIDTH;
use crate::memory;
use crate::parallel;

/// The number of triangles that one task makes leaves of. A leaf ends with them, so this shows in
/// the tree.
const PART: usize = 16_384;
/// The number of tasks whose leaves are joined at a time, while they are still in the caches.
const AT_ONCE: usize = 64;

/// The parts of a tree, the same for any number of threads.
pub(super) fn quick(triangles: &Triangles<'_>) -> Parts {
    let sharing = &triangles.sharing;
    let curve = Curve::new(sharing, triangles.around);
    let count = curve.keys().len();
    let triangles = &Triangles {
        large: triangles.large.min(large_beside_others(&curve, sharing)),
        ..*triangles
    };
    let mut order = memory::room(count);
    order.resize(count, 0);
    let (mut leaves, mut seen) = (Vec::new(), Vec::new());
    for (k, order) in order.chunks_mut(AT_ONCE * PART).enumerate() {
        if triangles.building.is_stopped() {
            return Parts::default();
        }
        let start = k * AT_ONCE * PART;
        let end = start + order.len();
        let parts = order.chunks_mut(PART).enumerate();
        let parts = parallel::map(parts, |(k, order)| {
            let mut part = CurveRange::new(&curve, sharing, start + k * PART, order);
            part.fill(triangles);
            (part.leaves, part.seen)
        });
        make_room(
            &mut leaves,
            parts.iter().map(|(leaves, _)| leaves.len()).sum(),
            count as f64 / end as f64,
        );
        for (own, own_seen) in parts {
            leaves.extend_from_slice(&own);
            seen.extend_from_slice(&own_seen);
        }
        triangles.building.advance((end - start) / 2);
    }
    drop(curve);
    if triangles.building.is_stopped() {
        return Parts::default();
    }
    Parts { nodes: nodes(&seen, triangles.large()), leaves, order }
}

/// The half surface from which on a leaf is large beside the others: eight times what runs of
/// neighbours on the curve have, the median of a sample. Neighbours may be of any size, and a large
/// one among small ones makes a large leaf of them.
fn large_beside_others(curve: &Curve, sharing: &Sharing<'_>) -> f64 {
    const TIMES: f64 = 8.0;
    const RUN: usize = 12;
    const SAMPLE: usize = 1021;
    let bounds = |&key: &u64| Box32::of(sharing.triangle(curve.triangle(key)));
    let surface = |keys: &[u64]| {
        let boxes = keys.iter().map(bounds);
        boxes.fold(Box32::EMPTY, Box32::union).half_area()
    };
    let step = curve.keys().len().div_ceil(SAMPLE);
    let runs = curve.keys().windows(RUN).step_by(step).map(surface);
    // Beside points and lines everything would be large.
    let mut surfaces: Vec<f64> = runs.filter(|&surface| surface > 0.0).collect();
    if surfaces.is_empty() {
        return f64::INFINITY;
    }
    let half = surfaces.len() / 2;
    TIMES * *surfaces.select_nth_unstable_by(half, f64::total_cmp).1
}

/// Makes room for `more` leaves, and for those that are to be expected after them: `times` is all
/// triangles over those so far.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a guess")]
fn make_room(leaves: &mut Vec<Meshlet>, more: usize, times: f64) {
    let needed = leaves.len() + more;
    if leaves.capacity() < needed {
        let mut all = memory::room((1.05 * times * needed as f64) as usize + 1);
        all.extend_from_slice(leaves);
        *leaves = all;
    }
}

/// A part of the triangles along the curve, of which leaves are made.
struct CurveRange<'a> {
    curve: &'a Curve,
    sharing: &'a Sharing<'a>,
    /// The place of the first triangle on the curve.
    start: usize,
    order: &'a mut [u32],
    leaves: Vec<Meshlet>,
    seen: Vec<LeafOnCurve>,
}

impl<'a> CurveRange<'a> {
    fn new(curve: &'a Curve, sharing: &'a Sharing<'a>, start: usize, order: &'a mut [u32]) -> Self {
        for (place, &key) in order.iter_mut().zip(&curve.keys()[start..]) {
            *place = curve.triangle(key);
        }
        Self {
            curve,
            sharing,
            start,
            leaves: Vec::with_capacity(order.len() / 8),
            seen: Vec::with_capacity(order.len() / 8),
            order,
        }
    }

    /// Makes leaves of all.
    fn fill(&mut self, triangles: &Triangles<'_>) {
        let mut at = 0;
        while at < self.order.len() {
            at += match self.in_one_cell(at) {
                some if some > WIDTH => self.push_parts(at, some, triangles),
                _ => self.push_run(at, triangles),
            };
        }
    }

    /// The [gap](Curve::gap) between a triangle and the one before it; the largest there is for the
    /// first.
    fn gap(&self, at: usize) -> u32 {
        let keys = self.curve.keys();
        let at = self.start + at;
        let before = at.checked_sub(1).map(|before| keys[before]);
        before.map_or(u64::BITS, |before| self.curve.gap(before, keys[at]))
    }

    /// The number of triangles from there on in one cell, if these are more than a leaf has; else
    /// 0.
    fn in_one_cell(&self, at: usize) -> usize {
        let keys = &self.curve.keys()[self.start..][..self.order.len()][at..];
        let is_same = |key: &u64| self.curve.gap(keys[0], *key) == 0;
        if keys.get(WIDTH).is_some_and(is_same) { keys.partition_point(is_same) } else { 0 }
    }

    /// Makes a leaf of the next triangles; returns their number.
    fn push_run(&mut self, at: usize, triangles: &Triangles<'_>) -> usize {
        let filling = Filling::new(self.sharing, &self.order[at..]);
        let run = filling.count();
        let count = if at + run == self.order.len() { run } else { cut(run, |k| self.gap(at + k)) };
        let leaf = filling.leaf(self.sharing, count, index(self.start + at));
        if leaf.bounds().half_area() > triangles.large() {
            return self.push_parts(at, count, triangles);
        }
        self.push(leaf, self.gap(at));
        count
    }

    /// Makes leaves of `count` triangles from `at` on, in an order of their own; returns their
    /// number.
    fn push_parts(&mut self, at: usize, count: usize, triangles: &Triangles<'_>) -> usize {
        let order = &mut self.order[at..at + count];
        let item = |&k: &u32| Item::new(Box32::of(self.sharing.triangle(k)), k);
        let mut items: Vec<Item> = order.iter().map(item).collect();
        let binary = binary::binary(&mut items, triangles);
        order.copy_from_slice(&binary.order);
        let mut gap = self.gap(at);
        for node in binary.nodes.iter().filter(|node| node.count > 0) {
            let first = at + node.first as usize;
            let own = &self.order[first..first + node.count as usize];
            let leaf = Meshlet::new(self.sharing, own, index(self.start + first));
            self.push(leaf, std::mem::take(&mut gap));
        }
        count
    }

    fn push(&mut self, leaf: Meshlet, gap: u32) {
        let bounds = leaf.bounds();
        self.seen.push(LeafOnCurve { bounds, gap });
        self.leaves.push(leaf);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::accel::mesh_tree::MeshTree;
    use crate::accel::node::LEAF;
    use crate::accel::traverse::stack::LEVELS;
    use crate::geometry::DVec3;
    use crate::shape::{Mesh, Positions};

    fn mesh(points: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh::new(Positions::compact(points), triangles).unwrap()
    }

    /// A number from 0 to below 1 that follows from `k`.
    fn random(k: u32) -> f64 {
        f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24)
    }

    /// A soup of `count` triangles of a size at the places of `place`.
    fn soup(count: u32, size: f64, place: impl Fn(u32) -> [f64; 3]) -> Mesh {
        let corners = |k: u32| {
            let at = place(k);
            let corner = |j: u32| {
                [0, 1, 2].map(|axis| at[axis as usize] + size * random(9 * k + 3 * j + axis))
            };
            [corner(0), corner(1), corner(2)]
        };
        let points = (0..count).flat_map(corners).collect();
        mesh(points, (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
    }

    /// The hard cases: one triangle, all in one point, all in one cell, much in one cell, copies,
    /// lines, large and far.
    fn meshes() -> Vec<Mesh> {
        let scattered = |k: u32| [random(k), random(k + 77), random(k + 555)];
        let corner = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let huge = |k: u32| scattered(k).map(|x| 1e30 * x);
        let far = |k: u32| scattered(k).map(|x| 1e9 + x);
        let crowd = |k: u32| {
            let scale = if k < 20_000 { 1e-7 } else { 1.0 };
            scattered(k).map(|x| scale * x)
        };
        vec![
            mesh(corner.to_vec(), vec![[0, 1, 2]]),
            mesh(corner.to_vec(), vec![[0, 1, 2]; 50_000]),
            mesh(vec![[3.0; 3]; 99], vec![[5, 7, 9]; 99]),
            mesh(vec![[0.0; 3]; 3], (0..400).map(|_| [0, 1, 2]).collect()),
            soup(40_000, 0.0, |k| [f64::from(k), 0.0, 0.0]),
            soup(40_000, 0.01, scattered),
            soup(40_000, 1e28, huge),
            soup(40_000, 1e-3, far),
            soup(21_000, 1e-9, crowd),
            soup(300, 2.0, scattered),
        ]
    }

    /// The number of levels, where each node and leaf has one parent, which stands before it, and
    /// is within the box there.
    fn levels(tree: &MeshTree) -> usize {
        let mut level = vec![0; tree.nodes.len()];
        let mut leaves = HashSet::new();
        level[0] = 1;
        for (k, node) in tree.nodes.iter().enumerate() {
            assert!(level[k] > 0, "node {k} has no parent");
            for child in 0..WIDTH {
                let Some(bounds) = node.child_box(child) else {
                    continue;
                };
                let index = (node.children[child] & !LEAF) as usize;
                let inner = if node.children[child] & LEAF != 0 {
                    assert!(leaves.insert(index));
                    tree.leaves[index].bounds()
                } else {
                    assert!(index > k && level[index] == 0);
                    level[index] = level[k] + 1;
                    let boxes = (0..WIDTH).filter_map(|child| tree.nodes[index].child_box(child));
                    boxes.fold(Box32::EMPTY, Box32::union)
                };
                assert!(bounds.union(inner) == bounds);
            }
        }
        assert_eq!(leaves.len(), tree.leaves.len());
        level.into_iter().max().unwrap_or(0)
    }

    #[test]
    fn every_triangle_is_in_one_leaf_or_a_copy() {
        for mesh in meshes() {
            let tree = MeshTree::build_quick(&mesh);
            assert!(levels(&tree) < LEVELS);
            let mut times = vec![0; mesh.triangles().len()];
            for leaf in &tree.leaves {
                let count = leaf.filled.count_ones() as usize;
                for &triangle in &tree.order[leaf.first as usize..][..count] {
                    times[triangle as usize] += 1;
                }
            }
            for [_, copy] in &tree.copies {
                times[*copy as usize] += 1;
            }
            assert!(times.iter().all(|&times| times == 1));
        }
    }

    #[test]
    fn copies_are_left_out() {
        let corner = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let tree = MeshTree::build_quick(&mesh(corner, vec![[0, 1, 2]; 5000]));
        assert_eq!((tree.leaves.len(), tree.copies.len()), (1, 4999));
    }

    #[test]
    fn leaves_and_nodes_are_half_full_at_least() {
        let side = 300;
        let point = |k: u32| [f64::from(k % side), f64::from(k / side), 3.0 * random(k / 7)];
        let cells = (0..side * side).filter(|k| k % side + 1 < side && k / side + 1 < side);
        let cells = cells.flat_map(|a| [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]);
        let tree =
            MeshTree::build_quick(&mesh((0..side * side).map(point).collect(), cells.collect()));
        let (nodes, leaves) = (tree.nodes.len() as f64, tree.leaves.len() as f64);
        assert!(tree.order.len() as f64 / leaves > 9.0);
        assert!((leaves + nodes - 1.0) / nodes > 9.0);
    }

    /// A tree of the fast build, refitted to moved vertices, still counts as one, and its own cost
    /// limits refits.
    #[test]
    fn it_is_fitted_as_others_are() {
        let place = |k: u32| [random(k), random(k + 77), random(k + 555)];
        let lifted = |k: u32| place(k).map(|x| x + 0.01 * DVec3::from(place(k)).length());
        let built = MeshTree::build_quick(&soup(5000, 0.01, place));
        let moved = built.refit(&soup(5000, 0.01, lifted)).unwrap();
        assert!(moved.is_quick() && levels(&moved) == levels(&built));
        assert!(built.refit(&soup(5000, 0.01, |k| place(k * k))).is_none());
    }
    /// A wall among small things beside it made a large leaf of them, and a large node of its
    /// neighbours.
    #[test]
    fn a_ray_does_not_pay_for_small_things_beside_a_wall() {
        let side = 101;
        let step = |k: u32| f64::from(k) / 100.0;
        let ground = |k: u32| [step(k % side), step(k / side), 0.02 * random(k / 7)];
        let wall = |k: u32| {
            let at = f64::from(k % 2);
            [[at, 0.0, 0.0], [at, 1.0, 0.0], [at, step(20 * k), 1.0]]
        };
        let points = (0..side * side).map(ground);
        let points: Vec<_> = points.chain((0..6).flat_map(wall)).collect();
        let cells = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
        let cells = cells.flat_map(|a| [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]);
        let walls = (0..6).map(|k| [0, 1, 2].map(|corner| side * side + 3 * k + corner));
        let mesh = mesh(points, cells.chain(walls).collect());
        let (quick, full) = (MeshTree::build_quick(&mesh), MeshTree::build(&mesh));
        assert!(quick.cost < 1.45 * full.cost, "{} {}", quick.cost, full.cost);
    }
}
