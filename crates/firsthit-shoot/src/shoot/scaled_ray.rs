//! A ray whose direction is scaled by a power of two, so that its square is in float64's range.

use crate::geometry::{Hit, Ray, RayFilter, SurfaceId, moderation};
use crate::scene::Object;
use crate::shape::Crossing;

/// See [the module](self). It goes into objects, and what it meets there becomes hits of the
/// original.
pub(super) struct ScaledRay {
    pub(super) ray: Ray,
    /// The factor from the scaled ray's `t` to the original's: a power of two, hardly ever another
    /// than 1.
    pub(super) t_scale: f64,
    /// The ends of the ray as the caller has it.
    t_min: f64,
    t_max: f64,
    /// Whether it leaves a surface: then its `t` is measured from a rounded start.
    pub(super) is_departing: bool,
}

impl ScaledRay {
    /// `None` for a ray that is not [valid](Ray::is_valid).
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let t_scale = moderation(ray.direction);
        Some(Self {
            ray: Ray {
                origin: ray.origin,
                direction: t_scale * ray.direction,
                t_min: ray.t_min / t_scale,
                t_max: ray.t_max / t_scale,
            },
            t_scale,
            t_min: ray.t_min,
            t_max: ray.t_max,
            is_departing: false,
        })
    }

    /// The scaled ray of one with a filter.
    #[inline(always)]
    pub(super) fn filtered(ray: &Ray, filter: &RayFilter) -> Option<Self> {
        let is_departing = filter.departure.is_some();
        Self::new(ray).map(|scaled| Self { is_departing, ..scaled })
    }

    /// The ray, up to `t_max`, in an object's space. A transform can take its numbers out of the
    /// range of float64: then it meets nothing, as does any ray an object that is out of range.
    #[inline(always)]
    pub(super) fn in_object(&self, object: &Object, t_max: f64) -> Option<Ray> {
        let ray = self.ray.up_to(t_max.min(self.ray.t_max));
        let ray = object.transform().ray_in_object(&ray);
        (ray.is_valid() && !object.is_out_of_range()).then_some(ray)
    }

    /// Whether a crossing is between the ends of the ray that the caller has.
    #[inline(always)]
    pub(super) fn holds(&self, crossing: &Crossing) -> bool {
        let t = self.t_scale * crossing.t;
        t > self.t_min && t <= self.t_max && t.is_finite()
    }

    /// A crossing with a surface, as a hit of the ray that the caller has.
    #[inline(always)]
    pub(super) fn hit(&self, surface: SurfaceId, crossing: Crossing) -> Option<Hit> {
        self.holds(&crossing).then_some(Hit {
            t: self.t_scale * crossing.t,
            object: surface.object,
            primitive: surface.primitive,
            barycentric: crossing.barycentric,
        })
    }
}
