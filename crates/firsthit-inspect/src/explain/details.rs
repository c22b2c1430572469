//! All details of a hit at once.

use std::sync::Arc;

use crate::error::Result;
use crate::geometry::{Color, DVec2, DVec3, Hit, Ray};
use crate::memory;
use crate::scene::{Material, Scene, SurfaceInteraction};
use crate::shape::PropertyOf;

/// A hit, the surface there, and its material. Positions and normals are those of
/// [`SurfaceInteraction`], in the world.
#[derive(Debug, Clone)]
pub struct HitDetails<'a> {
    /// The hit.
    pub hit: Hit,
    /// The object's name; may be empty.
    pub name: &'a str,
    /// The name of its shape, such as `mesh`.
    pub shape: &'static str,
    /// The position of the hit.
    pub position: DVec3,
    /// The geometric normal.
    pub normal: DVec3,
    /// The normal to shade with, in the world, of length one.
    pub shading_normal: DVec3,
    /// Whether the front was met.
    pub is_front: bool,
    /// The texture coordinates, if there are any.
    pub uv: Option<DVec2>,
    /// The polygon that the triangle was part of; of other shapes the primitive.
    pub face: i32,
    /// The linear colour of the surface there, with its texture, without light.
    pub color: Color,
    /// The node that the object comes from, as in the channel `node`; `None` where there is none.
    pub node: Option<CatalogEntry<'a>>,
    /// The mesh that the object is or is a part of, as in the channel `mesh`; `None` for other
    /// shapes.
    pub mesh: Option<CatalogEntry<'a>>,
    /// The material there, as in the channel `material`; `None` for an object without any.
    pub material_entry: Option<CatalogEntry<'a>>,
    /// The material there.
    pub material: Option<&'a Material>,
    /// The attributes of its mesh there.
    pub attributes: Vec<AttributeThere<'a>>,
}

/// A node, a mesh or a material of the scene: its place in the [catalog](crate::scene::Catalog),
/// and its name there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CatalogEntry<'a> {
    /// The number in the catalog, which the channels `node`, `mesh` and `material` have too.
    pub number: i32,
    /// The name; may be empty.
    pub name: &'a str,
}

impl<'a> CatalogEntry<'a> {
    /// `None` for -1, the number of what is not there.
    fn new(number: i32, names: &'a [Arc<str>]) -> Option<Self> {
        let name = names.get(usize::try_from(number).ok()?)?;
        Some(Self { number, name })
    }
}

/// An attribute of a mesh at a point of a triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct AttributeThere<'a> {
    /// The attribute's name.
    pub name: &'a str,
    /// The elements that have the values.
    pub of: PropertyOf,
    /// The value, interpolated as
    /// [`NamedAttribute::look_up`](crate::shape::NamedAttribute::look_up) has it.
    pub values: Vec<f64>,
}

impl<'a> HitDetails<'a> {
    /// The details of a ray's hit; `None` for a miss.
    pub(super) fn new(scene: &'a Scene, ray: &Ray, hit: &Hit) -> Result<Option<Self>> {
        let (Some(surface), Some(object)) = (scene.interaction(ray, hit), scene.object(hit)) else {
            return Ok(None);
        };
        let catalog = scene.catalog();
        let number = usize::try_from(hit.object).unwrap_or(usize::MAX);
        let material = catalog.material_of(number, object, hit.primitive);
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
            node: CatalogEntry::new(catalog.node_of(number), catalog.nodes()),
            mesh: CatalogEntry::new(catalog.mesh_of(number), catalog.meshes()),
            material_entry: CatalogEntry::new(material, catalog.materials()),
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
