//! What objects of a scene file are made of.

#![allow(
    clippy::indexing_slicing,
    reason = "tables are made when this is compiled, not when a file is read"
)]

use super::section::Section;
use super::settings::{self, MOST};
use super::table::{Form, Key, Pick, Record, Variant, keys, optional};
use crate::geometry::Color;
use crate::io::fault::Checked;
use crate::scene::{Material, Model, Object};

const COMMON: &[Key] = keys! {
    /// The radiance that the surface gives off: it is a light. Default: none.
    emission: optional(Form::Color),
};

const COUNT: usize = Model::KINDS.len();

static KEYS: [[Key; MOST]; COUNT] = {
    let mut keys = [settings::keys(&[]); COUNT];
    let mut kind = 0;
    while kind < COUNT {
        keys[kind] = settings::keys(Model::KINDS[kind].2);
        kind += 1;
    }
    keys
};

static GROUPS: [[&[Key]; 2]; COUNT] = {
    let mut groups: [[&[Key]; 2]; COUNT] = [[&[], COMMON]; COUNT];
    let mut kind = 0;
    while kind < COUNT {
        groups[kind][0] = KEYS[kind].split_at(Model::KINDS[kind].2.len()).0;
        kind += 1;
    }
    groups
};

static VARIANTS: [Variant; COUNT] = {
    let mut variants = [settings::variant(Pick::Always, &[]); COUNT];
    let mut kind = 0;
    while kind < COUNT {
        let pick = Pick::Tag("kind", Model::KINDS[kind].0);
        variants[kind] = settings::variant(pick, &GROUPS[kind]);
        kind += 1;
    }
    variants
};

pub(super) static MATERIAL: Record = Record {
    name: "material",
    about: "What a surface is made of.",
    variants: &VARIANTS,
};

/// A material of this colour; without one it is white where light goes through, and neutral elsewhere.
pub(super) fn read(section: &Section<'_, '_>, color: Option<Color>) -> Checked<Material> {
    let kind = section.tag().unwrap_or("matte");
    let mut model = section.checked(Model::named(kind))?;
    let known = Model::KINDS.iter().find(|(name, ..)| *name == kind);
    for (name, value) in settings::given(section, known.map_or(&[], |(.., list)| list)) {
        section.checked(model.set(name, value))?;
    }
    let usual = match model {
        Model::Glass(_) => Color::ONE,
        _ => Object::NEUTRAL,
    };
    Ok(Material {
        model,
        emission: section.color("emission").unwrap_or(Color::ZERO),
        ..Material::colored(color.unwrap_or(usual))
    })
}
