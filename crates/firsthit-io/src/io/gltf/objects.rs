//! Makes objects of placed nodes.

use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use super::super::fault::{Checked, Fault};
use super::super::memory_budget::{OBJECT_BYTES, check_free};
use super::super::report::Report;
use super::accessor::{Elements, Shape, declared};
use super::buffers::Buffers;
use super::document::{Document, Instancing};
use super::index::Index;
use super::material::{Look, Looks};
use super::mesh::{self, Deformation, Shared};
use super::nodes::{self, Placed, affine, of_length_one};
use super::skin::{self, Palette};
use super::values::Values;
use crate::error::escape_controls;
use crate::geometry::{DAffine3, Transform};
use crate::scene::{Label, Material, Object};
use crate::shape::Mesh;

/// Makes objects. A mesh that several nodes name is made once.
pub(super) struct Objects<'a, 'b, 'w> {
    document: &'a Document<'a>,
    placed: &'b [Placed<'a>],
    buffers: Buffers<'a>,
    report: &'b mut Report<'w>,
    looks: Looks,
    shared: Shared,
    meshes: HashMap<(usize, usize), Option<Arc<Mesh>>>,
    palettes: HashMap<Index, Rc<Palette>>,
    /// The transforms of all nodes, once a skin asked for them.
    worlds: Option<Vec<Option<DAffine3>>>,
    /// The primitives of a mesh that have triangles, once a node showed it: a mesh of many others
    /// is then no work for any further node.
    visible: HashMap<usize, Rc<[usize]>>,
    labels: HashMap<usize, Label>,
    made: Vec<Object>,
}

impl<'a, 'b, 'w> Objects<'a, 'b, 'w> {
    pub(super) fn new(
        document: &'a Document<'a>,
        placed: &'b [Placed<'a>],
        buffers: Buffers<'a>,
        report: &'b mut Report<'w>,
    ) -> Self {
        Self {
            document,
            placed,
            buffers,
            report,
            looks: Looks::default(),
            shared: Shared::default(),
            meshes: HashMap::new(),
            palettes: HashMap::new(),
            worlds: None,
            visible: HashMap::new(),
            labels: HashMap::new(),
            made: Vec::new(),
        }
    }

    /// An object for each primitive of each node that has triangles.
    pub(super) fn all(mut self) -> Checked<Vec<Object>> {
        for (number, place) in self.placed.iter().enumerate() {
            if let Some(Index(mesh)) = place.node.mesh {
                self.node(number, place, mesh)?;
            }
        }
        Ok(self.made)
    }

    fn node(&mut self, number: usize, place: &Placed<'a>, mesh: usize) -> Checked<()> {
        let Some(entry) = self.document.meshes.get(mesh) else {
            return Ok(());
        };
        let primitives: Rc<[usize]> = match self.visible.get(&mesh) {
            Some(known) => Rc::clone(known),
            None => (0..entry.primitives.len()).collect(),
        };
        if primitives.is_empty() {
            return Ok(());
        }
        let labels = self.labels(number, mesh)?;
        let name = place.name(entry.name.as_deref());
        let name = name.unwrap_or_else(|| format!("node {}", place.index));
        // Mostly it is there already.
        let same = labels.iter().find(|label| *label.name == *name);
        let name = same.map_or_else(|| name.into(), |label| Arc::clone(&label.name));
        let instances = match &place.node.extensions.instancing {
            Some(instancing) => self.instances(instancing, place)?.into(),
            None => Cow::Borrowed(&[DAffine3::IDENTITY][..]),
        };
        let mut visible = Vec::new();
        for &number in &*primitives {
            if self.primitive(place, (mesh, number), (&name, &labels), &instances)? {
                visible.push(number);
            }
        }
        if visible.len() < primitives.len() || !self.visible.contains_key(&mesh) {
            self.visible.insert(mesh, visible.into());
        }
        Ok(())
    }

    /// The labels of a node and of its mesh.
    fn labels(&mut self, place: usize, mesh: usize) -> Checked<[Label; 2]> {
        let node = nodes::label(self.placed, place);
        let budget = &mut self.report.budget;
        budget.charge(node.name.len() as u64, "a node's path")?;
        if let Some(known) = self.labels.get(&mesh) {
            return Ok([node, known.clone()]);
        }
        let entry = self.document.meshes.get(mesh);
        let name = entry.and_then(|entry| entry.name.as_deref());
        let name = escape_controls(name.unwrap_or_default());
        budget.charge(name.len() as u64, "a mesh's name")?;
        let label = Label { number: mesh as u64, name: name.into() };
        self.labels.insert(mesh, label.clone());
        Ok([node, label])
    }

    /// Makes the objects of a primitive; whether it has triangles at all, by its kind.
    fn primitive(
        &mut self,
        place: &Placed<'a>,
        primitive: (usize, usize),
        (name, [node, mesh_label]): (&Arc<str>, &[Label; 2]),
        instances: &[DAffine3],
    ) -> Checked<bool> {
        let entry = self.document.meshes.get(primitive.0);
        let described = entry.and_then(|entry| entry.primitives.get(primitive.1));
        let (Some(entry), Some(described)) = (entry, described) else {
            return Ok(false);
        };
        let has_joints = described.attributes.contains_key("JOINTS_0");
        let skin = place.node.skin.filter(|_| has_joints);
        let palette = skin.map(|skin| self.palette(skin)).transpose()?;
        let own_weights = place.node.weights.as_deref();
        let own_weights = own_weights.filter(|_| !described.targets.is_empty());
        let deformation = Deformation {
            weights: own_weights.unwrap_or(&entry.weights),
            palette: palette.as_deref(),
            node: place.world_from_node,
            flattened: None,
        };
        let look = described.material.map(|material| {
            self.looks.look(self.document, material, &mut self.buffers, self.report)
        });
        let look = look.transpose()?;
        let is_shared = palette.is_none() && own_weights.is_none();
        let known = self.meshes.get(&primitive).filter(|_| is_shared).cloned();
        let mesh = if let Some(mesh) = known {
            mesh
        } else {
            let made = self.mesh(primitive, &deformation, look.as_ref(), name)?;
            if is_shared {
                self.meshes.insert(primitive, made.clone());
            }
            made
        };
        let Some(mesh) = mesh else {
            return Ok(false);
        };
        // Joints are in the world already.
        let world = palette.as_ref().map_or(place.world_from_node, |_| DAffine3::IDENTITY);
        let is_painted = described.attributes.contains_key("COLOR_0");
        for &instance in instances {
            let placed = self.placed(
                world * instance,
                (&mesh, primitive, &deformation),
                (place, look.as_ref(), name),
            )?;
            let Some((mesh, transform)) = placed else {
                continue;
            };
            self.make_room(name)?;
            let object = Object::new(mesh).named(Arc::clone(name)).placed(transform);
            let object = object.from_node(node.clone());
            let object = object.from_mesh(mesh_label.clone());
            self.made.push(match &look {
                Some(look) => object.with_materials(Arc::clone(&look.materials)),
                // White leaves the vertices' own colours as they are.
                None if is_painted => object.with_materials([Material::default()]),
                None => object,
            });
        }
        Ok(true)
    }

    /// Pays for one more object; the system is asked whenever the list is about to double.
    fn make_room(&mut self, name: &str) -> Checked<()> {
        let each = OBJECT_BYTES + name.len() as u64;
        self.report.budget.charge(each, "an object")?;
        if self.made.len() == self.made.capacity() {
            let each = usize::try_from(each).unwrap_or(usize::MAX);
            check_free((2 * self.made.len()).saturating_mul(each))?;
        }
        Ok(())
    }

    /// A mesh and the way from it to the world; where that flattens space, which objects cannot, a
    /// mesh that is flat itself, if anything is left of it.
    fn placed(
        &mut self,
        world_from_mesh: DAffine3,
        (mesh, primitive, deformation): (&Arc<Mesh>, (usize, usize), &Deformation<'_>),
        (place, look, name): (&Placed<'a>, Option<&Look>, &str),
    ) -> Checked<Option<(Arc<Mesh>, Transform)>> {
        if let Ok(transform) = Transform::new(world_from_mesh) {
            return Ok(Some((Arc::clone(mesh), transform)));
        }
        self.report.warn("flat", &place.entry().place(), || {
            "the transform has no inverse in float64 (it flattens space, or is out of range): its surfaces are flat"
                .to_owned()
        });
        let deformation = Deformation { flattened: Some(world_from_mesh), ..*deformation };
        let flat = self.mesh(primitive, &deformation, look, name)?;
        Ok(flat.map(|flat| (flat, Transform::IDENTITY)))
    }

    fn mesh(
        &mut self,
        primitive: (usize, usize),
        deformation: &Deformation<'_>,
        look: Option<&Look>,
        name: &str,
    ) -> Checked<Option<Arc<Mesh>>> {
        let mut values = Values::new(self.document, primitive, &mut self.buffers, self.report)?;
        let mesh = mesh::build(&mut values, deformation, look, name, &mut self.shared)?;
        Ok(mesh.map(Arc::new))
    }

    fn palette(&mut self, skin: Index) -> Checked<Rc<Palette>> {
        if let Some(known) = self.palettes.get(&skin) {
            return Ok(Rc::clone(known));
        }
        let (document, placed) = (self.document, self.placed);
        let worlds = self.worlds.get_or_insert_with(|| skin::worlds(document, placed));
        let palette = skin::palette(document, skin, worlds, &mut self.buffers, self.report)?;
        let palette = Rc::new(palette);
        self.palettes.insert(skin, Rc::clone(&palette));
        Ok(palette)
    }

    /// The transforms of the instances of a node's mesh, relative to the node
    /// (`EXT_mesh_gpu_instancing`).
    fn instances(
        &mut self,
        instancing: &Instancing<'a>,
        place: &Placed<'a>,
    ) -> Checked<Vec<DAffine3>> {
        let place_of = |name: &str| {
            let name = super::place::key(name);
            let value = format!("extensions/EXT_mesh_gpu_instancing/attributes/{name}");
            place.entry().at(value)
        };
        let Some((first, &index)) = instancing.attributes.first_key_value() else {
            let what = "there are none: nothing says how many instances there are";
            return Err(Fault::at(place_of(""), what));
        };
        let Index(count) = declared(self.document, index)?.count;
        for (name, &index) in &instancing.attributes {
            if !["TRANSLATION", "ROTATION", "SCALE"].contains(&name.as_ref()) {
                self.report.warn("instances", &place_of(name), || {
                    "this attribute of instances is not read".to_owned()
                });
            }
            let Index(other) = declared(self.document, index)?.count;
            if other != count {
                let first = escape_controls(first);
                let what = format!("has {other} values, {first} has {count}");
                return Err(Fault::at(place_of(name), what));
            }
        }
        // Before anything else is made of a count that nothing may stand behind.
        let needed = (count as u64).saturating_mul(size_of::<DAffine3>() as u64 + OBJECT_BYTES);
        let budget = &mut self.report.budget;
        if needed > budget.left_to_describe() {
            budget.charge_at(place_of(first), needed, "the instances")?;
        }
        let placements = (count as u64).saturating_mul(size_of::<DAffine3>() as u64);
        budget.charge_at(place_of(first), placements, "the instances")?;
        let translations = self.values::<3>(instancing, "TRANSLATION", &Shape::VEC3)?;
        let mut rotations = self.values::<4>(instancing, "ROTATION", &Shape::VEC4)?;
        for rotation in rotations.iter_mut().flatten() {
            // Float32's own rounding is left as it is.
            *rotation = of_length_one((*rotation, 1e-6), || place_of("ROTATION"), self.report);
        }
        let scales = self.values::<3>(instancing, "SCALE", &Shape::VEC3)?;
        let instances = (0..count).map(|k| {
            affine(
                at(translations.as_ref(), k, [0.0; 3]),
                at(rotations.as_ref(), k, [0.0, 0.0, 0.0, 1.0]),
                at(scales.as_ref(), k, [1.0; 3]),
            )
        });
        Ok(instances.collect())
    }

    fn values<const N: usize>(
        &mut self,
        instancing: &Instancing<'_>,
        name: &str,
        shape: &Shape,
    ) -> Checked<Option<Vec<[f64; N]>>> {
        let Some(&index) = instancing.attributes.get(name) else {
            return Ok(None);
        };
        let elements = Elements::new(self.document, index, shape, &mut self.buffers, self.report)?;
        Ok(Some(elements.read(self.report)?))
    }
}

/// One of some values, if there are any.
fn at<T: Copy>(values: Option<&Vec<T>>, k: usize, missing: T) -> T {
    values.and_then(|values| values.get(k).copied()).unwrap_or(missing)
}
