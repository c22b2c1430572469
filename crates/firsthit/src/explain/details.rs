//! What there is to know about a hit, all at once.

use crate::error::Result;
use crate::geometry::{Color, DVec2, DVec3, Hit, Ray};
use crate::memory;
use crate::scene::{Material, Scene, SurfaceInteraction};
use crate::shape::PropertyOf;

/// A hit, the surface there, and its material. Positions and normals are those of [`SurfaceInteraction`], in the world.
#[derive(Debug, Clone)]
pub struct HitDetails<'a> {
    /// The hit.
    pub hit: Hit,
    /// The object's name; may be empty.
    pub name: &'a str,
    /// The name of its shape, such as `mesh`.
    pub shape: &'static str,
    /// Where it is.
    pub position: DVec3,
    /// The geometric normal.
    pub normal: DVec3,
    /// The normal to shade with.
    pub shading_normal: DVec3,
    /// Whether the front was met.
    pub is_front: bool,
    /// The texture coordinates, if there are any.
    pub uv: Option<DVec2>,
    /// The polygon that the triangle was part of; of other shapes the primitive.
    pub face: i32,
    /// The linear colour of the surface there, with its texture, without light.
    pub color: Color,
    /// Which of the object's materials.
    pub slot: Option<usize>,
    /// That material; `None` for an object without any.
    pub material: Option<&'a Material>,
    /// The attributes of its mesh there.
    pub attributes: Vec<AttributeThere<'a>>,
}

/// An attribute of a mesh at a point of a triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct AttributeThere<'a> {
    /// Its name.
    pub name: &'a str,
    /// What has its values.
    pub of: PropertyOf,
    /// The value, interpolated as [`NamedAttribute::look_up`](crate::shape::NamedAttribute::look_up) has it.
    pub values: Vec<f64>,
}

impl<'a> HitDetails<'a> {
    /// Those of a ray's hit; `None` for a miss.
    pub(super) fn new(scene: &'a Scene, ray: &Ray, hit: &Hit) -> Result<Option<Self>> {
        let (Some(surface), Some(object)) = (scene.interaction(ray, hit), scene.object(hit)) else {
            return Ok(None);
        };
        let materials = object.materials().len();
        let triangle = usize::try_from(hit.primitive).unwrap_or(0);
        let slot = object.mesh().map_or(0, |mesh| mesh.slot(triangle));
        Ok(Some(Self {
            hit: *hit,
            name: object.name(),
            shape: object.shape().name(),
            position: surface.position(),
            normal: surface.normal(),
            shading_normal: surface.shading_normal(),
            is_front: surface.is_front(),
            uv: surface.uv(),
            face: surface.face(),
            color: surface.color(),
            // The last one serves for slots beyond.
            slot: materials.checked_sub(1).map(|last| slot.min(last)),
            material: object.material(hit.primitive),
            attributes: attributes(scene, &surface)?,
        }))
    }
}

/// The attributes of the mesh that was hit.
fn attributes<'a>(
    scene: &'a Scene,
    surface: &SurfaceInteraction<'_>,
) -> Result<Vec<AttributeThere<'a>>> {
    let hit = surface.hit();
    let mesh = scene.object(hit).and_then(|object| object.mesh());
    let (Some(mesh), Ok(triangle)) = (mesh, usize::try_from(hit.primitive)) else {
        return Ok(Vec::new());
    };
    let there = mesh.attributes().map(|attribute| {
        let mut values = memory::filled(attribute.components(), f64::NAN)?;
        attribute.look_up(triangle, hit.barycentric, &mut values);
        let (name, of) = (attribute.name(), attribute.of());
        Ok(AttributeThere { name, of, values })
    });
    there.collect()
}
