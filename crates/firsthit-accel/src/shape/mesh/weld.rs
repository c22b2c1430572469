//! Vertices in one place are one, to the last bit, whether or not triangles share them by index; 0
//! and -0 are one number.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::Mesh;
use crate::error::Result;
use crate::geometry::{DVec3, compare_points};
use crate::memory;
use crate::parallel;

/// The number of triangles in one task.
const CHUNK: usize = 1 << 12;

/// The corners of a mesh by their places.
#[derive(Debug)]
#[doc(hidden)]
pub struct Welded {
    /// The corners of each triangle as numbers of places.
    pub triangles: Vec<[u32; 3]>,
    /// The vertex with the lowest index in each place.
    pub vertices: Vec<u32>,
}

impl Mesh {
    /// The vertices that triangles have, in order.
    #[doc(hidden)]
    pub fn used_vertices(&self) -> Result<Vec<u32>> {
        let corners = self.triangles.as_flattened();
        if self.uses_most_vertices() {
            let mut is_used = memory::filled(self.positions.len(), false)?;
            for &vertex in corners {
                is_used[vertex as usize] = true;
            }
            let count = is_used.iter().filter(|&&is_used| is_used).count();
            let mut used = memory::filled(count, 0)?;
            let numbers = (0..).zip(&is_used).filter(|(_, is_used)| **is_used);
            for (used, (vertex, _)) in used.iter_mut().zip(numbers) {
                *used = vertex;
            }
            return Ok(used);
        }
        let mut used = memory::filled(corners.len(), 0)?;
        used.copy_from_slice(corners);
        sort(&mut used, Ord::cmp);
        used.dedup();
        Ok(used)
    }

    /// Whether a table over all vertices is worth it: meshes of many objects may share one buffer.
    fn uses_most_vertices(&self) -> bool {
        self.positions.len() <= 8 * self.triangles.len()
    }

    /// The places of all corners. They are numbered in the order of their points.
    ///
    /// In a rayon pool all its threads help. Elsewhere the calling thread works alone, since a
    /// process that forks, as those of Python do, has no other threads.
    #[doc(hidden)]
    pub fn welded(&self) -> Result<Welded> {
        let used = self.used_vertices()?;
        let mut order = memory::filled(used.len(), (DVec3::ZERO, 0))?;
        for (entry, &vertex) in order.iter_mut().zip(&used) {
            *entry = (self.positions.get(vertex), vertex);
        }
        sort(&mut order, |a, b| compare_points(a.0, b.0).then(a.1.cmp(&b.1)));
        let is_table = self.uses_most_vertices();
        let slot = |vertex: u32| {
            if is_table {
                return vertex as usize;
            }
            let found = used.binary_search(&vertex);
            found.expect("every corner's vertex is there")
        };
        let slots = if is_table { self.positions.len() } else { used.len() };
        let mut places = memory::filled(slots, 0)?;
        let mut vertices = memory::filled(used.len(), 0)?;
        let mut count = 0;
        for same in order.chunk_by(|a, b| compare_points(a.0, b.0) == Ordering::Equal) {
            for &(_, vertex) in same {
                places[slot(vertex)] = count;
            }
            vertices[count as usize] = same[0].1;
            count += 1;
        }
        drop(order);
        vertices.truncate(count as usize);
        let place = |vertex: u32| places[slot(vertex)];
        let mut triangles = memory::filled(self.triangles.len(), [0; 3])?;
        let weld = |(welded, corners): (&mut [[u32; 3]], &[[u32; 3]])| {
            for (welded, corners) in welded.iter_mut().zip(corners) {
                *welded = corners.map(place);
            }
        };
        if is_in_pool() {
            let parts = triangles.chunks_mut(CHUNK);
            parallel::each(parts.zip(self.triangles.chunks(CHUNK)), weld);
        } else {
            weld((&mut triangles, &self.triangles));
        }
        Ok(Welded { triangles, vertices })
    }
}

/// Sorts by an order in which no two are equal but those that are the same.
pub(super) fn sort<T: Send>(all: &mut [T], compare: impl Fn(&T, &T) -> Ordering + Sync) {
    if is_in_pool() {
        all.par_sort_unstable_by(compare);
    } else {
        all.sort_unstable_by(compare);
    }
}

fn is_in_pool() -> bool {
    rayon::current_thread_index().is_some()
}

#[cfg(test)]
mod tests {
    use crate::shape::{Mesh, Positions};

    #[test]
    fn places_are_numbered_in_order_and_have_their_lowest_vertex() {
        let points = vec![
            [9.0; 3],
            [2.0, 0.0, 0.0],
            [0.0, -0.0, 0.0],
            [-0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [1.0, 5.0, 0.0],
        ];
        let triangles = vec![[4, 2, 5], [3, 1, 5]];
        let mesh = Mesh::new(Positions::compact(points), triangles).unwrap();
        assert_eq!(mesh.used_vertices().unwrap(), [1, 2, 3, 4, 5]);
        let welded = mesh.welded().unwrap();
        assert_eq!(welded.triangles, [[2, 0, 1], [0, 2, 1]]);
        assert_eq!(welded.vertices, [2, 5, 1]);
    }

    #[test]
    fn places_are_the_same_in_a_pool_and_outside_of_one() {
        let point = |k: u32| [k % 61, k % 83, k % 7].map(f64::from);
        let points = (0..40_000).map(point).collect();
        let triangle = |k: u32| [k, k + 1, k * 7 % 40_000];
        let triangles = (0..39_999).map(triangle).collect();
        let mesh = Mesh::new(Positions::compact(points), triangles).unwrap();
        let alone = mesh.welded().unwrap();
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pooled = pool.unwrap().install(|| mesh.welded().unwrap());
            assert_eq!(pooled.triangles, alone.triangles);
            assert_eq!(pooled.vertices, alone.vertices);
        }
    }
}
