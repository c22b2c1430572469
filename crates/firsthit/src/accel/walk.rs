//! One ray through a [`MeshTree`]: the one traversal for the first hit, for any hit and for all.
//!
//! Wald, Benthin and Boulos, "Getting Rid of Packets" (2008): a ray against all boxes of a wide node at once,
//! children nearest first. It departs in the leaves, where float32 rules out and float64 decides: what is
//! met for certain at a depth that no other candidate can have is not even computed before the end.

use super::distant::Approach;
use super::filter::filter;
use super::goal::{Each, Goal, Place, Question};
use super::mesh_tree::MeshTree;
use super::packet::Packet;
use super::visit::Known;
use super::wide::LEAF;
use crate::geometry::Ray;
use crate::shape::Mesh;
use crate::shape::triangle::clear_of;
use crate::simd::{Aligned, LANES, Lanes};

/// Memory for traversals, to be used again.
#[derive(Debug)]
pub(crate) struct Scratch {
    pub(super) stack: Stack,
    pub(super) known: Box<Known>,
    packet: Box<Packet>,
}

impl Scratch {
    /// With its memory.
    pub(crate) fn new() -> Self {
        Self {
            stack: Stack::new(),
            known: Box::default(),
            packet: Box::default(),
        }
    }
}

/// Nodes and leaves still to be visited: the index, and above it the depth's bits, or the rays of a packet.
#[derive(Debug)]
pub(super) struct Stack {
    entries: Box<[u64; STACK]>,
    height: usize,
}

/// A tree has no more levels than the binary one it is made from; see `build.rs`.
const LEVELS: usize = 97;
/// A power of two: each level leaves up to 15 behind.
const STACK: usize = 2048;
/// From here on [`Stack::pop_any`] takes the last, and what is above is that of one way down.
const MANY: usize = 256;
const _: () = assert!(MANY + 15 * LEVELS < STACK);

impl Stack {
    pub(super) fn new() -> Self {
        Self {
            entries: vec![0; STACK].try_into().expect("it has that length"),
            height: 0,
        }
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.height = 0;
    }

    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.height
    }

    #[inline(always)]
    pub(super) fn push(&mut self, key: u64) {
        debug_assert!(self.height < STACK, "a tree is not that deep");
        self.entries[self.height % STACK] = key;
        self.height += 1;
    }

    /// Puts `key` there if it `is` wanted, without a branch.
    #[inline(always)]
    pub(super) fn push_if(&mut self, is: bool, key: u64) {
        debug_assert!(self.height < STACK, "a tree is not that deep");
        self.entries[self.height % STACK] = key;
        self.height += usize::from(is);
    }

    /// Those from `base` on.
    #[inline(always)]
    pub(super) fn entries_from(&self, base: usize) -> &[u64] {
        &self.entries[base.min(STACK)..self.height.min(STACK)]
    }

    /// Any one: the last but two, whose memory was asked for longer ago than the last; of many, the last.
    #[inline(always)]
    pub(super) fn pop_any(&mut self) -> Option<u64> {
        let last = self.height.checked_sub(1)?;
        let at = if last < MANY {
            last.saturating_sub(2)
        } else {
            last
        };
        let key = self.entries[at % STACK];
        self.entries[at % STACK] = self.entries[last % STACK];
        self.height = last;
        Some(key)
    }

    /// Puts `key` among those from `base` on, the smallest on top.
    #[inline(always)]
    pub(super) fn insert(&mut self, base: usize, key: u64) {
        debug_assert!(self.height < STACK, "a tree is not that deep");
        let mut at = self.height;
        while at > base && self.entries[(at - 1) % STACK] < key {
            self.entries[at % STACK] = self.entries[(at - 1) % STACK];
            at -= 1;
        }
        self.entries[at % STACK] = key;
        self.height += 1;
    }

    /// The next that is at a depth of at most `limit`: the depth, and what is there.
    #[inline(always)]
    pub(super) fn pop_within(&mut self, limit: f32) -> Option<(f32, u32)> {
        loop {
            self.height = self.height.checked_sub(1)?;
            let key = self.entries[self.height % STACK];
            let depth = f32::from_bits((key >> 32) as u32);
            if depth <= limit {
                #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
                return Some((depth, key as u32));
            }
        }
    }

    #[inline(always)]
    pub(super) fn top(&self) -> Option<u64> {
        Some(self.entries[self.height.checked_sub(1)? % STACK])
    }
}

/// The answer to a question about `ray` and `mesh`, in the mesh's space: the first hit (the smallest `t`, at the
/// same `t` the lowest triangle), or whether there is any. The tree has nodes, and the ray is valid.
#[inline(always)]
pub(crate) fn ask<L: Lanes, Q: Question>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    ray: &Ray,
) -> Q::Answer {
    let Scratch { stack, packet, .. } = scratch;
    packet.put(0, ray);
    packet.prepare(l, tree, 1);
    if packet.alive == 0 {
        return Q::NOTHING;
    }
    let place = Place {
        tree,
        mesh,
        packet,
        lane: 0,
    };
    let mut goal = Q::new(packet.limits(0));
    traverse(l, stack, &place, &mut goal);
    goal.answer(l, &place)
}

/// What ends a search, in place of a `t_max`.
pub(crate) const END: f64 = f64::NEG_INFINITY;

/// Calls `visit(triangle, t_max)` with each triangle that `ray` may meet at a parameter of at most `t_max`, and perhaps with others,
/// in any order. `visit` returns the `t_max` to go on with, not larger than before, or [`END`].
#[inline(always)]
pub(crate) fn each<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    ray: &Ray,
    visit: impl FnMut(u32, f64) -> f64,
) {
    let approach = if !tree.has_nodes() {
        Approach::Somewhere
    } else if tree.is_distant(ray.origin) || ray.t_min == f64::NEG_INFINITY {
        Approach::new(&tree.space, ray)
    } else if ray.t_min >= 0.0 {
        return each_ahead(l, scratch, (tree, mesh), (ray, 0.0), visit);
    } else {
        // From a little earlier, as where that is has been rounded: the product, and the sum.
        let size = ray.origin.abs() + ray.at(ray.t_min).abs();
        let rounding = f64::EPSILON * size.max_element();
        let earlier = 2.0 * rounding / ray.direction.abs().max_element();
        let t = ray.t_min - earlier;
        let begin = ray.at(t);
        if tree.is_distant(begin) || !earlier.is_finite() {
            Approach::new(&tree.space, ray)
        } else {
            let after = |t_max: f64| clear_of(t_max - t) + 2.0 * earlier;
            let ahead = Ray::new(begin, ray.direction).up_to(after(ray.t_max));
            let off = rounding * tree.space.scale;
            let mut visit = visit;
            return each_ahead(l, scratch, (tree, mesh), (&ahead, off), |triangle, _| {
                let t_max = visit(triangle, ray.t_max);
                if t_max == END { END } else { after(t_max) }
            });
        }
    };
    let mut visit = visit;
    match approach {
        Approach::Past => {}
        Approach::Near(near, off) => {
            let visit = |triangle, _| {
                let is_over = visit(triangle, ray.t_max) == END;
                if is_over { END } else { f64::INFINITY }
            };
            each_ahead(l, scratch, (tree, mesh), (&near, off), visit);
        }
        Approach::Somewhere => {
            let mut t_max = ray.t_max;
            for &triangle in &tree.order {
                t_max = visit(triangle, t_max);
                if t_max == END {
                    return;
                }
            }
        }
    }
}

/// [`each`] for a ray that is not distant, and off by so much.
#[inline(always)]
fn each_ahead<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    (ray, off): (&Ray, f64),
    visit: impl FnMut(u32, f64) -> f64,
) {
    let Scratch { stack, packet, .. } = scratch;
    packet.put(0, ray);
    packet.prepare_blurred(l, tree, 1, off);
    if packet.alive != 0 {
        let mut each = Each {
            visit,
            t_max: ray.t_max,
            limit: packet.limits(0).last,
        };
        let place = Place {
            tree,
            mesh,
            packet,
            lane: 0,
        };
        traverse(l, stack, &place, &mut each);
    }
}

#[inline(always)]
pub(super) fn traverse<L: Lanes, G: Goal>(
    l: L,
    stack: &mut Stack,
    place: &Place<'_>,
    goal: &mut G,
) {
    let tree = place.tree;
    let ray = place.packet.tree_ray(place.lane);
    stack.clear();
    let mut index = 0_u32;
    loop {
        if index & LEAF == 0 {
            let node = &tree.nodes[index as usize];
            let (mut met, entry) = ray.boxes(l, node, goal.limit());
            if met.is_power_of_two() || (met != 0 && !G::ORDERED) {
                // The next one is known, without a way through memory.
                index = node.children[met.trailing_zeros() as usize % LANES];
                met &= met - 1;
                while met != 0 {
                    let child = met.trailing_zeros() as usize % LANES;
                    met &= met - 1;
                    stack.push(u64::from(node.children[child]));
                }
                continue;
            }
            let mut entries = Aligned([0.0; LANES]);
            l.store(entry, &mut entries.0);
            let base = stack.len();
            while met != 0 {
                let child = met.trailing_zeros() as usize % LANES;
                met &= met - 1;
                let key =
                    u64::from(entries.0[child].to_bits()) << 32 | u64::from(node.children[child]);
                stack.insert(base, key);
            }
        } else {
            let leaf = &tree.leaves[(index & !LEAF) as usize];
            if let Some(candidates) = filter(l, &ray, leaf, goal.limit()) {
                goal.meet(l, place, index & !LEAF, &candidates);
            }
        }
        let Some((_, next)) = stack.pop_within(goal.limit()) else {
            return;
        };
        index = next;
        if let Some(next) = stack.top() {
            prefetch(l, tree, next);
        }
    }
}

/// What comes after the next.
#[inline(always)]
fn prefetch<L: Lanes>(l: L, tree: &MeshTree, key: u64) {
    #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
    let index = key as u32;
    if index & LEAF == 0 {
        l.prefetch(&tree.nodes[index as usize]);
    } else {
        l.prefetch(&tree.leaves[(index & !LEAF) as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree as deep as one can be, with all sixteen children of each node met.
    #[test]
    fn the_stack_holds_what_is_left_of_the_deepest_tree() {
        let mut stack = Stack::new();
        stack.push(0);
        let mut highest = 0;
        // Not all of it, which nobody could: what comes first is what piles up.
        for _ in 0..200_000 {
            let level = stack.pop_any().unwrap();
            if level < LEVELS as u64 {
                for _ in 0..16 {
                    stack.push(level + 1);
                }
            }
            highest = highest.max(stack.len());
        }
        assert!(highest > MANY && highest < STACK, "{highest}");
    }
}
