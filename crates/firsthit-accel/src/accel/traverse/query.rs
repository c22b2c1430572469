//! The queries that a traversal of one mesh answers, and the sink for the answers.
//!
//! A traversal finds leaves; [`filter`](crate::accel::filter) says which triangles of a leaf a ray
//! may meet, and between which depths. A [`Visitor`] sees these candidates and narrows the ray. A
//! [`MeshQuery`] is a visitor with an answer: a file each for the first hit, any hit, the count and
//! all crossings.

use super::mesh_packet::MeshRay;
use crate::accel::filter::Candidates;
use crate::accel::rays::packet::RAYS;
use crate::geometry::arrays;
use crate::shape::Crossing;
use crate::shape::triangle::EdgeRule;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// Sees the candidates of one ray.
#[doc(hidden)]
pub trait Visitor {
    /// Whether near leaves should come first.
    const ORDERED: bool = true;
    /// Sees the candidates of a leaf.
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>);
    /// The depth beyond which no candidate matters; negative to end the traversal.
    fn limit(&self) -> f32;
}

/// A query of one ray and one mesh: its state on the way, and its answer in the end.
#[doc(hidden)]
pub trait MeshQuery: Visitor + Copy {
    /// The answer.
    type Found: Copy;
    /// Whether a ray at an edge meets one neighbour or both.
    const EDGES: EdgeRule = EdgeRule::Closed;
    /// Whether traversals of packets serve it; see `dispatch.rs`.
    const IN_PACKETS: bool = true;
    /// Whether traversals of packets serve it for rays with filters: those are compiled a second
    /// time.
    const IN_PACKETS_FILTERED: bool = false;
    /// The answer of a ray that meets nothing.
    const NONE: Self::Found;
    /// The query before the first leaf, for a ray that ends at a depth of at most `limit`. A packet
    /// makes sixteen at once, so a query is small: the ray's other bounds are in
    /// [`MeshRay::limits`].
    fn new(limit: f32) -> Self;
    /// Sees a single candidate: the triangle in a lane of a leaf, which is met between two depths,
    /// if at all; for sure if `is_certain`.
    fn visit_one<L: Lanes>(
        &mut self,
        l: L,
        ray: &MeshRay<'_>,
        triangle: (u32, usize),
        depths: (f32, f32),
        is_certain: bool,
    );
    /// Sees a crossing that the exact test has found.
    fn see<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, crossing: Crossing);
    /// The triangle that is the answer, as a leaf and a lane of it in one number, if where it is
    /// met is not computed yet.
    #[inline(always)]
    fn deferred(&self) -> Option<u32> {
        None
    }
    /// The answer, after the last leaf.
    fn finish<L: Lanes>(&self, l: L, ray: &MeshRay<'_>) -> Self::Found;
    /// The answer of a ray that meets one thing at most.
    fn of_crossing(crossing: Option<Crossing>) -> Self::Found;
}

/// Shows a query some candidates of a leaf, one by one, until it has ended.
#[inline(always)]
pub(super) fn visit_each<L: Lanes, Q: MeshQuery>(
    l: L,
    query: &mut Q,
    ray: &MeshRay<'_>,
    (leaf, triangles): (u32, u16),
    candidates: &Candidates<L>,
) {
    let mut lows = Aligned([0.0; LANES]);
    let mut highs = lows;
    l.store(candidates.low, &mut lows.0);
    l.store(candidates.high, &mut highs.0);
    for lane in set_bits(triangles) {
        let is_certain = candidates.certain >> lane & 1 == 1;
        let depths = (lows.0[lane], highs.0[lane]);
        query.visit_one(l, ray, (leaf, lane), depths, is_certain);
        if query.limit() < 0.0 {
            return;
        }
    }
}

/// The queries of a packet's rays, which end at depths of at most `limits`.
#[inline(always)]
pub(super) fn queries<Q: MeshQuery>(limits: &[f32; RAYS]) -> [Q; RAYS] {
    arrays::from_fn(|lane| Q::new(limits[lane]))
}

/// Takes the answers of packets of rays.
#[doc(hidden)]
pub trait Sink<Found> {
    /// Takes the answer of the ray in a lane of a packet, by the packet's number.
    fn put(&mut self, packet: usize, lane: usize, found: Found);
}
