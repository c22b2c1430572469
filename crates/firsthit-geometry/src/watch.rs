//! The watch on a long computation: callers follow it, and end it.

/// Follows a long computation from another thread's point of view.
///
/// The library calls it from all its threads, every few hundred rays. `()` follows nothing.
pub trait Watch: Sync {
    /// `rays` more rays are done.
    fn advance(&self, rays: u64) {
        let _ = rays;
    }

    /// Whether to give up: the computation then ends soon with
    /// [`Error::Interrupted`](crate::error::Error::Interrupted).
    fn is_stopped(&self) -> bool {
        false
    }
}

impl Watch for () {}

/// Tells another watch of the progress, and is not stopped by it: for a step that is of no use in part.
#[doc(hidden)]
pub struct OnlyCounts<'a>(pub &'a dyn Watch);

impl Watch for OnlyCounts<'_> {
    fn advance(&self, rays: u64) {
        self.0.advance(rays);
    }
}

/// Stops what another watch stops, and tells it of no progress: for a step of something whose progress is counted otherwise.
#[doc(hidden)]
pub struct OnlyStops<'a>(pub &'a dyn Watch);

impl Watch for OnlyStops<'_> {
    fn is_stopped(&self) -> bool {
        self.0.is_stopped()
    }
}
