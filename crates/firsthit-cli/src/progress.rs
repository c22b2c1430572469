//! Progress on a terminal, a log of the steps, and Ctrl-C.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};

use firsthit::watch::Watch;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::args::VerbosityArgs;
use crate::console::{be_quiet, counted, is_quiet, report_interrupted, say};
use crate::failure::INTERRUPTED;

/// The time that a computation gets to notice that it is interrupted.
const GRACE: Duration = Duration::from_millis(300);

/// The time that a step takes at least to have a bar.
const MOMENT: Duration = Duration::from_millis(300);

/// The share of a step that tells how long the rest takes.
const ESTIMATES: f32 = 0.01;

/// The unit of steps whose speed is shown.
pub(crate) const RAYS: &str = "rays";

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

/// Follows the run, step by step: a bar on standard error if that is a terminal, a line for each
/// step that is done if those are asked for, and the flag of Ctrl-C.
pub(crate) struct Progress {
    bar: ProgressBar,
    interrupted: Arc<AtomicBool>,
    is_verbose: bool,
    step: Arc<Mutex<Option<Step>>>,
}

/// A step that is not done.
struct Step {
    name: String,
    total: u64,
    unit: &'static str,
    began: Instant,
}

impl Progress {
    pub(crate) fn new(args: &VerbosityArgs) -> Self {
        be_quiet(args.quiet);
        let progress = Self {
            bar: ProgressBar::hidden(),
            interrupted: Arc::default(),
            is_verbose: args.verbose,
            step: Arc::default(),
        };
        if !is_quiet() && std::io::stderr().is_terminal() {
            let (step, bar) = (Arc::downgrade(&progress.step), progress.bar.clone());
            // Without the thread there is no bar.
            let _ = std::thread::Builder::new().spawn(move || show_long_steps(&step, &bar));
        }
        progress
    }

    /// Turns Ctrl-C into a flag, and ends the program if that has not ended it within a moment.
    /// Nothing is lost by that: outputs are whole files from one instant to the next, or not there.
    pub(crate) fn catch_interrupts(&self) {
        let (flag, bar) = (Arc::clone(&self.interrupted), self.bar.clone());
        // Fails only where somebody else has a handler: then Ctrl-C is theirs.
        let _ = ctrlc::try_set_handler(move || {
            if flag.swap(true, Ordering::SeqCst) {
                std::process::exit(i32::from(INTERRUPTED));
            }
            let bar = bar.clone();
            let end = move || {
                bar.finish_and_clear();
                report_interrupted();
                std::process::exit(i32::from(INTERRUPTED));
            };
            let at_once = end.clone();
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
                at_once();
            }
        });
    }

    /// Ends the step: the bar is gone, and the step is logged.
    pub(crate) fn end(&self) {
        let mut step = self.step.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(step) = step.take() {
            let done = self.bar.position().min(step.total);
            self.bar.finish_and_clear();
            self.bar.set_draw_target(ProgressDrawTarget::hidden());
            if self.is_verbose {
                say(step.line(done));
            }
        }
    }
}

/// Shows the bar of each step from the moment on that it turns out to be long.
fn show_long_steps(step: &Weak<Mutex<Option<Step>>>, bar: &ProgressBar) {
    while let Some(step) = step.upgrade() {
        let step = step.lock().unwrap_or_else(PoisonError::into_inner);
        if step.as_ref().is_some_and(|step| step.began.elapsed() > MOMENT) {
            if bar.is_hidden() {
                bar.set_draw_target(ProgressDrawTarget::stderr());
            }
            bar.tick();
        }
        drop(step);
        std::thread::sleep(MOMENT / 3);
    }
}

impl Step {
    /// The line of the log, such as `firsthit: reading a.ply: 190042305 bytes, 0.12 s, 203 MB`.
    fn line(&self, done: u64) -> String {
        let Self { name, total, .. } = self;
        let seconds = self.began.elapsed().as_secs_f64();
        let mut count = counted(*total, self.unit.trim_end_matches('s'));
        if done < *total {
            count = format!("{done} of {count}");
        }
        let memory =
            memory_in_use().map_or_else(String::new, |bytes| format!(", {} MB", bytes / 1_000_000));
        format!("firsthit: {name}: {count}, {seconds:.2} s{memory}")
    }
}

/// The bytes of memory that the process has now, where the system tells.
fn memory_in_use() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let mut lines = status.lines();
    let line = lines.find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kibibytes: u64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(1024 * kibibytes)
}

fn style(unit: &str) -> ProgressStyle {
    let of_rays = if unit == RAYS { "{speed}  " } else { "" };
    let template = format!("{{msg}}  {{wide_bar}} {{percent:>3}} %  {of_rays}{{left}}");
    let style = ProgressStyle::with_template(&template);
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    style.with_key("speed", speed).with_key("left", left)
}

/// The time left, as soon as there is an estimate.
fn left(state: &ProgressState, out: &mut dyn Write) {
    if state.fraction() >= ESTIMATES {
        let _ = write!(out, "{:#}", HumanDuration(state.eta()));
    }
}

fn speed(state: &ProgressState, out: &mut dyn Write) {
    let _ = write!(out, "{:.2} Mrays/s", state.per_sec() / 1e6);
}

impl Watch for Progress {
    fn begin(&self, step: &str, total: u64, unit: &'static str) {
        self.end();
        // Nothing would end it.
        if total == 0 {
            return;
        }
        let began = Step { name: step.to_owned(), total, unit, began: Instant::now() };
        let mut present = self.step.lock().unwrap_or_else(PoisonError::into_inner);
        self.bar.reset();
        self.bar.set_style(style(unit));
        self.bar.set_length(total);
        self.bar.set_message(step.to_owned());
        *present = Some(began);
    }

    fn advance(&self, count: u64) {
        self.bar.inc(count);
        if Some(self.bar.position()) >= self.bar.length() {
            self.end();
        }
    }

    fn is_stopped(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end();
    }
}
