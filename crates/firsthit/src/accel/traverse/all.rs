//! All crossings: where does a ray cross the triangles of a mesh?
//!
//! 1. Drop a candidate that is before `t_min`, by its depths.
//! 2. For any other candidate the exact test decides, and says where. At an edge it takes one neighbour
//!    (`triangle/crossed.rs`).
//! 3. The copies of a triangle, which the tree leaves out, are tested likewise.
//!
//! The crossings of a ray are a list in memory of the thread's, in no order.

use std::cell::RefCell;

use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor};
use crate::accel::filter::Candidates;
use crate::accel::rays::limits::Limits;
use crate::shape::Crossing;
use crate::shape::triangle::EdgeRule;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// A crossing, the object that it is with, and the next one of its list.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) crossing: Crossing,
    pub(crate) object: u32,
    next: u32,
}

/// The crossings of the rays that a thread has at hand.
#[derive(Debug, Default)]
struct Gathered {
    nodes: Vec<Node>,
    is_full: bool,
}

thread_local! {
    static GATHERED: RefCell<Gathered> = const {
        RefCell::new(Gathered {
            nodes: Vec::new(),
            is_full: false,
        })
    };
}

/// A list of crossings in memory of this thread's, the last one first. It is valid until [`CrossingList::forget_all`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct CrossingList {
    last: u32,
}

impl CrossingList {
    pub(crate) const EMPTY: Self = Self { last: u32::MAX };

    /// Begins anew: no list of this thread is valid any more. Returns whether all crossings since the last time had room.
    pub(crate) fn forget_all() -> bool {
        GATHERED.with_borrow_mut(|gathered| {
            gathered.nodes.clear();
            !std::mem::take(&mut gathered.is_full)
        })
    }

    /// Adds a crossing. Without memory it is lost, which [`forget_all`](Self::forget_all) says.
    pub(crate) fn push(&mut self, crossing: Crossing, object: u32) {
        GATHERED.with_borrow_mut(|gathered| {
            let index = gathered.nodes.len();
            let has_room = gathered.nodes.try_reserve(1).is_ok();
            match u32::try_from(index) {
                Ok(index) if has_room && index < u32::MAX => {
                    gathered.nodes.push(Node {
                        crossing,
                        object,
                        next: self.last,
                    });
                    self.last = index;
                }
                _ => gathered.is_full = true,
            }
        });
    }

    /// The nodes of the list, the last one first.
    pub(crate) fn nodes(self) -> impl Iterator<Item = Node> {
        let at = |index: u32| GATHERED.with_borrow(|all| all.nodes.get(index as usize).copied());
        std::iter::successors(at(self.last), move |node| at(node.next))
    }
}

/// The state of a query for all crossings: see [the module](self).
pub(crate) struct All {
    list: CrossingList,
    limits: Limits,
}

impl MeshQuery for All {
    type Found = CrossingList;
    const EDGES: EdgeRule = EdgeRule::Once;
    const NONE: CrossingList = CrossingList::EMPTY;

    #[inline(always)]
    fn new(limits: Limits) -> Self {
        Self {
            list: CrossingList::EMPTY,
            limits,
        }
    }

    #[inline(always)]
    fn visit_one<L: Lanes>(
        &mut self,
        l: L,
        ray: &MeshRay<'_>,
        (leaf, lane): (u32, usize),
        (_, high): (f32, f32),
        _: bool,
    ) {
        if high < self.limits.t_min_low {
            return;
        }
        let leaf = &ray.tree.leaves[leaf as usize];
        if let Some(crossing) = ray.intersect(l, Self::EDGES, leaf, lane) {
            self.list.push(crossing, 0);
            // Copies have the same corners in the same order.
            for &[_, copy] in ray.tree.copies_of(ray.tree.triangle(leaf, lane)) {
                let primitive = copy.cast_signed();
                self.list.push(
                    Crossing {
                        primitive,
                        ..crossing
                    },
                    0,
                );
            }
        }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, _: L, _: &MeshRay<'_>, crossing: Crossing) {
        self.list.push(crossing, 0);
    }

    #[inline(always)]
    fn deferred(&self) -> Option<(u32, usize)> {
        None
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: L, _: &MeshRay<'_>) -> CrossingList {
        self.list
    }

    #[inline(always)]
    fn of_crossing(crossing: Option<Crossing>) -> CrossingList {
        let mut list = CrossingList::EMPTY;
        if let Some(crossing) = crossing {
            list.push(crossing, 0);
        }
        list
    }
}

impl Visitor for All {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        let mut highs = Aligned([0.0; LANES]);
        l.store(candidates.high, &mut highs.0);
        for lane in set_bits(candidates.possible) {
            let depths = (0.0, highs.0[lane]);
            self.visit_one(l, ray, (leaf, lane), depths, false);
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limits.t_max_high
    }
}
