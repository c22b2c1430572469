//! Which vertices the triangles of a leaf share.
//!
//! Those with the same index; and, where a file has a vertex for each corner (as all STL files do) or for each side of a
//! seam, those in the same place of the tree. A leaf is nothing but places, so no answer depends on it.

use rayon::prelude::*;

use super::build::CHUNK;
use crate::shape::Mesh;
use crate::simd::LANES;

/// A mesh's vertices in the tree's space, and when two of them are one to a leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sharing<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) points: &'a [[f32; 3]],
    /// Where they are in the same place; elsewhere only where they have the same index, which is faster to see.
    pub(super) is_by_place: bool,
}

/// How many places are looked at, about, to guess how many there are.
const SAMPLE: usize = 4096;

impl<'a> Sharing<'a> {
    /// The one that serves, and how many vertices it leaves, about.
    pub(super) fn new(mesh: &'a Mesh, points: &'a [[f32; 3]]) -> (Self, usize) {
        let places = places(points);
        // Looking for less does not pay.
        let is_by_place = places < points.len() / 8 * 7;
        let sharing = Self {
            mesh,
            points,
            is_by_place,
        };
        (sharing, if is_by_place { places } else { points.len() })
    }

    /// The corners of a triangle, by their places.
    pub(super) fn triangle(&self, index: u32) -> [[f32; 3]; 3] {
        self.mesh.triangles()[index as usize].map(|vertex| self.points[vertex as usize])
    }

    /// Whether triangles have few enough vertices for one leaf.
    pub(super) fn fits(&self, triangles: impl Iterator<Item = u32>) -> bool {
        self.place(triangles, |_, _| {}).is_some()
    }

    /// Calls `visit` with each corner's vertex and where in a leaf of these triangles it stands, as they come; `None`
    /// when the leaf is full.
    pub(super) fn place(
        &self,
        triangles: impl Iterator<Item = u32>,
        visit: impl FnMut(u32, u8),
    ) -> Option<()> {
        let vertices = triangles.flat_map(|index| self.mesh.triangles()[index as usize]);
        if self.is_by_place {
            // To the last bit: which zero it is can show in a hit's weights.
            let key = |vertex| self.points[vertex as usize].map(f32::to_bits);
            place(vertices, key, visit)
        } else {
            place(vertices, |vertex| vertex, visit)
        }
    }
}

/// Vertices with the same key stand in the same place, the next ones each in the next.
fn place<K: Copy + Default + PartialEq>(
    mut vertices: impl Iterator<Item = u32>,
    key: impl Fn(u32) -> K,
    mut visit: impl FnMut(u32, u8),
) -> Option<()> {
    let mut keys = [K::default(); LANES];
    let mut count = 0;
    vertices.try_for_each(|vertex| {
        let key = key(vertex);
        let known = keys[..count].iter().position(|&known| known == key);
        let place = known.unwrap_or(count);
        if place == count {
            *keys.get_mut(place)? = key;
            count += 1;
        }
        visit(vertex, u8::try_from(place).ok()?);
        Some(())
    })
}

/// In how many places `points` are, about: how many there are of those whose hash is divisible by a power of two, and from
/// that how many of all. The same for any number of threads.
fn places(points: &[[f32; 3]]) -> usize {
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
    // Of no more than 2^32 and some thousands each.
    points.len() * sample.len() / all
}

/// Multiplicative hashing (Knuth, "The Art of Computer Programming" 3, 6.4), of one coordinate after the other.
fn hash(point: [f32; 3]) -> u64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    point.into_iter().fold(0, |hash: u64, coordinate| {
        (hash.rotate_left(32) ^ u64::from(coordinate.to_bits())).wrapping_mul(GOLDEN)
    })
}
