//! Many surfaces at a time.

use super::{Geometry, SurfaceInteraction};
use crate::geometry::rows::{ROW, Scalars, Vectors};
use crate::geometry::{DVec2, DVec3, Ray, Transform};
use crate::scene::Object;
use crate::shape::mesh::{normal_of, point_of};
use crate::shape::{Shape, Surface};
use crate::simd::{self, InstructionSet, Kernel, Lanes};

/// Fewer surfaces are not worth a row.
const FEW: usize = 8;

/// Computes where surfaces are and how they lie, many at a time: each would do so by itself when it
/// is asked.
#[doc(hidden)]
pub fn compute_geometry(set: InstructionSet, surfaces: &[SurfaceInteraction<'_>]) {
    let (mut of_meshes, mut of_shapes) = (Vec::new(), Vec::new());
    for surfaces in surfaces.chunks(ROW) {
        of_meshes.clear();
        of_shapes.clear();
        for surface in surfaces {
            match surface.mesh {
                Some(_) => of_meshes.push(surface),
                None => of_shapes.push(surface),
            }
        }
        if of_meshes.len() >= FEW {
            compute_of_meshes(set, &of_meshes);
        }
        of_shapes.sort_by_key(|surface| surface.hit.object);
        for same in of_shapes.chunk_by(|a, b| a.hit.object == b.hit.object) {
            if same.len() >= FEW {
                compute_of_shape(set, same);
            }
        }
    }
}

/// Computes positions and normals of a row of surfaces of meshes.
fn compute_of_meshes(set: InstructionSet, surfaces: &[&SurfaceInteraction<'_>]) {
    let mut triangles = Triangles::NONE;
    for surface in surfaces {
        if let Some((mesh, triangle)) = surface.mesh {
            triangles.push(mesh.corners(triangle), surface.hit.barycentric);
        }
    }
    let (points, normals) = simd::run_here(set, &triangles);
    for (k, surface) in surfaces.iter().enumerate() {
        surface.know(surface.in_world(points.get(k), normals.get(k)));
    }
}

/// Computes positions and normals of a row of surfaces of one object, which is no mesh.
fn compute_of_shape(set: InstructionSet, surfaces: &[&SurfaceInteraction<'_>]) {
    let Some(first) = surfaces.first() else {
        return;
    };
    let mut hits = ShapeHits::NONE;
    for surface in surfaces {
        hits.push(surface);
    }
    let Some((points, normals)) = hits.find(set, first.object) else {
        return;
    };
    for (k, surface) in surfaces.iter().enumerate() {
        surface.know(Geometry { position: points.get(k), normal: normals.get(k) });
    }
}

impl SurfaceInteraction<'_> {
    fn know(&self, geometry: Geometry) {
        self.geometry.set(Some(geometry));
    }
}

/// Corners of triangles, and where they were hit.
struct Triangles {
    count: usize,
    corners: [Vectors; 3],
    weights: Vectors,
}

impl Triangles {
    const NONE: Self =
        Self { count: 0, corners: [const { Vectors::ZERO }; 3], weights: Vectors::ZERO };

    #[inline]
    fn push(&mut self, corners: [DVec3; 3], weights: DVec2) {
        let k = self.count;
        for (all, corner) in self.corners.iter_mut().zip(corners) {
            all.set(k, corner);
        }
        self.weights.set(k, weights.extend(0.0));
        self.count += 1;
    }

    #[inline(always)]
    fn corners(&self, k: usize) -> [DVec3; 3] {
        let [a, b, c] = &self.corners;
        [a.get(k), b.get(k), c.get(k)]
    }
}

/// The points and the normals, in object space.
impl Kernel for &Triangles {
    type Output = (Vectors, Vectors);

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> (Vectors, Vectors) {
        let (mut points, mut normals) = (Vectors::ZERO, Vectors::ZERO);
        let count = self.count.min(ROW);
        for k in 0..count {
            let weights = self.weights.get(k).truncate();
            points.set(k, point_of(self.corners(k), weights));
        }
        for k in 0..count {
            normals.set(k, normal_of(self.corners(k)));
        }
        (points, normals)
    }
}

/// Rays that met a shape.
struct ShapeHits {
    count: usize,
    origin: Vectors,
    direction: Vectors,
    t: Scalars,
    primitive: [i32; ROW],
}

impl ShapeHits {
    const NONE: Self = Self {
        count: 0,
        origin: Vectors::ZERO,
        direction: Vectors::ZERO,
        t: Scalars::all(0.0),
        primitive: [0; ROW],
    };

    #[inline]
    fn push(&mut self, surface: &SurfaceInteraction<'_>) {
        let k = self.count;
        self.origin.set(k, surface.ray.origin);
        self.direction.set(k, surface.ray.direction);
        self.t.set(k, surface.hit.t);
        self.primitive[k] = surface.hit.primitive;
        self.count += 1;
    }

    /// The points and the normals in the world; `None` on a mesh.
    fn find(&self, set: InstructionSet, object: &Object) -> Option<(Vectors, Vectors)> {
        let (hits, transform) = (self, object.transform());
        macro_rules! on {
            ($shape:expr) => {
                simd::run_here(set, OnShape { shape: $shape, transform, hits })
            };
        }
        Some(match object.shape() {
            Shape::Mesh(_) => return None,
            Shape::Sphere(sphere) => on!(&**sphere),
            Shape::Plane(plane) => on!(&**plane),
            Shape::Disc(disc) => on!(&**disc),
            Shape::Box(cuboid) => on!(&**cuboid),
            Shape::Cylinder(cylinder) => on!(cylinder.cone()),
            Shape::Cone(cone) => on!(&**cone),
        })
    }
}

/// Hits on a shape, whose points and normals lanes compute.
struct OnShape<'a, S> {
    shape: &'a S,
    transform: &'a Transform,
    hits: &'a ShapeHits,
}

impl<S: Surface> Kernel for OnShape<'_, S> {
    type Output = (Vectors, Vectors);

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> (Vectors, Vectors) {
        let Self { shape, transform, hits } = self;
        let (mut points, mut normals) = (Vectors::ZERO, Vectors::ZERO);
        let count = hits.count.min(ROW);
        for k in 0..count {
            let ray = Ray::new(hits.origin.get(k), hits.direction.get(k));
            points.set(k, transform.ray_in_object(&ray).at(hits.t.get(k)));
        }
        for k in 0..count {
            let normal = shape.normal(points.get(k), hits.primitive[k]);
            normals.set(k, transform.normal_in_world(normal));
        }
        for k in 0..count {
            let point = shape.onto(points.get(k), hits.primitive[k]);
            points.set(k, transform.point_in_world(point));
        }
        (points, normals)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::{DAffine3, DQuat, Hit};
    use crate::sampling::Draws;
    use crate::scene::Scene;
    use crate::shape::{Cone, Cuboid, Cylinder, Disc, Mesh, Plane, Positions, Shape, Sphere};

    fn vector(draws: &mut Draws) -> DVec3 {
        let [x, y, z] = draws.three();
        DVec3::new(x, y, z) - 0.5
    }

    /// Shapes of every kind but meshes.
    fn shapes() -> Vec<Shape> {
        let v = DVec3::new;
        let shapes = vec![
            Shape::from(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
            Sphere::new(v(0.5, -2.0, 3.0), 0.25).unwrap().into(),
            Plane::new(v(1.0, -2.0, 0.5), v(1.0, 2.0, -0.5)).unwrap().into(),
            Disc::new(v(1.0, 0.0, -1.0), v(3.0, -1.0, 2.0), 2.0).unwrap().into(),
            Cuboid::new(v(0.25, -3.0, 1.0), v(0.5, 4.0, 1.1)).unwrap().into(),
            Cylinder::new(DVec3::NEG_Z, DVec3::Z, 1.0).unwrap().into(),
            Cylinder::new(v(1.0, 1.0, 0.0), v(-1.0, 2.0, 3.0), 0.4).unwrap().into(),
            Cone::new(DVec3::NEG_Z, DVec3::Z, 1.0, 0.0).unwrap().into(),
            Cone::new(DVec3::Y, v(2.0, 2.0, -1.0), 0.2, 0.9).unwrap().into(),
            Cone::new(DVec3::ZERO, v(0.1, 0.0, 0.0), 3.0, 2.0).unwrap().into(),
        ];
        let is_there = |name| shapes.iter().any(|shape| shape.name() == name);
        assert!(Shape::NAMES.iter().all(|&name| name == "mesh" || is_there(name)));
        shapes
    }

    /// Every shape and a mesh of thin triangles, as they are, and placed; and rays that met them,
    /// those of an object not side by side.
    fn scene() -> (Scene, Vec<(Ray, Hit)>) {
        let mut draws = Draws::new(3, 1);
        let points: Vec<[f64; 3]> = (0..90)
            .map(|k| {
                let flat = DVec3::new(2.0, 1.0, 1e-3 * f64::from(k));
                (flat * vector(&mut draws)).to_array()
            })
            .collect();
        let triangles = (0..30).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let mesh = Mesh::new(Positions::compact(points), triangles).unwrap();
        let mut objects = vec![Object::new(Arc::new(mesh))];
        objects.extend(shapes().into_iter().map(Object::new));
        let placed = DAffine3::from_scale_rotation_translation(
            DVec3::new(1.5, -0.7, 1.0),
            DQuat::from_rotation_x(0.8),
            DVec3::new(0.1, 0.2, -0.3),
        );
        let placed = Transform::new(placed).unwrap();
        let moved: Vec<Object> =
            (objects.iter().cloned()).map(|object| object.placed(placed)).collect();
        objects.extend(moved);
        let mut hits = Vec::new();
        let scene = Scene::new(objects.clone()).unwrap();
        let objects: Vec<(usize, Object)> = objects.into_iter().enumerate().collect();
        for (some, k) in objects.chunks(3).flat_map(|some| (0..400).map(move |k| (some, k))) {
            for (number, object) in some {
                // Of each object alone: in the scene most are hidden.
                let from = 4.0 * vector(&mut draws);
                let ray = Ray::new(from, vector(&mut draws) - from);
                let in_object = object.transform().ray_in_object(&ray);
                let met = object.shape().intersect(&in_object);
                if let Some(met) = met.filter(|_| (k + number) % 3 > 0) {
                    let hit = Hit {
                        t: met.t,
                        object: i32::try_from(*number).unwrap(),
                        primitive: met.primitive,
                        barycentric: met.barycentric,
                    };
                    hits.push((ray, hit));
                }
            }
        }
        (scene, hits)
    }

    #[test]
    fn many_surfaces_are_where_each_says_by_itself() {
        let (scene, hits) = scene();
        assert!(hits.len() > 1000, "{}", hits.len());
        let surfaces = || {
            let surface = |(ray, hit)| scene.interaction(ray, hit).unwrap();
            hits.iter().map(|(ray, hit)| (ray, hit)).map(surface).collect::<Vec<_>>()
        };
        let bits = |surface: &SurfaceInteraction<'_>| {
            let numbers = [surface.position(), surface.normal()];
            numbers.map(|v| v.to_array().map(f64::to_bits))
        };
        let singly: Vec<_> = surfaces().iter().map(bits).collect();
        for set in InstructionSet::available() {
            let together = surfaces();
            compute_geometry(set, &together);
            let known = together.iter().filter(|it| it.geometry.get().is_some());
            // Rows of an object that has few hits are left.
            assert!(2 * known.count() > together.len(), "{set:?}");
            let together: Vec<_> = together.iter().map(bits).collect();
            assert_eq!(together, singly, "{set:?}");
        }
    }
}
