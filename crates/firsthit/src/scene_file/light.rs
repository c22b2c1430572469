//! Lights of a scene file.

use super::section::Section;
use super::table::{Form, Pick, Record, Variant, keys, optional, required};
use crate::geometry::Color;
use crate::io::fault::Checked;
use crate::scene::Light;

const KIND: &str = "kind";

pub(super) static LIGHT: Record = Record {
    name: "light",
    about: "A light without a size.",
    variants: &[
        Variant {
            pick: Pick::Tag(KIND, "directional"),
            keys: &[keys! {
                /// Where the light goes, not where it comes from; of any length.
                direction: required(Form::Direction),
                /// What a white surface that faces the light takes. Default: [1, 1, 1].
                color: optional(Form::Color),
            }],
            rules: &[],
        },
        Variant {
            pick: Pick::Tag(KIND, "point"),
            keys: &[keys! {
                /// Where the light is.
                position: required(Form::Vector),
                /// What a white surface that faces the light takes at distance 1; it falls off with the square of the
                /// distance. Default: [1, 1, 1].
                intensity: optional(Form::Color),
            }],
            rules: &[],
        },
    ],
};

pub(super) fn read(section: &Section<'_, '_>) -> Checked<Light> {
    let color = |name| section.color(name).unwrap_or(Color::ONE);
    if section.tag() == Some("point") {
        return Ok(Light::Point {
            position: section.need("position", Section::vector)?,
            intensity: color("intensity"),
        });
    }
    Ok(Light::Directional {
        direction: section.need("direction", Section::vector)?,
        color: color("color"),
    })
}
