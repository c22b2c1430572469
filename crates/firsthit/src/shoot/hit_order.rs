//! Which of two hits of a ray is the first: the one with the smaller `t`, which of triangles is the float64 nearest to
//! the exact one; of equal ones the lower (object, primitive).

use super::scaled_ray::ScaledRay;
use crate::geometry::Hit;
use crate::scene::Scene;
use crate::shape::triangle::are_close;
use crate::shape::{Crossing, Shape};

impl ScaledRay {
    /// Whether `new` is the first of two hits of the ray, each perhaps a miss.
    #[inline(always)]
    pub(super) fn precedes(&self, scene: &Scene, new: &Hit, old: &Hit) -> bool {
        if are_close(new.t, old.t) {
            self.precedes_closely(scene, new, old)
        } else {
            new.t < old.t
        }
    }

    #[cold]
    fn precedes_closely(&self, scene: &Scene, new: &Hit, old: &Hit) -> bool {
        let key = |hit: &Hit| (self.nearest_t(scene, hit), hit.object, hit.primitive);
        key(new) < key(old)
    }

    /// The float64 nearest to the exact `t` of a hit in a triangle.
    fn nearest_t(&self, scene: &Scene, hit: &Hit) -> f64 {
        let object = usize::try_from(hit.object).map(|index| &scene.objects()[index]);
        if let Ok(object) = object
            && let Shape::Mesh(mesh) = object.shape()
            && let Some(ray) = self.in_object(object, f64::INFINITY)
        {
            let crossing = Crossing {
                t: hit.t / self.t_scale,
                primitive: hit.primitive,
                barycentric: hit.barycentric,
            };
            return self.t_scale * mesh.nearest_t(&ray, &crossing);
        }
        hit.t
    }
}
