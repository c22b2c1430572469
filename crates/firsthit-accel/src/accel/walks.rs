//! Many rays through the top-level tree, each on its own way.
//!
//! 1. For sixteen rays at once: take from each ray's list the nearest of the last sixteen entries,
//!    and ask memory for it. A ray whose list is empty, or holds only what is too far, has nothing
//!    left.
//! 2. A ray at a leaf, which is one box, has arrived, and waits until it is sent on.
//! 3. For each ray at a node: test the sixteen boxes, and append those that are met to its list.
//!
//! So the processor works on other rays while one waits, and nothing is sorted: see
//! `traverse/interleaved.rs`, which does the same in the trees of meshes. Lists that are too short
//! grow.
//!
//! Entries are depths from where the ray begins on, so that none is negative. The difference is
//! rounded as that of the ray's end is, and rounding is monotone: what is not too far stays so.

use super::bvh::{Bvh, narrowed};
use super::node::LEAF;
use super::rays::slabs::Slabs;
use crate::geometry::Ray;
use crate::simd::{Kernel, LANES, Lanes};

/// The ways of many rays, each by its place. Memory to be used again.
#[derive(Debug, Default)]
#[doc(hidden)]
pub struct Walks {
    ways: Vec<Way>,
    /// The depths of each way's entries, [`Walks::room`] for each. They are from index sixteen on:
    /// a look at the last sixteen may reach below the first.
    depths: Vec<f32>,
    /// The entries' nodes and leaves, as bits.
    children: Vec<f32>,
    room: usize,
    /// The places without a ray.
    free: Vec<u32>,
    /// The places whose rays are on their way to the next box.
    active: Vec<u32>,
}

/// The way of a ray.
#[derive(Debug, Clone, Copy)]
struct Way {
    slabs: Slabs,
    /// See [`Walk`](super::bvh::Walk).
    first: f32,
    depth_of_origin: f64,
    depth_per_t: f64,
    /// The depth beyond which nothing matters, and the largest key of an entry that still does, see
    /// [`Lanes::smallest_of_each`].
    last: f32,
    limit: f32,
    /// The node or leaf to visit next.
    next: u32,
    /// The number of entries in the list.
    height: usize,
}

impl Way {
    const NONE: Self = Self {
        slabs: Slabs { inverse: [0.0; 3], ends: [[0.0; 2]; 3] },
        first: 0.0,
        depth_of_origin: 0.0,
        depth_per_t: 0.0,
        last: 0.0,
        limit: 0.0,
        next: END,
        height: 0,
    };
}

/// Marks a ray that meets nothing more.
const END: u32 = u32::MAX;
/// The first room for a list.
const ROOM: usize = 112;
/// The length of a list from which on the last entry is the next, so that it hardly grows further.
const LAST_FIRST: usize = 64;
/// As many rays look for the nearest entries at once, or more.
const TOGETHER: usize = 4;

impl Walks {
    /// Finds a place for a ray at the start of its way through a tree.
    pub fn begin(&mut self, bvh: &Bvh, ray: &Ray) -> u32 {
        let (walk, passes) = bvh.walk(ray);
        let way = Way {
            slabs: walk.slabs,
            // Finite, so that the difference with a depth is a number.
            first: walk.first.max(f32::MIN / 4.0),
            depth_of_origin: walk.depth_of_origin,
            depth_per_t: walk.depth_per_t,
            height: usize::from(passes),
            ..Way::NONE
        };
        let place = self.free.pop().unwrap_or_else(|| self.add());
        let k = place as usize;
        self.ways[k] = way;
        self.depths[k * self.room + LANES] = 0.0;
        self.children[k * self.room + LANES] = f32::from_bits(0);
        place
    }

    /// Makes one place more.
    #[cold]
    fn add(&mut self) -> u32 {
        self.room = self.room.max(ROOM);
        self.ways.push(Way::NONE);
        self.depths.resize(self.ways.len() * self.room, f32::INFINITY);
        self.children.resize(self.ways.len() * self.room, 0.0);
        u32::try_from(self.ways.len() - 1).expect("rays in flight are few")
    }

    /// Gives a place back.
    #[inline(always)]
    pub fn end(&mut self, place: u32) {
        self.free.push(place);
    }

    /// Sends a ray on to the next box that it may meet at a parameter of at most `t_max`, roughly
    /// the nearest first. `t_max` is not larger than in the call before.
    #[inline(always)]
    pub fn send(&mut self, place: u32, t_max: f64) {
        let way = &mut self.ways[place as usize];
        way.last = narrowed(t_max * way.depth_per_t + way.depth_of_origin).next_up();
        let limit = (way.last - way.first).min(f32::MAX);
        way.limit = f32::from_bits((limit + 0.0).to_bits() | 15);
        self.active.push(place);
    }

    /// Takes the rays that were sent through the tree, until each has arrived at a box or at the
    /// end.
    #[inline(always)]
    pub fn advance<L: Lanes>(&mut self, l: L, bvh: &Bvh) {
        if !self.active.is_empty() {
            l.call(Advance { walks: self, bvh });
        }
    }

    /// The box that a ray has arrived at; `None` at the end.
    #[inline(always)]
    pub fn arrived(&self, place: u32) -> Option<u32> {
        let next = self.ways[place as usize].next;
        (next != END).then_some(next & !LEAF)
    }

    /// Doubles the room for each list.
    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        let [old, new] = [self.room, 2 * self.room];
        for (list, fill) in [(&mut self.depths, f32::INFINITY), (&mut self.children, 0.0)] {
            let mut grown = vec![fill; new * self.ways.len()];
            for (from, to) in list.chunks_exact(old).zip(grown.chunks_exact_mut(new)) {
                to[..old].copy_from_slice(from);
            }
            *list = grown;
        }
        self.room = new;
    }
}

/// A function of its own, one for all queries.
struct Advance<'r> {
    walks: &'r mut Walks,
    bvh: &'r Bvh,
}

impl Kernel for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { walks, bvh } = self;
        let mut active = std::mem::take(&mut walks.active);
        while !active.is_empty() {
            let mut at_nodes = 0;
            for first in (0..active.len()).step_by(LANES) {
                let count = LANES.min(active.len() - first);
                let mut keys = [0.0; LANES];
                let mut within = 0;
                if count >= TOGETHER {
                    within = walks.nearest(l, &active[first..first + count], &mut keys);
                }
                for (k, key) in keys[..count].iter().enumerate() {
                    let place = active[first + k];
                    if within >> k & 1 == 1 {
                        walks.take(place as usize, key.to_bits() as usize % LANES);
                    } else {
                        walks.step(l, place as usize);
                    }
                    let next = walks.ways[place as usize].next;
                    active[at_nodes] = place;
                    at_nodes += usize::from(next & LEAF == 0);
                    if let Some(node) = bvh.nodes.get(next as usize) {
                        l.prefetch(node);
                    }
                }
            }
            active.truncate(at_nodes);
            for &place in &active {
                walks.open(l, bvh, place as usize);
            }
        }
        walks.active = active;
    }
}

impl Walks {
    /// The keys of the nearest of the last sixteen entries of some rays, and the rays for which it
    /// is not too far, a bit each.
    #[inline(always)]
    fn nearest<L: Lanes>(&self, l: L, places: &[u32], keys: &mut [f32; LANES]) -> u16 {
        let mut windows = [self.window(places[0] as usize); LANES];
        let mut limits = [-1.0; LANES];
        for (k, &place) in places.iter().enumerate().take(LANES) {
            windows[k] = self.window(place as usize);
            let way = &self.ways[place as usize];
            limits[k] = if way.height < LAST_FIRST { way.limit } else { -1.0 };
        }
        let nearest = l.smallest_of_each(windows);
        l.store(nearest, keys);
        l.le(nearest, l.load(&limits))
    }

    /// The last sixteen entries of a ray.
    #[inline(always)]
    fn window(&self, place: usize) -> &[f32; LANES] {
        let from = place * self.room + self.ways[place].height;
        self.depths[from..].first_chunk().expect("sixteen are below all")
    }

    /// Takes the entry that is `behind` entries before the last, and puts the last in its place.
    #[inline(always)]
    fn take(&mut self, place: usize, behind: usize) {
        let way = &mut self.ways[place];
        let last = place * self.room + LANES - 1 + way.height;
        let at = last - behind;
        way.next = self.children[at].to_bits();
        way.height -= 1;
        self.children[at] = self.children[last];
        self.depths[at] = self.depths[last];
    }

    /// Takes what a ray visits next, one ray alone.
    #[inline(always)]
    fn step<L: Lanes>(&mut self, l: L, place: usize) {
        loop {
            let depths = l.load(self.window(place));
            let nearest = l.smallest(depths);
            let way = &mut self.ways[place];
            if way.height == 0 {
                way.next = END;
                return;
            }
            if way.height >= LAST_FIRST {
                return self.take(place, 0);
            }
            if nearest <= way.limit {
                // Of equal ones the last, as a stack would have it.
                let behind = l.le(depths, l.splat(nearest)).leading_zeros() as usize % LANES;
                return self.take(place, behind);
            }
            way.height = way.height.saturating_sub(LANES);
        }
    }

    /// Puts the children of its node that a ray meets into its list.
    #[inline(always)]
    fn open<L: Lanes>(&mut self, l: L, bvh: &Bvh, place: usize) {
        let way = &self.ways[place];
        if self.room < way.height + 2 * LANES {
            self.grow();
        }
        let way = &mut self.ways[place];
        let node = &bvh.nodes[way.next as usize];
        let (met, entries) = way.slabs.boxes(l, node, [way.first, way.last]);
        let from_first = l.sub(entries, l.splat(way.first));
        let above = place * self.room + LANES + way.height;
        if let Some(depths) = self.depths[above..].first_chunk_mut() {
            l.compress(met, from_first, depths);
        }
        if let Some(children) = self.children[above..].first_chunk_mut() {
            l.compress(met, l.load(bytemuck::cast_ref(&node.children)), children);
        }
        way.height += met.count_ones() as usize;
    }
}
