//! A ray on its way through a scene, and what it has met so far.

use super::filter::{self, Place};
use super::ray_query::RayQuery;
use super::scaled_ray::ScaledRay;
use crate::accel::MeshQuery;
use crate::geometry::Ray;
use crate::scene::Scene;
use crate::shape::{Crossing, Shape, Surface};

/// See [the module](self).
pub(super) struct RayState<Q> {
    /// `None` for a ray that meets nothing.
    pub(super) scaled: Option<ScaledRay>,
    /// Beyond this nothing matters; below zero nothing does at all.
    pub(super) t_max: f64,
    pub(super) query: Q,
}

impl<Q: RayQuery> RayState<Q> {
    /// Begins with `ray`; `query` knows what that has met already, at `t_max` or before.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, query: Q, t_max: f64) -> Self {
        let scaled = if Q::IS_FILTERED {
            ScaledRay::filtered(ray, query.filter())
        } else {
            ScaledRay::new(ray)
        };
        // A ray may begin behind its origin. Below zero `t_max` says that nothing matters any more,
        // so it stays above.
        let within = |scaled: &ScaledRay| {
            let t_max = scaled.ray.t_max.min(t_max / scaled.t_scale);
            t_max.max(f64::MIN_POSITIVE)
        };
        Self { t_max: scaled.as_ref().map_or(-1.0, within), scaled, query }
    }

    /// The ray on its way, unless it can meet nothing.
    #[inline(always)]
    pub(super) fn ray(&self) -> Option<&Ray> {
        self.scaled.as_ref().map(|scaled| &scaled.ray)
    }

    /// Whether anything matters any more.
    #[inline(always)]
    pub(super) fn is_open(&self) -> bool {
        self.t_max >= 0.0
    }

    /// The largest `t` at which the ray may still meet something that matters.
    #[inline(always)]
    pub(super) fn limit(&self) -> f64 {
        let t_max = self.scaled.as_ref().map_or(-1.0, |scaled| scaled.ray.t_max);
        self.t_max.min(t_max)
    }

    /// Comes to a lone shape out of turn.
    pub(super) fn come_to(&mut self, scene: &Scene, index: u32) {
        let Some(scaled) = self.scaled.as_ref().filter(|_| self.is_open()) else {
            return;
        };
        let object = &scene.objects()[index as usize];
        let filter = self.query.filter();
        if Q::IS_FILTERED && !filter::sees(filter, index, object) {
            return;
        }
        let ray = if Q::IS_FILTERED {
            let in_object =
                filter::in_object(scene, (scaled, filter), Place::Object(index), self.t_max);
            in_object.map(|(ray, _)| ray)
        } else {
            scaled.in_object(object, self.t_max)
        };
        if let Some(ray) = ray {
            self.meet_shape(scene, (index, object.shape()), &ray);
        }
    }

    /// Intersects the shape of an object, which is no mesh, with the ray in its space.
    pub(super) fn meet_shape(&mut self, scene: &Scene, (index, shape): (u32, &Shape), ray: &Ray) {
        let filter = self.query.filter();
        if Q::IS_FILTERED && !filter::meets_all_of(filter, index) {
            let t_scale = self.scaled.as_ref().map_or(1.0, |scaled| scaled.t_scale);
            let crossings = filter::crossings(filter, index, shape, (ray, t_scale));
            let crossings = crossings.into_iter().flatten();
            crossings.for_each(|crossing| self.cross(scene, index, crossing));
        } else if Q::ALL {
            let crossings = shape.crossings(ray).into_iter().flatten();
            crossings.for_each(|crossing| self.cross(scene, index, crossing));
        } else if let Some(crossing) = shape.intersect(ray) {
            self.cross(scene, index, crossing);
        }
    }

    /// Takes a crossing with an object, if it is a hit of the caller's ray.
    #[inline(always)]
    pub(super) fn cross(&mut self, scene: &Scene, index: u32, crossing: Crossing) {
        let scaled = self.scaled.as_ref();
        if scaled.is_some_and(|scaled| scaled.holds(&crossing)) {
            self.take(scene, index, Q::InMesh::of_crossing(Some(crossing)));
        }
    }

    /// Takes what an object, or one of those that it leads, was found to do to the ray.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        scene: &Scene,
        index: u32,
        found: <Q::InMesh as MeshQuery>::Found,
    ) {
        if let Some(scaled) = &self.scaled {
            let surface = |primitive| scene.surface_at(index, primitive);
            let t_max = self.query.take(scene, scaled, surface, found);
            self.t_max = self.t_max.min(t_max);
        }
    }
}
