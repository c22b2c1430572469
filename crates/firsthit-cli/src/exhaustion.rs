//! Handles the end of memory in the middle of something.
//!
//! Whatever a file's counts ask for is asked of the system in a way that can fail, and is an error
//! like any other. A small allocation, or one in foreign code, is not: there the standard library
//! says `memory allocation of N bytes failed`, with a second line or a trace as `RUST_BACKTRACE`
//! asks, and aborts the process. We turn the abort into an orderly exit; the lines are the standard
//! library's.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether an abort means that memory has run out.
pub(crate) struct Exhaustion(Arc<AtomicBool>);

/// Makes an abort, from now on, end the process with the exit code of a limit; after
/// [`Exhaustion::rule_out`] with that of a bug.
pub(crate) fn catch() -> Exhaustion {
    let likely = Arc::new(AtomicBool::new(true));
    #[cfg(unix)]
    {
        use crate::failure::{INTERNAL, LIMIT};
        use signal_hook::consts::SIGABRT;
        use signal_hook::flag::register_conditional_shutdown as shut_down;
        // In this order: the first whose flag is set ends the process. That a handler cannot be
        // registered takes nothing away from what works without.
        let always = Arc::new(AtomicBool::new(true));
        let _ = shut_down(SIGABRT, LIMIT.into(), Arc::clone(&likely))
            .and_then(|_| shut_down(SIGABRT, INTERNAL.into(), always));
    }
    Exhaustion(likely)
}

impl Exhaustion {
    /// A panic rules it out: an abort that follows is the panic's.
    pub(crate) fn rule_out(&self) {
        self.0.store(false, Ordering::Relaxed);
    }
}
