//! One ray through the tree of a mesh.
//!
//! 1. At a node, test the ray against its sixteen boxes at once; go on with the nearest child, and put the others onto
//!    the stack, in order.
//! 2. At a leaf, test its sixteen triangles at once in float32 ([`filter`]); the query sees what is left.
//! 3. Take the next child from the stack that is not beyond the query's limit.
//!
//! Wald, Benthin and Boulos, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using Multi-branching BVHs",
//! IEEE Symposium on Interactive Ray Tracing 2008. It departs in the leaves, where float32 only rules out and float64
//! decides.

use super::distant::Approach;
use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor};
use super::stack::Stack;
use super::visit::Each;
use crate::accel::filter::filter;
use crate::accel::mesh_tree::MeshTree;
use crate::accel::node::LEAF;
use crate::accel::rays::packet::Packet;
use crate::geometry::Ray;
use crate::shape::Mesh;
use crate::shape::triangle::clear_of;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// Memory for traversals, to be used again.
#[derive(Debug)]
pub(crate) struct Scratch {
    stack: Stack,
    packet: Box<Packet>,
}

impl Scratch {
    pub(crate) fn new() -> Self {
        Self {
            stack: Stack::new(),
            packet: Box::default(),
        }
    }
}

/// The answer of a query for `ray` and `mesh`, in the mesh's space. The tree has nodes, and the ray is valid.
#[inline(always)]
pub(crate) fn ask<L: Lanes, Q: MeshQuery>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    ray: &Ray,
) -> Q::Found {
    let Scratch { stack, packet, .. } = scratch;
    packet.put(0, ray);
    packet.prepare(l, tree, 1);
    if packet.alive == 0 {
        return Q::NONE;
    }
    let ray = MeshRay {
        tree,
        mesh,
        packet,
        lane: 0,
    };
    let mut query = Q::new(packet.limits(0));
    traverse(l, stack, &ray, &mut query);
    query.finish(l, &ray)
}

/// What ends a traversal, in place of a `t_max`.
pub(crate) const END: f64 = f64::NEG_INFINITY;

/// Calls `visit(triangle, t_max)` with each triangle that `ray` may meet at a parameter of at most `t_max`, in any
/// order, and perhaps with others. `visit` returns the `t_max` to go on with, not larger than before, or [`END`].
///
/// Of triangles in one place the lowest is among them. The others are too `with_copies`, and may be without.
#[inline(always)]
pub(crate) fn each<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    (ray, with_copies): (&Ray, bool),
    visit: impl FnMut(u32, f64) -> f64,
) {
    let approach = if !tree.has_nodes() {
        Approach::Somewhere
    } else if tree.is_distant(ray.origin) || ray.t_min == f64::NEG_INFINITY {
        Approach::new(&tree.space, ray)
    } else if ray.t_min >= 0.0 {
        return each_ahead(l, scratch, (tree, mesh), (ray, 0.0, with_copies), visit);
    } else {
        // Begin a little earlier: the place at `t_min` is rounded twice, by a product and a sum.
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
            let ahead = (&ahead, off, with_copies);
            return each_ahead(l, scratch, (tree, mesh), ahead, |triangle, _| {
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
            each_ahead(l, scratch, (tree, mesh), (&near, off, with_copies), visit);
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

/// [`each`] for a ray that is not distant, and may be `off` across its direction, in units of the tree.
#[inline(always)]
fn each_ahead<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, &Mesh),
    (ray, off, with_copies): (&Ray, f64, bool),
    visit: impl FnMut(u32, f64) -> f64,
) {
    let Scratch { stack, packet, .. } = scratch;
    packet.put(0, ray);
    packet.prepare_blurred(l, tree, 1, off);
    if packet.alive != 0 {
        let mut each = Each {
            call: visit,
            with_copies,
            t_max: ray.t_max,
            limit: packet.limits(0).t_max_high,
        };
        let ray = MeshRay {
            tree,
            mesh,
            packet,
            lane: 0,
        };
        traverse(l, stack, &ray, &mut each);
    }
}

/// Shows the leaves that a ray may meet to a visitor; see [the module](self).
#[inline(always)]
pub(super) fn traverse<L: Lanes, V: Visitor>(
    l: L,
    stack: &mut Stack,
    ray: &MeshRay<'_>,
    visitor: &mut V,
) {
    let tree = ray.tree;
    let tree_ray = ray.packet.tree_ray(ray.lane);
    stack.clear();
    let mut index = 0_u32;
    loop {
        if index & LEAF == 0 {
            let node = &tree.nodes[index as usize];
            let (mut met, entry) = tree_ray.boxes(l, node, visitor.limit());
            if met.is_power_of_two() || (met != 0 && !V::ORDERED) {
                // The next one is known: the entry depths need not be stored and sorted.
                index = node.children[met.trailing_zeros() as usize % LANES];
                met &= met - 1;
                for child in set_bits(met) {
                    stack.push(u64::from(node.children[child]));
                }
                continue;
            }
            let mut entries = Aligned([0.0; LANES]);
            l.store(entry, &mut entries.0);
            let base = stack.len();
            for child in set_bits(met) {
                let key =
                    u64::from(entries.0[child].to_bits()) << 32 | u64::from(node.children[child]);
                stack.insert(base, key);
            }
        } else {
            let leaf = &tree.leaves[(index & !LEAF) as usize];
            if let Some(candidates) = filter(l, &tree_ray, leaf, visitor.limit()) {
                visitor.visit(l, ray, index & !LEAF, &candidates);
            }
        }
        let Some((_, next)) = stack.pop_within(visitor.limit()) else {
            return;
        };
        index = next;
        if let Some(next) = stack.top() {
            prefetch(l, tree, next);
        }
    }
}

/// Asks memory for the child of a stack's entry.
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
