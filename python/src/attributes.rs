//! Attributes of meshes, by name: into meshes, out of them, and where rays met them.

use firsthit::channel::{AttributeName, AttributeValues, attribute as look_up, attributes};
use firsthit::shape::{Between, Property, PropertyValues};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{HitsIn, copied};
use crate::errors::Outcome;
use crate::run::{FEW, run_sized};
use crate::scene::Scene;

/// Numbers by name: what has them, name, how many each has, whether between corners those of the
/// nearest count, and the numbers.
#[derive(FromPyObject)]
pub(crate) struct PropertyIn<'py>(String, String, usize, bool, ValuesIn<'py>);

#[derive(FromPyObject)]
enum ValuesIn<'py> {
    Single(PyReadonlyArray1<'py, f32>),
    Double(PyReadonlyArray1<'py, f64>),
}

impl PropertyIn<'_> {
    pub(crate) fn property(self) -> Outcome<Property> {
        let Self(of, name, components, is_of_nearest, values) = self;
        Ok(Property {
            name,
            of: of.parse()?,
            components,
            between: if is_of_nearest { Between::NearestCorner } else { Between::Interpolated },
            values: match values {
                ValuesIn::Single(values) => {
                    let values = values.as_slice()?;
                    PropertyValues::Single(copied(values)?.into())
                }
                ValuesIn::Double(values) => {
                    let values = values.as_slice()?;
                    PropertyValues::Double(copied(values)?.into())
                }
            },
        })
    }
}

/// A property as it goes in.
pub(crate) type PropertyOut<'py> = (&'static str, String, usize, bool, Bound<'py, PyAny>);

pub(crate) fn property_out<'py>(py: Python<'py>, property: &Property) -> Outcome<PropertyOut<'py>> {
    let values = match &property.values {
        PropertyValues::Single(values) => PyArray1::from_vec(py, copied(values)?).into_any(),
        PropertyValues::Double(values) => PyArray1::from_vec(py, copied(values)?).into_any(),
    };
    let is_of_nearest = property.between == Between::NearestCorner;
    let of = property.of.name();
    Ok((of, property.name.clone(), property.components, is_of_nearest, values))
}

/// An attribute at hits: how many numbers each has, and the numbers, flat.
#[pyfunction]
pub(crate) fn attribute<'py>(
    py: Python<'py>,
    scene: &Scene,
    named: (String, Option<String>),
    hits: HitsIn<'py>,
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<(usize, Bound<'py, PyArray1<f64>>)> {
    let (name, of) = named;
    let of = of.as_deref().map(str::parse).transpose()?;
    let hits = hits.hits()?;
    let size = (hits.len(), hits.len() < FEW);
    let found = run_sized(py, size, threads, report.as_ref(), |watch| {
        look_up(&name, of, &scene.0, &hits, watch)
    })?;
    let AttributeValues { components, values } = found;
    Ok((components, PyArray1::from_vec(py, values)))
}

/// The attributes that a scene's meshes have: name, what has them, how many numbers.
#[pyfunction]
pub(crate) fn attribute_names(scene: &Scene) -> Vec<(String, &'static str, usize)> {
    let out = |found: AttributeName<'_>| (found.name.to_owned(), found.of.name(), found.components);
    attributes(&scene.0).into_iter().map(out).collect()
}
