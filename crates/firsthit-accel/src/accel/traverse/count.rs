//! The count: how many triangles does a ray cross?
//!
//! 1. Drop a candidate that is before `t_min`, by its depths.
//! 2. Count a candidate that is certain to be met, and certainly between `t_min` and `t_max`.
//! 3. For any other candidate the exact test decides. At an edge it counts one neighbour
//!    (`triangle/crossed.rs`).
//!
//! A triangle counts once for itself and once for each copy in its place, which the tree leaves
//! out.

use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor, visit_each};
use crate::accel::filter::Candidates;
use crate::shape::Crossing;
use crate::shape::triangle::EdgeRule;
use crate::simd::Lanes;

/// The state of a counting query: see [the module](self).
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct Count {
    count: u32,
    limit: f32,
}

impl MeshQuery for Count {
    type Found = u32;
    const EDGES: EdgeRule = EdgeRule::Once;
    const NONE: u32 = 0;

    #[inline(always)]
    fn new(limit: f32) -> Self {
        Self { count: 0, limit }
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
        if ray.limits.begin_after(high) {
            return;
        }
        let leaf = &ray.tree.leaves[leaf as usize];
        let is_inside = is_certain && ray.limits.hold(low, high);
        if is_inside || ray.intersect(l, Self::EDGES, leaf, lane).is_some() {
            let copies = ray.tree.copies_of(ray.tree.triangle(leaf, lane)).len();
            let times = u32::try_from(1 + copies).unwrap_or(u32::MAX);
            self.count = self.count.saturating_add(times);
        }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, _: L, _: &MeshRay<'_>, _: Crossing) {
        self.count = self.count.saturating_add(1);
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: L, _: &MeshRay<'_>) -> u32 {
        self.count
    }

    #[inline(always)]
    fn of_crossing(crossing: Option<Crossing>) -> u32 {
        u32::from(crossing.is_some())
    }
}

impl Visitor for Count {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        visit_each(l, self, ray, (leaf, candidates.possible), candidates);
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}
