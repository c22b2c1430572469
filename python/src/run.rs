//! Work without the interpreter's lock, with its own threads, that Ctrl-C ends.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
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

/// Stops the work and counts the rays done.
#[derive(Debug, Default)]
pub(crate) struct Stop {
    is_stopped: AtomicBool,
    done: AtomicU64,
}

impl Watch for Stop {
    fn advance(&self, rays: u64) {
        self.done.fetch_add(rays, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }
}

/// The caller's progress function, if there is one: it is called with the number of rays done.
pub(crate) type Report<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Calls `report` with the number of rays done.
pub(crate) fn report_done(report: Report<'_, '_>, done: usize) -> PyResult<()> {
    report.map_or(Ok(()), |report| report.call1((done,)).map(drop))
}

/// A pool of `threads` threads (0: all cores), or of as many as the system grants: the result is the same.
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

/// [`run_reported`] without a report.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce(&Stop) -> Result<T> + Send,
) -> PyResult<T> {
    run_reported(py, threads, None, work)
}

/// Does `work` with `threads` threads (0: all cores) while other Python threads run. Now and then, and at the end,
/// it calls `report` with the number of rays done. An exception from `report` ends the work.
///
/// The threads live as long as the call: a pool that outlived it would not survive `fork`. Making them
/// takes about a tenth of a millisecond. A panic is a bug of ours and becomes a `RuntimeError`.
pub(crate) fn run_reported<T: Send>(
    py: Python<'_>,
    threads: usize,
    report: Report<'_, '_>,
    work: impl FnOnce(&Stop) -> Result<T> + Send,
) -> PyResult<T> {
    let listener = report.map(|report| report.clone().unbind());
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
                // After the first the work is on its way out.
                if signal.is_some() {
                    continue;
                }
                let done = stop.done.load(Ordering::Relaxed);
                let asked = Python::attach(|py| {
                    // Signals are the main thread's business; elsewhere this does nothing.
                    py.check_signals()?;
                    let listener = listener.as_ref();
                    listener.map_or(Ok(()), |report| report.call1(py, (done,)).map(drop))
                });
                if let Err(error) = asked {
                    stop.is_stopped.store(true, Ordering::Relaxed);
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
        Ok(result) => {
            let result = result.map_err(|error: Error| raise(py, &error))?;
            report_done(
                report,
                usize::try_from(stop.done.into_inner()).unwrap_or(usize::MAX),
            )?;
            Ok(result)
        }
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
