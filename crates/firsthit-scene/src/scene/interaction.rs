//! The surface interaction: the data of a hit that shaders and channels read.

mod maps;
mod rows;

use std::cell::Cell;

#[doc(hidden)]
pub use rows::compute_geometry;

use super::{Colored, MapRole, Material, Object, Scene};
use crate::geometry::{
    Color, DVec2, DVec3, Departure, Hit, Ray, RayFilter, Side, SurfaceId, moderation, unit,
};
use crate::shape::{Mesh, Shape, Surface, mesh};

/// A ray's hit on a surface. The object, the mesh and the material are looked up once; everything
/// else is computed when it is asked for, or before, for many at a time.
///
/// ```
/// use firsthit::{DVec3, Object, Ray, Scene, Sphere, shoot};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
/// let hit = shoot(&scene, ray.origin, ray.direction);
/// let surface = scene.interaction(&ray, &hit).expect("the ray hits the sphere");
/// assert_eq!(surface.position(), DVec3::Z);
/// assert_eq!(surface.normal(), DVec3::Z);
/// assert!(surface.is_front());
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SurfaceInteraction<'a> {
    ray: &'a Ray,
    hit: &'a Hit,
    object: &'a Object,
    /// The mesh, and which of its triangles.
    pub(super) mesh: Option<(&'a Mesh, usize)>,
    /// The scene's colouring by numbers, if there is one.
    colored: Option<&'a Colored>,
    /// The position and normal, once computed.
    geometry: Cell<Option<Geometry>>,
}

/// The position and the geometric normal, in the world.
#[derive(Debug, Clone, Copy)]
struct Geometry {
    position: DVec3,
    normal: DVec3,
}

impl Scene {
    /// The surface interaction of a ray's hit; `None` for a miss.
    ///
    /// It takes a hit of this scene. With one of another scene it answers for whatever has its
    /// identifiers here: `None` where there is no such object, or its mesh has no such triangle.
    #[inline]
    pub fn interaction<'a>(&'a self, ray: &'a Ray, hit: &'a Hit) -> Option<SurfaceInteraction<'a>> {
        let object = self.object(hit)?;
        let mesh = match object.shape() {
            Shape::Mesh(mesh) => {
                let triangle = usize::try_from(hit.primitive).ok()?;
                mesh.triangles().get(triangle)?;
                Some((mesh.as_ref(), triangle))
            }
            _ => None,
        };
        Some(SurfaceInteraction {
            ray,
            hit,
            object,
            mesh,
            colored: self.colored(),
            geometry: Cell::new(None),
        })
    }
}

impl<'a> SurfaceInteraction<'a> {
    /// The ray, in the world.
    #[inline]
    pub fn ray(&self) -> &'a Ray {
        self.ray
    }

    /// The hit.
    #[inline]
    pub fn hit(&self) -> &'a Hit {
        self.hit
    }

    /// The object.
    #[inline]
    pub fn object(&self) -> &'a Object {
        self.object
    }

    /// The material; `None` for an object that was given none.
    #[inline]
    pub fn material(&self) -> Option<&'a Material> {
        self.object.material(self.hit.primitive)
    }

    /// The position of the hit in the world.
    ///
    /// `ray.at(hit.t)` is off by the rounding of everything on the ray's way; this point is on the
    /// surface. In object space a triangle's is the mean of its corners by the hit's weights, off
    /// its plane by 13 * 2^-53 of the largest coordinate at most. Other shapes' is `ray.at(hit.t)`
    /// moved onto the shape, off that by 8 * 2^-53 of the shape's largest coordinate and its size.
    /// A transform rounds once more.
    #[inline]
    pub fn position(&self) -> DVec3 {
        self.geometry().position
    }

    #[inline]
    fn geometry(&self) -> Geometry {
        self.geometry.get().unwrap_or_else(|| {
            let computed = self.computed_geometry();
            self.geometry.set(Some(computed));
            computed
        })
    }

    #[inline]
    fn computed_geometry(&self) -> Geometry {
        if let Some((mesh, triangle)) = self.mesh {
            let corners = mesh.corners(triangle);
            let point = mesh::point_of(corners, self.hit.barycentric);
            self.in_world(point, mesh::normal_of(corners))
        } else {
            let (shape, primitive) = (self.object.shape(), self.hit.primitive);
            let point = self.object.transform().ray_in_object(self.ray);
            let point = point.at(self.hit.t);
            self.in_world(shape.onto(point, primitive), shape.normal(point, primitive))
        }
    }

    /// The position and normal in the world, from those in object space.
    #[inline]
    fn in_world(&self, point: DVec3, normal: DVec3) -> Geometry {
        let transform = self.object.transform();
        Geometry {
            position: transform.point_in_world(point),
            normal: transform.normal_in_world(normal),
        }
    }

    /// A ray from the hit on, and the filter that goes with it: it meets neither the surface it
    /// leaves, nor the neighbours that touch it at the start, but everything else, however near. No
    /// offset is needed. At an edge or a vertex of an open mesh a ray from the side that was met
    /// into a neighbour is stopped there, at the least `t` above 0.
    ///
    /// ```
    /// use firsthit::shoot::{First, trace};
    /// use firsthit::{DVec3, Filtered, Object, Ray, Scene, Sphere, shoot};
    ///
    /// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
    /// let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
    /// let hit = shoot(&scene, ray.origin, ray.direction);
    /// let surface = scene.interaction(&ray, &hit).expect("the ray hits the sphere");
    /// let (inwards, filter) = surface.leave(DVec3::NEG_Z);
    /// let hits = trace(&scene, &Filtered::new(&[inwards], filter), First, &())?;
    /// assert_eq!(hits.t, [2.0]);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn leave(&self, direction: DVec3) -> (Ray, RayFilter) {
        (Ray::new(self.position(), direction), self.departure())
    }

    /// The filter of a ray from the hit on.
    #[inline]
    #[doc(hidden)]
    pub fn departure(&self) -> RayFilter {
        let Hit { object, primitive, barycentric, .. } = *self.hit;
        let departure = Departure {
            surface: SurfaceId { object, primitive },
            barycentric,
            side: Some(if self.is_front() { Side::Front } else { Side::Back }),
        };
        RayFilter { departure: Some(departure), ..RayFilter::NONE }
    }

    /// The geometric normal in the world: the face's own, of length one, outwards for closed
    /// shapes. NaN for a triangle without an area.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.geometry().normal
    }

    /// The angle between the ray and the line along the geometric normal, in radians: 0 head on, pi
    /// / 2 at most. NaN for a triangle without an area.
    ///
    /// It is the arc tangent of sine and cosine: next to 0 the arc cosine would lose half of the
    /// digits.
    pub fn incidence(&self) -> f64 {
        let normal = self.normal();
        let way = moderation(self.ray.direction) * self.ray.direction;
        libm::atan2(normal.cross(way).length(), normal.dot(way).abs())
    }

    /// The normal to shade with, in the world, of length one: interpolated where the mesh has
    /// normals at its vertices, on the same side as the geometric normal, which it is everywhere
    /// else.
    #[inline]
    pub fn shading_normal(&self) -> DVec3 {
        let geometric = self.normal();
        let smooth = || {
            let (mesh, triangle) = self.mesh?;
            let smooth = mesh.shading_normal(triangle, self.hit.barycentric)?;
            let smooth = unit(self.object.transform().normal_in_world(smooth));
            (smooth.is_finite() && smooth.dot(geometric) > 0.0).then_some(smooth)
        };
        smooth().unwrap_or(geometric)
    }

    /// Whether the front was met: the side that the geometric normal points to.
    #[inline]
    pub fn is_front(&self) -> bool {
        self.ray.direction.dot(self.normal()) < 0.0
    }

    /// 1 where the front was met, and -1 where the back was: times a normal it is the normal on the
    /// side that is seen.
    #[inline]
    #[doc(hidden)]
    pub fn side(&self) -> f64 {
        if self.is_front() { 1.0 } else { -1.0 }
    }

    /// The linear colour: that of its number, where the scene is [coloured by
    /// numbers](Scene::with_coloring), or else its own.
    #[inline]
    pub fn color(&self) -> Color {
        let by_number = self.colored.and_then(|colored| colored.color(self));
        by_number.unwrap_or_else(|| self.own_color())
    }

    /// The material's colour, times its texture's, times the mesh's own.
    #[inline]
    fn own_color(&self) -> Color {
        let Some((mesh, triangle)) = self.mesh else {
            return self.object.color();
        };
        let own = mesh.color(triangle, self.hit.barycentric);
        let look = self.material().map_or(Object::NEUTRAL, |material| {
            match material.maps.get(MapRole::Color) {
                Some(map) => material.color_at(self.uv_of(map)),
                None => material.color,
            }
        });
        look * own.unwrap_or(Color::ONE)
    }

    /// Whether the colour is to be seen as it is, whatever the light.
    #[inline]
    pub fn is_unlit(&self) -> bool {
        self.material().is_some_and(|material| material.unlit)
    }

    /// The texture coordinates, where a mesh has them.
    pub fn uv(&self) -> Option<DVec2> {
        let (mesh, triangle) = self.mesh?;
        mesh.uv(triangle, self.hit.barycentric)
    }

    /// The polygon of the file that the triangle was part of; of other shapes the primitive.
    pub fn face(&self) -> i32 {
        let face = |(mesh, triangle): (&Mesh, usize)| i32::try_from(mesh.face(triangle)).ok();
        self.mesh.and_then(face).unwrap_or(self.hit.primitive)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::shape::Positions;

    #[test]
    fn a_hit_of_another_scene_whose_triangle_is_not_there_has_no_interaction() {
        let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2]]).unwrap();
        let scene = Scene::new(vec![Object::new(Arc::new(mesh))]).unwrap();
        let ray = Ray::new(DVec3::Z, DVec3::NEG_Z);
        let hit = |object, primitive| Hit { t: 1.0, object, primitive, ..Hit::MISS };
        let found = |object, primitive| {
            let hit = hit(object, primitive);
            let surface = scene.interaction(&ray, &hit);
            surface.map(|surface| surface.normal())
        };
        assert_eq!(found(0, 0), Some(DVec3::Z));
        for (object, primitive) in [(0, 1), (0, -1), (0, i32::MAX), (1, 0), (-1, 0)] {
            assert_eq!(found(object, primitive), None, "{object} {primitive}");
        }
    }
}
