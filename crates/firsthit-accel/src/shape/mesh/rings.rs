//! Rings of the triangles around a corner.
//!
//! The corners of triangles that are in one place are a ring: for each there is the number of the
//! next one. To find all rings takes as long as to look for the triangles around some corners in
//! the tree: it is done after a number of questions.

use super::Mesh;
use super::weld::Welded;
use crate::memory;

/// The number of no corner.
const NONE: u32 = u32::MAX;

impl Mesh {
    /// The triangles that have a corner where this one is, a corner of a triangle: that first, and
    /// each once. `None` until it was asked for often.
    #[doc(hidden)]
    pub fn around(&self, triangle: u32, corner: u32) -> Option<impl Iterator<Item = u32>> {
        let price = self.triangles.len() / 8;
        let next = self.closed.rings.ask(price, || self.find_rings())?;
        let start = 3 * triangle + corner;
        let following = move |&corner: &u32| {
            let next = next[corner as usize];
            (next != start).then_some(next)
        };
        let mut last = NONE;
        let corners = std::iter::successors(Some(start), following);
        Some(corners.map(|corner| corner / 3).filter(move |&other| {
            // Corners of one triangle follow each other; those of the first one may be its end too.
            let is_new = other != last && (other != triangle || last == NONE);
            last = other;
            is_new
        }))
    }

    /// Finds the next corner in the place of each corner, in a circle.
    fn find_rings(&self) -> Option<Vec<u32>> {
        let count = 3 * self.triangles.len();
        u32::try_from(count).ok()?;
        let Welded { triangles, vertices } = self.welded().ok()?;
        let mut last = memory::filled(vertices.len(), NONE).ok()?;
        let mut next = memory::filled(count, NONE).ok()?;
        let places = triangles.as_flattened();
        for ((corner, next), &place) in (0..).zip(&mut next).zip(places) {
            *next = std::mem::replace(&mut last[place as usize], corner);
        }
        for (next, &place) in next.iter_mut().zip(places) {
            if *next == NONE {
                *next = last[place as usize];
            }
        }
        Some(next)
    }
}

#[cfg(test)]
mod tests {
    use crate::shape::{Mesh, Positions};

    /// Corners in one place without an index in common, both zeros, and a triangle with two corners
    /// in one place.
    #[test]
    fn around_a_corner_are_all_triangles_that_have_its_place_each_once() {
        let tips = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -0.0, 0.0]];
        let triangles = vec![[0, 1, 2], [3, 2, 1], [1, 1, 2], [1, 2, 2], [3, 0, 1], [2, 1, 1]];
        let mesh = Mesh::new(Positions::compact(tips.to_vec()), triangles.clone()).unwrap();
        // The first questions are answered the long way.
        let mut asked = 0;
        while mesh.around(0, 0).is_none() {
            asked += 1;
        }
        assert_eq!(asked, triangles.len() / 8);
        for (number, corners) in (0..).zip(&triangles) {
            for (corner, &vertex) in (0..).zip(corners) {
                let mut around: Vec<u32> = mesh.around(number, corner).unwrap().collect();
                assert_eq!(around[0], number);
                around.sort_unstable();
                let place = tips[vertex as usize];
                let has = |corners: &[u32; 3]| corners.iter().any(|&k| tips[k as usize] == place);
                let all = (0..).zip(&triangles).filter(|(_, corners)| has(corners));
                assert_eq!(around, all.map(|(number, _)| number).collect::<Vec<u32>>());
            }
        }
    }
}
