//! Rays whose triangle is known, intersected eight at a time.
//!
//! 1. A first hit mostly ends with a triangle that is certain to be met, of which only `t` and the
//!    weights are missing. Gather such rays, of any packets.
//! 2. When there are eight and one more comes, or none is left to come, compute all in lanes
//!    ([`EightPairs`]). Until then the last one has reached memory: lanes that are loaded right
//!    after a part of them is stored would wait for it.
//! 3. Compute the few that need more than float64 one by one.

use std::marker::PhantomData;

use super::mesh_packet::{MeshPacket, MeshRay};
use super::query::{MeshQuery, Sink};
use crate::accel::eight_pairs::EightPairs;
use crate::accel::rays::packet::RAYS;
use crate::shape::triangle::TriangleHit;
use crate::simd::{Kernel, Lanes, WIDE, set_bits};

/// The number of its packet, the ray, and its triangle: a leaf and a lane of it in one number.
type Entry<'a> = (usize, MeshRay<'a>, u32);

/// Up to eight rays that wait.
pub(super) struct Deferred<'a> {
    count: usize,
    entries: [Option<Entry<'a>>; WIDE],
    pairs: EightPairs,
}

impl<'a> Deferred<'a> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { count: 0, entries: [None; WIDE], pairs: EightPairs::NONE }
    }

    /// Puts the answer of a ray into `sink`, now or with the rays that wait.
    #[inline(always)]
    pub(super) fn finish<L: Lanes, Q: MeshQuery>(
        &mut self,
        l: L,
        (packet, ray): (usize, MeshRay<'a>),
        query: &Q,
        sink: &mut (impl Sink<Q::Found> + ?Sized),
    ) {
        let Some(leaf_lane) = query.deferred() else {
            sink.put(packet, ray.lane, query.finish(l, &ray));
            return;
        };
        if self.count == WIDE {
            self.finish_all::<L, Q>(l, sink);
        }
        let lane = self.count % WIDE;
        let in_mesh = ray.packet.ray(ray.lane);
        self.pairs.put(lane, &in_mesh, (ray.tree, ray.mesh), leaf_lane);
        self.entries[lane] = Some((packet, ray, leaf_lane));
        self.count += 1;
    }

    /// Puts the answers of all rays that wait into `sink`.
    #[inline(always)]
    pub(super) fn finish_all<L: Lanes, Q: MeshQuery>(
        &mut self,
        l: L,
        sink: &mut (impl Sink<Q::Found> + ?Sized),
    ) {
        if self.count != 0 {
            l.call(FinishAll::<Q, _>(self, sink, PhantomData));
        }
    }

    /// Puts the answers of `rays` into `sink` and closes these rays: of all of them if the
    /// traversal is `complete`, else of those whose query has ended.
    #[inline(always)]
    pub(super) fn finish_packet<L: Lanes, Q: MeshQuery>(
        &mut self,
        l: L,
        (number, packet): (usize, &mut MeshPacket<'a>),
        (rays, complete): (u16, bool),
        queries: &[Q; RAYS],
        sink: &mut (impl Sink<Q::Found> + ?Sized),
    ) {
        for lane in set_bits(rays) {
            let query = &queries[lane];
            if complete || query.limit() < 0.0 {
                self.finish(l, (number, packet.ray(lane)), query, sink);
                packet.open &= !(1 << lane);
            }
        }
    }
}

/// Steps 2 and 3: a function of its own, as it is called for eight rays at a time.
struct FinishAll<'r, 'a, Q, S: ?Sized>(&'r mut Deferred<'a>, &'r mut S, PhantomData<Q>);

impl<Q: MeshQuery, S: Sink<Q::Found> + ?Sized> Kernel for FinishAll<'_, '_, Q, S> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self(deferred, sink, _) = self;
        let located = deferred.pairs.locate(l, deferred.count);
        for lane in 0..deferred.count {
            let Some((packet, ray, leaf_lane)) = deferred.entries[lane] else {
                continue;
            };
            let crossing = if (located.sound & located.held) >> lane & 1 == 1 {
                let hit = TriangleHit::new(located.at(lane));
                Some(hit.crossing(ray.tree.triangle_at(leaf_lane).cast_signed()))
            } else {
                ray.locate(l, leaf_lane)
            };
            sink.put(packet, ray.lane, Q::of_crossing(crossing));
        }
        deferred.count = 0;
    }
}
