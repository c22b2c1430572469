//! Lights of a scene file.

use super::section::Section;
use super::table::Form;
use super::table::{Pick, Record, Variant, key, required};
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
            keys: &[&[
                required(
                    "direction",
                    Form::Direction,
                    "Where the light goes, not where it comes from; of any length.",
                ),
                key(
                    "color",
                    Form::Color,
                    "What a white surface that faces the light takes. Default: [1, 1, 1].",
                ),
            ]],
            rules: &[],
        },
        Variant {
            pick: Pick::Tag(KIND, "point"),
            keys: &[&[
                required("position", Form::Vector, "Where the light is."),
                key(
                    "intensity",
                    Form::Color,
                    "What a white surface that faces the light takes at distance 1; it falls off with the square of the distance. Default: [1, 1, 1].",
                ),
            ]],
            rules: &[],
        },
    ],
};

pub(super) fn read(section: &Section<'_, '_>) -> Checked<Light> {
    let color = |name| section.color(name).unwrap_or(Color::ONE);
    if section.tag() == Some("point") {
        return Ok(Light::Point {
            position: section.need_vector("position")?,
            intensity: color("intensity"),
        });
    }
    Ok(Light::Directional {
        direction: section.need_vector("direction")?,
        color: color("color"),
    })
}
