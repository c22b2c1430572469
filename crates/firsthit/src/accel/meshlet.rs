//! The leaf: up to sixteen triangles over up to sixteen shared vertices, in 256 bytes.

use super::sharing::Sharing;
use crate::simd::LANES;

/// Triangles over vertices of their own, in the tree's space, as float32.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Meshlet {
    /// The vertices, an array for each axis; what is not used repeats the first one.
    pub(super) vertices: [[f32; LANES]; 3],
    /// For each corner, the triangles' vertices.
    pub(super) corners: [[u8; LANES]; 3],
    /// Where the triangles stand in the tree's order.
    pub(super) first: u32,
    /// How far a triangle extends along an axis at most.
    pub(super) size: f32,
    /// How far all of them together do.
    pub(super) extent: f32,
    /// Which triangles there are, a bit each.
    pub(super) filled: u16,
}

impl Meshlet {
    /// The leaf of at most sixteen triangles, which stand at `first` in the order and [fit](Sharing::fits).
    pub(super) fn new(sharing: &Sharing<'_>, triangles: &[u32], first: u32) -> Self {
        let mut corners = [[0; LANES]; 3];
        let mut vertices = [0; LANES];
        let count = sharing.lanes(triangles.iter().copied(), |[k, corner], vertex, lane| {
            corners[corner][k] = lane;
            vertices[usize::from(lane)] = vertex;
        });
        let count = count.expect("whoever makes a leaf has asked whether they fit");
        let mut leaf = Self {
            vertices: [[0.0; LANES]; 3],
            corners,
            first,
            size: 0.0,
            extent: 0.0,
            filled: 0,
        };
        for k in 0..LANES {
            let vertex = vertices[if k < count { k } else { 0 }];
            for (axis, coordinate) in sharing.points[vertex as usize].into_iter().enumerate() {
                leaf.vertices[axis][k] = coordinate;
            }
        }
        for (k, &triangle) in triangles.iter().enumerate() {
            leaf.size = leaf.size.max(extent(sharing.triangle(triangle)));
            leaf.filled |= 1 << k;
        }
        let extents = leaf
            .vertices
            .each_ref()
            .map(|along| most(along) - least(along));
        leaf.extent = most(&extents);
        // Larger than any rounding of the differences.
        leaf.size *= 1.000_001;
        leaf.extent *= 1.000_001;
        leaf
    }

    /// The corners of a triangle, in the tree's space.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> [[f32; 3]; 3] {
        let corner = |k: usize| {
            let vertex = self.vertex(lane, k);
            [
                self.vertices[0][vertex],
                self.vertices[1][vertex],
                self.vertices[2][vertex],
            ]
        };
        [corner(0), corner(1), corner(2)]
    }

    /// Which vertex a corner of a triangle is.
    #[inline(always)]
    pub(super) fn vertex(&self, lane: usize, corner: usize) -> usize {
        usize::from(self.corners[corner % 3][lane % LANES]) % LANES
    }
}

/// How far a triangle extends along an axis at most.
fn extent([a, b, c]: [[f32; 3]; 3]) -> f32 {
    (0..3)
        .map(|k| a[k].max(b[k]).max(c[k]) - a[k].min(b[k]).min(c[k]))
        .fold(0.0, f32::max)
}

fn least(values: &[f32]) -> f32 {
    values.iter().copied().fold(f32::INFINITY, f32::min)
}

fn most(values: &[f32]) -> f32 {
    values.iter().copied().fold(f32::NEG_INFINITY, f32::max)
}
