//! Which vertices the triangles of a leaf share.
//!
//! Those with the same index; and, where a file has a vertex for each corner (as all STL files do) or for each side of a
//! seam, those in the same place of the tree (welding, without touching the mesh). A leaf is nothing but places, so no
//! answer depends on it.

use rayon::prelude::*;

use super::binary::CHUNK;
use crate::shape::Mesh;
use crate::simd::LANES;

/// A mesh's triangles and vertices, these in the tree's space, and when two of them are one to a leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sharing<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) points: &'a [[f32; 3]],
    /// Where they are in the same place; elsewhere only where they have the same index, which is faster to see.
    pub(super) is_welded: bool,
}

/// How many places are looked at, about, to guess how many there are.
const SAMPLE: usize = 4096;

impl<'a> Sharing<'a> {
    /// The one that serves, and how many vertices it leaves, about.
    pub(super) fn new(mesh: &'a Mesh, points: &'a [[f32; 3]]) -> (Self, usize) {
        let places = count_places(points);
        // Looking for less does not pay.
        let is_welded = places < points.len() / 8 * 7;
        let sharing = Self {
            triangles: mesh.triangles(),
            points,
            is_welded,
        };
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

    /// Calls `visit` with the number of each triangle and of its corner, which vertex that is, and the lane this has in a leaf
    /// of these triangles. Returns how many lanes are taken; `None` where there are not enough.
    #[inline]
    pub(super) fn lanes(
        &self,
        triangles: impl Iterator<Item = u32>,
        visit: impl FnMut([usize; 2], u32, u8),
    ) -> Option<usize> {
        let triangles = triangles.map(|index| self.triangles[index as usize]);
        if self.is_welded {
            // To the last bit: which zero it is can show in a hit's weights.
            let key = |vertex| self.points[vertex as usize].map(f32::to_bits);
            lanes(triangles, key, visit)
        } else {
            lanes(triangles, |vertex| vertex, visit)
        }
    }
}

/// As [`Sharing::lanes`], with those one that have the same key.
#[inline]
fn lanes<K: Copy + Default + PartialEq>(
    triangles: impl Iterator<Item = [u32; 3]>,
    key: impl Fn(u32) -> K,
    mut visit: impl FnMut([usize; 2], u32, u8),
) -> Option<usize> {
    let mut keys = [K::default(); LANES];
    let mut count = 0;
    for (k, triangle) in triangles.enumerate() {
        for (corner, vertex) in triangle.into_iter().enumerate() {
            let key = key(vertex);
            let known = keys[..count].iter().position(|&known| known == key);
            let lane = known.unwrap_or(count);
            if lane == count {
                *keys.get_mut(lane)? = key;
                count += 1;
            }
            visit([k, corner], vertex, u8::try_from(lane).ok()?);
        }
    }
    Some(count)
}

/// In how many places `points` are, about: how many those have whose hash is below a power of two, and from that how many
/// all have. The same for any number of threads.
fn count_places(points: &[[f32; 3]]) -> usize {
    let bits = (points.len() / SAMPLE).max(1).ilog2();
    let mut sample: Vec<u64> = points
        .par_iter()
        .with_min_len(CHUNK)
        .map(|point| hash(*point))
        .filter(|hash| hash.leading_zeros() >= bits)
        .collect();
    let all = sample.len().max(1);
    sample.sort_unstable();
    sample.dedup();
    points.len().saturating_mul(sample.len()) / all
}

/// Multiplicative hashing (Knuth, "The Art of Computer Programming" 3, 6.4), of one coordinate after the other.
fn hash(point: [f32; 3]) -> u64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    // Not from 0 on: the origin, which files are full of, would be in every sample.
    point.into_iter().fold(GOLDEN, |hash, coordinate| {
        (hash.rotate_left(32) ^ u64::from(coordinate.to_bits())).wrapping_mul(GOLDEN)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever stands there more often than anything else.
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
