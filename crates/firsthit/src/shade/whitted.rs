//! Mirrors and clear matter without noise: each ray that meets them goes on as a reflected and a refracted one (Whitted, "An Improved
//! Illumination Model for Shaded Display", Communications of the ACM 23(6), 1980), with exact Fresnel weights.

use super::blend::Found;
use super::found::{first_hits, light_found};
use super::shadow::ShadowRays;
use super::vertex::Vertex;
use super::{Points, Shading};
use crate::geometry::{Color, DVec2, Domain, Hit, Ray, RayFilter, settings, unit};
use crate::sampling::Draws;
use crate::scene::{Scattered, SurfaceInteraction};

settings! {
    /// The settings of Whitted's shader.
    pub struct Whitted {
        /// Light from everywhere, which nothing blocks, on surfaces that are neither mirrors nor clear.
        ambient: Color, Domain::Color, usual Color::splat(0.25);
        /// Whether things cast shadows. They are hard, and clear things cast them too.
        shadows: bool, Domain::Flag, usual true;
        /// How many times a ray is reflected at most. To pass through clear surfaces does not count.
        depth: u32, Domain::Whole(0, 64), usual 16;
        /// Rays that bring less than this share of their light end.
        least: f64, Domain::From(0.0, 1.0), usual 1e-4;
    }
}

/// How many mirrors and clear surfaces a ray goes by at most.
const MOST: u32 = 128;

/// A surface that was met, and how many times its ray was reflected.
struct Seen {
    vertex: Vertex,
    reflections: u32,
}

/// A ray that goes on from a mirror or clear matter.
struct Branch {
    ray: Ray,
    filter: RayFilter,
    scattered: Scattered,
    throughput: Color,
    sum: usize,
    reflections: u32,
}

pub(super) fn shade(
    settings: &Whitted,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    colors.fill(Color::ZERO);
    let mut seen = Vec::with_capacity(colors.len());
    for (k, surface) in points.surfaces.iter().enumerate() {
        let vertex = met(settings, surface, (k, Color::ONE), colors);
        seen.extend(vertex.map(|vertex| Seen {
            vertex,
            reflections: 0,
        }));
    }
    for _ in 0..MOST {
        add_light(settings, shading, &seen, colors);
        let branches: Vec<Branch> = seen
            .iter()
            .flat_map(|seen| branches(settings, seen))
            .collect();
        let rays: Vec<Ray> = branches.iter().map(|branch| branch.ray).collect();
        let filters: Vec<RayFilter> = branches.iter().map(|branch| branch.filter).collect();
        let hits = first_hits(shading, &rays, &filters);
        seen.clear();
        for (index, branch) in branches.iter().enumerate() {
            let vertex = follow(settings, shading, branch, &hits.get(index), colors);
            let reflections = branch.reflections;
            seen.extend(vertex.map(|vertex| Seen {
                vertex,
                reflections,
            }));
        }
        if seen.is_empty() {
            return;
        }
    }
    add_light(settings, shading, &seen, colors);
}

/// Adds what a surface shows by itself; returns the vertex there, unless its colour is known.
fn met(
    settings: &Whitted,
    surface: &SurfaceInteraction<'_>,
    (sum, throughput): (usize, Color),
    colors: &mut [Color],
) -> Option<Vertex> {
    if surface.is_unlit() {
        colors[sum] += throughput * surface.color();
        return None;
    }
    let vertex = Vertex::new(surface, sum, Draws::new(0, 0));
    let is_plain = (vertex.as_ref()).is_none_or(|v| v.scattering.branches().next().is_none());
    if is_plain {
        colors[sum] += throughput * settings.ambient * surface.color();
    }
    let mut vertex = vertex?;
    vertex.throughput = throughput;
    Some(vertex)
}

/// Adds the light of lights, each by its middle.
fn add_light(settings: &Whitted, shading: &Shading<'_>, seen: &[Seen], colors: &mut [Color]) {
    let mut rays = ShadowRays::with_capacity(seen.len());
    for light in shading.scene.lights() {
        for Seen { vertex, .. } in seen {
            let arriving = light.arriving(vertex.position, DVec2::splat(0.5));
            let Some(arriving) = arriving else { continue };
            let value = vertex.scattering.value(unit(arriving.towards));
            let light = vertex.throughput * value * arriving.light;
            // Written so that a NaN fails.
            if light.max_element() > 0.0 {
                let (ray, filter) = vertex.ray(arriving.towards);
                rays.push((ray.up_to(arriving.distance), filter), vertex.sum, light);
            }
        }
        rays.add_to(colors, shading, settings.shadows);
    }
}

/// The rays that go on from a vertex.
fn branches(settings: &Whitted, seen: &Seen) -> impl Iterator<Item = Branch> {
    let Whitted { least, depth, .. } = *settings;
    let Seen {
        vertex,
        reflections,
    } = seen;
    vertex.scattering.branches().filter_map(move |scattered| {
        let throughput = vertex.throughput * scattered.weight;
        let is_reflected = scattered.towards.dot(vertex.scattering.geometric()) > 0.0;
        let reflections = reflections + u32::from(is_reflected);
        let (ray, filter) = vertex.ray(scattered.towards);
        (throughput.max_element() > least && reflections <= depth).then_some(Branch {
            ray,
            filter,
            scattered,
            throughput,
            sum: vertex.sum,
            reflections,
        })
    })
}

/// Adds what a ray finds; returns the vertex where it meets a surface.
fn follow(
    settings: &Whitted,
    shading: &Shading<'_>,
    branch: &Branch,
    hit: &Hit,
    colors: &mut [Color],
) -> Option<Vertex> {
    let met_there = Found {
        ray: branch.ray,
        hit: *hit,
        before: 0.0,
    };
    let found = light_found(shading, (&branch.ray, &met_there), &branch.scattered, true);
    let surface = shading.scene.interaction(&branch.ray, hit);
    let behind = surface.as_ref().and_then(SurfaceInteraction::scattering);
    let absorbed = behind.map_or(Color::ZERO, |scattering| scattering.behind() * hit.t);
    let throughput = branch.throughput * absorbed.map(|x| libm::exp(-x));
    colors[branch.sum] += throughput * found;
    met(settings, &surface?, (branch.sum, throughput), colors)
}
