//! The reason why a file cannot be read.

use std::path::Path;

use crate::error::{Error, Place};

/// The result of a step of a loader, before the path is known.
pub type Checked<T> = Result<T, Fault>;

/// The reason why a file cannot be read.
#[derive(Debug)]
pub enum Fault {
    /// The content is wrong.
    Content { place: Place, what: String },
    /// The content needs more memory than is allowed.
    TooLarge { place: Place, what: String },
    /// Any other error.
    Other(Error),
}

impl Fault {
    pub fn at(place: Place, what: impl Into<String>) -> Self {
        let what = what.into();
        Self::Content { place, what }
    }

    pub fn line(number: u64, what: impl Into<String>) -> Self {
        Self::at(Place::Line(number), what)
    }

    pub fn file(what: impl Into<String>) -> Self {
        Self::at(Place::File, what)
    }

    pub fn too_large(place: Place, what: impl Into<String>) -> Self {
        let what = what.into();
        Self::TooLarge { place, what }
    }

    pub fn into_error(self, path: &Path) -> Error {
        let path = path.to_owned();
        match self {
            Self::Content { place, what } => {
                let what = shortened(what);
                Error::Parse { path, place, what }
            }
            Self::TooLarge { place, what } => {
                let what = shortened(what);
                Error::TooLarge { path, place, what }
            }
            Self::Other(error) => error,
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Other(error)
    }
}

/// The longest message, in characters.
const LONGEST: usize = 1000;

/// Cuts a text that the names in a file have made too long to read.
pub(crate) fn shortened(mut text: String) -> String {
    if let Some((end, _)) = text.char_indices().nth(LONGEST) {
        text.truncate(end);
        text.push_str("...");
    }
    text
}
