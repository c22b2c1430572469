//! The first hit: the smallest `t`, and at the same `t` the lowest triangle.
//!
//! 1. Of a leaf's candidates that are certain to be met, and certainly nearer than the best so far,
//!    find the nearest. Where no other begins before it ends, it becomes the best. Where it is met
//!    is computed only if it is still the best when the traversal ends.
//! 2. Otherwise look at the candidates one by one. Drop one that is beyond the best so far, by its
//!    depths.
//! 3. One that is certain to be met, and certainly nearer than the best so far, becomes the best,
//!    as in step 1.
//! 4. For any other the exact test decides, and compares it with the best so far; unless it is
//!    known to come after that: in its plane the lower one is the first (`shape/mesh/planes.rs`),
//!    and nearly there heights tell (`shape/mesh/crowds.rs`).
//!
//! Most leaves need step 1 alone. The others are functions of their own, so that they take no
//! registers from the traversal.

use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor};
use crate::accel::filter::Candidates;
use crate::accel::meshlet::{MOST_LEAVES, leaf_lane};
use crate::geometry::DVec2;
use crate::shape::Crossing;
use crate::simd::{Aligned, Kernel, LANES, Lanes, set_bits};

/// The state of a first-hit query: see [the module](self).
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct First {
    /// The nearest triangle so far, a leaf and a lane of it in one number; [`NOTHING`], or
    /// [`LOCATED`].
    best: u32,
    /// Between which depths it is met.
    low: f32,
    high: f32,
    limit: f32,
    /// The crossing, once computed.
    crossing: Crossing,
}

/// Marks that no triangle is met so far. No triangle has this number or the next: see `meshlet.rs`.
const NOTHING: u32 = u32::MAX;
/// Marks that the crossing with the nearest triangle is computed.
const LOCATED: u32 = u32::MAX - 1;
const _: () = assert!(MOST_LEAVES * LANES <= LOCATED as usize);

impl First {
    /// The best triangle's index in the mesh.
    #[inline(always)]
    fn triangle(&self, ray: &MeshRay<'_>) -> Option<u32> {
        match self.best {
            NOTHING => None,
            LOCATED => Some(self.crossing.primitive.cast_unsigned()),
            leaf_lane => Some(ray.tree.triangle_at(leaf_lane)),
        }
    }

    #[inline(always)]
    fn located<L: Lanes>(&self, l: L, ray: &MeshRay<'_>) -> Option<Crossing> {
        match self.best {
            NOTHING => None,
            LOCATED => Some(self.crossing),
            leaf_lane => ray.locate(l, leaf_lane),
        }
    }

    /// A candidate that ends before this depth is certainly nearer than the best so far, and within
    /// `t_max`.
    #[inline(always)]
    fn certain_before(&self, ray: &MeshRay<'_>) -> f32 {
        let t_max = ray.limits.t_max_low;
        // A NaN makes nothing certain.
        if t_max > self.low { self.low } else { t_max }
    }

    /// Takes a triangle that is certain to be met, and nearer than the best so far.
    #[inline(always)]
    fn take(&mut self, leaf_lane: u32, low: f32, high: f32) {
        self.best = leaf_lane;
        self.low = low;
        self.high = high;
        self.limit = self.limit.min(high);
    }

    /// Compares a candidate with the best so far by the exact test.
    #[inline(always)]
    fn compare<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, lane: usize) {
        let leaf = &ray.tree.leaves[leaf as usize];
        if let Some(best) = self.triangle(ray)
            && ray.is_known_to_follow(l, ray.tree.triangle(leaf, lane), best)
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
        let crossing = Crossing { t: 0.0, primitive: 0, barycentric: DVec2::ZERO };
        Self { best: NOTHING, low: f32::INFINITY, high: f32::INFINITY, limit, crossing }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, new: Crossing) {
        let old = self.located(l, ray);
        let crossing = match old {
            Some(old) if !ray.precedes(l, &new, &old) => old,
            _ => new,
        };
        self.best = LOCATED;
        self.crossing = crossing;
        self.low = ray.packet.depth_below(ray.lane, crossing.t);
        self.high = ray.packet.depth_above(ray.lane, crossing.t);
        self.limit = self.limit.min(self.high);
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
        if low > self.high || limits.begin_after(high) {
            return;
        }
        if is_certain && limits.begin_before(low) && high < self.certain_before(ray) {
            self.take(leaf_lane(leaf, lane), low, high);
        } else {
            l.call(Compared { query: self, ray, triangle: (leaf, lane) });
        }
    }

    #[inline(always)]
    fn deferred(&self) -> Option<u32> {
        (self.best < LOCATED).then_some(self.best)
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, l: L, ray: &MeshRay<'_>) -> Self::Found {
        self.located(l, ray)
    }

    #[inline(always)]
    fn of_crossing(crossing: Option<Crossing>) -> Self::Found {
        crossing
    }
}

impl Visitor for First {
    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        let Candidates { low, high, .. } = *candidates;
        let limits = &ray.limits;
        let possible = candidates.possible & l.le(l.splat(limits.t_min_low), high);
        let sure = possible
            & candidates.certain
            & l.lt(l.splat(limits.t_min_high), low)
            & l.lt(high, l.splat(self.certain_before(ray)));
        let ends = l.smallest(l.select(sure, high, l.splat(f32::INFINITY)));
        let near = possible & l.le(low, l.splat(ends));
        let mut depths = [Aligned([0.0; LANES]); 2];
        l.store(low, &mut depths[0].0);
        let lane = near.trailing_zeros() as usize % LANES;
        let is_one = near & near.wrapping_sub(1) == 0;
        let is_taken = is_one && near & sure != 0;
        // By arithmetic: whether there is a hit is hard to predict.
        let taken = 0_u32.wrapping_sub(is_taken.into());
        // The answer needs the triangle's index in the mesh. Where none is taken, it is one that
        // the cache has.
        let first = ray.tree.leaves[leaf as usize].first;
        let place = chosen(taken, first.wrapping_add(near.trailing_zeros()), 0);
        if let Some(index) = ray.tree.order.get(place as usize) {
            l.prefetch(index);
        }
        self.best = chosen(taken, leaf_lane(leaf, lane), self.best);
        self.low = chosen_depth(taken, depths[0].0[lane], self.low);
        self.high = chosen_depth(taken, ends, self.high);
        self.limit = chosen_depth(taken, self.limit.min(ends), self.limit);
        if near != 0 && !is_taken {
            l.store(high, &mut depths[1].0);
            l.call(OneByOne {
                query: self,
                ray,
                leaf,
                candidates: [near, candidates.certain],
                depths: [&depths[0].0, &depths[1].0],
            });
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}

/// One of two numbers by a mask of all bits.
#[inline(always)]
fn chosen(mask: u32, if_set: u32, otherwise: u32) -> u32 {
    otherwise ^ ((otherwise ^ if_set) & mask)
}

#[inline(always)]
fn chosen_depth(mask: u32, if_set: f32, otherwise: f32) -> f32 {
    f32::from_bits(chosen(mask, if_set.to_bits(), otherwise.to_bits()))
}

/// Steps 2 to 4.
struct OneByOne<'a> {
    query: &'a mut First,
    ray: &'a MeshRay<'a>,
    leaf: u32,
    /// The candidates, and those that are certain.
    candidates: [u16; 2],
    depths: [&'a [f32; LANES]; 2],
}

impl Kernel for OneByOne<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let [near, certain] = self.candidates;
        let [lows, highs] = self.depths;
        for lane in set_bits(near) {
            let is_certain = certain >> lane & 1 == 1;
            let (triangle, depths) = ((self.leaf, lane), (lows[lane], highs[lane]));
            self.query.visit_one(l, self.ray, triangle, depths, is_certain);
        }
    }
}

/// Step 4.
struct Compared<'a> {
    query: &'a mut First,
    ray: &'a MeshRay<'a>,
    triangle: (u32, usize),
}

impl Kernel for Compared<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let (leaf, lane) = self.triangle;
        self.query.compare(l, self.ray, leaf, lane);
    }
}
