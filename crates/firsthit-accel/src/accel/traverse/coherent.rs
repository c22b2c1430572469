//! Sixteen rays together through the tree of a mesh: neighbours that go nearly the same way.
//!
//! 1. Put planes around the rays of the packet ([`PacketFrustum`]); give up when they do not go the
//!    same way at all.
//! 2. At a node, test its sixteen boxes against the planes, and those of leaves that are left
//!    against the sixteen rays: in rooms no ray meets half of these. Continue with the nearest one.
//! 3. At a leaf, test its sixteen triangles against the planes, then each one that is left against
//!    the sixteen rays.
//! 4. Give up when that comes to more work than the rays alone would be.
//!
//! Boulos, Wald and Shirley, "Geometric and Arithmetic Culling Methods for Entire Ray Packets",
//! technical report UUCS-06-010, University of Utah, 2006; Reshetov, Soupikov and Hurley,
//! "Multi-Level Ray Tracing Algorithm", ACM Transactions on Graphics 24(3), 2005. It departs in
//! step 4: there the caller knows which rays are coherent, here trying finds out.

use super::deferred::Deferred;
use super::frustum::PacketFrustum;
use super::frustum_leaf::LeafView;
use super::mesh_packet::MeshPacket;
use super::query::{MeshQuery, Sink, queries};
use super::stack::Stack;
use crate::accel::node::{LEAF, Node};
use crate::accel::rays::packet::RAYS;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// The largest cost of a packet for each of its rays, in units of a node: a leaf is 3, and a
/// triangle that is tested 1.
const BUDGET: u32 = 16;

/// Answers the open rays of a packet. Returns `false` when it gave up; some rays may then be open
/// still.
#[inline(always)]
pub(super) fn coherent<'a, L: Lanes, Q: MeshQuery>(
    l: L,
    stack: &mut Stack,
    (number, packet): (usize, &mut MeshPacket<'a>),
    (deferred, sink): (&mut Deferred<'a>, &mut (impl Sink<Q::Found> + ?Sized)),
) -> bool {
    let Some(frustum) = PacketFrustum::new(l, packet) else {
        return false;
    };
    let rays = packet.packet;
    let mut queries: [Q; RAYS] = queries(&rays.t_max_high);
    let is_done = frustum.run(l, stack, packet, &mut queries);
    deferred.finish_packet(l, (number, packet), (frustum.rays, is_done), &queries, sink);
    is_done
}

impl PacketFrustum {
    /// Traverses the tree; `false` when that comes to too much work.
    #[inline(always)]
    fn run<L: Lanes, Q: MeshQuery>(
        &self,
        l: L,
        stack: &mut Stack,
        packet: &MeshPacket<'_>,
        queries: &mut [Q; RAYS],
    ) -> bool {
        let tree = packet.tree;
        let mut limits = Aligned([0.0; RAYS]);
        let none = l.splat(-1.0);
        l.store(l.select(self.rays, l.load(&packet.packet.t_max_high), none), &mut limits.0);
        let mut limit = self.limit(l, &limits.0);
        let mut budget = BUDGET * self.rays.count_ones();
        let mut view = LeafView::NOTHING;
        let mut index = 0_u32;
        stack.clear();
        loop {
            if index & LEAF == 0 {
                let node = &tree.nodes[index as usize];
                self.open::<L, Q>(l, packet, node, limit, stack);
                budget = budget.saturating_sub(1);
            } else {
                let index = index & !LEAF;
                let leaf = &tree.leaves[index as usize];
                let met = self.triangles(l, leaf, limit, &mut view);
                let met = tree.present(index, met);
                budget = budget.saturating_sub(3 + met.count_ones());
                for lane in set_bits(met) {
                    let triangle = (index, lane);
                    if self.visit(l, packet, triangle, &view, &mut limits.0, queries) {
                        limit = self.limit(l, &limits.0);
                        if limit < -self.margin {
                            return true;
                        }
                    }
                }
            }
            let Some((_, next)) = stack.pop_within(limit) else {
                return true;
            };
            if budget == 0 {
                return false;
            }
            index = next;
        }
    }

    /// Puts the children that the rays may meet onto the stack, the nearest on top if that matters.
    #[inline(always)]
    fn open<L: Lanes, Q: MeshQuery>(
        &self,
        l: L,
        packet: &MeshPacket<'_>,
        node: &Node,
        limit: f32,
        stack: &mut Stack,
    ) {
        let tree = packet.tree;
        let (met, entry) = self.boxes(l, node, limit);
        let mut entries = Aligned([0.0; LANES]);
        l.store(entry, &mut entries.0);
        let base = stack.len();
        let limits = l.load(&packet.packet.t_max_high);
        for child in set_bits(met) {
            let next = node.children[child];
            // A leaf costs ten times as much as this.
            let is_idle =
                next & LEAF != 0 && packet.packet.meets(l, node, child, limits) & self.rays == 0;
            if is_idle {
                continue;
            }
            l.prefetch_either(next & LEAF != 0, next & !LEAF, &tree.nodes, &tree.leaves);
            let key = u64::from(entries.0[child].to_bits()) << 32 | u64::from(next);
            if Q::ORDERED {
                stack.insert(base, key);
            } else {
                stack.push(key);
            }
        }
    }
}
