//! Places in a document, as JSON pointers (RFC 6901).

use std::fmt::Display;

use serde_path_to_error::{Path, Segment};

use super::super::fault::Fault;
use crate::error::{Place, escape_controls};

/// An entry of one of a document's lists, such as an accessor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) list: &'static str,
    pub(super) index: usize,
}

impl Entry {
    pub(super) fn new(list: &'static str, index: usize) -> Self {
        Self { list, index }
    }

    /// The place of one of its values, such as `sparse/count`.
    pub(super) fn at(self, value: impl Display) -> Place {
        let Self { list, index } = self;
        Place::Pointer(escape_controls(&format!("/{list}/{index}/{value}")))
    }

    /// The place of the whole entry.
    pub(super) fn place(self) -> Place {
        let Self { list, index } = self;
        Place::Pointer(format!("/{list}/{index}"))
    }

    /// The fault of one of the entry's values.
    pub(super) fn fault(self, value: impl Display, what: impl Into<String>) -> Fault {
        Fault::at(self.at(value), what)
    }
}

/// A key as a piece of a pointer.
pub(super) fn key(key: &str) -> String {
    escape_controls(&key.replace('~', "~0").replace('/', "~1"))
}

/// The pointer to where reading a document failed.
pub(super) fn pointer_of(path: &Path) -> String {
    let mut pointer = String::new();
    for segment in path {
        pointer.push('/');
        match segment {
            Segment::Seq { index } => pointer.push_str(&index.to_string()),
            Segment::Map { key: name } | Segment::Enum { variant: name } => {
                pointer.push_str(&key(name));
            }
            Segment::Unknown => pointer.push('?'),
        }
    }
    pointer
}
