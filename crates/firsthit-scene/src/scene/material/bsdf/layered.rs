//! glTF's metallic-roughness model with its extensions: a dielectric or a metal, under cloth's
//! fibres, under a clear coat (glTF 2.0, appendix B). There light is reflected once: the light that
//! a rough metal's microfacets send to each other is lost, so that rough metals are darker than
//! real ones. Where a surface is seen from the side, its matte ground gets less than in glTF: see
//! `leftover.rs`.

use std::f64::consts::PI;

use super::coat::Coat;
use super::dielectric::{Dielectric, Split};
use super::frame::Frame;
use super::fresnel;
use super::leftover::Leftover;
use super::lobes::LobeProbabilities;
use super::microfacet::{self, Microfacets, half};
use super::sheen::Sheen;
use crate::geometry::{Color, DVec3};
use crate::sampling::TangentFrame;

/// The material of a surface at a point.
#[derive(Debug, Clone, Copy)]
pub(in crate::scene::material) struct Layers {
    pub(in crate::scene::material) base: Color,
    pub(in crate::scene::material) metallic: f64,
    pub(in crate::scene::material) roughness: f64,
    pub(in crate::scene::material) ior: f64,
    pub(in crate::scene::material) specular: f64,
    pub(in crate::scene::material) specular_color: Color,
    pub(in crate::scene::material) transmission: f64,
    /// The absorption coefficient inside, per scene unit; `None` for a thin wall, which has no
    /// inside.
    pub(in crate::scene::material) absorption: Option<Color>,
    /// Weight, roughness, and the normal in the world on the side that is seen.
    pub(in crate::scene::material) coat: (f64, f64, DVec3),
    pub(in crate::scene::material) sheen: (Color, f64),
}

/// The layers as light meets them. Directions are in the space of the shading normal, whose axis is
/// z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layered {
    pub(super) axes: TangentFrame,
    pub(super) out: DVec3,
    base: Color,
    metallic: f64,
    pub(super) facets: Microfacets,
    dielectric: Dielectric,
    /// The light that the dielectric leaves to the diffuse base; `None` without a base.
    pub(super) leftover: Option<Leftover>,
    transmission: f64,
    /// The index of the other side divided by that of the side that is seen; `None` for a thin
    /// wall.
    pub(super) ior: Option<f64>,
    pub(super) sheen: Option<Sheen>,
    pub(super) coat: Option<Coat>,
    /// The probabilities of drawing each lobe.
    pub(super) lobes: LobeProbabilities,
}

impl Layered {
    pub(super) fn new(frame: &Frame, layers: &Layers, is_front: bool) -> Self {
        let axes = TangentFrame::around(frame.normal);
        let out = axes.local(frame.out);
        let (weight, roughness, normal) = layers.coat;
        // Of zero, which in glTF stands for a mirror (KHR_materials_ior), a solid is one as well.
        let inside = if layers.ior > 0.0 { layers.ior } else { 1e9 };
        let ratio = if is_front { inside } else { 1.0 / inside };
        let dielectric = Dielectric::new(layers.ior, layers.specular, layers.specular_color);
        let has_ground = layers.metallic < 1.0 && layers.transmission < 1.0;
        let leftover = || Leftover::new(layers.roughness, dielectric.lightest(), out.z);
        let mut layered = Self {
            axes,
            out,
            base: layers.base,
            metallic: layers.metallic,
            facets: Microfacets::of_roughness(layers.roughness),
            dielectric,
            leftover: has_ground.then(leftover),
            transmission: layers.transmission,
            ior: layers.absorption.map(|_| ratio),
            sheen: Sheen::new(layers.sheen.0, layers.sheen.1, out),
            coat: Coat::new(weight, roughness, Frame { normal, ..*frame }),
            lobes: LobeProbabilities::default(),
        };
        layered.lobes = layered.lobe_probabilities();
        layered
    }

    /// Whether light that goes through has a single direction: where the surface is smooth, and
    /// where both sides have the same index, so that no facet turns it.
    pub(super) fn is_straight_through(&self) -> bool {
        self.facets.is_smooth() || self.ior == Some(1.0)
    }

    /// The split at clear matter, a thin wall or the boundary of a solid.
    fn clear(&self, cosine: f64) -> Split {
        match self.ior {
            Some(ior) => self.dielectric.exact(cosine, ior),
            None => self.dielectric.schlick(cosine),
        }
    }

    /// The reflectance of microfacets that are met with this cosine.
    pub(super) fn specular(&self, cosine: f64) -> Color {
        let opaque = self.dielectric.schlick(cosine).reflected;
        let clear = self.clear(cosine).reflected;
        let dielectric = opaque.lerp(clear, self.transmission);
        dielectric.lerp(fresnel::schlick(self.base, cosine), self.metallic)
    }

    /// The albedo of the matte base under microfacets that are met with this cosine.
    pub(super) fn diffuse(&self, cosine: f64) -> Color {
        let share = (1.0 - self.metallic) * (1.0 - self.transmission);
        share * self.dielectric.schlick(cosine).on * self.base
    }

    /// The colour of the matte base, as much as there is of it.
    pub(super) fn ground(&self) -> Color {
        (1.0 - self.metallic) * (1.0 - self.transmission) * self.base
    }

    /// The transmittance of microfacets that are met with this cosine.
    pub(super) fn passed(&self, cosine: f64) -> Color {
        let share = (1.0 - self.metallic) * self.transmission;
        share * self.clear(cosine).on * self.base
    }

    /// The share of light from a direction that the layers above the microfacets let through.
    pub(super) fn left(&self, into: DVec3) -> f64 {
        let under_fibres = self.sheen.map_or(1.0, |sheen| sheen.left(into));
        under_fibres * (1.0 - self.coat.map_or(0.0, |coat| coat.share))
    }

    /// The scattering distribution times the cosine, of light from `towards` in the world.
    pub(super) fn value(&self, frame: &Frame, towards: DVec3) -> Color {
        let into = self.axes.local(towards);
        let flat = towards.dot(frame.geometric);
        if flat > 0.0 {
            let coat = (self.coat).map_or(0.0, |coat| coat.share * coat.value(towards));
            let below = if into.z > 0.0 {
                frame.share(towards) * self.reflected(into)
            } else {
                Color::ZERO
            };
            below + coat
        } else if into.z < 0.0 && flat < 0.0 && self.transmission > 0.0 {
            self.left(into) * -into.z * self.transmitted(into)
        } else {
            Color::ZERO
        }
    }

    /// The reflected light of all layers below the coat.
    fn reflected(&self, into: DVec3) -> Color {
        let cosine = self.out.dot(half(self.out, into));
        let facets = self.facets.reflection(self.out, into);
        let left = (self.leftover).map_or(0.0, |leftover| leftover.share(into.z));
        let under = left * self.diffuse(cosine) / PI + facets * self.specular(cosine);
        let mut value = self.left(into) * into.z * under;
        let uncoated = 1.0 - self.coat.map_or(0.0, |coat| coat.share);
        if let Some(sheen) = &self.sheen {
            value += uncoated * into.z * sheen.value(self.out, into);
        }
        value
    }

    fn transmitted(&self, into: DVec3) -> Color {
        if self.is_straight_through() {
            return Color::ZERO;
        }
        if let Some(ior) = self.ior {
            let Some(facet) = Microfacets::refracting(self.out, into, ior) else {
                return Color::ZERO;
            };
            let cosine = self.out.dot(facet.0);
            let through = self.facets.refraction((self.out, into), facet, ior);
            through * self.passed(cosine)
        } else {
            let into = microfacet::thin(into);
            let cosine = self.out.dot(half(self.out, into));
            self.facets.reflection(self.out, into) * self.passed(cosine)
        }
    }
}
