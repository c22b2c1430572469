//! The background of a scene file.

use super::form::is_transparent;
use super::section::Section;
use super::table::{Form, Pick, Record, Variant, keys, optional, required};
use crate::geometry::{Color, DVec3};
use crate::io::fault::Checked;
use crate::scene::Background;

pub(super) static BACKGROUND: Record = Record {
    name: "background",
    about: "One colour where nothing is hit.",
    variants: &[Variant {
        pick: Pick::Always,
        keys: &[keys! {
            /// Linear [red, green, blue], or sRGB as "#rrggbb" or by a name of CSS; or "transparent".
            color: required(Form::ColorOrTransparent),
        }],
        rules: &[],
    }],
};

pub(super) static SKY: Record = Record {
    name: "sky",
    about: "A sky where nothing is hit, from the horizon's colour to the zenith's.",
    variants: &[Variant {
        pick: Pick::Always,
        keys: &[keys! {
            /// The colour where the ray is level, and below.
            horizon: required(Form::Color),
            /// The colour straight up.
            zenith: required(Form::Color),
            /// The direction of the zenith. Default: the scene's up.
            up: optional(Form::Direction),
        }],
        rules: &[],
    }],
};

/// The background of the whole file, if it says one; `up` is the scene's.
pub(super) fn read(scene: &Section<'_, '_>, up: DVec3) -> Checked<Option<Background>> {
    if let Some(section) = scene.table("background", &BACKGROUND)? {
        if section.raw("color").is_some_and(is_transparent) {
            return Ok(Some(Background::Transparent));
        }
        let color = section.color("color").unwrap_or(Color::ZERO);
        return Ok(Some(Background::Uniform(color)));
    }
    let Some(section) = scene.table("sky", &SKY)? else {
        return Ok(None);
    };
    let color = |name| section.color(name).unwrap_or(Color::ZERO);
    Ok(Some(Background::Gradient {
        horizon: color("horizon"),
        zenith: color("zenith"),
        up: section.vector("up").unwrap_or(up),
    }))
}
