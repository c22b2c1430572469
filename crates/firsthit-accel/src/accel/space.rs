//! The space of a [`MeshTree`](super::MeshTree): that of the mesh, moved and scaled into the cube
//! from -1 to 1.

use rayon::prelude::*;

use super::bounds::DISTANT;
use crate::geometry::{DVec3, arrays};
use crate::memory;
use crate::parallel;
use crate::shape::{Mesh, Meshes};

/// The number of points or boxes in one task.
pub(super) const CHUNK: usize = 65_536;

/// The place and scale of the tree's space in the mesh's.
#[derive(Debug, Clone, Copy)]
pub(super) struct Space {
    /// The mesh's place of the tree's origin. Minus zero along each axis where it is the mesh's
    /// own: to add that changes no zero's sign.
    pub(super) origin: DVec3,
    /// Units of the tree in a unit of the mesh: a power of two.
    pub(super) scale: f64,
    /// The reciprocal of the scale.
    pub(super) unscale: f64,
}

/// Coordinates up to this, and sizes down to its reciprocal, are scaled: products of three of them
/// stay in float64's range.
const LARGEST: f64 = 1e90;

impl Space {
    pub(super) fn new(mesh: Meshes<'_>) -> Option<Self> {
        let bounds = mesh.bounds();
        let largest = bounds.low.abs().max(bounds.high.abs()).max_element();
        let half = 0.5 * bounds.size().max_element();
        // If the mesh's own origin is not far away, keep it: float32 coordinates then need no
        // rounding.
        let is_near = largest <= 4.0 * half;
        let centre = bounds.centre();
        let origin = if is_near {
            DVec3::splat(-0.0)
        } else if mesh.are_single() {
            centre.as_vec3().as_dvec3()
        } else {
            centre
        };
        let reach = (bounds.high - origin).max(origin - bounds.low).max_element();
        if largest.is_nan() || largest > LARGEST {
            return None;
        }
        let scale = 1.0 / power_of_two_above(reach.max(1.0 / LARGEST));
        Some(Self { origin, scale, unscale: 1.0 / scale })
    }

    /// The vertices of `mesh`.
    pub(super) fn points(&self, mesh: &Mesh) -> Vec<[f32; 3]> {
        let mut points = memory::room(mesh.positions().len());
        (0..count(mesh.positions().len()))
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|k| self.point(mesh.positions().get(k)))
            .collect_into_vec(&mut points);
        points
    }

    /// Whether `points` are the vertices of `mesh` to the last bit, as the sign of a zero can show
    /// in a hit's weights.
    pub(super) fn is_exact(&self, mesh: &Mesh, points: &[[f32; 3]]) -> bool {
        let is_same = |(k, point): (usize, &[f32; 3])| {
            let position = mesh.positions().get(count(k));
            let restored = self.restored(*point);
            arrays::map(restored.to_array(), f64::to_bits)
                == arrays::map(position.to_array(), f64::to_bits)
        };
        parallel::all(points.chunks(CHUNK).enumerate(), |(chunk, points)| {
            (chunk * CHUNK..).zip(points).all(is_same)
        })
    }

    #[expect(clippy::cast_possible_truncation, reason = "rounding is what this is for")]
    pub(super) fn point(&self, point: DVec3) -> [f32; 3] {
        // No difference with zero: it would change the sign of minus zero.
        let moved = if self.origin == DVec3::ZERO { point } else { point - self.origin };
        arrays::map((moved * self.scale).to_array(), |x| x as f32)
    }

    /// A point of the tree in the mesh; exact when the mesh's tree is.
    #[inline(always)]
    pub(super) fn restored(&self, [x, y, z]: [f32; 3]) -> DVec3 {
        DVec3::new(x.into(), y.into(), z.into()) * self.unscale + self.origin
    }
}

/// The smallest power of two that is larger than a normal `x`.
fn power_of_two_above(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    2.0 * f64::from_bits(x.to_bits() & EXPONENT)
}

impl Space {
    /// Whether rays from there are distant.
    #[inline(always)]
    pub(crate) fn is_distant(&self, origin: DVec3) -> bool {
        let start = (origin - self.origin) * self.scale;
        let largest = start.abs().max_element();
        largest > DISTANT || start.is_nan()
    }
}

/// A vertex' index; meshes count their vertices by `u32`.
fn count(length: usize) -> u32 {
    u32::try_from(length).expect("vertices are indexed by u32")
}
