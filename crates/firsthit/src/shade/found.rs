//! What rays find that surfaces draw themselves.

use super::Shading;
use super::blend::Found;
use super::vertex::power_share;
use crate::geometry::{Color, Filtered, Ray, RayFilter};
use crate::scene::Scattered;
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

/// The radiance of lights that a ray of length one finds before anything else, each counted as much as other ways do not find it.
///
/// `is_straight`: the ray goes on from the camera by mirrors and clear matter alone, so it sees what the camera would.
pub(super) fn light_found(
    shading: &Shading<'_>,
    (ray, found): (&Ray, &Found),
    scattered: &Scattered,
    is_straight: bool,
) -> Color {
    let Found { hit, before, .. } = found;
    let length = before + hit.t;
    let share = |other: f64| scattered.density.map_or(1.0, |own| power_share(own, other));
    let mut light_found = Color::ZERO;
    for light in shading.scene.lights() {
        let met = light.met(ray.origin, ray.direction);
        if let Some(met) = met.filter(|met| met.distance < length || hit.is_miss()) {
            light_found += share(met.density) * met.radiance;
        }
    }
    if let Some(surface) = shading.scene.interaction(&found.ray, hit) {
        let emitted = surface.emitted();
        if emitted != Color::ZERO {
            // Directions are as dense as the surface is far: from the start of the whole ray.
            let farther = length / hit.t;
            let density = shading.scene.emitters().density(&surface) * farther * farther;
            light_found += share(density) * emitted;
        }
        return light_found;
    }
    match shading.scene.environment() {
        Some(environment) => {
            light_found
                + share(environment.density(ray.direction)) * environment.radiance(ray.direction)
        }
        None if is_straight => light_found + shading.background.color(ray.direction),
        None => light_found,
    }
}
