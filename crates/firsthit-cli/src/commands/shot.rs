//! What some rays hit, as a frame.

use std::ops::AddAssign;

use firsthit::channel::{Kind, Shots, make};
use firsthit::image::Frame;
use firsthit::render::origin;
use firsthit::shoot::{First, trace};
use firsthit::{Rays as _, Scene};

use crate::failure::Failure;
use crate::progress::Progress;
use crate::rays::RayArrays;

/// How many rays there were, and how many of them hit.
#[derive(Debug, Default)]
pub(super) struct Counts {
    pub(super) rays: u64,
    pub(super) hits: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, more: Self) {
        self.rays += more.rays;
        self.hits += more.hits;
    }
}

/// Shoots rays, and computes channels of their first hits.
pub(super) fn shot(
    scene: &Scene,
    rays: &RayArrays,
    kinds: &[&Kind],
    progress: &Progress<'_>,
) -> Result<(Frame, Counts), Failure> {
    let hits = trace(scene, rays, First, progress)?;
    let shots = Shots {
        scene,
        rays,
        hits: &hits,
        sensor: None,
    };
    let mut frame = Frame::new([rays.len()]).from_origin(origin(scene, None, None));
    for channel in make(kinds, &shots, progress)? {
        frame.push(channel)?;
    }
    let counts = Counts {
        rays: rays.len() as u64,
        hits: hits.count_hit() as u64,
    };
    Ok((frame, counts))
}
