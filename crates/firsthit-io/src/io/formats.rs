//! The formats of meshes and models.

use std::path::Path;

use super::format::{Format, ModelFormat, format_of};
#[cfg(feature = "gltf")]
use super::gltf;
use super::model::Model;
#[cfg(feature = "obj")]
use super::obj;
#[cfg(feature = "off")]
use super::off;
#[cfg(feature = "ply")]
use super::ply;
use super::read;
use super::report::Report;
#[cfg(feature = "stl")]
use super::stl;
use crate::error::Result;
use crate::geometry::DVec3;

/// Every format of meshes and models.
pub const FORMATS: &[ModelFormat] = &[
    #[cfg(feature = "gltf")]
    ModelFormat {
        format: Format { name: "glTF", extensions: &["gltf", "glb"], up: DVec3::Y, rules_up: true },
        read: gltf::read,
    },
    #[cfg(feature = "obj")]
    ModelFormat {
        format: Format { name: "OBJ", extensions: &["obj"], up: DVec3::Y, rules_up: false },
        read: obj::read,
    },
    #[cfg(feature = "ply")]
    ModelFormat {
        format: Format { name: "PLY", extensions: &["ply"], up: DVec3::Z, rules_up: false },
        read: ply::read,
    },
    #[cfg(feature = "stl")]
    ModelFormat {
        format: Format { name: "STL", extensions: &["stl"], up: DVec3::Z, rules_up: false },
        read: stl::read,
    },
    #[cfg(feature = "off")]
    ModelFormat {
        format: Format { name: "OFF", extensions: &["off"], up: DVec3::Z, rules_up: false },
        read: off::read,
    },
];

/// Reads the file at `path`, which the file of `whole` names, within the budget of that one.
///
/// # Errors
///
/// The errors of [`ModelFormat::load`], and where `path` cannot be read.
pub fn load_part(path: &Path, whole: &mut Report) -> Result<Model> {
    let format = format_of(path, FORMATS.iter())?;
    let bytes = read::regular_file(path, whole.budget.left(), whole.watch)?;
    let mut report = whole.part(path);
    let model = format.load(bytes.into(), &mut report)?;
    if let Some(error) = report.strict_error() {
        return Err(error);
    }
    whole.absorb(report);
    Ok(model)
}
