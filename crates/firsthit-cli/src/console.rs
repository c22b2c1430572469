//! What the program says on standard error. Standard output is for data alone.

use std::fmt::Display;
use std::io::Write;
use std::sync::Once;

/// Says one line. That nobody listens any more (`2>&1 | head -1`) is no reason to fail, as `eprintln!` would.
pub(crate) fn say(line: impl Display) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Says a warning for each of the lines.
pub(crate) fn warn<T: Display>(warnings: &[T]) {
    for warning in warnings {
        say(format_args!("firsthit: warning: {warning}"));
    }
}

/// Says, once, that Ctrl-C was heard: who was at work says it, or the handler when that takes too long.
pub(crate) fn say_interrupted() {
    static SAID: Once = Once::new();
    SAID.call_once(|| say("firsthit: error: interrupted"));
}

/// A number with its noun: `1 ray`, `2 rays`.
pub(crate) fn counted(count: u64, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}
