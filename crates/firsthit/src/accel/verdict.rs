//! The judge's last word for eight rays at once, each with a triangle that it is known to meet.
//!
//! Operation for operation what `shape/triangle.rs` does in one lane, so the bits are the same; what goes a way
//! of its own there (an axis unlike its neighbours', tiny triangles, `t` by cancellation) is left to it.

use super::mesh_tree::MeshTree;
use crate::geometry::DVec3;
use crate::shape::Mesh;
use crate::shape::triangle::FAR;
use crate::simd::{LANES, Lanes, WIDE};

/// Eight rays, in the space of a mesh.
pub(crate) struct Pencil<L: Lanes> {
    pub(crate) origin: [L::Doubles; 3],
    pub(crate) direction: [L::Doubles; 3],
}

/// The corners of sixteen triangles in lanes, corner by corner and axis by axis, in two halves.
pub(crate) struct Corners<L: Lanes>(pub(crate) [[[L::Doubles; 2]; 3]; 3]);

impl<L: Lanes> Corners<L> {
    /// Those of the triangles in `slots` (as bits), in the lanes of `wanted`; of others anything.
    #[inline(always)]
    pub(crate) fn new(
        l: L,
        tree: &MeshTree,
        mesh: &Mesh,
        slots: &[f32; LANES],
        wanted: u16,
    ) -> Self {
        if tree.is_exact {
            Self::exact(l, tree, slots, wanted)
        } else {
            Self::gathered(l, tree, mesh, slots, wanted)
        }
    }

    /// From the leaves, which are in the cache: neighbours mostly meet the same few triangles.
    #[inline(always)]
    fn exact(l: L, tree: &MeshTree, slots: &[f32; LANES], wanted: u16) -> Self {
        let all = l.load(slots);
        let mut corners = [[l.splat(0.0); 3]; 3];
        let mut left = wanted;
        while left != 0 {
            let slot = slots[left.trailing_zeros() as usize % LANES];
            let here = l.same(all, l.splat(slot));
            left &= !here;
            let slot = slot.to_bits() as usize;
            let triangle = tree.leaves[slot / LANES].triangle(slot % LANES);
            for (corner, point) in corners.iter_mut().zip(triangle) {
                for (lanes, coordinate) in corner.iter_mut().zip(point) {
                    *lanes = l.select(here, l.splat(coordinate), *lanes);
                }
            }
        }
        let unscale = l.splat64(tree.space.unscale);
        let mut out = [[[l.splat64(0.0); 2]; 3]; 3];
        for (out, corner) in out.iter_mut().zip(corners) {
            for (axis, (out, lanes)) in out.iter_mut().zip(corner).enumerate() {
                let origin = l.splat64(tree.space.origin[axis]);
                let [low, high] = l.widen(lanes);
                *out = [
                    l.add64(l.mul64(low, unscale), origin),
                    l.add64(l.mul64(high, unscale), origin),
                ];
            }
        }
        Self(out)
    }

    /// From the mesh, one by one.
    #[inline(always)]
    fn gathered(l: L, tree: &MeshTree, mesh: &Mesh, slots: &[f32; LANES], wanted: u16) -> Self {
        let mut arrays = [[[[0.0; WIDE]; 2]; 3]; 3];
        let mut left = wanted;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let corners: [DVec3; 3] = tree.corners_in(mesh, slots[lane].to_bits());
            for (arrays, corner) in arrays.iter_mut().zip(corners) {
                for axis in 0..3 {
                    arrays[axis][lane / WIDE][lane % WIDE] = corner[axis];
                }
            }
        }
        let mut out = [[[l.splat64(0.0); 2]; 3]; 3];
        for (out, arrays) in out.iter_mut().zip(&arrays) {
            for (out, arrays) in out.iter_mut().zip(arrays) {
                *out = [l.load64(&arrays[0]), l.load64(&arrays[1])];
            }
        }
        Self(out)
    }
}

/// `t` and the weights of corners 1 and 2, and in which lanes they are the judge's.
#[inline(always)]
pub(crate) fn verdict<L: Lanes>(
    l: L,
    rays: &Pencil<L>,
    corners: &Corners<L>,
    half: usize,
) -> (u8, [L::Doubles; 3]) {
    let d = &rays.direction;
    let longest = [l.abs64(d[0]), l.abs64(d[1]), l.abs64(d[2])];
    // Where x, else y, is longest.
    let is_x = l.le64(longest[1], longest[0]) & l.le64(longest[2], longest[0]);
    let is_y = l.le64(longest[2], longest[1]) & !is_x;
    let (z, same) = if is_x & 1 == 1 {
        (0, is_x)
    } else if is_y & 1 == 1 {
        (1, is_y)
    } else {
        (2, !is_x & !is_y)
    };
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let slope = [l.div64(d[x], d[z]), l.div64(d[y], d[z])];
    let scale = l.div64(l.splat64(1.0), d[z]);
    macro_rules! sheared {
        ($corner:literal) => {{
            let corner = &corners.0[$corner];
            let along = l.sub64(corner[z][half % 2], rays.origin[z]);
            let across = l.sub64(corner[x][half % 2], rays.origin[x]);
            let upwards = l.sub64(corner[y][half % 2], rays.origin[y]);
            [
                l.sub64(across, l.mul64(slope[0], along)),
                l.sub64(upwards, l.mul64(slope[1], along)),
                l.mul64(along, scale),
            ]
        }};
    }
    let (a, b, c) = (sheared!(0), sheared!(1), sheared!(2));
    let (u, v, w) = (side(l, &c, &b), side(l, &a, &c), side(l, &b, &a));
    let sum = l.add64(l.add64(u, v), w);
    let (v, w) = (l.div64(v, sum), l.div64(w, sum));
    let t = l.add64(
        l.add64(a[2], l.mul64(v, l.sub64(b[2], a[2]))),
        l.mul64(w, l.sub64(c[2], a[2])),
    );
    macro_rules! largest {
        ($k:literal) => {
            l.max64(l.max64(l.abs64(a[$k]), l.abs64(b[$k])), l.abs64(c[$k]))
        };
    }
    let is_sizeable = l.le64(l.splat64(1e-140), l.max64(largest!(0), largest!(1)));
    let is_near = l.le64(largest!(2), l.mul64(l.splat64(FAR), l.abs64(t)));
    let is_ahead = l.lt64(l.splat64(0.0), t) & l.lt64(t, l.splat64(f64::INFINITY));
    (same & is_sizeable & is_near & is_ahead, [t, v, w])
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
