//! Values that are computed only once they have been asked for often enough to pay.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::parallel;

/// A value that is computed once it was asked for a number of times. Until then callers take the
/// long way to an equal answer.
pub(super) struct WhenAsked<T> {
    /// `None` where there was no memory.
    value: OnceLock<Option<T>>,
    asked: AtomicUsize,
}

impl<T> WhenAsked<T> {
    /// The value, if it is known.
    #[inline(always)]
    pub(super) fn known(&self) -> Option<&T> {
        self.value.get()?.as_ref()
    }

    /// The value, which is found out after `price` questions.
    pub(super) fn ask(&self, price: usize, find: impl FnOnce() -> Option<T>) -> Option<&T> {
        if let Some(value) = self.value.get() {
            return value.as_ref();
        }
        // One thread alone finds out.
        let is_due = self.asked.fetch_add(1, Ordering::Relaxed) == price;
        is_due.then(|| parallel::once(&self.value, find).as_ref())?
    }
}

impl<T> Default for WhenAsked<T> {
    fn default() -> Self {
        Self { value: OnceLock::new(), asked: AtomicUsize::new(0) }
    }
}

/// A clone finds out anew.
impl<T> Clone for WhenAsked<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}
