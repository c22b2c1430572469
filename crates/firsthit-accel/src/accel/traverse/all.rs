//! All crossings: where does a ray cross the triangles of a mesh?
//!
//! 1. Drop a candidate that is before `t_min`, by its depths.
//! 2. A candidate that is certain to be met, and certainly beyond `t_min`, waits with those of
//!    other rays until there are eight. Then compute in lanes where all are met ([`EightPairs`]).
//! 3. For any other candidate the exact test decides, and says where. At an edge it takes one
//!    neighbour (`triangle/crossed.rs`).
//! 4. The copies of a triangle, which the tree leaves out, are met in the same place.
//!
//! The crossings of a ray are an unordered list in thread-local memory.

use std::cell::{Cell, RefCell};

use super::mesh_packet::{MeshRay, SettleExactly};
use super::query::{MeshQuery, Visitor, visit_each};
use crate::accel::eight_pairs::EightPairs;
use crate::accel::filter::Candidates;
use crate::accel::meshlet::leaf_lane;
use crate::geometry::{DVec2, DVec3, Ray, SurfaceId};
use crate::shape::Crossing;
use crate::shape::triangle::{self, Doubtful, EdgeRule, TriangleHit};
use crate::simd::{Kernel, Lanes, WIDE};

/// A crossing, the object that it is with, and the next one of its list.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Node {
    /// The crossing; its `t` is NaN while it waits, and where it turns out not to be on the ray.
    pub crossing: Crossing,
    object: i32,
    next: u32,
}

impl Node {
    /// The surface that is crossed.
    pub fn surface(&self) -> SurfaceId {
        SurfaceId { object: self.object, primitive: self.crossing.primitive }
    }
}

/// The crossings of the rays that a thread has at hand.
#[derive(Debug)]
struct Gathered {
    nodes: Vec<Node>,
    is_full: bool,
    waiting: Waiting,
}

/// Memory for more crossings than this is given back, not kept for the next rays.
const KEPT: usize = 1 << 18;

impl Gathered {
    /// An empty list in `memory`.
    const fn new(memory: Vec<Node>) -> Self {
        Self { nodes: memory, is_full: false, waiting: Waiting::NONE }
    }

    /// Adds a crossing to a list, and returns its index. Without memory it is lost.
    #[inline]
    fn add(&mut self, list: &mut CrossingList, crossing: Crossing) -> Option<u32> {
        let has_room = self.nodes.try_reserve(1).is_ok();
        let index = u32::try_from(self.nodes.len()).ok();
        let index = index.filter(|&index| has_room && index < u32::MAX);
        match index {
            Some(index) => {
                let next = std::mem::replace(&mut list.last, index);
                self.nodes.push(Node { crossing, object: 0, next });
            }
            None => self.is_full = true,
        }
        index
    }

    /// Says where a ray meets the triangle of a node.
    #[inline]
    fn settle(&mut self, ray: &Ray, node: u32, hit: Option<TriangleHit>) {
        if let Some(hit) = hit.filter(|hit| ray.holds(hit.t))
            && let Some(node) = self.nodes.get_mut(node as usize)
        {
            node.crossing = hit.crossing(node.crossing.primitive);
        }
    }
}

/// Triangles that are certain to be met, of which only the place is missing.
#[derive(Debug, Clone, Copy)]
struct Waiting {
    count: usize,
    pairs: EightPairs,
    nodes: [u32; WIDE],
}

impl Waiting {
    const NONE: Self = Self { count: 0, pairs: EightPairs::NONE, nodes: [0; WIDE] };

    /// The rays with their triangles and nodes.
    fn entries(&self) -> impl Iterator<Item = (Ray, [DVec3; 3], u32)> {
        (0..self.count).map(|lane| {
            let (ray, corners) = self.pairs.get(lane);
            (ray, corners, self.nodes[lane])
        })
    }
}

thread_local! {
    static GATHERED: RefCell<Gathered> = const { RefCell::new(Gathered::new(Vec::new())) };

    /// Memory for nodes that is used again; empty while it is in use.
    static SPARE: Cell<Vec<Node>> = const { Cell::new(Vec::new()) };
}

/// A list of crossings in memory of this thread's, the last one first. It is valid within one
/// [`CrossingList::gather`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[doc(hidden)]
pub struct CrossingList {
    last: u32,
}

impl CrossingList {
    pub const EMPTY: Self = Self { last: u32::MAX };

    /// Calls `work`, which makes lists, and forgets these. Returns also whether all crossings had
    /// room.
    ///
    /// `work` may come back here on the same thread: rays may be computed by other queries, and a
    /// thread that waits for others takes over what these have left.
    pub fn gather<T>(work: impl FnOnce() -> T) -> (T, bool) {
        let outer = GATHERED.replace(Gathered::new(SPARE.take()));
        let made = work();
        let Gathered { mut nodes, is_full, .. } = GATHERED.replace(outer);
        nodes.clear();
        nodes.shrink_to(KEPT);
        SPARE.set(nodes);
        (made, !is_full)
    }

    /// The number of crossings that all lists of this thread have together, at most.
    pub fn count_all() -> usize {
        GATHERED.with_borrow(|gathered| gathered.nodes.len())
    }

    /// Adds a crossing. Without memory it is lost, which [`gather`](Self::gather) says.
    #[inline]
    fn push(&mut self, crossing: Crossing) {
        GATHERED.with_borrow_mut(|gathered| gathered.add(self, crossing));
    }

    /// Adds the crossing with a triangle that the ray meets for certain; where may be computed
    /// later.
    #[inline(always)]
    fn push_certain<L: Lanes>(
        &mut self,
        l: L,
        ray: &MeshRay<'_>,
        (primitive, leaf_lane): (i32, u32),
    ) {
        let is_eight = GATHERED.with_borrow_mut(|gathered| {
            let unknown = Crossing { t: f64::NAN, primitive, barycentric: DVec2::NAN };
            if let Some(node) = gathered.add(self, unknown) {
                let waiting = &mut gathered.waiting;
                let lane = waiting.count % WIDE;
                let in_mesh = ray.packet.ray(ray.lane);
                let at_mesh = (ray.tree, ray.mesh);
                waiting.pairs.put(lane, &in_mesh, at_mesh, leaf_lane);
                waiting.nodes[lane] = node;
                waiting.count += 1;
            }
            gathered.waiting.count == WIDE
        });
        if is_eight {
            l.call(LocateWaiting);
        }
    }

    /// Computes where the triangles that still wait are met.
    pub fn finish_all() {
        GATHERED.with_borrow_mut(|gathered| {
            let waiting = gathered.waiting;
            gathered.waiting.count = 0;
            for (ray, corners, node) in waiting.entries() {
                let hit = triangle::locate(&ray, corners, Doubtful::settle);
                gathered.settle(&ray, node, hit);
            }
        });
    }

    /// Takes over the crossings of another list; `surface` tells what a number stands for.
    pub fn append(&mut self, list: Self, surface: impl Fn(i32) -> SurfaceId) {
        GATHERED.with_borrow_mut(|gathered| {
            let mut index = list.last;
            while let Some(node) = gathered.nodes.get_mut(index as usize) {
                let SurfaceId { object, primitive } = surface(node.crossing.primitive);
                (node.object, node.crossing.primitive) = (object, primitive);
                index = node.next;
                if index == u32::MAX {
                    node.next = self.last;
                }
            }
        });
        if list != Self::EMPTY {
            self.last = list.last;
        }
    }

    /// Calls `see` with each node of the list, the last one first, once [all are
    /// finished](Self::finish_all). It may add no crossing.
    pub fn each(self, mut see: impl FnMut(&Node)) {
        GATHERED.with_borrow(|all| {
            let mut index = self.last;
            while let Some(node) = all.nodes.get(index as usize) {
                if !node.crossing.t.is_nan() {
                    see(node);
                }
                index = node.next;
            }
        });
    }
}

/// Computes in lanes where the eight triangles that wait are met.
struct LocateWaiting;

impl Kernel for LocateWaiting {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let waiting = GATHERED.with_borrow(|gathered| gathered.waiting);
        let located = waiting.pairs.locate(l, waiting.count);
        GATHERED.with_borrow_mut(|gathered| {
            gathered.waiting.count = 0;
            for (lane, (ray, corners, node)) in waiting.entries().enumerate() {
                let hit = if located.sound >> lane & 1 == 1 {
                    Some(TriangleHit::new(located.at(lane)))
                } else {
                    triangle::locate(&ray, corners, |doubtful| l.call(SettleExactly(doubtful)))
                };
                gathered.settle(&ray, node, hit);
            }
        });
    }
}

/// The state of a query for all crossings: see [the module](self).
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct All {
    list: CrossingList,
    limit: f32,
}

impl MeshQuery for All {
    type Found = CrossingList;
    const EDGES: EdgeRule = EdgeRule::Once;
    const NONE: CrossingList = CrossingList::EMPTY;

    #[inline(always)]
    fn new(limit: f32) -> Self {
        Self { list: CrossingList::EMPTY, limit }
    }

    #[inline(always)]
    fn visit_one<L: Lanes>(
        &mut self,
        l: L,
        ray: &MeshRay<'_>,
        (leaf, lane): (u32, usize),
        (low, high): (f32, f32),
        is_certain: bool,
    ) {
        if ray.limits.begin_after(high) {
            return;
        }
        let in_leaf = &ray.tree.leaves[leaf as usize];
        let triangle = ray.tree.triangle(in_leaf, lane);
        let copies = ray.tree.copies_of(triangle);
        if is_certain && ray.limits.begin_before(low) && copies.is_empty() {
            let triangle = (triangle.cast_signed(), leaf_lane(leaf, lane));
            self.list.push_certain(l, ray, triangle);
        } else if let Some(crossing) = ray.intersect(l, Self::EDGES, in_leaf, lane) {
            self.list.push(crossing);
            // Copies have the same corners in the same order.
            for &[_, copy] in copies {
                let primitive = copy.cast_signed();
                self.list.push(Crossing { primitive, ..crossing });
            }
        }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, _: L, _: &MeshRay<'_>, crossing: Crossing) {
        self.list.push(crossing);
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: L, _: &MeshRay<'_>) -> CrossingList {
        self.list
    }

    #[inline(always)]
    fn of_crossing(crossing: Option<Crossing>) -> CrossingList {
        let mut list = CrossingList::EMPTY;
        if let Some(crossing) = crossing {
            list.push(crossing);
        }
        list
    }
}

impl Visitor for All {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        visit_each(l, self, ray, (leaf, candidates.possible), candidates);
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}
