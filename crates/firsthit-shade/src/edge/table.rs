//! The edges of a mesh, with the triangles at them.
//!
//! 1. Vertices in one place are one. A triangle with two corners in one place, or with the corners
//!    of an earlier one, does not count.
//! 2. Sort the sides of triangles by their ends: those of one edge are side by side.
//! 3. A triangle that is thinner than the rounding of its coordinates has no meaningful normal.
//!    Meshes of CAD programs have such slivers along seams. The triangle across its longest side is
//!    the neighbour at its other two, and its longest side is not an edge.

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::{DVec2, DVec3};
use crate::memory;
use crate::parallel;
use crate::shape::{Mesh, Positions, Welded};

/// The memory that a triangle needs at most while the table is made, in bytes: its places, three
/// sides and three edges.
const TRIANGLE_BYTES: usize =
    3 * size_of::<[u32; 3]>() + 3 * size_of::<Side>() + 3 * size_of::<MeshEdge>();

/// The number of thin triangles in a row that are looked through.
const MOST_THIN: usize = 16;

/// A side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The places of its ends, the lower number first.
    ends: [u32; 2],
    pub(super) triangle: u32,
    /// The corner at which the side begins; it ends at the next one.
    corner: u8,
    /// Whether the triangle goes from the lower place to the higher one.
    is_forward: bool,
}

impl Side {
    /// The weights of the triangle's corners 1 and 2 at a share of the way from the lower place to
    /// the higher one. Exact, where the share is a multiple of 2^-52.
    pub(super) fn weights(&self, share: f64) -> DVec2 {
        let share = if self.is_forward { share } else { 1.0 - share };
        match self.corner {
            0 => DVec2::new(share, 0.0),
            1 => DVec2::new(1.0 - share, share),
            _ => DVec2::new(0.0, 1.0 - share),
        }
    }
}

/// A triangle as the neighbour of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Neighbour {
    pub(super) triangle: u32,
    /// Whether it goes along the edge from the lower place to the higher one.
    pub(super) is_forward: bool,
}

/// An edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeshEdge {
    /// The places of its ends.
    pub(super) ends: [u32; 2],
    /// The first two triangles that have it as a side.
    pub(super) sides: [Option<Side>; 2],
    /// The first two that meet there, thin ones looked through.
    pub(super) neighbours: [Option<Neighbour>; 2],
    /// Whether more than two do.
    pub(super) is_crowded: bool,
}

/// The edges of a mesh.
#[derive(Debug)]
pub(super) struct EdgeTable {
    pub(super) edges: Vec<MeshEdge>,
    /// A vertex in each place.
    vertices: Vec<u32>,
}

impl EdgeTable {
    pub(super) fn new(mesh: &Mesh) -> Result<Self> {
        let needed = mesh.triangles().len().saturating_mul(TRIANGLE_BYTES);
        memory::check("the edges of a mesh", needed)?;
        let Welded { triangles: welded, vertices } = mesh.welded()?;
        let sides = sides(&welded);
        let uses: Vec<&[Side]> = sides.chunk_by(|a, b| a.ends == b.ends).collect();
        let thin = Thin::new(mesh, &welded, &uses);
        let edges = parallel::gather(uses.chunks(parallel::MANY), |uses| {
            uses.iter().filter_map(|uses| thin.edge(uses)).collect()
        });
        Ok(Self { edges, vertices })
    }

    /// The ends of an edge, in object space.
    pub(super) fn points(&self, mesh: &Mesh, edge: &MeshEdge) -> [DVec3; 2] {
        let vertices = edge.ends.map(|place| self.vertices[place as usize]);
        vertices.map(|vertex| mesh.positions().get(vertex))
    }
}

/// The sides of all triangles that count, those of one edge side by side.
fn sides(welded: &[[u32; 3]]) -> Vec<Side> {
    let sorted = |[a, b, c]: [u32; 3]| {
        let mut places = [a, b, c];
        places.sort_unstable();
        places
    };
    let mut order: Vec<([u32; 3], u32)> =
        welded.iter().map(|&places| sorted(places)).zip(0..).collect();
    order.par_sort_unstable();
    order.dedup_by_key(|(places, _)| *places);
    order.retain(|([a, b, c], _)| a != b && b != c);
    let of_triangle = |&(_, triangle): &([u32; 3], u32)| {
        let [a, b, c] = welded[triangle as usize];
        [(0, a, b), (1, b, c), (2, c, a)].map(|(corner, from, to)| Side {
            ends: [from.min(to), from.max(to)],
            triangle,
            corner,
            is_forward: from < to,
        })
    };
    let of_triangles = |order: &[_]| order.iter().flat_map(of_triangle).collect();
    let mut sides: Vec<Side> = parallel::gather(order.chunks(parallel::MANY), of_triangles);
    sides.par_sort_unstable();
    sides
}

/// The thin triangles of a mesh.
struct Thin<'a> {
    /// The ends of the longest side of each thin triangle, with the triangle, in order.
    longest: Vec<(u32, [u32; 2])>,
    uses: &'a [&'a [Side]],
}

impl<'a> Thin<'a> {
    fn new(mesh: &Mesh, welded: &[[u32; 3]], uses: &'a [&'a [Side]]) -> Self {
        let bounds = mesh.bounds();
        let largest = bounds.low.abs().max(bounds.high.abs()).max_element();
        let exact = match &**mesh.positions() {
            Positions::Single(_) => f64::from(f32::EPSILON),
            Positions::Double(_) => f64::EPSILON,
        };
        let longest = |triangle: usize| {
            let corner = longest_side_of_thin(mesh.corners(triangle), exact * largest)?;
            let [from, to] = [corner, (corner + 1) % 3].map(|k| welded[triangle][k]);
            let number = u32::try_from(triangle).ok()?;
            Some((number, [from.min(to), from.max(to)]))
        };
        let starts = (0..welded.len()).step_by(parallel::MANY);
        let longest = parallel::gather(starts, |start| {
            let triangles = start..welded.len().min(start + parallel::MANY);
            triangles.filter_map(longest).collect()
        });
        Self { longest, uses }
    }

    /// The ends of the longest side of a triangle that is thin.
    fn longest_side(&self, triangle: u32) -> Option<[u32; 2]> {
        let found = self.longest.binary_search_by_key(&triangle, |(number, _)| *number);
        found.ok().map(|k| self.longest[k].1)
    }

    /// The edge of these sides, unless it is within something thin.
    fn edge(&self, uses: &[Side]) -> Option<MeshEdge> {
        let is_long = |side: &Side| self.longest_side(side.triangle) == Some(side.ends);
        if !self.longest.is_empty() && uses.iter().any(is_long) {
            return None;
        }
        let mut neighbours = uses.iter().filter_map(|side| self.through(side));
        let first_two = [neighbours.next(), neighbours.next()];
        Some(MeshEdge {
            ends: uses[0].ends,
            sides: [uses.first().copied(), uses.get(1).copied()],
            neighbours: first_two,
            is_crowded: neighbours.next().is_some(),
        })
    }

    /// The triangle of a side, or what is across the longest side of that if it is thin, and so on.
    fn through(&self, side: &Side) -> Option<Neighbour> {
        let mut seen = Neighbour { triangle: side.triangle, is_forward: side.is_forward };
        for _ in 0..MOST_THIN {
            let Some(ends) = self.longest_side(seen.triangle) else {
                return Some(seen);
            };
            let found = self.uses.binary_search_by_key(&ends, |uses| uses[0].ends);
            let &[a, b] = self.uses[found.ok()?] else {
                return None;
            };
            let (own, other) = if a.triangle == seen.triangle { (a, b) } else { (b, a) };
            // Neighbours that face the same way go opposite ways along their edge.
            let faces_alike = own.is_forward != other.is_forward;
            seen =
                Neighbour { triangle: other.triangle, is_forward: seen.is_forward == faces_alike };
        }
        None
    }
}

/// The longest side of a triangle, as the corner that it begins at, if no corner is farther than
/// `off` from it.
fn longest_side_of_thin(corners: [DVec3; 3], off: f64) -> Option<usize> {
    let [a, b, c] = corners;
    let sides = [b - a, c - b, a - c];
    let lengths = sides.map(DVec3::length);
    let longest = (1..3).fold(0, |best, k| if lengths[k] > lengths[best] { k } else { best });
    let double_area = sides[0].cross(sides[1]).length();
    // Written so that a NaN is thin.
    let is_thick = double_area > off * lengths[longest];
    (!is_thick).then_some(longest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> EdgeTable {
        let mesh = Mesh::new(Positions::compact(points.to_vec()), triangles.to_vec()).unwrap();
        EdgeTable::new(&mesh).unwrap()
    }

    /// The numbers of neighbours of all edges, in order.
    fn counts(table: &EdgeTable) -> Vec<usize> {
        let count = |edge: &MeshEdge| {
            let two = edge.neighbours.iter().flatten().count();
            two + usize::from(edge.is_crowded)
        };
        let mut counts: Vec<usize> = table.edges.iter().map(count).collect();
        counts.sort_unstable();
        counts
    }

    const POINTS: [[f64; 3]; 5] =
        [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 0.0, 0.0]];

    #[test]
    fn a_triangle_that_is_there_twice_counts_once() {
        let twice = table(&POINTS, &[[0, 1, 2], [0, 3, 1], [1, 0, 2], [2, 0, 1]]);
        assert_eq!(counts(&twice), [1, 1, 1, 1, 2]);
    }

    #[test]
    fn more_than_two_triangles_crowd_an_edge() {
        let mut points = POINTS.to_vec();
        points[4] = [1.0, 0.0, 1.0];
        let book = table(&points, &[[0, 1, 2], [0, 3, 1], [0, 1, 4]]);
        assert_eq!(counts(&book), [1, 1, 1, 1, 1, 1, 3]);
    }

    /// The seam from 0 to 1 has a vertex on one side, and a triangle without an area in between.
    #[test]
    fn thin_triangles_are_looked_through() {
        let seam = table(&POINTS, &[[0, 1, 2], [0, 4, 1], [0, 3, 4], [4, 3, 1]]);
        let pairs = seam.edges.iter().filter(|edge| edge.neighbours[1].is_some());
        let mut pairs: Vec<_> = pairs.map(|edge| edge.neighbours.map(Option::unwrap)).collect();
        pairs.sort_unstable_by_key(|pair| pair.map(|of| of.triangle));
        let triangles: Vec<_> = pairs.iter().map(|pair| pair.map(|of| of.triangle)).collect();
        assert_eq!(triangles, [[0, 2], [0, 3], [2, 3]]);
        assert!(pairs.iter().all(|[a, b]| a.is_forward != b.is_forward));
        assert_eq!(seam.edges.len(), 7);
    }

    #[test]
    fn weights_are_those_of_the_point_on_the_edge() {
        let corners = [POINTS[0], POINTS[1], POINTS[2]].map(DVec3::from);
        let mesh = Mesh::new(Positions::compact(POINTS.to_vec()), vec![[0, 1, 2]]).unwrap();
        let table = EdgeTable::new(&mesh).unwrap();
        for edge in &table.edges {
            let [from, to] = table.points(&mesh, edge);
            let weights = edge.sides[0].unwrap().weights(0.25);
            let [a, b, c] = corners;
            let point = a + weights.x * (b - a) + weights.y * (c - a);
            assert_eq!(point, from + 0.25 * (to - from));
        }
    }
}
