//! Pictures, and files of them.

use std::borrow::Cow;
use std::path::PathBuf;

use firsthit::channel::{self, ChannelKind, RAY};
use firsthit::image::{self, ArrayValues, Data, Frame, Metadata, Origin, WriteSettings};
use firsthit::render::{Picture, Region, work};
use firsthit::sensor::Sensor;
use firsthit::shade::{BACKGROUND, SAMPLES};
use firsthit::shoot::Cpu;
use firsthit::{Background, Color, DisplayTransform};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::copied;
use crate::edges::EdgesIn;
use crate::errors::{Outcome, Raised};
use crate::load::background_out;
use crate::run::{Stop, run, run_reported};
use crate::scene::Scene;
use crate::sensor::SensorIn;
use crate::shading::ShadingIn;

/// The display of colours in PNGs: the exposure in stops, and the tone map's name.
#[derive(FromPyObject)]
pub(crate) struct DisplayIn(f64, String);

impl DisplayIn {
    pub(crate) fn transform(&self) -> firsthit::Result<DisplayTransform> {
        let Self(exposure, tone_map) = self;
        Ok(DisplayTransform { exposure: *exposure, tone_map: tone_map.parse()? })
    }
}

/// The kinds of some channels.
fn kinds(channels: &[String]) -> firsthit::Result<Vec<Cow<'static, ChannelKind>>> {
    channels.iter().map(|name| channel::asked(name)).collect()
}

fn references<'a>(kinds: &'a [Cow<'static, ChannelKind>]) -> Vec<&'a ChannelKind> {
    kinds.iter().map(|kind| &**kind).collect()
}

/// The number of rays that [`render`] reports.
#[pyfunction]
pub(crate) fn render_work(pixels: usize, channels: Vec<String>, samples: u32) -> Outcome<u64> {
    let kinds = kinds(&channels)?;
    Ok(work(pixels, &references(&kinds), samples))
}

/// The default samples of a pixel, and the default background (a colour, or horizon, zenith and
/// up).
#[pyfunction]
pub(crate) fn defaults() -> (u32, Vec<[f64; 3]>) {
    (SAMPLES, background_out(BACKGROUND))
}

/// The settings of a picture: the shading; the background (see [`background_in`]); the direction
/// upwards; the samples of a pixel; the first row, the one behind the last, and likewise columns;
/// the side that rays pass through; the lines along edges; and the noise at which pixels have had
/// enough samples.
#[derive(FromPyObject)]
pub(crate) struct PictureIn(
    ShadingIn,
    Option<Vec<[f64; 3]>>,
    [f64; 3],
    u32,
    [usize; 4],
    Option<String>,
    Option<EdgesIn>,
    Option<f64>,
);

/// The number of threads, and the callable that is told of the rays that are done.
type HowIn<'py> = (usize, Option<Bound<'py, PyAny>>);

impl PictureIn {
    /// Does `work` with the picture, which ends when it is stopped.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        (scene, sensor): (&firsthit::Scene, &SensorIn<'_>),
        channels: &[String],
        (threads, report): &HowIn<'_>,
        work: impl FnOnce(&Picture<'_>, &Stop) -> firsthit::Result<T> + Send,
    ) -> Outcome<T> {
        let Self(shading, background, up, samples, region, cull, edges, noise) = self;
        let kinds = kinds(channels)?;
        let kinds = references(&kinds);
        let sensor = sensor.sensor();
        // Kept by the scene, of which the next picture may be.
        let resolved = run(py, *threads, |_| {
            scene.fingerprint();
            shading.resolve(scene, sensor.camera(), background.as_deref(), *up)
        })?;
        let shade = resolved.shading(Cpu::shared());
        let &[top, bottom, left, right] = region;
        let is_whole = [top, left] == [0, 0] && [bottom, right] == sensor.shape();
        let edges = edges.as_ref().map(EdgesIn::edges).transpose()?;
        let picture = Picture {
            samples: *samples,
            noise: *noise,
            cull: cull.as_deref().map(str::parse).transpose()?,
            edges,
            // A picture with a noise is a whole one, and has no region.
            region: (noise.is_none() || !is_whole)
                .then_some(Region { rows: top..bottom, columns: left..right }),
            ..Picture::new(&resolved.scene, sensor, &shade, &kinds)
        };
        run_reported(py, *threads, report.as_ref(), |stop| work(&picture, stop))
    }
}

/// Renders channels: a flat array for each, in their order, and the JSON of where they come from.
/// The state is kept in the file `resume`, if there is to be one, and is continued from there.
#[pyfunction]
pub(crate) fn render<'py>(
    py: Python<'py>,
    scene: &Scene,
    camera: SensorIn<'py>,
    channels: Vec<String>,
    picture: PictureIn,
    resume: Option<PathBuf>,
    how: HowIn<'py>,
) -> Outcome<(Vec<Bound<'py, PyAny>>, String)> {
    let seen = (&scene.0, &camera);
    let frame = picture.with(py, seen, &channels, &how, |picture, stop| match &resume {
        Some(path) => picture.render_resumed(path, stop),
        None => picture.render(stop),
    })?;
    let origin = serde_json::to_string(frame.origin())?;
    Ok((arrays(py, frame), origin))
}

/// The state of the pixels of a progressive picture.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Accumulated(Frame);

/// Goes on with a picture until it has all its samples, from what is known of it, if anything: a
/// flat array for each channel, in their order, and what is known then. The channels are those that
/// are `accumulated`, see [`sampling`].
#[pyfunction]
pub(crate) fn render_more<'py>(
    py: Python<'py>,
    scene: &Scene,
    camera: SensorIn<'py>,
    channels: Vec<String>,
    picture: PictureIn,
    known: Option<PyRef<'py, Accumulated>>,
    how: HowIn<'py>,
) -> Outcome<(Vec<Bound<'py, PyAny>>, Accumulated)> {
    let (seen, known) = ((&scene.0, &camera), known.as_deref());
    let (frame, known) = picture.with(py, seen, &channels, &how, |picture, stop| {
        let mut going_on = match known {
            Some(Accumulated(state)) => picture.resume(state)?,
            None => picture.start()?,
        };
        while going_on.samples() < picture.samples && going_on.add_sample(stop)? {}
        Ok((going_on.frame()?, going_on.state()?))
    })?;
    Ok((arrays(py, frame), Accumulated(known)))
}

/// The samples of a pixel that each channel is made of: `accumulated`, of all, to which a
/// progressive picture adds; `all`, of all at once; or `centre`, of the pixel's centre alone.
#[pyfunction]
pub(crate) fn sampling(channels: Vec<String>) -> Outcome<Vec<&'static str>> {
    let kinds = kinds(&channels)?;
    let made_of =
        |kind: &Cow<'static, ChannelKind>| match (kind.needs_shade(), kind.needs_samples()) {
            (true, _) => "accumulated",
            (false, true) => "all",
            (false, false) => "centre",
        };
    Ok(kinds.iter().map(made_of).collect())
}

/// Pairs each of some settings that do nothing for a picture's channels with the channels that it
/// needs, in words.
#[pyfunction]
pub(crate) fn idle(
    settings: Vec<String>,
    channels: Vec<String>,
) -> Outcome<Vec<(String, &'static str)>> {
    let kinds = kinds(&channels)?;
    let idle =
        |setting: String| firsthit::render::idle(&setting, &kinds).map(|needed| (setting, needed));
    Ok(settings.into_iter().filter_map(idle).collect())
}

/// Pairs each of some settings that do nothing for files, each a format and a channel, with the
/// files that it needs, in words.
#[pyfunction]
pub(crate) fn idle_in_files(
    settings: Vec<String>,
    files: Vec<(String, String)>,
) -> Outcome<Vec<(String, &'static str)>> {
    let (formats, channels): (Vec<_>, Vec<_>) = files.into_iter().unzip();
    let kinds = kinds(&channels)?;
    let idle = |setting: String| {
        let files = formats.iter().map(String::as_str).zip(&kinds);
        firsthit::render::idle_in_files(&setting, files.map(|(format, kind)| (format, &**kind)))
            .map(|needed| (setting, needed))
    };
    Ok(settings.into_iter().filter_map(idle).collect())
}

/// The channels of a frame as flat arrays, not copied.
fn arrays(py: Python<'_>, frame: Frame) -> Vec<Bound<'_, PyAny>> {
    let channels = frame.into_channels().into_iter();
    channels.map(|channel| array(py, channel.data)).collect()
}

/// A background: nothing if transparent; a colour; or horizon, zenith and up.
pub(crate) fn background_in(vectors: &[[f64; 3]]) -> Background {
    match *vectors {
        [horizon, zenith, up] => Background::Gradient {
            horizon: Color::from(horizon),
            zenith: Color::from(zenith),
            up: up.into(),
        },
        [] => Background::Transparent,
        [color, ..] => Background::Uniform(color.into()),
    }
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

/// The metadata of a frame of that shape, of whose channels one pixel is given, as JSON.
#[pyfunction]
pub(crate) fn metadata(
    shape: Vec<u64>,
    channels: Vec<(String, Bound<'_, PyAny>)>,
    origin: &str,
) -> Outcome<String> {
    let mut metadata = frame(vec![1, 1], channels, origin)?.metadata();
    metadata.shape = shape;
    Ok(metadata.to_json())
}

/// The identifier of a name in a Cryptomatte.
#[pyfunction]
pub(crate) fn matte_id(name: &str) -> u32 {
    image::matte_id(name)
}

/// Refuses a number of samples that colours of a sensor cannot have.
#[pyfunction]
pub(crate) fn check_samples(camera: SensorIn<'_>, samples: u32) -> Outcome<()> {
    Ok(firsthit::render::check_samples(camera.sensor(), samples)?)
}

/// The JSON of the origin of what rays met, of a camera's or of others.
#[pyfunction]
pub(crate) fn origin(
    py: Python<'_>,
    scene: &Scene,
    camera: Option<SensorIn<'_>>,
    channels: Vec<String>,
) -> Outcome<String> {
    let kinds = kinds(&channels)?;
    let kinds = references(&kinds);
    let sensor = camera.as_ref().map(|camera| camera.sensor() as &dyn Sensor);
    // The fingerprint takes long the first time.
    let origin = run(py, 0, |_| Ok(firsthit::render::origin(&scene.0, sensor, None, &kinds)))?;
    Ok(serde_json::to_string(&origin)?)
}

/// A frame from flat arrays; `origin` is the JSON of an origin, or of metadata.
fn frame(
    shape: Vec<usize>,
    arrays: Vec<(String, Bound<'_, PyAny>)>,
    origin: &str,
) -> Outcome<Frame> {
    let origin: Origin =
        serde_json::from_str(origin).map_err(|error| Raised::value(format!("origin: {error}")))?;
    let mut frame = Frame::new(shape).from_origin(origin);
    for (name, array) in arrays {
        let data = data(&array)?;
        let kind = if name == RAY.name {
            Cow::Borrowed(RAY)
        } else {
            let own = || ChannelKind::own(&name, &data).ok().map(Cow::Owned);
            channel::asked(&name).or_else(|error| own().ok_or(error))?
        };
        // Colours with a fourth number say so by how many there are.
        let elements: usize = frame.shape().iter().product();
        let is_transparent = kind.needs_shade() && elements > 0 && data.len() == 4 * elements;
        let mut channel =
            if is_transparent { kind.transparent_channel(data) } else { kind.channel(data) };
        if kind.components == 0 || kind.matte().is_some() {
            let components = channel.data.len().checked_div(elements);
            channel.components = components.unwrap_or(1).max(1);
        }
        frame.push(channel)?;
    }
    Ok(frame)
}

pub(crate) fn data(array: &Bound<'_, PyAny>) -> Outcome<Data> {
    Ok(if let Ok(values) = array.extract::<PyReadonlyArray1<'_, f64>>() {
        Data::Float64(copied(values.as_slice()?)?)
    } else if let Ok(values) = array.extract::<PyReadonlyArray1<'_, f32>>() {
        Data::Float32(copied(values.as_slice()?)?)
    } else if let Ok(values) = array.extract::<PyReadonlyArray1<'_, i32>>() {
        Data::Int32(copied(values.as_slice()?)?)
    } else if let Ok(values) = array.extract::<PyReadonlyArray1<'_, bool>>() {
        Data::Bool(copied(values.as_slice()?)?)
    } else {
        let what = "expected a flat array of float64, float32, int32 or bool";
        return Err(PyTypeError::new_err(what).into());
    })
}

/// The storage of numbers: the step of distances in PNGs, what becomes of those beyond, whether
/// PNGs of identifiers hold labels, whether an NPZ is packed.
#[derive(FromPyObject)]
pub(crate) struct StoredIn(Option<f64>, Option<String>, bool, bool);

/// Writes channels to a file, in the format of its extension, whole or not at all; returns what is
/// doubtful.
#[pyfunction]
pub(crate) fn write(
    py: Python<'_>,
    path: PathBuf,
    shape: Vec<usize>,
    channels: Vec<(String, Bound<'_, PyAny>)>,
    origin: &str,
    stored: StoredIn,
    display: Option<DisplayIn>,
) -> Outcome<Option<String>> {
    let frame = frame(shape, channels, origin)?;
    let display = display.as_ref().map(DisplayIn::transform).transpose()?;
    let StoredIn(png_scale, far, png_labels, compress) = stored;
    let settings = WriteSettings {
        png_scale,
        png_far: far.map(|name| name.parse()).transpose()?,
        png_labels,
        compress,
        display: display.unwrap_or_default(),
    };
    let format = image::format_of(&path)?;
    run(py, 0, |stop| format.write(&frame, None, settings, &path, stop))?;
    Ok(format.warning(&frame, None))
}

/// Writes bytes to a file, whole or not at all.
#[pyfunction]
pub(crate) fn write_bytes(py: Python<'_>, path: PathBuf, content: &[u8]) -> Outcome<()> {
    run(py, 1, |stop| image::write_whole(&path, stop, |out| out.write_all(content)))
}

/// Begins a run, which has read nothing and written nothing yet.
#[pyfunction]
pub(crate) fn begin_run() {
    firsthit::inputs::begin_run();
}

/// Notes that a file is read: from now on nothing is written over it.
#[pyfunction]
pub(crate) fn note_input(path: PathBuf) {
    firsthit::inputs::note(&path);
}

/// Whether a path leads to a file that was read.
#[pyfunction]
pub(crate) fn is_input(path: PathBuf) -> bool {
    firsthit::inputs::is_input(&path)
}

/// A channel of a file: its name, its shape, its numbers, and their type in the file.
type ArrayOut<'py> = (Option<String>, Vec<usize>, Bound<'py, PyAny>, String);

/// Reads an output: its channels, its metadata as JSON, and what is doubtful.
#[pyfunction]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
) -> Outcome<(Vec<ArrayOut<'_>>, Option<String>, Vec<String>)> {
    let output = run(py, 0, |_| image::read(&path))?;
    let metadata = output.metadata.as_ref().map(Metadata::to_json);
    Ok((arrays_out(py, output.arrays), metadata, output.notes))
}

fn arrays_out(py: Python<'_>, arrays: Vec<image::Array>) -> Vec<ArrayOut<'_>> {
    let array = |array: image::Array| {
        let numbers = match array.numbers {
            ArrayValues::Float64(values) => PyArray1::from_vec(py, values).into_any(),
            ArrayValues::Float32(values) => PyArray1::from_vec(py, values).into_any(),
            ArrayValues::Integer(values) => PyArray1::from_vec(py, values).into_any(),
        };
        (array.name, array.shape, numbers, array.dtype)
    };
    arrays.into_iter().map(array).collect()
}

/// Three numbers of each point in a row, the other columns, and what is doubtful.
type PointsOut<'py> = (Bound<'py, PyArray1<f64>>, Vec<ArrayOut<'py>>, Vec<String>);

/// Reads points.
#[pyfunction]
pub(crate) fn read_points(py: Python<'_>, path: PathBuf) -> Outcome<PointsOut<'_>> {
    let points = run(py, 0, |_| image::read_points(&path))?;
    let positions = PyArray1::from_vec(py, points.positions.into_flattened());
    Ok((positions, arrays_out(py, points.columns), points.notes))
}

/// One channel as the bytes of a PNG.
#[pyfunction]
pub(crate) fn png<'py>(
    py: Python<'py>,
    shape: Vec<usize>,
    name: String,
    values: Bound<'py, PyAny>,
    display: DisplayIn,
) -> Outcome<Bound<'py, PyBytes>> {
    let frame = frame(shape, vec![(name, values)], "{}")?;
    let settings = WriteSettings { display: display.transform()?, ..WriteSettings::default() };
    let memory = "memory".as_ref();
    let mut bytes = Vec::new();
    image::format_named("png")?.encode(&frame, None, settings, &mut bytes, memory)?;
    Ok(PyBytes::new(py, &bytes))
}
