//! Lights of a scene file.

#![allow(
    clippy::indexing_slicing,
    reason = "tables are made when this is compiled, not when a file is read"
)]

use super::section::Section;
use super::settings::{self, MOST};
use super::table::{Key, Pick, Record, Variant};
use crate::io::fault::Checked;
use crate::scene::Light;

const COUNT: usize = Light::KINDS.len();

static KEYS: [[Key; MOST]; COUNT] = {
    let mut keys = [settings::keys(&[]); COUNT];
    let mut kind = 0;
    while kind < COUNT {
        keys[kind] = settings::keys(Light::KINDS[kind].1);
        kind += 1;
    }
    keys
};

static GROUPS: [[&[Key]; 1]; COUNT] = {
    let mut groups: [[&[Key]; 1]; COUNT] = [[&[]]; COUNT];
    let mut kind = 0;
    while kind < COUNT {
        groups[kind] = [KEYS[kind].split_at(Light::KINDS[kind].1.len()).0];
        kind += 1;
    }
    groups
};

static VARIANTS: [Variant; COUNT] = {
    let mut variants = [settings::variant(Pick::Always, &[]); COUNT];
    let mut kind = 0;
    while kind < COUNT {
        let pick = Pick::Tag("kind", Light::KINDS[kind].0);
        variants[kind] = settings::variant(pick, &GROUPS[kind]);
        kind += 1;
    }
    variants
};

pub(super) static LIGHT: Record = Record {
    name: "light",
    about: "A light.",
    variants: &VARIANTS,
};

pub(super) fn read(section: &Section<'_, '_>) -> Checked<Light> {
    let kind = section.tag().unwrap_or("directional");
    let mut light = section.checked(Light::named(kind))?;
    let known = Light::KINDS.iter().find(|(name, _)| *name == kind);
    for (name, value) in settings::given(section, known.map_or(&[], |(_, list)| list)) {
        section.checked(light.set(name, value))?;
    }
    section.checked(light.check())?;
    Ok(light)
}
