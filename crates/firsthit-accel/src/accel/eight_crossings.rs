//! Computes the crossings of eight rays with eight triangles that they are known to meet, in
//! float64 lanes.
//!
//! 1. Gather the triangles' corners from the leaves of the tree, or where float32 does not hold
//!    them from the mesh ([`Corners`]).
//! 2. Compute `t` and the weights in lanes, by the code of `shape/triangle/place.rs`: the bits are
//!    those of the exact test.
//! 3. Where that says that float64 is not enough for a lane, compute it in twice the digits, in
//!    lanes too.
//! 4. Leave the lanes for which that is not enough to the caller, who takes `shape/triangle.rs`.
//!
//! Where many rays meet one triangle ([`SharedTriangle`]), the numbers that depend on the triangle
//! alone are computed once.

#![expect(
    clippy::needless_range_loop,
    reason = "for chains of iterators the compiler copies registers to memory"
)]

use super::mesh_tree::MeshTree;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::{DVec3, arrays};
use crate::shape::Meshes;
use crate::shape::triangle::{Plain, PlainStart, Plane, Start};
use crate::simd::{Aligned, InLanes, Kernel, LANES, Lanes, WIDE};

/// Eight rays, in the space of a mesh.
#[doc(hidden)]
pub struct RayBundle<L: Lanes> {
    pub origin: [L::Doubles; 3],
    pub direction: [L::Doubles; 3],
}

/// The corners of sixteen triangles in lanes, corner by corner and axis by axis.
#[expect(clippy::large_enum_variant, reason = "it lives for a block, on the stack")]
#[doc(hidden)]
pub enum Corners {
    /// Corners in the tree's space, with the unit of that space, and its origin where that is not
    /// the mesh's.
    Scaled(CornerLanes<[f32; LANES]>, f64, Option<[f64; 3]>),
    /// Corners in the mesh's space, in two halves.
    Whole(CornerLanes<[[f64; WIDE]; 2]>),
}

/// Three corners of three coordinates.
type CornerLanes<T> = Aligned<[[T; 3]; 3]>;

impl Corners {
    /// The corners of the triangles in `leaf_lanes` (as bits), in the lanes `wanted`; anything in
    /// the others. The triangles' indices (as bits) go into the same lanes of `triangles`.
    #[inline(always)]
    pub fn new<L: Lanes>(
        l: L,
        (tree, mesh): (&MeshTree, Meshes<'_>),
        (leaf_lanes, wanted): (&[f32; LANES], u16),
        triangles: &mut [f32; LANES],
    ) -> Self {
        if tree.is_exact {
            Self::scaled(l, tree, (leaf_lanes, wanted), triangles)
        } else {
            Self::whole(tree, mesh, (leaf_lanes, wanted), triangles)
        }
    }

    /// Takes the corners from the leaves, which are in the cache. Neighbours mostly meet triangles
    /// of the same one or two leaves.
    #[inline(always)]
    fn scaled<L: Lanes>(
        l: L,
        tree: &MeshTree,
        (leaf_lanes, wanted): (&[f32; LANES], u16),
        triangles: &mut [f32; LANES],
    ) -> Self {
        let all = l.load(leaf_lanes);
        let mut indices = l.load(triangles);
        let mut corners = [[l.splat(0.0); 3]; 3];
        let mut left = wanted;
        while left != 0 {
            let leaf_lane = leaf_lanes[left.trailing_zeros() as usize % LANES];
            // Lanes that are not wanted may have the same number in another tree.
            let here = wanted & l.same_sixteen(all, l.splat(leaf_lane));
            left &= !here;
            let leaf = &tree.leaves[leaf_lane.to_bits() as usize / LANES];
            let of_leaf = l.permute_by(tree.triangles_of(l, leaf), all);
            indices = l.select(here, of_leaf, indices);
            for corner in 0..3 {
                let vertices = l.permute_by(l.load_places(&leaf.corners[corner]), all);
                for axis in 0..3 {
                    let along = l.load(&leaf.vertices[axis]);
                    let lanes = &mut corners[corner][axis];
                    *lanes = l.select(here, l.permute_by(along, vertices), *lanes);
                }
            }
        }
        l.store(indices, triangles);
        let mut out = Aligned([[[0.0; LANES]; 3]; 3]);
        for corner in 0..3 {
            for axis in 0..3 {
                l.store(corners[corner][axis], &mut out.0[corner][axis]);
            }
        }
        let origin = tree.space.origin.to_array();
        let is_elsewhere = tree.space.origin != DVec3::ZERO;
        Self::Scaled(out, tree.space.unscale, is_elsewhere.then_some(origin))
    }

    /// Takes the corners from the mesh, one by one.
    #[inline(always)]
    fn whole(
        tree: &MeshTree,
        mesh: Meshes<'_>,
        (leaf_lanes, wanted): (&[f32; LANES], u16),
        triangles: &mut [f32; LANES],
    ) -> Self {
        let mut out = Aligned([[[[0.0; WIDE]; 2]; 3]; 3]);
        let mut left = wanted;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let leaf_lane = leaf_lanes[lane].to_bits();
            triangles[lane] = f32::from_bits(tree.triangle_at(leaf_lane));
            let corners: [DVec3; 3] = tree.corners_at(mesh, leaf_lane);
            for (out, corner) in out.0.iter_mut().zip(corners) {
                for (axis, out) in out.iter_mut().enumerate() {
                    out[lane / WIDE][lane % WIDE] = corner[axis];
                }
            }
        }
        Self::Whole(out)
    }

    /// Eight of them in float64.
    #[inline(always)]
    fn half<L: Lanes>(&self, l: L, half: usize) -> [[L::Doubles; 3]; 3] {
        let mut out = [[l.splat64(0.0); 3]; 3];
        match self {
            // The unit is a power of two, so products are exact.
            Self::Scaled(corners, unscale, origin) => {
                let unscale = l.splat64(*unscale);
                for corner in 0..3 {
                    for axis in 0..3 {
                        let lanes =
                            l.load_widened(&corners.0[corner][axis].as_chunks().0[half % 2]);
                        out[corner][axis] = match origin {
                            None => l.mul64(lanes, unscale),
                            Some(origin) => {
                                l.fused_mul_add64(lanes, unscale, l.splat64(origin[axis]))
                            }
                        };
                    }
                }
            }
            Self::Whole(corners) => {
                for corner in 0..3 {
                    for axis in 0..3 {
                        out[corner][axis] = l.load64(&corners.0[corner][axis][half % 2]);
                    }
                }
            }
        }
        out
    }
}

/// `t` and the weights of the corners 1 and 2, and the lanes in which they are those of the exact
/// test. In the others, which are few, the exact test itself is needed.
#[inline(always)]
pub fn eight_crossings<L: Lanes>(
    l: L,
    rays: &RayBundle<L>,
    corners: &Corners,
    half: usize,
    wanted: u8,
) -> (u8, [L::Doubles; 3]) {
    eight_crossings_at(l, rays, &corners.half(l, half), wanted)
}

/// [`eight_crossings`] with the corners in lanes.
#[inline(always)]
pub(super) fn eight_crossings_at<L: Lanes>(
    l: L,
    rays: &RayBundle<L>,
    corners: &[[L::Doubles; 3]; 3],
    wanted: u8,
) -> (u8, [L::Doubles; 3]) {
    let a = InLanes(l);
    let triangles = Plain::new(a, corners);
    let (enough, start) = triangles.seen_from(a, &rays.origin);
    let crossing = triangles.place(a, &start, &rays.direction);
    let (sound, crossing) = if enough & wanted == wanted {
        (enough, crossing)
    } else {
        in_double(l, rays, corners, (enough, crossing))
    };
    (sound & ahead(l, crossing[0]), crossing)
}

/// The lanes whose `t` is positive and finite.
#[inline(always)]
fn ahead<L: Lanes>(l: L, t: L::Doubles) -> u8 {
    l.lt64(l.splat64(0.0), t) & l.lt64(t, l.splat64(f64::INFINITY))
}

/// The lanes that are not `sound` in twice the digits.
#[inline(always)]
fn in_double<L: Lanes>(
    l: L,
    rays: &RayBundle<L>,
    [a, b, c]: &[[L::Doubles; 3]; 3],
    (sound, crossing): (u8, [L::Doubles; 3]),
) -> (u8, [L::Doubles; 3]) {
    let mut numbers = Aligned([[0.0; WIDE]; 15]);
    let vectors = [&rays.origin, &rays.direction, a, b, c];
    for k in 0..15 {
        l.store64(vectors[k / 3][k % 3], &mut numbers.0[k]);
    }
    let (more, precise) = l.call(InDouble(&numbers.0));
    let mut out = crossing;
    for k in 0..3 {
        out[k] = l.select64(sound, crossing[k], l.load64(&precise.0[k]));
    }
    (sound | more, out)
}

/// Steps 3 and 4, in a function of its own, which is rarely called.
struct InDouble<'a>(&'a [[f64; WIDE]; 15]);

impl Kernel for InDouble<'_> {
    type Output = (u8, Aligned<[[f64; WIDE]; 3]>);

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Self::Output {
        let a = InLanes(l);
        let zero = l.splat64(0.0);
        let mut vectors = [[zero; 3]; 5];
        for k in 0..15 {
            vectors[k / 3][k % 3] = l.load64(&self.0[k]);
        }
        let [origin, direction, corners @ ..] = vectors;
        let planes = Plane::new(a, &corners);
        let (of_start, start) = planes.seen_from(a, &origin);
        let (of_crossing, crossing) = planes.place(a, &start, &direction);
        let mut out = Aligned([[0.0; WIDE]; 3]);
        for k in 0..3 {
            l.store64(crossing[k], &mut out.0[k]);
        }
        (of_start & of_crossing, out)
    }
}

/// A triangle that many rays meet, one after the other.
#[derive(Debug)]
#[doc(hidden)]
pub struct SharedTriangle {
    leaf_lane: u32,
    triangle: u32,
    plain: Plain<f64>,
    plane: Plane<f64>,
    /// The origin of the first ray. Most others start there too.
    origin: [f64; 3],
    /// The triangle from there, and whether plain float64 is enough.
    plain_start: (bool, PlainStart<f64>),
    /// The triangle from there in double-double.
    start: (bool, Start<f64>),
}

impl SharedTriangle {
    #[inline(always)]
    pub fn new<L: Lanes>(
        l: L,
        (tree, mesh): (&MeshTree, Meshes<'_>),
        leaf_lane: u32,
        rays: &RayBundle<L>,
    ) -> Self {
        let corners = tree.corners_at(mesh, leaf_lane);
        let corners = arrays::map(corners, |corner| corner.to_array());
        let mut origin = [0.0; 3];
        for (axis, first) in origin.iter_mut().enumerate() {
            let mut lanes = [0.0; WIDE];
            l.store64(rays.origin[axis], &mut lanes);
            *first = lanes[0];
        }
        let plain = Plain::new(Scalar, &corners);
        let plane = Plane::new(Scalar, &corners);
        Self {
            leaf_lane,
            triangle: tree.triangle_at(leaf_lane),
            plain_start: plain.seen_from(Scalar, &origin),
            start: plane.seen_from(Scalar, &origin),
            plain,
            plane,
            origin,
        }
    }

    #[inline(always)]
    pub fn is(&self, leaf_lane: u32) -> bool {
        self.leaf_lane == leaf_lane
    }

    #[inline(always)]
    pub fn triangle(&self) -> u32 {
        self.triangle
    }

    /// As [`eight_crossings`]. All lanes take the same arithmetic, or none is sound.
    #[inline(always)]
    pub fn eight_crossings<L: Lanes>(&self, l: L, rays: &RayBundle<L>) -> (u8, [L::Doubles; 3]) {
        let a = InLanes(l);
        let mut same = u8::MAX;
        for axis in 0..3 {
            let first = l.splat64(self.origin[axis]);
            same &= l.le64(first, rays.origin[axis]) & l.le64(rays.origin[axis], first);
        }
        let is_same = same == u8::MAX;
        let (enough, plain_start) = if is_same {
            (if self.plain_start.0 { u8::MAX } else { 0 }, self.plain_start.1.splat(a))
        } else {
            self.plain.splat(a).seen_from(a, &rays.origin)
        };
        if enough == u8::MAX {
            let crossing = self.plain.splat(a).place(a, &plain_start, &rays.direction);
            return (ahead(l, crossing[0]), crossing);
        }
        let plane = self.plane.splat(a);
        let (of_start, start) = if is_same {
            (if self.start.0 { u8::MAX } else { 0 }, self.start.1.splat(a))
        } else {
            plane.seen_from(a, &rays.origin)
        };
        let (of_crossing, crossing) = plane.place(a, &start, &rays.direction);
        let sound = of_start & of_crossing & ahead(l, crossing[0]);
        // Where float64 is enough for some lanes, the exact test's bits there are those of float64.
        (if enough == 0 { sound } else { 0 }, crossing)
    }
}
