//! The objects that neighbouring rays may meet, for all of them at once.

use super::{Candidate, TopTree};
use crate::accel::{PacketWalk, RAYS, WalkStack, WorldRays};
use crate::simd::Lanes;

impl TopTree {
    /// The objects that neighbouring rays may meet; `None` where they do not go together, or where
    /// there is no tree.
    #[inline(always)]
    pub(in crate::scene) fn packet_candidates<L: Lanes>(
        &self,
        l: L,
        rays: (&WorldRays, usize),
        stack: &mut WalkStack,
    ) -> Option<PacketCandidates<'_>> {
        (self.outside.len() < self.count).then_some(())?;
        let walk = self.tree.packet_walk(l, rays, stack)?;
        Some(PacketCandidates { outside: &self.outside, walk })
    }
}

/// Objects that the rays of a packet may meet.
pub struct PacketCandidates<'a> {
    outside: &'a [Candidate],
    walk: PacketWalk<'a>,
}

impl PacketCandidates<'_> {
    /// The next object, and the rays that may meet it at a parameter of at most their limit, a bit
    /// each. From call to call no limit must grow, and the rays and `stack` must be the same.
    #[inline(always)]
    pub fn next<L: Lanes>(
        &mut self,
        l: L,
        limits: &[f64; RAYS],
        stack: &mut WalkStack,
    ) -> Option<(u32, u16)> {
        if let Some((first, rest)) = self.outside.split_first() {
            self.outside = rest;
            let is_open = |lane: usize| u16::from(limits[lane] >= 0.0) << lane;
            return Some((first.object, (0..RAYS).map(is_open).sum()));
        }
        self.walk.next(l, limits, stack)
    }
}
