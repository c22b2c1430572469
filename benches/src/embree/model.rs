//! Objects in Embree's types: what is not moved is a geometry of the scene, what is moved an
//! instance of a scene with one geometry, which all objects of that mesh share.

use std::collections::HashMap;
use std::ffi::{c_int, c_void};
use std::sync::Arc;

use firsthit::{Object, Positions, Shape};

use super::api::{self, Api, Handle};

/// The objects of a scene.
#[derive(Debug)]
pub(crate) struct Model {
    shapes: Vec<Form>,
    /// The shape of each object and, if it is moved, its matrix, column by column.
    objects: Vec<(usize, Option<[f32; 12]>)>,
}

/// A shape that Embree has, too.
#[derive(Debug)]
enum Form {
    /// The vertices and one more, and their indices.
    Triangles(Vec<[f32; 3]>, Vec<[u32; 3]>),
    /// Centre and radius.
    Sphere(Ball),
}

/// Embree reads the four at once, from an aligned address.
#[derive(Debug, PartialEq)]
#[repr(C, align(16))]
struct Ball([f32; 4]);

impl Model {
    /// Makes Embree's scene of objects, in their order. An error where Embree has no such shape.
    pub(crate) fn new(objects: &[Object]) -> Result<Self, String> {
        let mut shapes = Vec::new();
        let mut known = HashMap::new();
        let mut placed = Vec::new();
        for object in objects {
            let mut add = || {
                shapes.push(form(object)?);
                Ok::<_, String>(shapes.len() - 1)
            };
            let mesh = object.mesh().map(Arc::as_ptr);
            let shape = match mesh.and_then(|mesh| known.get(&mesh)) {
                Some(&shape) => shape,
                None => add()?,
            };
            known.extend(mesh.map(|mesh| (mesh, shape)));
            let transform = object.transform();
            let matrix = transform.world_from_object().to_cols_array().map(|x| x as f32);
            placed.push((shape, (!transform.is_identity()).then_some(matrix)));
        }
        Ok(Self { shapes, objects: placed })
    }

    /// The number of triangles, those of a mesh that objects share once.
    pub(crate) fn triangles(&self) -> usize {
        let count = |form: &Form| match form {
            Form::Triangles(_, indices) => indices.len(),
            Form::Sphere(_) => 0,
        };
        self.shapes.iter().map(count).sum()
    }

    /// The scene with trees over all of it.
    ///
    /// # Safety
    ///
    /// The device is alive, and the model lives longer than the scene.
    pub(super) unsafe fn commit(&self, api: &Api, device: Handle, flags: c_int) -> Handle {
        // SAFETY: everything used here is alive, as the caller says or as it was just made.
        // Attached geometries and instanced scenes are kept by what they are in.
        unsafe {
            let new_scene = || {
                let scene = (api.new_scene)(device);
                (api.set_scene_flags)(scene, flags);
                (api.set_build_quality)(scene, api::QUALITY_MEDIUM);
                scene
            };
            let attach = |scene, geometry| {
                (api.commit_geometry)(geometry);
                (api.attach_geometry)(scene, geometry);
                (api.release_geometry)(geometry);
            };
            let scene = new_scene();
            let mut inner: Vec<Option<Handle>> = vec![None; self.shapes.len()];
            for (shape, matrix) in &self.objects {
                let form = &self.shapes[*shape];
                let Some(matrix) = matrix else {
                    attach(scene, form.geometry(api, device));
                    continue;
                };
                let instanced = *inner[*shape].get_or_insert_with(|| {
                    let alone = new_scene();
                    attach(alone, form.geometry(api, device));
                    (api.commit_scene)(alone);
                    alone
                });
                let instance = (api.new_geometry)(device, api::GEOMETRY_INSTANCE);
                (api.set_instanced_scene)(instance, instanced);
                let matrix = matrix.as_ptr().cast();
                (api.set_transform)(instance, 0, api::FORMAT_COLUMNS, matrix);
                attach(scene, instance);
            }
            for scene in inner.into_iter().flatten() {
                (api.release_scene)(scene);
            }
            (api.commit_scene)(scene);
            scene
        }
    }
}

impl Form {
    /// A geometry that shares these numbers.
    ///
    /// # Safety
    ///
    /// The device is alive, and `self` lives longer than the geometry.
    unsafe fn geometry(&self, api: &Api, device: Handle) -> Handle {
        // SAFETY: what the caller says. Sizes are those of the arrays, and vertices are followed by
        // one more, so that the last one may be read as 16 bytes.
        unsafe {
            let share = |geometry, buffer, format, from: *const c_void, each, count| {
                (api.set_shared_buffer)(geometry, buffer, 0, format, from, 0, each, count);
            };
            match self {
                Self::Triangles(corners, indices) => {
                    let geometry = (api.new_geometry)(device, api::GEOMETRY_TRIANGLE);
                    let (points, count) = (corners.as_ptr().cast(), corners.len() - 1);
                    let (float3, uint3) = (api::FORMAT_FLOAT3, api::FORMAT_UINT3);
                    share(geometry, api::BUFFER_VERTEX, float3, points, 12, count);
                    let (triangles, count) = (indices.as_ptr().cast(), indices.len());
                    share(geometry, api::BUFFER_INDEX, uint3, triangles, 12, count);
                    geometry
                }
                Self::Sphere(Ball(numbers)) => {
                    let geometry = (api.new_geometry)(device, api::GEOMETRY_SPHERE);
                    let (numbers, float4) = (numbers.as_ptr().cast(), api::FORMAT_FLOAT4);
                    share(geometry, api::BUFFER_VERTEX, float4, numbers, 16, 1);
                    geometry
                }
            }
        }
    }
}

fn form(object: &Object) -> Result<Form, String> {
    let single = |point: [f64; 3]| point.map(|x| x as f32);
    match object.shape() {
        Shape::Mesh(mesh) => {
            let mut corners = match mesh.positions().as_ref() {
                Positions::Single(points) => points.to_vec(),
                Positions::Double(points) => points.iter().map(|&point| single(point)).collect(),
            };
            corners.push([0.0; 3]);
            Ok(Form::Triangles(corners, mesh.triangles().to_vec()))
        }
        Shape::Sphere(sphere) => {
            let [x, y, z] = single(sphere.center().to_array());
            Ok(Form::Sphere(Ball([x, y, z, sphere.radius() as f32])))
        }
        _ => Err(format!("object {} must be a mesh or a sphere for Embree", object.name())),
    }
}

#[cfg(test)]
mod tests {
    use firsthit::geometry::Transform;
    use firsthit::{DVec3, Disc, Mesh, Sphere};

    use super::*;

    #[test]
    fn instances_share_their_mesh_and_what_is_not_moved_has_no_matrix() {
        let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(Positions::Single(corners.into()), vec![[0, 1, 2]]).unwrap();
        let mesh = Arc::new(mesh);
        let moved = Transform::translation(DVec3::X).unwrap();
        let ball = Sphere::new(DVec3::ZERO, 2.0).unwrap();
        let model = Model::new(&[
            Object::new(Arc::clone(&mesh)),
            Object::new(mesh).placed(moved),
            Object::new(ball),
        ])
        .unwrap();
        let matrix = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
        assert_eq!(model.triangles(), 1);
        assert_eq!(model.objects, [(0, None), (0, Some(matrix)), (1, None)]);
        assert!(matches!(model.shapes[1], Form::Sphere(Ball([0.0, 0.0, 0.0, 2.0]))));
    }

    #[test]
    fn a_shape_that_embree_has_not_is_refused() {
        let disc = Disc::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap();
        let error = Model::new(&[Object::new(disc).named("lid")]).unwrap_err();
        assert!(error.contains("lid"), "{error}");
    }
}
