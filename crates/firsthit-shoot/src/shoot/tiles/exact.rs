//! The exact test for pixels of a tile that float32 cannot decide: which of two triangles does the
//! ray of a pixel meet first?

use std::cmp::Ordering;

use super::tile::TileTask;
use crate::accel::{ExactTest, IsAfter, SettleExactly, TriangleId};
use crate::geometry::{Hit, Ray};
use crate::scene::{Object, Scene};
use crate::shape::triangle::{EdgeRule, Shear, are_close};
use crate::shoot::scaled_ray::ScaledRay;
use crate::simd::{Kernel, Lanes};

/// One of this many comparisons in a tile is counted for the mesh, whose counter all threads share.
/// Tiles of most pictures have fewer.
const COMPARED: u32 = 4;

/// The exact test of a ray and a triangle, as a function of its own: it is rarely called.
struct Decision<'a> {
    scene: &'a Scene,
    ray: Ray,
    triangle: TriangleId,
}

impl Kernel for Decision<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Option<Hit> {
        let TriangleId { object: index, leaf_lane } = self.triangle;
        let (mesh, tree) = self.scene.plain_mesh(index)?;
        let scaled = ScaledRay::new(&self.ray)?;
        let object = &self.scene.objects()[index as usize];
        let ray = scaled.in_object(object, scaled.ray.t_max)?;
        let corners = tree.corners_at(mesh, leaf_lane);
        let hit = Shear::new(&ray)
            .intersect_by(EdgeRule::Closed, corners, |doubtful| l.call(SettleExactly(doubtful)))?;
        let primitive = tree.triangle_at(leaf_lane).cast_signed();
        let crossing = hit.crossing(primitive);
        ray.holds(hit.t)
            .then(|| scaled.hit(self.scene.surface_at(index, primitive), crossing))
            .flatten()
    }
}

impl TileTask<'_> {
    /// The hit of the ray of a pixel in a triangle, by the exact test.
    #[inline(always)]
    pub(super) fn decide<L: Lanes>(
        &self,
        l: L,
        row: usize,
        column: usize,
        triangle: TriangleId,
    ) -> Option<Hit> {
        let ray = self.ray(row, column);
        let scene = self.plan.scene;
        l.call(Decision { scene, ray, triangle })
    }

    /// The order of two triangles along the ray of a pixel, which meets the old one, if it is
    /// known: in one plane the lower one is the first, and nearly there heights tell.
    fn known_order<L: Lanes>(
        &mut self,
        l: L,
        pixel: (usize, usize),
        [old, new]: [TriangleId; 2],
    ) -> Option<Ordering> {
        if old.object != new.object {
            return None;
        }
        let index = old.object;
        let (mesh, tree) = self.plan.scene.plain_mesh(old.object)?;
        let (old, new) = (tree.triangle_at(old.leaf_lane), tree.triangle_at(new.leaf_lane));
        if mesh.are_in_one_plane(old, new) {
            return Some(old.cmp(&new));
        }
        self.compared += 1;
        if self.compared.is_multiple_of(COMPARED) {
            mesh.ask_for_planes(old, new);
        }
        if !mesh.crowds()?.are_together(old, new) {
            return None;
        }
        let scaled = ScaledRay::new(&self.ray(pixel.0, pixel.1))?;
        let object = &self.plan.scene.objects()[index as usize];
        let ray = scaled.in_object(object, scaled.ray.t_max)?;
        // Not where numbers leave float64.
        let is_after = scaled.t_scale == 1.0 && l.call(IsAfter(mesh, &ray, [new, old]));
        is_after.then_some(Ordering::Less)
    }

    /// Whether `new` is the first of two hits of a pixel.
    fn precedes(&self, row: usize, column: usize, new: &Hit, old: &Hit) -> bool {
        let object = self.plan.scene.object(new);
        if new.object == old.object
            && are_close(new.t, old.t)
            && let Some(mesh) = object.and_then(Object::mesh)
        {
            mesh.ask_for_planes();
        }
        ScaledRay::new(&self.ray(row, column))
            .is_some_and(|scaled| scaled.precedes(self.plan.scene, new, old))
    }
}

impl ExactTest for TileTask<'_> {
    #[inline(never)]
    fn nearer<L: Lanes>(
        &mut self,
        l: L,
        row: usize,
        column: usize,
        old: TriangleId,
        new: TriangleId,
    ) -> Option<(TriangleId, f64)> {
        let known = self.known_order(l, (row, column), [old, new]);
        if known == Some(Ordering::Less) {
            return None;
        }
        let new_hit = self.decide(l, row, column, new)?;
        let old_hit = if old == TriangleId::NONE || known.is_some() {
            None
        } else {
            self.decide(l, row, column, old)
        };
        let (triangle, hit) = match old_hit {
            Some(old_hit) if !self.precedes(row, column, &new_hit, &old_hit) => (old, old_hit),
            _ => (new, new_hit),
        };
        Some((triangle, self.depth(row, column, hit.t)))
    }
}
