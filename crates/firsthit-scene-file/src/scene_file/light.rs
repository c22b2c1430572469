//! Lights of a scene file.

#![allow(
    clippy::indexing_slicing,
    reason = "tables are made when this is compiled, not when a file is read"
)]

use super::section::Section;
use super::settings;
use super::table::{Key, Pick, Record, Variant};
use crate::io::fault::Checked;
use crate::scene::Light;

settings::variants!(Light::KINDS, |name| Pick::Tag("kind", name), &[]);

pub(super) static LIGHT: Record = Record { name: "light", about: "A light.", variants: &VARIANTS };

pub(super) fn read(section: &Section<'_, '_>) -> Checked<Light> {
    let kind = section.tag().unwrap_or("directional");
    let given = settings::given(section, Light::KINDS, kind);
    section.checked(Light::from_settings(kind, given))
}
