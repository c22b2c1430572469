//! Any query, for rays that do not meet everything: some leave a triangle, or cull a side, or skip
//! triangles.
//!
//! 1. Hand a candidate to the query where the filter cannot matter: it is met for certain, and
//!    ahead of the ray's start for certain, no side is culled, and neither it nor a copy in its
//!    place is skipped.
//! 2. For any other candidate the exact test of [`MeshFilter`] decides, and for each copy in its
//!    place where the filter tells them apart.

use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor, visit_each};
use crate::accel::filter::Candidates;
use crate::shape::Crossing;
use crate::shape::triangle::EdgeRule;
use crate::simd::Lanes;

#[cfg(doc)]
use crate::shape::triangle::MeshFilter;

/// The state of a query for filtered rays: see [the module](self).
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct FilteredQuery<Q> {
    query: Q,
}

impl<Q: MeshQuery> MeshQuery for FilteredQuery<Q> {
    type Found = Q::Found;
    const EDGES: EdgeRule = Q::EDGES;
    const IN_PACKETS: bool = Q::IN_PACKETS_FILTERED;
    const NONE: Self::Found = Q::NONE;

    #[inline(always)]
    fn new(limit: f32) -> Self {
        Self { query: Q::new(limit) }
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
        if ray.limits.begin_after(high) || low > self.query.limit() {
            return;
        }
        let tree = ray.tree;
        let triangle = tree.triangle(&tree.leaves[leaf as usize], lane);
        if ray.leaves_behind(triangle) {
            return;
        }
        let here = || {
            let copies = tree.copies_of(triangle).iter().map(|&[_, copy]| copy);
            std::iter::once(triangle).chain(copies)
        };
        let meets_all = ray.filter().meets_all_of(here);
        if meets_all && is_certain && ray.limits.begin_before(low) {
            return self.query.visit_one(l, ray, (leaf, lane), (low, high), is_certain);
        }
        if !meets_all {
            for triangle in here() {
                if let Some(crossing) = ray.intersect_filtered(l, Self::EDGES, triangle) {
                    self.query.see(l, ray, crossing);
                }
            }
            return;
        }
        // Copies have the same corners in the same order: the first answers for all.
        let mut triangles = here();
        let first = triangles.next();
        let crossing = first.and_then(|first| ray.intersect_filtered(l, Self::EDGES, first));
        let Some(crossing) = crossing else {
            return;
        };
        self.query.see(l, ray, crossing);
        if Self::EDGES == EdgeRule::Once {
            for copy in triangles {
                let primitive = copy.cast_signed();
                let copied = Crossing { primitive, ..crossing };
                self.query.see(l, ray, copied);
            }
        }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, crossing: Crossing) {
        self.query.see(l, ray, crossing);
    }

    #[inline(always)]
    fn deferred(&self) -> Option<u32> {
        self.query.deferred()
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, l: L, ray: &MeshRay<'_>) -> Self::Found {
        self.query.finish(l, ray)
    }

    #[inline(always)]
    fn of_crossing(crossing: Option<Crossing>) -> Self::Found {
        Q::of_crossing(crossing)
    }
}

impl<Q: MeshQuery> Visitor for FilteredQuery<Q> {
    const ORDERED: bool = Q::ORDERED;

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        let mut left = candidates.possible;
        if ray.filter().meets_everything() {
            let ahead = l.lt(l.splat(ray.limits.t_min_high), candidates.low);
            let settled = left & candidates.certain & ahead;
            left &= !settled;
            let settled = Candidates { possible: settled, ..*candidates };
            self.query.visit(l, ray, leaf, &settled);
        }
        if left == 0 || self.query.limit() < 0.0 {
            return;
        }
        visit_each(l, self, ray, (leaf, left), candidates);
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.query.limit()
    }
}
