//! Sixteen rays at a time, each on its own way through a [`MeshTree`].
//!
//! A single ray waits: for the next node from memory, for its boxes, for the guess where the way leads. Here a
//! round takes each of sixteen rays a step further, and all steps of a kind come one after the other, without a
//! branch in between that depends on what was met. So while one ray waits the others are at work, and what a
//! ray needs in the next round is asked for in this one. (An interleaved traversal of single rays: unlike packets, and
//! unlike Boulos, Wald and Benthin, "Adaptive Ray Packet Reordering", 2008, where rays are gathered that are at the same
//! place, the rays need have nothing in common.)
//!
//! What is still to be visited is a work list of two arrays, depths and children. The next one is the nearest of the
//! last sixteen: nothing is ever sorted, and where it is too far, so are all sixteen. It is looked for in the lists of all
//! sixteen rays at once, which takes two shuffles and a comparison for a ray; to find one after the other takes as
//! many steps for each, every one of which has to wait for that before.

use std::array::from_fn;

use super::filter::filter;
use super::goal::{Place, Question};
use super::packet::RAYS;
use super::search::{Answers, Search};
use super::waiting::Waiting;
use super::walk::{Stack, traverse};
use super::wide::LEAF;
use crate::simd::{Aligned, LANES, Lanes};

/// Memory for waves, to be used again.
#[derive(Debug)]
pub(super) struct Wave {
    lists: Box<[WorkList; LANES]>,
    /// For rays that have more to visit than a work list holds.
    stack: Stack,
}

impl Wave {
    /// With its memory.
    pub(super) fn new() -> Self {
        let lists = vec![WorkList::EMPTY; LANES].into_boxed_slice();
        Self {
            lists: lists.try_into().expect("it has that length"),
            stack: Stack::new(),
        }
    }
}

/// What a ray has still to visit.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
struct WorkList {
    /// The first sixteen are nobody's: a look at the last sixteen may reach below the first.
    depths: [f32; CAPACITY + LANES],
    /// Nodes and leaves, as bits.
    children: [f32; CAPACITY + LANES],
}

/// How many there can be.
const CAPACITY: usize = 256;
/// From here on the last one is the next, so that hardly anything comes to more.
const LAST_FIRST: usize = CAPACITY / 2;

impl WorkList {
    const EMPTY: Self = Self {
        depths: [f32::INFINITY; CAPACITY + LANES],
        children: [0.0; CAPACITY + LANES],
    };
}

/// A ray on its way.
struct Slot<'a, Q> {
    place: Place<'a>,
    /// The number of its search.
    search: usize,
    question: Q,
    /// What to visit next.
    next: u32,
    /// How many are in the work list.
    height: usize,
}

/// Answers each ray of `searches` that is still open.
#[inline(always)]
pub(super) fn wave<'a, L: Lanes, Q: Question>(
    l: L,
    wave: &mut Wave,
    searches: &[Search<'a>],
    answers: &mut impl Answers<Q::Answer>,
) {
    let Some(&any) = searches.first() else {
        return;
    };
    let mut queue = Queue {
        searches,
        next: 0,
        left: 0,
    };
    let mut slots: [Slot<'a, Q>; LANES] = from_fn(|_| Slot::new(any, 0, 0));
    let Wave { lists, stack } = wave;
    let mut waiting = Waiting::new();
    let mut nodes = 0_u16;
    let mut leaves = 0_u16;
    let mut free = u16::MAX;
    // Renewed after a leaf, which moves a ray's limit. So does starting again, but that leaves an empty list, and
    // nobody's depths are above all limits.
    let mut limits = Aligned([-1.0; LANES]);
    loop {
        while free != 0 {
            let Some((search, lane)) = queue.take() else {
                break;
            };
            let k = free.trailing_zeros() as usize % LANES;
            free &= free - 1;
            slots[k] = Slot::new(searches[search], search, lane);
            limits.0[k] = slots[k].last_key();
            nodes |= 1 << k;
        }
        let all = nodes | leaves;
        if all == 0 {
            waiting.answer_all::<L, Q>(l, answers);
            return;
        }
        while nodes != 0 {
            let k = nodes.trailing_zeros() as usize % LANES;
            nodes &= nodes - 1;
            slots[k].open(l, &mut lists[k], stack);
        }
        while leaves != 0 {
            let k = leaves.trailing_zeros() as usize % LANES;
            leaves &= leaves - 1;
            slots[k].visit(l);
            limits.0[k] = slots[k].last_key();
        }
        let next = Next::of(l, &mut slots, lists, &limits.0, all);
        (nodes, leaves) = (next.nodes, next.leaves);
        free |= next.nothing;
        let mut over = next.nothing;
        while over != 0 {
            let slot = &slots[over.trailing_zeros() as usize % LANES];
            over &= over - 1;
            waiting.answer(l, (slot.search, slot.place), &slot.question, answers);
        }
    }
}

/// What comes next, with a bit for each ray.
struct Next {
    nodes: u16,
    leaves: u16,
    nothing: u16,
}

impl Next {
    /// Takes it from the work lists of the rays `all`, which have done what came before.
    #[inline(always)]
    fn of<L: Lanes, Q: Question>(
        l: L,
        slots: &mut [Slot<'_, Q>; LANES],
        lists: &mut [WorkList; LANES],
        limits: &[f32; LANES],
        all: u16,
    ) -> Self {
        let mut next = Self {
            nodes: 0,
            leaves: 0,
            nothing: 0,
        };
        let mut left = all;
        if Q::ORDERED {
            let (within, keys) = nearest(l, slots, lists, limits);
            let mut within = within & all;
            left &= !within;
            while within != 0 {
                let k = within.trailing_zeros() as usize % LANES;
                within &= within - 1;
                let behind = keys.0[k].to_bits() as usize % LANES;
                slots[k].take(l, &mut lists[k], behind);
                next.put(k, &slots[k], true);
            }
        }
        while left != 0 {
            let k = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let goes_on = slots[k].step(l, &mut lists[k]);
            next.put(k, &slots[k], goes_on);
        }
        next
    }

    /// In numbers, not branches: nobody could foresee them.
    #[inline(always)]
    fn put<Q>(&mut self, k: usize, slot: &Slot<'_, Q>, goes_on: bool) {
        let (goes_on, is_leaf) = (u16::from(goes_on), u16::from(slot.next & LEAF != 0));
        self.nothing |= (1 - goes_on) << k;
        self.leaves |= (goes_on & is_leaf) << k;
        self.nodes |= (goes_on & (1 - is_leaf)) << k;
    }
}

/// For each ray what is nearest of the last sixteen in its work list, see [`Lanes::smallest_of_each`], and which rays are
/// to go on there: those for which it is not too far, and whose lists are not so long that the last comes first.
#[inline(always)]
fn nearest<L: Lanes, Q: Question>(
    l: L,
    slots: &[Slot<'_, Q>; LANES],
    lists: &[WorkList; LANES],
    limits: &[f32; LANES],
) -> (u16, Aligned<[f32; LANES]>) {
    let mut windows = [window(&lists[0].depths, 0); LANES];
    let mut short = 0;
    for k in 0..LANES {
        windows[k] = window(&lists[k].depths, slots[k].height);
        short |= u16::from(slots[k].height < LAST_FIRST) << k;
    }
    let keys = l.smallest_of_each(windows);
    let mut out = Aligned([0.0; LANES]);
    l.store(keys, &mut out.0);
    (short & l.le(keys, l.load(limits)), out)
}

/// The rays that are not yet on their way.
struct Queue<'a, 'b> {
    searches: &'b [Search<'a>],
    /// The number of the search after the one being taken from.
    next: usize,
    /// What is left of that.
    left: u16,
}

impl Queue<'_, '_> {
    /// The next ray: its search and its lane.
    #[inline(always)]
    fn take(&mut self) -> Option<(usize, usize)> {
        while self.left == 0 {
            self.left = self.searches.get(self.next)?.open;
            self.next += 1;
        }
        let lane = self.left.trailing_zeros() as usize % RAYS;
        self.left &= self.left - 1;
        Some((self.next - 1, lane))
    }
}

impl<'a, Q: Question> Slot<'a, Q> {
    #[inline(always)]
    fn new(search: Search<'a>, number: usize, lane: usize) -> Self {
        Self {
            place: search.place(lane),
            search: number,
            question: Q::new(search.packet.limits(lane)),
            next: 0,
            height: 0,
        }
    }

    /// Puts the children that the ray meets into the work list.
    #[inline(always)]
    fn open<L: Lanes>(&mut self, l: L, list: &mut WorkList, stack: &mut Stack) {
        let node = &self.place.tree.nodes[self.next as usize];
        let Place { packet, lane, .. } = self.place;
        let (met, entry) = packet.tree_ray(lane).boxes(l, node, self.question.limit());
        let above = LANES + self.height;
        let (Some(depths), Some(children)) = (
            list.depths[above..].first_chunk_mut(),
            list.children[above..].first_chunk_mut(),
        ) else {
            return self.start_again(l, stack);
        };
        if Q::ORDERED {
            l.compress(met, entry, depths);
        }
        l.compress(met, l.load(bytemuck::cast_ref(&node.children)), children);
        self.height += met.count_ones() as usize;
    }

    /// Looks for the answer in the plain way.
    #[cold]
    #[inline(never)]
    fn start_again<L: Lanes>(&mut self, l: L, stack: &mut Stack) {
        self.question = Q::new(self.place.packet.limits(self.place.lane));
        traverse(l, stack, &self.place, &mut self.question);
        self.height = 0;
    }

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L) {
        let index = self.next & !LEAF;
        let leaf = &self.place.tree.leaves[index as usize];
        let ray = self.place.packet.tree_ray(self.place.lane);
        if let Some(candidates) = filter(l, &ray, leaf, self.question.limit()) {
            self.question.meet(l, &self.place, index, &candidates);
        }
    }

    /// Takes what is to be visited next; `false` when there is nothing any more. Where the order matters, this is for long
    /// lists and those whose last sixteen are all too far: for others see [`nearest`].
    #[inline(always)]
    fn step<L: Lanes>(&mut self, l: L, list: &mut WorkList) -> bool {
        let limit = self.question.limit();
        loop {
            if self.height == 0 || limit < 0.0 {
                return false;
            }
            let mut behind = 0;
            if Q::ORDERED && self.height < LAST_FIRST {
                let depths = l.load(window(&list.depths, self.height));
                let nearest = l.smallest(depths);
                if nearest > limit {
                    self.height = self.height.saturating_sub(LANES);
                    continue;
                }
                // Of equal ones the last that was put there, as a stack would have it.
                behind = l.le(depths, l.splat(nearest)).leading_zeros() as usize % LANES;
            }
            self.take(l, list, behind);
            return true;
        }
    }

    /// Takes the one that so many are behind of in the work list, and puts the last there.
    #[inline(always)]
    fn take<L: Lanes>(&mut self, l: L, list: &mut WorkList, behind: usize) {
        let last = LANES - 1 + self.height;
        let at = last - behind;
        let next = list.children[at].to_bits();
        list.children[at] = list.children[last];
        if Q::ORDERED {
            list.depths[at] = list.depths[last];
        }
        self.height -= 1;
        self.next = next;
        let tree = self.place.tree;
        l.prefetch_either(next & LEAF != 0, next & !LEAF, &tree.nodes, &tree.leaves);
    }

    /// The largest key of a depth that still matters, see [`Lanes::smallest_of_each`]; below the keys of those that are
    /// nobody's.
    #[inline(always)]
    fn last_key(&self) -> f32 {
        let limit = self.question.limit().min(f32::MAX);
        f32::from_bits((limit + 0.0).to_bits() | 15)
    }
}

/// The sixteen below the height.
#[inline(always)]
fn window(values: &[f32; CAPACITY + LANES], height: usize) -> &[f32; LANES] {
    let from = height.min(CAPACITY);
    values[from..].first_chunk().expect("sixteen are below all")
}
