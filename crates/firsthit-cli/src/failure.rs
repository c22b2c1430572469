//! Failures: why the program ends without success, and with which exit code.

use std::fmt::Display;
use std::io;
use std::path::Path;

use firsthit::Error;
use firsthit::error::{escape_controls, escaped};

use crate::console::{end_report_with_error, report_interrupted, say};

/// The answer is no: outputs differ, or a file has findings.
const NO: u8 = 1;
pub(crate) const USAGE: u8 = 2;
pub(crate) const BAD_INPUT: u8 = 3;
pub(crate) const NOT_WRITTEN: u8 = 4;
pub(crate) const LIMIT: u8 = 5;
pub(crate) const INTERNAL: u8 = 70;
pub(crate) const INTERRUPTED: u8 = 130;

/// The message, and the exit code.
#[derive(Debug)]
pub(crate) struct Failure {
    code: u8,
    /// The message; `None` when no reader is left.
    message: Option<String>,
}

impl Failure {
    pub(crate) fn usage(message: impl Display) -> Self {
        Self { code: USAGE, message: Some(message.to_string()) }
    }

    pub(crate) fn bad_input(message: impl Display) -> Self {
        Self { code: BAD_INPUT, message: Some(message.to_string()) }
    }

    pub(crate) fn not_written(message: impl Display) -> Self {
        Self { code: NOT_WRITTEN, message: Some(message.to_string()) }
    }

    /// A panic, by its message.
    pub(crate) fn bug(text: &str) -> Self {
        Self {
            code: INTERNAL,
            message: Some(format!("a bug in firsthit, please report it: {text}")),
        }
    }

    pub(crate) fn limit(message: impl Display) -> Self {
        Self { code: LIMIT, message: Some(message.to_string()) }
    }

    /// The failure about settings of which options gave those that are `named`, and no file: its
    /// message names the option.
    pub(crate) fn of_options(error: Error, named: &[&str]) -> Self {
        match error {
            Error::Argument { name, expected, got } if named.contains(&name) => {
                let option = name.replace('_', "-");
                let expected = expected.replace("`far`", "--far");
                Self::usage(format!("--{option} must be {expected}, got {got}"))
            }
            other => other.into(),
        }
    }

    /// Adds words to the message.
    pub(crate) fn with(mut self, more: &str) -> Self {
        self.message = self.message.map(|message| message + more);
        self
    }

    /// The failure about a request of a file: then the file is wrong, not the command line.
    pub(crate) fn in_file(self, file: &Path) -> Self {
        match self {
            Self { code: USAGE, message: Some(message) } => {
                Self::bad_input(format!("{}: {message}", escaped(file)))
            }
            other => other,
        }
    }

    /// The answer is no: said already, on standard output.
    pub(crate) fn no() -> Self {
        Self::said(NO)
    }

    /// A failure that is said already.
    pub(crate) fn said(code: u8) -> Self {
        Self { code, message: None }
    }

    /// Standard output did not take it. A reader that has gone away had enough: that is no failure.
    pub(crate) fn stdout(error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Self::said(0);
        }
        Self { code: NOT_WRITTEN, message: Some(format!("standard output: {error}")) }
    }

    /// The exit code and the message.
    pub(crate) fn into_parts(self) -> (u8, String) {
        (self.code, self.message.unwrap_or_default())
    }

    /// Says it on standard error, and returns the exit code.
    pub(crate) fn report(self) -> u8 {
        let message = self.message.unwrap_or_default();
        if self.code == INTERRUPTED {
            report_interrupted();
        } else if !message.is_empty() && !end_report_with_error(&message, self.code) {
            let message = escape_controls(&message);
            say(format_args!("firsthit: error: {message}"));
        }
        self.code
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let code = match &error {
            Error::Write { source, .. } if source.kind() == io::ErrorKind::BrokenPipe => {
                return Self::stdout(source);
            }
            Error::Argument { .. } => USAGE,
            Error::Read { .. } | Error::Parse { .. } => BAD_INPUT,
            Error::Write { .. } => NOT_WRITTEN,
            Error::Limit { .. } | Error::TooLarge { .. } => LIMIT,
            Error::Interrupted => INTERRUPTED,
            _ => INTERNAL,
        };
        Self { code, message: Some(error.to_string()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_option_that_gave_the_value_is_named() {
        let error = || Error::argument("png_scale", "larger, unless `far` is given", "png_scale");
        let (code, message) = Failure::of_options(error(), &["far", "png_scale"]).into_parts();
        let expected = "--png-scale must be larger, unless --far is given, got png_scale";
        assert_eq!((code, &*message), (USAGE, expected));
        let (_, message) = Failure::of_options(error(), &["far"]).into_parts();
        assert_eq!(message, error().to_string());
    }
}
