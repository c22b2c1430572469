//! The tables of a file: each thing that objects share stands once, by its number.

use std::collections::HashMap;
use std::sync::Arc;

use super::look::{MapRecord, MaterialRecord};
use super::number::{Number, Triple};
use super::record::{LabelRecord, ObjectRecord, ShapeRecord};
use crate::geometry::DAffine3;
use crate::scene::{Label, Material, Object, Texture};
use crate::shape::{Mesh, Positions, Shape};

/// Things that many share, each once, by where they are in memory.
pub(super) struct Shared<'a, T> {
    numbers: HashMap<*const T, usize>,
    pub(super) list: Vec<&'a Arc<T>>,
}

impl<T> Default for Shared<'_, T> {
    fn default() -> Self {
        Self { numbers: HashMap::new(), list: Vec::new() }
    }
}

impl<'a, T> Shared<'a, T> {
    /// The number of a thing.
    pub(super) fn number(&mut self, thing: &'a Arc<T>) -> usize {
        *self.numbers.entry(Arc::as_ptr(thing)).or_insert_with(|| {
            self.list.push(thing);
            self.list.len() - 1
        })
    }
}

/// The tables of what objects share.
#[derive(Default)]
pub(super) struct Tables<'a> {
    pub(super) meshes: Shared<'a, Mesh>,
    pub(super) positions: Shared<'a, Positions>,
    pub(super) textures: Shared<'a, Texture>,
    /// Lists of materials, by where they are in memory.
    lists: HashMap<*const [Material], usize>,
    pub(super) materials: Vec<Vec<MaterialRecord>>,
    pub(super) maps: Vec<MapRecord>,
    label_numbers: HashMap<&'a Label, usize>,
    pub(super) labels: Vec<LabelRecord>,
}

impl<'a> Tables<'a> {
    pub(super) fn object(&mut self, object: &'a Object) -> ObjectRecord {
        let transform = object.transform();
        ObjectRecord {
            name: object.name().to_owned(),
            shape: self.shape(object.shape()),
            transform: (!transform.is_identity()).then(|| columns(transform.world_from_object())),
            materials: (!object.materials().is_empty()).then(|| self.list(object)),
            mask: (object.mask() != u32::MAX).then(|| object.mask()),
            is_hidden: object.is_hidden(),
            is_removed: object.is_removed(),
            node: object.node().map(|label| self.label(label)),
            mesh_label: object.mesh_label().map(|label| self.label(label)),
        }
    }

    fn label(&mut self, label: &'a Label) -> usize {
        *self.label_numbers.entry(label).or_insert_with(|| {
            self.labels.push(LabelRecord { number: label.number, name: label.name.to_string() });
            self.labels.len() - 1
        })
    }

    fn list(&mut self, object: &'a Object) -> usize {
        let list = object.materials();
        if let Some(&known) = self.lists.get(&Arc::as_ptr(list)) {
            return known;
        }
        let records = list.iter().map(|material| {
            MaterialRecord::new(material, |map| {
                let texture = self.textures.number(&map.texture);
                self.maps.push(MapRecord::new(map, texture));
                self.maps.len() - 1
            })
        });
        let records = records.collect();
        self.materials.push(records);
        self.lists.insert(Arc::as_ptr(list), self.materials.len() - 1);
        self.materials.len() - 1
    }

    fn shape(&mut self, shape: &'a Shape) -> ShapeRecord {
        match shape {
            Shape::Mesh(mesh) => ShapeRecord::Mesh(self.meshes.number(mesh)),
            Shape::Sphere(sphere) => {
                ShapeRecord::Sphere(sphere.center().into(), Number(sphere.radius()))
            }
            Shape::Plane(plane) => ShapeRecord::Plane(plane.point().into(), plane.facing().into()),
            Shape::Disc(disc) => {
                let (center, facing) = (disc.center().into(), disc.facing().into());
                ShapeRecord::Disc(center, facing, Number(disc.radius()))
            }
            Shape::Box(cuboid) => ShapeRecord::Box(cuboid.low().into(), cuboid.high().into()),
            Shape::Cylinder(cylinder) => {
                let (bottom, top) = (cylinder.bottom().into(), cylinder.top().into());
                ShapeRecord::Cylinder(bottom, top, Number(cylinder.radius()))
            }
            Shape::Cone(cone) => {
                let radii = [cone.bottom_radius(), cone.top_radius()].map(Number);
                let [bottom_radius, top_radius] = radii;
                let (bottom, top) = (cone.bottom().into(), cone.top().into());
                ShapeRecord::Cone(bottom, top, bottom_radius, top_radius)
            }
        }
    }
}

fn columns(affine: &DAffine3) -> [Triple; 4] {
    let (m, t) = (affine.matrix3, affine.translation);
    [m.x_axis, m.y_axis, m.z_axis, t].map(Triple::from)
}
