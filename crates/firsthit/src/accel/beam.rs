//! Sixteen rays together through a [`MeshTree`]: neighbours that go almost the same way.
//!
//! Boulos, Wald and Shirley, "Geometric and Arithmetic Culling Methods for Entire Ray Packets", 2006, and Reshetov,
//! Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", 2005: what no ray of the beam can meet is ruled out for all
//! at once, a node's sixteen boxes against the planes around the beam, then a leaf's sixteen triangles. What is left
//! are single triangles, each against sixteen rays in lanes. Whether neighbours go together is not asked before: a beam
//! that comes to more work than its rays alone gives up.

mod leaf;
mod space;

use super::goal::Question;
use super::packet::RAYS;
use super::search::{Answers, Search};
use super::walk::Stack;
use super::wide::{LEAF, Node};
use crate::simd::{Aligned, LANES, Lanes};
use leaf::Seen;
use space::Beam;

/// What a beam may cost for each of its rays, in units of a node; see [`Beam::run`].
const BUDGET: u32 = 16;

/// Answers the open rays of a search, if they go nearly the same way; `false` when they do not, and some may be open still.
#[inline(always)]
pub(super) fn beam<L: Lanes, Q: Question>(
    l: L,
    stack: &mut Stack,
    number: usize,
    search: &mut Search<'_>,
    answers: &mut impl Answers<Q::Answer>,
) -> bool {
    let Some(beam) = Beam::new(l, search) else {
        return false;
    };
    let packet = search.packet;
    let mut questions: [Q; RAYS] = std::array::from_fn(|lane| Q::new(packet.limits(lane)));
    let is_done = beam.run(l, stack, search, &mut questions);
    search.close(l, number, (beam.rays, is_done), &questions, answers);
    is_done
}

impl Beam {
    /// Asks what the beam meets; `false` when that comes to too much work.
    #[inline(always)]
    fn run<L: Lanes, Q: Question>(
        &self,
        l: L,
        stack: &mut Stack,
        search: &Search<'_>,
        questions: &mut [Q; RAYS],
    ) -> bool {
        let tree = search.tree;
        let mut limits = Aligned([0.0; RAYS]);
        let none = l.splat(-1.0);
        l.store(
            l.select(self.rays, l.load(&search.packet.limit), none),
            &mut limits.0,
        );
        let mut limit = self.limit(l, &limits.0);
        let mut budget = BUDGET * self.rays.count_ones();
        let mut seen = Seen::NOTHING;
        let mut index = 0_u32;
        stack.clear();
        loop {
            if index & LEAF == 0 {
                let node = &tree.nodes[index as usize];
                self.open::<L, Q>(l, search, node, limit, stack);
                budget = budget.saturating_sub(1);
            } else {
                let index = index & !LEAF;
                let leaf = &tree.leaves[index as usize];
                let mut left = self.triangles(l, leaf, limit, &mut seen);
                budget = budget.saturating_sub(3 + left.count_ones());
                while left != 0 {
                    let lane = left.trailing_zeros() as usize % LANES;
                    left &= left - 1;
                    let triangle = (index, lane);
                    if self.meet(l, search, triangle, &seen, &mut limits.0, questions) {
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

    /// Puts the children that the beam may meet onto the stack, the nearest on top if that matters.
    #[inline(always)]
    fn open<L: Lanes, Q: Question>(
        &self,
        l: L,
        search: &Search<'_>,
        node: &Node,
        limit: f32,
        stack: &mut Stack,
    ) {
        let tree = search.tree;
        let (mut met, entry) = self.boxes(l, node, limit);
        let mut entries = Aligned([0.0; LANES]);
        l.store(entry, &mut entries.0);
        let base = stack.len();
        while met != 0 {
            let child = met.trailing_zeros() as usize % LANES;
            met &= met - 1;
            let next = node.children[child];
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
