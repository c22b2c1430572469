//! One ray through the tree of a mesh.
//!
//! 1. At a node, test the ray against its sixteen boxes at once; continue with the nearest child,
//!    and put the others onto the stack, in order.
//! 2. At a leaf, test its sixteen triangles at once in float32 ([`filter`]); the query sees what is
//!    left.
//! 3. Take the next child from the stack that is not beyond the query's limit.
//!
//! Wald, Benthin and Boulos, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
//! Multi-branching BVHs", IEEE Symposium on Interactive Ray Tracing 2008. It departs in the leaves,
//! where float32 only rules out and float64 decides.

use super::mesh_packet::{MeshPacket, MeshRay};
use super::query::{MeshQuery, Visitor};
use super::stack::Stack;
use crate::accel::filter::filter;
use crate::accel::mesh_tree::MeshTree;
use crate::accel::node::LEAF;
use crate::accel::rays::packet::Packet;
use crate::geometry::Ray;
use crate::shape::Meshes;
use crate::shape::triangle::MeshFilter;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// Memory for traversals, to be used again.
#[derive(Debug)]
#[doc(hidden)]
pub struct Scratch {
    pub(super) stack: Stack,
    pub(super) packet: Box<Packet>,
}

impl Default for Scratch {
    fn default() -> Self {
        Self { stack: Stack::new(), packet: Box::default() }
    }
}

/// The answer of a query for `ray` and `mesh`, in the mesh's space. The tree has nodes, and the ray
/// is valid.
#[inline(always)]
#[doc(hidden)]
pub fn query_mesh<L: Lanes, Q: MeshQuery>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, Meshes<'_>),
    ray: &Ray,
) -> Q::Found {
    scratch.packet.put(0, ray);
    scratch.packet.prepare(l, tree, 1);
    query_prepared::<L, Q>(l, scratch, (tree, mesh))
}

/// Queries a mesh for a ray with a filter, where [`MeshTree::is_sharp_from`] holds.
#[inline(always)]
#[doc(hidden)]
pub fn query_mesh_filtered<L: Lanes, Q: MeshQuery>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, Meshes<'_>),
    (ray, filter): (&Ray, &MeshFilter),
) -> Q::Found {
    scratch.packet.put(0, ray);
    scratch.packet.set_filter(0, filter);
    scratch.packet.prepare_filtered(l, tree, 1);
    query_prepared::<L, Q>(l, scratch, (tree, mesh))
}

#[inline(always)]
fn query_prepared<L: Lanes, Q: MeshQuery>(
    l: L,
    scratch: &mut Scratch,
    (tree, mesh): (&MeshTree, Meshes<'_>),
) -> Q::Found {
    let Scratch { stack, packet, .. } = scratch;
    if packet.alive == 0 {
        return Q::NONE;
    }
    let ray = MeshPacket::new(tree, mesh, packet).ray(0);
    let mut query = Q::new(ray.limits.t_max_high);
    traverse(l, stack, &ray, &mut query);
    query.finish(l, &ray)
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
            let index = index & !LEAF;
            let leaf = &tree.leaves[index as usize];
            if let Some(mut candidates) = filter(l, &tree_ray, leaf, visitor.limit()) {
                candidates.possible = tree.present(index, candidates.possible);
                visitor.visit(l, ray, index, &candidates);
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
