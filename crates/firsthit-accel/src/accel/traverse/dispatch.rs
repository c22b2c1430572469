//! Many rays through the trees of meshes: chooses a traversal for each packet.
//!
//! 1. Try [`coherent`], for rays that go nearly the same way. It gives up when they do not.
//! 2. If the query needs no order, try [`masked`], for short rays from a small place. It gives up
//!    likewise.
//! 3. Put all rays that are left, of all packets, through [`interleaved`].
//!
//! Where packet after packet gives up, some of the next are not tried. Packets whose rays are
//! [scattered](crate::accel::Packet::is_scattered) go to step 3 at once.

use super::coherent::coherent;
use super::deferred::Deferred;
use super::interleaved::{InFlight, interleaved};
use super::masked::masked;
use super::mesh_packet::MeshPacket;
use super::query::{MeshQuery, Sink};
use super::stack::Stack;
use crate::simd::Lanes;

/// Memory for traversals, to be used again.
#[derive(Debug)]
#[doc(hidden)]
pub struct TraversalMemory {
    stack: Stack,
    in_flight: InFlight,
}

impl Default for TraversalMemory {
    fn default() -> Self {
        Self { stack: Stack::new(), in_flight: InFlight::new() }
    }
}

/// Packets on their way: each is tried as soon as it is ready, while its rays are in the nearest
/// cache.
#[doc(hidden)]
pub struct Traversal<'d, 'a> {
    memory: &'d mut TraversalMemory,
    of_coherent: Trials,
    of_masked: Trials,
    deferred: Deferred<'a>,
}

impl<'d, 'a> Traversal<'d, 'a> {
    /// Begins with no packet.
    pub fn new(memory: &'d mut TraversalMemory) -> Self {
        let (of_coherent, of_masked) = (Trials::new(), Trials::new());
        Self { memory, of_coherent, of_masked, deferred: Deferred::new() }
    }

    /// Steps 1 and 2 for a packet, by its number. Puts answers into `sink`, and leaves open the
    /// rays that have none.
    #[inline(always)]
    pub fn try_together<L: Lanes, Q: MeshQuery>(
        &mut self,
        l: L,
        (number, packet): (usize, &mut MeshPacket<'a>),
        sink: &mut (impl Sink<Q::Found> + ?Sized),
    ) {
        let stack = &mut self.memory.stack;
        // A packet of few rays, as the last one of a batch is, says nothing about the next.
        if Q::IN_PACKETS && packet.goes_together() && self.of_coherent.tries() {
            let out = (&mut self.deferred, &mut *sink);
            self.of_coherent.learn(coherent::<L, Q>(l, stack, (number, packet), out));
        }
        let has_masks = Q::IN_PACKETS && !Q::ORDERED;
        if has_masks && packet.goes_together() && self.of_masked.tries() {
            let out = (&mut self.deferred, &mut *sink);
            self.of_masked.learn(masked::<L, Q>(l, stack, (number, packet), out));
        }
    }

    /// Step 3 for the rays of all packets that are open still.
    #[inline(always)]
    pub fn finish<L: Lanes, Q: MeshQuery>(
        &mut self,
        l: L,
        packets: &[MeshPacket<'a>],
        sink: &mut (impl Sink<Q::Found> + ?Sized),
    ) {
        let in_flight = &mut self.memory.in_flight;
        interleaved::<L, Q>(l, in_flight, packets, (&mut self.deferred, sink));
    }
}

/// Whether to try a traversal on the next packet: after each failure but the first two, one more
/// packet is left out, up to eight.
struct Trials {
    failures: u32,
    left_out: u32,
}

impl Trials {
    fn new() -> Self {
        Self { failures: 0, left_out: 0 }
    }

    #[inline(always)]
    fn tries(&mut self) -> bool {
        let tries = self.left_out == 0;
        self.left_out = self.left_out.saturating_sub(1);
        tries
    }

    #[inline(always)]
    fn learn(&mut self, has_succeeded: bool) {
        self.failures = if has_succeeded { 0 } else { self.failures + 1 };
        self.left_out = self.failures.saturating_sub(2).min(8);
    }
}
