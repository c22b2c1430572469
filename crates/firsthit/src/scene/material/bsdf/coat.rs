//! A clear coat over everything else: glTF's `KHR_materials_clearcoat`. Its index is 1.5.

use super::frame::TangentFrame;
use super::fresnel;
use super::microfacet::Microfacets;
use crate::geometry::DVec3;

/// A coat, in the space of its own normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coat {
    pub(super) facets: Microfacets,
    axes: TangentFrame,
    out: DVec3,
    /// What it reflects of all light, to whoever looks.
    pub(super) share: f64,
}

impl Coat {
    /// `out` and `normal` are in the world. `None` where nothing is there to be seen of it.
    pub(super) fn new(weight: f64, roughness: f64, normal: DVec3, out: DVec3) -> Option<Self> {
        let axes = TangentFrame::around(normal);
        let out = axes.local(out);
        (weight > 0.0 && out.z > 0.0).then(|| Self {
            facets: Microfacets::of_roughness(roughness),
            axes,
            out,
            share: weight * (0.04 + 0.96 * fresnel::grazing(out.z)),
        })
    }

    /// The distribution times the cosine, for all that it reflects.
    pub(super) fn value(&self, towards: DVec3) -> f64 {
        let into = self.axes.local(towards);
        if into.z > 0.0 {
            self.facets.reflection(self.out, into) * into.z
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

    pub(super) fn reflected(&self, facet: DVec3) -> DVec3 {
        self.axes
            .world(super::microfacet::reflected(self.out, facet))
    }

    pub(super) fn sample(&self, u: crate::geometry::DVec2) -> DVec3 {
        self.reflected(self.facets.sample(self.out, u))
    }
}
