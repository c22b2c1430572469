//! Work without the interpreter's lock, with its own threads, that Ctrl-C ends.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use firsthit::watch::Watch;
use firsthit::{Error, Result};
use firsthit_cli::threads;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::errors::{Outcome, raise};

/// The time between two questions to the interpreter whether Ctrl-C was pressed.
const POLL: Duration = Duration::from_millis(50);

/// Stops the work, and counts what is done of its rays, or of its present step.
#[derive(Debug, Default)]
pub(crate) struct Stop {
    is_stopped: AtomicBool,
    done: AtomicU64,
    /// The step that began last, its total and its unit.
    step: Mutex<Option<Step>>,
}

type Step = (String, u64, &'static str);

impl Stop {
    fn step(&self) -> MutexGuard<'_, Option<Step>> {
        self.step.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls `report` with the number of rays done; of work in steps also with the step, its total
    /// and its unit.
    fn report(&self, report: &Bound<'_, PyAny>) -> PyResult<()> {
        // Together: a step that begins sets the count anew.
        let (step, done) = {
            let present = self.step();
            (present.clone(), self.done.load(Ordering::Relaxed))
        };
        match step {
            Some((name, total, unit)) => report.call1((done.min(total), total, name, unit)),
            // Before the first step there is nothing to tell.
            None if done == 0 => return Ok(()),
            None => report.call1((done,)),
        }
        .map(drop)
    }
}

impl Watch for Stop {
    fn begin(&self, step: &str, total: u64, unit: &'static str) {
        let mut present = self.step();
        *present = Some((step.to_owned(), total, unit));
        self.done.store(0, Ordering::Relaxed);
    }

    fn advance(&self, count: u64) {
        self.done.fetch_add(count, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }
}

/// The caller's progress function, if there is one: it is called with the number of rays done, and
/// for work in steps with the step's total, name and unit beside.
pub(crate) type Report<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Calls `report` with the number of rays done.
pub(crate) fn report_done(report: Report<'_, '_>, done: usize) -> Outcome<()> {
    if let Some(report) = report {
        report.call1((done,))?;
    }
    Ok(())
}

/// The default number of threads.
#[pyfunction]
pub(crate) fn all_threads() -> usize {
    threads::cores()
}

/// A pool of `threads` threads (0: all cores), or of as many as the system grants: the result is
/// the same.
fn pool(threads: usize) -> Outcome<ThreadPool> {
    let pool = threads::pool(if threads == 0 { threads::cores() } else { threads });
    let refused = |why| format!("the system grants no thread to work in: {why}");
    Ok(pool.map_err(|why| PyMemoryError::new_err(refused(why)))?)
}

/// The place of the last panic.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

/// Silences panics of this module from now on: they become exceptions, which say the same.
pub(crate) fn silence_panics() {
    set_hook(Box::new(|panic| {
        let place = panic.location().map(ToString::to_string);
        // Never waited for: another thread may have been forked away from while it held the lock.
        if let (Some(place), Ok(mut last)) = (place, LAST_PANIC.try_lock()) {
            *last = place;
        }
    }));
}

/// Does `work`; a panic is a bug of ours and becomes a `RuntimeError`.
pub(crate) fn guarded<T>(work: impl FnOnce() -> T) -> Outcome<T> {
    Ok(catch_unwind(AssertUnwindSafe(work)).map_err(|panic| bug(&*panic))?)
}

fn bug(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    let place = LAST_PANIC.try_lock().map(|place| place.clone());
    PyRuntimeError::new_err(format!(
        "a bug in firsthit, please report it: {} ({})",
        text.unwrap_or_default(),
        place.unwrap_or_default()
    ))
}

/// Fewer rays than this are done at once: making threads would take longer.
pub(crate) const FEW: usize = 512;

/// Does `work` that is `little` by the calling thread alone, and any other as [`run_reported`]
/// does. `count` is what is reported as done.
pub(crate) fn run_sized<T: Send>(
    py: Python<'_>,
    (count, is_little): (usize, bool),
    threads: usize,
    report: Report<'_, '_>,
    work: impl FnOnce(&dyn Watch) -> Result<T> + Send,
) -> Outcome<T> {
    if is_little {
        let made = guarded(|| work(&()))??;
        report_done(report, count)?;
        return Ok(made);
    }
    run_reported(py, threads, report, |stop| work(stop))
}

/// [`run_reported`] without a report.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce(&Stop) -> Result<T> + Send,
) -> Outcome<T> {
    run_reported(py, threads, None, work)
}

/// Does `work` with `threads` threads (0: all cores) while other Python threads run. Now and then,
/// and at the end, it calls `report` with the number of rays done. An exception from `report` ends
/// the work.
///
/// The threads live as long as the call: a pool that outlived it would not survive `fork`. Making
/// them takes about a tenth of a millisecond. A panic is a bug of ours and becomes a
/// `RuntimeError`; where the system grants no thread at all, there is a `MemoryError`.
pub(crate) fn run_reported<T: Send>(
    py: Python<'_>,
    threads: usize,
    report: Report<'_, '_>,
    work: impl FnOnce(&Stop) -> Result<T> + Send,
) -> Outcome<T> {
    let listener = report.map(|report| report.clone().unbind());
    let pool = pool(threads)?;
    let stop = Stop::default();
    let (result, signal) = py.detach(|| {
        let (mut result, mut signal) = (None, None);
        let (done, waiting) = channel();
        // The calling thread waits in the closure: no thread but those of the pool is needed.
        pool.in_place_scope(|scope| {
            let (slot, stop) = (&mut result, &stop);
            scope.spawn(move |_| {
                *slot = Some(catch_unwind(AssertUnwindSafe(|| work(stop))));
                // No thread waits any more only if the scope is being left, where nothing is lost.
                let _ = done.send(());
            });
            while waiting.recv_timeout(POLL) == Err(RecvTimeoutError::Timeout) {
                // After the first the work is on its way out.
                if signal.is_some() {
                    continue;
                }
                let asked = Python::attach(|py| {
                    // Signals are the main thread's business; elsewhere this does nothing.
                    py.check_signals()?;
                    let listener = listener.as_ref();
                    listener.map_or(Ok(()), |report| stop.report(report.bind(py)))
                });
                if let Err(error) = asked {
                    stop.is_stopped.store(true, Ordering::Relaxed);
                    signal = Some(error);
                }
            }
        });
        (result, signal)
    });
    let result = result.expect("the scope ends after the work");
    if let Some(signal) = signal {
        // An error on the way out is told too.
        if let Ok(Err(error)) = &result
            && !matches!(error, Error::Interrupted)
        {
            signal.set_cause(py, Some(raise(py, error)));
        }
        return Err(signal.into());
    }
    let result = result.map_err(|panic| bug(&*panic))??;
    report.map_or(Ok(()), |report| stop.report(report))?;
    Ok(result)
}
