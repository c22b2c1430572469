//! What can go wrong, grouped by who can put it right.

use std::fmt;
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

/// What went wrong. Rays never fail: a ray that makes no sense is a miss.
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
        /// What would be right.
        expected: &'static str,
        /// What came.
        got: String,
    },
    /// The operating system refused to read something.
    #[error("{}: {source}", escaped(.path))]
    Read {
        /// What was to be read.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The operating system refused to write something. Nothing of it was written.
    #[error("{}: {source}", escaped(.path))]
    Write {
        /// What was to be written.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file's content is wrong. Whoever made the file can fix it.
    #[error("{}{place}: {what}", escaped(.path))]
    Parse {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Place,
        /// What is wrong there, and a hint where there is one.
        what: String,
    },
    /// More was asked for than this machine or this library's limits hold.
    #[error("{what}: {got} is over the limit of {limit}")]
    Limit {
        /// What there would be too much of.
        what: &'static str,
        /// How much was asked for.
        got: String,
        /// How much is possible.
        limit: String,
    },
    /// A file needs more than its reader was allowed to spend on it. Whoever reads it can allow more.
    #[error("{}{place}: {what}", escaped(.path))]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Place,
        /// What it needs, what is allowed, and how to allow more.
        what: String,
    },
    /// The caller's [`Watch`](crate::watch::Watch) asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// An [`Error::Argument`] from anything printable.
    pub fn argument(name: &'static str, expected: &'static str, got: impl fmt::Display) -> Self {
        let got = got.to_string();
        Self::Argument {
            name,
            expected,
            got,
        }
    }
}

/// Where in a file something stands.
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

/// A path or a name from a file as one line of printable text: control characters are escaped, so
/// that a hostile name cannot write to the terminal.
pub fn escaped(path: &Path) -> String {
    escape_controls(&path.to_string_lossy())
}

/// `text` with its control characters escaped, see [`escaped`].
pub fn escape_controls(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        // Also the Unicode marks that reorder a line of text, which would disguise a file's name.
        if c.is_control()
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
        {
            line.extend(c.escape_unicode());
        } else {
            line.push(c);
        }
    }
    line
}
