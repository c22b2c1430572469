//! Points of the ground, many at a time.

use std::f64::consts::PI;

use super::{BlockerBounds, Point};
use crate::geometry::rows::ROW;
use crate::geometry::{Color, DVec3, unit};
use crate::sampling::{TangentFrame, warp};
use crate::scene::{Environment, PreparedLight};
use crate::shade::rows::{Arriving, DrawnLight, LightSamples, ShadingPoints, Sky};
use crate::shade::vertex::power_heuristic;
use crate::simd::{self, InstructionSet, Kernel, Lanes};

/// The cosine of a direction of any length to the ground's normal.
#[inline(always)]
pub(super) fn cosine(towards: DVec3, up: DVec3) -> f64 {
    unit(towards).dot(up).max(0.0)
}

/// Gathers the wanted points in rows, with their numbers.
pub(super) fn rows(
    points: &[Point],
    is_wanted: impl Fn(&Point) -> bool,
) -> Vec<(ShadingPoints, Vec<usize>)> {
    let mut rows = Vec::with_capacity(points.len().div_ceil(ROW));
    for (index, point) in points.iter().enumerate() {
        if !is_wanted(point) {
            continue;
        }
        if rows.last().is_none_or(|(row, _): &(ShadingPoints, _)| row.is_full()) {
            rows.push((ShadingPoints::NONE, Vec::with_capacity(ROW)));
        }
        if let Some((row, indices)) = rows.last_mut() {
            row.push(point.position, point.draws);
            indices.push(index);
        }
    }
    rows
}

/// A ground that takes light, and what may block that.
#[derive(Clone, Copy)]
pub(super) struct Receiver {
    pub(super) up: DVec3,
    pub(super) blocking: Option<BlockerBounds>,
}

impl Receiver {
    /// A sample of a light for each point, with the numbers of the light's stream, and what the
    /// ground takes of it. It is black where nothing can block it.
    pub(super) fn draw_light(
        self,
        set: InstructionSet,
        row: &ShadingPoints,
        (light, stream): (&PreparedLight, u64),
    ) -> Arriving {
        match light {
            PreparedLight::Sun(sun) => simd::run_here(set, DrawLight(self, row, sun, stream)),
            PreparedLight::Other(light) => simd::run_here(set, DrawLight(self, row, light, stream)),
        }
    }

    /// A cosine-weighted direction for each point, and what the environment brings from there. It
    /// is black where nothing can block it.
    pub(super) fn sample_sky(
        self,
        set: InstructionSet,
        row: &ShadingPoints,
        environment: &Environment,
    ) -> Arriving {
        match &environment.hemispheres() {
            Some(sky) => simd::run_here(set, SampleSky(self, row, sky)),
            None => simd::run_here(set, SampleSky(self, row, environment)),
        }
    }

    /// Makes light black that nothing can block.
    #[inline(always)]
    fn blacken_unblocked(self, row: &ShadingPoints, arriving: &mut Arriving) {
        let Some(blocking) = self.blocking else {
            return;
        };
        for k in 0..row.len() {
            let (origin, direction) = (row.position.get(k), arriving.towards.get(k));
            let light = if blocking.is_passed_by(origin, direction) {
                Color::ZERO
            } else {
                arriving.light.get(k)
            };
            arriving.light.set(k, light);
        }
    }
}

/// See [`Receiver::draw_light`].
struct DrawLight<'a, S>(Receiver, &'a ShadingPoints, &'a S, u64);

impl<S: DrawnLight> Kernel for DrawLight<'_, S> {
    type Output = Arriving;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Arriving {
        let Self(ground, row, light, stream) = self;
        let LightSamples { towards, end, mut light, .. } = row.draw_light(light, stream);
        for k in 0..row.len() {
            light.set(k, cosine(towards.get(k), ground.up) * light.get(k));
        }
        let mut arriving = Arriving { towards, end, light };
        ground.blacken_unblocked(row, &mut arriving);
        arriving
    }
}

/// See [`Receiver::sample_sky`].
struct SampleSky<'a, S>(Receiver, &'a ShadingPoints, &'a S);

impl<S: Sky> Kernel for SampleSky<'_, S> {
    type Output = Arriving;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Arriving {
        let Self(ground, row, sky) = self;
        let mut arriving = Arriving::NONE;
        let frame = TangentFrame::around(ground.up);
        let u = row.draw(None);
        for k in 0..row.len() {
            let local = warp::cosine_hemisphere(u.get(k));
            arriving.towards.set(k, frame.world(local));
        }
        for k in 0..row.len() {
            let towards = arriving.towards.get(k);
            let own = towards.dot(ground.up).max(0.0) / PI;
            let share = power_heuristic(own, sky.pdf(towards));
            arriving.light.set(k, share * sky.radiance(towards));
        }
        ground.blacken_unblocked(row, &mut arriving);
        arriving
    }
}
