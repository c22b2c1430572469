//! Sections.

use std::path::PathBuf;

use firsthit::DVec3;
use firsthit::section::{SectionPlane, section_with};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{collected, copied};
use crate::errors::Outcome;
use crate::run::{Report, Stop, guarded, run, run_reported};
use crate::scene::Scene;

/// The curves of a plane through a scene.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Section(firsthit::section::Section);

/// A polyline: its object, whether it is closed, its points in space and in the plane, its
/// primitives, its area if it is closed, its length.
type PolylineOut<'py> = (
    i32,
    bool,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<i32>>,
    Option<f64>,
    f64,
);

#[pymethods]
impl Section {
    /// Cuts a scene.
    #[new]
    fn new(
        py: Python<'_>,
        scene: &Scene,
        origin: [f64; 3],
        normal: [f64; 3],
        rule: &str,
        threads: usize,
        report: Report<'_, '_>,
    ) -> Outcome<Self> {
        let plane = SectionPlane::new(DVec3::from(origin), DVec3::from(normal))?;
        let rule = rule.parse()?;
        let cut = |stop: &Stop| section_with(rule, &scene.0, plane, stop);
        run_reported(py, threads, report, cut).map(Self)
    }

    /// The plane's origin, its normal and its two directions.
    fn frame(&self) -> [[f64; 3]; 4] {
        let plane = self.0.plane();
        [plane.origin(), plane.normal(), plane.u(), plane.v()].map(|v| v.to_array())
    }

    /// The area and the perimeter.
    fn totals(&self, py: Python<'_>) -> Outcome<(f64, f64)> {
        guarded(|| py.detach(|| (self.0.area(), self.0.perimeter())))
    }

    /// The polylines, all arrays copies.
    fn polylines<'py>(&self, py: Python<'py>) -> Outcome<Vec<PolylineOut<'py>>> {
        let plane = self.0.plane();
        let one = |polyline: firsthit::section::Polyline<'_>| {
            let points = polyline.points;
            let in_space = points.iter().flat_map(DVec3::to_array);
            let in_plane = points.iter().flat_map(|&p| plane.coordinates(p).to_array());
            let in_space = PyArray1::from_vec(py, collected(3 * points.len(), in_space)?);
            let in_plane = PyArray1::from_vec(py, collected(2 * points.len(), in_plane)?);
            Ok((
                polyline.object,
                polyline.is_closed,
                in_space.reshape([points.len(), 3])?,
                in_plane.reshape([points.len(), 2])?,
                PyArray1::from_vec(py, copied(polyline.primitives)?),
                polyline.area(plane),
                polyline.length(),
            ))
        };
        self.0.polylines().map(one).collect()
    }

    /// The identifiers of the objects that were left out.
    fn left_out(&self) -> Vec<i32> {
        self.0.left_out().to_vec()
    }

    /// The doubts about the section.
    fn warnings(&self) -> Vec<String> {
        self.0.warnings().to_vec()
    }

    /// Writes it to a file, whose extension tells the format.
    fn save(&self, py: Python<'_>, path: PathBuf) -> Outcome<()> {
        run(py, 1, |stop| self.0.save(path, stop))
    }
}
