//! The names that objects come from: numbers for the nodes, meshes and materials of a scene.

use std::collections::HashMap;
use std::hash::Hash;
use std::ops::Range;
use std::sync::Arc;

use super::{MapRole, Material, Object, Scene, TextureMap};
use crate::geometry::Value;
use crate::parallel;
use crate::shape::Mesh;

/// A node or a mesh of a file. Two objects come from the same one if their labels are equal.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Label {
    /// The number in the file, which tells nodes and meshes with equal names apart.
    pub number: u64,
    /// The name, which may be empty; of a node the path from the root, such as `truck/wheel`.
    pub name: Arc<str>,
}

/// The nodes, meshes and materials of a scene, each with a number: its place in the order in which
/// objects have them. See [`Scene::catalog`].
///
/// - A **node** is one of the file's tree; objects from formats without a tree have none.
/// - A **mesh** is one of the file, whose parts may be several objects. Of meshes without a label,
///   those that objects share are one.
/// - A **material** is known by its name and its look: two that are alike in both are one.
///
/// An object is itself an instance, of a mesh at a node, so that instances have no other number
/// than objects.
#[derive(Debug, Clone, Default)]
pub struct Catalog {
    nodes: Vec<Arc<str>>,
    meshes: Vec<Arc<str>>,
    materials: Vec<Arc<str>>,
    objects: Vec<Entry>,
    /// The materials of lists, one list after the other.
    lists: Vec<i32>,
}

/// The numbers of an object's node and mesh, -1 for none, and where its materials stand among the
/// lists.
#[derive(Debug, Clone)]
struct Entry {
    node: i32,
    mesh: i32,
    materials: Range<usize>,
}

impl Scene {
    /// The nodes, meshes and materials that objects come from. Made once for a scene.
    ///
    /// ```
    /// use firsthit::{DVec3, Material, Object, Scene, Sphere};
    ///
    /// let steel = Material { name: "steel".into(), ..Material::default() };
    /// let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0)?).with_materials([steel]);
    /// let scene = Scene::new(vec![ball.clone(), ball])?;
    /// assert_eq!(&*scene.catalog().materials()[0], "steel");
    /// assert_eq!(scene.catalog().materials_of(1), [0]);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn catalog(&self) -> &Catalog {
        parallel::once::<Arc<_>>(&self.derived.catalog, || Arc::new(Catalog::of(&self.objects)))
    }
}

impl Catalog {
    /// The names of the nodes.
    pub fn nodes(&self) -> &[Arc<str>] {
        &self.nodes
    }

    /// The names of the meshes.
    pub fn meshes(&self) -> &[Arc<str>] {
        &self.meshes
    }

    /// The names of the materials.
    pub fn materials(&self) -> &[Arc<str>] {
        &self.materials
    }

    /// The number of an object's node; -1 for none.
    pub fn node_of(&self, object: usize) -> i32 {
        self.objects.get(object).map_or(-1, |entry| entry.node)
    }

    /// The number of an object's mesh; -1 for other shapes.
    pub fn mesh_of(&self, object: usize) -> i32 {
        self.objects.get(object).map_or(-1, |entry| entry.mesh)
    }

    /// The numbers of an object's materials, in the order of a mesh's slots; none for an object
    /// without a look.
    pub fn materials_of(&self, object: usize) -> &[i32] {
        let entry = self.objects.get(object);
        let list = entry.and_then(|entry| self.lists.get(entry.materials.clone()));
        list.unwrap_or_default()
    }

    /// The number of the material of an object's primitive; -1 for an object without a look.
    #[doc(hidden)]
    pub fn material_of(&self, number: usize, object: &Object, primitive: i32) -> i32 {
        let slot = object.material_slot(primitive);
        let of_slot = |slot: usize| self.materials_of(number).get(slot).copied();
        slot.and_then(of_slot).unwrap_or(-1)
    }

    fn of(objects: &[Object]) -> Self {
        let mut catalog = Self::default();
        let (mut nodes, mut meshes) = (Numbering::default(), Numbering::default());
        let (mut materials, mut lists) = (Numbering::default(), HashMap::new());
        for object in objects {
            let node = object.node();
            let node = node.map_or(-1, |node| nodes.number(node.clone(), || node.name.clone()));
            let mesh = object.mesh().map_or(-1, |mesh| {
                let label = object.mesh_label();
                let name = || label.map(|label| Arc::clone(&label.name));
                let key = label.map_or_else(
                    || MeshKey::Shared(Arc::as_ptr(mesh)),
                    |label| MeshKey::Labelled(label.clone()),
                );
                meshes.number(key, || name().unwrap_or_default())
            });
            let list = object.materials();
            // Lists are shared: each is looked at once.
            let range = lists.entry(list.as_ptr()).or_insert_with(|| {
                let first = catalog.lists.len();
                let number = |material: &Material| {
                    materials.number(MaterialKey::of(material), || material.name.clone())
                };
                catalog.lists.extend(list.iter().map(number));
                first..catalog.lists.len()
            });
            catalog.objects.push(Entry {
                node,
                mesh,
                materials: if list.is_empty() { 0..0 } else { range.clone() },
            });
        }
        catalog.nodes = nodes.names;
        catalog.meshes = meshes.names;
        catalog.materials = materials.names;
        catalog
    }
}

/// Numbers for things, in the order in which they come, and their names.
struct Numbering<K> {
    known: HashMap<K, i32>,
    names: Vec<Arc<str>>,
}

impl<K> Default for Numbering<K> {
    fn default() -> Self {
        Self { known: HashMap::new(), names: Vec::new() }
    }
}

impl<K: Hash + Eq> Numbering<K> {
    fn number(&mut self, key: K, name: impl FnOnce() -> Arc<str>) -> i32 {
        *self.known.entry(key).or_insert_with(|| {
            self.names.push(name());
            // More than 2^31 things do not fit into the memory of objects that have them.
            i32::try_from(self.names.len() - 1).unwrap_or(-1)
        })
    }
}

/// Identifies a mesh: by its label, or by the mesh that objects share.
#[derive(PartialEq, Eq, Hash)]
enum MeshKey {
    Labelled(Label),
    Shared(*const Mesh),
}

/// Identifies a material: by its name and its look. Numbers count by their bits, textures by where
/// they are in memory.
#[derive(PartialEq, Eq, Hash)]
struct MaterialKey {
    name: Arc<str>,
    /// Colour, alpha, cutoff, emission, strengths; then the model's settings.
    numbers: Vec<u64>,
    model: &'static str,
    flags: [bool; 2],
    alpha_mode: &'static str,
    maps: Vec<(MapRole, MapKey)>,
}

impl MaterialKey {
    fn of(material: &Material) -> Self {
        let Material {
            name,
            color,
            alpha,
            model,
            emission,
            maps,
            normal_scale,
            occlusion_strength,
            alpha_mode,
            unlit,
            double_sided,
        } = material;
        let (alpha_mode, cutoff) = (alpha_mode.name(), alpha_mode.cutoff().unwrap_or(0.0));
        let mut numbers = [*color, *emission].map(|color| color.to_array()).concat();
        numbers.extend([*alpha, cutoff, *normal_scale, *occlusion_strength]);
        for (_, value) in model.settings() {
            match value {
                Value::Flag(flag) => numbers.push(f64::from(flag)),
                Value::Number(number) => numbers.push(number),
                Value::Vector(vector) => numbers.extend(vector.to_array()),
            }
        }
        Self {
            name: Arc::clone(name),
            numbers: numbers.into_iter().map(f64::to_bits).collect(),
            model: model.name(),
            flags: [*unlit, *double_sided],
            alpha_mode,
            maps: maps.roles().map(|(role, map)| (role, MapKey::of(map))).collect(),
        }
    }
}

#[derive(PartialEq, Eq, Hash)]
struct MapKey {
    texture: usize,
    wrap: [u8; 2],
    filter: u8,
    uv_set: u8,
    picture_from_uv: [[u64; 3]; 2],
}

impl MapKey {
    fn of(map: &TextureMap) -> Self {
        Self {
            texture: Arc::as_ptr(&map.texture).addr(),
            wrap: map.wrap.map(|wrap| wrap as u8),
            filter: map.filter as u8,
            uv_set: map.uv_set as u8,
            picture_from_uv: map.picture_from_uv.map(|row| row.map(f64::to_bits)),
        }
    }
}
