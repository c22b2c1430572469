//! Plans of data sets.

use std::path::PathBuf;

use firsthit::Error;
use firsthit::error::Place;
use firsthit::scene_file::Mistake;
use pyo3::prelude::*;

use crate::errors::{Outcome, Raised};

/// The values of a plan as JSON. A mistake is told with its line and column in a file, and else
/// with the table that it is in.
#[pyfunction]
pub(crate) fn read_plan(text: &[u8], path: Option<PathBuf>) -> Outcome<String> {
    let read = firsthit::scene_file::read_plan(text)?;
    read.map_err(|Mistake { place, table, what }| match path {
        Some(path) => Error::Parse { path, place, what }.into(),
        None if table.is_empty() => Raised::value(format!("plan: {what}")),
        None => Raised::value(format!("plan: {table}: {what}")),
    })
}

/// The file that a plan in a folder names.
#[pyfunction]
pub(crate) fn plan_file(folder: PathBuf, name: &str) -> Outcome<PathBuf> {
    firsthit::scene_file::plan_file(&folder, name).map_err(Raised::value)
}

/// The line and column in a plan to which keys and indices lead.
#[pyfunction]
pub(crate) fn place_in_plan(text: &[u8], way: Vec<String>) -> Option<(u64, u64)> {
    match firsthit::scene_file::place_in_plan(text, &way) {
        Some(Place::Position { line, column }) => Some((line, column)),
        _ => None,
    }
}
