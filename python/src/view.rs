//! The viewer of a scene: its page, served or in one file, and the questions that a page asks.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::Duration;

use firsthit_view::server::Server;
use firsthit_view::{Answer, AnswerError};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::camera::Camera;
use crate::edges::EdgesIn;
use crate::errors::{Outcome, Raised};
use crate::frame::DisplayIn;
use crate::run::run;
use crate::scene::Scene;
use crate::shading::ShadingIn;

/// The time between two questions whether the server has ended.
const POLL: Duration = Duration::from_millis(5);

/// The viewer of a page.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Viewer(Arc<firsthit_view::Viewer>);

#[pymethods]
impl Viewer {
    #[new]
    fn new(
        seen: (PyRef<'_, Scene>, PyRef<'_, Camera>),
        shading: ShadingIn,
        background: Option<Vec<[f64; 3]>>,
        up: [f64; 3],
        shown: (DisplayIn, Option<EdgesIn>),
        title: String,
    ) -> Outcome<Self> {
        let (scene, camera) = seen;
        let (display, edges) = shown;
        let seen = scene.0.clone().with_up(up.into());
        let appearance = shading.appearance(background.as_deref())?;
        let edges = edges.as_ref().map(EdgesIn::edges).transpose()?;
        let viewer = firsthit_view::Viewer::new(title, seen, appearance, &camera.0)?;
        Ok(Self(Arc::new(viewer.shown(display.transform()?, edges))))
    }

    /// The page in one file.
    fn report<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyBytes>> {
        let report = run(py, 0, |stop| self.0.report(stop))?;
        Ok(PyBytes::new(py, &report))
    }

    /// The page for a window that answers it.
    fn embedded_page(&self, py: Python<'_>) -> Outcome<String> {
        run(py, 0, |stop| self.0.embedded_page(stop))
    }

    /// A PNG of what the page begins with.
    fn still<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyBytes>> {
        let still = run(py, 0, |stop| self.0.still(stop))?;
        Ok(PyBytes::new(py, &still))
    }

    /// Answers a question of the page: JSON, and the pixels of a frame.
    fn answer<'py>(
        &self,
        py: Python<'py>,
        question: &str,
        about: &str,
    ) -> Outcome<(String, Bound<'py, PyBytes>)> {
        let answered = run(py, 0, |stop| Ok(self.0.answer(question, about.as_bytes(), stop)))?;
        let Answer { json, pixels } = answered.map_err(|error| match error {
            AnswerError::Failed(error) => Raised::from(error),
            other => Raised::value(other.to_string()),
        })?;
        Ok((json.to_string(), PyBytes::new(py, &pixels)))
    }
}

/// A server of the page, in a thread of its own. It ends when it is told to.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct PageServer {
    address: String,
    is_stopped: Arc<AtomicBool>,
    is_over: Arc<AtomicBool>,
}

#[pymethods]
impl PageServer {
    #[new]
    fn new(viewer: PyRef<'_, Viewer>, port: u16) -> Outcome<Self> {
        let server = Server::bind(Arc::clone(&viewer.0), port)
            .map_err(|error| PyOSError::new_err(format!("port {port}: {error}")))?
            .lingering(None);
        let address = server.address();
        let (is_stopped, is_over) = <(Arc<AtomicBool>, Arc<AtomicBool>)>::default();
        let (stop, over) = (Arc::clone(&is_stopped), Over(Arc::clone(&is_over)));
        let serve = move || {
            // The last declaration ends first: the port is free before anyone is told.
            let _over = over;
            let server = server;
            server.run(&|| stop.load(Ordering::Relaxed));
        };
        std::thread::Builder::new().name("viewer".into()).spawn(serve).map_err(PyErr::from)?;
        Ok(Self { address, is_stopped, is_over })
    }

    #[getter]
    fn address(&self) -> &str {
        &self.address
    }

    #[getter]
    fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    /// Ends it, and waits until the port is free.
    fn stop(&self, py: Python<'_>) {
        self.is_stopped.store(true, Ordering::Relaxed);
        py.detach(|| {
            while !self.is_over() {
                sleep(POLL);
            }
        });
    }
}

/// Tells that the server has ended, however it did.
struct Over(Arc<AtomicBool>);

impl Drop for Over {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Drop for PageServer {
    fn drop(&mut self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }
}
