//! What rays find that surfaces draw themselves.

use super::Shading;
use super::blend::Found;
use super::vertex::{power_share, transmittance};
use crate::geometry::{Color, Filtered, Ray, RayFilter};
use crate::scene::{Scattered, SurfaceInteraction};
use crate::shoot::{First, Hits, trace_into};

/// The first hits of rays that leave surfaces.
pub(super) fn first_hits(shading: &Shading<'_>, rays: &[Ray], filters: &[RayFilter]) -> Hits {
    let mut hits = Hits::default();
    if !rays.is_empty() {
        let rays = Filtered::each(rays, filters);
        let answers = (First, &mut hits);
        let traced = trace_into(shading.engine, shading.scene, &rays, answers, &());
        debug_assert!(traced.is_ok(), "nobody stops it");
    }
    hits
}

/// A ray that a surface has drawn, and which of the light it meets is counted.
pub(super) struct Search<'a> {
    /// The ray, of length one.
    pub(super) ray: &'a Ray,
    pub(super) scattered: &'a Scattered,
    /// It goes on from the camera by mirrors and clear matter alone, so it sees what the camera would.
    pub(super) is_straight: bool,
    /// Whether lights that points are drawn of count too, unless the ray's direction is a single one.
    pub(super) finds_lights: bool,
    /// From here on nothing hides the environment.
    pub(super) reach: f64,
    /// How much of the environment reaches the surface, as far as a map says so.
    pub(super) occlusion: f64,
    /// What is taken away on the way, for each unit of length.
    pub(super) absorption: Color,
}

/// The radiance of all light that a ray meets before a surface hides it, each counted as much as other ways do not find it.
pub(super) fn light_found(shading: &Shading<'_>, search: &Search<'_>, found: &Found) -> Color {
    let length = found.length();
    let mut light = search.lights(shading, length);
    if let Some(surface) = shading.scene.interaction(&found.ray, &found.hit) {
        light += search.emission(shading, &surface, length);
    }
    if length > search.reach || length == f64::INFINITY {
        light += search.environment(shading);
    }
    light
}

impl Search<'_> {
    /// Of lights that are met before a length.
    pub(super) fn lights(&self, shading: &Shading<'_>, length: f64) -> Color {
        let mut sum = Color::ZERO;
        for light in shading.scene.lights() {
            let met = light.met(self.ray.origin, self.ray.direction);
            if let Some(met) = met.filter(|met| met.distance < length || length == f64::INFINITY) {
                let left = transmittance(self.absorption, met.distance);
                sum += self.share_of_light(met.density) * left * met.radiance;
            }
        }
        sum
    }

    /// Of what a surface gives off that the ray meets after a length.
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
        let density = emitters.density(surface, self.ray.origin, length);
        let left = transmittance(self.absorption, length);
        self.share_of_light(density) * left * emitted
    }

    /// Of what is behind everything.
    pub(super) fn environment(&self, shading: &Shading<'_>) -> Color {
        let direction = self.ray.direction;
        match shading.scene.environment() {
            Some(environment) => {
                let share = self.share(environment.density(direction));
                self.occlusion * share * environment.radiance(direction)
            }
            None if self.is_straight => shading.background.color(direction),
            None => Color::ZERO,
        }
    }

    /// How much counts what another way finds with that density.
    fn share(&self, other: f64) -> f64 {
        let own = self.scattered.density;
        own.map_or(1.0, |own| power_share(own, other))
    }

    /// The same of lights.
    fn share_of_light(&self, other: f64) -> f64 {
        let is_left_out = !self.finds_lights && self.scattered.density.is_some() && other > 0.0;
        if is_left_out { 0.0 } else { self.share(other) }
    }
}
