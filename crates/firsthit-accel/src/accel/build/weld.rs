//! Finds the vertices that the triangles of a leaf share.
//!
//! Vertices with one index are shared. Where a file has a vertex for each corner (as all STL files
//! have) or for each side of a seam, also those in the same place of the tree: they are welded,
//! without touching the mesh.
//!
//! 1. Estimate in how many places the vertices are: count the distinct ones among those whose hash
//!    is below a power of two.
//! 2. If that is less than 7/8 of the vertices, compare vertices by place, else by index, which is
//!    faster.
//!
//! A leaf holds only places, so no answer depends on this.

use crate::accel::space::CHUNK;
use crate::parallel;
use crate::shape::Mesh;
use crate::simd::LANES;

/// The triangles of a mesh, its vertices in the tree's space, and when two of these are one to a
/// leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sharing<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) points: &'a [[f32; 3]],
    /// Whether two vertices in the same place are one; else only two with the same index are.
    pub(super) is_welded: bool,
}

/// The approximate number of vertices in the estimate's sample.
const SAMPLE: usize = 4096;

impl<'a> Sharing<'a> {
    /// Decides whether to weld, and estimates how many vertices that leaves.
    pub(super) fn new(mesh: &'a Mesh, points: &'a [[f32; 3]]) -> (Self, usize) {
        let places = count_places(points);
        // To compare places for fewer does not pay.
        let is_welded = places < points.len() / 8 * 7;
        let sharing = Self { triangles: mesh.triangles(), points, is_welded };
        (sharing, if is_welded { places } else { points.len() })
    }

    /// The corners of a triangle, by their places.
    #[inline]
    pub(super) fn triangle(&self, index: u32) -> [[f32; 3]; 3] {
        let [a, b, c] = self.triangles[index as usize];
        let point = |vertex: u32| self.points[vertex as usize];
        [point(a), point(b), point(c)]
    }

    /// Whether triangles have few enough vertices for one leaf.
    #[inline]
    pub(super) fn fits(&self, triangles: impl Iterator<Item = u32>) -> bool {
        self.lanes(triangles, |_, _, _| {}).is_some()
    }

    /// Gives each vertex a lane in a leaf of these triangles. Calls `visit` for each corner with
    /// the number of the triangle and that of the corner, the vertex, and its lane. Returns how
    /// many lanes are taken; `None` where there are not enough.
    #[inline]
    pub(super) fn lanes(
        &self,
        triangles: impl Iterator<Item = u32>,
        visit: impl FnMut([usize; 2], u32, u8),
    ) -> Option<usize> {
        let triangles = triangles.map(|index| self.triangles[index as usize]);
        if self.is_welded {
            // To the last bit: the sign of a zero can show in a hit's weights.
            let key = |vertex| self.points[vertex as usize].map(f32::to_bits);
            lanes(triangles, key, visit)
        } else {
            lanes(triangles, |vertex| [vertex], visit)
        }
    }
}

/// As [`Sharing::lanes`]: vertices with the same key are one.
#[inline]
fn lanes<const N: usize>(
    triangles: impl Iterator<Item = [u32; 3]>,
    key: impl Fn(u32) -> [u32; N],
    mut visit: impl FnMut([usize; 2], u32, u8),
) -> Option<usize> {
    // Arrays for each part of a key: then it is compared with all at once.
    let mut keys = [[0; LANES]; N];
    let mut count = 0;
    for (k, triangle) in triangles.enumerate() {
        for (corner, vertex) in triangle.into_iter().enumerate() {
            let key = key(vertex);
            let mut same = (1_u32 << count) - 1;
            for (keys, part) in keys.iter().zip(key) {
                same &= mask(keys, part);
            }
            let lane = (same.trailing_zeros() as usize).min(count);
            if lane == count {
                if count == LANES {
                    return None;
                }
                for (keys, part) in keys.iter_mut().zip(key) {
                    keys[count] = part;
                }
                count += 1;
            }
            visit([k, corner], vertex, u8::try_from(lane).ok()?);
        }
    }
    Some(count)
}

/// The mask of the keys that equal `key`.
#[inline]
fn mask(keys: &[u32; LANES], key: u32) -> u32 {
    let bits = keys.iter().enumerate();
    bits.fold(0, |all, (k, &other)| all | u32::from(other == key) << k)
}

/// Estimates in how many places `points` are, from those whose hash is below a power of two. The
/// same for any number of threads.
fn count_places(points: &[[f32; 3]]) -> usize {
    let bits = (points.len() / SAMPLE).max(1).ilog2();
    let mut sample: Vec<u64> = parallel::gather(points.chunks(CHUNK), |points| {
        let hashes = points.iter().map(|point| hash(*point));
        hashes.filter(|hash| hash.leading_zeros() >= bits).collect()
    });
    let all = sample.len().max(1);
    sample.sort_unstable();
    sample.dedup();
    points.len().saturating_mul(sample.len()) / all
}

/// Multiplicative hashing (Knuth, "The Art of Computer Programming" 3, 6.4), of one coordinate
/// after the other.
fn hash(point: [f32; 3]) -> u64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    // Not from 0 on: the origin, which is frequent in files, would be in every sample.
    point.into_iter().fold(GOLDEN, |hash, coordinate| {
        (hash.rotate_left(32) ^ u64::from(coordinate.to_bits())).wrapping_mul(GOLDEN)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Also where one place is far more frequent than all others.
    #[test]
    fn places_are_counted_about() {
        let point = |k: u32| [k as f32, (k % 321) as f32, (k % 7) as f32];
        for (copies, at) in [(0, [0.0; 3]), (9_000, [0.0; 3]), (9_000, [1.0; 3])] {
            for times in [1, 3] {
                let points = (0..90_000).map(|k| point(k / times));
                let points: Vec<_> = points.chain(vec![at; copies]).collect();
                let places = 90_000.0 / f64::from(times);
                let count = count_places(&points) as f64;
                assert!((0.8 * places..1.3 * places).contains(&count), "{count}");
            }
        }
    }
}
