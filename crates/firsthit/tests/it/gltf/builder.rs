//! Documents made value by value.

use std::path::{Path, PathBuf};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use firsthit::Result;
use firsthit::load::{LoadSettings, Loaded, load_bytes};
use serde_json::{Value, json};

pub(crate) const FLOAT: u32 = 5126;

/// A document and its only buffer.
pub(crate) struct Builder {
    pub(crate) json: Value,
    pub(crate) buffer: Vec<u8>,
}

impl Builder {
    /// A document of one node.
    pub(crate) fn new() -> Self {
        Self {
            json: json!({
                "asset": {"version": "2.0"},
                "scene": 0,
                "scenes": [{"nodes": [0]}],
                "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {}}]}],
                "accessors": [],
                "bufferViews": [],
            }),
            buffer: Vec::new(),
        }
    }

    /// A right-angled triangle in the plane z = 0.
    pub(crate) fn triangle() -> Self {
        let mut builder = Self::new();
        builder.attribute("POSITION", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], "VEC3");
        builder
    }

    /// Adds bytes as a view of their own; returns its index.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        while !self.buffer.len().is_multiple_of(4) {
            self.buffer.push(0);
        }
        let view = json!({"buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len()});
        self.buffer.extend(bytes);
        push(&mut self.json["bufferViews"], view)
    }

    /// Adds an accessor of all of `bytes`.
    pub(crate) fn accessor(
        &mut self,
        bytes: &[u8],
        component: u32,
        count: usize,
        kind: &str,
    ) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        push(&mut self.json["accessors"], accessor)
    }

    pub(crate) fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let components = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        self.accessor(&bytes_of(values), FLOAT, values.len() / components, kind)
    }

    /// Adds an attribute to the first primitive.
    pub(crate) fn attribute(&mut self, name: &str, values: &[f32], kind: &str) -> usize {
        let accessor = self.floats(values, kind);
        self.primitive()["attributes"][name] = json!(accessor);
        accessor
    }

    pub(crate) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// The document with its buffer as a data URI.
    pub(crate) fn text(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json.get("buffers").is_none() {
            let uri = format!("data:;base64,{}", STANDARD.encode(&self.buffer));
            json["buffers"] = json!([{"byteLength": self.buffer.len(), "uri": uri}]);
        }
        json.to_string().into_bytes()
    }

    pub(crate) fn load(&self) -> Result<Loaded> {
        load_bytes(Path::new("a.gltf"), &self.text(), &LoadSettings::default())
    }

    /// The message of the error that it must be, behind the file's name.
    pub(crate) fn refusal(&self) -> String {
        let message = self.load().unwrap_err().to_string();
        message.strip_prefix("a.gltf").unwrap().to_owned()
    }
}

/// Adds to a list; returns the new index.
pub(crate) fn push(list: &mut Value, entry: Value) -> usize {
    let list = list.as_array_mut().unwrap();
    list.push(entry);
    list.len() - 1
}

pub(crate) fn bytes_of(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The positions of an object's mesh, where they are in the world.
pub(crate) fn points(model: &Loaded, object: usize) -> Vec<firsthit::DVec3> {
    let object = &model.world.objects[object];
    let positions = object.mesh().unwrap().positions();
    let place = object.transform().world_from_object();
    (0..positions.len() as u32).map(|k| place.transform_point3(positions.get(k))).collect()
}

/// A file of the reference data. Tests that use it are ignored unless `make test` finds it.
pub(crate) fn reference(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/refdata/public");
    let path = root.join(name);
    assert!(path.exists(), "needs ../shared/refdata beside the clone");
    path
}
