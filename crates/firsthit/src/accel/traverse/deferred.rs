//! Rays whose triangle is known, intersected eight at a time.
//!
//! 1. A first hit mostly ends with a triangle that is certain to be met, of which only `t` and the weights are missing.
//!    Gather such rays, of any packets.
//! 2. When there are eight, or none is left to come, compute all in lanes ([`EightPairs`]).
//! 3. Compute the few that need more than float64 one by one.

use super::mesh_packet::{MeshPacket, MeshRay};
use super::query::{MeshQuery, Sink};
use crate::accel::locate8::EightPairs;
use crate::accel::rays::packet::RAYS;
use crate::simd::{Lanes, WIDE, set_bits};

/// The number of its packet, the ray, and its triangle: a leaf and a lane of it.
type Entry<'a> = (usize, MeshRay<'a>, (u32, usize));

/// Up to eight rays that wait.
pub(super) struct Deferred<'a> {
    count: usize,
    entries: [Option<Entry<'a>>; WIDE],
    pairs: EightPairs,
}

impl<'a> Deferred<'a> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            entries: [None; WIDE],
            pairs: EightPairs::NONE,
        }
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
        let Some((leaf, triangle)) = query.deferred() else {
            sink.put(packet, ray.lane, query.finish(l, &ray));
            return;
        };
        let lane = self.count % WIDE;
        let corners = ray.corners(leaf, triangle);
        self.pairs.put(lane, &ray.packet.ray(ray.lane), corners);
        self.entries[lane] = Some((packet, ray, (leaf, triangle)));
        self.count += 1;
        if self.count == WIDE {
            self.finish_all::<L, Q>(l, sink);
        }
    }

    /// Puts the answers of all rays that wait into `sink`.
    #[inline(always)]
    pub(super) fn finish_all<L: Lanes, Q: MeshQuery>(
        &mut self,
        l: L,
        sink: &mut (impl Sink<Q::Found> + ?Sized),
    ) {
        if self.count == 0 {
            return;
        }
        let (sound, out) = self.pairs.locate(l, self.count);
        for lane in 0..self.count {
            let Some((packet, ray, (leaf, triangle))) = self.entries[lane] else {
                continue;
            };
            let crossing = if sound >> lane & 1 == 1 {
                let [t, v, w] = [out.0[0][lane], out.0[1][lane], out.0[2][lane]];
                ray.crossing_at(leaf, triangle, [t, v, w])
            } else {
                ray.locate(l, leaf, triangle)
            };
            sink.put(packet, ray.lane, Q::of_crossing(crossing));
        }
        self.count = 0;
    }
}

/// Puts the answers of `rays` into `sink` and closes these rays: of all of them if the traversal is `complete`, else of
/// those whose query has ended.
#[inline(always)]
pub(super) fn finish_packet<L: Lanes, Q: MeshQuery>(
    l: L,
    (number, packet): (usize, &mut MeshPacket<'_>),
    (rays, complete): (u16, bool),
    queries: &[Q; RAYS],
    sink: &mut (impl Sink<Q::Found> + ?Sized),
) {
    let mut deferred = Deferred::new();
    for lane in set_bits(rays) {
        let query = &queries[lane];
        if complete || query.limit() < 0.0 {
            deferred.finish(l, (number, packet.ray(lane)), query, sink);
            packet.open &= !(1 << lane);
        }
    }
    deferred.finish_all::<L, Q>(l, sink);
}
