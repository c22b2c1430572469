//! One ray through a [`MeshTree`]: the one traversal for the first hit, for any hit and for all.
//!
//! Wald, Benthin and Boulos, "Getting Rid of Packets" (2008): a ray against all boxes of a wide node at once,
//! children nearest first. It departs in the leaves, where float32 rules out and float64 decides: what is
//! met for certain at a depth that no other candidate can have is not even computed before the end.

use super::filter::{Candidates, filter};
use super::mesh_tree::MeshTree;
use super::meshlet::Meshlet;
use super::ray::TreeRay;
use super::tile::Known;
use super::wide::LEAF;
use crate::geometry::Ray;
use crate::shape::triangle::{Shear, TriangleHit};
use crate::shape::{Crossing, Mesh};
use crate::simd::{Aligned, LANES, Lanes};

/// Memory for traversals, to be used again.
#[derive(Debug)]
pub(crate) struct Scratch {
    pub(super) stack: Stack,
    pub(super) known: Box<Known>,
}

impl Scratch {
    /// With its memory.
    pub(crate) fn new() -> Self {
        Self {
            stack: Stack {
                entries: vec![0; STACK].try_into().expect("it has that length"),
                height: 0,
            },
            known: Box::default(),
        }
    }
}

/// Nodes and leaves still to be visited: the depth's bits above the index.
#[derive(Debug)]
pub(super) struct Stack {
    entries: Box<[u64; STACK]>,
    height: usize,
}

/// A power of two. A tree has no more levels than the binary one it is made from, which are at most 97 (see
/// `build.rs`), and each leaves up to 15 behind.
const STACK: usize = 2048;

impl Stack {
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
        self.entries[self.height % STACK] = key;
        self.height += 1;
    }

    /// Puts `key` among those from `base` on, the smallest on top.
    #[inline(always)]
    pub(super) fn insert(&mut self, base: usize, key: u64) {
        let mut at = self.height;
        while at > base && self.entries[(at - 1) % STACK] < key {
            self.entries[at % STACK] = self.entries[(at - 1) % STACK];
            at -= 1;
        }
        self.entries[at % STACK] = key;
        self.height += 1;
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<u64> {
        self.height = self.height.checked_sub(1)?;
        Some(self.entries[self.height % STACK])
    }

    #[inline(always)]
    pub(super) fn top(&self) -> Option<u64> {
        Some(self.entries[self.height.checked_sub(1)? % STACK])
    }
}

/// What to do with a leaf's candidates.
trait Goal<L: Lanes> {
    /// Whether it matters which candidates come first.
    const ORDERED: bool = true;
    /// Takes note of them.
    fn meet(&mut self, l: L, place: &Place<'_>, leaf: u32, candidates: &Candidates<L>);
    /// The depth beyond which nothing matters any more; negative to end.
    fn limit(&self) -> f32;
}

/// What a traversal works with.
struct Place<'a> {
    tree: &'a MeshTree,
    mesh: &'a Mesh,
    ray: &'a TreeRay,
}

impl Place<'_> {
    /// The judge's word about a triangle.
    #[inline(always)]
    fn decide(&self, leaf: &Meshlet, lane: usize) -> Option<TriangleHit> {
        let corners = self.tree.corners(self.mesh, leaf, lane);
        let hit = self.ray.shear.intersect_ahead(corners)?;
        (hit.t > 0.0 && hit.t <= self.ray.ray.t_max).then_some(hit)
    }

    #[inline(always)]
    fn crossing(&self, leaf: &Meshlet, lane: usize, hit: TriangleHit) -> Crossing {
        hit.crossing(self.tree.triangle(leaf, lane).cast_signed())
    }
}

/// The first hit of `ray` in `mesh`, in the mesh's space: the smallest `t`, at the same `t` the lowest triangle.
#[inline(always)]
pub(crate) fn first<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    ray: &Ray,
) -> Option<Crossing> {
    let shear = Shear::new(ray);
    if tree.nodes.is_empty() {
        // Float32 holds nothing of this mesh, or there is nothing.
        return mesh.first_crossing(ray, &shear);
    }
    let tree_ray = TreeRay::new(tree, ray, &shear)?;
    let place = Place {
        tree,
        mesh,
        ray: &tree_ray,
    };
    let mut first = First {
        best: Best::None,
        limit: place.ray.depth_above(ray.t_max),
        within: place.ray.depth_below(ray.t_max),
    };
    traverse(l, &mut scratch.stack, &place, &mut first);
    first.best.decided(&place)
}

/// Whether `ray` hits anything in `mesh`, in the mesh's space.
#[inline(always)]
pub(crate) fn any<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    ray: &Ray,
) -> bool {
    let shear = Shear::new(ray);
    if tree.nodes.is_empty() {
        return mesh.first_crossing(ray, &shear).is_some();
    }
    let Some(tree_ray) = TreeRay::new(tree, ray, &shear) else {
        return false;
    };
    let place = Place {
        tree,
        mesh,
        ray: &tree_ray,
    };
    let mut any = Any {
        is_found: false,
        limit: place.ray.depth_above(ray.t_max),
        within: place.ray.depth_below(ray.t_max),
    };
    traverse(l, &mut scratch.stack, &place, &mut any);
    any.is_found
}

/// Calls `visit(triangle, t_max)` with each triangle that `ray` may meet at a parameter of at most `t_max`, in
/// any order. `visit` returns the `t_max` to go on with, not larger than before; any negative number ends
/// the search.
#[inline(always)]
pub(crate) fn each<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    ray: &Ray,
    visit: impl FnMut(u32, f64) -> f64,
) {
    let shear = Shear::new(ray);
    let mut each = Each {
        visit,
        t_max: ray.t_max,
        limit: f32::INFINITY,
    };
    if tree.nodes.is_empty() {
        for &triangle in &tree.order {
            each.t_max = (each.visit)(triangle, each.t_max);
            if each.t_max < 0.0 {
                return;
            }
        }
    } else if let Some(ray) = TreeRay::new(tree, ray, &shear) {
        each.limit = ray.depth_above(each.t_max);
        let place = Place {
            tree,
            mesh,
            ray: &ray,
        };
        traverse(l, &mut scratch.stack, &place, &mut each);
    }
}

#[inline(always)]
fn traverse<L: Lanes, G: Goal<L>>(l: L, stack: &mut Stack, place: &Place<'_>, goal: &mut G) {
    let tree = place.tree;
    stack.clear();
    let mut index = 0_u32;
    loop {
        if index & LEAF == 0 {
            let node = &tree.nodes[index as usize];
            let (mut met, entry) = place.ray.boxes(l, node, goal.limit());
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
            if let Some(candidates) = filter(l, place.ray, leaf, goal.limit()) {
                goal.meet(l, place, index & !LEAF, &candidates);
            }
        }
        loop {
            let Some(key) = stack.pop() else {
                return;
            };
            if f32::from_bits((key >> 32) as u32) <= goal.limit() {
                #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
                let next = key as u32;
                index = next;
                break;
            }
        }
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

/// The first hit so far.
enum Best {
    None,
    /// Met for certain, between two depths; float64 has yet to say where.
    Pending {
        leaf: u32,
        lane: usize,
        low: f32,
        high: f32,
    },
    Decided {
        crossing: Crossing,
        low: f32,
        high: f32,
    },
}

impl Best {
    #[inline(always)]
    fn decided(&self, place: &Place<'_>) -> Option<Crossing> {
        match *self {
            Self::None => None,
            Self::Decided { crossing, .. } => Some(crossing),
            Self::Pending { leaf, lane, .. } => {
                let leaf = &place.tree.leaves[leaf as usize];
                place
                    .decide(leaf, lane)
                    .map(|hit| place.crossing(leaf, lane, hit))
            }
        }
    }
}

struct First {
    best: Best,
    limit: f32,
    /// The depth up to which a hit is within the ray's `t_max` for certain.
    within: f32,
}

impl First {
    /// Lets float64 decide between the best so far and a candidate.
    #[inline(always)]
    fn compare(&mut self, place: &Place<'_>, leaf: u32, lane: usize) {
        let leaf = &place.tree.leaves[leaf as usize];
        let Some(hit) = place.decide(leaf, lane) else {
            return;
        };
        let new = place.crossing(leaf, lane, hit);
        let old = self.best.decided(place);
        let is_first = |old: Crossing| (new.t, new.primitive) < (old.t, old.primitive);
        let crossing = match old {
            Some(old) if !is_first(old) => old,
            _ => new,
        };
        let low = place.ray.depth_below(crossing.t);
        let high = place.ray.depth_above(crossing.t);
        self.best = Best::Decided {
            crossing,
            low,
            high,
        };
        self.limit = self.limit.min(high);
    }
}

impl<L: Lanes> Goal<L> for First {
    #[inline(always)]
    fn meet(&mut self, l: L, place: &Place<'_>, leaf: u32, candidates: &Candidates<L>) {
        let mut lows = Aligned([0.0; LANES]);
        let mut highs = lows;
        l.store(candidates.low, &mut lows.0);
        l.store(candidates.high, &mut highs.0);
        let mut possible = candidates.possible;
        while possible != 0 {
            let lane = possible.trailing_zeros() as usize;
            possible &= possible - 1;
            let (low, high) = (lows.0[lane], highs.0[lane]);
            let (best_low, best_high) = match self.best {
                Best::None => (self.within, f32::INFINITY),
                Best::Pending { low, high, .. } | Best::Decided { low, high, .. } => (low, high),
            };
            if low > best_high {
                continue;
            }
            let is_certain = candidates.certain >> lane & 1 == 1;
            if is_certain && low > 0.0 && high < best_low {
                self.best = Best::Pending {
                    leaf,
                    lane,
                    low,
                    high,
                };
                self.limit = self.limit.min(high);
            } else {
                self.compare(place, leaf, lane);
            }
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}

struct Any {
    is_found: bool,
    limit: f32,
    within: f32,
}

impl<L: Lanes> Goal<L> for Any {
    const ORDERED: bool = false;

    #[inline(always)]
    fn meet(&mut self, l: L, place: &Place<'_>, leaf: u32, candidates: &Candidates<L>) {
        let inside =
            l.lt(l.splat(0.0), candidates.low) & l.lt(candidates.high, l.splat(self.within));
        let leaf = &place.tree.leaves[leaf as usize];
        let mut possible = candidates.possible;
        // Where it is met for certain, nobody wants to know the place.
        self.is_found = possible & candidates.certain & inside != 0;
        while possible != 0 && !self.is_found {
            let lane = possible.trailing_zeros() as usize;
            possible &= possible - 1;
            self.is_found = place.decide(leaf, lane).is_some();
        }
        if self.is_found {
            self.limit = -1.0;
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}

/// Every candidate, for whoever visits.
struct Each<V> {
    visit: V,
    t_max: f64,
    limit: f32,
}

impl<L: Lanes, V: FnMut(u32, f64) -> f64> Goal<L> for Each<V> {
    #[inline(always)]
    fn meet(&mut self, _: L, place: &Place<'_>, leaf: u32, candidates: &Candidates<L>) {
        let leaf = &place.tree.leaves[leaf as usize];
        let mut possible = candidates.possible;
        while possible != 0 {
            let lane = possible.trailing_zeros() as usize;
            possible &= possible - 1;
            self.t_max = (self.visit)(place.tree.triangle(leaf, lane), self.t_max);
            if self.t_max < 0.0 {
                self.limit = -1.0;
                return;
            }
            self.limit = place.ray.depth_above(self.t_max);
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}
