//! Makes a leaf of triangles: gives each vertex that they share a lane, and each corner the lane of
//! its vertex.

use super::binned_sah::{Box32, larger, smaller};
use super::weld::Sharing;
use crate::accel::meshlet::Meshlet;
use crate::geometry::arrays;
use crate::simd::LANES;

/// Triangles in order with the places they would take in a leaf: any first ones may become one.
pub(super) struct Filling {
    /// The lanes of the triangles' vertices, for each corner.
    corners: [[u8; LANES]; 3],
    /// The vertex of each lane.
    vertices: [u32; LANES],
    /// The number of lanes that a triangle and those before it take.
    taken: [u8; LANES],
    /// The number of triangles that fit.
    count: usize,
}

impl Filling {
    /// Takes as many of `triangles` as fit, from the first on.
    #[inline]
    pub(super) fn new(sharing: &Sharing<'_>, triangles: &[u32]) -> Self {
        let triangles = &triangles[..triangles.len().min(LANES)];
        let mut filling =
            Self { corners: [[0; LANES]; 3], vertices: [0; LANES], taken: [0; LANES], count: 0 };
        let Self { corners, vertices, taken, count } = &mut filling;
        // Where there is no lane for a corner, its triangle does not count.
        let _ = sharing.lanes(triangles.iter().copied(), |[k, corner], vertex, lane| {
            corners[corner][k] = lane;
            vertices[usize::from(lane)] = vertex;
            taken[k] = taken[k.saturating_sub(1)].max(taken[k]).max(lane + 1);
            *count = k + usize::from(corner == 2);
        });
        filling
    }

    /// The number of triangles that fit.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The leaf of the first `count` triangles, at least one, which stand at `first` in the order.
    #[inline]
    pub(super) fn leaf(&self, sharing: &Sharing<'_>, count: usize, first: u32) -> Meshlet {
        let mut leaf = Meshlet {
            vertices: [[0.0; LANES]; 3],
            corners: self.corners,
            first,
            size: 0.0,
            extent: 0.0,
            filled: u16::MAX >> (LANES - count),
            reserved: 0,
        };
        let taken = usize::from(self.taken[count - 1]);
        for k in 0..LANES {
            let vertex = self.vertices[if k < taken { k } else { 0 }];
            for (axis, coordinate) in sharing.points[vertex as usize].into_iter().enumerate() {
                leaf.vertices[axis][k] = coordinate;
            }
        }
        for corners in &mut leaf.corners {
            corners[count..].fill(0);
        }
        for k in 0..count {
            leaf.size = leaf.size.max(extent(leaf.triangle(k)));
        }
        let bounds = leaf.bounds();
        let [x, y, z] = arrays::from_fn(|k| bounds.high()[k] - bounds.low()[k]);
        leaf.extent = f32::max(x, f32::max(y, z)).max(0.0);
        // Larger than any rounding of the differences.
        leaf.size *= 1.000_001;
        leaf.extent *= 1.000_001;
        leaf
    }
}

impl Meshlet {
    /// The leaf of at most sixteen triangles, which stand at `first` in the order and
    /// [fit](Sharing::fits).
    pub(super) fn new(sharing: &Sharing<'_>, triangles: &[u32], first: u32) -> Self {
        let filling = Filling::new(sharing, triangles);
        assert_eq!(filling.count(), triangles.len(), "the builder has asked whether they fit");
        filling.leaf(sharing, triangles.len(), first)
    }

    /// The box around its vertices, all of which are corners of its triangles.
    #[inline]
    pub(super) fn bounds(&self) -> Box32 {
        // Unused lanes repeat a vertex.
        let ends = self.vertices.each_ref();
        Box32::new(arrays::map(ends, least), arrays::map(ends, most))
    }
}

/// The largest extent of a triangle along an axis.
fn extent([a, b, c]: [[f32; 3]; 3]) -> f32 {
    let [x, y, z] = arrays::from_fn(|k| a[k].max(b[k]).max(c[k]) - a[k].min(b[k]).min(c[k]));
    f32::max(x, f32::max(y, z)).max(0.0)
}

#[inline]
fn least(values: &[f32; LANES]) -> f32 {
    let (fours, _) = values.as_chunks();
    let [a, b, c, d] = fours.iter().copied().reduce(smaller).unwrap_or_default();
    a.min(b).min(c.min(d))
}

#[inline]
fn most(values: &[f32; LANES]) -> f32 {
    let (fours, _) = values.as_chunks();
    let [a, b, c, d] = fours.iter().copied().reduce(larger).unwrap_or_default();
    a.max(b).max(c.max(d))
}
