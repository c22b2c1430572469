//! A ground that only shadows are seen of.

use super::shadow::ShadowRays;
use super::{Samples, Shading};
use crate::geometry::{Color, DVec3, Ray, RayFilter, unit};
use crate::sampling::{Draws, warp};
use crate::scene::Scene;

/// A level plane on which shadows fall. What it shows of itself is how much darker it is for what stands on it: rays that meet
/// nothing else see the background through it, as much as light reaches it.
///
/// It is no object: no other ray meets it, and pictures are as fast as without it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// A point of it.
    pub point: DVec3,
    /// Its normal: the side that is seen and lit; any length but zero.
    pub up: DVec3,
}

impl Ground {
    /// Under everything that a scene has, `up` being any length but zero. `None` for a scene without an end in that direction.
    pub fn under(scene: &Scene, up: DVec3) -> Option<Self> {
        let up = unit(up);
        let depth = scene.support(-up);
        depth.is_finite().then(|| Self {
            point: -depth * up,
            up,
        })
    }

    /// Darkens the misses of rays that go through the plane from above.
    pub(super) fn shade(
        &self,
        shading: &Shading<'_>,
        samples: &Samples<'_>,
        colors: &mut [Color],
        coverage: &mut [f64],
    ) {
        let mut points = Vec::new();
        for (k, (ray, hit)) in samples.rays.iter().zip(samples.hits).enumerate() {
            if let Some(point) = self.crossed(ray).filter(|_| hit.is_miss()) {
                points.push((k, point, samples.draws(k)));
            }
        }
        let lit = Lighting::new(shading, unit(self.up), &points);
        for (&(k, ..), share) in points.iter().zip(lit.shares()) {
            colors[k] *= share;
            coverage[k] = 1.0 - share;
        }
    }

    /// Where a ray goes through the plane from above.
    fn crossed(&self, ray: &Ray) -> Option<DVec3> {
        let up = unit(self.up);
        let t = (ray.origin - self.point).dot(up) / -ray.direction.dot(up);
        // Written so that a NaN fails.
        let is_crossed = ray.direction.dot(up) < 0.0 && t > 0.0 && t < f64::INFINITY;
        is_crossed.then(|| ray.at(t))
    }
}

/// The light at points of the ground: what reaches them, and what would if nothing were in the way.
struct Lighting {
    reached: Vec<Color>,
    full: Vec<Color>,
}

impl Lighting {
    fn new(shading: &Shading<'_>, up: DVec3, points: &[(usize, DVec3, Draws)]) -> Self {
        let mut lighting = Self {
            reached: vec![Color::ZERO; points.len()],
            full: vec![Color::ZERO; points.len()],
        };
        let mut rays = ShadowRays::with_capacity(points.len());
        for light in shading.scene.lights() {
            let (key, light) = (light.key(), light.prepared());
            for (index, (_, point, draws)) in points.iter().enumerate() {
                let arriving = light.arriving(*point, draws.split(key).two());
                let Some(arriving) = arriving else { continue };
                let color = unit(arriving.towards).dot(up) * arriving.light;
                let ray = Ray::new(*point, arriving.towards).up_to(arriving.distance);
                lighting.push(&mut rays, ray, index, color);
            }
            rays.add_to(&mut lighting.reached, shading, true);
        }
        let environment = shading.scene.environment();
        // Where nothing shines, as for shaders without light, it is as under a white sky.
        if environment.is_some() || shading.scene.lights().is_empty() {
            for (index, (_, point, mut draws)) in points.iter().copied().enumerate() {
                let towards = warp::around(up, warp::cosine_hemisphere(draws.two()));
                let light = environment.map_or(Color::ONE, |sky| sky.radiance(towards));
                lighting.push(&mut rays, Ray::new(point, towards), index, light);
            }
            rays.add_to(&mut lighting.reached, shading, true);
        }
        lighting
    }

    /// Takes a ray that brings light to a point.
    fn push(&mut self, rays: &mut ShadowRays, ray: Ray, index: usize, color: Color) {
        // Written so that a NaN fails.
        if color.element_sum() > 0.0 {
            self.full[index] += color;
            rays.push((ray, RayFilter::NONE), index, color);
        }
    }

    /// How much of the light reaches each point.
    fn shares(&self) -> impl Iterator<Item = f64> {
        self.reached.iter().zip(&self.full).map(|(reached, full)| {
            let [reached, full] = [reached, full].map(|color| color.element_sum());
            if full > 0.0 {
                (reached / full).clamp(0.0, 1.0)
            } else {
                1.0
            }
        })
    }
}
