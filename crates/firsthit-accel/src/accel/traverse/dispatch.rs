//! Many rays through the trees of meshes: chooses a traversal for each packet.
//!
//! 1. Try [`coherent`], for rays that go nearly the same way. It gives up when they do not.
//! 2. If the query needs no order, try [`masked`], for short rays from a small place. It gives up
//!    likewise.
//! 3. Put all rays that are left, of all packets, through [`interleaved`].
//!
//! Where packet after packet gives up, some of the next are not tried.

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
pub struct Dispatcher {
    stack: Stack,
    in_flight: InFlight,
}

impl Default for Dispatcher {
    fn default() -> Self {
        Self { stack: Stack::new(), in_flight: InFlight::new() }
    }
}

impl Dispatcher {
    /// Puts the answer of each open ray of `packets` into `sink`, in any order.
    #[inline(always)]
    pub fn run<L: Lanes, Q: MeshQuery>(
        &mut self,
        l: L,
        packets: &mut [MeshPacket<'_>],
        sink: &mut (impl Sink<Q::Found> + ?Sized),
    ) {
        let (mut of_coherent, mut of_masked) = (Trials::new(), Trials::new());
        let stack = &mut self.stack;
        let mut deferred = Deferred::new();
        for (number, packet) in packets.iter_mut().enumerate() {
            // A packet of few rays, as the last one of a batch is, says nothing about the next.
            if Q::IN_PACKETS && packet.goes_together() && of_coherent.tries() {
                of_coherent.learn(coherent::<L, Q>(
                    l,
                    stack,
                    (number, packet),
                    (&mut deferred, &mut *sink),
                ));
            }
            let has_masks = Q::IN_PACKETS && !Q::ORDERED;
            if has_masks && packet.goes_together() && of_masked.tries() {
                of_masked.learn(masked::<L, Q>(
                    l,
                    stack,
                    (number, packet),
                    (&mut deferred, &mut *sink),
                ));
            }
        }
        interleaved::<L, Q>(l, &mut self.in_flight, packets, (&mut deferred, &mut *sink));
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
