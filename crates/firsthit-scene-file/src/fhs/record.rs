//! The record: all of a scene that is no array. Sections are named by their numbers, other things
//! by their places in the record's lists.

use serde::{Deserialize, Serialize};

use super::look::{KindRecord, MapRecord, MaterialRecord, ShadingRecord};
use super::number::{Number, Triple};
use super::sensor::CameraRecord;

/// A section, by its number.
pub(super) type Section = usize;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Record {
    pub(super) positions: Vec<PositionsRecord>,
    pub(super) meshes: Vec<MeshRecord>,
    pub(super) textures: Vec<TextureRecord>,
    /// Textures on surfaces.
    pub(super) maps: Vec<MapRecord>,
    /// The lists of materials that objects have.
    pub(super) materials: Vec<Vec<MaterialRecord>>,
    /// Nodes and meshes of the file that the scene was built from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) labels: Vec<LabelRecord>,
    pub(super) objects: Vec<ObjectRecord>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) groups: Vec<GroupRecord>,
    /// A box around each object.
    pub(super) boxes: Section,
    /// Pairs of an object and a later one in its place.
    pub(super) duplicates: Section,
    /// The low and the high corner of the box around everything finite, if there is anything.
    pub(super) bounds: Option<[Triple; 2]>,
    pub(super) lights: Vec<KindRecord>,
    pub(super) cameras: Vec<CameraRecord>,
    pub(super) shading: ShadingRecord,
    /// Whether the first camera is the one to look through.
    pub(super) has_view: bool,
    pub(super) up: Triple,
    pub(super) up_is_guessed: bool,
}

/// Vertices, which meshes share.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum PositionsRecord {
    Single(Section),
    Double(Section),
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshRecord {
    pub(super) positions: usize,
    pub(super) triangles: Section,
    pub(super) bounds: [Triple; 2],
    pub(super) faces: Option<Section>,
    pub(super) slots: Option<Section>,
    pub(super) normals: Option<AttributeRecord>,
    pub(super) uvs: Option<AttributeRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) second_uvs: Option<AttributeRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) tangents: Option<AttributeRecord>,
    pub(super) colors: Option<AttributeRecord>,
    pub(super) alphas: Option<AttributeRecord>,
    pub(super) properties: Vec<PropertyRecord>,
    /// The tree; `None` where all objects that have the mesh share trees with others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) tree: Option<TreeRecord>,
}

/// Objects that share a tree.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GroupRecord {
    pub(super) objects: Section,
    pub(super) tree: TreeRecord,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AttributeRecord {
    pub(super) values: Section,
    /// The indices of corners' values; `None` where there is a value for each vertex.
    pub(super) corners: Option<Section>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PropertyRecord {
    pub(super) name: String,
    pub(super) of_faces: bool,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) of_corners: bool,
    /// The number of components, where it is not one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) components: Option<usize>,
    /// Whether it is that of the nearest corner, and not interpolated.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) of_nearest: bool,
    pub(super) values: ValuesRecord,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ValuesRecord {
    Single(Section),
    Double(Section),
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TreeRecord {
    pub(super) nodes: Section,
    pub(super) leaves: Section,
    pub(super) order: Section,
    pub(super) copies: Section,
    pub(super) exact: bool,
    pub(super) welded: bool,
    pub(super) cost: Number,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TextureRecord {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) texels: Section,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectRecord {
    pub(super) name: String,
    pub(super) shape: ShapeRecord,
    /// World from object: the images of x, y and z, and that of the origin.
    pub(super) transform: Option<[Triple; 4]>,
    /// The list of its materials, if it has any.
    pub(super) materials: Option<usize>,
    /// The mask, where it is not all bits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) mask: Option<u32>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) is_hidden: bool,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) is_removed: bool,
    /// The label of its node, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) node: Option<usize>,
    /// The label of its mesh, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) mesh_label: Option<usize>,
}

/// A node or a mesh.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LabelRecord {
    pub(super) number: u64,
    pub(super) name: String,
}

/// A shape, by the arguments of its constructor.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ShapeRecord {
    Mesh(usize),
    Sphere(Triple, Number),
    Plane(Triple, Triple),
    Disc(Triple, Triple, Number),
    Box(Triple, Triple),
    Cylinder(Triple, Triple, Number),
    Cone(Triple, Triple, Number, Number),
}
