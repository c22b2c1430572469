//! The scattering model of a material: glTF's metallic-roughness with its extensions.

use super::super::report::Report;
use super::material_entry::{Diffuse, MaterialEntry};
use super::place::Entry;
use crate::geometry::Color;
use crate::scene::{Matte, MetalRough, Model};

/// Numbers of a material; those out of their range are moved into it, which is one warning.
pub(super) struct MaterialNumbers<'a, 'w> {
    pub(super) entry: Entry,
    pub(super) report: &'a mut Report<'w>,
}

/// The brightest light: more than any real one, and less than its sums can bear.
const BRIGHTEST: f64 = 1e30;

impl MaterialNumbers<'_, '_> {
    fn within(&mut self, (least, most): (f64, f64), number: f64, name: &'static str) -> f64 {
        if (least..=most).contains(&number) {
            return number;
        }
        let taken = if number < least { least } else { most };
        self.report.warn("material range", &self.entry.at(name), || {
            format!("must be from {least} to {most}, got {number}: {taken} is taken")
        });
        taken
    }

    /// A number from 0 to 1.
    fn share(&mut self, number: Option<f64>, usual: f64, name: &'static str) -> f64 {
        self.within((0.0, 1.0), number.unwrap_or(usual), name)
    }

    /// A colour of numbers that are not negative.
    fn color(&mut self, color: [f64; 3], name: &'static str) -> Color {
        Color::from(color.map(|level| self.within((0.0, BRIGHTEST), level, name)))
    }

    /// A colour that nothing reflects more than all of.
    fn reflectance(&mut self, color: [f64; 3], name: &'static str) -> Color {
        Color::from(color.map(|level| self.within((0.0, 1.0), level, name)))
    }

    /// The linear colour, and alpha.
    pub(super) fn base(&mut self, material: &MaterialEntry<'_>) -> (Color, f64) {
        let (factor, name) = material.base();
        let [red, green, blue, alpha] = factor;
        let color = self.reflectance([red, green, blue], name);
        (color, self.share(Some(alpha), 1.0, name))
    }

    /// The radiance that the material gives off.
    pub(super) fn emission(&mut self, material: &MaterialEntry<'_>) -> Color {
        let strength = material.extensions.emissive_strength.as_ref();
        let strength = strength.and_then(|entry| entry.emissive_strength);
        let strength = self.within((0.0, BRIGHTEST), strength.unwrap_or(1.0), "emissiveStrength");
        let factor = self.reflectance(material.emissive_factor, "emissiveFactor");
        (strength * factor).min(Color::splat(BRIGHTEST))
    }

    /// The scale of a normal map: any number, but for those that are beyond all use.
    pub(super) fn scale(&mut self, scale: Option<f64>) -> f64 {
        self.within((-100.0, 100.0), scale.unwrap_or(1.0), "normalTexture/scale")
    }

    /// The weight of the occlusion map.
    pub(super) fn strength(&mut self, strength: Option<f64>) -> f64 {
        self.share(strength, 1.0, "occlusionTexture/strength")
    }

    /// The scattering model of a material.
    pub(super) fn model(&mut self, material: &MaterialEntry<'_>) -> Model {
        let extensions = &material.extensions;
        if extensions.unlit.is_some() {
            return Matte.into();
        }
        let mut model = if let Some(diffuse) = &extensions.diffuse {
            self.glossy(diffuse)
        } else {
            let pbr = &material.pbr_metallic_roughness;
            MetalRough {
                metallic: self.share(pbr.metallic_factor, 1.0, "metallicFactor"),
                roughness: self.share(pbr.roughness_factor, 1.0, "roughnessFactor"),
                ..MetalRough::default()
            }
        };
        self.reflection(material, &mut model);
        self.inside(material, &mut model);
        self.layers(material, &mut model);
        model.into()
    }

    /// The older model: a ground and a reflection, each of its colour. With an infinite index the
    /// reflection has its colour head on.
    fn glossy(&mut self, entry: &Diffuse) -> MetalRough {
        let specular = entry.specular_factor.unwrap_or([1.0; 3]);
        MetalRough {
            roughness: 1.0 - self.share(entry.glossiness_factor, 1.0, "glossinessFactor"),
            ior: 0.0,
            specular_color: self.reflectance(specular, "specularFactor"),
            ..MetalRough::default()
        }
    }

    fn reflection(&mut self, material: &MaterialEntry<'_>, model: &mut MetalRough) {
        let ior = material.extensions.ior.as_ref().and_then(|entry| entry.ior);
        match ior {
            // A mirror, for models that have no index.
            Some(0.0) => model.ior = 0.0,
            Some(ior) => model.ior = self.within((1.0, 100.0), ior, "ior"),
            None => {}
        }
        if let Some(entry) = &material.extensions.specular {
            let color = entry.specular_color_factor.unwrap_or([1.0; 3]);
            model.specular = self.share(entry.specular_factor, 1.0, "specularFactor");
            model.specular_color = self.color(color, "specularColorFactor");
        }
    }

    fn inside(&mut self, material: &MaterialEntry<'_>, model: &mut MetalRough) {
        let extensions = &material.extensions;
        if let Some(entry) = &extensions.transmission {
            model.transmission = self.share(entry.transmission_factor, 0.0, "transmissionFactor");
        }
        let Some(entry) = &extensions.volume else {
            return;
        };
        // How thick it is tells the way of the rays.
        model.solid = entry.thickness_factor.is_some_and(|thickness| thickness > 0.0);
        let color = entry.attenuation_color.unwrap_or([1.0; 3]);
        model.attenuation_color = self.reflectance(color, "attenuationColor");
        if let Some(distance) = entry.attenuation_distance {
            model.attenuation_distance =
                self.within((1e-30, BRIGHTEST), distance, "attenuationDistance");
        }
    }

    fn layers(&mut self, material: &MaterialEntry<'_>, model: &mut MetalRough) {
        if let Some(entry) = &material.extensions.clearcoat {
            let scale = entry.clearcoat_normal_texture.as_ref();
            model.clearcoat = self.share(entry.clearcoat_factor, 0.0, "clearcoatFactor");
            model.clearcoat_roughness =
                self.share(entry.clearcoat_roughness_factor, 0.0, "clearcoatRoughnessFactor");
            model.clearcoat_normal_scale = self.scale(scale.and_then(|info| info.scale));
        }
        if let Some(entry) = &material.extensions.sheen {
            let color = entry.sheen_color_factor.unwrap_or([0.0; 3]);
            model.sheen_color = self.reflectance(color, "sheenColorFactor");
            model.sheen_roughness =
                self.share(entry.sheen_roughness_factor, 0.0, "sheenRoughnessFactor");
        }
    }
}
