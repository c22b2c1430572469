//! Pictures, and files of them.

use std::path::PathBuf;

use firsthit::channel::{self, Kind};
use firsthit::image::{self, Channel, Data, Frame};
use firsthit::render::shoulder_light;
use firsthit::shade::Lambert;
use firsthit::{Background, Color, Shader, Shading};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::not_contiguous;
use crate::camera::Camera;
use crate::errors::raise;
use crate::run::run;
use crate::scene::Scene;

/// How to shade: the shader's name, the background (a colour, or horizon, zenith and up), the ambient light if not the usual, shadows.
#[derive(FromPyObject)]
pub(crate) struct ShadingIn(String, Vec<[f64; 3]>, Option<[f64; 3]>, bool);

/// Renders channels: a flat array for each, in their order.
#[pyfunction]
pub(crate) fn render<'py>(
    py: Python<'py>,
    scene: &Scene,
    camera: &Camera,
    channels: Vec<String>,
    shading: ShadingIn,
    samples: u32,
    threads: usize,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let kinds = channels.iter().map(|name| channel::kind(name));
    let kinds: Vec<&Kind> = kinds
        .collect::<firsthit::Result<_>>()
        .map_err(|error| raise(py, &error))?;
    let ShadingIn(name, background, ambient, shadows) = shading;
    let mut shader = Shader::named(&name).map_err(|error| raise(py, &error))?;
    if let Shader::Lambert(lambert) = &mut shader {
        let ambient = ambient.map_or(lambert.ambient, Color::from);
        *lambert = Lambert { ambient, shadows };
    }
    let scene = if scene.0.lights().is_empty() {
        scene.0.clone().with_lights(vec![shoulder_light(&camera.0)])
    } else {
        scene.0.clone()
    };
    let background = match background.as_slice() {
        &[horizon, zenith, up] => Background::Gradient {
            horizon: Color::from(horizon),
            zenith: Color::from(zenith),
            up: up.into(),
        },
        colors => Background::Uniform(colors.first().copied().unwrap_or_default().into()),
    };
    let shade = Shading {
        scene: &scene,
        shader,
        background,
    };
    let frame = run(py, threads, |stop| {
        firsthit::render(&scene, &camera.0, &shade, &kinds, samples, stop)
    })?;
    Ok(frame
        .into_channels()
        .into_iter()
        .map(|channel| array(py, channel.data))
        .collect())
}

/// The data of a channel as a flat array, not copied.
pub(crate) fn array(py: Python<'_>, data: Data) -> Bound<'_, PyAny> {
    match data {
        Data::Float64(values) => PyArray1::from_vec(py, values).into_any(),
        Data::Float32(values) => PyArray1::from_vec(py, values).into_any(),
        Data::Int32(values) => PyArray1::from_vec(py, values).into_any(),
        Data::Bool(values) => PyArray1::from_vec(py, values).into_any(),
    }
}

/// A frame from flat arrays.
fn frame(
    py: Python<'_>,
    shape: Vec<usize>,
    arrays: Vec<(String, Bound<'_, PyAny>)>,
) -> PyResult<Frame> {
    let mut frame = Frame::new(shape);
    for (name, array) in arrays {
        let kind = channel::kind(&name).map_err(|error| raise(py, &error))?;
        let channel = Channel {
            name: kind.name,
            components: kind.components,
            data: data(&array)?,
            picture: kind.picture,
        };
        frame.push(channel).map_err(|error| raise(py, &error))?;
    }
    Ok(frame)
}

fn data(array: &Bound<'_, PyAny>) -> PyResult<Data> {
    if let Ok(values) = array.extract::<PyReadonlyArray1<'_, f64>>() {
        return Ok(Data::Float64(
            values.as_slice().map_err(not_contiguous)?.to_vec(),
        ));
    }
    if let Ok(values) = array.extract::<PyReadonlyArray1<'_, f32>>() {
        return Ok(Data::Float32(
            values.as_slice().map_err(not_contiguous)?.to_vec(),
        ));
    }
    if let Ok(values) = array.extract::<PyReadonlyArray1<'_, i32>>() {
        return Ok(Data::Int32(
            values.as_slice().map_err(not_contiguous)?.to_vec(),
        ));
    }
    if let Ok(values) = array.extract::<PyReadonlyArray1<'_, bool>>() {
        return Ok(Data::Bool(
            values.as_slice().map_err(not_contiguous)?.to_vec(),
        ));
    }
    Err(PyTypeError::new_err(
        "expected a flat array of float64, float32, int32 or bool",
    ))
}

/// Writes channels to a file, in the format of its extension, whole or not at all.
#[pyfunction]
pub(crate) fn write(
    py: Python<'_>,
    path: PathBuf,
    shape: Vec<usize>,
    channels: Vec<(String, Bound<'_, PyAny>)>,
) -> PyResult<()> {
    let frame = frame(py, shape, channels)?;
    py.detach(|| image::write(&frame, &path))
        .map_err(|error| raise(py, &error))
}

/// One channel as the bytes of a PNG.
#[pyfunction]
pub(crate) fn png<'py>(
    py: Python<'py>,
    shape: Vec<usize>,
    name: String,
    values: Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyBytes>> {
    let frame = frame(py, shape, vec![(name, values)])?;
    let mut bytes = Vec::new();
    let encoded = image::format_named("png")
        .and_then(|format| format.encode(&frame, None, &mut bytes, "memory".as_ref()));
    encoded.map_err(|error| raise(py, &error))?;
    Ok(PyBytes::new(py, &bytes))
}
