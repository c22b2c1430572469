//! Light that reaches surfaces without a detour: from lights, from surfaces that shine, and from
//! the environment.
//!
//! For each sample of a pixel:
//!
//! 1. Sample a point of each light, one of the emissive surfaces, and a direction of the
//!    environment by its luminance. Ask whether they are seen (`vertex.rs`).
//! 2. Sample a direction by the surface's BSDF, and add all light that a ray meets there
//!    (`found.rs`). On a matte surface where nothing else emits it is enough to ask whether the
//!    environment is seen there.
//!
//! Where both may find the same light, they are weighted (multiple importance sampling). Without
//! shadows only light sampling counts for lights, because BSDF-sampled rays end on things as
//! always; mirrors show lights all the same.

use super::blend::stochastic_hits;
use super::found::{BsdfRay, light_found};
use super::matte::{MatteVertex, SortedVertices, push};
use super::shadow::ShadowRays;
use super::vertex::{Vertex, add_direct_light, first_vertex};
use super::{Points, Shading};
use crate::geometry::rows::ROW;
use crate::geometry::{Color, Domain, settings};

settings! {
    /// The settings of the shader for direct light.
    pub struct Direct {
        /// Whether things cast shadows. The light of the environment they always hide.
        shadows: bool, Domain::Flag, default true;
        /// The distance up to which things hide the environment, in scene units.
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
    // Surfaces that emit are found by BSDF-sampled rays, without shadows those alone that are not
    // drawn.
    let may_find_emitters = settings.shadows && emitters.has_any() || emitters.has_others();
    let mut rows = Vec::with_capacity(points.surfaces.len().div_ceil(ROW));
    let mut vertices = Vec::new();
    for (k, (surface, &draws)) in points.surfaces.iter().zip(&points.draws).enumerate() {
        if !may_find_emitters && let Some(matte) = surface.plain_matte() {
            colors[k] = Color::ZERO;
            if matte.geometric.is_finite() {
                push(&mut rows, &MatteVertex::first(surface, matte, (k, draws)));
            }
            continue;
        }
        let Some(mut vertex) = first_vertex(surface, (k, draws), &mut colors[k]) else {
            continue;
        };
        let is_diffuse = vertex.bsdf.is_diffuse();
        vertex.finds_lights = settings.shadows && (emitters.has_any() || !is_diffuse);
        vertex.occlusion = vertex.bsdf.occlusion();
        match vertex.matte().filter(|_| !may_find_emitters) {
            Some(matte) => push(&mut rows, &matte),
            None => vertices.push(vertex),
        }
    }
    let limits = (settings.shadows, settings.reach);
    if may_find_emitters {
        add_direct_light(shading, &SortedVertices::new(&vertices), limits, colors);
    } else {
        let others = vertices.iter().collect();
        let sorted = SortedVertices { rows, others };
        add_direct_light(shading, &sorted, limits, colors);
        add_environment(settings, shading, &sorted, colors);
    }
    add_bsdf_rays(settings, shading, &vertices, colors);
}

/// Adds the light of the environment that is seen in a direction that each matte surface draws.
fn add_environment(
    settings: &Direct,
    shading: &Shading<'_>,
    sorted: &SortedVertices<'_>,
    colors: &mut [Color],
) {
    let Some(environment) = shading.scene.environment() else {
        return;
    };
    let set = shading.engine.instruction_set();
    let mut rays = ShadowRays::with_capacity(sorted.count());
    for row in &sorted.rows {
        row.push_scattered(set, (environment, settings.reach), &mut rays);
    }
    rays.add_to(colors, shading, true);
}

/// Adds all light that a BSDF-sampled ray of each vertex meets.
fn add_bsdf_rays(
    settings: &Direct,
    shading: &Shading<'_>,
    vertices: &[Vertex],
    colors: &mut [Color],
) {
    let (mut rays, mut filters) = (Vec::new(), Vec::new());
    let (mut drawn, mut draws) = (Vec::new(), Vec::new());
    for vertex in vertices {
        let mut own_draws = vertex.draws;
        if let Some(scattered) = vertex.bsdf.sample(own_draws.three()) {
            let (ray, filter) = vertex.ray(scattered.towards);
            rays.push(ray);
            filters.push(filter);
            drawn.push((vertex, scattered));
            draws.push(own_draws);
        }
    }
    let all_found = stochastic_hits(shading, &rays, &filters, &mut draws);
    for ((ray, (vertex, scattered)), met) in rays.iter().zip(&drawn).zip(&all_found) {
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
