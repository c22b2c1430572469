//! Checks that every index of a document names something that exists, used or not.

use super::super::fault::Checked;
use super::document::{Attributes, BufferView, Document, MeshEntry, Node};
use super::index::Index;
use super::place::{Entry, key};
use crate::error::Place;
use crate::io::fault::Fault;

/// Refuses a document with an index out of range.
pub(super) fn check(document: &Document<'_>) -> Checked<()> {
    if let Some(Index(scene)) = document.scene
        && scene >= document.scenes.len()
        && !document.scenes.is_empty()
    {
        let what = missing("scene", scene, document.scenes.len());
        return Err(Fault::at(Place::Pointer("/scene".into()), what));
    }
    let nodes = Count::of("node", &document.nodes);
    let accessors = Count::of("accessor", &document.accessors);
    let views = Count::of("buffer view", &document.buffer_views);
    for (entry, scene) in entries("scenes", &document.scenes) {
        nodes.all(&scene.nodes, entry, "nodes")?;
    }
    for (entry, node) in entries("nodes", &document.nodes) {
        check_node(document, node, entry)?;
    }
    for (entry, mesh) in entries("meshes", &document.meshes) {
        check_mesh(document, mesh, entry)?;
    }
    for (entry, skin) in entries("skins", &document.skins) {
        nodes.all(&skin.joints, entry, "joints")?;
        accessors.option(skin.inverse_bind_matrices, entry, "inverseBindMatrices")?;
    }
    for (entry, accessor) in entries("accessors", &document.accessors) {
        views.option(accessor.buffer_view, entry, "bufferView")?;
        if let Some(sparse) = &accessor.sparse {
            let (indices, values) = (sparse.indices.buffer_view, sparse.values.buffer_view);
            views.option(Some(indices), entry, "sparse/indices/bufferView")?;
            views.option(Some(values), entry, "sparse/values/bufferView")?;
        }
    }
    for (entry, view) in entries("bufferViews", &document.buffer_views) {
        check_view(document, view, entry)?;
    }
    for (entry, image) in entries("images", &document.images) {
        views.option(image.buffer_view, entry, "bufferView")?;
    }
    check_materials(document)
}

fn missing(kind: &str, index: usize, count: usize) -> String {
    format!("there is no {kind} {index}: there are {count}")
}

/// The things of a list of the document, each with its place.
fn entries<'a, T>(list: &'static str, all: &'a [T]) -> impl Iterator<Item = (Entry, &'a T)> {
    let all = all.iter().enumerate();
    all.map(move |(k, one)| (Entry::new(list, k), one))
}

/// The number of entries of a kind.
struct Count {
    kind: &'static str,
    count: usize,
}

impl Count {
    fn of<T>(kind: &'static str, all: &[T]) -> Self {
        let count = all.len();
        Self { kind, count }
    }

    fn option(&self, index: Option<Index>, entry: Entry, value: &str) -> Checked<()> {
        match index {
            Some(Index(index)) if index >= self.count => {
                Err(entry.fault(value, missing(self.kind, index, self.count)))
            }
            _ => Ok(()),
        }
    }

    fn all(&self, indices: &[Index], entry: Entry, value: &str) -> Checked<()> {
        match indices.iter().position(|&Index(index)| index >= self.count) {
            None => Ok(()),
            Some(k) => self.option(indices.get(k).copied(), entry, &format!("{value}/{k}")),
        }
    }

    fn attributes(&self, attributes: &Attributes<'_>, entry: Entry, value: &str) -> Checked<()> {
        for (name, &index) in attributes {
            if index.0 >= self.count {
                let value = format!("{value}/{}", key(name));
                self.option(Some(index), entry, &value)?;
            }
        }
        Ok(())
    }
}

fn check_node(document: &Document<'_>, node: &Node<'_>, entry: Entry) -> Checked<()> {
    Count::of("node", &document.nodes).all(&node.children, entry, "children")?;
    Count::of("mesh", &document.meshes).option(node.mesh, entry, "mesh")?;
    Count::of("camera", &document.cameras).option(node.camera, entry, "camera")?;
    Count::of("skin", &document.skins).option(node.skin, entry, "skin")?;
    let lights = document.extensions.lights.as_ref();
    let lights = lights.map_or(&[][..], |lights| lights.lights.as_slice());
    let light = node.extensions.light.as_ref().map(|light| light.light);
    Count::of("light", lights).option(light, entry, "extensions/KHR_lights_punctual/light")?;
    if let Some(instancing) = &node.extensions.instancing {
        let value = "extensions/EXT_mesh_gpu_instancing/attributes";
        let accessors = Count::of("accessor", &document.accessors);
        accessors.attributes(&instancing.attributes, entry, value)?;
    }
    Ok(())
}

fn check_mesh(document: &Document<'_>, mesh: &MeshEntry<'_>, entry: Entry) -> Checked<()> {
    let accessors = Count::of("accessor", &document.accessors);
    let materials = Count::of("material", &document.materials);
    let views = Count::of("buffer view", &document.buffer_views);
    for (k, primitive) in mesh.primitives.iter().enumerate() {
        let value = |name: &str| format!("primitives/{k}/{name}");
        accessors.attributes(&primitive.attributes, entry, &value("attributes"))?;
        accessors.option(primitive.indices, entry, &value("indices"))?;
        materials.option(primitive.material, entry, &value("material"))?;
        for (t, target) in primitive.targets.iter().enumerate() {
            accessors.attributes(target, entry, &value(&format!("targets/{t}")))?;
        }
        if let Some(draco) = &primitive.extensions.draco {
            let value = value("extensions/KHR_draco_mesh_compression/bufferView");
            views.option(Some(draco.buffer_view), entry, &value)?;
        }
    }
    Ok(())
}

fn check_view(document: &Document<'_>, view: &BufferView<'_>, entry: Entry) -> Checked<()> {
    let buffers = Count::of("buffer", &document.buffers);
    buffers.option(Some(view.buffer), entry, "buffer")?;
    if let Some(Index(stride)) = view.byte_stride
        && !(4..=252).contains(&stride)
    {
        let what = format!("must be from 4 to 252, got {stride}");
        return Err(entry.fault("byteStride", what));
    }
    let packed = view.extensions.meshopt.as_ref();
    let value = "extensions/EXT_meshopt_compression/buffer";
    buffers.option(packed.map(|packed| packed.buffer), entry, value)
}

fn check_materials(document: &Document<'_>) -> Checked<()> {
    let samplers = Count::of("sampler", &document.samplers);
    let images = Count::of("image", &document.images);
    let textures = Count::of("texture", &document.textures);
    for (entry, texture) in entries("textures", &document.textures) {
        samplers.option(texture.sampler, entry, "sampler")?;
        for source in texture.sources() {
            images.option(Some(source), entry, "source")?;
        }
    }
    for (entry, material) in entries("materials", &document.materials) {
        for (_, value, texture) in material.textures() {
            textures.option(Some(texture.index), entry, &format!("{value}/index"))?;
        }
    }
    Ok(())
}
