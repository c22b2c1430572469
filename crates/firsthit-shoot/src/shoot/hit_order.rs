//! Orders two hits of a ray: first is the one with the smaller `t`, for triangles the float64
//! nearest to the exact one; of equal ones the lower (object, primitive). A hit's own `t` may be
//! the next to the nearest: with its last digit for all rays, those of a camera would take a half
//! longer.
//!
//! Of a ray that leaves a surface `t` itself decides: it is measured from a rounded start.
//!
//! Where all crossings are wanted, those of one mesh with equal `t` are in the order of a ray
//! infinitely little beside it (`triangle/crossed.rs`).

use std::cmp::Ordering;

use super::scaled_ray::ScaledRay;
use crate::geometry::{Hit, Ray};
use crate::scene::Scene;
use crate::shape::triangle::are_close;
use crate::shape::{Crossing, Mesh, Shape};

impl ScaledRay {
    /// Whether `new` is the first of two hits of the ray, each perhaps a miss.
    #[inline(always)]
    pub(super) fn precedes(&self, scene: &Scene, new: &Hit, old: &Hit) -> bool {
        if are_close(new.t, old.t) { self.precedes_closely(scene, new, old) } else { new.t < old.t }
    }

    #[cold]
    fn precedes_closely(&self, scene: &Scene, new: &Hit, old: &Hit) -> bool {
        let key = |hit: &Hit| (self.nearest_t(scene, hit), hit.object, hit.primitive);
        key(new) < key(old)
    }

    /// Sorts crossings of the ray. A solid's first end must come before its second one in the
    /// input.
    pub(super) fn order(&self, scene: &Scene, hits: &mut [Hit]) {
        if self.is_departing {
            let ids = |hit: &Hit| (hit.object, hit.primitive);
            hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(ids(a).cmp(&ids(b))));
            return;
        }
        hits.sort_by(|a, b| a.t.total_cmp(&b.t));
        for close in hits.chunk_by_mut(|a, b| are_close(a.t, b.t)) {
            if close.len() > 1 {
                self.order_closely(scene, close);
            }
        }
    }

    /// Orders hits with nearly equal `t`. Each keeps its own: what else is met changes no hit.
    #[cold]
    fn order_closely(&self, scene: &Scene, hits: &mut [Hit]) {
        let with_nearest = |hit: &Hit| (self.nearest_t(scene, hit), *hit);
        let mut ordered: Vec<(f64, Hit)> = hits.iter().map(with_nearest).collect();
        ordered.sort_by(|(t, a), (u, b)| t.total_cmp(u).then(a.object.cmp(&b.object)));
        for (out, (_, hit)) in hits.iter_mut().zip(&ordered) {
            *out = *hit;
        }
        let mut rest = hits;
        for same in ordered.chunk_by(|(t, a), (u, b)| (t, a.object) == (u, b.object)) {
            let (same, after) = rest.split_at_mut(same.len());
            rest = after;
            let Some((ray, mesh)) = self.in_mesh(scene, &same[0]) else {
                continue;
            };
            same.sort_by_key(|hit| hit.primitive);
            merge_sort(same, &|one, other| {
                mesh.compare(&ray, &self.crossing(one), &self.crossing(other)) == Ordering::Less
            });
        }
    }

    /// The float64 nearest to the exact `t` of a hit in a triangle.
    pub(super) fn nearest_t(&self, scene: &Scene, hit: &Hit) -> f64 {
        if self.is_departing {
            return hit.t;
        }
        self.in_mesh(scene, hit)
            .map_or(hit.t, |(ray, mesh)| self.t_scale * mesh.nearest_t(&ray, &self.crossing(hit)))
    }

    /// A hit of a mesh, and the ray in the space of that.
    fn in_mesh<'a>(&self, scene: &'a Scene, hit: &Hit) -> Option<(Ray, &'a Mesh)> {
        let object = scene.objects().get(usize::try_from(hit.object).ok()?)?;
        let Shape::Mesh(mesh) = object.shape() else {
            return None;
        };
        Some((self.in_object(object, f64::INFINITY)?, mesh))
    }

    /// A hit as its mesh has it.
    fn crossing(&self, hit: &Hit) -> Crossing {
        Crossing { t: hit.t / self.t_scale, primitive: hit.primitive, barycentric: hit.barycentric }
    }
}

/// A stable sort that takes any `is_before`: of numbers beyond float64's range the exact comparison
/// is no order, on which the standard library's may panic.
fn merge_sort(hits: &mut [Hit], is_before: &impl Fn(&Hit, &Hit) -> bool) {
    if hits.len() < 2 {
        return;
    }
    let middle = hits.len() / 2;
    let (low, high) = hits.split_at_mut(middle);
    merge_sort(low, is_before);
    merge_sort(high, is_before);
    let first_half = low.to_vec();
    let (mut one, mut other) = (0, middle);
    for place in 0..hits.len() {
        let Some(hit) = first_half.get(one) else {
            return;
        };
        if other < hits.len() && is_before(&hits[other], hit) {
            hits[place] = hits[other];
            other += 1;
        } else {
            hits[place] = *hit;
            one += 1;
        }
    }
}
