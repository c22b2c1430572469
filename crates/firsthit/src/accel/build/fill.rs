//! Makes a leaf of triangles: gives each vertex that they share a lane, and each corner the lane of its vertex.

use super::weld::Sharing;
use crate::accel::meshlet::Meshlet;
use crate::simd::LANES;

impl Meshlet {
    /// The leaf of at most sixteen triangles, which stand at `first` in the order and [fit](Sharing::fits).
    pub(super) fn new(sharing: &Sharing<'_>, triangles: &[u32], first: u32) -> Self {
        let mut corners = [[0; LANES]; 3];
        let mut vertices = [0; LANES];
        let count = sharing.lanes(triangles.iter().copied(), |[k, corner], vertex, lane| {
            corners[corner][k] = lane;
            vertices[usize::from(lane)] = vertex;
        });
        let count = count.expect("the builder has asked whether they fit");
        let mut leaf = Self {
            vertices: [[0.0; LANES]; 3],
            corners,
            first,
            size: 0.0,
            extent: 0.0,
            filled: 0,
            reserved: 0,
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
