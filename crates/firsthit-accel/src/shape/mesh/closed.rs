//! Whether a mesh is closed, so that every ray crosses it in pairs.
//!
//! 1. Vertices in one place are one (`weld.rs`).
//! 2. Count for each edge, whatever its direction, how many times triangles have it. An edge
//!    without a length does not count.
//! 3. The mesh is closed if every number is even.
//!
//! Then the triangles are a cycle modulo 2: no line that avoids their edges crosses them an odd
//! number of times. Which way triangles face is of no account. A triangle that is there twice
//! closes nothing. Collinear corners count as others do: they close the seam where one long edge
//! meets two short ones.

use std::sync::OnceLock;

use super::Mesh;
use super::asked::WhenAsked;
use super::facing::{Facing, edges};
use super::planes::Planes;
use super::weld::{Welded, sort};
use crate::error::{Error, Result};
use crate::memory;
use crate::parallel;

/// Topology of the triangles, computed when asked for, here, in `facing.rs`, `rings.rs` and
/// `planes.rs`; always compares equal, since it follows from the triangles.
#[derive(Clone, Default)]
pub(super) struct Closed {
    edges: OnceLock<Edges>,
    pub(super) facing: OnceLock<Facing>,
    pub(super) rings: WhenAsked<Vec<u32>>,
    pub(super) planes: WhenAsked<Planes>,
}

/// An edge and its way are one number.
const MOST_PLACES: usize = 1 << 31;

/// Facts about the edges of a mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edges {
    /// The number of edges that belong to an odd number of triangles.
    pub(super) odd: usize,
    /// Whether as many triangles go along each edge one way as the other.
    pub(super) is_balanced: bool,
    /// Whether no two triangles go along an edge in one direction, and every edge has a length.
    pub(super) are_of_one_way: bool,
}

impl PartialEq for Closed {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Mesh {
    /// Whether every edge belongs to an even number of triangles; an edge is where its two ends
    /// are, so vertices in one place need not be one. Every ray then enters and leaves the mesh in
    /// turn. Remembered once it is found out.
    ///
    /// ```
    /// use firsthit::{Mesh, Positions};
    ///
    /// let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let sides = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// assert!(Mesh::new(Positions::compact(points.clone()), sides.clone())?.is_closed()?);
    /// assert!(!Mesh::new(Positions::compact(points), sides[1..].to_vec())?.is_closed()?);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] when there is no memory to sort the edges.
    pub fn is_closed(&self) -> Result<bool> {
        Ok(self.odd_edges()? == 0)
    }

    /// The number of edges that belong to an odd number of triangles. Remembered once it is
    /// computed.
    #[doc(hidden)]
    pub fn odd_edges(&self) -> Result<usize> {
        Ok(self.edges()?.odd)
    }

    /// Whether no two triangles go along an edge in one direction, and every edge has a length.
    /// Remembered likewise.
    #[doc(hidden)]
    pub fn edges_are_of_one_way(&self) -> Result<bool> {
        Ok(self.edges()?.are_of_one_way)
    }

    pub(super) fn edges(&self) -> Result<Edges> {
        let known = &self.closed.edges;
        if let Some(&edges) = known.get() {
            return Ok(edges);
        }
        let edges = self.count_edges()?;
        Ok(*parallel::once(known, || edges))
    }

    fn count_edges(&self) -> Result<Edges> {
        let mut uses: Vec<u64> = Vec::new();
        let room = uses.try_reserve_exact(3 * self.triangles.len());
        room.map_err(|_| memory::no_room_for("edges of a mesh"))?;
        let Welded { triangles, vertices } = self.welded()?;
        if vertices.len() > MOST_PLACES {
            return Err(Error::Limit {
                what: "places of a mesh's vertices",
                got: vertices.len().to_string(),
                limit: MOST_PLACES.to_string(),
            });
        }
        for places in triangles {
            // The lower place, the upper one, and which way it goes.
            let packed = |([low, high], is_up): ([u32; 2], bool)| {
                u64::from(low) << 33 | u64::from(high) << 1 | u64::from(is_up)
            };
            uses.extend(edges(places).map(packed));
        }
        sort(&mut uses, Ord::cmp);
        let is_once = uses.windows(2).all(|two| two[0] != two[1]);
        let mut edges = Edges {
            odd: 0,
            is_balanced: true,
            are_of_one_way: is_once && uses.len() == 3 * self.triangles.len(),
        };
        for uses in uses.chunk_by(|one, other| one >> 1 == other >> 1) {
            let up = uses.iter().filter(|&use_| use_ & 1 == 1).count();
            edges.odd += uses.len() % 2;
            edges.is_balanced &= 2 * up == uses.len();
        }
        Ok(edges)
    }
}

#[cfg(test)]
mod tests {
    use crate::shape::{Mesh, Positions};

    fn is_closed(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> bool {
        let mesh = Mesh::new(Positions::compact(points.to_vec()), triangles.to_vec()).unwrap();
        let answer = mesh.is_closed().unwrap();
        assert_eq!(mesh.is_closed().unwrap(), answer, "remembered");
        assert_eq!(mesh.clone(), mesh);
        answer
    }

    const TIPS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const SIDES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn vertices_in_one_place_are_one_and_so_are_both_zeros() {
        let mut soup: Vec<_> = SIDES.as_flattened().iter().map(|&k| TIPS[k as usize]).collect();
        for (k, point) in soup.iter_mut().enumerate() {
            *point = point.map(|x| if x == 0.0 && k % 2 == 0 { -0.0 } else { x });
        }
        let triangles: Vec<_> = (0..4).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        assert!(is_closed(&soup, &triangles));
        soup[4][0] = soup[4][0].next_up();
        assert!(!is_closed(&soup, &triangles));
    }

    #[test]
    fn which_way_a_triangle_faces_is_of_no_account_but_that_it_is_there_twice_is() {
        let mut sides = SIDES;
        sides[2].swap(0, 1);
        assert!(is_closed(&TIPS, &sides));
        let twice = [&SIDES[..], &SIDES[1..2]].concat();
        assert!(!is_closed(&TIPS, &twice));
        assert!(is_closed(&TIPS, &[]));
        assert!(!is_closed(&TIPS, &SIDES[..1]));
        let open = Mesh::new(Positions::compact(TIPS.to_vec()), SIDES[..2].to_vec()).unwrap();
        assert_eq!(open.odd_edges().unwrap(), 4);
    }

    /// The seam from 0 to 1 has a vertex halfway on one side alone.
    #[test]
    fn collinear_corners_close_a_seam() {
        let points = [&TIPS[..], &[[0.5, 0.0, 0.0]]].concat();
        let mut sides = vec![[0, 2, 4], [4, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert!(!is_closed(&points, &sides));
        sides.push([0, 4, 1]);
        assert!(is_closed(&points, &sides));
        // A side without a length is no edge.
        sides.extend([[0, 0, 0], [1, 1, 2]]);
        assert!(is_closed(&points, &sides));
    }
}
