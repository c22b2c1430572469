//! Replaces unusable normals, texture coordinates and colours, so that a NaN does not spread over a picture.

use super::report::Report;
use crate::error::Place;
use crate::geometry::{single, srgb_decode};

/// The meaning of the numbers of vertices or faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Normals,
    Coordinates,
    Colors,
    /// Colours that are at most 1, as glTF has them.
    Albedos,
}

/// Colours from here on are garbage, as coordinates are: their products would leave the range of float32.
const TOO_BRIGHT: f32 = 1e30;

impl Kind {
    /// The replacement of an unusable value.
    fn mended<const N: usize>(self, value: [f32; N]) -> [f32; N] {
        match self {
            // A normal without a length is the triangle's own.
            Self::Normals | Self::Coordinates => {
                let is_usable = value.iter().all(|x| x.is_finite());
                if is_usable { value } else { [0.0; N] }
            }
            Self::Colors => value.map(|level| {
                if level < 0.0 {
                    0.0
                } else if level < TOO_BRIGHT {
                    level
                } else {
                    1.0
                }
            }),
            Self::Albedos => Self::Colors.mended(value).map(|level| level.min(1.0)),
        }
    }

    /// The key of the warning, the name of the values, and the name of their replacement.
    fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Normals => (
                "bad normals",
                "normals that are not finite",
                "the triangles' own are taken",
            ),
            Self::Coordinates => (
                "bad texture coordinates",
                "texture coordinates that are not finite",
                "0 is taken",
            ),
            Self::Colors => (
                "bad colours",
                "colours that are negative, not finite or not below 1e30",
                "0 is taken for negative levels, 1 for the others",
            ),
            Self::Albedos => (
                "bad colours",
                "colours that are not from 0 to 1",
                "0 is taken for negative levels, 1 for the others",
            ),
        }
    }
}

/// The linear value of a level that is encoded as sRGB.
pub(super) fn linear(encoded: f64) -> f32 {
    if encoded.is_finite() && encoded >= 0.0 {
        single(srgb_decode(encoded))
    } else {
        // Not a colour: told, and replaced, where all are there.
        single(encoded)
    }
}

/// Puts harmless values in the place of unusable ones; how many there are and which one is the first is one
/// warning.
pub(super) fn mend<const N: usize>(
    values: &mut [[f32; N]],
    kind: Kind,
    place: &Place,
    report: &mut Report,
) {
    let (mut count, mut first) = (0_u64, 0);
    for (index, value) in values.iter_mut().enumerate() {
        let mended = kind.mended(*value);
        // Not equal to itself is NaN; -0 may stay.
        if mended != *value {
            *value = mended;
            if count == 0 {
                first = index;
            }
            count += 1;
        }
    }
    if count > 0 {
        let (key, name, instead) = kind.words();
        report.warn(key, place, || {
            format!("{name}: {count}, the first at index {first}; {instead}")
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::LoadSettings;

    #[test]
    fn numbers_that_are_none_are_replaced_and_counted() {
        let mut report = Report::new("x".as_ref(), LoadSettings::default());
        let mut colors = [
            [0.5, -0.0, 1.0],
            [f32::NAN, -5.0, f32::INFINITY],
            [f32::NEG_INFINITY, 1e30, 2.0],
        ];
        mend(&mut colors, Kind::Colors, &Place::File, &mut report);
        assert_eq!(colors, [[0.5, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 2.0]]);
        let mut normals = [[0.0, 0.0, 1.0], [0.0, f32::NAN, 1.0]];
        mend(&mut normals, Kind::Normals, &Place::File, &mut report);
        assert_eq!(normals, [[0.0, 0.0, 1.0], [0.0; 3]]);
        let mut uvs = [[1e38, -3.0]];
        mend(&mut uvs, Kind::Coordinates, &Place::File, &mut report);
        let lines = report.take_lines();
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!(lines[0].contains(": 2, the first at index 1;"), "{lines:?}");
    }
}
