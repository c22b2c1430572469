//! The display of a scene file's colours in pictures.

use super::section::Section;
use super::table::{Form, Pick, Record, keys, optional, record};
use crate::geometry::{DisplayTransform, ToneMap};
use crate::io::fault::Checked;

pub(super) static DISPLAY: Record = record! {
    "display", "How PNGs show colours.";
    Pick::Always => [keys! {
        /// The exposure in stops: PNGs show colours times 2 to this power. Default: 0.
        exposure: optional(Form::NUMBER),
        /// The tone map of colours in PNGs. Default: none, which shows what is above 1 as 1.
        tone_map: optional(Form::OneOf(|| ToneMap::NAMES.to_vec())),
    }];
};

pub(super) fn read(section: &Section<'_, '_>) -> Checked<DisplayTransform> {
    let named = section.text("tone_map").map(str::parse).transpose();
    Ok(DisplayTransform {
        exposure: section.number("exposure").unwrap_or_default(),
        tone_map: section.checked(named)?.unwrap_or_default(),
    })
}
