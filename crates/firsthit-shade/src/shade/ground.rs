//! A shadow catcher: a ground that only shadows are seen of.

mod rows;

use std::f64::consts::PI;

use rows::{Receiver, cosine, rows};

use super::light_rig::taken_by_white;
use super::rows::{Arriving, ShadingPoints};
use super::shadow::ShadowRays;
use super::vertex::power_heuristic;
use super::{Shading, stream};
use crate::geometry::{
    Bounds, Color, DVec2, DVec3, Hit, Ray, RayFilter, SurfaceId, is_light, unit,
};
use crate::sampling::Draws;
use crate::scene::{Environment, EnvironmentKind, Light, LightSample, Scene};

/// A shadow catcher: a level plane of which only shadows are seen. A ray that meets nothing else
/// sees the background through it, darkened by the share of light that things keep from it.
///
/// A sample may be darkened by more than all, and only the mean is right. Pictures have 0 where a
/// mean is below 0 by noise, and an alpha of at most 1.
///
/// It is no object: no other ray meets it, and finding what the camera's rays hit takes no longer.
/// Shading does: for each ray that meets nothing else and crosses it, rays go to every light and to
/// the sky, and a picture takes as many samples by default as with a shader that draws numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// A point of it.
    pub point: DVec3,
    /// The normal: the side that is seen and lit; any length but zero.
    pub up: DVec3,
}

impl Ground {
    /// The ground under everything that a scene has, `up` being any length but zero. `None` for a
    /// scene without an end in that direction.
    pub fn under(scene: &Scene, up: DVec3) -> Option<Self> {
        let up = unit(up);
        let depth = scene.support(-up);
        depth.is_finite().then(|| Self { point: -depth * up, up })
    }

    /// Whether a point is above it, where its shadows are seen.
    pub fn is_seen_from(&self, point: DVec3) -> bool {
        (point - self.point).dot(unit(self.up)) > 0.0
    }

    /// Darkens the misses of rays that go through the plane from above.
    pub(super) fn shade(
        &self,
        shading: &Shading<'_>,
        (rays, hits, draws): (&[Ray], &[Hit], &[Draws]),
        colors: &mut [Color],
        coverage: &mut [f64],
    ) {
        let up = unit(self.up);
        let mut points = Vec::new();
        for (k, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            let crossed = || self.crossed(up, ray);
            if let Some(position) = hit.is_miss().then(crossed).flatten() {
                points.push(Point { sample: k, position, draws: draws[k] });
            }
        }
        if points.is_empty() {
            return;
        }
        let shadows = Shadows::new(shading, up, &points);
        for (point, share) in points.iter().zip(shadows.shares()) {
            colors[point.sample] *= 1.0 - share;
            coverage[point.sample] = share;
        }
    }

    /// The point where a ray goes through the plane from above.
    fn crossed(&self, up: DVec3, ray: &Ray) -> Option<DVec3> {
        let descent = -ray.direction.dot(up);
        let t = (ray.origin - self.point).dot(up) / descent;
        // Written so that a NaN fails.
        let is_crossed =
            descent > 0.0 && t > 0.0 && t < f64::INFINITY && t > ray.t_min && t <= ray.t_max;
        is_crossed.then(|| ray.at(t))
    }
}

/// A point of the ground.
struct Point {
    /// The sample that sees it.
    sample: usize,
    position: DVec3,
    draws: Draws,
}

/// The light at points of the ground: how much would be there without anything, and how much of
/// that is missing.
///
/// Missing light is sampled: it is the light of those rays towards lights that something blocks.
/// The full light is known, or estimated from points that are the same for all samples of a pixel.
/// So the mean over samples of their ratio is the share that is missing, although a single sample
/// may say more than 1.
struct Shadows {
    missing: Vec<Color>,
    full: Vec<Color>,
    /// The bounds of everything that can block light; `None` where that has no end.
    blocking: Option<BlockerBounds>,
}

impl Shadows {
    fn new(shading: &Shading<'_>, up: DVec3, points: &[Point]) -> Self {
        let mut shadows = Self {
            missing: vec![Color::ZERO; points.len()],
            // Light that nothing blocks is never missing.
            full: vec![shading.shader.ambient(); points.len()],
            blocking: shading.scene.blocking_bounds().map(BlockerBounds::new),
        };
        shadows.add_lights(shading, up, points);
        shadows.add_emitters(shading, up, points);
        let emitters = shading.scene.emitters();
        let has_light = !shading.scene.lights().is_empty() || emitters.has_any();
        match shading.scene.environment() {
            Some(environment) => shadows.add_environment(shading, environment, up, points),
            // Where nothing shines, as for shaders without light, it is as under a white sky.
            None if !has_light => {
                let white = Environment::new(EnvironmentKind::Uniform(Color::ONE));
                shadows.add_environment(shading, &white, up, points);
            }
            None => {}
        }
        shadows
    }

    fn add_lights(&mut self, shading: &Shading<'_>, up: DVec3, points: &[Point]) {
        let mut rays = BlockedRays::with_capacity(self.blocking, points.len());
        let set = shading.engine.instruction_set();
        let ground = Receiver { up, blocking: self.blocking };
        for light in shading.scene.lights() {
            let (key, prepared) = (light.key(), light.prepared());
            // A sun is the same everywhere, and has a closed form.
            let everywhere = matches!(light, Light::Directional(_))
                .then(|| taken_by_white(light, (DVec3::ZERO, up), 1));
            if everywhere == Some(Color::ZERO) {
                continue;
            }
            let cone = Cone::of_sun(light, self.blocking);
            for (index, point) in points.iter().enumerate() {
                let here = || taken_by_white(light, (point.position, up), side(light, point));
                self.full[index] += everywhere.unwrap_or_else(here);
            }
            let is_clear = |point: &Point| cone.is_some_and(|cone| cone.is_clear(point.position));
            for (row, indices) in rows(points, |point| !is_clear(point)) {
                let arriving = ground.draw_light(set, &row, (&prepared, key));
                rays.push_row(&row, &indices, &arriving);
            }
            rays.add_to(&mut self.missing, shading);
        }
    }

    fn add_emitters(&mut self, shading: &Shading<'_>, up: DVec3, points: &[Point]) {
        let emitters = shading.scene.emitters();
        if emitters.is_empty() {
            return;
        }
        let mut rays = BlockedRays::with_capacity(self.blocking, points.len());
        for (index, point) in points.iter().enumerate() {
            let mut draws = point.draws.split(stream::EMITTERS);
            let drawn = emitters.sample(shading.scene, point.position, draws.three());
            if let Some((arriving, surface)) = drawn {
                rays.push(point, index, up, &arriving, surface);
            }
            if let Some(known) = emitters.irradiance(shading.scene, point.position, up) {
                self.full[index] += known;
                continue;
            }
            // Those of the pixel's first samples, for every sample: so their error does not depend
            // on what the sample finds.
            let taken = (0..DRAWS_OF_EMITTERS).filter_map(|sample| {
                let mut draws = point.draws.of_sample(sample).split(stream::EMITTERS);
                emitters.sample(shading.scene, point.position, draws.three())
            });
            let taken: Color = taken.map(|(arriving, _)| taken_of(&arriving, up)).sum();
            self.full[index] += taken / f64::from(DRAWS_OF_EMITTERS);
        }
        rays.add_to(&mut self.missing, shading);
    }

    /// Two ways to find what of an environment is hidden: by the cosine, and by its table if it has
    /// one.
    fn add_environment(
        &mut self,
        shading: &Shading<'_>,
        environment: &Environment,
        up: DVec3,
        points: &[Point],
    ) {
        let mut rays = BlockedRays::with_capacity(self.blocking, points.len());
        let full = environment.irradiance(up);
        for sum in &mut self.full {
            *sum += full;
        }
        let set = shading.engine.instruction_set();
        let ground = Receiver { up, blocking: self.blocking };
        for (row, indices) in rows(points, |_| true) {
            let arriving = ground.sample_sky(set, &row, environment);
            rays.push_row(&row, &indices, &arriving);
        }
        if environment.is_drawn() {
            for (index, point) in points.iter().enumerate() {
                let mut draws = point.draws.split(stream::ENVIRONMENT);
                if let Some(arriving) = environment.sample(draws.two())
                    && let Some(pdf) = arriving.pdf
                {
                    let towards = unit(arriving.towards);
                    let ray = Ray::new(point.position, towards);
                    rays.push_ray(ray, None, index, || {
                        let own = towards.dot(up).max(0.0) / PI;
                        power_heuristic(pdf, own) * taken_of(&arriving, up)
                    });
                }
            }
        }
        rays.add_to(&mut self.missing, shading);
    }

    /// The share of the light that is missing at each point.
    fn shares(&self) -> impl Iterator<Item = f64> {
        self.missing.iter().zip(&self.full).map(|(missing, full)| {
            let share = missing.element_sum() / full.element_sum();
            // No light at all is no shadow.
            if share.is_finite() { share } else { 0.0 }
        })
    }
}

/// The bounds of everything that can block light: a box, and the ball around it.
#[derive(Clone, Copy)]
struct BlockerBounds {
    bounds: Bounds,
    center: DVec3,
    radius: f64,
}

impl BlockerBounds {
    fn new(bounds: Bounds) -> Self {
        Self { bounds, center: bounds.centre(), radius: 0.5 * bounds.size().length() }
    }

    /// Whether a ray may meet what is in the box. Most rays that miss the box miss the ball too,
    /// which takes no division to see.
    fn may_be_met(&self, ray: &Ray) -> bool {
        !self.is_passed_by(ray.origin, ray.direction) && self.bounds.may_be_met(ray, 0.0)
    }

    /// Whether a ray passes the ball by.
    #[inline(always)]
    fn is_passed_by(&self, origin: DVec3, direction: DVec3) -> bool {
        let way = self.center - origin;
        let along = way.dot(direction);
        // Of the way to where the ray touches the ball; below zero within it.
        let squared = way.length_squared() - self.radius * self.radius;
        let touching = (1.0 - 1e-9) * squared * direction.length_squared();
        squared > 0.0 && (along < 0.0 || along * along < touching)
    }
}

/// The directions of a sun, and what may block them.
#[derive(Clone, Copy)]
struct Cone {
    towards: DVec3,
    /// The sine and the cosine of the angle from the sun's middle to its edge.
    half: [f64; 2],
    blocking: BlockerBounds,
}

impl Cone {
    fn of_sun(light: &Light, blocking: Option<BlockerBounds>) -> Option<Self> {
        let (Light::Directional(sun), Some(blocking)) = (light, blocking) else {
            return None;
        };
        let (sine, cosine) = libm::sincos((0.5 * sun.angle_degrees).to_radians());
        Some(Self { towards: -unit(sun.direction), half: [sine, cosine], blocking })
    }

    /// Whether all of the sun passes the ball by, seen from a point.
    fn is_clear(&self, point: DVec3) -> bool {
        let way = self.blocking.center - point;
        let distance = way.length();
        let sine = self.blocking.radius / distance;
        let cosine = (1.0 - sine * sine).sqrt();
        let [sun_sine, sun_cosine] = self.half;
        // The ball and the sun touch where the angle between them is the sum of theirs, less than
        // half a turn. Written so that a NaN, as within the ball, fails.
        let touching = cosine * sun_cosine - sine * sun_sine;
        self.towards.dot(way) < (touching - 1e-9) * distance && cosine >= 0.0
    }
}

/// The irradiance over pi of the ground by light from one direction.
fn taken_of(arriving: &LightSample, up: DVec3) -> Color {
    cosine(arriving.towards, up) * arriving.light
}

/// The side of the grid of a light's points over which its light is summed: more where a light is
/// seen large, and its points are at different distances. The ground's light is off by less than
/// a hundredth.
fn side(light: &Light, point: &Point) -> u32 {
    let middle = light.sample(point.position, DVec2::splat(0.5));
    let solid_angle = middle.and_then(|middle| middle.pdf).map_or(0.0, f64::recip);
    match solid_angle {
        ..0.05 => 4,
        ..0.5 => 8,
        _ => 16,
    }
}

/// The number of points of emissive surfaces that estimate the ground's light from them without
/// occlusion.
const DRAWS_OF_EMITTERS: u32 = 32;

/// Rays towards light, and what is missing where something blocks them: what they would bring is
/// taken from the sum, and what arrives is given back.
struct BlockedRays {
    rays: ShadowRays,
    brought: Vec<(usize, Color)>,
    /// Rays that pass it by are not traced.
    blocking: Option<BlockerBounds>,
}

impl BlockedRays {
    fn with_capacity(blocking: Option<BlockerBounds>, count: usize) -> Self {
        Self {
            rays: ShadowRays::with_capacity(count),
            brought: Vec::with_capacity(count),
            blocking,
        }
    }

    fn push(
        &mut self,
        point: &Point,
        index: usize,
        up: DVec3,
        arriving: &LightSample,
        end: SurfaceId,
    ) {
        let ray =
            Ray::new(point.position, arriving.towards).up_to(arriving.ray_end(point.position));
        self.push_ray(ray, Some(end), index, || taken_of(arriving, up));
    }

    /// Adds the rays of a row of points, whose numbers are given.
    fn push_row(&mut self, row: &ShadingPoints, indices: &[usize], arriving: &Arriving) {
        for (k, &index) in indices.iter().enumerate() {
            let light = arriving.light.get(k);
            if light == Color::ZERO {
                continue;
            }
            let ray = arriving.ray(k, row.position.get(k));
            // Those that pass the ball by are black already.
            let may_be_blocked = |blocking: BlockerBounds| blocking.bounds.may_be_met(&ray, 0.0);
            if self.blocking.is_none_or(may_be_blocked) {
                self.add(ray, None, index, light);
            }
        }
    }

    fn push_ray(
        &mut self,
        ray: Ray,
        end: Option<SurfaceId>,
        index: usize,
        brought: impl FnOnce() -> Color,
    ) {
        let may_be_blocked = |blocking: BlockerBounds| blocking.may_be_met(&ray);
        if !self.blocking.is_none_or(may_be_blocked) {
            return;
        }
        self.add(ray, end, index, brought());
    }

    fn add(&mut self, ray: Ray, end: Option<SurfaceId>, index: usize, brought: Color) {
        if is_light(brought) {
            let mut filter = RayFilter::NONE;
            filter.skip[1] = end;
            self.rays.push((ray, filter), self.brought.len(), brought);
            self.brought.push((index, brought));
        }
    }

    /// Adds what is missing to the sums of the points, and forgets the rays.
    fn add_to(&mut self, missing: &mut [Color], shading: &Shading<'_>) {
        let mut arrived = vec![Color::ZERO; self.brought.len()];
        self.rays.add_to(&mut arrived, shading, true);
        for ((index, brought), arrived) in self.brought.drain(..).zip(arrived) {
            missing[index] += brought - arrived;
        }
    }
}
