//! The shading frame: normals, and the direction to the viewer.

use crate::geometry::{DVec3, unit};
use crate::scene::terminator_factor;

/// A point of a surface that is seen. All directions are in the world, of length one; normals are
/// on the side that is seen.
#[derive(Debug, Clone, Copy)]
pub(in crate::scene::material) struct Frame {
    /// The shading normal.
    pub(in crate::scene::material) normal: DVec3,
    /// The normal of the face.
    pub(in crate::scene::material) geometric: DVec3,
    /// The direction towards the viewer.
    pub(in crate::scene::material) out: DVec3,
}

impl Frame {
    /// The factor on light that reaches the surface on the side that is seen: below 1 near its
    /// terminator. Zero for light from behind.
    pub(super) fn share(&self, towards: DVec3) -> f64 {
        share(self.normal, self.geometric, towards)
    }

    /// Bends the shading normal so that the mirror direction is above the face (Keller and others,
    /// "The Iray Light Transport Simulation and Rendering System", 2017). Smooth normals and normal
    /// maps need it where the surface is seen from the side. The normal of the face stays.
    pub(in crate::scene::material) fn bent(self) -> Self {
        let Self { normal, geometric, out } = self;
        let below = normal.dot(geometric);
        let normal = if below > 0.0 { normal } else { normal - 2.0 * below * geometric };
        let reflected = 2.0 * normal.dot(out) * normal - out;
        let least = (0.9 * out.dot(geometric)).min(0.01);
        let height = reflected.dot(geometric);
        if height >= least {
            return Self { normal, ..self };
        }
        let raised = unit(reflected + (least - height) * geometric);
        let normal = unit(out + raised);
        Self { normal, ..self }
    }
}

/// See [`Frame::share`].
#[inline(always)]
fn share(normal: DVec3, geometric: DVec3, towards: DVec3) -> f64 {
    let (smooth, flat) = (towards.dot(normal), towards.dot(geometric));
    if smooth > 0.0 && flat > 0.0 {
        terminator_factor(smooth, flat, normal.dot(geometric))
    } else {
        0.0
    }
}

/// The cosine to the shading normal of light on the side that is seen, as far as it counts.
#[inline(always)]
pub(super) fn cosine(normal: DVec3, geometric: DVec3, towards: DVec3) -> f64 {
    towards.dot(normal).max(0.0) * share(normal, geometric, towards)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_normal_shows_what_is_above_the_surface() {
        let geometric = DVec3::Z;
        for k in 0..1000 {
            let [a, b, c] = [0.61, 0.37, 0.83].map(|step| f64::from(k) * step % 1.0);
            let out = unit(DVec3::new(a - 0.5, b - 0.5, 1e-6 + 0.3 * c));
            let normal = unit(DVec3::new(c - 0.5, a - 0.5, b - 0.3));
            let bent = Frame { normal, geometric, out }.bent();
            let reflected = 2.0 * bent.normal.dot(out) * bent.normal - out;
            assert!(reflected.z > 0.0 && bent.normal.dot(out) > 0.0, "{normal} {out}");
            assert!((bent.normal.length() - 1.0).abs() < 1e-12);
            let flat = Frame { normal: geometric, geometric, out };
            assert_eq!(flat.bent().normal, geometric);
        }
    }
}
