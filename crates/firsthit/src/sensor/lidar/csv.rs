//! Beams in CSV. The text is untrusted: no count in it sizes an allocation.

// A reader that panics is a reader that a file can crash.
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::indexing_slicing
    )
)]

use std::path::Path;

use super::Pattern;
use crate::error::{Error, Place, Result};
use crate::memory;

/// The columns by their names; the first two must be there.
const NAMES: [&str; 4] = ["azimuth", "elevation", "time", "ring"];

/// See [`Pattern::read_csv`].
pub(super) fn read(text: &[u8], path: &Path) -> Result<Pattern> {
    let wrong = |line: Option<u64>, what: String| Error::Parse {
        path: path.to_owned(),
        place: line.map_or(Place::File, Place::Line),
        what,
    };
    let text = std::str::from_utf8(text).map_err(|_| wrong(None, "not UTF-8".to_owned()))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = (1..).zip(text.lines());
    let mut lines = lines.filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let Some((number, header)) = lines.next() else {
        return Err(wrong(None, "there are no beams in it".to_owned()));
    };
    let mut places: [Option<usize>; 4] = [None; 4];
    for (column, field) in header.split(',').enumerate() {
        let field = field.trim().trim_end_matches("_deg");
        let of_name = NAMES.iter().zip(&mut places);
        for (name, place) in of_name.filter(|(name, _)| field.eq_ignore_ascii_case(name)) {
            if place.replace(column).is_some() {
                return Err(wrong(
                    Some(number),
                    format!("two columns are called {name}"),
                ));
            }
        }
    }
    for (name, place) in NAMES.iter().zip(&places).take(2) {
        if place.is_none() {
            let what = format!("expected a column {name}, in degrees");
            return Err(wrong(Some(number), what));
        }
    }
    let (mut azimuths, mut elevations) = (Vec::new(), Vec::new());
    let (mut times, mut rings) = (Vec::new(), Vec::new());
    for (number, line) in lines {
        let mut values = [0.0; 4];
        let named = NAMES.iter().zip(&places).zip(&mut values);
        for ((name, place), value) in named {
            let Some(column) = *place else {
                continue;
            };
            let field = line.split(',').nth(column).map(str::trim);
            let parsed = field.and_then(|field| field.parse::<f64>().ok());
            let Some(parsed) = parsed.filter(|value| value.is_finite()) else {
                let got = field.map_or("nothing".to_owned(), |field| {
                    format!("{:?}", field.chars().take(40).collect::<String>())
                });
                return Err(wrong(
                    Some(number),
                    format!("{name} must be a number, got {got}"),
                ));
            };
            *value = parsed;
        }
        let [azimuth, elevation, time, ring] = values;
        let full = |_| memory::no_room_for("beams");
        for (list, value) in [
            (&mut azimuths, azimuth),
            (&mut elevations, elevation),
            (&mut times, time),
        ] {
            list.try_reserve(1).map_err(full)?;
            list.push(value);
        }
        let Some(ring) = whole(ring) else {
            let what = format!("ring must be a whole number from 0 on, got {ring}");
            return Err(wrong(Some(number), what));
        };
        rings.try_reserve(1).map_err(full)?;
        rings.push(ring);
    }
    if azimuths.is_empty() {
        return Err(wrong(None, "there are no beams in it".to_owned()));
    }
    Pattern::table(&azimuths, &elevations, &times, &rings)
}

/// A whole number that an int32 holds, from 0 on.
#[expect(clippy::cast_possible_truncation, reason = "it is within an int32")]
fn whole(value: f64) -> Option<i32> {
    let is_whole = value.fract() == 0.0 && (0.0..=f64::from(i32::MAX)).contains(&value);
    is_whole.then_some(value as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(text: &str) -> Result<Pattern> {
        read(text.as_bytes(), Path::new("beams.csv"))
    }

    #[test]
    fn columns_are_taken_by_their_names() {
        let text = "# from a calibration\nring, Elevation_deg,azimuth,other,time\n3,-1.5,90,x,0.25\n\n4,2,0,,1\n";
        let read = pattern(text).unwrap();
        assert_eq!(read.azimuths(), [90.0, 0.0]);
        assert_eq!(read.elevations(), [-1.5, 2.0]);
        assert_eq!(read.times(), [0.25, 1.0]);
        assert_eq!(read.rings(), [3, 4]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, said) in [
            ("", "beams.csv: there are no beams in it"),
            ("azimuth,elevation\n", "beams.csv: there are no beams in it"),
            (
                "azimuth\n1\n",
                "beams.csv:1: expected a column elevation, in degrees",
            ),
            (
                "azimuth,elevation\n1,2\n1\n",
                "beams.csv:3: elevation must be a number, got nothing",
            ),
            (
                "azimuth,elevation\n1,nan\n",
                "beams.csv:2: elevation must be a number, got \"nan\"",
            ),
            (
                "azimuth,elevation,ring\n1,2,0.5\n",
                "beams.csv:2: ring must be a whole number from 0 on, got 0.5",
            ),
            (
                "azimuth,azimuth,elevation\n1,2,3\n",
                "beams.csv:1: two columns are called azimuth",
            ),
        ] {
            assert_eq!(pattern(text).unwrap_err().to_string(), said);
        }
    }
}
