//! How a caller follows a long computation, and ends it.

/// Follows a long computation from another thread's point of view.
///
/// The library calls it from all its threads, every few hundred rays. `()` follows nothing.
pub trait Watch: Sync {
    /// `rays` more rays are done.
    fn advance(&self, rays: u64) {
        let _ = rays;
    }

    /// Whether to give up: the computation then ends soon with
    /// [`Error::Interrupted`](crate::Error::Interrupted).
    fn is_stopped(&self) -> bool {
        false
    }
}

impl Watch for () {}

/// Stops what another watch stops, and tells it of no progress: for a step of something whose progress is counted otherwise.
pub(crate) struct OnlyStops<'a>(pub(crate) &'a dyn Watch);

impl Watch for OnlyStops<'_> {
    fn is_stopped(&self) -> bool {
        self.0.is_stopped()
    }
}
