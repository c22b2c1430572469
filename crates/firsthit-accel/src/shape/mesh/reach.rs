//! The support function of a mesh, asked for in several directions to frame it.
//!
//! 1. Once for a mesh, find the boxes around blocks of triangles that follow each other.
//! 2. Ask the boxes how far the triangles in them may reach, and the triangles of the most
//!    promising block how far they do.
//! 3. Then those of all blocks that may reach farther than what is known by then.

use std::sync::{Arc, OnceLock};

use super::Mesh;
use crate::geometry::{Bounds, DVec3};
use crate::parallel;

/// The number of triangles in a block.
const BLOCK: usize = 256;

/// A box for each block; equal to any other, since it follows from the triangles.
#[derive(Clone, Default)]
pub(super) struct Blocks(OnceLock<Arc<[Bounds]>>);

impl PartialEq for Blocks {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Mesh {
    /// The largest product of a triangle's corner with `direction`: vertices without a triangle do
    /// not count.
    pub(super) fn reach(&self, direction: DVec3) -> f64 {
        // A corner of the box and a vertex go through the same operations, and rounding is
        // monotone: the bound holds to the last bit.
        let most = |&Bounds { low, high }: &Bounds| {
            DVec3::select(direction.cmpge(DVec3::ZERO), high, low).dot(direction)
        };
        let blocks = self.blocks();
        let bounds: Vec<f64> = blocks.iter().map(most).collect();
        let first = (0..bounds.len()).max_by(|&a, &b| bounds[a].total_cmp(&bounds[b]));
        let mut farthest = first.map_or(f64::NEG_INFINITY, |block| self.reach_of(block, direction));
        for (block, bound) in bounds.into_iter().enumerate() {
            // Of a NaN nothing is known.
            if bound > farthest || bound.is_nan() {
                farthest = farthest.max(self.reach_of(block, direction));
            }
        }
        farthest
    }

    fn reach_of(&self, block: usize, direction: DVec3) -> f64 {
        let triangles = self.triangles.chunks(BLOCK).nth(block).unwrap_or_default();
        let corners = triangles.iter().flatten();
        let along = corners.map(|&vertex| self.positions.get(vertex).dot(direction));
        along.fold(f64::NEG_INFINITY, f64::max)
    }

    fn blocks(&self) -> Arc<[Bounds]> {
        let Blocks(known) = &self.blocks;
        let around = |triangles: &[[u32; 3]]| {
            let corners = triangles.iter().flat_map(|&corners| self.positions.three(corners));
            corners.fold(Bounds::EMPTY, |all, corner| Bounds {
                low: all.low.min(corner),
                high: all.high.max(corner),
            })
        };
        let blocks = || {
            parallel::gather(self.triangles.chunks(64 * BLOCK), |triangles| {
                triangles.chunks(BLOCK).map(around).collect()
            })
        };
        Arc::clone(parallel::once(known, || blocks().into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Positions;

    #[test]
    fn it_is_that_of_the_farthest_corner() {
        let point = |k: u32| [0.37, 0.61, 0.83].map(|step| (f64::from(k) * step).fract() - 0.4);
        let mut points: Vec<[f64; 3]> = (0..3000).map(point).collect();
        // No triangle has it.
        points.push([9.0; 3]);
        let triangles: Vec<[u32; 3]> = (0..2990).map(|k| [k, k + 1, k + 7]).collect();
        let mesh = Mesh::new(Positions::compact(points), triangles).unwrap();
        for direction in [DVec3::X, DVec3::NEG_Z, DVec3::new(1.0, -2.0, 0.3), DVec3::ZERO] {
            let corners = (0..mesh.triangles().len()).flat_map(|k| mesh.corners(k));
            let along = corners.map(|corner| corner.dot(direction));
            assert_eq!(mesh.reach(direction), along.fold(f64::NEG_INFINITY, f64::max));
        }
        let nothing = Mesh::new(Positions::compact(vec![]), vec![]).unwrap();
        assert_eq!(nothing.reach(DVec3::X), f64::NEG_INFINITY);
    }
}
