//! The reason why bytes cannot be read.

use super::super::fault::Fault;
use super::super::report::Report;
use crate::error::Place;

/// The reason why bytes cannot be read, before their place in the document is known.
#[derive(Debug)]
pub(super) enum Problem {
    Words(String),
    Fault(Fault),
}

impl Problem {
    pub(super) fn at(self, place: Place) -> Fault {
        match self {
            Self::Words(what) => Fault::at(place, what),
            Self::Fault(fault) => fault,
        }
    }

    /// The reason in words, for a warning.
    pub(super) fn into_words(self, report: &Report) -> String {
        match self {
            Self::Words(what) => what,
            Self::Fault(fault) => fault.into_error(report.source.path()).to_string(),
        }
    }
}

impl From<String> for Problem {
    fn from(what: String) -> Self {
        Self::Words(what)
    }
}

impl From<&str> for Problem {
    fn from(what: &str) -> Self {
        Self::Words(what.to_owned())
    }
}

impl From<Fault> for Problem {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}
