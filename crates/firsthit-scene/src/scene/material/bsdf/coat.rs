//! A clear coat over everything else: glTF's `KHR_materials_clearcoat`. Its index is 1.5.

use super::frame::Frame;
use super::fresnel;
use super::microfacet::{self, Microfacets};
use crate::geometry::{DVec2, DVec3};
use crate::sampling::TangentFrame;

/// A coat, in the space of its own normal, which has nothing to do with that of the surface below
/// it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coat {
    pub(super) facets: Microfacets,
    frame: Frame,
    axes: TangentFrame,
    out: DVec3,
    /// The share of light that the coat reflects towards the viewer.
    pub(super) share: f64,
}

/// The share of light that a coat reflects, by how much coat there is and the cosine to its normal.
pub(in crate::scene::material) fn coat_share(weight: f64, cosine: f64) -> f64 {
    weight * (0.04 + 0.96 * fresnel::grazing(cosine))
}

impl Coat {
    /// The normal of `frame` is that of the coat. `None` where there is no coat.
    pub(super) fn new(weight: f64, roughness: f64, frame: Frame) -> Option<Self> {
        let frame = frame.bent();
        let axes = TangentFrame::around(frame.normal);
        let out = axes.local(frame.out);
        (weight > 0.0 && out.z > 0.0).then(|| Self {
            facets: Microfacets::of_roughness(roughness),
            frame,
            axes,
            out,
            share: coat_share(weight, out.z),
        })
    }

    /// The distribution times the cosine, for all that it reflects.
    pub(super) fn value(&self, towards: DVec3) -> f64 {
        let into = self.axes.local(towards);
        if into.z > 0.0 {
            self.frame.share(towards) * self.facets.reflection(self.out, into) * into.z
        } else {
            0.0
        }
    }

    pub(super) fn pdf(&self, towards: DVec3) -> f64 {
        let into = self.axes.local(towards);
        if into.z > 0.0 && !self.facets.is_smooth() {
            self.facets.reflection_pdf(self.out, into)
        } else {
            0.0
        }
    }

    /// The direction from which a smooth coat reflects light to the viewer, and the weight of that
    /// light.
    pub(super) fn reflection(&self) -> (DVec3, f64) {
        let towards = self.reflected(DVec3::Z);
        (towards, self.share * self.frame.share(towards))
    }

    pub(super) fn sample(&self, u: DVec2) -> DVec3 {
        self.reflected(self.facets.sample(self.out, u))
    }

    fn reflected(&self, facet: DVec3) -> DVec3 {
        self.axes.world(microfacet::reflected(self.out, facet))
    }
}
