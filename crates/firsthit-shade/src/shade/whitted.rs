//! Mirrors and clear matter without noise: each ray that meets them is continued by a reflected and
//! a refracted one (Whitted, "An Improved Illumination Model for Shaded Display", Communications of
//! the ACM 23(6), 1980), with exact Fresnel weights.

use super::blend::onwards;
use super::found::{BsdfRay, first_hits};
use super::shadow::ShadowRays;
use super::vertex::{PathSegment, Vertex, transmittance};
use super::{Points, Shading};
use crate::geometry::{Color, DVec2, Domain, Hit, Ray, RayFilter, settings};
use crate::sampling::Draws;
use crate::scene::{BsdfSample, SurfaceInteraction};

settings! {
    /// The settings of Whitted's shader.
    pub struct Whitted {
        /// Light from everywhere, which nothing blocks, on surfaces that are neither mirrors nor
        /// clear.
        ambient: Color, Domain::Color, default Color::splat(0.25);
        /// Whether things cast shadows. They are hard, and clear things cast them too.
        shadows: bool, Domain::Flag, default true;
        /// The most reflections of a ray. Passing through clear surfaces does not count.
        depth: u32, Domain::Whole(0, 64), default 16;
        /// Rays that bring less than this share of their light end.
        least: f64, Domain::From(0.0, 1.0), default 1e-4;
    }
}

/// The most mirrors and clear surfaces on the way of a ray.
const MOST: u32 = 128;

/// Into how many a ray is split at most: of more, those that bring the least end.
const MOST_BRANCHES: usize = 64;

/// A surface that was met, and how many times its ray was reflected.
struct ReflectedVertex {
    vertex: Vertex,
    reflections: u32,
}

/// A ray that continues from a mirror, or through clear matter or a translucent surface.
struct Branch {
    ray: Ray,
    filter: RayFilter,
    scattered: BsdfSample,
    throughput: Color,
    /// The absorption coefficient on its way, per scene unit.
    absorption: Color,
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
        if !surface.is_unlit() {
            colors[k] = surface.emitted();
        }
        let vertex = met(settings, surface, (k, PathSegment::of_camera(surface)), colors);
        seen.extend(vertex.map(|vertex| ReflectedVertex { vertex, reflections: 0 }));
    }
    // The rays that continue through translucent surfaces.
    let mut through: Vec<Branch> = Vec::new();
    for _ in 0..MOST {
        add_light(settings, shading, &seen, colors);
        let mut branches: Vec<Branch> = std::mem::take(&mut through);
        branches.extend(seen.drain(..).flat_map(|seen| branches_of(settings, &seen)));
        let branches = strongest(branches);
        if branches.is_empty() {
            return;
        }
        let rays: Vec<Ray> = branches.iter().map(|branch| branch.ray).collect();
        let filters: Vec<RayFilter> = branches.iter().map(|branch| branch.filter).collect();
        let hits = first_hits(shading, &rays, &filters);
        for (index, branch) in branches.iter().enumerate() {
            let (vertex, on) = follow(settings, shading, branch, &hits.get(index), colors);
            let reflections = branch.reflections;
            seen.extend(vertex.map(|vertex| ReflectedVertex { vertex, reflections }));
            through.extend(on);
        }
    }
    add_light(settings, shading, &seen, colors);
}

/// The strongest branches of each sum, as many as may continue.
fn strongest(mut branches: Vec<Branch>) -> Vec<Branch> {
    let strength = |branch: &Branch| branch.throughput.max_element();
    // Stable, so that the order of equals does not depend on who else is in the batch.
    branches.sort_by(|a, b| {
        let by_strength = strength(b).total_cmp(&strength(a));
        a.sum.cmp(&b.sum).then(by_strength)
    });
    let (mut last, mut count) = (usize::MAX, 0);
    branches.retain(|branch| {
        count = if branch.sum == last { count + 1 } else { 1 };
        last = branch.sum;
        count <= MOST_BRANCHES
    });
    branches
}

/// Adds what a surface shows by itself; returns the vertex there, unless its colour is known.
fn met(
    settings: &Whitted,
    surface: &SurfaceInteraction<'_>,
    (sum, segment): (usize, PathSegment),
    colors: &mut [Color],
) -> Option<Vertex> {
    let vertex = Vertex::new(surface, sum, Draws::new(0, 0), segment);
    let throughput = vertex
        .as_ref()
        .map_or(segment.throughput * transmittance(segment.absorption, segment.length), |vertex| {
            vertex.throughput
        });
    if surface.is_unlit() {
        colors[sum] += throughput * surface.color();
        return None;
    }
    let is_plain = (vertex.as_ref()).is_none_or(|v| v.bsdf.branches().next().is_none());
    if is_plain {
        colors[sum] += throughput * settings.ambient * surface.color();
    }
    vertex
}

/// Adds the light of lights, each by its middle.
fn add_light(
    settings: &Whitted,
    shading: &Shading<'_>,
    seen: &[ReflectedVertex],
    colors: &mut [Color],
) {
    let mut rays = ShadowRays::with_capacity(seen.len());
    for light in shading.scene.lights() {
        let light = light.prepared();
        for ReflectedVertex { vertex, .. } in seen {
            let sample = light.sample(vertex.position, DVec2::splat(0.5));
            let seen = sample.and_then(|sample| Some((sample, vertex.seen(&sample)?)));
            if let Some((sample, light)) = seen {
                rays.push(vertex.ray_to(&sample), vertex.sum, light);
            }
        }
        rays.add_to(colors, shading, settings.shadows);
    }
}

/// The rays that continue from a vertex.
fn branches_of(settings: &Whitted, seen: &ReflectedVertex) -> Vec<Branch> {
    let Whitted { least, depth, .. } = *settings;
    let ReflectedVertex { vertex, reflections } = seen;
    let branch = |scattered: BsdfSample| {
        let throughput = vertex.throughput * scattered.weight;
        let is_reflected = scattered.towards.dot(vertex.bsdf.geometric()) > 0.0;
        let reflections = reflections + u32::from(is_reflected);
        let (ray, filter) = vertex.ray(scattered.towards);
        (throughput.max_element() > least && reflections <= depth).then_some(Branch {
            ray,
            filter,
            scattered,
            throughput,
            absorption: vertex.absorption_towards(scattered.towards),
            sum: vertex.sum,
            reflections,
        })
    };
    vertex.bsdf.branches().filter_map(branch).collect()
}

/// Adds the light that a ray finds; returns the vertex where it meets a surface, and the ray that
/// continues through a translucent one.
fn follow(
    settings: &Whitted,
    shading: &Shading<'_>,
    branch: &Branch,
    hit: &Hit,
    colors: &mut [Color],
) -> (Option<Vertex>, Option<Branch>) {
    let bsdf_ray = BsdfRay {
        ray: &branch.ray,
        sample: &branch.scattered,
        is_specular_path: true,
        finds_lights: true,
        reach: f64::INFINITY,
        occlusion: 1.0,
        absorption: branch.absorption,
    };
    let color = &mut colors[branch.sum];
    *color += branch.throughput * bsdf_ray.lights(shading, hit.t);
    let Some(surface) = shading.scene.interaction(&branch.ray, hit) else {
        *color += branch.throughput * bsdf_ray.environment(shading);
        return (None, None);
    };
    let opacity = surface.opacity();
    let segment = PathSegment {
        throughput: opacity * branch.throughput,
        absorption: branch.absorption,
        length: hit.t,
    };
    *color += segment.throughput * bsdf_ray.emission(shading, &surface, hit.t);
    let vertex =
        if opacity > 0.0 { met(settings, &surface, (branch.sum, segment), colors) } else { None };
    let left = transmittance(branch.absorption, hit.t);
    let throughput = (1.0 - opacity) * left * branch.throughput;
    let through = (throughput.max_element() > settings.least).then(|| {
        let (ray, filter) = onwards(&surface);
        Branch { ray, filter, throughput, ..*branch }
    });
    (vertex, through)
}
