//! Colours by numbers in a scene file.

use super::section::Section;
use super::table::{Form, Key, Pick, Record, Rule, keys, optional, record, required};
use crate::geometry::ColorMap;
use crate::io::fault::Checked;
use crate::scene::{ColorBy, Coloring};

/// How numbers become colours.
pub(super) const SCALE: &[Key] = keys! {
    /// The colour map. Default: viridis.
    map: optional(Form::OneOf(|| ColorMap::NAMES.to_vec())),
    /// The numbers of the first and the last colour. Default: the least and the largest that the
    /// scene has, seen or not.
    range: optional(Form::Range),
    /// The colour of numbers below a given range. Default: the map's first.
    below: optional(Form::COLOR),
    /// The colour of numbers above a given range. Default: the map's last.
    above: optional(Form::COLOR),
    /// The colour where there is no number. Default: the surface's own.
    missing: optional(Form::COLOR),
};

pub(super) static COLORS: Record = record! {
    "colors", "Colours by numbers, in place of those that surfaces have. Shaders light them as others.";
    Pick::Always => [keys! {
        /// The source of the numbers: attribute:NAME for an attribute of the meshes, object,
        /// face, height, or incidence (the angle between the ray and the normal, in radians).
        by: required(Form::OneOfOr(|| ColorBy::NAMES.to_vec(), ColorBy::ATTRIBUTE)),
    }, SCALE] [Rule::Needs("below", "range"), Rule::Needs("above", "range")];
};

/// The colours by numbers of the whole file, if it says some.
pub(super) fn read(scene: &Section<'_, '_>) -> Checked<Option<Coloring>> {
    let Some(section) = scene.table("colors", &COLORS)? else {
        return Ok(None);
    };
    let by = section.need("by", Section::text)?;
    let map = section.text("map").map(str::parse).transpose();
    Ok(Some(Coloring {
        map: section.checked(map)?.unwrap_or_default(),
        range: section.range("range"),
        below: section.color("below"),
        above: section.color("above"),
        missing: section.color("missing"),
        ..Coloring::new(section.checked(by.parse::<ColorBy>())?)
    }))
}
