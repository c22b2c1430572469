//! Progress on a terminal, and Ctrl-C.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use firsthit::watch::Watch;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::console::{say, say_interrupted};
use crate::failure::INTERRUPTED;

/// The time that a computation gets to notice that it is interrupted.
const GRACE: Duration = Duration::from_millis(300);

/// Turns Ctrl-C into a flag, and ends the program if that has not ended it within a moment. Nothing is lost
/// by that: outputs are whole files from one instant to the next, or not there.
pub(crate) fn catch_interrupts() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    // Fails only where somebody else has a handler: then Ctrl-C is theirs.
    let _ = ctrlc::try_set_handler(move || {
        if flag.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        let end = || {
            say_interrupted();
            std::process::exit(i32::from(INTERRUPTED));
        };
        let after_grace = move || {
            std::thread::sleep(GRACE);
            if IS_KEEPING.load(Ordering::SeqCst) {
                say(
                    "firsthit: note: what is done is kept after this sample; Ctrl-C again ends at once",
                );
                while IS_KEEPING.load(Ordering::SeqCst) {
                    std::thread::sleep(GRACE / 10);
                }
                std::thread::sleep(GRACE);
            }
            end();
        };
        if std::thread::Builder::new().spawn(after_grace).is_err() {
            end();
        }
    });
    interrupted
}

/// Whether somebody keeps what is done before it ends.
static IS_KEEPING: AtomicBool = AtomicBool::new(false);

/// A guard: while it lives, the first Ctrl-C leaves the time that it takes to keep what is done.
pub(crate) struct Keeping(());

impl Keeping {
    pub(crate) fn begin() -> Self {
        IS_KEEPING.store(true, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for Keeping {
    fn drop(&mut self) {
        IS_KEEPING.store(false, Ordering::SeqCst);
    }
}

/// The flag of Ctrl-C alone, for what is not counted in rays.
pub(crate) struct Interrupt<'a>(pub(crate) &'a AtomicBool);

impl Watch for Interrupt<'_> {
    fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Follows a computation: a bar on standard error if that is a terminal, and the flag of Ctrl-C.
pub(crate) struct Progress<'a> {
    bar: ProgressBar,
    interrupted: &'a AtomicBool,
}

impl<'a> Progress<'a> {
    pub(crate) fn new(rays: u64, quiet: bool, interrupted: &'a AtomicBool) -> Self {
        let visible = !quiet && std::io::stderr().is_terminal();
        let target = if visible {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {speed}  {eta}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::with_draw_target(Some(rays), target)
            .with_style(style.with_key("speed", speed));
        Self { bar, interrupted }
    }
}

fn speed(state: &ProgressState, out: &mut dyn Write) {
    let _ = write!(out, "{:.2} Mrays/s", state.per_sec() / 1e6);
}

impl Watch for Progress<'_> {
    fn advance(&self, rays: u64) {
        self.bar.inc(rays);
    }

    fn is_stopped(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}

impl Drop for Progress<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
