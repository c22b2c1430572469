//! Any hit: does a ray meet anything?
//!
//! 1. Drop a candidate that is before `t_min`, by its depths.
//! 2. A candidate that is certain to be met, and certainly between `t_min` and `t_max`, ends the traversal.
//! 3. For any other candidate the exact test decides.

use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor};
use crate::accel::filter::Candidates;
use crate::accel::meshlet::Meshlet;
use crate::shape::Crossing;
use crate::simd::{Kernel, Lanes, set_bits};

/// The state of an any-hit query: see [the module](self).
///
/// It is one number, so that the state of sixteen is a copy of their limits.
pub(crate) struct Any {
    /// [`FOUND`] when something is met.
    limit: f32,
}

/// The limit that ends the traversal with an answer: below all that a query begins with.
const FOUND: f32 = -2.0;

impl MeshQuery for Any {
    type Found = bool;
    const IN_PACKETS_FILTERED: bool = true;
    const NONE: Self::Found = false;

    #[inline(always)]
    fn new(limit: f32) -> Self {
        // Negative ones are alike: nothing is met.
        let limit = if limit < -1.0 { -1.0 } else { limit };
        Self { limit }
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
        let limits = &ray.limits;
        if high < limits.t_min_low {
            return;
        }
        let leaf = &ray.tree.leaves[leaf as usize];
        let is_inside = is_certain && low > limits.t_min_high && high < limits.t_max_low;
        if is_inside || l.call(ExactTest(ray, leaf, 1 << lane)) {
            self.limit = FOUND;
        }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, _: L, _: &MeshRay<'_>, _: Crossing) {
        self.limit = FOUND;
    }

    #[inline(always)]
    fn deferred(&self) -> Option<(u32, usize)> {
        None
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: L, _: &MeshRay<'_>) -> Self::Found {
        self.limit == FOUND
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
        let limits = &ray.limits;
        let inside = l.lt(l.splat(limits.t_min_high), candidates.low)
            & l.lt(candidates.high, l.splat(limits.t_max_low));
        let leaf = &ray.tree.leaves[leaf as usize];
        let possible = candidates.possible & l.le(l.splat(limits.t_min_low), candidates.high);
        debug_assert!(self.limit != FOUND, "an answer is never taken back");
        let is_certain = possible & candidates.certain & inside != 0;
        if is_certain || possible != 0 && l.call(ExactTest(ray, leaf, possible)) {
            self.limit = FOUND;
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}

/// Whether a ray meets one of some triangles of a leaf, by the exact test. A function of its own: it is rarely called, and leaves
/// the registers to what is.
struct ExactTest<'a>(&'a MeshRay<'a>, &'a Meshlet, u16);

impl Kernel for ExactTest<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> bool {
        let Self(ray, leaf, triangles) = self;
        for lane in set_bits(triangles) {
            if ray.intersect(l, Any::EDGES, leaf, lane).is_some() {
                return true;
            }
        }
        false
    }
}
