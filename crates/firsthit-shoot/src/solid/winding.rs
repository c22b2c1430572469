//! The generalised winding number: how many times does a mesh go around a point?
//!
//! It is the sum of the solid angles of the triangles, seen from the point and positive from
//! behind, in units of the whole sphere. Of a closed mesh that faces outwards it is 1 inside and 0
//! outside. Of an open one it changes smoothly where the surface is missing, and one half is a fair
//! border.
//!
//! Jacobson, Kavan and Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized
//! Winding Numbers", ACM Transactions on Graphics 32(4), 2013. The solid angle of a triangle is
//! that of Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", IEEE Transactions on
//! Biomedical Engineering 30(2), 1983.

use std::f64::consts::TAU;

use crate::error::Result;
use crate::geometry::{DVec3, moderation};
use crate::shape::Mesh;
use crate::watch::{Watch, stop_if_asked};

/// Triangles whose angles are added up before `watch` is asked again.
const AT_ONCE: usize = 1 << 14;

/// The winding number of a mesh around a point in its object space, in float64 and in the order of
/// the triangles: the same on every machine, and off by some 10^-16 for each triangle. On the
/// surface itself either side may be answered for.
///
/// ```
/// use firsthit::measure::winding_number;
/// use firsthit::{DVec3, Mesh, Positions};
///
/// // One side of a cube, seen from the cube's middle.
/// let corners = vec![[1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0]];
/// let side = Mesh::new(Positions::compact(corners), vec![[0, 1, 2], [0, 2, 3]])?;
/// let number = winding_number(&side, DVec3::ZERO, &())?;
/// assert!((number - 1.0 / 6.0).abs() < 1e-15);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Interrupted`](crate::error::Error::Interrupted) when `watch` stops it.
pub fn winding_number(mesh: &Mesh, point: DVec3, watch: &dyn Watch) -> Result<f64> {
    let bounds = mesh.bounds();
    let largest = [bounds.low, bounds.high, point].map(|v| v.abs().max_element());
    let largest = largest.into_iter().fold(0.0, f64::max);
    // Products of three lengths stay in range.
    let scale = moderation(DVec3::splat(largest));
    let mut total = 0.0;
    for triangles in mesh.triangles().chunks(AT_ONCE) {
        stop_if_asked(watch)?;
        let corners = triangles.iter().map(|triangle| {
            triangle.map(|vertex| scale * mesh.positions().get(vertex) - scale * point)
        });
        total += corners.map(half_angle).sum::<f64>();
    }
    Ok(2.0 * total / (2.0 * TAU))
}

/// Half the solid angle of a triangle, seen from the origin.
fn half_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [i, j, k] = [a, b, c].map(DVec3::length);
    // From the edges: far away the three corners are nearly one vector.
    let volume = a.dot((b - a).cross(c - a));
    let along = i * j * k + a.dot(b) * k + b.dot(c) * i + c.dot(a) * j;
    libm::atan2(volume, along)
}
