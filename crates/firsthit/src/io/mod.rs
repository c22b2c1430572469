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

mod gltf;
mod gzip;
mod mtl;
mod obj;
mod picture;
mod ply;
mod polygon;
mod read;
mod report;
mod stl;
mod surface;
mod text;

use std::borrow::Cow;
use std::path::Path;

use crate::camera::View;
use crate::error::{Error, Place, Result};
use crate::geometry::DVec3;
use crate::scene::{Background, Light, Object};
use report::{Checked, Report, without_gz};

/// What a file holds.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// The objects, in the order of their identifiers. Those without materials got no colour from the file.
    pub objects: Vec<Object>,
    /// The cameras, in the file's order.
    pub cameras: Vec<NamedCamera>,
    /// The lights.
    pub lights: Vec<Light>,
    /// What rays see that meet nothing, if the file says.
    pub background: Option<Background>,
    /// What was doubtful in the file: a line each, ready to print.
    pub warnings: Vec<String>,
    /// Which way is up by the format's custom: +y for OBJ, +z for STL and PLY.
    pub up: DVec3,
}

impl Model {
    fn of(objects: Vec<Object>) -> Self {
        Self {
            objects,
            ..Self::default()
        }
    }
}

/// A camera of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCamera {
    /// Its name; may be empty. In glTF, that of its node.
    pub name: String,
    /// Another name that it goes by; may be empty. In glTF, that of the camera itself, which nodes may share.
    pub own_name: String,
    /// What it is made from.
    pub view: View,
    /// Whether the file gives the number of pixels and the shape of the viewplane too. If not, the view's height
    /// alone counts, and whoever makes the picture decides about the rest.
    pub has_size: bool,
}

/// How to read a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoadSettings {
    /// Whether triangles that cannot be used are an error instead of a warning.
    pub strict: bool,
    /// How many bytes of memory may be spent on the file: on its content, unpacked, on what it names, and
    /// on the vertices, triangles and textures of all that. The trees of a scene come on top.
    pub max_memory: u64,
    /// How many texels a texture may have across or down, and the root of how many bytes it may have in all.
    pub max_texture: u32,
}

impl Default for LoadSettings {
    /// Doubtful triangles are dropped; 8 GiB; textures of 16,384 texels and 256 MiB.
    fn default() -> Self {
        Self {
            strict: false,
            max_memory: 8 << 30,
            max_texture: 16_384,
        }
    }
}

/// A kind of file.
struct Format {
    name: &'static str,
    /// In lower case, without the dot.
    extensions: &'static [&'static str],
    up: DVec3,
    read: fn(&[u8], &mut Report) -> Checked<Model>,
}

/// Every format there is; all else is derived from this table.
const FORMATS: &[Format] = &[
    Format {
        name: "glTF",
        extensions: &["gltf", "glb"],
        up: DVec3::Y,
        read: gltf::read,
    },
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

/// Reads the file at `path`, its format chosen by its extension. Packed by gzip, it is unpacked; its
/// name may end with `.gz` then.
///
/// # Errors
///
/// [`Error::Read`] when the system refuses, or `path` is no regular file; [`Error::Parse`] when the
/// content or the extension is wrong; [`Error::TooLarge`] for more than `settings` allow, and
/// [`Error::Limit`] for more than identifiers hold.
pub fn load(path: &Path, settings: &LoadSettings) -> Result<Model> {
    let format = format_of(path)?;
    let bytes = read::regular_file(path, settings.max_memory)?;
    model(format, bytes.into(), Report::new(path, *settings))
}

/// Reads a file's content from memory. `name` is what messages call it; its extension tells the format.
/// Nothing that the content names, such as textures, is opened: each is a warning.
///
/// # Errors
///
/// Those of [`load`], but for [`Error::Read`].
pub fn load_bytes(name: &Path, bytes: &[u8], settings: &LoadSettings) -> Result<Model> {
    let format = format_of(name)?;
    model(
        format,
        bytes.into(),
        Report::new(name, *settings).in_memory(),
    )
}

fn model(format: &Format, bytes: Cow<'_, [u8]>, mut report: Report) -> Result<Model> {
    let path = &report.path().to_owned();
    let strict = report.settings().strict;
    let read = |report: &mut Report| {
        report.spend(bytes.len() as u64, "its content")?;
        let bytes = gzip::unpacked(bytes, report)?;
        (format.read)(&bytes, report)
    };
    let model = read(&mut report).map_err(|fault| fault.into_error(path))?;
    if let (true, Some(what)) = (strict, report.dropped()) {
        return Err(parse_error(path, what));
    }
    Ok(Model {
        warnings: report.into_lines(),
        up: format.up,
        ..model
    })
}

fn format_of(path: &Path) -> Result<&'static Format> {
    let unpacked = without_gz(path);
    let extension = unpacked.extension().unwrap_or_default();
    let extension = extension.to_ascii_lowercase();
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
             it must be one of .gltf (glTF), .glb (glTF), .obj (OBJ), .ply (PLY), .stl (STL)"
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
