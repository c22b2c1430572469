//! Up to eight rays, each with a triangle of a leaf that it is known to meet, gathered one by one
//! and located in lanes.
//!
//! 1. Copy the ray and the triangle's corners, which are float32 in the leaf; or where float32 does
//!    not hold them float64 from the mesh.
//! 2. Bring the corners into the space of the mesh in lanes, and compute `t` and the weights there
//!    ([`eight_crossings_at`]).

#![expect(
    clippy::needless_range_loop,
    reason = "for chains of iterators the compiler copies registers to memory"
)]

use super::eight_crossings::{RayBundle, eight_crossings_at};
use super::mesh_tree::MeshTree;
use crate::geometry::{DVec3, Ray, arrays};
use crate::shape::Meshes;
use crate::simd::{Aligned, LANES, Lanes, WIDE};

/// See [the module](self).
#[derive(Debug, Clone, Copy)]
pub(super) struct EightPairs {
    /// Origins and directions, three axes each, `t_min` and `t_max`.
    rays: Aligned<[[f64; WIDE]; 8]>,
    /// The corners a, b and c as leaves have them, three axes each.
    scaled: Aligned<[[f32; WIDE]; 9]>,
    /// The spaces of those: the unit, and where the origin is in the mesh.
    spaces: Aligned<[[f64; WIDE]; 4]>,
    /// The corners as the mesh has them, in the lanes that are not scaled.
    whole: Aligned<[[f64; WIDE]; 9]>,
    is_scaled: u8,
}

/// The crossings of the eight: `t` and the weights of the corners 1 and 2.
pub(super) struct Located {
    /// The lanes in which these are those of the exact test.
    pub(super) sound: u8,
    /// The lanes whose ray holds `t`.
    pub(super) held: u8,
    numbers: Aligned<[[f64; WIDE]; 3]>,
}

impl Located {
    #[inline(always)]
    pub(super) fn at(&self, lane: usize) -> [f64; 3] {
        let [t, v, w] = &self.numbers.0;
        [t[lane % WIDE], v[lane % WIDE], w[lane % WIDE]]
    }
}

impl EightPairs {
    pub(super) const NONE: Self = Self {
        rays: Aligned([[0.0; WIDE]; 8]),
        scaled: Aligned([[0.0; WIDE]; 9]),
        spaces: Aligned([[0.0; WIDE]; 4]),
        whole: Aligned([[0.0; WIDE]; 9]),
        is_scaled: 0,
    };

    /// Puts a ray and a triangle, by its leaf and lane, into a lane.
    #[inline(always)]
    pub(super) fn put(
        &mut self,
        at: usize,
        ray: &Ray,
        (tree, mesh): (&MeshTree, Meshes<'_>),
        leaf_lane: u32,
    ) {
        let at = at % WIDE;
        for axis in 0..3 {
            self.rays.0[axis][at] = ray.origin[axis];
            self.rays.0[3 + axis][at] = ray.direction[axis];
        }
        self.rays.0[6][at] = ray.t_min;
        self.rays.0[7][at] = ray.t_max;
        self.is_scaled = self.is_scaled & !(1 << at) | u8::from(tree.is_exact) << at;
        if !tree.is_exact {
            let corners = tree.corners_at(mesh, leaf_lane);
            for k in 0..9 {
                self.whole.0[k][at] = corners[k / 3][k % 3];
            }
            return;
        }
        self.spaces.0[0][at] = tree.space.unscale;
        for axis in 0..3 {
            self.spaces.0[1 + axis][at] = tree.space.origin[axis];
        }
        let leaf = &tree.leaves[leaf_lane as usize / LANES];
        for corner in 0..3 {
            let vertex = leaf.vertex(leaf_lane as usize % LANES, corner);
            for axis in 0..3 {
                self.scaled.0[3 * corner + axis][at] = leaf.vertices[axis][vertex];
            }
        }
    }

    /// The ray in a lane, and the corners of its triangle.
    pub(super) fn get(&self, at: usize) -> (Ray, [DVec3; 3]) {
        let at = at % WIDE;
        let rays = |k: usize| self.rays.0[k][at];
        let vector = |k: usize| DVec3::new(rays(k), rays(k + 1), rays(k + 2));
        let ray = Ray::new(vector(0), vector(3)).beyond(rays(6)).up_to(rays(7));
        let number = |k: usize| {
            if self.is_scaled >> at & 1 == 0 {
                self.whole.0[k][at]
            } else {
                let [unit, origin] = [self.spaces.0[0][at], self.spaces.0[1 + k % 3][at]];
                f64::from(self.scaled.0[k][at]) * unit + origin
            }
        };
        let corners =
            arrays::from_fn(|k| DVec3::from_array(arrays::from_fn(|axis| number(3 * k + axis))));
        (ray, corners)
    }

    /// Locates the first `count`.
    #[inline(always)]
    pub(super) fn locate<L: Lanes>(&self, l: L, count: usize) -> Located {
        let number = |k: usize| l.load64(&self.rays.0[k]);
        let rays = RayBundle {
            origin: [number(0), number(1), number(2)],
            direction: [number(3), number(4), number(5)],
        };
        let unit = l.load64(&self.spaces.0[0]);
        let mut corners = [[unit; 3]; 3];
        for k in 0..9 {
            // The unit is a power of two, so products are exact.
            let origin = l.load64(&self.spaces.0[1 + k % 3]);
            let scaled = l.fused_mul_add64(l.load_widened(&self.scaled.0[k]), unit, origin);
            let whole = l.load64(&self.whole.0[k]);
            corners[k / 3][k % 3] = l.select64(self.is_scaled, scaled, whole);
        }
        #[expect(clippy::cast_possible_truncation, reason = "eight bits")]
        let wanted = ((1_u32 << count) - 1) as u8;
        let (sound, crossings) = eight_crossings_at(l, &rays, &corners, wanted);
        let t = crossings[0];
        let held = l.lt64(number(6), t) & l.le64(t, number(7));
        let mut numbers = Aligned([[0.0; WIDE]; 3]);
        for k in 0..3 {
            l.store64(crossings[k], &mut numbers.0[k]);
        }
        Located { sound, held, numbers }
    }
}
