//! The tree over a mesh's triangles: 16-wide nodes over meshlets, all in float32.
//!
//! Everything is in the tree's own space: relative to a local origin, and scaled by a power of two so that
//! no coordinate is larger than 1. So float32 serves a mesh of any size at any place, and rounding can be
//! bounded by constants. Nothing here decides: see `filter.rs`.

use rayon::prelude::*;

use super::bins::{Block, Box32, Item};
use super::build::{self, Binary};
use super::meshlet::Meshlet;
use super::sharing::Sharing;
use super::wide::{self, Node};
use crate::geometry::DVec3;
use crate::memory;
use crate::shape::{Mesh, Positions};
use crate::simd::{LANES, Lanes};

/// A 16-wide tree over the triangles of one mesh.
#[derive(Debug, Clone)]
pub struct MeshTree {
    pub(super) space: Space,
    /// Whether the leaves hold the very coordinates of the mesh, so that nobody need look there.
    pub(super) is_exact: bool,
    /// See [`Sharing`].
    pub(super) is_welded: bool,
    /// The root first; none for a mesh that is not a matter for float32, or empty.
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Meshlet>,
    /// The triangles' indices, those of a leaf side by side.
    pub(super) order: Vec<u32>,
    /// What a ray through the mesh's box costs, as it was [built](Self::build); see `refit.rs`.
    pub(super) cost: f64,
}

/// How the tree's space lies in the mesh's.
#[derive(Debug, Clone, Copy)]
pub(super) struct Space {
    /// Minus zero along each axis where it is the mesh's own: adding that changes no sign of a zero.
    pub(super) origin: DVec3,
    /// Units of the tree in a unit of the mesh: a power of two.
    pub(super) scale: f64,
    /// Its reciprocal.
    pub(super) unscale: f64,
}

/// Coordinates up to here, and sizes down to its reciprocal, are scaled; products of three stay in float64.
const LARGEST: f64 = 1e90;

impl Space {
    pub(super) fn new(mesh: &Mesh) -> Option<Self> {
        let bounds = mesh.bounds();
        let largest = bounds.low.abs().max(bounds.high.abs()).max_element();
        let half = 0.5 * bounds.size().max_element();
        // Float32 coordinates stay what they are around the mesh's own origin, if that is not far away.
        let is_near = largest <= 4.0 * half;
        let origin = match mesh.positions().as_ref() {
            _ if is_near => DVec3::splat(-0.0),
            Positions::Single(_) => bounds.centre().as_vec3().as_dvec3(),
            Positions::Double(_) => bounds.centre(),
        };
        let reach = (bounds.high - origin)
            .max(origin - bounds.low)
            .max_element();
        if largest.is_nan() || largest > LARGEST {
            return None;
        }
        let scale = 1.0 / power_of_two_above(reach.max(1.0 / LARGEST));
        Some(Self {
            origin,
            scale,
            unscale: 1.0 / scale,
        })
    }

    /// The vertices of `mesh`.
    pub(super) fn points(&self, mesh: &Mesh) -> Vec<[f32; 3]> {
        let mut points = memory::room(mesh.positions().len());
        (0..count(mesh.positions().len()))
            .into_par_iter()
            .with_min_len(build::CHUNK)
            .map(|k| self.point(mesh.positions().get(k)))
            .collect_into_vec(&mut points);
        points
    }

    /// Whether `points` are the vertices of `mesh` to the last bit (which zero it is can show in a hit's weights).
    pub(super) fn is_exact(&self, mesh: &Mesh, points: &[[f32; 3]]) -> bool {
        let is_same = |(k, point): (usize, &[f32; 3])| {
            let position = mesh.positions().get(count(k));
            let restored = self.restored(*point);
            restored.to_array().map(f64::to_bits) == position.to_array().map(f64::to_bits)
        };
        points
            .par_iter()
            .with_min_len(build::CHUNK)
            .enumerate()
            .all(is_same)
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding is what this is for"
    )]
    fn point(&self, point: DVec3) -> [f32; 3] {
        // Not even a difference with zero: it would change minus zero.
        let moved = if self.origin == DVec3::ZERO {
            point
        } else {
            point - self.origin
        };
        (moved * self.scale).to_array().map(|x| x as f32)
    }

    /// A point of the tree in the mesh; exact when the mesh's tree is.
    #[inline(always)]
    pub(super) fn restored(&self, [x, y, z]: [f32; 3]) -> DVec3 {
        DVec3::new(x.into(), y.into(), z.into()) * self.unscale + self.origin
    }
}

/// The smallest power of two that is larger than a normal `x`.
fn power_of_two_above(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    2.0 * f64::from_bits(x.to_bits() & EXPONENT)
}

impl MeshTree {
    /// The tree over the triangles of `mesh`, by all threads of the current rayon pool, and the same for any
    /// number of them.
    pub fn build(mesh: &Mesh) -> Self {
        let Some(space) = Space::new(mesh).filter(|_| !mesh.triangles().is_empty()) else {
            return Self {
                space: Space {
                    origin: DVec3::ZERO,
                    scale: 1.0,
                    unscale: 1.0,
                },
                is_exact: false,
                is_welded: false,
                nodes: Vec::new(),
                leaves: Vec::new(),
                order: (0..count(mesh.triangles().len())).collect(),
                cost: 0.0,
            };
        };
        let points = space.points(mesh);
        let (sharing, vertices) = Sharing::new(mesh, &points);
        let triangles = count(mesh.triangles().len());
        let item = |index: u32| Item::new(Box32::of(sharing.triangle(index)), index);
        let mut items = memory::room(mesh.triangles().len());
        (0..triangles)
            .into_par_iter()
            .with_min_len(build::CHUNK)
            .map(item)
            .collect_into_vec(&mut items);
        let Binary {
            nodes: binary,
            order,
        } = build::binary(
            &mut items,
            &Triangles {
                mesh,
                sharing,
                vertices,
            },
        );
        drop(items);
        let wide::Wide { nodes, ranges } = wide::collapse(&binary);
        drop(binary);
        let leaf = |&(first, length): &(u32, u32)| {
            let of_leaf = &order[first as usize..(first + length) as usize];
            Meshlet::new(&sharing, of_leaf, first)
        };
        let mut leaves = memory::room(ranges.len());
        ranges
            .par_iter()
            .with_min_len(1024)
            .map(leaf)
            .collect_into_vec(&mut leaves);
        let mut tree = Self {
            is_exact: space.is_exact(mesh, &points),
            is_welded: sharing.is_welded,
            space,
            nodes,
            leaves,
            order,
            cost: 0.0,
        };
        tree.cost = tree.expected_cost();
        tree
    }

    /// What the tree takes in memory.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
            + self.leaves.capacity() * size_of::<Meshlet>()
            + self.order.capacity() * size_of::<u32>()
    }

    /// Whether there is anything to traverse.
    pub(crate) fn has_nodes(&self) -> bool {
        !self.nodes.is_empty()
    }

    /// The triangle in a slot (see [`super::Winner`]) by its index in the mesh.
    pub(crate) fn triangle_in(&self, slot: u32) -> u32 {
        self.triangle(&self.leaves[slot as usize / LANES], slot as usize % LANES)
    }

    /// Its corners, as the mesh has them.
    pub(crate) fn corners_in(&self, mesh: &Mesh, slot: u32) -> [DVec3; 3] {
        self.corners(
            mesh,
            &self.leaves[slot as usize / LANES],
            slot as usize % LANES,
        )
    }

    /// The corners of a triangle of a leaf, as the mesh has them.
    #[inline(always)]
    pub(super) fn corners(&self, mesh: &Mesh, leaf: &Meshlet, lane: usize) -> [DVec3; 3] {
        if self.is_exact {
            let [a, b, c] = leaf.triangle(lane);
            [
                self.space.restored(a),
                self.space.restored(b),
                self.space.restored(c),
            ]
        } else {
            mesh.corners(self.triangle(leaf, lane) as usize)
        }
    }

    /// The triangles of a leaf by their indices in the mesh, as bits; in lanes that it has no triangles in, anything.
    #[inline(always)]
    pub(super) fn triangles_of<L: Lanes>(&self, l: L, leaf: &Meshlet) -> L::Floats {
        let from = &self.order[leaf.first as usize..];
        if let Some(all) = from.first_chunk() {
            l.load(bytemuck::cast_ref::<[u32; LANES], _>(all))
        } else {
            let mut padded = [0; LANES];
            padded[..from.len()].copy_from_slice(from);
            l.load(bytemuck::cast_ref(&padded))
        }
    }

    /// A triangle of a leaf by its index in the mesh.
    #[inline(always)]
    pub(super) fn triangle(&self, leaf: &Meshlet, lane: usize) -> u32 {
        self.order[leaf.first as usize + lane]
    }
}

/// A mesh's triangles as the builder sees them.
struct Triangles<'a> {
    mesh: &'a Mesh,
    sharing: Sharing<'a>,
    /// How many vertices they are over, about.
    vertices: usize,
}

impl build::Kind for Triangles<'_> {
    /// As many as are over sixteen vertices: of a soup, where nobody shares any, only five are. (Vertices of nobody, or of
    /// other meshes, make it fewer, which does no harm.)
    fn block(&self) -> Block {
        let triangles = self.sharing.triangles.len();
        let full = triangles.saturating_mul(wide::WIDTH) / self.vertices.max(1);
        Block(full.clamp(1, wide::WIDTH).ilog2())
    }

    fn is_leaf(&self, items: &[Item]) -> bool {
        items.len() <= wide::WIDTH && self.sharing.fits(items.iter().map(Item::index))
    }

    fn distinct(&self, items: &mut [Item]) -> usize {
        let mesh = self.mesh;
        if !mesh.has_plain_triangles() {
            return items.len();
        }
        let key = |item: &Item| {
            let corners = mesh.corners(item.index() as usize);
            corners.map(|corner| corner.to_array().map(f64::to_bits))
        };
        items.sort_by_cached_key(|item| (key(item), item.index()));
        // Of those that are alike the lowest wins, and comes first.
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

/// Meshes have at most `i32::MAX` triangles, and their vertices are counted by `u32`.
fn count(length: usize) -> u32 {
    u32::try_from(length).expect("vertices are indexed by u32")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A hilly field of so many squares along a side; its first triangle stands there forty times more, which is too
    /// many for a leaf.
    fn field(side: u32) -> Mesh {
        let height = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 24) / 256.0;
        let points: Vec<[f64; 3]> = (0..(side + 1) * (side + 1))
            .map(|k| {
                [
                    f64::from(k % (side + 1)),
                    f64::from(k / (side + 1)),
                    height(k),
                ]
            })
            .collect();
        let squares = (0..side * side).map(|k| k % side + k / side * (side + 1));
        let mut triangles: Vec<[u32; 3]> = squares
            .flat_map(|a| [[a, a + 1, a + side + 2], [a, a + side + 2, a + side + 1]])
            .collect();
        triangles.extend([triangles[0]; 40]);
        Mesh::new(Positions::compact(points), triangles).unwrap()
    }

    /// The same with vertices for each triangle alone, a thousandth of which lie so far from where the next have theirs.
    pub(in super::super) fn apart(mesh: &Mesh, by: f64) -> Mesh {
        let triangles = count(mesh.triangles().len());
        let corners = (0..triangles).flat_map(|k| {
            let corners = mesh.corners(k as usize);
            corners.map(|corner| (corner + by * f64::from(k % 1000)).to_array())
        });
        let own = (0..triangles).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        Mesh::new(Positions::compact(corners.collect()), own.collect()).unwrap()
    }

    #[test]
    fn the_tree_is_the_same_for_any_number_of_threads() {
        // Enough that planning forks too.
        let mesh = field(400);
        for mesh in [apart(&mesh, 0.0), mesh] {
            let trees = [1, 2, 7].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                pool.install(|| MeshTree::build(&mesh))
            });
            assert!(trees[0].leaves.len() > 20_000, "{}", trees[0].leaves.len());
            for tree in &trees[1..] {
                assert!(tree.nodes == trees[0].nodes);
                assert!(tree.leaves == trees[0].leaves);
                assert_eq!(tree.order, trees[0].order);
            }
        }
    }

    /// Where triangles share their vertices, where those are in the same places, and where there is nothing to share.
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
                [
                    corner(0.0, 0.0, k),
                    corner(1.0, 0.0, k + 1),
                    corner(1.0, 1.0, k),
                ],
                [
                    corner(0.0, 0.0, k + 1),
                    corner(1.0, 1.0, k),
                    corner(0.0, 1.0, k + 1),
                ],
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
                let own = mesh.corners(tree.triangle_in(slot) as usize);
                assert_eq!(bits(tree.corners_in(&mesh, slot)), bits(own));
            }
        }
    }
}
