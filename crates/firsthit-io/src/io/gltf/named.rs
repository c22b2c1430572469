//! Attributes that mean nothing to us, and colours beside the first, kept by their names.

use super::super::fault::Checked;
use super::accessor::{Component, Shape, component, declared};
use super::index::Index;
use super::values::Values;
use crate::error::escape_controls;
use crate::memory::Storage;
use crate::shape::{Between, Mesh, Property, PropertyOf, PropertyValues};

/// The mesh with the properties of a primitive of `vertices` vertices.
pub(super) fn with_properties(
    mesh: Mesh,
    values: &mut Values<'_, '_, '_>,
    vertices: usize,
) -> Checked<Mesh> {
    let primitive = values.primitive;
    let mut properties = Vec::new();
    for (name, &index) in &primitive.attributes {
        if is_kept(name)
            && let Some(property) = property(values, name, index, vertices)?
        {
            properties.push(property);
        }
    }
    if properties.is_empty() {
        return Ok(mesh);
    }
    Ok(mesh.with_properties(properties)?)
}

/// Whether an attribute is one of the application, which begin with an underscore, or a colour
/// beside the first.
fn is_kept(name: &str) -> bool {
    let number = name.strip_prefix("COLOR_");
    name.starts_with('_') || number.is_some_and(|number| number != "0")
}

/// `None`, with a warning, where the numbers are no vectors, or not as many as vertices.
fn property(
    values: &mut Values<'_, '_, '_>,
    name: &str,
    index: Index,
    vertices: usize,
) -> Checked<Option<Property>> {
    let accessor = declared(values.document, index)?;
    let (kind, Index(count)) = (&*accessor.kind, accessor.count);
    let shapes = [Shape::SCALAR, Shape::VEC2, Shape::VEC3, Shape::VEC4];
    let shape = shapes.into_iter().find(|shape| shape.name == kind);
    let is_packed = values.is_packed();
    let Some(shape) = shape.filter(|_| is_packed || count == vertices) else {
        let place = values.place("attributes");
        let [name, kind] = [name, kind].map(escape_controls);
        values.report.warn("attributes", &place, || {
            format!("{name}, {count} values of type {kind} for {vertices} vertices, is not kept")
        });
        return Ok(None);
    };
    let component = component(values.document, index)?;
    let is_share = accessor.normalized && component != Component::Float32;
    // Numbers that float32 holds without a loss are kept as such.
    let is_double = is_share || component == Component::Uint32;
    let numbers = match shape.components {
        1 => numbers::<1>(values, (name, &shape), is_double, vertices)?,
        2 => numbers::<2>(values, (name, &shape), is_double, vertices)?,
        3 => numbers::<3>(values, (name, &shape), is_double, vertices)?,
        _ => numbers::<4>(values, (name, &shape), is_double, vertices)?,
    };
    let is_whole = component != Component::Float32 && !is_share;
    Ok(Some(Property {
        components: shape.components,
        between: if is_whole { Between::NearestCorner } else { Between::Interpolated },
        ..Property::new(escape_controls(name), PropertyOf::Vertices, numbers)
    }))
}

fn numbers<const N: usize>(
    values: &mut Values<'_, '_, '_>,
    (name, shape): (&str, &Shape),
    is_double: bool,
    vertices: usize,
) -> Checked<PropertyValues> {
    Ok(if is_double {
        let read = values.read::<f64, N>(name, shape, vertices)?;
        PropertyValues::Double(Storage::from(read.unwrap_or_default().into_flattened()))
    } else {
        let read = values.read::<f32, N>(name, shape, vertices)?;
        PropertyValues::Single(Storage::from(read.unwrap_or_default().into_flattened()))
    })
}
