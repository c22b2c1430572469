//! Work without the interpreter's lock, with its own threads, that Ctrl-C ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use firsthit::watch::Watch;
use firsthit::{Error, Result};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::errors::raise;

/// How often the interpreter is asked whether Ctrl-C was pressed.
const POLL: Duration = Duration::from_millis(50);

/// Tells the work to stop.
#[derive(Debug, Default)]
pub(crate) struct Stop(AtomicBool);

impl Watch for Stop {
    fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// So many threads (0: all cores), or as many as the system grants: the result is the same.
fn pool(threads: usize) -> std::result::Result<ThreadPool, ThreadPoolBuildError> {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let mut threads = if threads == 0 { cores() } else { threads };
    loop {
        match ThreadPoolBuilder::new().num_threads(threads).build() {
            Err(_) if threads > 1 => threads /= 2,
            result => return result,
        }
    }
}

/// Does `work` with `threads` threads (0: all cores) while other Python threads run.
///
/// The threads live as long as the call: a pool that outlived it would not survive `fork`. Making them
/// takes about a tenth of a millisecond. A panic is a bug of ours and becomes a `RuntimeError`.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce(&Stop) -> Result<T> + Send,
) -> PyResult<T> {
    let pool =
        pool(threads).map_err(|error| PyMemoryError::new_err(format!("threads: {error}")))?;
    let stop = Stop::default();
    let (result, signal) = py.detach(|| {
        std::thread::scope(|scope| {
            let (done, waiting) = channel();
            let (pool, stop) = (&pool, &stop);
            let worker = scope.spawn(move || {
                let result = pool.install(|| work(stop));
                // Nobody waits any more only if the scope is being left, where nothing is lost.
                let _ = done.send(());
                result
            });
            let mut signal = None;
            while waiting.recv_timeout(POLL) == Err(RecvTimeoutError::Timeout) {
                // Signals are the main thread's business; elsewhere this does nothing.
                #[expect(
                    clippy::redundant_closure_for_method_calls,
                    reason = "lifetimes need it"
                )]
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    stop.0.store(true, Ordering::Relaxed);
                    signal = Some(error);
                }
            }
            (worker.join(), signal)
        })
    });
    if let Some(signal) = signal {
        return Err(signal);
    }
    match result {
        Ok(result) => result.map_err(|error: Error| raise(py, &error)),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|&text| text.to_owned()));
            let text = text.unwrap_or_default();
            Err(PyRuntimeError::new_err(format!(
                "a bug in firsthit, please report it: {text}"
            )))
        }
    }
}
