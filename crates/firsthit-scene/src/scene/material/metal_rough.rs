//! glTF's materials: metallic-roughness with most of its extensions.

use super::bsdf::{Bsdf, Frame, Layers, coat_share};
use crate::geometry::{Color, Domain, settings, unit};
use crate::scene::{MapRole, SurfaceInteraction};

settings! {
    /// A metal, or what is none: glTF's metallic-roughness model, its names those of glTF. The
    /// material's colour is that of a metal's reflection, of the ground below another boundary, or
    /// of what passes through.
    pub struct MetalRough {
        /// From 0, no metal, to 1. Default: 0.
        metallic: f64, Domain::From(0.0, 1.0), default 0.0;
        /// From 0, a mirror, to 1. Default: 0.5.
        roughness: f64, Domain::From(0.0, 1.0), default 0.5;
        /// The index of refraction of what is no metal; 0 stands for infinity, as in glTF. Default:
        /// 1.5.
        ior: f64, Domain::From(0.0, 100.0), default 1.5;
        /// The factor on the specular reflection of dielectrics. Default: 1.
        specular: f64, Domain::From(0.0, 1.0), default 1.0;
        /// The colour of its reflection, of what is no metal. Default: [1, 1, 1].
        specular_color: Color, Domain::Color, default Color::ONE;
        /// The share of the light that is not reflected that goes through. Default: 0.
        transmission: f64, Domain::From(0.0, 1.0), default 0.0;
        /// Whether the surface is that of a solid, which refracts light. Default: false, it is a
        /// thin wall, as a soap bubble.
        solid: bool, Domain::Flag, default false;
        /// The colour of white light after the attenuation distance inside a solid. Default: [1, 1,
        /// 1].
        attenuation_color: Color, Domain::Color, default Color::ONE;
        /// The way on which light takes the attenuation colour. Default: infinite.
        attenuation_distance: f64, Domain::PositiveOrInfinite, default f64::INFINITY;
        /// The weight of the clear coat. Default: 0.
        clearcoat: f64, Domain::From(0.0, 1.0), default 0.0;
        /// The roughness of the coat, from 0, a mirror, to 1. Default: 0.
        clearcoat_roughness: f64, Domain::From(0.0, 1.0), default 0.0;
        /// The factor on the steepness of the coat's normal map. Default: 1.
        clearcoat_normal_scale: f64, Domain::From(-100.0, 100.0), default 1.0;
        /// The colour of fibres, as of cloth. Default: [0, 0, 0].
        sheen_color: Color, Domain::Color, default Color::ZERO;
        /// The roughness of the fibres, from 0 to 1. Default: 0.
        sheen_roughness: f64, Domain::From(0.0, 1.0), default 0.0;
    }
}

// Of red, green, blue and alpha, the ones that maps are in.
const R: usize = 0;
const G: usize = 1;
const B: usize = 2;
const A: usize = 3;

/// A factor, times what a channel of a map says where there is one.
fn number(surface: &SurfaceInteraction<'_>, role: MapRole, channel: usize, factor: f64) -> f64 {
    let map = surface.mapped(role);
    map.map_or(factor, |value| factor * value[channel])
}

impl MetalRough {
    /// The share of light that the coat reflects towards the viewer (`KHR_materials_clearcoat`,
    /// with the coat's own normal).
    pub(super) fn coat_share(&self, surface: &SurfaceInteraction<'_>) -> f64 {
        let weight = number(surface, MapRole::Clearcoat, R, self.clearcoat);
        if weight <= 0.0 {
            return 0.0;
        }
        let normal = surface.mapped_coat_normal(self.clearcoat_normal_scale, 1.0);
        let normal = normal.unwrap_or_else(|| surface.shading_normal());
        coat_share(weight, unit(surface.ray().direction).dot(normal).abs())
    }

    pub(super) fn bsdf(&self, surface: &SurfaceInteraction<'_>, frame: Frame, side: f64) -> Bsdf {
        let number = |role, channel, factor| number(surface, role, channel, factor);
        let color = |role, factor: Color| {
            surface.mapped(role).map_or(factor, |[r, g, b, _]| factor * Color::new(r, g, b))
        };
        let metal = surface.mapped(MapRole::MetallicRoughness);
        let [rough, metal] = [G, B].map(|channel| metal.map_or(1.0, |value| value[channel]));
        let coat_normal = surface.mapped_coat_normal(self.clearcoat_normal_scale, side);
        let layers = Layers {
            base: surface.color(),
            metallic: self.metallic * metal,
            roughness: self.roughness * rough,
            ior: self.ior,
            specular: number(MapRole::Specular, A, self.specular),
            specular_color: color(MapRole::SpecularColor, self.specular_color),
            transmission: number(MapRole::Transmission, R, self.transmission),
            absorption: self.solid.then(|| self.absorption()),
            coat: (
                number(MapRole::Clearcoat, R, self.clearcoat),
                number(MapRole::ClearcoatRoughness, G, self.clearcoat_roughness),
                coat_normal.unwrap_or(frame.normal),
            ),
            sheen: (
                color(MapRole::SheenColor, self.sheen_color),
                number(MapRole::SheenRoughness, A, self.sheen_roughness),
            ),
        };
        let normal = surface.mapped_normal(side).unwrap_or(frame.normal);
        Bsdf::layered(Frame { normal, ..frame }, side > 0.0, &layers)
    }

    /// The absorption coefficient inside a solid, per scene unit.
    pub fn absorption(&self) -> Color {
        let each = |share: f64| -libm::log(share.clamp(1e-6, 1.0)) / self.attenuation_distance;
        Color::from(self.attenuation_color.to_array().map(each))
    }
}
