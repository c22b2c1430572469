//! Scenes, and files that hold them.

use std::path::PathBuf;
use std::sync::Arc;

use firsthit::io::LoadSettings;
use firsthit::{Color, DAffine3, DMat3, DVec3, Light, Object, Transform};
use pyo3::prelude::*;

use crate::errors::raise;
use crate::run::run;
use crate::shape::{Mesh, Shape};

/// A built scene.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Scene(pub(crate) firsthit::Scene);

/// An object: shape, name, the rows of its transform if it has one, colour if it has one.
#[derive(FromPyObject)]
struct ObjectIn<'py>(
    PyRef<'py, Shape>,
    String,
    Option<[[f64; 4]; 4]>,
    Option<[f64; 3]>,
);

/// A light: its kind, a direction or position, and its colour.
#[derive(FromPyObject)]
struct LightIn(String, [f64; 3], [f64; 3]);

#[pymethods]
impl Scene {
    /// Builds a scene, sharing with `previous` what did not change.
    #[new]
    fn new(
        py: Python<'_>,
        objects: Vec<ObjectIn<'_>>,
        lights: Vec<LightIn>,
        previous: Option<&Self>,
    ) -> PyResult<Self> {
        let objects: Vec<Object> = objects
            .iter()
            .map(|object| build(py, object))
            .collect::<PyResult<_>>()?;
        let lights = lights.iter().map(light).collect();
        let scene = run(py, 0, |_| match previous {
            Some(Self(previous)) => previous.with_objects(objects),
            None => firsthit::Scene::new(objects),
        })?;
        Ok(Self(scene.with_lights(lights)))
    }

    /// The two corners of the box around all objects, or `None`.
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let bounds = self.0.bounds();
        (!bounds.is_empty()).then(|| [bounds.low.to_array(), bounds.high.to_array()])
    }
}

/// Refuses the rows of a transform that cannot be undone.
#[pyfunction]
pub(crate) fn check_transform(py: Python<'_>, rows: [[f64; 4]; 4]) -> PyResult<()> {
    transform(py, &rows).map(drop)
}

fn transform(py: Python<'_>, rows: &[[f64; 4]; 4]) -> PyResult<Transform> {
    let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
    let matrix = DMat3::from_cols(column(0), column(1), column(2));
    let transform = Transform::new(DAffine3::from_mat3_translation(matrix, column(3)));
    transform.map_err(|error| raise(py, &error))
}

fn build(py: Python<'_>, ObjectIn(shape, name, rows, color): &ObjectIn<'_>) -> PyResult<Object> {
    let mut object = Object::new(shape.0.clone()).named(name.clone());
    if let Some(rows) = rows {
        object = object.placed(transform(py, rows)?);
    }
    if let Some(color) = color {
        object = object.colored(Color::from(*color));
    }
    Ok(object)
}

fn light(LightIn(kind, vector, color): &LightIn) -> Light {
    let (vector, color) = (DVec3::from(*vector), Color::from(*color));
    if kind == "point" {
        Light::Point {
            position: vector,
            intensity: color,
        }
    } else {
        Light::Directional {
            direction: vector,
            color,
        }
    }
}

/// An object of a file: its mesh, name and colour, if the file gives one.
type ObjectOut = (String, Mesh, Option<[f64; 3]>);

/// Reads a 3D file: its objects, which way is up, and warnings.
#[pyfunction]
pub(crate) fn load(
    py: Python<'_>,
    path: PathBuf,
    strict: bool,
) -> PyResult<(Vec<ObjectOut>, [f64; 3], Vec<String>)> {
    let settings = LoadSettings {
        strict,
        ..LoadSettings::default()
    };
    let model = run(py, 0, |_| firsthit::io::load(&path, &settings))?;
    let object = |object: &Object| {
        let color = (!object.materials().is_empty()).then(|| object.color().to_array());
        let mesh = Mesh(Arc::clone(object.mesh()?));
        Some((object.name().to_owned(), mesh, color))
    };
    Ok((
        model.objects.iter().filter_map(object).collect(),
        model.up.to_array(),
        model.warnings,
    ))
}
