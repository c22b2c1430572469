//! The lines of beams, and what they meet.

use std::ops::Range;

use super::settings::{Returns, ScanSettings};
use crate::error::Result;
use crate::geometry::{DVec3, Ray, Rays};
use crate::memory::filled;
use crate::parallel;
use crate::scene::Scene;
use crate::sensor::Lidar;
use crate::shoot::{All, AllHits, First, Hits, trace};
use crate::watch::Watch;

/// The lines of some beams of a scanner, beam by beam.
pub(super) struct Lines<'a> {
    lidar: &'a Lidar,
    pub(super) beams: Range<usize>,
    /// The number of lines of a beam.
    pub(super) each: usize,
    /// The directions of cones' lines; of beams that are lines none.
    ways: Vec<DVec3>,
    far: f64,
}

/// The hits of lines.
pub(super) struct Met {
    pub(super) hits: Hits,
    /// Where the hits of each line begin, if it has several; otherwise each has one, which may be a
    /// miss.
    offsets: Vec<usize>,
    near: f64,
}

impl<'a> Lines<'a> {
    pub(super) fn new(
        lidar: &'a Lidar,
        beams: Range<usize>,
        settings: &ScanSettings,
    ) -> Result<Self> {
        let each = settings.lines();
        let mut ways = Vec::new();
        if let Some(divergence) = settings.divergence {
            ways = filled(beams.len().saturating_mul(each), DVec3::ZERO)?;
            // As many beams as have some thousand lines.
            let part = (parallel::MANY / each).max(1);
            let parts = ways.chunks_mut(part * each).zip(beams.clone().step_by(part));
            parallel::try_each(parts, |(ways, first)| {
                let cones = ways.chunks_exact_mut(each).zip(first..);
                { cones }.try_for_each(|(cone, beam)| lidar.spread(beam, divergence, cone))
            })?;
        }
        Ok(Self { lidar, beams, each, ways, far: settings.max_range })
    }

    /// Shoots them. Lines of a cone, and those whose first return is wanted alone, end at their
    /// first hit.
    pub(super) fn shot(
        &self,
        scene: &Scene,
        settings: &ScanSettings,
        watch: &dyn Watch,
    ) -> Result<Met> {
        let is_first = settings.returns == Returns::First && settings.range_gate == 0.0;
        let (hits, offsets) = if is_first || settings.divergence.is_some() {
            (trace(scene, self, First, watch)?, Vec::new())
        } else {
            let AllHits { offsets, hits } = trace(scene, self, All::default(), watch)?;
            (hits, offsets)
        };
        let near = settings.min_range;
        Ok(Met { hits, offsets, near })
    }
}

impl Rays for Lines<'_> {
    fn len(&self) -> usize {
        self.beams.len() * self.each
    }

    fn ray(&self, index: usize) -> Ray {
        let mut ray = self.lidar.ray(self.beams.start + index / self.each);
        if let Some(&way) = self.ways.get(index) {
            ray = Ray::new(ray.origin, way);
        }
        ray.up_to(self.far)
    }
}

impl Met {
    /// The places of a line's hits; none of a line that something blocks, which is nearer than
    /// ranges begin.
    pub(super) fn of_line(&self, line: usize) -> Range<usize> {
        let places = match self.offsets.get(line..line + 2) {
            Some(ends) => ends[0]..ends[1],
            None if self.hits.object[line] < 0 => 0..0,
            None => line..line + 1,
        };
        let is_blocked = !places.is_empty() && self.hits.t[places.start] <= self.near;
        if is_blocked { 0..0 } else { places }
    }

    /// The number of the line of each hit.
    pub(super) fn lines(&self) -> Vec<i32> {
        let numbers = |end: usize| 0..i32::try_from(end).unwrap_or(i32::MAX);
        if self.offsets.is_empty() {
            return numbers(self.hits.len()).collect();
        }
        let counts = self.offsets.windows(2).map(|ends| ends[1] - ends[0]);
        let lines = numbers(self.offsets.len()).zip(counts);
        lines.flat_map(|(line, count)| std::iter::repeat_n(line, count)).collect()
    }
}
