//! Every surface on the way of a ray, not only the first.

use std::ops::Range;

use super::{Points, Shading};
use crate::geometry::{Hit, Ray};
use crate::scene::{Scene, SurfaceInteraction};
use crate::shoot::{All, AllHits, trace_into};

/// All that some rays meet, those of one ray after those of another, in order.
pub(super) struct Crossings {
    /// A ray for each hit.
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    /// The start of each ray's hits, and the end of the last ones.
    offsets: Vec<usize>,
}

impl Crossings {
    /// Finds all hits of the rays to all points. They are shot together.
    pub(super) fn new(shading: &Shading<'_>, points: &Points<'_>) -> Self {
        let shot: Vec<Ray> = points.surfaces.iter().map(|hit| *hit.ray()).collect();
        let mut all = AllHits::default();
        let into = (All::default(), &mut all);
        let traced = trace_into(shading.engine, shading.scene, &shot[..], into, &());
        debug_assert!(traced.is_ok(), "no watch can stop it");
        let AllHits { offsets, hits } = all;
        let counts = offsets.windows(2).map(|ends| ends[1] - ends[0]);
        let rays = shot.iter().zip(counts);
        Self {
            rays: rays.flat_map(|(&ray, count)| std::iter::repeat_n(ray, count)).collect(),
            hits: (0..hits.len()).map(|k| hits.get(k)).collect(),
            offsets,
        }
    }

    /// The surface interaction of each hit.
    pub(super) fn surfaces<'a>(&'a self, scene: &'a Scene) -> Vec<SurfaceInteraction<'a>> {
        let pairs = self.rays.iter().zip(&self.hits);
        let surface = |(ray, hit)| scene.interaction(ray, hit).expect("it was met");
        pairs.map(surface).collect()
    }

    /// The range of each ray's hits.
    pub(super) fn of_rays(&self) -> impl Iterator<Item = Range<usize>> {
        self.offsets.windows(2).map(|ends| ends[0]..ends[1])
    }
}
