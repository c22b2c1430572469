//! Rays whose triangle is known, intersected eight at a time.
//!
//! 1. A first hit mostly ends with a triangle that is certain to be met, of which only `t` and the weights are missing.
//!    Gather such rays, of any packets.
//! 2. When there are eight, or none is left to come, compute all in lanes ([`locate8_at`]).
//! 3. Compute the few that need more than float64 one by one.

use super::mesh_packet::{MeshPacket, MeshRay};
use super::query::{MeshQuery, Sink};
use crate::accel::locate8::{RayBundle, locate8_at};
use crate::accel::rays::packet::RAYS;
use crate::simd::{Aligned, Lanes, WIDE, set_bits};

/// The number of its packet, the ray, and its triangle: a leaf and a lane of it.
type Entry<'a> = (usize, MeshRay<'a>, (u32, usize));

/// Up to eight rays that wait.
pub(super) struct Deferred<'a> {
    count: usize,
    entries: [Option<Entry<'a>>; WIDE],
    /// Origins, directions and the corners a, b, c; three axes each.
    numbers: Aligned<[[f64; WIDE]; 15]>,
}

impl<'a> Deferred<'a> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            entries: [None; WIDE],
            numbers: Aligned([[0.0; WIDE]; 15]),
        }
    }

    /// Puts the answer of a ray into `sink`, now or with the rays that wait.
    #[inline(always)]
    pub(super) fn finish<L: Lanes, Q: MeshQuery>(
        &mut self,
        l: L,
        (packet, ray): (usize, MeshRay<'a>),
        query: &Q,
        sink: &mut impl Sink<Q::Found>,
    ) {
        let Some((leaf, triangle)) = query.deferred() else {
            sink.put(packet, ray.lane, query.finish(l, &ray));
            return;
        };
        let lane = self.count % WIDE;
        let [a, b, c] = ray.corners(leaf, triangle);
        let world = ray.packet.ray(ray.lane);
        let vectors = [world.origin, world.direction, a, b, c];
        for (k, vector) in vectors.into_iter().enumerate() {
            for axis in 0..3 {
                self.numbers.0[3 * k + axis][lane] = vector[axis];
            }
        }
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
        sink: &mut impl Sink<Q::Found>,
    ) {
        if self.count == 0 {
            return;
        }
        let number = |k: usize| l.load64(&self.numbers.0[k]);
        let rays = RayBundle {
            origin: [number(0), number(1), number(2)],
            direction: [number(3), number(4), number(5)],
        };
        let corners = [
            [number(6), number(7), number(8)],
            [number(9), number(10), number(11)],
            [number(12), number(13), number(14)],
        ];
        #[expect(clippy::cast_possible_truncation, reason = "eight bits")]
        let wanted = ((1_u32 << self.count) - 1) as u8;
        let (sound, crossings) = locate8_at(l, &rays, &corners, wanted);
        let mut out = Aligned([[0.0; WIDE]; 3]);
        for (numbers, out) in crossings.into_iter().zip(&mut out.0) {
            l.store64(numbers, out);
        }
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
    sink: &mut impl Sink<Q::Found>,
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
