//! The first hit: the smallest `t`, and at the same `t` the lowest triangle.
//!
//! 1. Drop a candidate that is beyond the best so far, by its depths.
//! 2. A candidate that is certain to be met, and certainly nearer than the best so far, becomes the best. Where it is
//!    met is computed only if it is still the best when the traversal ends.
//! 3. For any other candidate the exact test decides, and compares it with the best so far; unless it is known to lie in the plane
//!    of that (`shape/mesh/planes.rs`), and then the lower one is the first.

use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor};
use crate::accel::filter::Candidates;
use crate::shape::Crossing;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// The nearest triangle so far.
#[derive(Clone, Copy)]
enum Best {
    None,
    /// Certain to be met, between two depths; where is not computed yet.
    Deferred {
        leaf: u32,
        lane: usize,
        low: f32,
        high: f32,
    },
    /// Met, between two depths.
    Located {
        crossing: Crossing,
        low: f32,
        high: f32,
    },
}

impl Best {
    #[inline(always)]
    fn triangle(&self, ray: &MeshRay<'_>) -> Option<u32> {
        match *self {
            Self::None => None,
            Self::Located { crossing, .. } => Some(crossing.primitive.cast_unsigned()),
            Self::Deferred { leaf, lane, .. } => {
                Some(ray.tree.triangle(&ray.tree.leaves[leaf as usize], lane))
            }
        }
    }

    #[inline(always)]
    fn located<L: Lanes>(&self, l: L, ray: &MeshRay<'_>) -> Option<Crossing> {
        match *self {
            Self::None => None,
            Self::Located { crossing, .. } => Some(crossing),
            Self::Deferred { leaf, lane, .. } => ray.locate(l, leaf, lane),
        }
    }
}

/// The state of a first-hit query: see [the module](self).
#[derive(Clone, Copy)]
pub(crate) struct First {
    best: Best,
    limit: f32,
}

impl First {
    /// Compares a candidate with the best so far by the exact test.
    #[inline(always)]
    fn compare<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, lane: usize) {
        let leaf = &ray.tree.leaves[leaf as usize];
        if let Some(best) = self.best.triangle(ray)
            && ray.is_known_to_follow(ray.tree.triangle(leaf, lane), best)
        {
            return;
        }
        if let Some(new) = ray.intersect(l, Self::EDGES, leaf, lane) {
            self.see(l, ray, new);
        }
    }
}

impl MeshQuery for First {
    type Found = Option<Crossing>;
    const IN_PACKETS_FILTERED: bool = true;
    const NONE: Self::Found = None;

    #[inline(always)]
    fn new(limit: f32) -> Self {
        Self {
            best: Best::None,
            limit,
        }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, new: Crossing) {
        let old = self.best.located(l, ray);
        let crossing = match old {
            Some(old) if !ray.precedes(l, &new, &old) => old,
            _ => new,
        };
        let low = ray.packet.depth_below(ray.lane, crossing.t);
        let high = ray.packet.depth_above(ray.lane, crossing.t);
        self.best = Best::Located {
            crossing,
            low,
            high,
        };
        self.limit = self.limit.min(high);
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
        let (best_low, best_high) = match self.best {
            Best::None => (limits.t_max_low, f32::INFINITY),
            Best::Deferred { low, high, .. } | Best::Located { low, high, .. } => (low, high),
        };
        if low > best_high || limits.begin_after(high) {
            return;
        }
        if is_certain && limits.begin_before(low) && high < best_low {
            self.best = Best::Deferred {
                leaf,
                lane,
                low,
                high,
            };
            self.limit = self.limit.min(high);
        } else {
            self.compare(l, ray, leaf, lane);
        }
    }

    #[inline(always)]
    fn deferred(&self) -> Option<(u32, usize)> {
        match self.best {
            Best::Deferred { leaf, lane, .. } => Some((leaf, lane)),
            _ => None,
        }
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, l: L, ray: &MeshRay<'_>) -> Self::Found {
        self.best.located(l, ray)
    }

    #[inline(always)]
    fn of_crossing(crossing: Option<Crossing>) -> Self::Found {
        crossing
    }
}

impl Visitor for First {
    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        let mut lows = Aligned([0.0; LANES]);
        let mut highs = lows;
        l.store(candidates.low, &mut lows.0);
        l.store(candidates.high, &mut highs.0);
        let first = ray.tree.leaves[leaf as usize].first as usize;
        for lane in set_bits(candidates.possible) {
            // The answer needs the triangle's index in the mesh.
            if let Some(index) = ray.tree.order.get(first + lane) {
                l.prefetch(index);
            }
            let is_certain = candidates.certain >> lane & 1 == 1;
            self.visit_one(
                l,
                ray,
                (leaf, lane),
                (lows.0[lane], highs.0[lane]),
                is_certain,
            );
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}
