//! Light that reaches surfaces without a detour: from lights, from surfaces that shine, and from the environment.
//!
//! For each sample of a pixel:
//!
//! 1. Draw a point of each light, one of the surfaces that shine, and a direction of the environment where bright ones are drawn more
//!    often. Ask whether they are seen (`vertex.rs`).
//! 2. Let the surface draw a direction itself. If it scatters light evenly, ask whether the environment is seen there; if not, see
//!    what light is there.
//!
//! Where two of these may find the same light, each is weighted by how likely it found it. Without shadows only drawn points count, since
//! a surface's own rays are hidden from lights as always; a mirror shows lights all the same.

use super::blend::found;
use super::found::{Search, light_found};
use super::shadow::ShadowRays;
use super::vertex::{Vertex, add_direct_light, first_vertices, power_share};
use super::{Points, Shading};
use crate::geometry::{Color, Domain, settings};
use crate::scene::Scattered;

settings! {
    /// The settings of the shader for direct light.
    pub struct Direct {
        /// Whether things cast shadows. The light of the environment they always hide.
        shadows: bool, Domain::Flag, default true;
        /// How far away things hide the environment, in scene units.
        reach: f64, Domain::PositiveOrInfinite, default f64::INFINITY;
    }
}

pub(super) fn shade(
    settings: &Direct,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    let has_others = shading.scene.emitters().has_others();
    let mut vertices = first_vertices(points, colors);
    for vertex in &mut vertices {
        vertex.finds_lights = settings.shadows && (has_others || !vertex.scattering.is_diffuse());
        vertex.occlusion = vertex.scattering.occlusion();
    }
    let limits = (settings.shadows, settings.reach);
    add_direct_light(shading, &vertices, limits, colors);
    add_own_rays(settings, shading, &mut vertices, colors);
}

/// Adds what is found in a direction that each surface draws.
fn add_own_rays(
    settings: &Direct,
    shading: &Shading<'_>,
    vertices: &mut [Vertex],
    colors: &mut [Color],
) {
    let environment = shading.scene.environment();
    let has_others = shading.scene.emitters().has_others();
    let mut shadow_rays = ShadowRays::with_capacity(vertices.len());
    let (mut rays, mut filters) = (Vec::new(), Vec::new());
    let (mut drawn, mut draws) = (Vec::new(), Vec::new());
    for (k, vertex) in vertices.iter_mut().enumerate() {
        let searches = has_others || !vertex.scattering.is_diffuse();
        if environment.is_none() && !searches {
            continue;
        }
        let Some(scattered) = vertex.scattering.sample(vertex.draws.three()) else {
            continue;
        };
        let Scattered {
            towards,
            weight,
            density,
        } = scattered;
        let (ray, filter) = vertex.ray(towards);
        if searches {
            rays.push(ray);
            filters.push(filter);
            drawn.push((k, scattered));
            draws.push(vertex.draws);
        } else if let Some(environment) = environment {
            let others = environment.density(towards);
            let share = density.map_or(1.0, |own| power_share(own, others));
            let light = share
                * vertex.occlusion
                * vertex.throughput
                * weight
                * environment.radiance(towards);
            shadow_rays.push((ray.up_to(settings.reach), filter), vertex.sum, light);
        }
    }
    shadow_rays.add_to(colors, shading, true);
    let all_found = found(shading, &rays, &filters, &mut draws);
    for ((ray, (k, scattered)), met) in rays.iter().zip(&drawn).zip(&all_found) {
        let vertex = &vertices[*k];
        let search = Search {
            ray,
            scattered,
            is_straight: scattered.density.is_none(),
            finds_lights: vertex.finds_lights,
            reach: settings.reach,
            occlusion: vertex.occlusion,
            absorption: vertex.absorption_towards(ray.direction),
        };
        let light = light_found(shading, &search, met);
        colors[vertex.sum] += vertex.throughput * scattered.weight * light;
    }
}
