//! The light that BSDF-sampled rays meet.

use super::Shading;
use super::blend::StochasticHit;
use super::vertex::{power_heuristic, transmittance};
use crate::geometry::{Color, Filtered, Ray, RayFilter, is_light};
use crate::scene::{BsdfSample, SurfaceInteraction};
use crate::shoot::{First, Hits, trace_into};

/// The first hits of rays that leave surfaces.
pub(super) fn first_hits(shading: &Shading<'_>, rays: &[Ray], filters: &[RayFilter]) -> Hits {
    let mut hits = Hits::default();
    if !rays.is_empty() {
        let rays = Filtered::each(rays, filters);
        let answers = (First, &mut hits);
        let traced = trace_into(shading.engine, shading.scene, &rays, answers, &());
        debug_assert!(traced.is_ok(), "no watch can stop it");
    }
    hits
}

/// A BSDF-sampled ray, and which of the light that it meets counts.
pub(super) struct BsdfRay<'a> {
    /// The ray; its direction has length one.
    pub(super) ray: &'a Ray,
    pub(super) sample: &'a BsdfSample,
    /// Whether the ray comes from the camera by mirrors and clear matter alone, so that it sees the
    /// camera's background.
    pub(super) is_specular_path: bool,
    /// Whether sampled lights count too. With a ray of a single direction, as in a mirror, they
    /// always do.
    pub(super) finds_lights: bool,
    /// Surfaces farther away than this do not hide the environment, in scene units.
    pub(super) reach: f64,
    /// The share of the environment that the material's occlusion map lets through.
    pub(super) occlusion: f64,
    /// The absorption coefficient on its way, per scene unit.
    pub(super) absorption: Color,
}

/// The radiance of all light that a ray meets before a surface hides it, weighted against light
/// sampling (multiple importance sampling).
pub(super) fn light_found(
    shading: &Shading<'_>,
    bsdf_ray: &BsdfRay<'_>,
    found: &StochasticHit,
) -> Color {
    let length = found.length();
    let mut light = bsdf_ray.lights(shading, length);
    if let Some(surface) = shading.scene.interaction(&found.ray, &found.hit) {
        light += bsdf_ray.emission(shading, &surface, length);
    }
    if length > bsdf_ray.reach || length == f64::INFINITY {
        light += bsdf_ray.environment(shading);
    }
    light
}

impl BsdfRay<'_> {
    /// The light of the lights that are met before a length.
    pub(super) fn lights(&self, shading: &Shading<'_>, length: f64) -> Color {
        let mut sum = Color::ZERO;
        for light in shading.scene.lights() {
            let met = light.intersect(self.ray.origin, self.ray.direction);
            if let Some(met) = met.filter(|met| met.is_visible_before(self.ray, length)) {
                let left = transmittance(self.absorption, met.distance);
                let light = self.share_of_light(met.pdf) * left * met.radiance;
                if is_light(light) {
                    sum += light;
                }
            }
        }
        sum
    }

    /// The emission of a surface that the ray meets after a length.
    pub(super) fn emission(
        &self,
        shading: &Shading<'_>,
        surface: &SurfaceInteraction<'_>,
        length: f64,
    ) -> Color {
        let emitted = surface.emitted();
        if emitted == Color::ZERO {
            return Color::ZERO;
        }
        // From the start of the whole ray, which may have come through translucent surfaces.
        let emitters = shading.scene.emitters();
        let pdf = emitters.pdf(surface, self.ray.origin, length);
        let left = transmittance(self.absorption, length);
        self.share_of_light(pdf) * left * emitted
    }

    /// The light of the environment, or of the background where the camera would see that.
    pub(super) fn environment(&self, shading: &Shading<'_>) -> Color {
        let direction = self.ray.direction;
        match shading.scene.environment() {
            Some(environment) => {
                let share = self.share(environment.pdf(direction));
                self.occlusion * share * environment.radiance(direction)
            }
            None if self.is_specular_path => shading.background.color(direction),
            None => Color::ZERO,
        }
    }

    /// The weight beside another technique of that probability density.
    fn share(&self, other: f64) -> f64 {
        let own = self.sample.pdf;
        own.map_or(1.0, |own| power_heuristic(own, other))
    }

    /// The weight beside a light's sampling; 0 where the ray leaves lights out.
    fn share_of_light(&self, other: f64) -> f64 {
        let is_left_out = !self.finds_lights && self.sample.pdf.is_some() && other > 0.0;
        if is_left_out { 0.0 } else { self.share(other) }
    }
}
