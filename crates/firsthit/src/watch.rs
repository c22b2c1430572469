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
