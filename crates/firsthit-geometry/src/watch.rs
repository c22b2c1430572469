//! The watch on a long computation: callers follow it, and end it.

use crate::error::{Error, Result};

/// Follows a long computation from another thread's point of view.
///
/// The library calls it from all its threads, every few hundred rays. `()` follows nothing.
pub trait Watch: Sync {
    /// A step begins, of which `total` units will be done: reading a file, building trees. The
    /// count starts at 0. Rays and points are shot without one: their caller knows how many there
    /// are.
    fn begin(&self, step: &str, total: u64, unit: &'static str) {
        let _ = (step, total, unit);
    }

    /// `count` more units are done: of the step that began last, or rays.
    fn advance(&self, count: u64) {
        let _ = count;
    }

    /// Whether to give up: the computation then ends soon with [`Error::Interrupted`]. Once true it
    /// must stay so: what a step gives up is of no use to the next one, which asks again.
    fn is_stopped(&self) -> bool {
        false
    }
}

impl Watch for () {}

/// Fails when the caller wants to stop.
///
/// # Errors
///
/// [`Error::Interrupted`].
#[doc(hidden)]
pub fn stop_if_asked(watch: &dyn Watch) -> Result<()> {
    if watch.is_stopped() {
        return Err(Error::Interrupted);
    }
    Ok(())
}

/// Tells another watch of the progress, and is not stopped by it: for a step that is of no use in
/// part.
#[doc(hidden)]
pub struct OnlyCounts<'a>(pub &'a dyn Watch);

impl Watch for OnlyCounts<'_> {
    fn begin(&self, step: &str, total: u64, unit: &'static str) {
        self.0.begin(step, total, unit);
    }

    fn advance(&self, count: u64) {
        self.0.advance(count);
    }
}

/// Stops what another watch stops, and tells it of no progress: for a step of something whose
/// progress is counted otherwise.
#[doc(hidden)]
pub struct OnlyStops<'a>(pub &'a dyn Watch);

impl Watch for OnlyStops<'_> {
    fn is_stopped(&self) -> bool {
        self.0.is_stopped()
    }
}
