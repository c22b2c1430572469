//! Beams in CSV. The text is untrusted: no count in it sizes an allocation.

// A reader that panics is a reader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

use std::path::Path;

use super::Pattern;
use crate::error::{Error, Place, Result};
use crate::memory;

/// The columns by their names; the first two must be there.
const NAMES: [&str; 4] = ["azimuth", "elevation", "time", "ring"];

/// The number of each column, where there is one, in the order of the names.
type Places = [Option<usize>; 4];

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
    let empty = || wrong(None, "there are no beams in it".to_owned());
    let (number, header) = lines.next().ok_or_else(empty)?;
    let places = places_in(header).map_err(|what| wrong(Some(number), what))?;
    let (mut azimuths, mut elevations) = (Vec::new(), Vec::new());
    let (mut times, mut rings) = (Vec::new(), Vec::new());
    for (number, line) in lines {
        let values = values_in(line, &places).map_err(|what| wrong(Some(number), what))?;
        let [azimuth, elevation, time, ring] = values;
        let full = |_| memory::no_room_for("beams");
        for (list, value) in
            [(&mut azimuths, azimuth), (&mut elevations, elevation), (&mut times, time)]
        {
            list.try_reserve(1).map_err(full)?;
            list.push(value);
        }
        let ring = whole(ring).ok_or_else(|| {
            let what = format!("ring must be a whole number from 0 on, got {ring}");
            wrong(Some(number), what)
        })?;
        rings.try_reserve(1).map_err(full)?;
        rings.push(ring);
    }
    if azimuths.is_empty() {
        return Err(empty());
    }
    Pattern::table(&azimuths, &elevations, &times, &rings)
}

/// The indices of the columns.
fn places_in(header: &str) -> std::result::Result<Places, String> {
    let mut places: Places = [None; 4];
    for (column, field) in header.split(',').enumerate() {
        let field = field.trim().trim_end_matches("_deg");
        let of_name = NAMES.iter().zip(&mut places);
        for (name, place) in of_name.filter(|(name, _)| field.eq_ignore_ascii_case(name)) {
            if place.replace(column).is_some() {
                return Err(format!("two columns are called {name}"));
            }
        }
    }
    let mut needed = NAMES.iter().zip(&places).take(2);
    match needed.find(|(_, place)| place.is_none()) {
        Some((name, _)) => Err(format!("expected a column {name}, in degrees")),
        None => Ok(places),
    }
}

/// The numbers of a line, in the order of the names; zero for a column that there is not.
fn values_in(line: &str, places: &Places) -> std::result::Result<[f64; 4], String> {
    let mut values = [0.0; 4];
    for ((name, place), value) in NAMES.iter().zip(places).zip(&mut values) {
        let Some(column) = *place else {
            continue;
        };
        let field = line.split(',').nth(column).map(str::trim);
        let parsed = field.and_then(|field| field.parse::<f64>().ok());
        *value = parsed.filter(|value| value.is_finite()).ok_or_else(|| {
            let shown = |field: &str| format!("{:?}", field.chars().take(40).collect::<String>());
            let got = field.map_or("nothing".to_owned(), shown);
            format!("{name} must be a number, got {got}")
        })?;
    }
    Ok(values)
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
            ("azimuth\n1\n", "beams.csv:1: expected a column elevation, in degrees"),
            ("azimuth,elevation\n1,2\n1\n", "beams.csv:3: elevation must be a number, got nothing"),
            ("azimuth,elevation\n1,nan\n", "beams.csv:2: elevation must be a number, got \"nan\""),
            (
                "azimuth,elevation,ring\n1,2,0.5\n",
                "beams.csv:2: ring must be a whole number from 0 on, got 0.5",
            ),
            ("azimuth,azimuth,elevation\n1,2,3\n", "beams.csv:1: two columns are called azimuth"),
        ] {
            assert_eq!(pattern(text).unwrap_err().to_string(), said);
        }
    }
}
