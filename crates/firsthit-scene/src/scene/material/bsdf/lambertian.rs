//! Scattering that is the same in all directions (Lambert, "Photometria", 1760).

use std::f64::consts::PI;

use super::frame::{Frame, cosine};
use super::{Bsdf, BsdfSample};
use crate::geometry::{Color, DVec2, DVec3};
use crate::sampling::{TangentFrame, warp};

/// The scattering distribution of a matte surface, on the side that is seen. All of it is inlined,
/// so that rows of points can be shaded in lanes.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Lambertian {
    /// The shading normal.
    pub normal: DVec3,
    /// The normal of the face.
    pub geometric: DVec3,
    pub albedo: Color,
}

impl From<Lambertian> for Bsdf {
    fn from(matte: Lambertian) -> Self {
        let frame = Frame { normal: matte.normal, geometric: matte.geometric, out: matte.normal };
        Self::even(frame, matte.albedo)
    }
}

impl Lambertian {
    #[inline(always)]
    pub(super) fn new(frame: &Frame, albedo: Color) -> Self {
        Self { normal: frame.normal, geometric: frame.geometric, albedo }
    }

    /// See [`Bsdf::value`](super::Bsdf::value).
    #[inline(always)]
    pub fn value(&self, towards: DVec3) -> Color {
        self.albedo * cosine(self.normal, self.geometric, towards)
    }

    /// See [`Bsdf::pdf`](super::Bsdf::pdf).
    #[inline(always)]
    pub fn pdf(&self, towards: DVec3) -> f64 {
        if towards.dot(self.geometric) > 0.0 { towards.dot(self.normal).max(0.0) / PI } else { 0.0 }
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline(always)]
    pub fn sample(&self, u: DVec2) -> Option<BsdfSample> {
        let local = warp::cosine_hemisphere(u);
        let towards = TangentFrame::around(self.normal).world(local);
        let density = towards.dot(self.normal);
        let value = cosine(self.normal, self.geometric, towards);
        (value > 0.0).then_some(BsdfSample {
            towards,
            weight: self.albedo * (value / density),
            pdf: Some(density / PI),
        })
    }
}
