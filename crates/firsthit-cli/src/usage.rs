//! What clap says, in the one line that every error of the program has.

use clap::error::{Error, ErrorKind};
use firsthit::error::escape_controls;

use crate::console::say;
use crate::failure::USAGE;

/// Prints what was asked for, help or version, or what is wrong with the command line; returns the exit
/// code.
pub(crate) fn report(error: &Error) -> u8 {
    match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // A closed pipe (`firsthit --help | head -1`) is nothing to complain about.
            let _ = error.print();
        }
        _ => say(format_args!("firsthit: error: {}", line(error))),
    }
    u8::try_from(error.exit_code()).unwrap_or(USAGE)
}

/// clap's message and tips; its usage is left to `--help`.
fn line(error: &Error) -> String {
    let text = error.render().to_string();
    let mut line = String::new();
    for part in text.split("\n\n").map(str::trim) {
        if part.starts_with("Usage:") || part.starts_with("For more information") {
            continue;
        }
        let words: Vec<&str> = part.lines().map(str::trim).collect();
        if !line.is_empty() {
            line += "; ";
        }
        line += words.join(" ").trim_start_matches("error: ");
    }
    let help = match text.split_once("Usage: firsthit ") {
        Some((_, usage)) if usage.starts_with(char::is_alphabetic) => {
            let command = usage.split_whitespace().next().unwrap_or_default();
            format!("firsthit {command} --help")
        }
        _ => "--help".into(),
    };
    format!("{}; see {help}", escape_controls(&line))
}
