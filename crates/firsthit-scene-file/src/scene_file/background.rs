//! The background of a scene file.

use super::form::{TRANSPARENT, is_transparent};
use super::section::Section;
use super::table::{Form, Pick, Record, keys, optional, record, required};
use crate::geometry::{Color, DVec3};
use crate::io::fault::Checked;
use crate::scene::Background;

pub(super) static BACKGROUND: Record = record! {
    "background", "One colour where nothing is hit.";
    Pick::Always => [keys! {
        /// Linear [red, green, blue], or sRGB as "#rrggbb" or by a name of CSS; or "transparent".
        color: required(Form::Either(&Form::COLOR, &Form::Word(TRANSPARENT))),
    }];
};

pub(super) static SKY: Record = record! {
    "sky", "A sky where nothing is hit, from the horizon's colour to the zenith's.";
    Pick::Always => [keys! {
        /// The colour where the ray is level, and below.
        horizon: required(Form::COLOR),
        /// The colour straight up.
        zenith: required(Form::COLOR),
        /// The direction of the zenith. Default: the scene's up.
        up: optional(Form::DIRECTION),
    }];
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
