//! One ray through a [`MeshTree`]: the one traversal for the first hit, for any hit and for all.
//!
//! Wald, Benthin and Boulos, "Getting Rid of Packets" (2008): a ray against all boxes of a wide node at once,
//! children nearest first. It departs in the leaves, where float32 rules out and float64 decides: what is
//! met for certain at a depth that no other candidate can have is not even computed before the end.

use super::filter::{Candidates, filter};
use super::mesh_tree::MeshTree;
use super::meshlet::Meshlet;
use super::ray::TreeRay;
use super::wide::LEAF;
use crate::geometry::Ray;
use crate::shape::triangle::{Shear, TriangleHit};
use crate::shape::{Crossing, Mesh};
use crate::simd::{LANES, Lanes};

/// Memory for traversals, to be used again.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// Nodes and leaves still to be visited: the depth's bits above the index.
    pub(super) stack: Vec<u64>,
}

/// What to do with a leaf's candidates.
trait Goal<L: Lanes> {
    /// Takes note of them.
    fn meet(&mut self, l: L, place: &Place<'_, L>, leaf: u32, candidates: &Candidates<L>);
    /// The depth beyond which nothing matters any more; negative to end.
    fn limit(&self) -> f32;
}

/// What a traversal works with.
struct Place<'a, L: Lanes> {
    tree: &'a MeshTree,
    mesh: &'a Mesh,
    ray: TreeRay<L>,
}

impl<L: Lanes> Place<'_, L> {
    /// The judge's word about a triangle.
    #[inline(always)]
    fn decide(&self, leaf: &Meshlet, lane: usize) -> Option<TriangleHit> {
        let corners = self.tree.corners(self.mesh, leaf, lane);
        let hit = self.ray.shear.intersect(corners)?;
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
        return without_tree(mesh, ray, &shear);
    }
    let place = Place {
        tree,
        mesh,
        ray: TreeRay::new(l, tree, ray, &shear)?,
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
        return without_tree(mesh, ray, &shear).is_some();
    }
    let Some(tree_ray) = TreeRay::new(l, tree, ray, &shear) else {
        return false;
    };
    let place = Place {
        tree,
        mesh,
        ray: tree_ray,
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
    } else if let Some(ray) = TreeRay::new(l, tree, ray, &shear) {
        each.limit = ray.depth_above(each.t_max);
        let place = Place { tree, mesh, ray };
        traverse(l, &mut scratch.stack, &place, &mut each);
    }
}

/// Float32 holds nothing of this mesh, or there is nothing.
#[cold]
fn without_tree(mesh: &Mesh, ray: &Ray, shear: &Shear) -> Option<Crossing> {
    let mut first: Option<Crossing> = None;
    for (triangle, primitive) in (0..mesh.triangles().len()).zip(0..) {
        if let Some(TriangleHit { t, barycentric }) = mesh.intersect_triangle(triangle, shear)
            && t > 0.0
            && t <= ray.t_max
            && first.is_none_or(|first| t < first.t)
        {
            first = Some(Crossing {
                t,
                primitive,
                barycentric,
            });
        }
    }
    first
}

#[inline(always)]
fn traverse<L: Lanes, G: Goal<L>>(l: L, stack: &mut Vec<u64>, place: &Place<'_, L>, goal: &mut G) {
    let tree = place.tree;
    stack.clear();
    let mut index = 0_u32;
    loop {
        if index & LEAF == 0 {
            let node = &tree.nodes[index as usize];
            let (mut met, entry) = place.ray.boxes(l, node, goal.limit());
            let mut entries = [0.0; LANES];
            l.store(entry, &mut entries);
            let base = stack.len();
            while met != 0 {
                let child = met.trailing_zeros() as usize;
                met &= met - 1;
                let key =
                    u64::from(entries[child].to_bits()) << 32 | u64::from(node.children[child]);
                // The farthest at the bottom.
                stack.push(key);
                let mut at = stack.len() - 1;
                while at > base && stack[at - 1] < key {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = key;
            }
        } else {
            let leaf = &tree.leaves[(index & !LEAF) as usize];
            if let Some(candidates) = filter(l, &place.ray, leaf, goal.limit()) {
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
        if let Some(&next) = stack.last() {
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
    fn decided<L: Lanes>(&self, place: &Place<'_, L>) -> Option<Crossing> {
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
    fn compare<L: Lanes>(&mut self, place: &Place<'_, L>, leaf: u32, lane: usize) {
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
    fn meet(&mut self, l: L, place: &Place<'_, L>, leaf: u32, candidates: &Candidates<L>) {
        let (mut lows, mut highs) = ([0.0; LANES], [0.0; LANES]);
        l.store(candidates.low, &mut lows);
        l.store(candidates.high, &mut highs);
        let mut possible = candidates.possible;
        while possible != 0 {
            let lane = possible.trailing_zeros() as usize;
            possible &= possible - 1;
            let (low, high) = (lows[lane], highs[lane]);
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
    #[inline(always)]
    fn meet(&mut self, l: L, place: &Place<'_, L>, leaf: u32, candidates: &Candidates<L>) {
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
    fn meet(&mut self, _: L, place: &Place<'_, L>, leaf: u32, candidates: &Candidates<L>) {
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
