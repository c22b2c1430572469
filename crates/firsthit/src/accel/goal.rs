//! What a traversal is for: the first hit, any hit, or all candidates.
//!
//! What is met for certain at a depth that no other candidate can have is not computed before the end.

use super::filter::Candidates;
use super::mesh_tree::MeshTree;
use super::meshlet::Meshlet;
use super::packet::{Limits, Packet};
use crate::geometry::{DVec3, Ray};
use crate::shape::triangle::{self, Doubtful, Shear, TriangleHit};
use crate::shape::{Crossing, Mesh};
use crate::simd::{Aligned, Kernel, LANES, Lanes};

/// What to do with a leaf's candidates.
pub(crate) trait Goal {
    /// Whether it matters which candidates come first.
    const ORDERED: bool = true;
    /// Takes note of them.
    fn meet<L: Lanes>(&mut self, l: L, place: &Place<'_>, leaf: u32, candidates: &Candidates<L>);
    /// The depth beyond which nothing matters any more; negative to end.
    fn limit(&self) -> f32;
}

/// A goal with an answer.
pub(crate) trait Question: Goal {
    /// What comes out.
    type Answer: Copy;
    /// The answer where nothing is met.
    const NOTHING: Self::Answer;
    /// Before the first leaf; with the ray's limits, see [`Packet::limits`].
    fn new(limits: Limits) -> Self;
    /// Takes note of a single candidate, the triangle in a lane of a leaf, between two depths.
    fn meet_one<L: Lanes>(
        &mut self,
        l: L,
        place: &Place<'_>,
        triangle: (u32, usize),
        depths: (f32, f32),
        is_certain: bool,
    );
    /// The triangle that is met for certain, of which nobody has asked yet where; a lane of a leaf.
    fn pending(&self) -> Option<(u32, usize)>;
    /// After the last one.
    fn answer<L: Lanes>(&self, l: L, place: &Place<'_>) -> Self::Answer;
    /// Without a tree.
    fn from_crossing(crossing: Option<Crossing>) -> Self::Answer;
}

/// What a traversal works with: a ray of a packet, and a mesh with its tree.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub(super) tree: &'a MeshTree,
    pub(super) mesh: &'a Mesh,
    pub(super) packet: &'a Packet,
    pub(super) lane: usize,
}

impl Place<'_> {
    /// The judge's word about a triangle.
    #[inline(always)]
    fn decide<L: Lanes>(&self, l: L, leaf: &Meshlet, lane: usize) -> Option<TriangleHit> {
        let corners = self.tree.corners(self.mesh, leaf, lane);
        let ray = self.packet.ray(self.lane);
        let hit = Shear::new(&ray).intersect_by(corners, |doubtful| l.call(Settling(doubtful)))?;
        ray.holds(hit.t).then_some(hit)
    }

    /// The corners of the triangle in a lane of a leaf.
    #[inline(always)]
    pub(super) fn corners(&self, leaf: u32, lane: usize) -> [DVec3; 3] {
        let leaf = &self.tree.leaves[leaf as usize];
        self.tree.corners(self.mesh, leaf, lane)
    }

    /// The crossing with a triangle that the ray meets for certain.
    #[inline(always)]
    pub(super) fn locate<L: Lanes>(&self, l: L, leaf: u32, lane: usize) -> Option<Crossing> {
        let corners = self.corners(leaf, lane);
        let ray = self.packet.ray(self.lane);
        let hit = triangle::locate(&ray, corners, |doubtful| l.call(Settling(doubtful)))?;
        let leaf = &self.tree.leaves[leaf as usize];
        ray.holds(hit.t).then(|| self.crossing(leaf, lane, hit))
    }

    /// The same, if it is known where it is.
    #[inline(always)]
    pub(super) fn crossing_at(&self, leaf: u32, lane: usize, place: [f64; 3]) -> Option<Crossing> {
        let hit = TriangleHit::new(place);
        let leaf = &self.tree.leaves[leaf as usize];
        let ray = self.packet.ray(self.lane);
        ray.holds(hit.t).then(|| self.crossing(leaf, lane, hit))
    }

    /// Whether `new` is the first of the two.
    #[inline(always)]
    fn precedes<L: Lanes>(&self, l: L, new: &Crossing, old: &Crossing) -> bool {
        if triangle::are_close(new.t, old.t) {
            let ray = self.packet.ray(self.lane);
            let nearest = |crossing| l.call(Nearest(self.mesh, &ray, crossing));
            (nearest(new), new.primitive) < (nearest(old), old.primitive)
        } else {
            new.t < old.t
        }
    }

    #[inline(always)]
    fn crossing(&self, leaf: &Meshlet, lane: usize, hit: TriangleHit) -> Crossing {
        hit.crossing(self.tree.triangle(leaf, lane).cast_signed())
    }
}

/// What exact arithmetic says of a triangle, in a function of its own, which is rarely called.
pub(crate) struct Settling(pub(crate) Doubtful);

impl Kernel for Settling {
    type Output = Option<TriangleHit>;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Self::Output {
        self.0.settle_in_place()
    }
}

/// The float64 nearest to the exact `t` of a crossing.
pub(crate) struct Nearest<'a>(
    pub(crate) &'a Mesh,
    pub(crate) &'a Ray,
    pub(crate) &'a Crossing,
);

impl Kernel for Nearest<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> f64 {
        self.0.nearest_t(self.1, self.2)
    }
}

/// The first hit so far.
enum Best {
    None,
    /// Met for certain, between two depths; float64 has yet to say where.
    Pending {
        leaf: u32,
        lane: usize,
        low: f32,
        high: f32,
    },
    Decided {
        crossing: Crossing,
        low: f32,
        high: f32,
    },
}

impl Best {
    #[inline(always)]
    fn decided<L: Lanes>(&self, l: L, place: &Place<'_>) -> Option<Crossing> {
        match *self {
            Self::None => None,
            Self::Decided { crossing, .. } => Some(crossing),
            Self::Pending { leaf, lane, .. } => place.locate(l, leaf, lane),
        }
    }
}

pub(crate) struct First {
    best: Best,
    limit: f32,
    limits: Limits,
}

impl First {
    /// Lets float64 decide between the best so far and a candidate.
    #[inline(always)]
    fn compare<L: Lanes>(&mut self, l: L, place: &Place<'_>, leaf: u32, lane: usize) {
        let leaf = &place.tree.leaves[leaf as usize];
        let Some(hit) = place.decide(l, leaf, lane) else {
            return;
        };
        let new = place.crossing(leaf, lane, hit);
        let old = self.best.decided(l, place);
        let crossing = match old {
            Some(old) if !place.precedes(l, &new, &old) => old,
            _ => new,
        };
        let low = place.packet.depth_below(place.lane, crossing.t);
        let high = place.packet.depth_above(place.lane, crossing.t);
        self.best = Best::Decided {
            crossing,
            low,
            high,
        };
        self.limit = self.limit.min(high);
    }
}

impl Question for First {
    type Answer = Option<Crossing>;
    const NOTHING: Self::Answer = None;

    #[inline(always)]
    fn new(limits: Limits) -> Self {
        Self {
            best: Best::None,
            limit: limits.last,
            limits,
        }
    }

    #[inline(always)]
    fn meet_one<L: Lanes>(
        &mut self,
        l: L,
        place: &Place<'_>,
        (leaf, lane): (u32, usize),
        (low, high): (f32, f32),
        is_certain: bool,
    ) {
        let (best_low, best_high) = match self.best {
            Best::None => (self.limits.within, f32::INFINITY),
            Best::Pending { low, high, .. } | Best::Decided { low, high, .. } => (low, high),
        };
        if low > best_high || high < self.limits.before {
            return;
        }
        if is_certain && low > self.limits.beyond && high < best_low {
            self.best = Best::Pending {
                leaf,
                lane,
                low,
                high,
            };
            self.limit = self.limit.min(high);
        } else {
            self.compare(l, place, leaf, lane);
        }
    }

    #[inline(always)]
    fn pending(&self) -> Option<(u32, usize)> {
        match self.best {
            Best::Pending { leaf, lane, .. } => Some((leaf, lane)),
            _ => None,
        }
    }

    #[inline(always)]
    fn answer<L: Lanes>(&self, l: L, place: &Place<'_>) -> Self::Answer {
        self.best.decided(l, place)
    }

    #[inline(always)]
    fn from_crossing(crossing: Option<Crossing>) -> Self::Answer {
        crossing
    }
}

impl Goal for First {
    #[inline(always)]
    fn meet<L: Lanes>(&mut self, l: L, place: &Place<'_>, leaf: u32, candidates: &Candidates<L>) {
        let mut lows = Aligned([0.0; LANES]);
        let mut highs = lows;
        l.store(candidates.low, &mut lows.0);
        l.store(candidates.high, &mut highs.0);
        let mut possible = candidates.possible;
        let first = place.tree.leaves[leaf as usize].first as usize;
        while possible != 0 {
            let lane = possible.trailing_zeros() as usize % LANES;
            possible &= possible - 1;
            // Who wins is asked for its index in the end.
            if let Some(index) = place.tree.order.get(first + lane) {
                l.prefetch(index);
            }
            let is_certain = candidates.certain >> lane & 1 == 1;
            self.meet_one(
                l,
                place,
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

pub(crate) struct Any {
    is_found: bool,
    limit: f32,
    limits: Limits,
}

impl Question for Any {
    type Answer = bool;
    const NOTHING: Self::Answer = false;

    #[inline(always)]
    fn new(limits: Limits) -> Self {
        Self {
            is_found: false,
            limit: limits.last,
            limits,
        }
    }

    #[inline(always)]
    fn meet_one<L: Lanes>(
        &mut self,
        l: L,
        place: &Place<'_>,
        (leaf, lane): (u32, usize),
        (low, high): (f32, f32),
        is_certain: bool,
    ) {
        if high < self.limits.before {
            return;
        }
        let leaf = &place.tree.leaves[leaf as usize];
        let is_inside = is_certain && low > self.limits.beyond && high < self.limits.within;
        if is_inside || place.decide(l, leaf, lane).is_some() {
            self.is_found = true;
            self.limit = -1.0;
        }
    }

    #[inline(always)]
    fn pending(&self) -> Option<(u32, usize)> {
        None
    }

    #[inline(always)]
    fn answer<L: Lanes>(&self, _: L, _: &Place<'_>) -> Self::Answer {
        self.is_found
    }

    #[inline(always)]
    fn from_crossing(crossing: Option<Crossing>) -> Self::Answer {
        crossing.is_some()
    }
}

impl Goal for Any {
    const ORDERED: bool = false;

    #[inline(always)]
    fn meet<L: Lanes>(&mut self, l: L, place: &Place<'_>, leaf: u32, candidates: &Candidates<L>) {
        let inside = l.lt(l.splat(self.limits.beyond), candidates.low)
            & l.lt(candidates.high, l.splat(self.limits.within));
        let leaf = &place.tree.leaves[leaf as usize];
        let mut possible = candidates.possible & l.le(l.splat(self.limits.before), candidates.high);
        debug_assert!(!self.is_found, "an answer is never taken back");
        // Where it is met for certain, nobody wants to know the place.
        self.is_found = possible & candidates.certain & inside != 0;
        while possible != 0 && !self.is_found {
            let lane = possible.trailing_zeros() as usize;
            possible &= possible - 1;
            self.is_found = place.decide(l, leaf, lane).is_some();
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

/// Every candidate, for whoever visits.
pub(super) struct Each<V> {
    pub(super) visit: V,
    pub(super) t_max: f64,
    pub(super) limit: f32,
}

impl<V: FnMut(u32, f64) -> f64> Goal for Each<V> {
    #[inline(always)]
    fn meet<L: Lanes>(&mut self, _: L, place: &Place<'_>, leaf: u32, candidates: &Candidates<L>) {
        let leaf = &place.tree.leaves[leaf as usize];
        let mut possible = candidates.possible;
        while possible != 0 {
            let lane = possible.trailing_zeros() as usize;
            possible &= possible - 1;
            self.t_max = (self.visit)(place.tree.triangle(leaf, lane), self.t_max);
            if self.t_max < 0.0 {
                self.limit = -1.0;
                return;
            }
            self.limit = place.packet.depth_above(place.lane, self.t_max);
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}
