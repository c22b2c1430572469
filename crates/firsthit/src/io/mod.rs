//! Mesh and scene files, read with suspicion.
//!
//! A file is bytes from a stranger: no count in it sizes an allocation, no index in it is used
//! unchecked, and nothing outside its folder is opened on its word.

// A loader that panics is a loader that a file can crash.
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::indexing_slicing
    )
)]

mod mtl;
mod obj;
mod ply;
mod polygon;
mod read;
mod report;
mod stl;
mod surface;
mod text;

use std::path::Path;

use crate::error::{Error, Place, Result};
use crate::geometry::{Color, DVec3};
use crate::shape::Mesh;
use report::{Checked, Report};

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
    /// Its linear colour, if the file gives it one; white where the mesh itself is coloured.
    pub color: Option<Color>,
}

/// How to treat a doubtful file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LoadSettings {
    /// Whether triangles that cannot be used are an error instead of a warning.
    pub strict: bool,
}

/// A kind of file.
struct Format {
    name: &'static str,
    /// In lower case, without the dot.
    extensions: &'static [&'static str],
    up: DVec3,
    read: fn(&[u8], &mut Report) -> Checked<Vec<Part>>,
}

/// Every format there is; all else is derived from this table.
const FORMATS: &[Format] = &[
    Format {
        name: "OBJ",
        extensions: &["obj"],
        up: DVec3::Y,
        read: obj::read,
    },
    Format {
        name: "PLY",
        extensions: &["ply"],
        up: DVec3::Z,
        read: ply::read,
    },
    Format {
        name: "STL",
        extensions: &["stl"],
        up: DVec3::Z,
        read: stl::read,
    },
];

/// Reads the file at `path`, its format chosen by its extension.
///
/// # Errors
///
/// [`Error::Read`] when the system refuses, or `path` is no regular file; [`Error::Parse`] when the
/// content or the extension is wrong; [`Error::Limit`] for more than memory or identifiers hold.
pub fn load(path: &Path, settings: &LoadSettings) -> Result<Model> {
    let format = format_of(path)?;
    let bytes = read::regular_file(path)?;
    let mut report = Report::new(path);
    let parts = (format.read)(&bytes, &mut report).map_err(|fault| fault.into_error(path))?;
    if let (true, Some(what)) = (settings.strict, report.dropped()) {
        return Err(parse_error(path, what));
    }
    Ok(Model {
        parts,
        warnings: report.into_lines(),
        up: format.up,
    })
}

fn format_of(path: &Path) -> Result<&'static Format> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    FORMATS
        .iter()
        .find(|format| format.extensions.iter().any(|&known| extension == known))
        .ok_or_else(|| {
            let known: Vec<_> = FORMATS
                .iter()
                .flat_map(|format| format.extensions.iter().map(move |e| (format.name, e)))
                .map(|(name, extension)| format!(".{extension} ({name})"))
                .collect();
            let what = format!(
                "the extension names no known format; it must be one of {}",
                known.join(", ")
            );
            parse_error(path, what)
        })
}

fn parse_error(path: &Path, what: String) -> Error {
    Error::Parse {
        path: path.to_owned(),
        place: Place::File,
        what,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_are_known_in_any_case() {
        assert_eq!(format_of(Path::new("a.b/C.StL")).unwrap().name, "STL");
        let error = format_of(Path::new("x.3ds")).err().unwrap().to_string();
        assert_eq!(
            error,
            "x.3ds: the extension names no known format; \
             it must be one of .obj (OBJ), .ply (PLY), .stl (STL)"
        );
        assert!(format_of(Path::new("noextension")).is_err());
    }

    #[test]
    fn what_is_no_regular_file_is_refused() {
        let folder = tempfile::Builder::new().suffix(".obj").tempdir().unwrap();
        let error = load(folder.path(), &LoadSettings::default()).unwrap_err();
        assert!(
            error.to_string().ends_with("a folder, not a file"),
            "{error}"
        );
        let missing = folder.path().join("x.ply");
        assert!(matches!(
            load(&missing, &LoadSettings::default()),
            Err(Error::Read { .. })
        ));
    }
}
