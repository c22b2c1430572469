//! Translucent surfaces: those whose alpha says how much of what is behind them they hide (glTF's
//! alpha mode BLEND).
//!
//! A ray goes through them in their exact order, so nothing has to be sorted.
//!
//! - The camera's picture is composed from the front to the back (Porter and Duff, "Compositing
//!   Digital Images", SIGGRAPH 1984).
//! - Light that goes through loses the share that each surface hides.
//! - A ray that a surface draws, in a path, goes through by chance, as often as the surface lets
//!   light through.

use super::found::first_hits;
use super::{Samples, Shading, stream};
use crate::geometry::{Color, Hit, Ray, RayFilter, Side};
use crate::sampling::Draws;
use crate::scene::SurfaceInteraction;

/// The most translucent surfaces that a ray goes through.
const MOST: u32 = 256;

/// The least share of light that counts: a tenth of what a picture of 16 bits shows.
const LEAST: f64 = 1e-6;

/// The ray from a surface on in its own direction.
pub(super) fn onwards(surface: &SurfaceInteraction<'_>) -> (Ray, RayFilter) {
    surface.leave(surface.ray().direction)
}

/// A ray on its way through translucent surfaces.
struct TransmittedRay {
    /// The index of the sample.
    sample: usize,
    ray: Ray,
    hit: Hit,
    /// The share of the light from farther on that is seen.
    left: f64,
}

/// Composes what is seen through translucent surfaces: `colors` are those of the first surfaces,
/// `coverage` is 1 for hits.
pub(super) fn compose(
    shading: &Shading<'_>,
    samples: &Samples<'_>,
    colors: &mut [Color],
    coverage: &mut [f64],
) {
    let mut seen = Vec::new();
    for (sample, (ray, hit)) in samples.rays.iter().zip(samples.hits).enumerate() {
        let surface = shading.scene.interaction(ray, hit);
        let opacity = surface.as_ref().map_or(1.0, SurfaceInteraction::opacity);
        if opacity < 1.0 {
            colors[sample] *= opacity;
            coverage[sample] *= opacity;
            seen.push(TransmittedRay { sample, ray: *ray, hit: *hit, left: 1.0 - opacity });
        }
    }
    for layer in 0..MOST {
        go_on(shading, samples.cull, &mut seen);
        if seen.is_empty() {
            return;
        }
        let draws = |seen: &TransmittedRay| {
            samples.draws(seen.sample).split(stream::LAYERS + u64::from(layer))
        };
        let (rays, hits): (Vec<Ray>, Vec<Hit>) =
            seen.iter().map(|seen| (seen.ray, seen.hit)).unzip();
        let drawn: Vec<Draws> = seen.iter().map(draws).collect();
        let mut found = vec![Color::ZERO; seen.len()];
        let mut covered: Vec<f64> =
            hits.iter().map(|hit| f64::from(u8::from(!hit.is_miss()))).collect();
        shading.shade_hits((&rays, &hits, &drawn), &mut found, &mut covered);
        for (k, seen) in seen.iter_mut().enumerate() {
            let surface = shading.scene.interaction(&rays[k], &hits[k]);
            let opacity = surface.as_ref().map_or(1.0, SurfaceInteraction::opacity);
            // Before a transparent background a miss is black, and covers nothing.
            colors[seen.sample] += seen.left * opacity * found[k];
            coverage[seen.sample] += seen.left * opacity * covered[k];
            seen.left *= 1.0 - opacity;
        }
        seen.retain(|seen| seen.left > LEAST && !seen.hit.is_miss());
    }
}

/// Takes rays to what is behind the surfaces that they have met.
fn go_on(shading: &Shading<'_>, cull: Option<Side>, seen: &mut [TransmittedRay]) {
    let on = seen.iter().filter_map(|seen| {
        let surface = shading.scene.interaction(&seen.ray, &seen.hit)?;
        let (ray, filter) = onwards(&surface);
        Some((ray, RayFilter { cull, ..filter }))
    });
    let (rays, filters): (Vec<Ray>, Vec<RayFilter>) = on.unzip();
    let hits = first_hits(shading, &rays, &filters);
    for (k, seen) in seen.iter_mut().enumerate() {
        (seen.ray, seen.hit) = (rays[k], hits.get(k));
    }
}

/// The share of light that comes through from the end of each ray to its start.
pub(super) fn transmitted(shading: &Shading<'_>, rays: &[Ray], filters: &[RayFilter]) -> Vec<f64> {
    let mut shares = vec![1.0; rays.len()];
    let mut going: Vec<usize> = (0..rays.len()).collect();
    let (mut rays, mut filters) = (rays.to_vec(), filters.to_vec());
    for _ in 0..MOST {
        let hits = first_hits(shading, &rays, &filters);
        let (mut next, mut next_rays, mut next_filters) = (Vec::new(), Vec::new(), Vec::new());
        for (k, &ray) in going.iter().enumerate() {
            let hit = hits.get(k);
            let Some(surface) = shading.scene.interaction(&rays[k], &hit) else {
                continue;
            };
            shares[ray] *= 1.0 - surface.opacity();
            if shares[ray] > LEAST {
                let (on, mut filter) = onwards(&surface);
                // The rest of the way, and the surface at its end.
                filter.skip[1] = filters[k].skip[1];
                let rest = rays[k].t_max - hit.t;
                next.push(ray);
                next_rays.push(rescaled(on, rest));
                next_filters.push(filter);
            }
        }
        if next.is_empty() {
            break;
        }
        (going, rays, filters) = (next, next_rays, next_filters);
    }
    shares
}

/// A ray that ends after `rest` lengths of its direction; at 1, so that what is at its end can be
/// left out.
fn rescaled(ray: Ray, rest: f64) -> Ray {
    if rest < f64::INFINITY { Ray::new(ray.origin, rest * ray.direction).up_to(1.0) } else { ray }
}

/// The first hit of a ray behind the translucent surfaces that it goes through by chance.
pub(super) struct StochasticHit {
    /// The last part of it.
    pub(super) ray: Ray,
    /// The hit of that part.
    pub(super) hit: Hit,
    /// The length of the ray before that part.
    pub(super) before: f64,
}

impl StochasticHit {
    /// The length of the whole ray, up to the hit; infinite for a miss.
    pub(super) fn length(&self) -> f64 {
        self.before + self.hit.t
    }
}

/// The first hit of each ray, with a direction of length one, on a surface that it does not pass
/// through by chance.
pub(super) fn stochastic_hits(
    shading: &Shading<'_>,
    rays: &[Ray],
    filters: &[RayFilter],
    draws: &mut [Draws],
) -> Vec<StochasticHit> {
    let hits = first_hits(shading, rays, filters);
    let all = rays.iter().enumerate();
    let mut found: Vec<StochasticHit> =
        all.map(|(k, &ray)| StochasticHit { ray, hit: hits.get(k), before: 0.0 }).collect();
    if !shading.scene.has_translucent() {
        return found;
    }
    let mut going: Vec<usize> = (0..rays.len()).collect();
    for _ in 0..MOST {
        let mut through = Vec::new();
        for &k in &going {
            let surface = shading.scene.interaction(&found[k].ray, &found[k].hit);
            let opacity = surface.as_ref().map_or(1.0, SurfaceInteraction::opacity);
            if let Some(surface) = surface.filter(|_| opacity < 1.0 && draws[k].one() >= opacity) {
                through.push((k, onwards(&surface)));
            }
        }
        if through.is_empty() {
            break;
        }
        let (rays, filters): (Vec<Ray>, Vec<RayFilter>) = through.iter().map(|(_, on)| *on).unzip();
        let hits = first_hits(shading, &rays, &filters);
        for (index, &(k, (ray, _))) in through.iter().enumerate() {
            let StochasticHit { hit, before, .. } = &found[k];
            found[k] = StochasticHit { before: before + hit.t, ray, hit: hits.get(index) };
        }
        going = through.into_iter().map(|(k, _)| k).collect();
    }
    found
}
