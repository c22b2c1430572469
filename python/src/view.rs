//! The viewer's page of a scene.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::Duration;

use firsthit_view::Viewer;
use firsthit_view::server::Server;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::camera::Camera;
use crate::errors::raise;
use crate::scene::Scene;
use crate::shading::ShadingIn;

/// How often it is asked whether the server has ended.
const POLL: Duration = Duration::from_millis(5);

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
    fn new(
        py: Python<'_>,
        seen: (PyRef<'_, Scene>, PyRef<'_, Camera>),
        shading: ShadingIn,
        background: Option<Vec<[f64; 3]>>,
        up: [f64; 3],
        title: String,
        port: u16,
    ) -> PyResult<Self> {
        let (scene, camera) = seen;
        let appearance = shading.appearance(background.as_deref());
        let seen = scene.0.clone().with_up(up.into());
        let viewer = appearance
            .and_then(|appearance| Viewer::new(title, seen, appearance, &camera.0))
            .map_err(|error| raise(py, &error))?;
        let server = Server::bind(viewer, port)
            .map_err(|error| PyOSError::new_err(format!("port {port}: {error}")))?
            .lingering(None);
        let address = server.address();
        let (is_stopped, is_over) = <(Arc<AtomicBool>, Arc<AtomicBool>)>::default();
        let (stop, over) = (Arc::clone(&is_stopped), Over(Arc::clone(&is_over)));
        let serve = move || {
            // What is declared last ends first: the port is free before anyone is told.
            let _over = over;
            let server = server;
            server.run(&|| stop.load(Ordering::Relaxed));
        };
        std::thread::Builder::new()
            .name("viewer".into())
            .spawn(serve)?;
        Ok(Self {
            address,
            is_stopped,
            is_over,
        })
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
