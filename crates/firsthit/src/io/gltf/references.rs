//! Checks that every index of a document names something that exists, used or not.

use super::super::fault::Checked;
use super::document::{Accessor, Attributes, BufferView, Document, MeshEntry, Node};
use super::index::Index;
use super::material_entry::MaterialEntry;
use super::place::{Entry, key};
use crate::error::Place;
use crate::io::fault::Fault;

/// Refuses a document with an index out of range.
pub(super) fn check(document: &Document<'_>) -> Checked<()> {
    let counts = Counts::of(document);
    let scene = document.scene.filter(|_| !document.scenes.is_empty());
    if let Some(Index(scene)) = scene
        && scene >= document.scenes.len()
    {
        let what = missing("scene", scene, document.scenes.len());
        return Err(Fault::at(Place::Pointer("/scene".into()), what));
    }
    for (k, scene) in document.scenes.iter().enumerate() {
        counts
            .nodes
            .all(&scene.nodes, Entry::new("scenes", k), "nodes")?;
    }
    for (k, node) in document.nodes.iter().enumerate() {
        counts.node(node, Entry::new("nodes", k))?;
    }
    for (k, mesh) in document.meshes.iter().enumerate() {
        counts.mesh(mesh, Entry::new("meshes", k))?;
    }
    for (k, skin) in document.skins.iter().enumerate() {
        let entry = Entry::new("skins", k);
        counts.nodes.all(&skin.joints, entry, "joints")?;
        counts
            .accessors
            .option(skin.inverse_bind_matrices, entry, "inverseBindMatrices")?;
    }
    for (k, accessor) in document.accessors.iter().enumerate() {
        counts.accessor(accessor, Entry::new("accessors", k))?;
    }
    for (k, view) in document.buffer_views.iter().enumerate() {
        counts.view(view, Entry::new("bufferViews", k))?;
    }
    for (k, image) in document.images.iter().enumerate() {
        counts
            .views
            .option(image.buffer_view, Entry::new("images", k), "bufferView")?;
    }
    for (k, texture) in document.textures.iter().enumerate() {
        let entry = Entry::new("textures", k);
        counts.samplers.option(texture.sampler, entry, "sampler")?;
        for source in texture.sources() {
            counts.images.option(Some(source), entry, "source")?;
        }
    }
    for (k, material) in document.materials.iter().enumerate() {
        counts.material(material, Entry::new("materials", k))?;
    }
    Ok(())
}

fn missing(kind: &str, index: usize, count: usize) -> String {
    format!("there is no {kind} {index}: there are {count}")
}

/// How many there are of a kind.
struct Count {
    kind: &'static str,
    count: usize,
}

impl Count {
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

struct Counts {
    nodes: Count,
    meshes: Count,
    skins: Count,
    cameras: Count,
    lights: Count,
    accessors: Count,
    views: Count,
    buffers: Count,
    materials: Count,
    textures: Count,
    images: Count,
    samplers: Count,
}

impl Counts {
    fn of(document: &Document<'_>) -> Self {
        let count = |kind, count| Count { kind, count };
        let lights = document.extensions.lights.as_ref();
        Self {
            nodes: count("node", document.nodes.len()),
            meshes: count("mesh", document.meshes.len()),
            skins: count("skin", document.skins.len()),
            cameras: count("camera", document.cameras.len()),
            lights: count("light", lights.map_or(0, |lights| lights.lights.len())),
            accessors: count("accessor", document.accessors.len()),
            views: count("buffer view", document.buffer_views.len()),
            buffers: count("buffer", document.buffers.len()),
            materials: count("material", document.materials.len()),
            textures: count("texture", document.textures.len()),
            images: count("image", document.images.len()),
            samplers: count("sampler", document.samplers.len()),
        }
    }

    fn node(&self, node: &Node<'_>, entry: Entry) -> Checked<()> {
        self.nodes.all(&node.children, entry, "children")?;
        self.meshes.option(node.mesh, entry, "mesh")?;
        self.cameras.option(node.camera, entry, "camera")?;
        self.skins.option(node.skin, entry, "skin")?;
        let light = node.extensions.light.as_ref().map(|light| light.light);
        self.lights
            .option(light, entry, "extensions/KHR_lights_punctual/light")?;
        if let Some(instancing) = &node.extensions.instancing {
            let value = "extensions/EXT_mesh_gpu_instancing/attributes";
            self.accessors
                .attributes(&instancing.attributes, entry, value)?;
        }
        Ok(())
    }

    fn mesh(&self, mesh: &MeshEntry<'_>, entry: Entry) -> Checked<()> {
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let value = |name: &str| format!("primitives/{k}/{name}");
            self.accessors
                .attributes(&primitive.attributes, entry, &value("attributes"))?;
            self.accessors
                .option(primitive.indices, entry, &value("indices"))?;
            self.materials
                .option(primitive.material, entry, &value("material"))?;
            for (t, target) in primitive.targets.iter().enumerate() {
                self.accessors
                    .attributes(target, entry, &value(&format!("targets/{t}")))?;
            }
            if let Some(draco) = &primitive.extensions.draco {
                let value = value("extensions/KHR_draco_mesh_compression/bufferView");
                self.views.option(Some(draco.buffer_view), entry, &value)?;
            }
        }
        Ok(())
    }

    fn accessor(&self, accessor: &Accessor<'_>, entry: Entry) -> Checked<()> {
        self.views
            .option(accessor.buffer_view, entry, "bufferView")?;
        if let Some(sparse) = &accessor.sparse {
            let (indices, values) = (sparse.indices.buffer_view, sparse.values.buffer_view);
            self.views
                .option(Some(indices), entry, "sparse/indices/bufferView")?;
            self.views
                .option(Some(values), entry, "sparse/values/bufferView")?;
        }
        Ok(())
    }

    fn view(&self, view: &BufferView<'_>, entry: Entry) -> Checked<()> {
        self.buffers.option(Some(view.buffer), entry, "buffer")?;
        if let Some(Index(stride)) = view.byte_stride
            && !(4..=252).contains(&stride)
        {
            let what = format!("must be from 4 to 252, got {stride}");
            return Err(entry.fault("byteStride", what));
        }
        let packed = view
            .extensions
            .meshopt
            .as_ref()
            .map(|meshopt| meshopt.buffer);
        self.buffers
            .option(packed, entry, "extensions/EXT_meshopt_compression/buffer")
    }

    fn material(&self, material: &MaterialEntry<'_>, entry: Entry) -> Checked<()> {
        for (value, texture) in material.textures() {
            self.textures
                .option(Some(texture.index), entry, &format!("{value}/index"))?;
        }
        Ok(())
    }
}
