//! The objects of an OBJ file, from faces to meshes.

use super::index::NONE;
use std::collections::HashMap;
use std::sync::Arc;

use super::values::{Materials, Values};
use crate::io::fault::Checked;
use crate::io::report::Report;
use crate::io::surface::{Surface, Vertices, push_fan};
use crate::scene::{self, Material};
use crate::shape::{Attribute, Mesh};

/// A face, as indices from 0: of vertices, texture coordinates and normals, [`NONE`] where it has
/// none.
#[derive(Debug, Default)]
pub(super) struct Face {
    pub(super) vertices: Vec<u32>,
    pub(super) others: [Vec<u32>; 2],
}

impl Face {
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.others.iter_mut().for_each(Vec::clear);
    }
}

/// An object in the making.
#[derive(Debug)]
pub(super) struct Object {
    pub(super) name: String,
    surface: Surface,
    /// Whether all faces so far have texture coordinates and normals.
    has: [bool; 2],
    /// The first face of each material's run, and the material.
    materials: Vec<(u32, Option<u32>)>,
}

impl Object {
    pub(super) fn new(name: String) -> Self {
        Self { name, surface: Surface::default(), has: [true; 2], materials: Vec::new() }
    }

    /// The object's size in bytes so far.
    pub(super) fn bytes(&self) -> usize {
        self.surface.bytes() + size_of::<Self>()
    }

    pub(super) fn push(&mut self, face: &Face, material: Option<u32>) {
        if self.materials.last().is_none_or(|&(_, last)| last != material) {
            self.materials.push((self.surface.face_count(), material));
        }
        self.surface.push(&face.vertices);
        let kinds = self.has.iter_mut().zip(&mut self.surface.corners);
        for ((has, corners), ring) in kinds.zip(&face.others) {
            *has &= !ring.contains(&NONE);
            if *has {
                push_fan(corners, ring);
            } else {
                *corners = Vec::new();
            }
        }
    }

    pub(super) fn finish(
        self,
        vertices: &Vertices,
        values: &Values,
        materials: &Materials,
        gather: &mut Gather,
        report: &mut Report,
    ) -> Checked<scene::Object> {
        let Self { name, surface, has, materials: runs } = self;
        let face_count = surface.face_count();
        let (mut mesh, [uvs, normals]) = surface.finish(vertices, &name, report)?;
        if let ([true, _], Some(uvs)) = (has, gather.attribute(&values.uvs, uvs)) {
            mesh = mesh.with_uvs(uvs)?;
        }
        if let ([_, true], Some(normals)) = (has, gather.attribute(&values.normals, normals)) {
            mesh = mesh.with_normals(normals)?;
        }
        let corners = mesh.triangles().to_vec();
        let (mesh, looks) = match gather.attribute(&values.colors, corners) {
            // White leaves the mesh's own colours as they are.
            Some(colors) if !values.colors.is_empty() => {
                (mesh.with_colors(colors)?, vec![Material::default()])
            }
            _ => dress(mesh, face_count, &runs, materials)?,
        };
        let object = scene::Object::new(Arc::new(mesh)).named(name);
        Ok(if looks.is_empty() { object } else { object.with_materials(looks) })
    }
}

/// Gives a mesh its materials: none, one to all of it, or a slot to each triangle.
fn dress(
    mesh: Mesh,
    face_count: u32,
    runs: &[(u32, Option<u32>)],
    materials: &Materials,
) -> Checked<(Mesh, Vec<Material>)> {
    let look_of = |number: Option<u32>| number.and_then(|number| materials.look(number));
    let first = runs.first().and_then(|&(_, number)| look_of(number));
    if runs.iter().all(|&(_, number)| look_of(number) == first) {
        return Ok((mesh, first.into_iter().cloned().collect()));
    }
    let mut slots = HashMap::new();
    let mut looks = Vec::new();
    let mut slot_of_face = Vec::new();
    let starts_of_next = runs.iter().skip(1).map(|&(start, _)| start);
    for (&(start, number), end) in runs.iter().zip(starts_of_next.chain([face_count])) {
        let slot = *slots.entry(number).or_insert_with(|| {
            let neutral = || Material::colored(scene::Object::NEUTRAL);
            looks.push(look_of(number).cloned().unwrap_or_else(neutral));
            #[expect(clippy::cast_possible_truncation, reason = "at most as many as faces")]
            let slot = (looks.len() - 1) as u32;
            slot
        });
        slot_of_face.extend((start..end).map(|_| slot));
    }
    let slots = (0..mesh.triangles().len())
        .map(|triangle| slot_of_face.get(mesh.face(triangle)).copied())
        .map(Option::unwrap_or_default)
        .collect();
    Ok((mesh.with_slots(slots)?, looks))
}

/// Takes from a file's values those that an object uses, so that each of many objects does not hold
/// them all.
#[derive(Debug, Default)]
pub(super) struct Gather {
    /// The place of each value of the file among those taken, or [`NONE`]; all of them between
    /// calls.
    places: Vec<u32>,
}

impl Gather {
    /// The values at `corners`; `None` if one of them has none.
    fn attribute<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        mut corners: Vec<[u32; 3]>,
    ) -> Option<Attribute<N>> {
        if self.places.len() < values.len() {
            self.places.resize(values.len(), NONE);
        }
        let (mut taken, mut origins) = (Vec::new(), Vec::new());
        let mut is_complete = true;
        for corner in corners.iter_mut().flatten() {
            let source = *corner as usize;
            let (Some(place), Some(&value)) = (self.places.get_mut(source), values.get(source))
            else {
                is_complete = false;
                break;
            };
            if *place == NONE {
                #[expect(clippy::cast_possible_truncation, reason = "at most as many as values")]
                let next = taken.len() as u32;
                *place = next;
                taken.push(value);
                origins.push(source);
            }
            *corner = *place;
        }
        for origin in origins {
            if let Some(place) = self.places.get_mut(origin) {
                *place = NONE;
            }
        }
        is_complete.then_some(Attribute { values: taken.into(), corners: Some(corners.into()) })
    }
}
