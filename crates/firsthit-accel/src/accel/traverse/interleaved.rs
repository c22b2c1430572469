//! Sixteen rays at a time, each on its own way through the tree of a mesh.
//!
//! 1. Fill the free slots with the next rays.
//! 2. For each ray at a node: test its sixteen boxes, append those that are met to the ray's work
//!    list.
//! 3. For each ray at a leaf: test its sixteen triangles; the ray's query sees what is left.
//! 4. For all sixteen at once: take from each work list the nearest of the last sixteen entries,
//!    and ask memory for it. A ray whose list is empty, or holds only what is too far, is finished,
//!    and its slot is free.
//!
//! A single ray waits: for the next node from memory, for the test of its boxes, for a branch that
//! is hard to predict. Here the same step of all rays comes in one loop, without branches that
//! depend on what was met, so the processor works on other rays while one waits. The rays need have
//! nothing in common. Boulos, Wald and Benthin, "Adaptive Ray Packet Reordering", IEEE Symposium on
//! Interactive Ray Tracing 2008, keep many rays in flight too, and gather those that are at the
//! same node.
//!
//! A work list is two arrays, depths and children, and is never sorted: where the nearest of the
//! last sixteen is too far, all sixteen are. To look for the nearest in sixteen lists at once takes
//! two shuffles and a comparison for each ray ([`Lanes::smallest_of_each`]). In one list it takes
//! as many steps as for all sixteen, each of which waits for the one before.

use super::deferred::Deferred;
use super::mesh_packet::{MeshPacket, MeshRay};
use super::query::{MeshQuery, Sink};
use super::single::traverse;
use super::stack::Stack;
use crate::accel::filter::filter;
use crate::accel::node::LEAF;
use crate::accel::rays::packet::RAYS;
use crate::simd::{Aligned, Kernel, LANES, Lanes, set_bits};

/// Memory for the rays in flight, to be used again.
#[derive(Debug)]
pub(super) struct InFlight {
    lists: Box<[WorkList; LANES]>,
    /// The stack of a ray that has more to visit than a work list holds.
    stack: Stack,
}

impl InFlight {
    pub(super) fn new() -> Self {
        let lists = vec![WorkList::EMPTY; LANES].into_boxed_slice();
        Self { lists: lists.try_into().expect("it has that length"), stack: Stack::new() }
    }
}

/// The nodes and leaves that a ray has still to visit.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
struct WorkList {
    /// Entries are from index sixteen on: a look at the last sixteen may reach below the first.
    depths: [f32; CAPACITY + LANES],
    /// Nodes and leaves, as bits.
    children: [f32; CAPACITY + LANES],
}

/// The number of entries that a work list holds.
const CAPACITY: usize = 256;
/// The length of a list from which on the last entry is the next, so that hardly any list outgrows
/// its capacity.
const LAST_FIRST: usize = CAPACITY / 2;

impl WorkList {
    const EMPTY: Self =
        Self { depths: [f32::INFINITY; CAPACITY + LANES], children: [0.0; CAPACITY + LANES] };
}

/// A ray in flight.
#[derive(Clone, Copy)]
struct Slot<'a, Q> {
    ray: MeshRay<'a>,
    /// The number of its packet.
    packet: usize,
    query: Q,
    /// The node or leaf to visit next.
    next: u32,
    /// The number of entries in the work list.
    height: usize,
}

/// Puts the answer of each open ray of `packets` into `sink`.
#[inline(always)]
pub(super) fn interleaved<'a, L: Lanes, Q: MeshQuery>(
    l: L,
    in_flight: &mut InFlight,
    packets: &[MeshPacket<'a>],
    (deferred, sink): (&mut Deferred<'a>, &mut (impl Sink<Q::Found> + ?Sized)),
) {
    let Some(&any) = packets.first() else {
        return;
    };
    let mut queue = Queue { packets, next: 0, left: 0 };
    let mut slots: [Slot<'a, Q>; LANES] = [Slot::new(any, 0, 0); LANES];
    let InFlight { lists, stack } = in_flight;
    let mut nodes = 0_u16;
    let mut leaves = 0_u16;
    let mut free = u16::MAX;
    // Renewed after a leaf, which moves a ray's limit. Starting again moves it too, but leaves an
    // empty list, and what is below the first entry of a list is beyond all limits.
    let mut limits = Aligned([-1.0; LANES]);
    loop {
        while free != 0 {
            let Some((packet, lane)) = queue.take() else {
                break;
            };
            let k = free.trailing_zeros() as usize % LANES;
            free &= free - 1;
            slots[k] = Slot::new(packets[packet], packet, lane);
            limits.0[k] = slots[k].last_key();
            let is_leaf = u16::from(slots[k].next & LEAF != 0);
            nodes |= (1 - is_leaf) << k;
            leaves |= is_leaf << k;
        }
        let all = nodes | leaves;
        if all == 0 {
            deferred.finish_all::<L, Q>(l, sink);
            return;
        }
        for k in set_bits(nodes) {
            slots[k].open(l, &mut lists[k], stack);
        }
        for k in set_bits(leaves) {
            slots[k].visit(l);
            limits.0[k] = slots[k].last_key();
        }
        let next = Next::of(l, &mut slots, lists, &limits.0, all);
        (nodes, leaves) = (next.nodes, next.leaves);
        free |= next.nothing;
        for k in set_bits(next.nothing) {
            let slot = &slots[k];
            deferred.finish(l, (slot.packet, slot.ray), &slot.query, sink);
        }
    }
}

/// The rays whose next visit is a node, a leaf, or nothing, a bit each.
struct Next {
    nodes: u16,
    leaves: u16,
    nothing: u16,
}

impl Next {
    /// Takes it from the work lists of the rays `all`, which have done what came before.
    #[inline(always)]
    fn of<L: Lanes, Q: MeshQuery>(
        l: L,
        slots: &mut [Slot<'_, Q>; LANES],
        lists: &mut [WorkList; LANES],
        limits: &[f32; LANES],
        all: u16,
    ) -> Self {
        let mut next = Self { nodes: 0, leaves: 0, nothing: 0 };
        let mut left = all;
        if Q::ORDERED {
            let (within, keys) = nearest(l, slots, lists, limits);
            let within = within & all;
            left &= !within;
            for k in set_bits(within) {
                let behind = keys.0[k].to_bits() as usize % LANES;
                slots[k].take(l, &mut lists[k], behind);
                next.put(k, &slots[k], true);
            }
        }
        for k in set_bits(left) {
            let goes_on = slots[k].step(l, &mut lists[k]);
            next.put(k, &slots[k], goes_on);
        }
        next
    }

    /// Adds a ray. By arithmetic: a branch would be hard to predict.
    #[inline(always)]
    fn put<Q>(&mut self, k: usize, slot: &Slot<'_, Q>, goes_on: bool) {
        let (goes_on, is_leaf) = (u16::from(goes_on), u16::from(slot.next & LEAF != 0));
        self.nothing |= (1 - goes_on) << k;
        self.leaves |= (goes_on & is_leaf) << k;
        self.nodes |= (goes_on & (1 - is_leaf)) << k;
    }
}

/// The nearest of the last sixteen entries in each ray's work list, as [`Lanes::smallest_of_each`]
/// has it, and the rays that continue there: those for which it is not too far, and whose list is
/// shorter than [`LAST_FIRST`].
#[inline(always)]
fn nearest<L: Lanes, Q: MeshQuery>(
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

/// The rays that wait for a slot.
struct Queue<'a, 'b> {
    packets: &'b [MeshPacket<'a>],
    /// The number of the packet after the one being taken from.
    next: usize,
    /// The rays that are left of that.
    left: u16,
}

impl Queue<'_, '_> {
    /// The next ray: its packet and its lane.
    #[inline(always)]
    fn take(&mut self) -> Option<(usize, usize)> {
        while self.left == 0 {
            self.left = self.packets.get(self.next)?.open;
            self.next += 1;
        }
        let lane = self.left.trailing_zeros() as usize % RAYS;
        self.left &= self.left - 1;
        Some((self.next - 1, lane))
    }
}

impl<'a, Q: MeshQuery> Slot<'a, Q> {
    #[inline(always)]
    fn new(packet: MeshPacket<'a>, number: usize, lane: usize) -> Self {
        let ray = packet.ray(lane);
        let (query, next) = (Q::new(ray.limits.t_max_high), ray.packet.begin[lane % RAYS]);
        Self { ray, packet: number, query, next, height: 0 }
    }

    /// Puts the children that the ray meets into the work list.
    #[inline(always)]
    fn open<L: Lanes>(&mut self, l: L, list: &mut WorkList, stack: &mut Stack) {
        let node = &self.ray.tree.nodes[self.next as usize];
        let MeshRay { packet, lane, .. } = self.ray;
        let (met, entry) = packet.tree_ray(lane).boxes(l, node, self.query.limit());
        let above = LANES + self.height;
        let (Some(depths), Some(children)) =
            (list.depths[above..].first_chunk_mut(), list.children[above..].first_chunk_mut())
        else {
            return self.start_again(l, stack);
        };
        if Q::ORDERED {
            l.compress(met, entry, depths);
        }
        l.compress(met, l.load(bytemuck::cast_ref(&node.children)), children);
        self.height += met.count_ones() as usize;
    }

    /// Traverses the tree from the root again, with a stack that holds everything.
    #[cold]
    #[inline(never)]
    fn start_again<L: Lanes>(&mut self, l: L, stack: &mut Stack) {
        self.query = Q::new(self.ray.limits.t_max_high);
        l.call(FromRoot { stack, ray: self.ray, query: &mut self.query });
        self.height = 0;
    }

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L) {
        let index = self.next & !LEAF;
        let tree = self.ray.tree;
        let leaf = &tree.leaves[index as usize];
        let ray = self.ray.packet.tree_ray(self.ray.lane);
        if let Some(mut candidates) = filter(l, &ray, leaf, self.query.limit()) {
            candidates.possible = tree.present(index, candidates.possible);
            self.query.visit(l, &self.ray, index, &candidates);
        }
    }

    /// Takes what is to be visited next; `false` when nothing is left. Where the order matters,
    /// this is for long lists, and for those whose last sixteen entries are all too far; for the
    /// others see [`nearest`].
    #[inline(always)]
    fn step<L: Lanes>(&mut self, l: L, list: &mut WorkList) -> bool {
        let limit = self.query.limit();
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
                // Of equal ones the last, as a stack would have it.
                behind = l.le(depths, l.splat(nearest)).leading_zeros() as usize % LANES;
            }
            self.take(l, list, behind);
            return true;
        }
    }

    /// Takes the entry that is `behind` entries before the last, and puts the last in its place.
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
        let tree = self.ray.tree;
        l.prefetch_either(next & LEAF != 0, next & !LEAF, &tree.nodes, &tree.leaves);
    }

    /// The largest key of a depth that still matters, see [`Lanes::smallest_of_each`]; below the
    /// keys of unused entries.
    #[inline(always)]
    fn last_key(&self) -> f32 {
        let limit = self.query.limit().min(f32::MAX);
        f32::from_bits((limit + 0.0).to_bits() | 15)
    }
}

/// A traversal that is compiled once for all that may have to start again.
struct FromRoot<'a, 'b, Q> {
    stack: &'b mut Stack,
    ray: MeshRay<'a>,
    query: &'b mut Q,
}

impl<Q: MeshQuery> Kernel for FromRoot<'_, '_, Q> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        traverse(l, self.stack, &self.ray, self.query);
    }
}

/// The sixteen below the height.
#[inline(always)]
fn window(values: &[f32; CAPACITY + LANES], height: usize) -> &[f32; LANES] {
    let from = height.min(CAPACITY);
    values[from..].first_chunk().expect("sixteen are below all")
}
