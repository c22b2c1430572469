//! The JSON of a glTF document: the parts that are read.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::super::fault::{Checked, Fault};
use super::super::memory_budget::check_free;
use super::super::report::Report;
use super::container::Container;
use super::index::Index;
use super::material_entry::{ImageEntry, MaterialEntry, SamplerEntry, TextureEntry};
use super::place::pointer_of;
use crate::error::{Place, escape_controls};

/// The attributes of a primitive or an instancing extension: semantics and their accessors.
pub(super) type Attributes<'a> = BTreeMap<Cow<'a, str>, Index>;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document<'a> {
    #[serde(borrow)]
    pub(super) asset: Option<Asset<'a>>,
    pub(super) extensions_used: Vec<Cow<'a, str>>,
    pub(super) extensions_required: Vec<Cow<'a, str>>,
    pub(super) scene: Option<Index>,
    pub(super) scenes: Vec<SceneEntry>,
    pub(super) nodes: Vec<Node<'a>>,
    pub(super) meshes: Vec<MeshEntry<'a>>,
    pub(super) skins: Vec<Skin>,
    pub(super) cameras: Vec<CameraEntry<'a>>,
    pub(super) accessors: Vec<Accessor<'a>>,
    pub(super) buffer_views: Vec<BufferView<'a>>,
    pub(super) buffers: Vec<Buffer<'a>>,
    pub(super) materials: Vec<MaterialEntry<'a>>,
    pub(super) textures: Vec<TextureEntry>,
    pub(super) images: Vec<ImageEntry<'a>>,
    pub(super) samplers: Vec<SamplerEntry>,
    pub(super) animations: Vec<IgnoredAny>,
    pub(super) extensions: DocumentExtensions<'a>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Asset<'a> {
    #[serde(borrow)]
    pub(super) version: Cow<'a, str>,
    pub(super) min_version: Option<Cow<'a, str>>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct DocumentExtensions<'a> {
    #[serde(borrow, rename = "KHR_lights_punctual")]
    pub(super) lights: Option<Lights<'a>>,
    #[serde(rename = "CESIUM_RTC")]
    pub(super) relative_to: Option<RelativeTo>,
    #[serde(borrow, rename = "KHR_materials_variants")]
    pub(super) variants: Option<Variants<'a>>,
}

/// A point of the earth that everything is relative to.
#[derive(Debug, Deserialize)]
pub(super) struct RelativeTo {
    #[serde(default)]
    pub(super) center: Vec<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Variants<'a> {
    #[serde(borrow, default)]
    pub(super) variants: Vec<VariantEntry<'a>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct VariantEntry<'a> {
    #[serde(borrow, default)]
    pub(super) name: Cow<'a, str>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Lights<'a> {
    #[serde(borrow, default)]
    pub(super) lights: Vec<LightEntry<'a>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct LightEntry<'a> {
    #[serde(borrow, rename = "type")]
    pub(super) kind: Cow<'a, str>,
    pub(super) color: Option<[f64; 3]>,
    pub(super) intensity: Option<f64>,
    pub(super) range: Option<f64>,
    pub(super) spot: Option<Spot>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Spot {
    pub(super) inner_cone_angle: Option<f64>,
    pub(super) outer_cone_angle: Option<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct SceneEntry {
    #[serde(default)]
    pub(super) nodes: Vec<Index>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Node<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Cow<'a, str>>,
    #[serde(default)]
    pub(super) children: Vec<Index>,
    pub(super) mesh: Option<Index>,
    pub(super) camera: Option<Index>,
    pub(super) skin: Option<Index>,
    /// In a box: few nodes have one, and there may be a million.
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) weights: Option<Vec<f64>>,
    #[serde(default)]
    pub(super) extensions: NodeExtensions<'a>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct NodeExtensions<'a> {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) light: Option<NodeLight>,
    #[serde(borrow, rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing<'a>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct NodeLight {
    pub(super) light: Index,
}

#[derive(Debug, Deserialize)]
pub(super) struct Instancing<'a> {
    #[serde(borrow, default)]
    pub(super) attributes: Attributes<'a>,
}

#[derive(Debug, Deserialize)]
pub(super) struct MeshEntry<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Cow<'a, str>>,
    pub(super) primitives: Vec<Primitive<'a>>,
    #[serde(default)]
    pub(super) weights: Vec<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive<'a> {
    #[serde(borrow, default)]
    pub(super) attributes: Attributes<'a>,
    pub(super) indices: Option<Index>,
    pub(super) material: Option<Index>,
    pub(super) mode: Option<Index>,
    #[serde(default)]
    pub(super) targets: Vec<Attributes<'a>>,
    #[serde(default)]
    pub(super) extensions: PrimitiveExtensions<'a>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct PrimitiveExtensions<'a> {
    #[serde(borrow, rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<Draco<'a>>,
    #[serde(rename = "KHR_materials_variants")]
    pub(super) variants: Option<MappedVariants>,
}

#[derive(Debug, Deserialize)]
pub(super) struct MappedVariants {
    #[serde(default)]
    pub(super) mappings: Vec<VariantMapping>,
}

/// A material, and the variants that show it.
#[derive(Debug, Deserialize)]
pub(super) struct VariantMapping {
    pub(super) material: Index,
    #[serde(default)]
    pub(super) variants: Vec<Index>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Draco<'a> {
    pub(super) buffer_view: Index,
    /// The identifiers of the attributes in the packed mesh.
    #[serde(borrow, default)]
    pub(super) attributes: Attributes<'a>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) inverse_bind_matrices: Option<Index>,
    pub(super) joints: Vec<Index>,
}

#[derive(Debug, Deserialize)]
pub(super) struct CameraEntry<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Cow<'a, str>>,
    #[serde(rename = "type")]
    pub(super) kind: Cow<'a, str>,
    pub(super) perspective: Option<PerspectiveEntry>,
    pub(super) orthographic: Option<OrthographicEntry>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct PerspectiveEntry {
    pub(super) yfov: f64,
    pub(super) aspect_ratio: Option<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct OrthographicEntry {
    pub(super) xmag: f64,
    pub(super) ymag: f64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor<'a> {
    pub(super) buffer_view: Option<Index>,
    #[serde(default)]
    pub(super) byte_offset: Index,
    pub(super) component_type: Index,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: Index,
    #[serde(borrow, rename = "type")]
    pub(super) kind: Cow<'a, str>,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: Index,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: Index,
    #[serde(default)]
    pub(super) byte_offset: Index,
    pub(super) component_type: Index,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: Index,
    #[serde(default)]
    pub(super) byte_offset: Index,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView<'a> {
    pub(super) buffer: Index,
    #[serde(default)]
    pub(super) byte_offset: Index,
    pub(super) byte_length: Index,
    pub(super) byte_stride: Option<Index>,
    #[serde(borrow, default)]
    pub(super) extensions: BufferViewExtensions<'a>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct BufferViewExtensions<'a> {
    #[serde(borrow, rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    pub(super) meshopt: Option<Meshopt<'a>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Meshopt<'a> {
    pub(super) buffer: Index,
    #[serde(default)]
    pub(super) byte_offset: Index,
    pub(super) byte_length: Index,
    pub(super) byte_stride: Index,
    pub(super) count: Index,
    #[serde(borrow)]
    pub(super) mode: Cow<'a, str>,
    pub(super) filter: Option<Cow<'a, str>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer<'a> {
    #[serde(borrow)]
    pub(super) uri: Option<Cow<'a, str>>,
    pub(super) byte_length: Index,
}

/// Charges the most memory that a document can need: few characters can stand for a large record.
pub(super) fn charge(container: &Container<'_>, report: &mut Report) -> Checked<()> {
    // Lists grow by doubling. Nodes are the largest records; names are the largest plain values,
    // two to an entry of a map.
    let (record, value) = (2 * size_of::<Node<'_>>(), 4 * size_of::<Cow<'_, str>>());
    let count = |wanted: u8| memchr::memchr_iter(wanted, container.json).count();
    let records = count(b'{').saturating_mul(record);
    let needed = records.saturating_add(count(b',').saturating_mul(value));
    report.budget.charge_content(needed as u64, "the document")?;
    check_free(needed)
}

/// Parses the JSON. A fault names its place: the line of a text, the byte of a GLB, or the pointer
/// of a value.
pub(super) fn parse<'a>(container: &Container<'a>) -> Checked<Document<'a>> {
    let mut json = serde_json::Deserializer::from_slice(container.json);
    let document: Document<'a> = serde_path_to_error::deserialize(&mut json)
        .map_err(|error| fault(container, Some(error.path()), error.inner()))?;
    json.end().map_err(|error| fault(container, None, &error))?;
    let Some(Asset { version, min_version }) = &document.asset else {
        return Err(Fault::at(Place::Pointer(String::new()), "missing field `asset`"));
    };
    // A later version 2 adds what older readers may pass over, unless `minVersion` says otherwise.
    if !version.starts_with("2.") && *version != "2" {
        let what = format!("the version must be 2, got '{}'", escape_controls(version));
        return Err(Fault::at(Place::Pointer("/asset/version".into()), what));
    }
    if let Some(least) = min_version.as_deref().filter(|&least| least != "2.0") {
        let least = escape_controls(least);
        let what = format!("a reader of version {least} is needed, this is 2.0");
        return Err(Fault::at(Place::Pointer("/asset/minVersion".into()), what));
    }
    Ok(document)
}

fn fault(
    container: &Container<'_>,
    path: Option<&serde_path_to_error::Path>,
    error: &serde_json::Error,
) -> Fault {
    let mut what = error.to_string();
    if let Some(end) = what.rfind(" at line ") {
        what.truncate(end);
    }
    let what = plain(&escape_controls(&what));
    let place = match (path, container.start) {
        (Some(path), _) if error.is_data() => Place::Pointer(pointer_of(path)),
        (_, Some(start)) => Place::Byte((start + offset_of(container.json, error)) as u64),
        (_, None) => Place::Line(error.line() as u64),
    };
    Fault::at(place, what)
}

/// A message in JSON's words, where it has Rust's.
fn plain(what: &str) -> String {
    let Some((start, expected)) = what.rsplit_once("expected ") else {
        return what.to_owned();
    };
    let words = match expected {
        "f32" | "f64" => "a number",
        "a sequence" => "an array",
        _ if expected.starts_with("struct ") || expected == "a map" => "an object",
        _ => expected,
    };
    format!("{start}expected {words}")
}

/// The byte of the text that an error is about.
fn offset_of(json: &[u8], error: &serde_json::Error) -> usize {
    let lines = json.split_inclusive(|&byte| byte == b'\n');
    let lines = lines.take(error.line().saturating_sub(1));
    let before: usize = lines.map(<[u8]>::len).sum();
    (before + error.column().saturating_sub(1)).min(json.len())
}
