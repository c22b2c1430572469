//! The facing of a closed mesh's triangles with which it goes around every point a whole number of
//! times.
//!
//! That needs as many triangles along each edge in one direction as in the other. Nearly every
//! closed mesh is so as it stands. In others some triangles are flipped:
//!
//! 1. Triangles with the same three places are one facet, however often it is there.
//! 2. Where an edge has exactly two facets, they face alike if they run along it in opposite
//!    directions. That makes sets of facets (`disjoint_sets.rs`, with two numbers for each facet,
//!    one for each way it may face).
//! 3. Of each set most triangles stay as they are, and the others are taken as turned around.
//! 4. If as many then go one way as the other along each edge, that is how they face. Else the mesh
//!    has no sides that can be told apart.

use super::Mesh;
use super::disjoint_sets::DisjointSets;
use super::weld::sort;
use crate::error::Result;
use crate::memory;
use crate::parallel;

/// The facing of a closed mesh's triangles.
#[derive(Debug, Clone)]
#[doc(hidden)]
pub enum Facing {
    /// Triangles face as their corners go around.
    AsGiven,
    /// Triangles with `true` face the other way.
    Turned(Vec<bool>),
    /// No facing fits all triangles, or the mesh is open.
    Undecided,
}

impl Facing {
    /// Whether a triangle faces the other way than its corners say.
    #[inline]
    pub fn is_turned(&self, triangle: usize) -> bool {
        matches!(self, Self::Turned(turned) if turned[triangle])
    }
}

/// Three numbers in order, and whether they were in a cyclic order of it.
#[doc(hidden)]
pub fn sorted([a, b, c]: [u32; 3]) -> ([u32; 3], bool) {
    let mut all = [a, b, c];
    all.sort_unstable();
    let is_even = all == [a, b, c] || all == [b, c, a] || all == [c, a, b];
    (all, is_even)
}

/// The edges of a triangle that have a length: the lower place first, and whether the triangle goes
/// up.
#[doc(hidden)]
pub fn edges([a, b, c]: [u32; 3]) -> impl Iterator<Item = ([u32; 2], bool)> {
    let sides = [(a, b), (b, c), (c, a)].into_iter();
    sides.filter(|(p, q)| p != q).map(|(p, q)| ([p.min(q), p.max(q)], p < q))
}

impl Mesh {
    /// The facing of the triangles. Remembered once it is computed.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when there is no memory to sort the edges.
    #[doc(hidden)]
    pub fn facing(&self) -> Result<&Facing> {
        let known = &self.closed.facing;
        if let Some(facing) = known.get() {
            return Ok(facing);
        }
        let edges = self.edges()?;
        let facing = if edges.odd > 0 {
            Facing::Undecided
        } else if edges.is_balanced {
            Facing::AsGiven
        } else {
            let turned = self.turned()?;
            if self.is_balanced(&turned)? { Facing::Turned(turned) } else { Facing::Undecided }
        };
        Ok(parallel::once(known, || facing))
    }

    /// The triangles to be turned, so that those at edges of two facets face alike and most stay as
    /// they are.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when there is no memory to sort the edges.
    #[doc(hidden)]
    pub fn turned(&self) -> Result<Vec<bool>> {
        let count = self.triangles.len();
        memory::check("the edges of a mesh", count.saturating_mul(96))?;
        let welded = self.welded()?.triangles;
        let mut order: Vec<([u32; 3], bool, u32)> = (welded.iter().zip(0..))
            .map(|(&places, triangle)| {
                let (places, is_even) = sorted(places);
                (places, !is_even, triangle)
            })
            .collect();
        sort(&mut order, Ord::cmp);
        // For each triangle its facet, and which way around that it is.
        let mut of_triangle = memory::filled(count, (0_u32, false))?;
        let mut facets: Vec<([u32; 3], usize)> = Vec::new();
        for same in order.chunk_by(|one, other| one.0 == other.0) {
            for &(_, is_odd, triangle) in same {
                of_triangle[triangle as usize] = (number(facets.len()), is_odd);
            }
            facets.push((same[0].0, same.len()));
        }
        drop(order);
        let mut uses: Vec<([u32; 2], u32, bool)> = (facets.iter().zip(0..))
            .flat_map(|(&(places, _), facet)| {
                edges(places).map(move |(ends, is_up)| (ends, facet, is_up))
            })
            .collect();
        sort(&mut uses, Ord::cmp);
        let mut sets = DisjointSets::new(2 * facets.len());
        for at_edge in uses.chunk_by(|one, other| one.0 == other.0) {
            if let &[(_, f, is_up), (_, g, is_also_up)] = at_edge
                && facets[f as usize].1 == facets[g as usize].1
            {
                let turn = u32::from(is_up == is_also_up);
                sets.unite(2 * f, 2 * g + turn);
                sets.unite(2 * f + 1, 2 * g + 1 - turn);
            }
        }
        // Each facet's set, and which way around it is there.
        let mut way = |facet: u32| {
            let ways = [sets.first(2 * facet), sets.first(2 * facet + 1)];
            (ways[0].min(ways[1]), ways[1] < ways[0])
        };
        let mut votes = memory::filled(2 * facets.len(), 0_i64)?;
        for &(facet, is_odd) in &of_triangle {
            let (set, is_around) = way(facet);
            votes[set as usize] += if is_odd == is_around { 1 } else { -1 };
        }
        let mut turned = memory::filled(count, false)?;
        for (turned, &(facet, is_odd)) in turned.iter_mut().zip(&of_triangle) {
            let (set, is_around) = way(facet);
            *turned = (is_odd == is_around) == (votes[set as usize] < 0);
        }
        Ok(turned)
    }

    /// Whether as many triangles go along each edge one way as the other, some of them turned.
    fn is_balanced(&self, turned: &[bool]) -> Result<bool> {
        let welded = self.welded()?.triangles;
        let mut uses: Vec<([u32; 2], bool)> = (welded.iter().zip(turned))
            .flat_map(|(&places, &is_turned)| {
                edges(places).map(move |(ends, is_up)| (ends, is_up != is_turned))
            })
            .collect();
        sort(&mut uses, Ord::cmp);
        Ok(uses.chunk_by(|one, other| one.0 == other.0).all(|at_edge| {
            2 * at_edge.iter().filter(|&&(_, is_up)| is_up).count() == at_edge.len()
        }))
    }
}

fn number(facet: usize) -> u32 {
    u32::try_from(facet).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::Facing;
    use crate::shape::{Mesh, Positions};

    const TIPS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const SIDES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn facing(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Facing {
        let mesh = Mesh::new(Positions::compact(points.to_vec()), triangles.to_vec()).unwrap();
        mesh.facing().unwrap().clone()
    }

    fn flipped(triangles: &[[u32; 3]], which: &[usize]) -> Vec<[u32; 3]> {
        let mut triangles = triangles.to_vec();
        for &k in which {
            triangles[k].swap(0, 1);
        }
        triangles
    }

    #[test]
    fn the_few_that_are_flipped_are_turned() {
        assert!(matches!(facing(&TIPS, &SIDES), Facing::AsGiven));
        let inwards = flipped(&SIDES, &[0, 1, 2, 3]);
        assert!(matches!(facing(&TIPS, &inwards), Facing::AsGiven));
        for k in 0..4 {
            let Facing::Turned(turned) = facing(&TIPS, &flipped(&SIDES, &[k])) else {
                panic!("one is to be turned");
            };
            assert_eq!(turned.iter().position(|&turned| turned), Some(k));
            assert_eq!(turned.iter().filter(|&&turned| turned).count(), 1);
        }
        // Each twice, one copy of one the other way.
        let twice = flipped(&[SIDES, SIDES].concat(), &[5]);
        let Facing::Turned(turned) = facing(&TIPS, &twice) else {
            panic!("one is to be turned");
        };
        assert_eq!(turned.iter().filter(|&&turned| turned).count(), 1);
        assert!(turned[5]);
    }

    /// The projective plane with six vertices: each edge has two triangles, and there is one side.
    #[test]
    fn a_surface_of_one_side_faces_no_way() {
        let plane = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 1],
            [1, 2, 4],
            [2, 3, 5],
            [3, 4, 1],
            [4, 5, 2],
            [5, 1, 3],
        ];
        let points = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 0.5],
            [0.2, 0.7, 1.1],
        ];
        let mesh = Mesh::new(Positions::compact(points.to_vec()), plane.to_vec()).unwrap();
        assert!(mesh.is_closed().unwrap());
        assert!(matches!(mesh.facing().unwrap(), Facing::Undecided));
        assert!(matches!(facing(&TIPS, &SIDES[1..]), Facing::Undecided));
    }
}
