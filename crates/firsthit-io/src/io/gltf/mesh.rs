//! Makes a mesh of a primitive.

use std::collections::HashMap;
use std::rc::Rc;

use super::super::fault::{Checked, Fault};
use super::super::memory_budget::check_free;
use super::super::sanitize::{ValueKind, sanitize};
use super::super::surface::{Surface, Vertices, push_fan};
use super::accessor::{Component, Shape, component, has_shape};
use super::index::Index;
use super::material::Look;
use super::named;
use super::skin::{self, Palette};
use super::values::Values;
use crate::geometry::{DAffine3, DVec3, single};
use crate::scene::UvSet;
use crate::shape::{Attribute, Mesh, Positions};

/// The deformation of a primitive's vertices: morph targets and joints.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Deformation<'a> {
    /// The weight of each morph target.
    pub(super) weights: &'a [f64],
    pub(super) palette: Option<&'a Palette>,
    /// The map of the mesh's node, at which vertices stay that no joint moves.
    pub(super) node: DAffine3,
    /// A map that no transform can stand for, since it flattens space.
    pub(super) flattened: Option<DAffine3>,
}

/// Vertices that several primitives name, by their accessors.
pub(super) type Shared = HashMap<Index, Rc<Vertices>>;

/// The mesh of a primitive; `None`, with a warning, where it has no triangles by its kind.
pub(super) fn build(
    values: &mut Values<'_, '_, '_>,
    deformation: &Deformation<'_>,
    look: Option<&Look>,
    name: &str,
    shared: &mut Shared,
) -> Checked<Option<Mesh>> {
    let Some(mode) = mode(values)? else {
        return Ok(None);
    };
    let Some(index) = values.attribute("POSITION") else {
        let place = values.place("attributes");
        let what = || "a primitive without POSITION is not seen".to_owned();
        values.report.warn("POSITION", &place, what);
        return Ok(None);
    };
    let is_plain = deformation.palette.is_none()
        && deformation.flattened.is_none()
        && !is_morphed(values, deformation);
    let (vertices, maps) = if is_plain {
        (plain(values, index, shared)?, None)
    } else {
        deformed(values, index, deformation)?
    };
    let count = vertices.positions.len();
    let triangles = triangles(values, mode, count)?;
    let (mesh, _) = Surface::of(triangles).finish(&vertices, name, values.report)?;
    let mesh = with_normals(mesh, values, deformation, maps.as_deref(), count)?;
    let mesh = with_uvs(mesh, values, look, count)?;
    let mesh = with_tangents(mesh, values, look, (deformation, maps.as_deref()), count)?;
    let mesh = with_colors(mesh, values, look, count)?;
    named::with_properties(mesh, values, count).map(Some)
}

/// The topology: how indices make triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

fn mode(values: &mut Values<'_, '_, '_>) -> Checked<Option<Mode>> {
    let Index(code) = values.primitive.mode.unwrap_or(Index(4));
    let place = values.place("mode");
    let mut unseen = |key: &'static str| {
        values
            .report
            .warn(key, &place, || format!("primitives of {key} (mode {code}) are not seen"));
        Ok(None)
    };
    match code {
        0 => unseen("points"),
        1 => unseen("lines"),
        2 => unseen("line loops"),
        3 => unseen("line strips"),
        4 => Ok(Some(Mode::Triangles)),
        5 => Ok(Some(Mode::Strip)),
        6 => Ok(Some(Mode::Fan)),
        _ => Err(Fault::at(place, format!("must be from 0 to 6, got {code}"))),
    }
}

/// The targets of a primitive that add something, with how much.
fn targets<'v>(
    values: &Values<'v, '_, '_>,
    deformation: &Deformation<'_>,
) -> Vec<(&'v super::document::Attributes<'v>, f64)> {
    let targets = values.primitive.targets.iter().zip(deformation.weights);
    targets
        .filter(|(_, weight)| **weight != 0.0)
        .map(|(target, &weight)| (target, weight))
        .collect()
}

fn is_morphed(values: &Values<'_, '_, '_>, deformation: &Deformation<'_>) -> bool {
    !targets(values, deformation).is_empty()
}

/// The vertices as the file has them.
fn plain(
    values: &mut Values<'_, '_, '_>,
    index: Index,
    shared: &mut Shared,
) -> Checked<Rc<Vertices>> {
    if let Some(known) = shared.get(&index)
        && !values.is_packed()
    {
        return Ok(Rc::clone(known));
    }
    let positions = if component(values.document, index)? == Component::Float32 {
        Positions::Single(values.all("POSITION", index, &Shape::VEC3)?.into())
    } else {
        Positions::compact(values.all("POSITION", index, &Shape::VEC3)?)
    };
    let vertices = Rc::new(Vertices::new(positions));
    if !values.is_packed() {
        shared.insert(index, Rc::clone(&vertices));
    }
    Ok(vertices)
}

/// The vertices morphed, then moved by joints, then flattened; with what joints do to each.
fn deformed(
    values: &mut Values<'_, '_, '_>,
    index: Index,
    deformation: &Deformation<'_>,
) -> Checked<(Rc<Vertices>, Option<Vec<DAffine3>>)> {
    let mut points: Vec<[f64; 3]> = values.all("POSITION", index, &Shape::VEC3)?;
    morph(values, deformation, "POSITION", &mut points)?;
    let maps = match deformation.palette {
        Some(palette) => Some(skin::maps(values, palette, deformation.node, points.len())?),
        None => None,
    };
    if let Some(maps) = &maps {
        for (point, map) in points.iter_mut().zip(maps) {
            *point = map.transform_point3((*point).into()).into();
        }
    }
    if let Some(map) = &deformation.flattened {
        for point in &mut points {
            *point = map.transform_point3((*point).into()).into();
        }
    }
    Ok((Rc::new(Vertices::new(Positions::compact(points))), maps))
}

fn morph(
    values: &mut Values<'_, '_, '_>,
    deformation: &Deformation<'_>,
    name: &str,
    vectors: &mut [[f64; 3]],
) -> Checked<()> {
    for (target, weight) in targets(values, deformation) {
        let Some(moves) = values.target::<3>(target, name, &Shape::VEC3, vectors.len())? else {
            continue;
        };
        for (vector, change) in vectors.iter_mut().zip(moves) {
            for (x, dx) in vector.iter_mut().zip(change) {
                *x += weight * dx;
            }
        }
    }
    Ok(())
}

/// The triangles of a primitive of `vertices` vertices.
fn triangles(
    values: &mut Values<'_, '_, '_>,
    mode: Mode,
    vertices: usize,
) -> Checked<Vec<[u32; 3]>> {
    if let Some(triangles) = values.unpacked_triangles() {
        let largest = triangles.iter().flatten().max();
        if let Some(&index) = largest.filter(|&&index| index as usize >= vertices) {
            let what = format!("index {index} of {vertices} vertices");
            return Err(Fault::at(values.place("indices"), what));
        }
        return Ok(triangles);
    }
    let indices: Vec<u32> = if let Some(index) = values.primitive.indices {
        indices(values, index, vertices)?
    } else {
        let what = "has more than 2^32 vertices";
        let count = u32::try_from(vertices);
        let count = count.map_err(|_| values.attribute_fault("POSITION", what))?;
        let budget = &mut values.report.budget;
        budget.charge(4 * u64::from(count), "the indices")?;
        (0..count).collect()
    };
    let budget = &mut values.report.budget;
    budget.charge(12 * indices.len() as u64, "the triangles")?;
    Ok(match mode {
        Mode::Triangles => {
            let (triangles, rest) = indices.as_chunks::<3>();
            if !rest.is_empty() {
                let place = values.place("indices");
                let left = rest.len();
                let what = || format!("{left} indices after the last triangle are not read");
                values.report.warn("indices", &place, what);
            }
            triangles.to_vec()
        }
        Mode::Strip => {
            let steps = indices.windows(3).zip([false, true].into_iter().cycle());
            let turned = steps.filter_map(|step| match step {
                (&[a, b, c], false) => Some([a, b, c]),
                (&[a, b, c], true) => Some([b, a, c]),
                _ => None,
            });
            turned.collect()
        }
        Mode::Fan => {
            let mut triangles = Vec::new();
            push_fan(&mut triangles, &indices);
            triangles
        }
    })
}

fn indices(values: &mut Values<'_, '_, '_>, index: Index, vertices: usize) -> Checked<Vec<u32>> {
    let entry = super::accessor::entry(index);
    if !component(values.document, index)?.is_unsigned() {
        let what = "indices must be 5121, 5123 or 5125 (unsigned)";
        return Err(entry.fault("componentType", what));
    }
    let indices = values.elements::<u32, 1>(index, &Shape::SCALAR)?.into_flattened();
    let largest = indices.iter().copied().max().unwrap_or_default() as usize;
    if largest < vertices || indices.is_empty() {
        return Ok(indices);
    }
    let bad = indices.iter().position(|&index| index as usize >= vertices).unwrap_or_default();
    let value = indices.get(bad).copied().unwrap_or_default();
    let what = format!("element {bad} is index {value}, of {vertices} vertices");
    Err(Fault::at(entry.place(), what))
}

fn with_normals(
    mesh: Mesh,
    values: &mut Values<'_, '_, '_>,
    deformation: &Deformation<'_>,
    maps: Option<&[DAffine3]>,
    count: usize,
) -> Checked<Mesh> {
    // A surface that was flattened has only its triangles' normals.
    if deformation.flattened.is_some() || values.attribute("NORMAL").is_none() {
        return Ok(mesh);
    }
    if maps.is_none() && !is_morphed(values, deformation) {
        let normals = sanitized(values, "NORMAL", &Shape::VEC3, ValueKind::Normals, count)?;
        return Ok(mesh.with_normals(Attribute::per_vertex(normals.unwrap_or_default()))?);
    }
    let mut normals: Vec<[f64; 3]> =
        values.read("NORMAL", &Shape::VEC3, count)?.unwrap_or_default();
    morph(values, deformation, "NORMAL", &mut normals)?;
    for (normal, map) in normals.iter_mut().zip(maps.unwrap_or_default()) {
        // By the inverse transpose, as surfaces are turned.
        *normal = (map.matrix3.inverse().transpose() * DVec3::from(*normal)).into();
    }
    // Joints that flatten space, which is no fault, leave no normal either.
    let is_moved = maps.is_some();
    let mut normals: Vec<[f32; 3]> = normals
        .iter()
        .map(|normal| match normal.map(single) {
            moved if is_moved && !moved.iter().all(|x| x.is_finite()) => [0.0; 3],
            normal => normal,
        })
        .collect();
    sanitize_attribute(values, &mut normals, ValueKind::Normals, "NORMAL");
    Ok(mesh.with_normals(Attribute::per_vertex(normals))?)
}

/// The values of an attribute, unusable ones replaced.
fn sanitized<const N: usize>(
    values: &mut Values<'_, '_, '_>,
    name: &str,
    shape: &Shape,
    kind: ValueKind,
    count: usize,
) -> Checked<Option<Vec<[f32; N]>>> {
    let mut numbers = values.read(name, shape, count)?;
    if let Some(numbers) = &mut numbers {
        sanitize_attribute(values, numbers, kind, name);
    }
    Ok(numbers)
}

/// Replaces unusable values of an attribute.
fn sanitize_attribute<const N: usize>(
    values: &mut Values<'_, '_, '_>,
    numbers: &mut [[f32; N]],
    kind: ValueKind,
    name: &str,
) {
    let place = values.place(&format!("attributes/{name}"));
    sanitize(numbers, kind, &place, values.report);
}

/// The texture coordinates that the material takes; without a texture, the first set.
fn with_uvs(
    mesh: Mesh,
    values: &mut Values<'_, '_, '_>,
    look: Option<&Look>,
    count: usize,
) -> Checked<Mesh> {
    let [first, second] = look.map_or([None; 2], |look| look.sets);
    let mut mesh = mesh;
    if let Some(uvs) = uvs(values, first.unwrap_or(0), first.is_some(), count)? {
        mesh = mesh.with_uvs(uvs)?;
    }
    if let Some(second) = second
        && let Some(uvs) = uvs(values, second, true, count)?
    {
        mesh = mesh.with_second_uvs(uvs)?;
    }
    Ok(mesh)
}

/// A set of texture coordinates; that it is not there is a warning where a texture takes it.
fn uvs(
    values: &mut Values<'_, '_, '_>,
    set: usize,
    is_taken: bool,
    count: usize,
) -> Checked<Option<Attribute<2>>> {
    let name = format!("TEXCOORD_{set}");
    let uvs = sanitized(values, &name, &Shape::VEC2, ValueKind::Coordinates, count)?;
    if uvs.is_none() && is_taken {
        let place = values.place("attributes");
        values.report.warn("TEXCOORD", &place, || {
            format!("there is no {name} for the material's texture: the surface has a flat colour")
        });
    }
    Ok(uvs.map(Attribute::per_vertex))
}

/// Tangents where the material has a normal map: the file's, or such as tools make them that make
/// normal maps.
fn with_tangents(
    mesh: Mesh,
    values: &mut Values<'_, '_, '_>,
    look: Option<&Look>,
    (deformation, maps): (&Deformation<'_>, Option<&[DAffine3]>),
    count: usize,
) -> Checked<Mesh> {
    let Some(set) = look.and_then(|look| look.normal_set) else {
        return Ok(mesh);
    };
    // Tangents of vertices mean nothing without normals of vertices.
    let has_own = values.attribute("TANGENT").is_some() && mesh.normals().is_some();
    if has_own && !is_morphed(values, deformation) {
        let tangents = sanitized(values, "TANGENT", &Shape::VEC4, ValueKind::Normals, count)?;
        let mut tangents: Vec<[f32; 4]> = tangents.unwrap_or_default();
        for (tangent, map) in tangents.iter_mut().zip(maps.unwrap_or_default()) {
            let [x, y, z, sign] = *tangent;
            let moved = map.matrix3 * DVec3::from([x, y, z].map(f64::from));
            let [x, y, z] = moved.to_array().map(single);
            *tangent = [x, y, z, sign];
        }
        return Ok(mesh.with_tangents(Attribute::per_vertex(tangents))?);
    }
    let uvs = match set {
        UvSet::First => mesh.uvs(),
        UvSet::Second => mesh.second_uvs(),
    };
    let Some(uvs) = uvs.cloned() else {
        return Ok(mesh);
    };
    let needed = TANGENT_BYTES.saturating_mul(mesh.triangles().len() as u64);
    values.report.budget.charge(needed, "the tangents")?;
    check_free(usize::try_from(needed).unwrap_or(usize::MAX))?;
    let tangents = mesh.made_tangents(&uvs)?;
    Ok(mesh.with_tangents(tangents)?)
}

/// The memory for a triangle's tangents: of each corner a key, a sum and a value, and its number.
const TANGENT_BYTES: u64 = 3 * (72 + 32 + 16 + 4);

fn with_colors(
    mesh: Mesh,
    values: &mut Values<'_, '_, '_>,
    look: Option<&Look>,
    count: usize,
) -> Checked<Mesh> {
    let Some(index) = values.attribute("COLOR_0") else {
        return Ok(mesh);
    };
    if has_shape(values.document, index, &Shape::VEC3) {
        let colors = sanitized(values, "COLOR_0", &Shape::VEC3, ValueKind::Colors, count)?;
        return Ok(mesh.with_colors(Attribute::per_vertex(colors.unwrap_or_default()))?);
    }
    let colors = sanitized::<4>(values, "COLOR_0", &Shape::VEC4, ValueKind::Colors, count)?;
    let colors = colors.unwrap_or_default();
    let opaque = colors.iter().map(|&[red, green, blue, _]| [red, green, blue]);
    let mesh = mesh.with_colors(Attribute::per_vertex(opaque.collect()))?;
    if !look.is_some_and(|look| look.has_alpha) {
        return Ok(mesh);
    }
    let alphas = colors.iter().map(|&[.., alpha]| [alpha]).collect();
    Ok(mesh.with_alphas(Attribute::per_vertex(alphas))?)
}
