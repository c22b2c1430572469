//! The formats of meshes and models.

use std::path::Path;

use super::format::{Format, format_of};
#[cfg(feature = "gltf")]
use super::gltf;
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
use crate::world::World;

/// Every format but the scene file.
pub(crate) const FORMATS: &[Format] = &[
    #[cfg(feature = "gltf")]
    Format {
        name: "glTF",
        extensions: &["gltf", "glb"],
        up: DVec3::Y,
        rules_up: true,
        read: gltf::read,
    },
    #[cfg(feature = "obj")]
    Format {
        name: "OBJ",
        extensions: &["obj"],
        up: DVec3::Y,
        rules_up: false,
        read: obj::read,
    },
    #[cfg(feature = "ply")]
    Format {
        name: "PLY",
        extensions: &["ply"],
        up: DVec3::Z,
        rules_up: false,
        read: ply::read,
    },
    #[cfg(feature = "stl")]
    Format {
        name: "STL",
        extensions: &["stl"],
        up: DVec3::Z,
        rules_up: false,
        read: stl::read,
    },
    #[cfg(feature = "off")]
    Format {
        name: "OFF",
        extensions: &["off"],
        up: DVec3::Z,
        rules_up: false,
        read: off::read,
    },
];

/// Reads the file at `path`, which the file of `whole` names, within the budget of that one.
///
/// # Errors
///
/// Those of [`Format::load`], and where `path` cannot be read.
pub(crate) fn load_part(path: &Path, whole: &mut Report) -> Result<World> {
    let format = format_of(path, FORMATS.iter())?;
    let bytes = read::regular_file(path, whole.budget.left())?;
    let mut report = whole.part(path);
    let loaded = format.load(bytes.into(), &mut report)?;
    whole.absorb(&report, loaded.warnings, loaded.files);
    whole.add_variants(loaded.variants);
    Ok(loaded.world)
}
