//! The materials of objects of a scene file.

#![allow(
    clippy::indexing_slicing,
    reason = "tables are made when this is compiled, not when a file is read"
)]

use super::section::Section;
use super::settings;
use super::table::{Form, Key, Pick, Record, Variant, keys, optional};
use crate::geometry::Color;
use crate::io::fault::Checked;
use crate::scene::{Material, Model, Object};

const COMMON: &[Key] = keys! {
    /// The radiance that the surface gives off: it is a light, with the least noise where it is a
    /// mesh or a sphere. Default: none.
    emission: optional(Form::COLOR),
};

settings::variants!(Model::KINDS, |name| Pick::Tag("kind", name), COMMON);

pub(super) static MATERIAL: Record =
    Record { name: "material", about: "What a surface is made of.", variants: &VARIANTS };

/// A material of this colour; without one it is white where light goes through, and neutral
/// elsewhere.
pub(super) fn read(section: &Section<'_, '_>, color: Option<Color>) -> Checked<Material> {
    let kind = section.tag().unwrap_or("matte");
    let given = settings::given(section, Model::KINDS, kind);
    let model = section.checked(Model::from_settings(kind, given))?;
    let default = match model {
        Model::Glass(_) => Color::ONE,
        _ => Object::NEUTRAL,
    };
    Ok(Material {
        model,
        emission: section.color("emission").unwrap_or(Color::ZERO),
        ..Material::colored(color.unwrap_or(default))
    })
}
