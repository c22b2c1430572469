//! Light that reaches surfaces without a detour: from lights, from surfaces that shine, and from the environment.
//!
//! For each sample of a pixel:
//!
//! 1. Draw a point of each light, one of the surfaces that shine, and a direction of the environment where bright ones are drawn more
//!    often. Ask whether they are seen (`vertex.rs`).
//! 2. Let the surface draw a direction itself. If it scatters light evenly, ask whether the environment is seen there; if not, see
//!    what light is there.
//!
//! Where two of these may find the same light, each is weighted by how likely it found it.

use super::blend::Found;
use super::found::{first_hits, light_found};
use super::shadow::ShadowRays;
use super::vertex::{Vertex, add_direct_light, first_vertices, power_share};
use super::{Points, Shading};
use crate::geometry::{Color, Domain, Hit, settings};
use crate::scene::Scattered;

settings! {
    /// The settings of the shader for direct light.
    pub struct Direct {
        /// Whether things cast shadows. The light of the environment they always hide.
        shadows: bool, Domain::Flag, usual true;
        /// How far away things hide the environment, in scene units.
        reach: f64, Domain::Reach, usual f64::INFINITY;
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
        vertex.finds_lights = has_others || !vertex.scattering.is_diffuse();
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
    let mut shadow_rays = ShadowRays::with_capacity(vertices.len());
    let (mut rays, mut filters, mut drawn) = (Vec::new(), Vec::new(), Vec::new());
    for (k, vertex) in vertices.iter_mut().enumerate() {
        if environment.is_none() && !vertex.finds_lights {
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
        if vertex.finds_lights {
            rays.push(ray);
            filters.push(filter);
            drawn.push((k, scattered));
        } else if let Some(environment) = environment {
            let others = environment.density(towards);
            let share = density.map_or(1.0, |own| power_share(own, others));
            let share = share * vertex.scattering.occlusion();
            let light = share * weight * environment.radiance(towards);
            shadow_rays.push((ray.up_to(settings.reach), filter), vertex.sum, light);
        }
    }
    shadow_rays.add_to(colors, shading, true);
    let hits = first_hits(shading, &rays, &filters);
    for (index, (ray, (k, scattered))) in rays.iter().zip(&drawn).enumerate() {
        let mut hit = hits.get(index);
        if hit.t > settings.reach {
            hit = Hit::MISS;
        }
        let met = Found {
            ray: *ray,
            hit,
            before: 0.0,
        };
        let is_straight = scattered.density.is_none();
        let found = light_found(shading, (ray, &met), scattered, is_straight);
        colors[vertices[*k].sum] += scattered.weight * found;
    }
}
