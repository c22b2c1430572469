//! Every triangle that a ray may meet, for rays that no query traverses.
//!
//! 1. A ray ahead of its origin goes through the tree as it is.
//! 2. One that begins behind its origin goes through it from a little before its beginning.
//! 3. One that is too far away for float64 is moved to the tree first (`distant.rs`).
//! 4. Where that leaves open where the ray is, every triangle of the mesh is asked.

use super::distant::Approach;
use super::mesh_packet::{MeshPacket, MeshRay};
use super::query::Visitor;
use super::single::{Scratch, traverse};
use crate::accel::filter::Candidates;
use crate::accel::mesh_tree::MeshTree;
use crate::geometry::Ray;
use crate::shape::Meshes;
use crate::shape::triangle::clear_of;
use crate::simd::{Kernel, Lanes, set_bits};

/// Returned in place of a `t_max` to end a traversal.
#[doc(hidden)]
pub const END: f64 = f64::NEG_INFINITY;

/// A function of a triangle and a `t_max` that returns the `t_max` to continue with: not larger
/// than before, or [`END`].
pub(crate) type Visit<'a> = dyn FnMut(u32, f64) -> f64 + Send + 'a;

/// A kernel that calls `visit` with each triangle that a ray, or one displaced from it by up to
/// `off`, may meet at a parameter of at most `t_max`, in any order, and perhaps with others.
///
/// The lowest of triangles in one place is among them. The others are for sure only `with_copies`.
///
/// `visit` is behind a pointer, so that the kernel is compiled once and not for each query: few
/// rays need it.
#[doc(hidden)]
pub struct EachCandidate<'a> {
    pub scratch: &'a mut Scratch,
    pub at_mesh: (&'a MeshTree, Meshes<'a>),
    pub ray: &'a Ray,
    pub off: f64,
    pub with_copies: bool,
    pub visit: &'a mut Visit<'a>,
}

impl Kernel for EachCandidate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { scratch, at_mesh: (tree, mesh), ray, off, with_copies, visit } = self;
        // In units of the tree.
        let unsure = off * tree.space.scale;
        let at_mesh = (tree, mesh);
        let approach = if !tree.has_nodes() {
            Approach::Somewhere
        } else if tree.is_distant(ray.origin) || ray.t_min == f64::NEG_INFINITY {
            Approach::new(&tree.space, ray)
        } else if ray.t_min >= 0.0 {
            return each_ahead(l, scratch, at_mesh, (ray, unsure, with_copies), visit);
        } else {
            // Begin a little earlier: the place at `t_min` is rounded twice, by a product and a
            // sum.
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
                let off = rounding * tree.space.scale + unsure;
                let mut visit = |triangle, _| {
                    let t_max = visit(triangle, ray.t_max);
                    if t_max == END { END } else { after(t_max) }
                };
                let ahead = (&ahead, off, with_copies);
                return each_ahead(l, scratch, at_mesh, ahead, &mut visit);
            }
        };
        match approach {
            Approach::Past => {}
            Approach::Near(near, off) => {
                let mut visit = |triangle, _| {
                    let is_over = visit(triangle, ray.t_max) == END;
                    if is_over { END } else { f64::INFINITY }
                };
                let near = (&near, off + unsure, with_copies);
                each_ahead(l, scratch, at_mesh, near, &mut visit);
            }
            Approach::Somewhere => {
                let mut t_max = ray.t_max;
                for &triangle in tree.all_present().iter() {
                    t_max = visit(triangle, t_max);
                    if t_max == END {
                        return;
                    }
                }
            }
        }
    }
}

/// [`EachCandidate`] for a ray that is not distant, and may be `off` across its direction, in units
/// of the tree.
#[inline(always)]
fn each_ahead<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    at_mesh: (&MeshTree, Meshes<'_>),
    (ray, off, with_copies): (&Ray, f64, bool),
    visit: &mut Visit<'_>,
) {
    l.call(EachAhead { scratch, at_mesh, ray, off, with_copies, visit });
}

/// A function of its own for [`each_ahead`], which has it three times.
struct EachAhead<'a> {
    scratch: &'a mut Scratch,
    at_mesh: (&'a MeshTree, Meshes<'a>),
    ray: &'a Ray,
    off: f64,
    with_copies: bool,
    visit: &'a mut Visit<'a>,
}

impl Kernel for EachAhead<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let (tree, mesh) = self.at_mesh;
        let Scratch { stack, packet, .. } = self.scratch;
        packet.put(0, self.ray);
        packet.prepare_blurred(l, tree, 1, self.off);
        if packet.alive != 0 {
            let in_tree = MeshPacket::new(tree, mesh, packet).ray(0);
            let mut each = Each {
                call: self.visit,
                with_copies: self.with_copies,
                t_max: self.ray.t_max,
                limit: in_tree.limits.t_max_high,
            };
            traverse(l, stack, &in_tree, &mut each);
        }
    }
}

/// Calls a function with each candidate; see [`EachCandidate`].
struct Each<'a> {
    call: &'a mut Visit<'a>,
    /// Whether triangles in the place of others are wanted too.
    with_copies: bool,
    t_max: f64,
    limit: f32,
}

impl Visitor for Each<'_> {
    #[inline(always)]
    fn visit<L: Lanes>(&mut self, _: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        let leaf = &ray.tree.leaves[leaf as usize];
        for lane in set_bits(candidates.possible) {
            let triangle = ray.tree.triangle(leaf, lane);
            self.t_max = (self.call)(triangle, self.t_max);
            if self.with_copies {
                for &[_, copy] in ray.tree.copies_of(triangle) {
                    self.t_max = (self.call)(copy, self.t_max);
                }
            }
            if self.t_max < 0.0 {
                self.limit = -1.0;
                return;
            }
            self.limit = ray.packet.depth_above(ray.lane, self.t_max);
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}
