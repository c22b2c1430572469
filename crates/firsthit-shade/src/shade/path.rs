//! Path tracing: light that reaches the camera by any number of surfaces (Kajiya, "The Rendering
//! Equation", SIGGRAPH 1986).
//!
//! 1. At each vertex of a path add the light of sampled lights (next-event estimation,
//!    `vertex.rs`).
//! 2. Sample a direction by the surface's BSDF, and add the light that a ray meets there
//!    (`found.rs`). Where both may find the same light, they are weighted (multiple importance
//!    sampling).
//! 3. The surface that the ray meets is the next vertex. After some vertices a path continues by
//!    chance only, the rarer the less it can bring, and counts as much more (Russian roulette; Arvo
//!    and Kirk, "Particle Transport and Image Synthesis", SIGGRAPH 1990). The share that refraction
//!    takes of its light does not count there, because leaving the medium gives it back.
//!
//! All paths of a batch take each step together, so that their rays are shot together.

use super::blend::{StochasticHit, stochastic_hits};
use super::found::{BsdfRay, light_found};
use super::matte::SortedVertices;
use super::vertex::{PathSegment, Vertex, add_direct_light, first_vertices, transmittance};
use super::{Points, Shading};
use crate::geometry::{Color, Domain, Ray, RayFilter, settings};
use crate::sampling::Draws;
use crate::scene::BsdfSample;

settings! {
    /// The settings of the path tracer.
    pub struct Path {
        /// The most scatterings of light on its way to the camera: with 1 it arrives straight from
        /// lights.
        depth: u32, Domain::Whole(1, 1024), default 8;
        /// The number of scatterings after which paths that bring little end by chance.
        roulette: u32, Domain::Whole(1, 1024), default 3;
    }
}

pub(super) fn shade(
    settings: &Path,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    let mut vertices = first_vertices(points, colors);
    for depth in 1..=settings.depth {
        for vertex in &mut vertices {
            vertex.finds_lights = true;
        }
        let sorted = SortedVertices::new(&vertices);
        add_direct_light(shading, &sorted, (true, f64::INFINITY), colors);
        let roulette = depth >= settings.roulette;
        let mut drawn: Vec<Drawn> =
            vertices.iter_mut().filter_map(|vertex| drawn(vertex, roulette)).collect();
        let rays: Vec<Ray> = drawn.iter().map(|drawn| drawn.ray).collect();
        let filters: Vec<RayFilter> = drawn.iter().map(|drawn| drawn.filter).collect();
        let mut draws: Vec<Draws> = drawn.iter().map(|drawn| drawn.draws).collect();
        let all_found = stochastic_hits(shading, &rays, &filters, &mut draws);
        vertices.clear();
        for (index, drawn) in drawn.iter_mut().enumerate() {
            drawn.draws = draws[index];
            let met = &all_found[index];
            let bsdf_ray = BsdfRay {
                ray: &drawn.ray,
                sample: &drawn.scattered,
                is_specular_path: drawn.is_specular_path,
                finds_lights: true,
                reach: f64::INFINITY,
                occlusion: 1.0,
                absorption: drawn.absorption,
            };
            let light = light_found(shading, &bsdf_ray, met);
            colors[drawn.sum] += drawn.throughput * light;
            if depth < settings.depth {
                vertices.extend(next(shading, drawn, met, colors));
            }
        }
        if vertices.is_empty() {
            break;
        }
    }
}

/// A BSDF-sampled ray.
struct Drawn {
    ray: Ray,
    filter: RayFilter,
    scattered: BsdfSample,
    /// The factor on the light that the ray meets.
    throughput: Color,
    /// The absorption coefficient on its way, per scene unit.
    absorption: Color,
    sum: usize,
    draws: Draws,
    is_specular_path: bool,
    /// See [`Vertex`].
    eta_scale: f64,
}

/// A BSDF-sampled ray from a vertex; `None` where the path ends.
fn drawn(vertex: &mut Vertex, roulette: bool) -> Option<Drawn> {
    let scattered = vertex.bsdf.sample(vertex.draws.three())?;
    let mut throughput = vertex.throughput * scattered.weight;
    let eta = vertex.bsdf.eta(scattered.towards);
    let eta_scale = vertex.eta_scale * eta * eta;
    if roulette {
        let chance = (eta_scale * throughput.max_element()).min(1.0);
        // Written so that a NaN fails.
        let goes_on = vertex.draws.one() < chance;
        if !goes_on {
            return None;
        }
        throughput /= chance;
    }
    let (ray, filter) = vertex.ray(scattered.towards);
    Some(Drawn {
        ray,
        filter,
        scattered,
        throughput,
        absorption: vertex.absorption_towards(scattered.towards),
        sum: vertex.sum,
        draws: vertex.draws,
        is_specular_path: vertex.is_specular_path && scattered.pdf.is_none(),
        eta_scale,
    })
}

/// The vertex where a ray meets a surface; `None` for a miss, and for a surface whose colour does
/// not depend on light. That is seen in mirrors as the camera sees it, and gives others no light.
fn next(
    shading: &Shading<'_>,
    drawn: &Drawn,
    met: &StochasticHit,
    colors: &mut [Color],
) -> Option<Vertex> {
    let surface = shading.scene.interaction(&met.ray, &met.hit)?;
    if surface.is_unlit() {
        if drawn.is_specular_path {
            let left = transmittance(drawn.absorption, met.length());
            colors[drawn.sum] += drawn.throughput * left * surface.color();
        }
        return None;
    }
    let segment = PathSegment {
        throughput: drawn.throughput,
        absorption: drawn.absorption,
        length: met.length(),
    };
    let mut vertex = Vertex::new(&surface, drawn.sum, drawn.draws, segment)?;
    vertex.is_specular_path = drawn.is_specular_path;
    vertex.eta_scale = drawn.eta_scale;
    Some(vertex)
}
