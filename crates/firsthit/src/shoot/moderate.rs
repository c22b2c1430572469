//! From a ray in the world to one in an object, and back with what it met.

use crate::geometry::{Hit, Ray, moderation};
use crate::scene::{Object, Scene};
use crate::shape::triangle::{Shear, are_close};
use crate::shape::{Crossing, Mesh, Shape};

/// A ray whose direction can be squared: `t` is counted in other units where float64 would not hold that.
pub(super) struct Moderate {
    pub(super) ray: Ray,
    /// What its `t` is to be multiplied with: a power of two, hardly ever another than 1.
    pub(super) scale: f64,
    /// As the caller has it.
    whole: Ray,
}

impl Moderate {
    /// `None` for a ray that is not [valid](Ray::is_valid).
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let scale = moderation(ray.direction);
        Some(Self {
            ray: Ray {
                origin: ray.origin,
                direction: scale * ray.direction,
                t_min: ray.t_min / scale,
                t_max: ray.t_max / scale,
            },
            scale,
            whole: *ray,
        })
    }

    /// The ray, up to `t_max`, in an object's space. A transform can take its numbers out of the range of
    /// float64: then it meets nothing, as does any ray an object that is out of range.
    #[inline(always)]
    pub(super) fn in_object(&self, object: &Object, t_max: f64) -> Option<Ray> {
        let ray = self.ray.up_to(t_max.min(self.ray.t_max));
        let ray = object.transform().ray_in_object(&ray);
        (ray.is_valid() && !object.is_out_of_range()).then_some(ray)
    }

    /// Whether `new` is the first of two hits of the ray, each perhaps a miss: the one with the smaller `t`, which of triangles is
    /// that nearest to the exact one; of equal ones the lower (object, primitive).
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
                t: hit.t / self.scale,
                primitive: hit.primitive,
                barycentric: hit.barycentric,
            };
            return self.scale * mesh.nearest_t(&ray, &crossing);
        }
        hit.t
    }

    /// What was met of the object `index`, as a hit of the ray that the caller has.
    #[inline(always)]
    pub(super) fn hit(&self, index: u32, crossing: Crossing) -> Option<Hit> {
        let t = self.scale * crossing.t;
        (self.whole.holds(t) && t.is_finite()).then(|| Hit {
            t,
            object: index.cast_signed(),
            primitive: crossing.primitive,
            barycentric: crossing.barycentric,
        })
    }
}

/// Where a ray meets a triangle that is not cut out there.
#[cold]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "a mesh holds at most `i32::MAX` triangles"
)]
pub(super) fn crossing(
    object: &Object,
    mesh: &Mesh,
    triangle: usize,
    (ray, shear): (&Ray, &Shear),
) -> Option<Crossing> {
    let hit = mesh.intersect_triangle(triangle, shear)?;
    let is_cut_out = object.has_cutouts() && object.is_cut_out(mesh, triangle, hit.barycentric);
    (ray.holds(hit.t) && !is_cut_out).then(|| hit.crossing(triangle as i32))
}
