//! Scans of laser scanners, as columns.

use std::path::PathBuf;

use firsthit::image::{Data, Origin};
use firsthit::scan::{self, Scan};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::{Outcome, Raised};
use crate::frame::{array, data};
use crate::run::{run, run_reported};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// The checked settings of a scan.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct ScanSettings(scan::ScanSettings);

#[pymethods]
impl ScanSettings {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "sent by the Python half alone")]
    fn new(
        returns: &str,
        divergence: Option<f64>,
        subrays: usize,
        range_gate: f64,
        max_returns: Option<usize>,
        limits: [f64; 2],
        intensity: bool,
        noise: Option<[f64; 2]>,
        dropout: Option<f64>,
        seed: Option<u64>,
        rings: &str,
    ) -> Outcome<Self> {
        let settings = scan::ScanSettings {
            returns: returns.parse()?,
            divergence,
            subrays,
            range_gate,
            max_returns,
            min_range: limits[0],
            max_range: limits[1],
            intensity,
            noise,
            dropout,
            seed,
            rings: rings.parse()?,
        };
        settings.check()?;
        Ok(Self(settings))
    }

    /// The settings as JSON.
    fn record(&self) -> String {
        self.0.record().to_string()
    }

    /// The number of lines of a beam.
    fn lines(&self) -> usize {
        self.0.lines()
    }

    /// The warning of settings that are probably not meant.
    fn warning(&self) -> Option<String> {
        self.0.warning()
    }
}

/// Columns by their names.
type ColumnsOut<'py> = Vec<(String, Bound<'py, PyAny>)>;

/// Columns, rows and columns of beams, and the JSON of an origin.
type ScanOut<'py> = (ColumnsOut<'py>, [usize; 2], String);

/// A scan from its flat columns; `origin` is the JSON of an origin.
#[derive(FromPyObject)]
pub(crate) struct ScanIn<'py>(Vec<(String, Bound<'py, PyAny>)>, [usize; 2], String);

impl ScanIn<'_> {
    fn scan(&self) -> Outcome<Scan> {
        let Self(columns, shape, origin) = self;
        let columns = columns.iter().map(|(name, array)| Ok((name.clone(), data(array)?)));
        let columns = columns.collect::<Outcome<_>>()?;
        Ok(Scan::of(columns, *shape, origin_of(origin)?)?)
    }
}

fn origin_of(text: &str) -> Outcome<Origin> {
    let origin = serde_json::from_str(text);
    origin.map_err(|error| Raised::value(format!("origin: {error}")))
}

fn columns_out(
    py: Python<'_>,
    columns: impl IntoIterator<Item = (String, Data)>,
) -> ColumnsOut<'_> {
    let columns = columns.into_iter();
    columns.map(|(name, data)| (name, array(py, data))).collect()
}

fn scan_out(py: Python<'_>, scan: Scan) -> Outcome<ScanOut<'_>> {
    let shape = scan.shape();
    let origin = serde_json::to_string(scan.frame().origin());
    let origin = origin.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let channels = scan.into_frame().into_channels().into_iter();
    let columns = channels.map(|channel| (channel.name.into_owned(), channel.data));
    Ok((columns_out(py, columns), shape, origin))
}

/// The columns of a scan, flat.
#[pyfunction]
pub(crate) fn scan_columns<'py>(
    py: Python<'py>,
    scene: &Scene,
    sensor: &Sensor,
    settings: &ScanSettings,
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<ColumnsOut<'py>> {
    let lidar = sensor.lidar_of()?;
    let columns = run_reported(py, threads, report.as_ref(), |stop| {
        scan::columns(lidar, &scene.0, &settings.0, stop)
    })?;
    Ok(columns_out(py, columns))
}

/// The metadata of a scan with columns of these names, as JSON.
#[pyfunction]
pub(crate) fn scan_metadata(names: Vec<String>, count: u64, origin: &str) -> Outcome<String> {
    Ok(scan::metadata(&names, count, origin_of(origin)?)?.to_json())
}

/// Several scans as one.
#[pyfunction]
pub(crate) fn join_scans<'py>(py: Python<'py>, scans: Vec<ScanIn<'py>>) -> Outcome<ScanOut<'py>> {
    let scans = scans.iter().map(ScanIn::scan).collect::<Outcome<Vec<Scan>>>()?;
    scan_out(py, run(py, 1, |_| Scan::joined(scans))?)
}

/// Writes a scan in the format of the path's extension, whole or not at all.
#[pyfunction]
pub(crate) fn write_scan(py: Python<'_>, path: PathBuf, scan: ScanIn<'_>) -> Outcome<()> {
    let scan = scan.scan()?;
    run(py, 1, |stop| scan.write(&path, stop))
}

/// Reads a scan from an NPZ.
#[pyfunction]
pub(crate) fn read_scan(py: Python<'_>, path: PathBuf) -> Outcome<ScanOut<'_>> {
    scan_out(py, run(py, 1, |_| Scan::read(&path))?)
}

/// The extensions of the files that a scan is written to, without the dot.
#[pyfunction]
pub(crate) fn scan_extensions() -> &'static [&'static str] {
    firsthit::image::SCAN_EXTENSIONS
}
