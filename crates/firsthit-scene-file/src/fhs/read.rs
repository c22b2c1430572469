//! Puts a scene together from its sections.

use std::sync::Arc;

use serde_json::error::Category;

use super::layout::{Element, Sections};
use super::look::{KindRecord, MaterialRecord, direction_of, missing};
use super::number::{Number, Triple};
use super::record::{
    AttributeRecord, LabelRecord, MeshRecord, ObjectRecord, PositionsRecord, PropertyRecord,
    Record, ShapeRecord, TextureRecord, TreeRecord, ValuesRecord,
};
use super::sensor::{CameraRecord, check_cameras};
use crate::accel::{MeshTree, TreeFacts, TreeParts};
use crate::error::{Error, Result, escape_controls, escaped};
use crate::geometry::{Bounds, DAffine3, DMat3, DVec3, Transform};
use crate::io::Report;
use crate::io::fault::{Checked, Fault};
use crate::memory::{self, Block};
use crate::scene::{Group, Label, Material, Object, ObjectTree, Scene, SceneParts, Texture};
use crate::shape::{
    Attribute, Between, Cone, Cuboid, Cylinder, Disc, Mesh, MeshParts, Meshes, Plane, Positions,
    Property, PropertyOf, PropertyValues, Shape, Sphere,
};
use crate::watch::stop_if_asked;
use crate::world::World;

/// The world of a file; its scene, which is built, goes to `report`.
pub(super) fn world(block: Arc<Block>, report: &mut Report) -> Checked<World> {
    let path = escaped(report.source.path());
    let bytes = block.bytes().len() as u64;
    let mut sections = Sections::open(block)?;
    if report.settings.verify {
        sections.verify(&format!("comparing checksums of {path}"), report.watch)?;
    }
    report.watch.begin(&format!("opening {path}"), bytes, "bytes");
    let record = record(&mut sections)?;
    let meshes = meshes(&record, &mut sections)?;
    let looks = looks(&record, &mut sections)?;
    let labels: Vec<Label> = record.labels.iter().map(label).collect();
    let objects = objects(&record.objects, (&meshes, &looks, &labels))?;
    stop_if_asked(report.watch)?;
    let trees = trees(&record, (&meshes, &objects), &mut sections)?;
    stop_if_asked(report.watch)?;
    let boxes = sections.take::<[f64; 6]>(record.boxes)?;
    let boxes = boxes
        .iter()
        .map(|&[a, b, c, d, e, f]| Bounds { low: DVec3::new(a, b, c), high: DVec3::new(d, e, f) });
    let duplicates = sections.take::<[u32; 2]>(record.duplicates)?;
    let environment = record.shading.environment(|texels| sections.take(texels))?;
    sections.finish()?;
    let scene = Scene::from_parts(SceneParts {
        objects: objects.clone(),
        trees,
        boxes: boxes.collect(),
        duplicates: duplicates.to_vec(),
        bounds: record.bounds.map_or(Bounds::EMPTY, bounds_of),
    });
    let scene = of_record(scene)?;
    report.watch.advance(bytes);
    let world = of_record(described(&record, objects))?;
    of_record(check_cameras(&world.cameras))?;
    report.scene = Some(scene);
    Ok(World { environment, ..world })
}

/// All but the scene and the environment.
fn described(record: &Record, objects: Vec<Object>) -> Result<World> {
    let up = DVec3::from(record.up);
    Ok(World {
        objects,
        cameras: record.cameras.iter().map(CameraRecord::camera).collect::<Result<_>>()?,
        lights: record.lights.iter().map(KindRecord::light).collect::<Result<_>>()?,
        has_view: record.has_view && !record.cameras.is_empty(),
        appearance: record.shading.appearance()?,
        environment: None,
        display: record.shading.display()?,
        edges: record.shading.edges()?,
        outputs: Vec::new(),
        // Zero says that nothing is known.
        up: if up == DVec3::ZERO { up } else { direction_of(record.up)? },
        up_is_guessed: record.up_is_guessed,
    })
}

/// The memory for parsing the record, in multiples of its length: two copies of an object and one
/// of its record, in lists that may have room for twice as many, over the 30 characters that
/// describe one at least.
const TIMES_RECORD: usize = 64;

fn record(sections: &mut Sections) -> Checked<Record> {
    let text = sections.take::<u8>(0)?;
    memory::check("the file's record", text.len().saturating_mul(TIMES_RECORD))?;
    serde_json::from_slice(&text).map_err(|error| {
        let what = match error.classify() {
            Category::Eof => "the record ends too early".to_owned(),
            _ => format!("the record: {}", escape_controls(&error.to_string())),
        };
        Fault::file(what)
    })
}

/// The result of a constructor for a part of the record, its error as the file's fault.
pub(super) fn of_record<T>(made: Result<T>) -> Checked<T> {
    made.map_err(|error| match error {
        Error::Argument { .. } | Error::Limit { .. } => Fault::file(format!("the record: {error}")),
        other => other.into(),
    })
}

fn bounds_of([low, high]: [Triple; 2]) -> Bounds {
    Bounds { low: low.into(), high: high.into() }
}

type Built = (Arc<Mesh>, Option<Arc<MeshTree>>);

fn meshes(record: &Record, sections: &mut Sections) -> Checked<Vec<Built>> {
    let mut vertices = Vec::new();
    for positions in &record.positions {
        let positions = match *positions {
            PositionsRecord::Single(points) => Positions::Single(sections.take(points)?),
            PositionsRecord::Double(points) => Positions::Double(sections.take(points)?),
        };
        let is_finite = positions.are_finite();
        vertices.push((Arc::new(positions), is_finite));
    }
    let meshes = record.meshes.iter().enumerate();
    meshes.map(|mesh| built(mesh, &vertices, sections)).collect()
}

fn built(
    (number, record): (usize, &MeshRecord),
    vertices: &[(Arc<Positions>, bool)],
    sections: &mut Sections,
) -> Checked<Built> {
    let positions = vertices.get(record.positions);
    let positions = positions.ok_or_else(|| missing("the positions of a mesh", record.positions));
    let (positions, is_finite) = of_record(positions)?;
    let properties = record.properties.iter();
    let parts = MeshParts {
        positions: Arc::clone(positions),
        is_finite: *is_finite,
        triangles: sections.take(record.triangles)?,
        bounds: bounds_of(record.bounds),
        faces: record.faces.map(|faces| sections.take(faces)).transpose()?,
        slots: record.slots.map(|slots| sections.take(slots)).transpose()?,
        normals: attribute(record.normals.as_ref(), sections)?,
        uvs: attribute(record.uvs.as_ref(), sections)?,
        second_uvs: attribute(record.second_uvs.as_ref(), sections)?,
        tangents: attribute(record.tangents.as_ref(), sections)?,
        colors: attribute(record.colors.as_ref(), sections)?,
        alphas: attribute(record.alphas.as_ref(), sections)?,
        properties: properties.map(|named| property(named, sections)).collect::<Checked<_>>()?,
    };
    let of_mesh = |what: &str| Fault::file(format!("mesh {number}: {what}"));
    let mesh = Mesh::from_parts(parts).map_err(of_mesh)?;
    let tree = match &record.tree {
        Some(tree) => {
            let parts = tree_parts(tree, sections)?;
            let tree = MeshTree::from_parts((&mesh).into(), parts).map_err(of_mesh)?;
            Some(Arc::new(tree))
        }
        None => None,
    };
    Ok((Arc::new(mesh), tree))
}

fn tree_parts(tree: &TreeRecord, sections: &mut Sections) -> Checked<TreeParts> {
    Ok(TreeParts {
        nodes: sections.take(tree.nodes)?,
        leaves: sections.take(tree.leaves)?,
        order: sections.take(tree.order)?,
        copies: sections.take(tree.copies)?,
        facts: TreeFacts { is_exact: tree.exact, is_welded: tree.welded, cost: tree.cost.0 },
    })
}

/// The tree of each object.
fn trees(
    record: &Record,
    (meshes, objects): (&[Built], &[Object]),
    sections: &mut Sections,
) -> Checked<Vec<ObjectTree>> {
    let own = record.objects.iter().map(|object| match object.shape {
        ShapeRecord::Mesh(mesh) => {
            let tree = meshes.get(mesh).and_then(|(_, tree)| tree.as_ref());
            tree.map_or(ObjectTree::None, |tree| ObjectTree::Own(Arc::clone(tree)))
        }
        _ => ObjectTree::None,
    });
    let mut trees: Vec<ObjectTree> = own.collect();
    for (number, group) in record.groups.iter().enumerate() {
        let of_group = |what: &str| Fault::file(format!("group {number}: {what}"));
        let members = sections.take::<u32>(group.objects)?;
        let parts = tree_parts(&group.tree, sections)?;
        let tree = |meshes: Meshes<'_>| MeshTree::from_parts(meshes, parts);
        let group = Group::from_parts(&members, objects, tree).map_err(of_group)?;
        let has_tree =
            |&member: &u32| trees.get(member as usize).is_some_and(|tree| tree.any().is_some());
        if members.iter().any(has_tree) {
            return Err(of_group("it joins an object that has a tree"));
        }
        Arc::new(group).join(&mut trees);
    }
    let mut pairs = objects.iter().zip(&trees);
    let lacks =
        |(object, tree): (&Object, &ObjectTree)| object.mesh().is_some() && tree.any().is_none();
    if let Some(object) = pairs.position(lacks) {
        return Err(Fault::file(format!("object {object}: its mesh has no tree")));
    }
    Ok(trees)
}

fn attribute<const N: usize>(
    record: Option<&AttributeRecord>,
    sections: &mut Sections,
) -> Checked<Option<Attribute<N>>>
where
    [f32; N]: Element,
{
    let Some(record) = record else {
        return Ok(None);
    };
    let corners = record.corners.map(|corners| sections.take(corners));
    Ok(Some(Attribute { values: sections.take(record.values)?, corners: corners.transpose()? }))
}

fn property(record: &PropertyRecord, sections: &mut Sections) -> Checked<Property> {
    Ok(Property {
        name: escape_controls(&record.name),
        of: match (record.of_faces, record.of_corners) {
            (false, false) => PropertyOf::Vertices,
            (false, true) => PropertyOf::Corners,
            (true, false) => PropertyOf::Faces,
            (true, true) => {
                let what = "a property is of faces or of corners, not of both";
                return Err(Fault::file(what));
            }
        },
        components: record.components.unwrap_or(1),
        between: if record.of_nearest { Between::NearestCorner } else { Between::Interpolated },
        values: match record.values {
            ValuesRecord::Single(values) => PropertyValues::Single(sections.take(values)?),
            ValuesRecord::Double(values) => PropertyValues::Double(sections.take(values)?),
        },
    })
}

/// The lists of materials.
type Looks = Vec<Arc<[Material]>>;

fn looks(record: &Record, sections: &mut Sections) -> Checked<Looks> {
    let mut textures = Vec::new();
    for &TextureRecord { columns, rows, texels } in &record.textures {
        let texels = sections.take(texels)?;
        textures.push(Arc::new(of_record(Texture::new(columns, rows, texels))?));
    }
    let maps = record.maps.iter().map(|map| map.map(&textures));
    let maps = of_record(maps.collect::<Result<Vec<_>>>())?;
    let list = |list: &Vec<MaterialRecord>| {
        let materials = list.iter().map(|material| material.material(&maps));
        materials.collect::<Result<Arc<[Material]>>>()
    };
    of_record(record.materials.iter().map(list).collect())
}

/// The most looks at materials: more than any honest file asks for.
const MOST_LOOKS: usize = 1 << 28;

fn label(record: &LabelRecord) -> Label {
    Label { number: record.number, name: escape_controls(&record.name).into() }
}

/// The label that an object names, if it names one.
fn labelled(labels: &[Label], number: Option<usize>) -> Checked<Option<Label>> {
    let found = number.map(|number| {
        let label = labels.get(number);
        label.cloned().ok_or_else(|| missing("a label", number))
    });
    of_record(found.transpose())
}

fn objects(
    records: &[ObjectRecord],
    (meshes, looks, labels): (&[Built], &Looks, &[Label]),
) -> Checked<Vec<Object>> {
    let mut objects = Vec::new();
    let room = objects.try_reserve_exact(records.len());
    room.map_err(|_| memory::no_room_for("the file's objects"))?;
    let mut looked: usize = 0;
    for record in records {
        let mut object = of_record(shape(&record.shape, meshes).map(Object::new))?;
        object = object.named(escape_controls(&record.name));
        object = object.masked(record.mask.unwrap_or(u32::MAX));
        object = object.hidden(record.is_hidden);
        object = object.removed(record.is_removed);
        object = object.from_node(labelled(labels, record.node)?);
        object = object.from_mesh(labelled(labels, record.mesh_label)?);
        if let Some(columns) = record.transform {
            object = object.placed(of_record(transform(columns))?);
        }
        if let Some(number) = record.materials {
            let list = looks.get(number);
            let list = of_record(list.ok_or_else(|| missing("a list of materials", number)))?;
            // Each of a list is asked whether it is cut out.
            looked = looked.saturating_add(list.len());
            if looked > MOST_LOOKS {
                return Err(Fault::file("the record: objects with too many materials"));
            }
            object = object.with_materials(Arc::clone(list));
        }
        objects.push(object);
    }
    Ok(objects)
}

fn transform(columns: [Triple; 4]) -> Result<Transform> {
    let [x, y, z, moved] = columns.map(DVec3::from);
    let matrix = DMat3::from_cols(x, y, z);
    Transform::new(DAffine3::from_mat3_translation(matrix, moved))
}

fn shape(record: &ShapeRecord, meshes: &[Built]) -> Result<Shape> {
    Ok(match *record {
        ShapeRecord::Mesh(number) => {
            let mesh = meshes.get(number);
            let (mesh, _) = mesh.ok_or_else(|| missing("a mesh", number))?;
            Arc::clone(mesh).into()
        }
        ShapeRecord::Sphere(center, Number(radius)) => Sphere::new(center.into(), radius)?.into(),
        ShapeRecord::Plane(point, normal) => Plane::new(point.into(), normal.into())?.into(),
        ShapeRecord::Disc(center, normal, Number(radius)) => {
            Disc::new(center.into(), normal.into(), radius)?.into()
        }
        ShapeRecord::Box(low, high) => Cuboid::new(low.into(), high.into())?.into(),
        ShapeRecord::Cylinder(bottom, top, Number(radius)) => {
            Cylinder::new(bottom.into(), top.into(), radius)?.into()
        }
        ShapeRecord::Cone(bottom, top, Number(bottom_radius), Number(top_radius)) => {
            Cone::new(bottom.into(), top.into(), bottom_radius, top_radius)?.into()
        }
    })
}
