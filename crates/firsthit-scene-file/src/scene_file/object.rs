//! Objects of a scene file: shapes, and the objects of other files.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::numbers;
use super::form::triple;
use super::labels::Renumber;
use super::material::{self, MATERIAL};
use super::placement::{self, PLACED, PLACED_RULES};
use super::section::Section;
use super::table::{Form, Key, Pick, Record, Variant, keys, optional, required};
use crate::error::{Error, Result, escape_controls};
#[cfg(feature = "fhs")]
use crate::fhs;
use crate::geometry::{DAffine3, DVec3, Transform};
use crate::io::fault::{Checked, Fault};
use crate::io::memory_budget::OBJECT_BYTES;
use crate::io::{Report, TOO_FAR, UNITS, has_extension, load_part};
use crate::scene::Object;
use crate::shape::{Cone, Cuboid, Cylinder, Disc, Mesh, Plane, Positions, Shape, Sphere};
use crate::world::{World, unknown_variant};

const SHAPE: &str = "shape";

/// The variant of an object that is a shape.
const fn shape(name: &'static str, keys: &'static [&'static [Key]]) -> Variant {
    Variant { pick: Pick::Tag(SHAPE, name), keys, rules: PLACED_RULES }
}

/// The index of a vertex.
const INDEX: Form = Form::Whole(0, u32::MAX as i64);

const FILE: &[Key] = keys! {
    /// A mesh file, relative to the scene file and in its folder or below. Named several times, it
    /// is read once and shared.
    file: required(Form::Path),
    /// The unit of the file's lengths, which become metres. Default: lengths are as they are.
    units: optional(Form::OneOf(|| UNITS.iter().map(|&(name, _)| name).collect())),
    /// The variant of a glTF file's materials, by its name. Default: the one that is asked for
    /// where the scene file is read, or the materials that the file shows without one.
    variant: optional(Form::Text),
};

const CENTER: &[Key] = keys! {
    /// The centre.
    center: required(Form::VECTOR),
};

const RADIUS: &[Key] = keys! {
    /// The radius.
    radius: required(Form::POSITIVE),
};

const POINT: &[Key] = keys! {
    /// A point of the infinite plane.
    point: required(Form::VECTOR),
};

const NORMAL: &[Key] = keys! {
    /// The normal, of any length.
    normal: required(Form::DIRECTION),
};

const CORNERS: &[Key] = keys! {
    /// The corner with the smallest coordinates.
    low: required(Form::VECTOR),
    /// The corner with the largest coordinates.
    high: required(Form::VECTOR),
};

const BAR: &[Key] = keys! {
    /// The middle of its bottom.
    bottom: required(Form::VECTOR),
    /// The middle of its top, or its tip.
    top: required(Form::VECTOR),
};

const RADII: &[Key] = keys! {
    /// The radius at the bottom.
    bottom_radius: required(Form::NON_NEGATIVE),
    /// The radius at the top. Default: 0, a tip.
    top_radius: optional(Form::NON_NEGATIVE),
};

const TRIANGLES: &[Key] = keys! {
    /// The corners of its triangles. Large meshes belong into files.
    vertices: required(Form::Array(&Form::VECTOR, 0, usize::MAX)),
    /// The indices of each triangle's corners, from 0 on, counter-clockwise seen from the front.
    triangles: required(Form::Array(&Form::Array(&INDEX, 3, 3), 0, usize::MAX)),
};

pub(super) static OBJECT: Record = Record {
    name: "object",
    about: "An object: a file's objects, or a shape.",
    variants: &[
        Variant { pick: Pick::Has("file"), keys: &[FILE, PLACED], rules: PLACED_RULES },
        shape("sphere", &[CENTER, RADIUS, PLACED]),
        shape("plane", &[POINT, NORMAL, PLACED]),
        shape("disc", &[CENTER, NORMAL, RADIUS, PLACED]),
        shape("box", &[CORNERS, PLACED]),
        shape("cylinder", &[BAR, RADIUS, PLACED]),
        shape("cone", &[BAR, RADII, PLACED]),
        shape("mesh", &[TRIANGLES, PLACED]),
    ],
};

/// The shape of an object that names one.
fn shape_of(section: &Section<'_, '_>) -> Checked<Shape> {
    let vector = |name| section.need(name, Section::vector);
    let number = |name| section.need(name, Section::number);
    section.checked(match section.tag().unwrap_or_default() {
        "sphere" => Sphere::new(vector("center")?, number("radius")?).map(Shape::from),
        "plane" => Plane::new(vector("point")?, vector("normal")?).map(Shape::from),
        "disc" => {
            Disc::new(vector("center")?, vector("normal")?, number("radius")?).map(Shape::from)
        }
        "box" => Cuboid::new(vector("low")?, vector("high")?).map(Shape::from),
        "cylinder" => {
            Cylinder::new(vector("bottom")?, vector("top")?, number("radius")?).map(Shape::from)
        }
        "cone" => {
            let top_radius = section.number("top_radius").unwrap_or(0.0);
            let (bottom, top) = (vector("bottom")?, vector("top")?);
            Cone::new(bottom, top, number("bottom_radius")?, top_radius).map(Shape::from)
        }
        _ => mesh(section)?.map(|mesh| Arc::new(mesh).into()),
    })
}

/// The mesh that stands in the scene file itself.
fn mesh(section: &Section<'_, '_>) -> Checked<Result<Mesh>> {
    let points = section.items("vertices").filter_map(numbers::<3>);
    let points: Vec<[f64; 3]> = points.collect();
    let is_far = |point: &[f64; 3]| point.iter().any(|x| x.abs() >= TOO_FAR);
    // Mesh files lose the triangles at such a corner; a scene file, written by hand, is refused.
    if let Some(far) = points.iter().position(is_far) {
        let what = format!("vertex {far} has a coordinate that is not below {TOO_FAR:e}");
        return Err(section.fault_in("vertices", far, what));
    }
    let triangles = section.items("triangles").filter_map(triple).collect();
    Ok(Mesh::new(Positions::compact(points), triangles))
}

/// The most objects: a small text may name a file many times.
const MOST_OBJECTS: usize = 1 << 20;

/// The objects in the order of the text.
pub(super) fn read(scene: &Section<'_, '_>, report: &mut Report) -> Checked<Vec<Object>> {
    let (mut files, mut nodes) = (Files::default(), Renumber::default());
    let mut objects = Vec::new();
    for section in scene.list("objects", &OBJECT)? {
        let placed = placement::read(&section)?;
        if section.has("file") {
            let of_file = files.read(&section, report)?;
            let unit = section.text("units").unwrap_or_default();
            let unit = UNITS.iter().find(|&&(name, _)| name == unit);
            let placed = unit
                .map_or(placed, |&(_, metres)| placed * DAffine3::from_scale(DVec3::splat(metres)));
            let count = objects.len() + of_file.len();
            if count > MOST_OBJECTS {
                let what = "objects in a scene file";
                let (got, limit) = (format!("at least {count}"), MOST_OBJECTS.to_string());
                return Err(Error::Limit { what, got, limit }.into());
            }
            // Their names too: the table's own may be long, and stands in each.
            let own_name = section.text("name").map_or(0, str::len) as u64;
            let each = OBJECT_BYTES.saturating_add(own_name);
            let names: usize = of_file.iter().map(|object| object.name().len()).sum();
            let needed = each.saturating_mul(of_file.len() as u64);
            let needed = needed.saturating_add(names as u64);
            let charged = (report.budget).charge(needed, "an object for each of the file's");
            // To count the lines up to here for each of many objects would take longer than all
            // else.
            charged.map_err(|fault| match fault {
                Fault::TooLarge { what, .. } => Fault::too_large(section.place("file"), what),
                other => other,
            })?;
            let of_nodes = of_file.iter().filter_map(Object::node);
            let of_nodes = nodes.batch(of_nodes, section.text("name"), report)?;
            for object in &*of_file {
                let name = name_of(&section, object, of_file.len() > 1);
                let node = object.node().and_then(|node| of_nodes.get(node));
                let object = object.clone().named(name).from_node(node.cloned());
                objects.push(finished(&section, object, placed, "file")?);
            }
        } else {
            let name = section.text("name").or(section.tag()).unwrap_or_default();
            let object = Object::new(shape_of(&section)?).named(name);
            objects.push(finished(&section, object, placed, "shape")?);
        }
    }
    Ok(objects)
}

/// The object where the table puts it, in the colour that the table gives it.
fn finished(
    section: &Section<'_, '_>,
    object: Object,
    placed: DAffine3,
    key: &str,
) -> Checked<Object> {
    let color = section.color("color");
    let object = match (section.table("material", &MATERIAL)?, color) {
        (Some(material), color) => object.with_materials([material::read(&material, color)?]),
        (None, Some(color)) => object.colored(color),
        (None, None) => object,
    };
    if placed == DAffine3::IDENTITY {
        return Ok(object);
    }
    let placed = placed * *object.transform().world_from_object();
    match Transform::new(placed) {
        Ok(transform) => Ok(object.placed(transform)),
        Err(error) => Err(section.fault_at(key, format!("an object cannot stand there: {error}"))),
    }
}

fn name_of(section: &Section<'_, '_>, object: &Object, is_one_of_several: bool) -> String {
    match section.text("name") {
        Some(name) if is_one_of_several => format!("{name}/{}", object.name()),
        Some(name) => name.to_owned(),
        None => object.name().to_owned(),
    }
}

/// The extensions of scene files.
pub(super) const EXTENSIONS: &[&str] = &["toml"];

/// The world of a file that a scene file names.
fn part(path: &Path, report: &mut Report) -> Result<World> {
    #[cfg(feature = "fhs")]
    if has_extension(path, fhs::FORMAT.format.extensions) {
        return fhs::open_part(path, report);
    }
    Ok(World::of(load_part(path, report)?))
}

/// The world of a file in the variant that its table names, if it names one; where the file has
/// none of that name, what to tell of it.
fn part_in(
    path: &Path,
    variant: Option<&str>,
    report: &mut Report,
) -> Result<(World, Option<String>)> {
    let Some(variant) = variant else {
        return Ok((part(path, report)?, None));
    };
    let asked = report.settings.variant.replace(variant.to_owned());
    let of_others = std::mem::take(&mut report.variants);
    let read = part(path, report);
    report.settings.variant = asked;
    let own = std::mem::replace(&mut report.variants, of_others);
    let unknown = unknown_variant(variant, &own);
    report.add_variants(own);
    Ok((read?, unknown))
}

/// The files that were read: each once, however often it is named.
#[derive(Debug, Default)]
struct Files {
    /// The objects of files, by their paths and the variants that the scene file names.
    known: HashMap<(PathBuf, Option<String>), Arc<[Object]>>,
    meshes: Renumber,
}

impl Files {
    fn read(&mut self, section: &Section<'_, '_>, report: &mut Report) -> Checked<Arc<[Object]>> {
        let name = section.need("file", Section::text)?;
        let refused = |reason: &str| {
            let name = escape_controls(name);
            section.fault_at("file", format!("'{name}' is not read: {reason}"))
        };
        let path = report.sibling(name).map_err(|reason| refused(&reason))?;
        let own = section.text("variant").map(str::to_owned);
        let key = (path.clone(), own.clone());
        if let Some(objects) = self.known.get(&key) {
            return Ok(Arc::clone(objects));
        }
        if has_extension(&path, EXTENSIONS) {
            return Err(refused("a scene file holds no other scene files"));
        }
        let world = match part_in(&path, own.as_deref(), report) {
            Ok((_, Some(unknown))) => {
                let name = escape_controls(name);
                let what = format!("'{name}' has no variant {unknown}");
                return Err(section.fault_at("variant", what));
            }
            Ok((world, None)) => world,
            Err(error @ (Error::Parse { .. } | Error::Read { .. })) => {
                return Err(refused(&error.to_string()));
            }
            Err(error) => return Err(error.into()),
        };
        let is_plain = world.cameras.is_empty() && world.lights.is_empty();
        if !is_plain || world.environment.is_some() {
            report.warn("only objects", &section.place("file"), || {
                let name = escape_controls(name);
                format!("of '{name}' only the objects are taken, not its cameras and its light")
            });
        }
        let of_meshes = world.objects.iter().filter_map(Object::mesh_label);
        let of_meshes = self.meshes.batch(of_meshes, None, report)?;
        let labelled = |object: &Object| {
            let mesh = object.mesh_label().and_then(|mesh| of_meshes.get(mesh));
            object.clone().from_mesh(mesh.cloned())
        };
        let objects: Arc<[Object]> = world.objects.iter().map(labelled).collect();
        self.known.insert(key, Arc::clone(&objects));
        Ok(objects)
    }
}
