//! The judge's last word for eight rays at once, each with a triangle that it is known to meet.
//!
//! Operation for operation what `shape/triangle.rs` does in one lane, so the bits are the same; what goes a way
//! of its own there (an axis unlike its neighbours', tiny triangles, `t` by cancellation) is left to it.

#![expect(
    clippy::needless_range_loop,
    reason = "of chains of iterators over registers the compiler makes copies in memory"
)]

use super::mesh_tree::MeshTree;
use crate::geometry::DVec3;
use crate::shape::Mesh;
use crate::shape::triangle::FAR;
use crate::simd::{Aligned, LANES, Lanes, WIDE};

/// Eight rays, in the space of a mesh, along [`axes`].
pub(crate) struct Pencil<L: Lanes> {
    pub(crate) origin: [L::Doubles; 3],
    pub(crate) direction: [L::Doubles; 3],
}

/// The order of the axes for rays that go mostly along the axis `z`: that one is the last.
pub(crate) fn axes(z: usize) -> [usize; 3] {
    [(z + 1) % 3, (z + 2) % 3, z]
}

/// The corners of sixteen triangles in lanes, corner by corner and axis by axis, along [`axes`].
#[expect(
    clippy::large_enum_variant,
    reason = "it lives for a block, on the stack"
)]
pub(crate) enum Corners {
    /// In units of the tree's space: what they are multiplied with, and where the tree's origin is, if not in that of
    /// the mesh.
    Scaled(Box3<[f32; LANES]>, f64, Option<[f64; 3]>),
    /// As they are, in two halves.
    Whole(Box3<[[f64; WIDE]; 2]>),
}

/// Three corners of three coordinates.
type Box3<T> = Aligned<[[T; 3]; 3]>;

impl Corners {
    /// Those of the triangles in `slots` (as bits), in the lanes of `wanted`; of others anything. The triangles' indices
    /// (as bits) go into the same lanes of `triangles`.
    #[inline(always)]
    pub(crate) fn new<L: Lanes>(
        l: L,
        (tree, mesh): (&MeshTree, &Mesh),
        axes: [usize; 3],
        (slots, wanted): (&[f32; LANES], u16),
        triangles: &mut [f32; LANES],
    ) -> Self {
        if tree.is_exact {
            Self::scaled(l, tree, axes, (slots, wanted), triangles)
        } else {
            Self::whole(tree, mesh, axes, (slots, wanted), triangles)
        }
    }

    /// From the leaves, which are in the cache: what neighbours meet is mostly in the same one or two.
    #[inline(always)]
    fn scaled<L: Lanes>(
        l: L,
        tree: &MeshTree,
        axes: [usize; 3],
        (slots, wanted): (&[f32; LANES], u16),
        triangles: &mut [f32; LANES],
    ) -> Self {
        let all = l.load(slots);
        let mut indices = l.load(triangles);
        let mut corners = [[l.splat(0.0); 3]; 3];
        let mut left = wanted;
        while left != 0 {
            let slot = slots[left.trailing_zeros() as usize % LANES];
            // Other lanes may be those of another tree, with the same number.
            let here = wanted & l.same_sixteen(all, l.splat(slot));
            left &= !here;
            let leaf = &tree.leaves[slot.to_bits() as usize / LANES];
            let of_leaf = l.permute_by(tree.triangles_of(l, leaf), all);
            indices = l.select(here, of_leaf, indices);
            for corner in 0..3 {
                let vertices = l.permute_by(l.load_places(&leaf.corners[corner]), all);
                for axis in 0..3 {
                    let along = l.load(&leaf.vertices[axes[axis] % 3]);
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
        let origin = axes.map(|axis| tree.space.origin[axis % 3]);
        let is_elsewhere = tree.space.origin != DVec3::ZERO;
        Self::Scaled(out, tree.space.unscale, is_elsewhere.then_some(origin))
    }

    /// From the mesh, one by one.
    #[inline(always)]
    fn whole(
        tree: &MeshTree,
        mesh: &Mesh,
        axes: [usize; 3],
        (slots, wanted): (&[f32; LANES], u16),
        triangles: &mut [f32; LANES],
    ) -> Self {
        let mut out = Aligned([[[[0.0; WIDE]; 2]; 3]; 3]);
        let mut left = wanted;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let slot = slots[lane].to_bits();
            triangles[lane] = f32::from_bits(tree.triangle_in(slot));
            let corners: [DVec3; 3] = tree.corners_in(mesh, slot);
            for (out, corner) in out.0.iter_mut().zip(corners) {
                for (out, axis) in out.iter_mut().zip(axes) {
                    out[lane / WIDE][lane % WIDE] = corner[axis % 3];
                }
            }
        }
        Self::Whole(out)
    }

    /// Eight of them in float64, relative to where rays start.
    #[inline(always)]
    fn half<L: Lanes>(&self, l: L, half: usize, start: &[L::Doubles; 3]) -> [[L::Doubles; 3]; 3] {
        let mut out = [*start; 3];
        match self {
            // The unit is a power of two, so products are exact, and fused or not the differences are the same.
            Self::Scaled(corners, unscale, origin) => {
                let unscale = l.splat64(*unscale);
                for corner in 0..3 {
                    for axis in 0..3 {
                        let lanes =
                            l.load_widened(&corners.0[corner][axis].as_chunks().0[half % 2]);
                        out[corner][axis] = match origin {
                            None => l.fused_mul_sub64(lanes, unscale, start[axis]),
                            Some(origin) => {
                                let minus = l.splat64(-origin[axis]);
                                let place = l.fused_mul_sub64(lanes, unscale, minus);
                                l.sub64(place, start[axis])
                            }
                        };
                    }
                }
            }
            Self::Whole(corners) => {
                for corner in 0..3 {
                    for axis in 0..3 {
                        let place = l.load64(&corners.0[corner][axis][half % 2]);
                        out[corner][axis] = l.sub64(place, start[axis]);
                    }
                }
            }
        }
        out
    }
}

/// `t` and the weights of corners 1 and 2, and in which lanes they are the judge's: those whose rays go mostly along
/// the axis `z`, and where nothing is special.
#[inline(always)]
pub(crate) fn verdict<L: Lanes>(
    l: L,
    z: usize,
    rays: &Pencil<L>,
    corners: &Corners,
    half: usize,
) -> (u8, [L::Doubles; 3]) {
    let d = &rays.direction;
    let [p, q, r] = [l.abs64(d[0]), l.abs64(d[1]), l.abs64(d[2])];
    // As the judge chooses: of equal ones the first.
    let along = match z {
        0 => l.le64(p, r) & l.le64(q, r),
        1 => l.le64(p, r) & !(l.le64(r, q) & l.le64(p, q)),
        _ => !(l.le64(q, p) & l.le64(r, p)) & !l.le64(r, q),
    };
    let scale = l.div64(l.splat64(1.0), d[2]);
    let slope = [
        quotient(l, d[0], d[2], scale),
        quotient(l, d[1], d[2], scale),
    ];
    let corners = corners.half(l, half, &rays.origin);
    macro_rules! sheared {
        ($corner:literal) => {{
            let [across, upwards, along] = corners[$corner];
            [
                l.sub64(across, l.mul64(slope[0], along)),
                l.sub64(upwards, l.mul64(slope[1], along)),
                along,
            ]
        }};
    }
    let (a, b, c) = (sheared!(0), sheared!(1), sheared!(2));
    let (u, v, w) = (side(l, &c, &b), side(l, &a, &c), side(l, &b, &a));
    let sum = l.add64(l.add64(u, v), w);
    let (v, w) = (l.div64(v, sum), l.div64(w, sum));
    let mean = l.fused_mul_add64(v, l.sub64(b[2], a[2]), a[2]);
    let mean = l.fused_mul_add64(w, l.sub64(c[2], a[2]), mean);
    let t = l.mul64(mean, scale);
    let farthest = l.max64(l.max64(l.abs64(a[2]), l.abs64(b[2])), l.abs64(c[2]));
    // Where all distances are below the judge's 1e-140, their products' sum is below this, and rarely elsewhere.
    let is_sizeable = l.le64(l.splat64(1e-270), l.abs64(sum));
    let is_near = l.le64(farthest, l.mul64(l.splat64(FAR), l.abs64(mean)));
    let is_ahead = l.lt64(l.splat64(0.0), t) & l.lt64(t, l.splat64(f64::INFINITY));
    (along & is_sizeable & is_near & is_ahead, [t, v, w])
}

/// `a / b` by the inverse of `b`, as `quotient` of `shape/triangle.rs`.
#[inline(always)]
pub(crate) fn quotient<L: Lanes>(
    l: L,
    a: L::Doubles,
    b: L::Doubles,
    inverse: L::Doubles,
) -> L::Doubles {
    let first = l.mul64(a, inverse);
    let beyond = l.fused_mul_sub64(first, b, a);
    l.fused_neg_mul_add64(beyond, inverse, first)
}

/// On which side of an edge the ray is, to the last digits.
#[inline(always)]
fn side<L: Lanes>(l: L, p: &[L::Doubles; 3], q: &[L::Doubles; 3]) -> L::Doubles {
    let right = l.mul64(p[1], q[0]);
    l.sub64(
        l.fused_mul_sub64(p[0], q[1], right),
        l.fused_mul_sub64(p[1], q[0], right),
    )
}
