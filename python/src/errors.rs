//! The library's errors as Python's.

use std::io::ErrorKind;
use std::path::Path;

use firsthit::Error;
use firsthit::error::{Place, escape_controls};
use numpy::AsSliceError;
use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// An exception on its way to Python.
#[derive(Debug)]
pub(crate) struct Raised(PyErr);

/// The result of a function that Python calls.
pub(crate) type Outcome<T> = Result<T, Raised>;

impl Raised {
    /// A `ValueError`.
    pub(crate) fn value(text: impl Into<String>) -> Self {
        PyValueError::new_err(text.into()).into()
    }
}

impl From<Error> for Raised {
    fn from(error: Error) -> Self {
        Self(Python::attach(|py| raise(py, &error)))
    }
}

impl From<PyErr> for Raised {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

impl From<AsSliceError> for Raised {
    /// The Python half sends contiguous arrays; this is for calls around it.
    fn from(_: AsSliceError) -> Self {
        Self::value("expected a C-contiguous array")
    }
}

impl From<serde_json::Error> for Raised {
    fn from(error: serde_json::Error) -> Self {
        Self::value(error.to_string())
    }
}

impl From<Raised> for PyErr {
    fn from(Raised(error): Raised) -> Self {
        error
    }
}

/// The Python exception for an error; those about files are classes of the Python half.
pub(crate) fn raise(py: Python<'_>, error: &Error) -> PyErr {
    // Names in it may be of a caller who escaped nothing.
    let message = escape_controls(&error.to_string());
    let file = |class, path, place| of_file(class, py, (path, place), message.clone());
    match error {
        Error::Argument { .. } => PyValueError::new_err(message),
        Error::Read { path, source } if source.kind() == ErrorKind::NotFound => {
            file("FileMissingError", path, String::new())
        }
        Error::Read { path, .. } => file("FileReadError", path, String::new()),
        Error::Write { path, .. } => file("FileWriteError", path, String::new()),
        Error::Parse { path, place, .. } => file("FileFormatError", path, words(place)),
        Error::Limit { .. } | Error::TooLarge { .. } => PyMemoryError::new_err(message),
        Error::Interrupted => PyKeyboardInterrupt::new_err(()),
        _ => PyRuntimeError::new_err(message),
    }
}

/// An exception of the Python half about a file and a place in it.
pub(crate) fn of_file(
    class: &str,
    py: Python<'_>,
    (path, place): (&Path, String),
    message: String,
) -> PyErr {
    let made = py
        .import("firsthit._base.errors")
        .and_then(|module| module.getattr(class)?.call1((message, path.to_string_lossy(), place)));
    made.map_or_else(|error| error, PyErr::from_value)
}

fn words(place: &Place) -> String {
    match place {
        Place::Line(line) => format!("line {line}"),
        Place::Position { line, column } => format!("line {line}, column {column}"),
        Place::Byte(byte) => format!("byte {byte}"),
        _ => String::new(),
    }
}

/// A text as one line whose every character is seen.
#[pyfunction]
pub(crate) fn escaped(text: &str) -> String {
    escape_controls(text)
}
