//! Where light is scattered on its way to the camera, and what arrives there straight from lights.

use super::shadow::ShadowRays;
use super::{Points, Shading, stream};
use crate::geometry::{Color, DVec3, Ray, RayFilter, unit};
use crate::sampling::Draws;
use crate::scene::{Arriving, Scattering, SurfaceInteraction};

/// A point of a surface where light is scattered to the camera, or to the vertex before.
pub(super) struct Vertex {
    pub(super) position: DVec3,
    pub(super) scattering: Scattering,
    /// What its rays do not meet: the surface they leave.
    pub(super) filter: RayFilter,
    /// What light from here is multiplied by on its way to the camera.
    pub(super) throughput: Color,
    /// The sum that it counts for.
    pub(super) sum: usize,
    pub(super) draws: Draws,
    /// Whether lights are found by the rays that its surface draws too: then the points that are drawn of them count as much less.
    pub(super) finds_lights: bool,
    /// How much of the environment reaches the surface, as far as a map says so.
    pub(super) occlusion: f64,
    /// What is taken away for each unit of length on the side of the surface that is seen.
    pub(super) absorption: Color,
    /// Whether it is seen by mirrors and through clear matter alone: then so is the background.
    pub(super) is_straight: bool,
}

/// The vertices that the camera sees; each sum begins with what its surface gives off.
pub(super) fn first_vertices(points: &Points<'_>, sums: &mut [Color]) -> Vec<Vertex> {
    let mut vertices = Vec::with_capacity(sums.len());
    for (k, (surface, draws)) in points.surfaces.iter().zip(&points.draws).enumerate() {
        sums[k] = if surface.is_unlit() {
            surface.color()
        } else {
            let way = Way {
                throughput: Color::ONE,
                absorption: Color::ZERO,
                length: surface.hit().t * surface.ray().direction.length(),
            };
            vertices.extend(Vertex::new(surface, k, *draws, way));
            surface.emitted()
        };
    }
    vertices
}

/// The way of a ray that meets a surface.
#[derive(Clone, Copy)]
pub(super) struct Way {
    /// What light is multiplied by from the start of the ray to the camera.
    pub(super) throughput: Color,
    /// What is taken away for each unit of its length, as far as is known at its start.
    pub(super) absorption: Color,
    pub(super) length: f64,
}

impl Vertex {
    /// The one that a ray meets; `None` where the surface has no normal.
    pub(super) fn new(
        surface: &SurfaceInteraction<'_>,
        sum: usize,
        draws: Draws,
        way: Way,
    ) -> Option<Self> {
        let scattering = surface.scattering()?;
        let (start, filter) = surface.leave(scattering.geometric());
        // A ray that starts inside a solid learns so where it leaves it.
        let absorption = scattering.behind().unwrap_or(way.absorption);
        Some(Self {
            position: start.origin,
            scattering,
            filter,
            throughput: way.throughput * transmittance(absorption, way.length),
            sum,
            draws,
            finds_lights: false,
            occlusion: 1.0,
            absorption,
            is_straight: true,
        })
    }

    /// A ray from here on.
    pub(super) fn ray(&self, towards: DVec3) -> (Ray, RayFilter) {
        (Ray::new(self.position, towards), self.filter)
    }

    /// What is taken away, for each unit of length, on the way of a ray from here on.
    pub(super) fn absorption_towards(&self, towards: DVec3) -> Color {
        let beyond = self.scattering.beyond(towards);
        beyond.unwrap_or(self.absorption)
    }

    /// What the sum gets of light, if nothing is in its way; `None` where that is nothing. Of light that the surface's own
    /// rays may find too, it is a share.
    fn seen(&self, arriving: &Arriving) -> Option<Color> {
        let towards = unit(arriving.towards);
        let mut light = self.throughput * self.scattering.value(towards) * arriving.light;
        let absorption = self.absorption_towards(towards);
        if absorption != Color::ZERO {
            light *= transmittance(absorption, arriving.distance * arriving.towards.length());
        }
        let share = match arriving.density {
            Some(density) if self.finds_lights => {
                power_share(density, self.scattering.density(towards))
            }
            _ => 1.0,
        };
        let light = share * light;
        // Written so that a NaN (the point is where the light is) fails.
        (light.max_element() > 0.0 || light.min_element() < 0.0).then_some(light)
    }
}

/// How much counts what was drawn with one density, where another way could have drawn it too (Veach and Guibas, "Optimally Combining
/// Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995: the power heuristic, with the power of two).
pub(super) fn power_share(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

/// What is left of light after a length of something that takes so much away for each unit of it (Beer, 1852). Nothing is taken away from
/// what never meets a surface: the solid that it is in has no end.
pub(super) fn transmittance(absorption: Color, length: f64) -> Color {
    if absorption == Color::ZERO || length == f64::INFINITY {
        Color::ONE
    } else {
        (absorption * length).map(|x| libm::exp(-x))
    }
}

/// Adds the light that arrives at vertices straight from points of lights that are drawn: one of each light, one of the surfaces
/// that shine, and one direction of the environment.
pub(super) fn add_direct_light(
    shading: &Shading<'_>,
    vertices: &[Vertex],
    (shadows, reach): (bool, f64),
    sums: &mut [Color],
) {
    let mut rays = ShadowRays::with_capacity(vertices.len());
    // Each light has numbers of its own, so that it brings the same whatever other lights there are.
    for light in shading.scene.lights() {
        let (key, light) = (light.key(), light.prepared());
        for vertex in vertices {
            let u = vertex.draws.split(key).two();
            let drawn = light.arriving(vertex.position, u);
            let seen = drawn.and_then(|drawn| Some((drawn, vertex.seen(&drawn)?)));
            if let Some((
                Arriving {
                    towards, distance, ..
                },
                light,
            )) = seen
            {
                let (ray, filter) = vertex.ray(towards);
                rays.push((ray.up_to(distance), filter), vertex.sum, light);
            }
        }
        rays.add_to(sums, shading, shadows);
    }
    let emitters = shading.scene.emitters();
    if !emitters.is_empty() {
        for vertex in vertices {
            let u = vertex.draws.split(stream::EMITTERS).three();
            let drawn = emitters.arriving(shading.scene, vertex.position, u);
            let Some((arriving, surface)) = drawn else {
                continue;
            };
            if let Some(light) = vertex.seen(&arriving) {
                let (ray, mut filter) = vertex.ray(arriving.towards);
                filter.skip[1] = Some(surface);
                rays.push((ray.up_to(arriving.distance), filter), vertex.sum, light);
            }
        }
        rays.add_to(sums, shading, shadows);
    }
    let drawn = shading
        .scene
        .environment()
        .filter(|environment| environment.is_drawn());
    if let Some(environment) = drawn {
        for vertex in vertices {
            let u = vertex.draws.split(stream::ENVIRONMENT).two();
            let Some(arriving) = environment.arriving(u) else {
                continue;
            };
            let towards = unit(arriving.towards);
            let value = vertex.throughput * vertex.scattering.value(towards) * arriving.light;
            // The surface's own rays always find the environment.
            let own = vertex.scattering.density(towards);
            let share = arriving
                .density
                .map_or(1.0, |density| power_share(density, own));
            let light = share * vertex.occlusion * value;
            if light.max_element() > 0.0 {
                let (ray, filter) = vertex.ray(towards);
                rays.push((ray.up_to(reach), filter), vertex.sum, light);
            }
        }
        rays.add_to(sums, shading, true);
    }
}
