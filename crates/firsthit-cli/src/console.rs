//! Writes to standard error. Standard output is for data alone.

use std::fmt::Display;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Mutex, Once, PoisonError};

use firsthit::error::{escape_controls, escape_controls_of_json};
pub(crate) use firsthit_view::words::counted;
use serde_json::{Value, json};

use crate::failure::{Failure, INTERRUPTED};

/// Writes one line. A closed pipe (`2>&1 | head -1`) is no reason to fail, as `eprintln!` would.
pub(crate) fn say(line: impl Display) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Prints each warning, or keeps it for the report of `--json`.
pub(crate) fn warn<T: Display>(warnings: &[T]) {
    let warnings = warnings.iter().map(ToString::to_string);
    with_report(|report| match report {
        Some(report) => report.warnings.extend(warnings),
        None => warnings.for_each(|warning| {
            let warning = escape_controls(&warning);
            say(format_args!("firsthit: warning: {warning}"));
        }),
    });
}

/// A value as JSON for programs, on lines for people: names from files cannot write to the
/// terminal.
pub(crate) fn json_text(value: &Value) -> String {
    escape_controls_of_json(&format!("{value:#}"))
}

/// The report of `--json`: one object for the run.
#[derive(Debug, Default)]
struct Report {
    warnings: Vec<String>,
    /// Whether standard output is taken by data.
    is_beside_data: bool,
}

static REPORT: Mutex<Option<Report>> = Mutex::new(None);

fn with_report<T>(work: impl FnOnce(&mut Option<Report>) -> T) -> T {
    work(&mut REPORT.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Starts a report if one `is_wanted`; warnings are then kept for it.
pub(crate) fn begin_report(is_wanted: bool) {
    with_report(|report| *report = is_wanted.then(Report::default));
}

static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Keeps whether the run says nothing but results, warnings and errors.
pub(crate) fn be_quiet(is_quiet: bool) {
    IS_QUIET.store(is_quiet, Relaxed);
}

/// Whether lines for people are left out: it was asked for, or a report takes their place.
pub(crate) fn is_quiet() -> bool {
    IS_QUIET.load(Relaxed) || with_report(|report| report.is_some())
}

/// Sends the report to standard error, since standard output takes data.
pub(crate) fn report_beside_data() {
    with_report(|report| {
        if let Some(report) = report {
            report.is_beside_data = true;
        }
    });
}

/// Takes the warnings kept so far.
pub(crate) fn kept_warnings() -> Vec<String> {
    with_report(|report| report.as_mut().map_or_else(Vec::new, |r| std::mem::take(&mut r.warnings)))
}

/// Prints the report: `done`, with the warnings added.
pub(crate) fn end_report(mut done: Value) -> Result<(), Failure> {
    let Some(Report { warnings, is_beside_data }) = with_report(Option::take) else {
        return Ok(());
    };
    if let Some(fields) = done.as_object_mut() {
        fields.insert("warnings".to_owned(), json!(warnings));
    }
    if is_beside_data {
        say(json_text(&done));
        return Ok(());
    }
    let written = writeln!(std::io::stdout().lock(), "{}", json_text(&done));
    written.map_err(|error| Failure::stdout(&error))
}

/// Prints the report of a failure. Returns whether it went to standard error, where it replaces the
/// line for people.
pub(crate) fn end_report_with_error(message: &str, exit_code: u8) -> bool {
    let is_beside_data = with_report(|report| report.as_ref().is_some_and(|r| r.is_beside_data));
    // A closed stream is no second failure.
    let _ = end_report(json!({ "error": message, "exit_code": exit_code }));
    is_beside_data
}

/// Prints results as they are. No other report follows them.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    with_report(Option::take);
    let written = std::io::stdout().write_all(text.as_bytes());
    written.map_err(|error| Failure::stdout(&error))
}

/// Reports, once, that Ctrl-C was heard: who was at work does, or the handler when that takes too
/// long.
pub(crate) fn report_interrupted() {
    static SAID: Once = Once::new();
    SAID.call_once(|| {
        if !end_report_with_error("interrupted", INTERRUPTED) {
            say("firsthit: error: interrupted");
        }
    });
}

/// The most entries of a list in one line.
const MOST_IN_WORDS: usize = 20;

/// A list for a line of text: its first entries, and how many there are beside.
pub(crate) fn in_words(list: impl ExactSizeIterator<Item = String>) -> String {
    let more = list.len().saturating_sub(MOST_IN_WORDS);
    let mut words: Vec<String> = list.take(MOST_IN_WORDS).collect();
    if more > 0 {
        words.push(format!("and {more} more"));
    }
    words.join(", ")
}
