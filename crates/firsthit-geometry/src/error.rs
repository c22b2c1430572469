//! Errors, grouped by who can put them right.

use std::borrow::Cow;
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

/// The result of everything in firsthit that can fail.
///
/// ```
/// use firsthit::{DVec3, Object, Result, Scene, Sphere};
///
/// fn ball(radius: f64) -> Result<Scene> {
///     Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, radius)?)])
/// }
/// assert!(ball(0.0).is_err());
/// ```
pub type Result<T> = std::result::Result<T, Error>;

/// The error of any call. Rays never fail: a ray that makes no sense is a miss.
///
/// ```
/// use firsthit::{DVec3, Error, Sphere};
///
/// let error = Sphere::new(DVec3::ZERO, -1.0).unwrap_err();
/// assert_eq!(error.to_string(), "radius must be positive and finite, got -1");
/// assert!(matches!(error, Error::Argument { name: "radius", .. }));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value that the caller passed makes no sense. The caller can fix it.
    #[error("{name} must be {expected}, got {got}")]
    Argument {
        /// The parameter's name, in the words of the interface.
        name: &'static str,
        /// The expected value.
        expected: Cow<'static, str>,
        /// The value that came.
        got: String,
    },
    /// The operating system refused to read something.
    #[error("{}: {source}", escaped(.path))]
    Read {
        /// The path that was to be read.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The operating system refused to write something. Nothing of it was written.
    #[error("{}: {source}", escaped(.path))]
    Write {
        /// The path that was to be written.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file's content is wrong. The file's author can fix it.
    #[error("{}{place}: {what}", escaped(.path))]
    Parse {
        /// The file.
        path: PathBuf,
        /// The place in the file.
        place: Place,
        /// The fault there, and a hint where there is one.
        what: String,
    },
    /// The demand is beyond the limits of this machine or this library.
    #[error("{what}: {got} is over the limit of {limit}")]
    Limit {
        /// The things that there would be too many of.
        what: &'static str,
        /// The demand.
        got: String,
        /// The limit.
        limit: String,
    },
    /// A file needs more than its reader was allowed to spend on it. The caller can allow more.
    #[error("{}{place}: {what}", escaped(.path))]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The place in the file.
        place: Place,
        /// The need, the limit, and the way to allow more.
        what: String,
    },
    /// The caller's [`Watch`](crate::watch::Watch) asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// An [`Error::Argument`] from anything printable.
    pub fn argument(
        name: &'static str,
        expected: impl Into<Cow<'static, str>>,
        got: impl fmt::Display,
    ) -> Self {
        let (expected, got) = (expected.into(), got.to_string());
        Self::Argument { name, expected, got }
    }
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(u64),
    /// A line of a text file and a character in it, both counted from 1.
    Position {
        /// The line.
        line: u64,
        /// The column.
        column: u64,
    },
    /// An offset into a binary file, counted from 0.
    Byte(u64),
    /// A value of a JSON document, by its pointer (RFC 6901), such as `/accessors/3/count`.
    Pointer(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ":{line}"),
            Self::Position { line, column } => write!(f, ":{line}:{column}"),
            Self::Byte(byte) => write!(f, " @ byte {byte}"),
            Self::Pointer(pointer) => write!(f, "#{pointer}"),
        }
    }
}

/// A path or a name from a file as one line of printable text: what [`escape_controls`] escapes is
/// escaped, so that a hostile name cannot write to the terminal.
pub fn escaped(path: &Path) -> String {
    escape_controls(&path.to_string_lossy())
}

/// `text` as one line whose every character is seen: control characters, the marks that reorder a
/// line of text, line separators and characters without a glyph are escaped. Text that is escaped
/// already stays as it is.
///
/// ```
/// use firsthit::error::escape_controls;
///
/// assert_eq!(escape_controls("a\u{202e}b\n"), r"a\u{202e}b\u{a}");
/// ```
pub fn escape_controls(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if is_unseen(c) {
            line.extend(c.escape_unicode());
        } else {
            line.push(c);
        }
    }
    line
}

/// The text about names beside one that is not among them: the first of those there are, or `none`.
#[doc(hidden)]
pub fn there_are(names: &[String], none: &str) -> String {
    /// The most names that are listed.
    const MOST: usize = 20;
    match names.get(..MOST) {
        _ if names.is_empty() => none.to_owned(),
        Some(first) if names.len() > MOST => {
            let (first, more) = (first.join(", "), names.len() - MOST);
            format!("there are {first} and {more} more")
        }
        _ => format!("there are {}", names.join(", ")),
    }
}

/// JSON whose strings have the characters that [`escape_controls`] escapes as JSON's own escapes:
/// it can be shown on a terminal, and its strings are those of `json`.
///
/// ```
/// use firsthit::error::escape_controls_of_json;
///
/// assert_eq!(escape_controls_of_json("[\"a\u{202e}b\"]\n"), "[\"a\\u202eb\"]\n");
/// ```
pub fn escape_controls_of_json(json: &str) -> String {
    // In JSON a bare line break is never part of a string.
    escape_json(json, |c| is_unseen(c) && c != '\n')
}

/// JSON whose strings have some characters, which only strings have, as JSON's own escapes.
#[doc(hidden)]
pub fn escape_json(json: &str, is_escaped: impl Fn(char) -> bool) -> String {
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        if is_escaped(c) {
            for unit in c.encode_utf16(&mut [0; 2]) {
                let _ = write!(text, "\\u{unit:04x}");
            }
        } else {
            text.push(c);
        }
    }
    text
}

/// Whether a character does something to a text without being seen in it, which would disguise a
/// name or write to the terminal: controls, and Unicode's default ignorable and line-breaking
/// characters. Joiners and variation selectors are none: names in Persian or Sinhala are spelt with
/// them, and they move nothing.
fn is_unseen(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}'
            | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}'
            | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e00ff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_that_are_not_seen_are_escaped_and_names_in_any_script_stay() {
        let hidden = "\u{7}\u{1b}\u{7f}\u{9b}\u{ad}\u{61c}\u{200b}\u{200e}\u{200f}\u{2028}\u{202a}\u{202b}\u{202c}\u{202d}\u{202e}\
            \u{2060}\u{2066}\u{2067}\u{2068}\u{2069}\u{feff}\u{fff9}\u{e0041}";
        for c in hidden.chars() {
            let shown = escape_controls(&format!("a{c}b"));
            assert_eq!(shown, format!("a\\u{{{:x}}}b", u32::from(c)));
            assert_eq!(escape_controls(&shown), shown);
        }
        for name in ["cube", "Würfel", "می\u{200c}خواهم", "工具", "👩\u{200d}🔧", "❤\u{fe0f}"]
        {
            assert_eq!(escape_controls(name), name);
        }
    }
}
