//! Any hit: does a ray meet anything?
//!
//! 1. Drop a candidate that is before `t_min`, by its depths.
//! 2. A candidate that is certain to be met, and certainly between `t_min` and `t_max`, ends the traversal.
//! 3. For any other candidate the exact test decides.

use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor};
use crate::accel::filter::Candidates;
use crate::accel::rays::limits::Limits;
use crate::shape::Crossing;
use crate::simd::{Lanes, set_bits};

/// The state of an any-hit query: see [the module](self).
pub(crate) struct Any {
    is_found: bool,
    limit: f32,
    limits: Limits,
}

impl MeshQuery for Any {
    type Found = bool;
    const IN_PACKETS_FILTERED: bool = true;
    const NONE: Self::Found = false;

    #[inline(always)]
    fn new(limits: Limits) -> Self {
        Self {
            is_found: false,
            limit: limits.t_max_high,
            limits,
        }
    }

    #[inline(always)]
    fn visit_one<L: Lanes>(
        &mut self,
        l: L,
        ray: &MeshRay<'_>,
        (leaf, lane): (u32, usize),
        (low, high): (f32, f32),
        is_certain: bool,
    ) {
        if high < self.limits.t_min_low {
            return;
        }
        let leaf = &ray.tree.leaves[leaf as usize];
        let is_inside = is_certain && low > self.limits.t_min_high && high < self.limits.t_max_low;
        if is_inside || ray.intersect(l, Self::EDGES, leaf, lane).is_some() {
            self.is_found = true;
            self.limit = -1.0;
        }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, _: L, _: &MeshRay<'_>, _: Crossing) {
        self.is_found = true;
        self.limit = -1.0;
    }

    #[inline(always)]
    fn deferred(&self) -> Option<(u32, usize)> {
        None
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: L, _: &MeshRay<'_>) -> Self::Found {
        self.is_found
    }

    #[inline(always)]
    fn of_crossing(crossing: Option<Crossing>) -> Self::Found {
        crossing.is_some()
    }
}

impl Visitor for Any {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        let inside = l.lt(l.splat(self.limits.t_min_high), candidates.low)
            & l.lt(candidates.high, l.splat(self.limits.t_max_low));
        let leaf = &ray.tree.leaves[leaf as usize];
        let possible = candidates.possible & l.le(l.splat(self.limits.t_min_low), candidates.high);
        debug_assert!(!self.is_found, "an answer is never taken back");
        self.is_found = possible & candidates.certain & inside != 0;
        for lane in set_bits(possible) {
            if self.is_found {
                break;
            }
            self.is_found = ray.intersect(l, Self::EDGES, leaf, lane).is_some();
        }
        if self.is_found {
            self.limit = -1.0;
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}
