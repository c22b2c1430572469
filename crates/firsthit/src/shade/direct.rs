//! Light that reaches surfaces without a detour: from lights, from surfaces that shine, and from the environment.
//!
//! For each sample of a pixel:
//!
//! 1. Sample a point of each light, one of the emissive surfaces, and a direction of the environment by its luminance. Ask whether
//!    they are seen (`vertex.rs`).
//! 2. Sample a direction by the surface's BSDF, and add all light that a ray meets there (`found.rs`). On a matte surface where nothing else
//!    emits it is enough to ask whether the environment is seen there.
//!
//! Where both may find the same light, they are weighted (multiple importance sampling). Without shadows only light sampling counts for
//! lights, because BSDF-sampled rays end on things as always; mirrors show lights all the same.

use super::blend::found;
use super::found::{BsdfRay, light_found};
use super::shadow::ShadowRays;
use super::vertex::{Vertex, add_direct_light, first_vertices, power_heuristic};
use super::{Points, Shading};
use crate::geometry::{Color, Domain, settings};
use crate::scene::BsdfSample;

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
    let emitters = shading.scene.emitters();
    let mut vertices = first_vertices(points, colors);
    for vertex in &mut vertices {
        vertex.finds_lights = settings.shadows && (emitters.has_any() || !vertex.bsdf.is_diffuse());
        vertex.occlusion = vertex.bsdf.occlusion();
    }
    let limits = (settings.shadows, settings.reach);
    add_direct_light(shading, &vertices, limits, colors);
    add_bsdf_rays(settings, shading, &mut vertices, colors);
}

/// Adds the light that a BSDF-sampled ray of each vertex meets.
fn add_bsdf_rays(
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
        // Other surfaces that emit are found by these rays alone, with shadows or without.
        let searches = vertex.finds_lights || has_others || !vertex.bsdf.is_diffuse();
        if environment.is_none() && !searches {
            continue;
        }
        let Some(scattered) = vertex.bsdf.sample(vertex.draws.three()) else {
            continue;
        };
        let BsdfSample {
            towards,
            weight,
            pdf,
        } = scattered;
        let (ray, filter) = vertex.ray(towards);
        if searches {
            rays.push(ray);
            filters.push(filter);
            drawn.push((k, scattered));
            draws.push(vertex.draws);
        } else if let Some(environment) = environment {
            let others = environment.pdf(towards);
            let share = pdf.map_or(1.0, |own| power_heuristic(own, others));
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
        let bsdf_ray = BsdfRay {
            ray,
            sample: scattered,
            is_specular_path: scattered.pdf.is_none(),
            finds_lights: vertex.finds_lights,
            reach: settings.reach,
            occlusion: vertex.occlusion,
            absorption: vertex.absorption_towards(ray.direction),
        };
        let light = light_found(shading, &bsdf_ray, met);
        colors[vertex.sum] += vertex.throughput * scattered.weight * light;
    }
}
