//! The hits of some rays, as a frame.

use std::ops::AddAssign;

use firsthit::channel::{ChannelInput, ChannelKind, RAY, make};
use firsthit::image::{Data, Frame};
use firsthit::render::origin;
use firsthit::shoot::{All, AllHits, First, RaysOfHits, trace};
use firsthit::{Rays as _, Scene};

use crate::failure::Failure;
use crate::progress::Progress;
use crate::rays::RayArrays;

/// The number of rays, and the number of those that hit.
#[derive(Debug, Default)]
pub(super) struct Counts {
    pub(super) rays: u64,
    pub(super) hits: u64,
    /// The hits of all rays, where they were asked for.
    pub(super) crossings: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, more: Self) {
        self.rays += more.rays;
        self.hits += more.hits;
        self.crossings += more.crossings;
    }
}

/// Shoots rays, and computes channels of their first hits.
pub(super) fn shot(
    scene: &Scene,
    rays: &RayArrays,
    kinds: &[&ChannelKind],
    progress: &Progress,
) -> Result<(Frame, Counts), Failure> {
    let hits = trace(scene, rays, First, progress)?;
    let shots = ChannelInput { scene, rays, hits: &hits, sensor: None };
    let mut frame = Frame::new([rays.len()]).from_origin(origin(scene, None, None, kinds));
    for channel in make(kinds, &shots, progress)? {
        frame.push(channel)?;
    }
    let counts = Counts { rays: rays.len() as u64, hits: hits.count_hit() as u64, crossings: 0 };
    Ok((frame, counts))
}

/// Shoots rays, and computes channels of all their hits; of each ray the first ones, if `query`
/// says so. The first of the kinds is [`RAY`].
pub(super) fn shot_all(
    scene: &Scene,
    rays: &RayArrays,
    (query, kinds): (All, &[&ChannelKind]),
    progress: &Progress,
) -> Result<(Frame, Counts), Failure> {
    let all = trace(scene, rays, query, progress)?;
    let numbers = all.ray_numbers()?;
    let AllHits { offsets, hits } = all;
    let shots =
        ChannelInput { scene, rays: &RaysOfHits::new(rays, &numbers), hits: &hits, sensor: None };
    let made = make(&kinds[1..], &shots, progress)?;
    let counts = Counts {
        rays: rays.len() as u64,
        hits: (offsets.windows(2)).filter(|ends| ends[0] < ends[1]).count() as u64,
        crossings: hits.len() as u64,
    };
    let mut frame = Frame::new([hits.len()]).from_origin(origin(scene, None, None, kinds));
    frame.push(RAY.channel(Data::Int32(numbers)))?;
    for channel in made {
        frame.push(channel)?;
    }
    Ok((frame, counts))
}
