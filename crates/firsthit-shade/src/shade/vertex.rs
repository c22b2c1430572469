//! Vertices of light paths, and next-event estimation: the light that arrives there straight from
//! sampled lights.

use super::matte::{MatteVertex, SortedVertices};
use super::shadow::ShadowRays;
use super::{Points, Shading, stream};
use crate::geometry::{Color, DVec3, Ray, RayFilter, is_light, unit};
use crate::sampling::Draws;
use crate::scene::{Bsdf, LightSample, SurfaceInteraction};

/// A point of a surface where light is scattered to the camera, or to the vertex before.
pub(super) struct Vertex {
    pub(super) position: DVec3,
    pub(super) bsdf: Bsdf,
    /// The filter of the rays that leave the vertex: they do not meet its surface.
    pub(super) filter: RayFilter,
    /// The factor on light from here on its way to the camera.
    pub(super) throughput: Color,
    /// The sum that it counts for.
    pub(super) sum: usize,
    pub(super) draws: Draws,
    /// Whether its BSDF-sampled rays count the lights they meet too: then both are weighted.
    pub(super) finds_lights: bool,
    /// The share of the environment that the material's occlusion map lets through.
    pub(super) occlusion: f64,
    /// The absorption coefficient on the side of the surface that is seen, per scene unit.
    pub(super) absorption: Color,
    /// Whether it is seen by mirrors and through clear matter alone: then so is the background.
    pub(super) is_specular_path: bool,
    /// The product of the squared relative indices of all refractions so far. For Russian roulette
    /// it undoes what refraction took of the throughput.
    pub(super) eta_scale: f64,
}

/// The vertices that the camera sees; each sum begins with the emission of its surface.
pub(super) fn first_vertices(points: &Points<'_>, sums: &mut [Color]) -> Vec<Vertex> {
    let mut vertices = Vec::with_capacity(sums.len());
    for (k, (surface, &draws)) in points.surfaces.iter().zip(&points.draws).enumerate() {
        vertices.extend(first_vertex(surface, (k, draws), &mut sums[k]));
    }
    vertices
}

/// The vertex that the camera sees where it meets a surface, if light changes its colour.
pub(super) fn first_vertex(
    surface: &SurfaceInteraction<'_>,
    (number, draws): (usize, Draws),
    sum: &mut Color,
) -> Option<Vertex> {
    if surface.is_unlit() {
        *sum = surface.color();
        return None;
    }
    *sum = surface.emitted();
    Vertex::new(surface, number, draws, PathSegment::of_camera(surface))
}

/// The segment of a path, a ray that meets a surface.
#[derive(Clone, Copy)]
pub(super) struct PathSegment {
    /// The factor on light from the start of the ray to the camera.
    pub(super) throughput: Color,
    /// The absorption coefficient on its way, per scene unit, as far as is known at its start.
    pub(super) absorption: Color,
    pub(super) length: f64,
}

impl PathSegment {
    /// The segment of a ray from the camera.
    pub(super) fn of_camera(surface: &SurfaceInteraction<'_>) -> Self {
        Self {
            throughput: Color::ONE,
            absorption: Color::ZERO,
            length: surface.hit().t * surface.ray().direction.length(),
        }
    }
}

impl Vertex {
    /// The vertex that a ray meets; `None` where the surface has no normal.
    pub(super) fn new(
        surface: &SurfaceInteraction<'_>,
        sum: usize,
        draws: Draws,
        segment: PathSegment,
    ) -> Option<Self> {
        let bsdf = surface.bsdf()?;
        let (start, filter) = surface.leave(bsdf.geometric());
        // A ray that starts inside a solid learns so where it leaves it.
        let absorption = bsdf.behind().unwrap_or(segment.absorption);
        Some(Self {
            position: start.origin,
            bsdf,
            filter,
            throughput: segment.throughput * transmittance(absorption, segment.length),
            sum,
            draws,
            finds_lights: false,
            occlusion: 1.0,
            absorption,
            is_specular_path: true,
            eta_scale: 1.0,
        })
    }

    /// The vertex as one of a row, if it can be.
    pub(super) fn matte(&self) -> Option<MatteVertex> {
        let surface = self.bsdf.lambertian();
        let surface = surface.filter(|_| self.absorption == Color::ZERO)?;
        Some(MatteVertex {
            position: self.position,
            surface,
            filter: self.filter,
            throughput: self.throughput,
            sum: self.sum,
            draws: self.draws,
            finds_lights: self.finds_lights,
            occlusion: self.occlusion,
        })
    }

    /// A ray from here on.
    pub(super) fn ray(&self, towards: DVec3) -> (Ray, RayFilter) {
        (Ray::new(self.position, towards), self.filter)
    }

    /// A ray from here to a light, which ends before it.
    pub(super) fn ray_to(&self, light: &LightSample) -> (Ray, RayFilter) {
        let (ray, filter) = self.ray(light.towards);
        (ray.up_to(light.ray_end(self.position)), filter)
    }

    /// The absorption coefficient on the way of a ray from here on, per scene unit.
    pub(super) fn absorption_towards(&self, towards: DVec3) -> Color {
        let beyond = self.bsdf.beyond(towards);
        beyond.unwrap_or(self.absorption)
    }

    /// The contribution of a sampled light if nothing is in its way; `None` for none. It is
    /// weighted where the surface's BSDF-sampled rays count it too.
    pub(super) fn seen(&self, arriving: &LightSample) -> Option<Color> {
        self.weighted(arriving, self.finds_lights)
    }

    /// The seen light of a sampled direction of the environment, which BSDF-sampled rays always
    /// count.
    fn seen_environment(&self, arriving: &LightSample) -> Option<Color> {
        let light = self.weighted(arriving, true)?;
        let light = self.occlusion * light;
        is_light(light).then_some(light)
    }

    fn weighted(&self, arriving: &LightSample, is_found_too: bool) -> Option<Color> {
        let towards = unit(arriving.towards);
        let mut light = self.throughput * self.bsdf.value(towards) * arriving.light;
        let absorption = self.absorption_towards(towards);
        if absorption != Color::ZERO {
            light *= transmittance(absorption, arriving.distance * arriving.towards.length());
        }
        let share = match arriving.pdf {
            Some(pdf) if is_found_too => power_heuristic(pdf, self.bsdf.pdf(towards)),
            _ => 1.0,
        };
        let light = share * light;
        // It is none where the point is where the light is.
        is_light(light).then_some(light)
    }
}

/// The weight of a sample that was drawn with one probability density and could have been drawn
/// with another one (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo
/// Rendering", SIGGRAPH 1995: the power heuristic, with the power of two).
#[inline(always)]
pub(super) fn power_heuristic(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

/// The share of light that is left after a length, by an absorption coefficient (Beer, 1852). A ray
/// that never meets a surface is not absorbed: the solid that it is in has no end.
pub(super) fn transmittance(absorption: Color, length: f64) -> Color {
    if absorption == Color::ZERO || length == f64::INFINITY {
        Color::ONE
    } else {
        (absorption * length).map(|x| libm::exp(-x))
    }
}

/// Next-event estimation: adds the light of one sample of each light, one of the emissive surfaces,
/// and one of the environment.
pub(super) fn add_direct_light(
    shading: &Shading<'_>,
    sorted: &SortedVertices<'_>,
    (shadows, reach): (bool, f64),
    sums: &mut [Color],
) {
    let set = shading.engine.instruction_set();
    let mut rays = ShadowRays::with_capacity(sorted.count());
    // Each light has numbers of its own, so that it brings the same whatever other lights there
    // are.
    for light in shading.scene.lights() {
        let (key, light) = (light.key(), light.prepared());
        for row in &sorted.rows {
            row.push_light(set, (&light, key), &mut rays);
        }
        for vertex in &sorted.others {
            let u = vertex.draws.split(key).two();
            let drawn = light.sample(vertex.position, u);
            let seen = drawn.and_then(|drawn| Some((drawn, vertex.seen(&drawn)?)));
            if let Some((drawn, light)) = seen {
                rays.push(vertex.ray_to(&drawn), vertex.sum, light);
            }
        }
        rays.add_to(sums, shading, shadows);
    }
    let emitters = shading.scene.emitters();
    if !emitters.is_empty() {
        for row in &sorted.rows {
            row.push_emitters(set, shading, &mut rays);
        }
        for vertex in &sorted.others {
            let u = vertex.draws.split(stream::EMITTERS).three();
            let drawn = emitters.sample(shading.scene, vertex.position, u);
            let Some((arriving, surface)) = drawn else {
                continue;
            };
            if let Some(light) = vertex.seen(&arriving) {
                let (ray, mut filter) = vertex.ray_to(&arriving);
                filter.skip[1] = Some(surface);
                rays.push((ray, filter), vertex.sum, light);
            }
        }
        rays.add_to(sums, shading, shadows);
    }
    let drawn = shading.scene.environment().filter(|environment| environment.is_drawn());
    if let Some(environment) = drawn {
        for row in &sorted.rows {
            row.push_environment((environment, reach), &mut rays);
        }
        for vertex in &sorted.others {
            let u = vertex.draws.split(stream::ENVIRONMENT).two();
            let Some(arriving) = environment.sample(u) else {
                continue;
            };
            if let Some(light) = vertex.seen_environment(&arriving) {
                let (ray, filter) = vertex.ray(unit(arriving.towards));
                rays.push((ray.up_to(reach), filter), vertex.sum, light);
            }
        }
        rays.add_to(sums, shading, true);
    }
}
