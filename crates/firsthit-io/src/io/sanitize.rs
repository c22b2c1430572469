//! Replaces unusable normals, texture coordinates and colours, so that a NaN does not spread over a
//! picture.

use super::report::Report;
use crate::error::Place;
use crate::geometry::{single, srgb_decode, srgb_encode};

/// The meaning of the numbers of vertices or faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ValueKind {
    Normals,
    Coordinates,
    /// Linear, from 0 to 1.
    Colors,
}

impl ValueKind {
    /// The replacement of an unusable value.
    fn sanitized<const N: usize>(self, value: [f32; N]) -> [f32; N] {
        match self {
            // A normal without a length is the triangle's own.
            Self::Normals | Self::Coordinates => {
                let is_usable = value.iter().all(|x| x.is_finite());
                if is_usable { value } else { [0.0; N] }
            }
            // `min` takes 1 for a NaN.
            Self::Colors => value.map(|level| if level < 0.0 { 0.0 } else { level.min(1.0) }),
        }
    }

    /// The key of the warning, the name of the values, and the name of their replacement.
    fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Normals => {
                ("bad normals", "normals that are not finite", "the triangles' own are taken")
            }
            Self::Coordinates => {
                ("bad texture coordinates", "texture coordinates that are not finite", "0 is taken")
            }
            Self::Colors => (
                "bad colours",
                "colours that are not from 0 to 1",
                "0 is taken for negative levels, 1 for the others",
            ),
        }
    }
}

/// The linear value of a level that is encoded as sRGB. A level outside 0 to 1 stays as it is:
/// [`sanitize_levels`] tells what it means.
pub(super) fn linear(encoded: f64) -> f32 {
    if (0.0..=1.0).contains(&encoded) { single(srgb_decode(encoded)) } else { single(encoded) }
}

/// Mends colours whose levels came through [`linear`]. Levels above 1 say that a file counts from 0
/// to 255, which is a warning.
pub(super) fn sanitize_levels(values: &mut [[f32; 3]], report: &mut Report) {
    let levels = values.iter().flatten().filter(|level| level.is_finite());
    let largest = levels.fold(0.0_f32, |most, &level| most.max(level));
    if (2.0..=255.0).contains(&largest) {
        report.warn("levels", &Place::File, || {
            format!("colours reach {largest}: they are taken to be from 0 to 255, not from 0 to 1")
        });
        levels_of_bytes(values);
    }
    sanitize(values, ValueKind::Colors, &Place::File, report);
}

/// Makes levels that count from 0 to 255, and came through [`linear`], what they are.
pub(super) fn levels_of_bytes(values: &mut [[f32; 3]]) {
    let levels = values.iter_mut().flatten();
    for level in levels.filter(|level| **level >= 0.0) {
        let read = f64::from(*level);
        let encoded = if read > 1.0 { read } else { srgb_encode(read) };
        *level = linear(encoded / 255.0);
    }
}

/// Puts harmless values in the place of unusable ones; how many there are and which one is the
/// first is one warning.
pub(super) fn sanitize<const N: usize>(
    values: &mut [[f32; N]],
    kind: ValueKind,
    place: &Place,
    report: &mut Report,
) {
    let (mut count, mut first) = (0_u64, 0);
    for (index, value) in values.iter_mut().enumerate() {
        let sanitized = kind.sanitized(*value);
        // Not equal to itself is NaN; -0 may stay.
        if sanitized != *value {
            *value = sanitized;
            if count == 0 {
                first = index;
            }
            count += 1;
        }
    }
    if count > 0 {
        let (key, name, instead) = kind.words();
        report
            .warn(key, place, || format!("{name}: {count}, the first at index {first}; {instead}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::LoadSettings;

    #[test]
    fn numbers_that_are_none_are_replaced_and_counted() {
        let mut report = Report::new("x".as_ref(), LoadSettings::default(), &());
        let mut colors =
            [[0.5, -0.0, 1.0], [f32::NAN, -5.0, f32::INFINITY], [f32::NEG_INFINITY, 1e30, 2.0]];
        sanitize(&mut colors, ValueKind::Colors, &Place::File, &mut report);
        assert_eq!(colors, [[0.5, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
        let mut normals = [[0.0, 0.0, 1.0], [0.0, f32::NAN, 1.0]];
        sanitize(&mut normals, ValueKind::Normals, &Place::File, &mut report);
        assert_eq!(normals, [[0.0, 0.0, 1.0], [0.0; 3]]);
        let mut uvs = [[1e38, -3.0]];
        sanitize(&mut uvs, ValueKind::Coordinates, &Place::File, &mut report);
        let lines = report.take_lines();
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!(lines[0].contains(": 2, the first at index 1;"), "{lines:?}");
    }
}
