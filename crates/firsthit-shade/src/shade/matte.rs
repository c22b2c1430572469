//! Matte surfaces, row by row: each step of their direct light is done for many points at a time.
//!
//! A step is a loop in a kernel, so it is compiled for each instruction set, and the compiler makes
//! lanes of it. The loop calls the functions that shade a single point, so both come to the same
//! bits.

use super::rows::{Arriving, DrawnLight, LightSamples, ShadingPoints, Sky};
use super::shadow::ShadowRays;
use super::vertex::{Vertex, power_heuristic};
use super::{Shading, stream};
use crate::geometry::rows::{ROW, Scalars, Vectors};
use crate::geometry::{Color, DVec3, Ray, RayFilter, unit};
use crate::sampling::Draws;
use crate::scene::{BsdfSample, Environment, Lambertian, PreparedLight, SurfaceInteraction};
use crate::simd::{self, InstructionSet, Kernel, Lanes};

/// Vertices on matte surfaces, in a medium that absorbs nothing.
pub(super) struct MatteRow {
    points: ShadingPoints,
    normal: Vectors,
    geometric: Vectors,
    albedo: Vectors,
    throughput: Vectors,
    occlusion: Scalars,
    finds_lights: [bool; ROW],
    filters: Vec<RayFilter>,
    sums: Vec<usize>,
}

/// One of a [`MatteRow`]; see [`Vertex`].
pub(super) struct MatteVertex {
    pub(super) position: DVec3,
    pub(super) surface: Lambertian,
    pub(super) filter: RayFilter,
    pub(super) throughput: Color,
    pub(super) sum: usize,
    pub(super) draws: Draws,
    pub(super) finds_lights: bool,
    pub(super) occlusion: f64,
}

impl MatteVertex {
    /// The vertex of a surface that the camera sees.
    #[inline]
    pub(super) fn first(
        surface: &SurfaceInteraction<'_>,
        matte: Lambertian,
        (sum, draws): (usize, Draws),
    ) -> Self {
        let (start, filter) = surface.leave(matte.geometric);
        Self {
            position: start.origin,
            surface: matte,
            filter,
            throughput: Color::ONE,
            sum,
            draws,
            finds_lights: false,
            occlusion: 1.0,
        }
    }
}

/// Vertices, those on matte surfaces in rows.
#[derive(Default)]
pub(super) struct SortedVertices<'a> {
    pub(super) rows: Vec<MatteRow>,
    pub(super) others: Vec<&'a Vertex>,
}

impl<'a> SortedVertices<'a> {
    /// Sorts vertices.
    pub(super) fn new(vertices: &'a [Vertex]) -> Self {
        let mut sorted = Self::default();
        for vertex in vertices {
            match vertex.matte() {
                Some(matte) => push(&mut sorted.rows, &matte),
                None => sorted.others.push(vertex),
            }
        }
        sorted
    }

    /// The number of vertices.
    pub(super) fn count(&self) -> usize {
        let in_rows: usize = self.rows.iter().map(|row| row.points.len()).sum();
        in_rows + self.others.len()
    }
}

/// Adds a vertex to the last row, or to a new one.
#[inline]
pub(super) fn push(rows: &mut Vec<MatteRow>, vertex: &MatteVertex) {
    if rows.last().is_none_or(|row| row.points.is_full()) {
        rows.push(MatteRow {
            filters: Vec::with_capacity(ROW),
            sums: Vec::with_capacity(ROW),
            ..MatteRow::EMPTY
        });
    }
    if let Some(row) = rows.last_mut() {
        row.push(vertex);
    }
}

impl MatteRow {
    const EMPTY: Self = Self {
        points: ShadingPoints::NONE,
        normal: Vectors::ZERO,
        geometric: Vectors::ZERO,
        albedo: Vectors::ZERO,
        throughput: Vectors::ZERO,
        occlusion: Scalars::all(0.0),
        finds_lights: [false; ROW],
        filters: Vec::new(),
        sums: Vec::new(),
    };

    #[inline]
    fn push(&mut self, vertex: &MatteVertex) {
        let k = self.points.push(vertex.position, vertex.draws);
        self.normal.set(k, vertex.surface.normal);
        self.geometric.set(k, vertex.surface.geometric);
        self.albedo.set(k, vertex.surface.albedo);
        self.throughput.set(k, vertex.throughput);
        self.occlusion.set(k, vertex.occlusion);
        self.finds_lights[k] = vertex.finds_lights;
        self.filters.push(vertex.filter);
        self.sums.push(vertex.sum);
    }

    #[inline(always)]
    fn surface(&self, k: usize) -> Lambertian {
        Lambertian {
            normal: self.normal.get(k),
            geometric: self.geometric.get(k),
            albedo: self.albedo.get(k),
        }
    }

    /// Adds rays towards samples of a light, which are drawn with the numbers of its stream.
    pub(super) fn push_light(
        &self,
        set: InstructionSet,
        (light, stream): (&PreparedLight, u64),
        rays: &mut ShadowRays,
    ) {
        let arriving = match light {
            PreparedLight::Sun(sun) => simd::run_here(set, DrawLight(self, sun, stream)),
            PreparedLight::Other(light) => simd::run_here(set, DrawLight(self, light, stream)),
        };
        self.push_rays(&arriving, rays);
    }

    /// Adds rays towards samples of surfaces that emit.
    pub(super) fn push_emitters(
        &self,
        set: InstructionSet,
        shading: &Shading<'_>,
        rays: &mut ShadowRays,
    ) {
        let mut samples = LightSamples::NONE;
        let mut ends = [None; ROW];
        for (k, end) in ends.iter_mut().enumerate().take(self.points.len()) {
            let at = self.points.position.get(k);
            let u = self.points.draws(k, stream::EMITTERS).three();
            let drawn = shading.scene.emitters().sample(shading.scene, at, u);
            if let Some((sample, surface)) = drawn {
                samples.set(k, &sample, at);
                *end = Some(surface);
            }
        }
        let arriving = simd::run_here(set, Reflect(self, samples));
        for (k, end) in ends.into_iter().enumerate().take(self.points.len()) {
            let mut filter = self.filters[k];
            filter.skip[1] = end;
            self.push_ray(k, filter, &arriving, rays);
        }
    }

    /// Adds rays in directions that are drawn by the environment's light.
    pub(super) fn push_environment(
        &self,
        (environment, reach): (&Environment, f64),
        rays: &mut ShadowRays,
    ) {
        for k in 0..self.points.len() {
            let u = self.points.draws(k, stream::ENVIRONMENT).two();
            let Some(sample) = environment.sample(u) else {
                continue;
            };
            let (surface, towards) = (self.surface(k), unit(sample.towards));
            let scattered = self.throughput.get(k) * surface.value(towards);
            let share = (sample.pdf).map_or(1.0, |pdf| power_heuristic(pdf, surface.pdf(towards)));
            let light = self.occlusion.get(k) * (share * (scattered * sample.light));
            let ray = Ray::new(self.points.position.get(k), towards).up_to(reach);
            rays.push((ray, self.filters[k]), self.sums[k], light);
        }
    }

    /// Adds rays in directions that the surfaces draw, each with what the environment brings from
    /// there if it is seen.
    pub(super) fn push_scattered(
        &self,
        set: InstructionSet,
        (environment, reach): (&Environment, f64),
        rays: &mut ShadowRays,
    ) {
        let arriving = match &environment.hemispheres() {
            Some(sky) => simd::run_here(set, Scatter(self, sky, reach)),
            None => simd::run_here(set, Scatter(self, environment, reach)),
        };
        self.push_rays(&arriving, rays);
    }

    fn push_rays(&self, arriving: &Arriving, rays: &mut ShadowRays) {
        for k in 0..self.points.len() {
            self.push_ray(k, self.filters[k], arriving, rays);
        }
    }

    #[inline]
    fn push_ray(&self, k: usize, filter: RayFilter, arriving: &Arriving, rays: &mut ShadowRays) {
        let ray = arriving.ray(k, self.points.position.get(k));
        rays.push((ray, filter), self.sums[k], arriving.light.get(k));
    }

    /// Computes the reflected light of samples of lights. They are weighted where BSDF-sampled rays
    /// count them too.
    #[inline(always)]
    fn reflect(&self, samples: LightSamples) -> Arriving {
        let LightSamples { towards, end, mut light, pdf } = samples;
        for k in 0..self.points.len() {
            let scattered = self.throughput.get(k) * self.surface(k).value(unit(towards.get(k)));
            light.set(k, scattered * light.get(k));
        }
        for k in 0..self.points.len() {
            // Of a light without a size the share is 1, since its density is infinite.
            let own = self.surface(k).pdf(unit(towards.get(k)));
            let share = if self.finds_lights[k] { power_heuristic(pdf.get(k), own) } else { 1.0 };
            light.set(k, share * light.get(k));
        }
        Arriving { towards, end, light }
    }
}

/// A sample of a light for each vertex, and what the surface reflects of it.
struct DrawLight<'a, S>(&'a MatteRow, &'a S, u64);

impl<S: DrawnLight> Kernel for DrawLight<'_, S> {
    type Output = Arriving;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Arriving {
        let Self(row, light, stream) = self;
        row.reflect(row.points.draw_light(light, stream))
    }
}

/// Computes the reflected light of samples of lights.
struct Reflect<'a>(&'a MatteRow, LightSamples);

impl Kernel for Reflect<'_> {
    type Output = Arriving;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Arriving {
        let Self(row, samples) = self;
        row.reflect(samples)
    }
}

/// A direction that each surface draws, and what the environment brings from there.
struct Scatter<'a, S>(&'a MatteRow, &'a S, f64);

impl<S: Sky> Kernel for Scatter<'_, S> {
    type Output = Arriving;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Arriving {
        let Self(row, sky, reach) = self;
        let mut arriving = Arriving { end: Scalars::all(reach), ..Arriving::NONE };
        let mut pdf = Scalars::all(1.0);
        let u = row.points.draw(None);
        for k in 0..row.points.len() {
            let drawn = row.surface(k).sample(u.get(k));
            let drawn = drawn.unwrap_or(NO_DIRECTION);
            arriving.towards.set(k, drawn.towards);
            arriving.light.set(k, drawn.weight);
            pdf.set(k, drawn.pdf.unwrap_or(1.0));
        }
        for k in 0..row.points.len() {
            let (towards, weight) = (arriving.towards.get(k), arriving.light.get(k));
            let share = power_heuristic(pdf.get(k), sky.pdf(towards));
            let scattered = share * row.occlusion.get(k) * row.throughput.get(k) * weight;
            arriving.light.set(k, scattered * sky.radiance(towards));
        }
        arriving
    }
}

/// The stand-in for a direction where none is drawn: it brings no light.
const NO_DIRECTION: BsdfSample =
    BsdfSample { towards: DVec3::Z, weight: Color::ZERO, pdf: Some(1.0) };

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::is_light;
    use crate::scene::{Bsdf, DirectionalLight, EnvironmentKind, Light, SphereLight};

    fn vector(draws: &mut Draws) -> DVec3 {
        let [x, y, z] = draws.three();
        DVec3::new(x, y, z) - 0.5
    }

    /// Points with smooth normals, a few of them seen from behind; some are weighted against
    /// BSDF-sampled rays, and the last row is not full.
    fn vertices() -> Vec<MatteVertex> {
        let mut draws = Draws::new(5, 2);
        let mut one = |k: usize| {
            let geometric = unit(vector(&mut draws));
            let lean = [0.0, 0.4, 3.0][k % 3];
            MatteVertex {
                position: vector(&mut draws),
                surface: Lambertian {
                    normal: unit(geometric + lean * vector(&mut draws)),
                    geometric,
                    albedo: vector(&mut draws).abs(),
                },
                filter: RayFilter::NONE,
                throughput: vector(&mut draws).abs(),
                sum: k,
                draws: Draws::new(k as u64, 1),
                finds_lights: k.is_multiple_of(2),
                occlusion: 1.0 / (1.0 + (k % 4) as f64),
            }
        };
        (0..150).map(&mut one).collect()
    }

    fn bsdf(vertex: &MatteVertex) -> Bsdf {
        vertex.surface.into()
    }

    /// Compares a row's direction and light for each vertex with a single vertex's.
    fn compare(
        mut of_row: impl FnMut(&MatteRow) -> Arriving,
        single: impl Fn(&MatteVertex) -> Option<(DVec3, Color)>,
    ) -> usize {
        let (vertices, mut rows) = (vertices(), Vec::new());
        for vertex in &vertices {
            push(&mut rows, vertex);
        }
        assert_eq!(rows.len(), vertices.len().div_ceil(ROW));
        let mut lit = 0;
        for (row, vertices) in rows.iter().zip(vertices.chunks(ROW)) {
            let arriving = of_row(row);
            for (k, vertex) in vertices.iter().enumerate() {
                let light = arriving.light.get(k);
                let got = is_light(light).then(|| (arriving.towards.get(k), light));
                let expected = single(vertex).filter(|(_, light)| is_light(*light));
                assert_eq!(got, expected, "{k}");
                lit += usize::from(got.is_some());
            }
        }
        lit
    }

    #[test]
    fn a_row_draws_of_lights_what_each_vertex_does() {
        let sun = |angle_degrees| {
            Light::from(DirectionalLight {
                direction: DVec3::new(0.3, -0.4, -1.2),
                color: Color::new(0.9, 0.8, 0.7),
                angle_degrees,
            })
        };
        let ball = Light::from(SphereLight {
            center: DVec3::new(0.2, 0.1, 2.0),
            radius: 0.4,
            ..SphereLight::default()
        });
        for (light, set) in [sun(0.0), sun(0.5), sun(90.0), ball]
            .into_iter()
            .flat_map(|light| InstructionSet::available().map(move |set| (light, set)))
        {
            let stream = light.key();
            let prepared = light.prepared();
            let single = |vertex: &MatteVertex| {
                let u = vertex.draws.split(stream).two();
                let sample = light.sample(vertex.position, u)?;
                let (bsdf, towards) = (bsdf(vertex), unit(sample.towards));
                let share = match sample.pdf {
                    Some(pdf) if vertex.finds_lights => power_heuristic(pdf, bsdf.pdf(towards)),
                    _ => 1.0,
                };
                let light = share * (vertex.throughput * bsdf.value(towards) * sample.light);
                Some((sample.towards, light))
            };
            let of_row = |row: &MatteRow| match &prepared {
                PreparedLight::Sun(sun) => simd::run_here(set, DrawLight(row, sun, stream)),
                PreparedLight::Other(light) => simd::run_here(set, DrawLight(row, light, stream)),
            };
            assert!(compare(of_row, single) > 40, "{light:?}");
        }
    }

    #[test]
    fn a_row_scatters_what_each_vertex_does() {
        let colors = [Color::new(0.4, 0.5, 0.9), Color::new(0.3, 0.2, 0.1)];
        for (strength, set) in [1.0, 2.5]
            .into_iter()
            .flat_map(|strength| InstructionSet::available().map(move |set| (strength, set)))
        {
            let environment = Environment {
                strength,
                ..Environment::new(EnvironmentKind::Hemispheres {
                    above: colors[0],
                    below: colors[1],
                    up: DVec3::new(0.1, 3.0, 0.2),
                })
            };
            let single = |vertex: &MatteVertex| {
                let mut draws = vertex.draws;
                let drawn = bsdf(vertex).sample(draws.three())?;
                let share = power_heuristic(drawn.pdf?, environment.pdf(drawn.towards));
                let light = share * vertex.occlusion * vertex.throughput * drawn.weight;
                Some((drawn.towards, light * environment.radiance(drawn.towards)))
            };
            let sky = environment.hemispheres().unwrap();
            let reach = 3.0;
            let fast = |row: &MatteRow| simd::run_here(set, Scatter(row, &sky, reach));
            let plain = |row: &MatteRow| simd::run_here(set, Scatter(row, &environment, reach));
            assert!(compare(fast, single) > 100);
            assert!(compare(plain, single) > 100);
        }
    }
}
