//! Makes the tree of a mesh.
//!
//! 1. Bring the vertices into the tree's space, as float32 (`space.rs`).
//! 2. Decide whether vertices in one place are one to a leaf (`weld.rs`).
//! 3. Build a binary tree over the triangles' boxes (`binary.rs`). A range is a leaf when it has at
//!    most sixteen triangles over at most sixteen vertices.
//! 4. Find better places for its large subtrees (`reinsert.rs`).
//! 5. Collapse it to nodes of sixteen children (`collapse.rs`).
//! 6. Fill the leaves (`fill.rs`).
//!
//! For few rays another build (`quick.rs`) takes the place of steps 3 to 6. Both end with:
//!
//! 7. List the copies: triangles that are in no leaf, since a lower one has the same corners and
//!    wins every tie.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;

use super::binary::{self, Binary, Primitives};
use super::binned_sah::{Block, Box32, Item};
use super::collapse::{self, Wide};
use super::quick;
use super::reinsert::reinsert;
use super::weld::Sharing;
use crate::accel::mesh_tree::MeshTree;
use crate::accel::meshlet::{MOST_LEAVES, Meshlet};
use crate::accel::node::{Node, WIDTH};
use crate::accel::space::{CHUNK, Space};
use crate::error::{Error, Result};
use crate::geometry::DVec3;
use crate::memory::{self, Storage};
use crate::shape::Mesh;
use crate::watch::Watch;

impl MeshTree {
    /// The tree of a mesh that is empty, has a coordinate beyond 1e90 ([`Space::new`]) or needs
    /// more than [`MOST_LEAVES`].
    fn without_nodes(mesh: &Mesh) -> Self {
        Self {
            space: Space { origin: DVec3::ZERO, scale: 1.0, unscale: 1.0 },
            is_exact: false,
            is_welded: false,
            nodes: Storage::default(),
            leaves: Storage::default(),
            order: (0..count(mesh.triangles().len())).collect(),
            copies: Storage::default(),
            present: None,
            children_left: None,
            cost: 0.0,
            is_quick: false,
        }
    }

    /// The tree over the triangles of `mesh`, by all threads of the current rayon pool, and the
    /// same for any number of them.
    pub fn build(mesh: &Mesh) -> Self {
        Self::build_by(mesh, full, &Building::new(&()))
    }

    /// Builds a tree as `watch` is told of each triangle. A quick one takes a third to a half of
    /// the time: it is not the best one, with equal answers. See `quick.rs`.
    ///
    /// # Errors
    ///
    /// [`Error::Interrupted`].
    #[doc(hidden)]
    pub fn build_watched(mesh: &Mesh, is_quick: bool, watch: &dyn Watch) -> Result<Self> {
        let building = Building::new(watch);
        let tree = Self {
            is_quick,
            ..Self::build_by(mesh, if is_quick { quick::quick } else { full }, &building)
        };
        building.end(mesh.triangles().len())?;
        Ok(tree)
    }

    fn build_by(mesh: &Mesh, build: fn(&Triangles<'_>) -> Parts, building: &Building<'_>) -> Self {
        /// The least surface of a large node, as a share of the root's.
        const LARGE: f64 = 0.01;
        let Some(space) = Space::new(mesh.into()).filter(|_| !mesh.triangles().is_empty()) else {
            return Self::without_nodes(mesh);
        };
        let points = space.points(mesh);
        let (sharing, vertices) = Sharing::new(mesh, &points);
        let bounds = mesh.bounds();
        let around = Box32::new(space.point(bounds.low), space.point(bounds.high));
        let Parts { nodes, leaves, order } = build(&Triangles {
            mesh,
            sharing,
            vertices,
            around,
            large: LARGE * around.half_area(),
            building,
        });
        if leaves.len() > MOST_LEAVES {
            return Self::without_nodes(mesh);
        }
        let mut tree = Self {
            is_exact: space.is_exact(mesh, &points),
            is_welded: sharing.is_welded,
            space,
            nodes: nodes.into(),
            copies: copies(mesh, &order, &leaves).into(),
            present: None,
            children_left: None,
            leaves: leaves.into(),
            order: order.into(),
            cost: 0.0,
            is_quick: false,
        };
        tree.cost = tree.expected_cost();
        tree
    }
}

/// The watch on a build.
pub(super) struct Building<'a> {
    watch: &'a dyn Watch,
    /// Once it was stopped it stays so, whatever the watch says later: trees are not whole.
    is_stopped: AtomicBool,
    /// The triangles that the watch was told of.
    told: AtomicUsize,
}

impl<'a> Building<'a> {
    pub(super) fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, is_stopped: AtomicBool::new(false), told: AtomicUsize::new(0) }
    }

    /// The share of the work on some triangles that is done now.
    pub(super) fn advance(&self, triangles: usize) {
        self.told.fetch_add(triangles, Relaxed);
        self.watch.advance(triangles as u64);
    }

    pub(super) fn is_stopped(&self) -> bool {
        if self.watch.is_stopped() {
            self.is_stopped.store(true, Relaxed);
        }
        self.is_stopped.load(Relaxed)
    }

    /// Tells of what is left of `triangles`, or fails if it was stopped.
    pub(super) fn end(&self, triangles: usize) -> Result<()> {
        if self.is_stopped.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        self.advance(triangles.saturating_sub(self.told.load(Relaxed)));
        Ok(())
    }
}

/// The nodes, leaves and order that a build makes of triangles.
#[derive(Default)]
pub(super) struct Parts {
    /// The root first, children after their parents.
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Meshlet>,
    /// The triangles, those of a leaf side by side.
    pub(super) order: Vec<u32>,
}

/// The number of leaves between two reports.
const LEAVES_AT_ONCE: usize = 1024;

/// Steps 3 to 6.
fn full(triangles: &Triangles<'_>) -> Parts {
    let sharing = &triangles.sharing;
    let item = |index: u32| Item::new(Box32::of(sharing.triangle(index)), index);
    let mut items = memory::room(sharing.triangles.len());
    (0..count(sharing.triangles.len()))
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(item)
        .collect_into_vec(&mut items);
    let Binary { nodes: binary, order } = binary::binary(&mut items, triangles);
    drop(items);
    if triangles.building.is_stopped() {
        return Parts::default();
    }
    let binary = reinsert(binary, || triangles.building.is_stopped());
    let Wide { nodes, ranges } = collapse::collapse(binary, || triangles.building.is_stopped());
    if triangles.building.is_stopped() {
        return Parts::default();
    }
    let leaf = |(k, &(first, length)): (usize, &(u32, u32))| {
        if k.is_multiple_of(LEAVES_AT_ONCE) {
            let some = ranges[k..].iter().take(LEAVES_AT_ONCE);
            let some: usize = some.map(|&(_, length)| length as usize).sum();
            triangles.building.advance(some / 2);
        }
        let of_leaf = &order[first as usize..(first + length) as usize];
        Meshlet::new(sharing, of_leaf, first)
    };
    let mut leaves = memory::room(ranges.len());
    ranges
        .par_iter()
        .enumerate()
        .with_min_len(LEAVES_AT_ONCE)
        .map(leaf)
        .collect_into_vec(&mut leaves);
    Parts { nodes, leaves, order }
}

/// A mesh's triangles as the builder sees them.
#[derive(Clone, Copy)]
pub(super) struct Triangles<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) sharing: Sharing<'a>,
    /// The approximate number of vertices.
    pub(super) vertices: usize,
    /// The box around them.
    pub(super) around: Box32,
    /// The half surface from which on a leaf is large.
    pub(super) large: f64,
    pub(super) building: &'a Building<'a>,
}

impl Primitives for Triangles<'_> {
    /// The number of triangles over sixteen vertices: five where no vertices are shared. Vertices
    /// that no triangle of the mesh has make it fewer, which costs a little time and nothing else.
    fn block(&self) -> Block {
        let triangles = self.sharing.triangles.len();
        let full = triangles.saturating_mul(WIDTH) / self.vertices.max(1);
        Block(full.clamp(1, WIDTH).ilog2())
    }

    fn is_leaf(&self, items: &[Item]) -> bool {
        items.len() <= WIDTH && self.sharing.fits(items.iter().map(Item::index))
    }

    fn large(&self) -> f64 {
        self.large
    }

    /// The tree is made better and its leaves are filled after this, which takes as long.
    fn advance(&self, items: usize) {
        self.building.advance(items / 2);
    }

    fn is_stopped(&self) -> bool {
        self.building.is_stopped()
    }

    fn distinct(&self, items: &mut [Item]) -> usize {
        let mesh = self.mesh;
        if !mesh.has_plain_triangles() {
            return items.len();
        }
        let key = |item: &Item| corner_bits(mesh, item.index());
        items.sort_by_cached_key(|item| (key(item), item.index()));
        // Of equal ones the lowest comes first, and is kept: it wins every tie.
        let mut kept = 0;
        for k in 0..items.len() {
            if kept == 0 || key(&items[k]) != key(&items[kept - 1]) {
                items.swap(kept, k);
                kept += 1;
            }
        }
        kept
    }
}

/// The corners of a triangle, as bits.
fn corner_bits(mesh: &Mesh, triangle: u32) -> [[u64; 3]; 3] {
    let corners = mesh.corners(triangle as usize);
    corners.map(|corner| corner.to_array().map(f64::to_bits))
}

/// See [`MeshTree::copies`]: the triangles of `order` that are in none of the leaves.
fn copies(mesh: &Mesh, order: &[u32], leaves: &[Meshlet]) -> Vec<[u32; 2]> {
    let length = |leaf: &Meshlet| leaf.filled.count_ones() as usize;
    if leaves.iter().map(length).sum::<usize>() == order.len() {
        return Vec::new();
    }
    let mut is_in_leaf = vec![false; order.len()];
    for leaf in leaves {
        for &triangle in &order[leaf.first as usize..][..length(leaf)] {
            is_in_leaf[triangle as usize] = true;
        }
    }
    let triangles = || (0..count(order.len())).zip(&is_in_leaf);
    let mut first_with = HashMap::new();
    for (triangle, _) in triangles().filter(|(_, is_in_leaf)| **is_in_leaf) {
        let first = first_with.entry(corner_bits(mesh, triangle));
        first.or_insert(triangle);
    }
    let of = |triangle| first_with.get(&corner_bits(mesh, triangle)).copied();
    let others = triangles().filter(|(_, is_in_leaf)| !**is_in_leaf);
    let mut copies: Vec<[u32; 2]> =
        others.filter_map(|(triangle, _)| Some([of(triangle)?, triangle])).collect();
    copies.sort_unstable();
    copies
}

/// Meshes have at most `i32::MAX` triangles, and their vertices are counted by `u32`.
fn count(length: usize) -> u32 {
    u32::try_from(length).expect("vertices are indexed by u32")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::shape::Positions;
    use crate::simd::LANES;

    impl MeshTree {
        pub(in super::super) fn build_quick(mesh: &Mesh) -> Self {
            Self::build_watched(mesh, true, &()).unwrap()
        }
    }

    impl Mesh {
        /// A sheet of `side` vertices each way, at the points for the numbers from 0 to `side - 1`.
        pub(crate) fn sheet(side: u32, point: impl Fn(f64, f64) -> [f64; 3]) -> Self {
            let points = (0..side * side).map(|k| point(f64::from(k % side), f64::from(k / side)));
            let cell = |k: u32| {
                let a = k / (side - 1) * side + k % (side - 1);
                [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]
            };
            let triangles = (0..(side - 1) * (side - 1)).flat_map(cell).collect();
            Self::new(Positions::Double(points.collect()), triangles).unwrap()
        }
    }

    /// A hilly field with `side` squares along a side; its first triangle stands there forty times
    /// more, which is too many for a leaf.
    fn field(side: u32) -> Mesh {
        let height = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 24) / 256.0;
        let points: Vec<[f64; 3]> = (0..(side + 1) * (side + 1))
            .map(|k| [f64::from(k % (side + 1)), f64::from(k / (side + 1)), height(k)])
            .collect();
        let squares = (0..side * side).map(|k| k % side + k / side * (side + 1));
        let mut triangles: Vec<[u32; 3]> = squares
            .flat_map(|a| [[a, a + 1, a + side + 2], [a, a + side + 2, a + side + 1]])
            .collect();
        triangles.extend([triangles[0]; 40]);
        Mesh::new(Positions::compact(points), triangles).unwrap()
    }

    /// The mesh with vertices for each triangle alone, moved by up to a thousand steps of `by`.
    pub(in super::super) fn apart(mesh: &Mesh, by: f64) -> Mesh {
        let triangles = count(mesh.triangles().len());
        let corners = (0..triangles).flat_map(|k| {
            let corners = mesh.corners(k as usize);
            corners.map(|corner| (corner + by * f64::from(k % 1000)).to_array())
        });
        let own = (0..triangles).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        Mesh::new(Positions::compact(corners.collect()), own.collect()).unwrap()
    }

    /// The corners of a box of a size, and of its sides those that are named.
    fn sides_of_box([x, y, z]: [f64; 3], sides: &[[u32; 4]]) -> Mesh {
        let corner = |k: u32| {
            let [a, b, c] = [k & 1, k >> 1 & 1, k >> 2].map(f64::from);
            [a * x, b * y, c * z]
        };
        let halves = |&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]];
        let triangles = sides.iter().flat_map(halves).collect();
        Mesh::new(Positions::compact((0..8).map(corner).collect()), triangles).unwrap()
    }

    #[test]
    fn a_floor_and_a_ceiling_are_two_leaves_and_a_box_is_one() {
        let (floor, ceiling) = ([0, 1, 3, 2], [4, 5, 7, 6]);
        let walls = [[0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        // A room, and a low storey, whose floor and ceiling have most of its surface.
        for size in [[1.0; 3], [80.0, 12.0, 3.0]] {
            let room = MeshTree::build(&sides_of_box(size, &[floor, ceiling]));
            assert_eq!(room.leaves.len(), 2);
            for leaf in &*room.leaves {
                let [low, high] = [leaf.bounds().low(), leaf.bounds().high()];
                assert!(low[2] == high[2], "{low:?} to {high:?}");
            }
            let sides = [[floor, ceiling].as_slice(), &walls].concat();
            let whole = MeshTree::build(&sides_of_box(size, &sides));
            assert_eq!(whole.leaves.len(), 1, "{size:?}");
        }
    }

    #[test]
    fn the_tree_is_the_same_for_any_number_of_threads() {
        // Enough that planning forks too.
        let mesh = field(400);
        for mesh in [apart(&mesh, 0.0), mesh] {
            let trees = [1, 2, 7].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| [MeshTree::build(&mesh), MeshTree::build_quick(&mesh)])
            });
            for tree in trees.as_flattened() {
                assert!(tree.leaves.len() > 20_000, "{}", tree.leaves.len());
                let same = &trees[0][usize::from(tree.is_quick())];
                assert!(tree.nodes == same.nodes);
                assert!(tree.leaves == same.leaves);
                assert_eq!(tree.order, same.order);
            }
        }
    }

    /// Stops after it was asked a number of times, or never; `true` once is enough.
    #[derive(Default)]
    struct Stopper {
        asked: AtomicUsize,
        at: Option<usize>,
        told: AtomicUsize,
        /// The most that it was told of at a time.
        most: AtomicUsize,
    }

    impl Watch for Stopper {
        fn advance(&self, triangles: u64) {
            let triangles = usize::try_from(triangles).unwrap();
            self.told.fetch_add(triangles, Relaxed);
            self.most.fetch_max(triangles, Relaxed);
        }

        fn is_stopped(&self) -> bool {
            Some(self.asked.fetch_add(1, Relaxed)) == self.at
        }
    }

    #[test]
    fn a_build_ends_wherever_it_is_stopped_and_else_tells_of_each_triangle() {
        let mesh = field(200);
        for is_quick in [false, true] {
            let whole = Stopper::default();
            MeshTree::build_watched(&mesh, is_quick, &whole).unwrap();
            assert_eq!(whole.told.into_inner(), mesh.triangles().len());
            let most = whole.most.into_inner();
            assert!(is_quick || 8 * most < mesh.triangles().len(), "{most}");
            let questions = whole.asked.into_inner();
            assert!(questions >= if is_quick { 1 } else { 20 }, "{questions}");
            for at in 0..questions {
                let watch = Stopper { at: Some(at), ..Stopper::default() };
                let made = MeshTree::build_watched(&mesh, is_quick, &watch);
                assert!(matches!(made, Err(Error::Interrupted)), "{at}");
            }
        }
    }

    /// The meshes share vertices, have equal vertices in equal places, and share nothing.
    #[test]
    fn leaves_and_nodes_are_full() {
        let field = field(100);
        let (together, soup) = (apart(&field, 0.0), apart(&field, 1e-5));
        for (mesh, triangles) in [(field, 12.0), (together, 12.0), (soup, 3.8)] {
            let tree = MeshTree::build(&mesh);
            let (nodes, leaves) = (tree.nodes.len() as f64, tree.leaves.len() as f64);
            let in_leaf = tree.order.len() as f64 / leaves;
            let in_node = (leaves + nodes - 1.0) / nodes;
            assert!(in_leaf > triangles, "{in_leaf}");
            assert!(in_node > 9.0, "{in_node}");
        }
    }

    /// Leaves hold the corners as the mesh has them, to the sign of a zero.
    #[test]
    fn corners_stay_what_they_are() {
        let zeros = |k: u32| [0.0, -0.0][k as usize % 2];
        let square = |k: u32| {
            let (x, y) = (f64::from(k % 20), f64::from(k / 20));
            let corner = |right, up, zero| [x + right, y + up, zeros(zero)];
            [
                [corner(0.0, 0.0, k), corner(1.0, 0.0, k + 1), corner(1.0, 1.0, k)],
                [corner(0.0, 0.0, k + 1), corner(1.0, 1.0, k), corner(0.0, 1.0, k + 1)],
            ]
        };
        let corners: Vec<[f64; 3]> = (0..400).flat_map(square).flatten().collect();
        let own = (0..800).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        let mesh = Mesh::new(Positions::compact(corners), own.collect()).unwrap();
        let tree = MeshTree::build(&mesh);
        assert!(tree.is_exact && tree.is_welded);
        for (k, leaf) in tree.leaves.iter().enumerate() {
            for lane in 0..leaf.filled.count_ones() as usize {
                let slot = count(k * LANES + lane);
                let bits = |corners: [DVec3; 3]| corners.map(|p| p.to_array().map(f64::to_bits));
                let own = mesh.corners(tree.triangle_at(slot) as usize);
                assert_eq!(bits(tree.corners_at((&mesh).into(), slot)), bits(own));
            }
        }
    }
}
