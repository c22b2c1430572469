//! The values that a primitive names, from accessors or unpacked.

use super::super::fault::{Checked, Fault};
use super::super::report::Report;
use super::accessor::{self, Elements, Number, Shape};
use super::buffers::Buffers;
use super::document::{Attributes, Document, Primitive};
use super::draco::Unpacked;
use super::index::Index;
use super::place::{Entry, key};
use super::problem::Problem;
use crate::error::Place;

/// A primitive, and all it takes to read what it names.
pub(super) struct Values<'a, 'b, 'w> {
    pub(super) document: &'a Document<'a>,
    pub(super) primitive: &'a Primitive<'a>,
    /// The entry of the mesh.
    entry: Entry,
    number: usize,
    unpacked: Option<Unpacked>,
    pub(super) buffers: &'b mut Buffers<'a>,
    pub(super) report: &'b mut Report<'w>,
}

impl<'a, 'b, 'w> Values<'a, 'b, 'w> {
    pub(super) fn new(
        document: &'a Document<'a>,
        (mesh, number): (usize, usize),
        buffers: &'b mut Buffers<'a>,
        report: &'b mut Report<'w>,
    ) -> Checked<Self> {
        let entry = Entry::new("meshes", mesh);
        let mesh = document.meshes.get(mesh);
        let primitive = mesh.and_then(|mesh| mesh.primitives.get(number));
        let primitive = primitive.ok_or_else(|| entry.fault("", "there is no such primitive"))?;
        let mut values =
            Self { document, primitive, entry, number, unpacked: None, buffers, report };
        if let Some(draco) = &primitive.extensions.draco {
            let bytes = values.buffers.view(draco.buffer_view, values.report)?;
            let unpacked = Unpacked::new(bytes.get(), values.report);
            let place = || values.place("extensions/KHR_draco_mesh_compression");
            values.unpacked = Some(unpacked.map_err(|problem| problem.at(place()))?);
        }
        Ok(values)
    }

    /// The place of a value of the primitive.
    pub(super) fn place(&self, value: &str) -> Place {
        self.entry.at(format!("primitives/{}/{value}", self.number))
    }

    pub(super) fn attribute_fault(&self, name: &str, what: impl Into<String>) -> Fault {
        Fault::at(self.place(&format!("attributes/{}", key(name))), what)
    }

    pub(super) fn attribute(&self, name: &str) -> Option<Index> {
        self.primitive.attributes.get(name).copied()
    }

    pub(super) fn is_packed(&self) -> bool {
        self.unpacked.is_some()
    }

    /// The triangles of a packed primitive.
    pub(super) fn unpacked_triangles(&self) -> Option<Vec<[u32; 3]>> {
        self.unpacked.as_ref().map(Unpacked::triangles)
    }

    /// The values of an attribute, as many as there are vertices; `None` where it is not named.
    pub(super) fn read<T: Number, const N: usize>(
        &mut self,
        name: &str,
        shape: &Shape,
        vertices: usize,
    ) -> Checked<Option<Vec<[T; N]>>> {
        let Some(index) = self.attribute(name) else {
            return Ok(None);
        };
        let values = self.all(name, index, shape)?;
        if values.len() == vertices {
            return Ok(Some(values));
        }
        let what = format!("has {} values for {vertices} vertices", values.len());
        Err(self.attribute_fault(name, what))
    }

    /// All values of an attribute.
    pub(super) fn all<T: Number, const N: usize>(
        &mut self,
        name: &str,
        index: Index,
        shape: &Shape,
    ) -> Checked<Vec<[T; N]>> {
        let draco = self.primitive.extensions.draco.as_ref();
        let packed = draco.and_then(|draco| draco.attributes.get(name));
        if let (Some(&identifier), Some(unpacked)) = (packed, &self.unpacked) {
            accessor::check_shape(self.document, index, shape)?;
            let numbers = unpacked.attribute(identifier, N, self.report);
            let numbers = numbers.map_err(|problem: Problem| {
                let name = key(name);
                let value = format!("extensions/KHR_draco_mesh_compression/attributes/{name}");
                problem.at(self.place(&value))
            })?;
            let component = accessor::component(self.document, index)?;
            let is_share = accessor::declared(self.document, index)?.normalized;
            let largest = is_share.then(|| component.largest());
            let largest = largest.filter(|&largest| largest > 1.0);
            let (values, _) = numbers.as_chunks::<N>();
            let values = values.iter().map(|value| value.map(|x| number(x, largest)));
            return Ok(values.collect());
        }
        self.elements(index, shape)
    }

    /// The values of a morph target, as many as there are vertices.
    pub(super) fn target<const N: usize>(
        &mut self,
        target: &Attributes<'_>,
        name: &str,
        shape: &Shape,
        vertices: usize,
    ) -> Checked<Option<Vec<[f64; N]>>> {
        let Some(&index) = target.get(name) else {
            return Ok(None);
        };
        let values = self.elements(index, shape)?;
        if values.len() == vertices {
            return Ok(Some(values));
        }
        let count = values.len();
        let what = format!("a morph target has {count} values for {vertices} vertices");
        Err(Fault::at(self.place("targets"), what))
    }

    pub(super) fn elements<T: Number, const N: usize>(
        &mut self,
        index: Index,
        shape: &Shape,
    ) -> Checked<Vec<[T; N]>> {
        Elements::new(self.document, index, shape, self.buffers, self.report)?.read(self.report)
    }
}

/// A number that was unpacked as a float.
#[expect(clippy::cast_possible_truncation, reason = "whole, where it is a share")]
fn number<T: Number>(value: f32, largest: Option<f64>) -> T {
    match largest {
        None => T::from_single(value),
        Some(_) => T::from_whole(value as i64, largest),
    }
}
