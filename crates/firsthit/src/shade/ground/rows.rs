//! Points of the ground, many at a time.

use std::f64::consts::PI;

use super::{BlockerBounds, Point};
use crate::geometry::rows::ROW;
use crate::geometry::{Color, DVec3, unit};
use crate::sampling::{TangentFrame, warp};
use crate::shade::rows::{Arriving, DrawnLight, LightSamples, ShadingPoints, Sky};
use crate::shade::vertex::power_heuristic;
use crate::simd::{Kernel, Lanes};

/// The cosine of a direction of any length to the ground's normal.
#[inline(always)]
pub(super) fn cosine(towards: DVec3, up: DVec3) -> f64 {
    unit(towards).dot(up).max(0.0)
}

/// Those points that are wanted, in rows, and their numbers.
pub(super) fn rows(
    points: &[Point],
    is_wanted: impl Fn(&Point) -> bool,
) -> Vec<(ShadingPoints, Vec<usize>)> {
    let mut rows = Vec::with_capacity(points.len().div_ceil(ROW));
    for (index, point) in points.iter().enumerate() {
        if !is_wanted(point) {
            continue;
        }
        if rows
            .last()
            .is_none_or(|(places, _): &(ShadingPoints, _)| places.is_full())
        {
            rows.push((ShadingPoints::NONE, Vec::with_capacity(ROW)));
        }
        if let Some((places, indices)) = rows.last_mut() {
            places.push(point.position, point.draws);
            indices.push(index);
        }
    }
    rows
}

/// A sample of a light for each point, and what the ground takes of it; black where nothing can block it.
pub(super) struct DrawLight<'a, S> {
    pub(super) places: &'a ShadingPoints,
    pub(super) light: &'a S,
    pub(super) stream: u64,
    pub(super) up: DVec3,
    pub(super) blocking: Option<BlockerBounds>,
}

impl<S: DrawnLight> Kernel for DrawLight<'_, S> {
    type Output = Arriving;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Arriving {
        let Self { places, up, .. } = self;
        let LightSamples {
            towards,
            end,
            mut light,
            ..
        } = places.draw_light(self.light, self.stream);
        for k in 0..places.len() {
            light.set(k, cosine(towards.get(k), up) * light.get(k));
        }
        let mut arriving = Arriving {
            towards,
            end,
            light,
        };
        blacken_unblocked(self.blocking, places, &mut arriving);
        arriving
    }
}

/// A direction by the cosine for each point, and what the environment brings from there; black where nothing can block it.
pub(super) struct SampleSky<'a, S> {
    pub(super) places: &'a ShadingPoints,
    pub(super) sky: &'a S,
    pub(super) up: DVec3,
    pub(super) blocking: Option<BlockerBounds>,
}

impl<S: Sky> Kernel for SampleSky<'_, S> {
    type Output = Arriving;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Arriving {
        let Self {
            places, sky, up, ..
        } = self;
        let mut arriving = Arriving::NONE;
        let frame = TangentFrame::around(up);
        let u = places.draw(None);
        for k in 0..places.len() {
            let local = warp::cosine_hemisphere(u.get(k));
            arriving.towards.set(k, frame.world(local));
        }
        for k in 0..places.len() {
            let towards = arriving.towards.get(k);
            let own = towards.dot(up).max(0.0) / PI;
            let share = power_heuristic(own, sky.pdf(towards));
            arriving.light.set(k, share * sky.radiance(towards));
        }
        blacken_unblocked(self.blocking, places, &mut arriving);
        arriving
    }
}

/// Makes light black that nothing can block.
#[inline(always)]
fn blacken_unblocked(
    blocking: Option<BlockerBounds>,
    places: &ShadingPoints,
    arriving: &mut Arriving,
) {
    let Some(blocking) = blocking else { return };
    for k in 0..places.len() {
        let (origin, direction) = (places.position.get(k), arriving.towards.get(k));
        let light = if blocking.is_passed_by(origin, direction) {
            Color::ZERO
        } else {
            arriving.light.get(k)
        };
        arriving.light.set(k, light);
    }
}
