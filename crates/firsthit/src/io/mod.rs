//! Mesh and scene files, read with suspicion.

use crate::geometry::{Color, DVec3};
use crate::shape::Mesh;

/// What a file holds.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// The objects, in the order of their identifiers.
    pub parts: Vec<Part>,
    /// What was doubtful in the file: a line each, ready to print.
    pub warnings: Vec<String>,
    /// Which way is up by the format's custom: +y for OBJ, +z for STL and PLY.
    pub up: DVec3,
}

/// One object of a file.
#[derive(Debug, Clone)]
pub struct Part {
    /// Its name in the file; the file's stem where it has none.
    pub name: String,
    /// Its surface.
    pub mesh: Mesh,
    /// Its linear colour, if the file gives it one.
    pub color: Option<Color>,
}

/// stub
#[derive(Debug)]
pub struct LoadSettings {
    /// stub
    pub strict: bool,
}
/// stub
pub fn load(_path: &std::path::Path, _s: &LoadSettings) -> crate::Result<Model> {
    Ok(Model { up: DVec3::Z, ..Model::default() })
}
