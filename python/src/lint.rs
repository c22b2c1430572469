//! Checks scenes for likely faults.

use std::path::PathBuf;

use firsthit::lint::{self, FindingKind, KINDS, LintSettings, lint, save_marked};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::collected;
use crate::errors::Outcome;
use crate::run::{Report, Stop, run, run_reported};
use crate::scene::Scene;

/// The findings about a scene.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Lint(lint::Report);

/// A place: its object, its primitive and its position.
type PlaceOut = (Option<i32>, Option<i32>, [f64; 3]);

/// A finding: its kind, how many there are, a note, places.
type FindingOut = (&'static str, u64, String, Vec<PlaceOut>);

#[pymethods]
impl Lint {
    /// Looks for all kinds but some.
    #[new]
    fn new(
        py: Python<'_>,
        scene: &Scene,
        ignore: Vec<String>,
        places: usize,
        threads: usize,
        report: Report<'_, '_>,
    ) -> Outcome<Self> {
        let ignore = ignore.iter().map(|name| FindingKind::named(name));
        let ignore = ignore.collect::<firsthit::Result<_>>()?;
        let settings = LintSettings { ignore, places };
        let check = |stop: &Stop| lint(&scene.0, &settings, stop);
        run_reported(py, threads, report, check).map(Self)
    }

    /// The findings.
    fn findings(&self) -> Vec<FindingOut> {
        let findings = self.0.findings().iter();
        let made = findings.map(|finding| {
            let places = finding.places.iter();
            let places =
                places.map(|place| (place.object, place.primitive, place.position.to_array()));
            (finding.kind.name, finding.count, finding.note.clone(), places.collect())
        });
        made.collect()
    }

    /// The names of the kinds that were looked for.
    fn checked(&self) -> Vec<&'static str> {
        self.0.checked().iter().map(|kind| kind.name).collect()
    }

    /// Whether each triangle of an object is part of a finding; `None` for an object without a
    /// mesh.
    fn marked<'py>(
        &self,
        py: Python<'py>,
        identifier: usize,
    ) -> Outcome<Option<Bound<'py, PyArray1<bool>>>> {
        let Some(marked) = self.0.marked(identifier) else {
            return Ok(None);
        };
        let marked = collected(marked.len(), marked.map(|kind| kind.is_some()))?;
        Ok(Some(PyArray1::from_vec(py, marked)))
    }

    /// Writes the meshes of the scene with their faces coloured.
    fn save(&self, py: Python<'_>, scene: &Scene, path: PathBuf) -> Outcome<()> {
        run(py, 1, |stop| save_marked(&scene.0, &self.0, path, stop))
    }
}

/// Every kind's name and meaning.
#[pyfunction]
pub(crate) fn lint_kinds() -> Vec<(&'static str, &'static str)> {
    KINDS.iter().map(|kind| (kind.name, kind.about)).collect()
}
