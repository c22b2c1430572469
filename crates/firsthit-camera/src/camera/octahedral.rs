//! The whole sphere on a square: an octahedron, unfolded. The middle of the picture is the aim, its
//! corners are straight back.
//!
//! Engelhardt and Dachsbacher, "Octahedron Environment Maps", VMV 2008.

use super::central::Central;
use crate::geometry::{DVec2, DVec3, settings};

settings! {
    /// See [`Projection::Octahedral`](super::Projection::Octahedral). Rays start at the camera.
    pub struct Octahedral {}
}

/// The point of the square, from -1 to 1 both ways, with the back half folded inwards, or outwards.
fn folded(point: DVec2) -> DVec2 {
    let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
    DVec2::new((1.0 - point.y.abs()) * sign(point.x), (1.0 - point.x.abs()) * sign(point.y))
}

impl Central for Octahedral {
    fn direction(&self, [rows, columns]: [usize; 2], pixel: DVec2) -> Option<DVec3> {
        let point = 2.0 * pixel / DVec2::new(columns as f64, rows as f64) - DVec2::ONE;
        let ahead = 1.0 - point.x.abs() - point.y.abs();
        let aside = if ahead < 0.0 { folded(point) } else { point };
        Some(aside.extend(ahead))
    }

    fn pixel(&self, [rows, columns]: [usize; 2], direction: DVec3) -> Option<DVec2> {
        let on_octahedron = direction / direction.abs().element_sum();
        let aside = on_octahedron.truncate();
        let point = if direction.z < 0.0 { folded(aside) } else { aside };
        Some(0.5 * (point + DVec2::ONE) * DVec2::new(columns as f64, rows as f64))
    }

    fn scaled(&self, _factors: [f64; 2]) -> Self {
        *self
    }
}
