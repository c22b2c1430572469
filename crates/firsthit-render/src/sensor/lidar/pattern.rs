//! The directions and times of beams.

use std::collections::BTreeMap;
use std::path::Path;

use super::csv;
use crate::error::{Error, Result};
use crate::geometry::summary::summary;
use crate::geometry::{DVec3, require};
use crate::memory;

/// The beams of a laser scanner in rows and columns: which way each goes in the scanner's frame,
/// when, and of which laser it is.
///
/// Angles are in degrees. The azimuth counts from forwards (x) to the left (y): counter-clockwise,
/// seen from above. The elevation counts from the horizontal plane upwards (z). Times are in
/// seconds.
#[derive(Clone, PartialEq)]
pub struct Pattern {
    name: String,
    parameters: BTreeMap<String, f64>,
    shape: [usize; 2],
    azimuths: Vec<f64>,
    elevations: Vec<f64>,
    directions: Vec<DVec3>,
    times: Vec<f64>,
    rings: Vec<i32>,
}

summary!(Pattern, "Pattern", |it| "name": it.name, "shape": it.shape);

/// A beam, as patterns are made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Beam {
    pub(super) azimuth: f64,
    pub(super) elevation: f64,
    pub(super) time: f64,
    pub(super) ring: i32,
}

/// The most beams of a pattern, whose tables then are 3.5 GB: more are a mistake.
const MOST: usize = 1 << 26;

impl Pattern {
    /// The beams of `[rows, columns]`, one after the other, row by row from the top.
    pub(super) fn of(
        name: &str,
        [rows, columns]: [usize; 2],
        parameters: &[(&str, f64)],
        beam: impl Fn(usize, usize) -> Beam,
    ) -> Result<Self> {
        require("rows", "at least 1", rows >= 1, rows)?;
        require("columns", "at least 1", columns >= 1, columns)?;
        let count = rows.saturating_mul(columns);
        require("beams", "at most 2^26", count <= MOST, count)?;
        let mut made = Self {
            name: name.to_owned(),
            parameters: parameters.iter().map(|&(name, value)| (name.to_owned(), value)).collect(),
            shape: [rows, columns],
            azimuths: memory::filled(count, 0.0)?,
            elevations: memory::filled(count, 0.0)?,
            directions: memory::filled(count, DVec3::X)?,
            times: memory::filled(count, 0.0)?,
            rings: memory::filled(count, 0)?,
        };
        for pixel in 0..count {
            let beam = beam(pixel / columns, pixel % columns);
            let numbers =
                [("azimuth", beam.azimuth), ("elevation", beam.elevation), ("time", beam.time)];
            for (name, number) in numbers {
                // Beyond this, degrees and seconds have no digits left after the point.
                require(name, "finite, within 1e12", number.abs() <= 1e12, number)?;
            }
            made.azimuths[pixel] = beam.azimuth;
            made.elevations[pixel] = beam.elevation;
            made.directions[pixel] = direction_of(beam.azimuth, beam.elevation);
            made.times[pixel] = beam.time;
            made.rings[pixel] = beam.ring;
        }
        Ok(made)
    }

    /// Beams from a table: one row of pixels, in the table's order. `times` and `rings` may be
    /// empty, for zeros.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for lists of other lengths, none at all, and numbers that are not
    /// finite.
    pub fn table(
        azimuths: &[f64],
        elevations: &[f64],
        times: &[f64],
        rings: &[i32],
    ) -> Result<Self> {
        let count = azimuths.len();
        let lengths = [
            ("elevations", elevations.len(), false),
            ("times", times.len(), true),
            ("rings", rings.len(), true),
        ];
        for (name, length, may_be_empty) in lengths {
            let fine = length == count || (may_be_empty && length == 0);
            require(name, "as many as azimuths", fine, length)?;
        }
        Self::of("table", [1, count], &[], |_, k| Beam {
            azimuth: azimuths[k],
            elevation: elevations[k],
            time: times.get(k).copied().unwrap_or(0.0),
            ring: rings.get(k).copied().unwrap_or(0),
        })
    }

    /// Beams from CSV with a header, which names the columns `azimuth` and `elevation` (degrees)
    /// and, where there are some, `time` (seconds) and `ring` (a whole number). `path` is what
    /// errors call the text.
    ///
    /// ```
    /// use std::path::Path;
    ///
    /// use firsthit::sensor::Pattern;
    ///
    /// let pattern = Pattern::read_csv(b"azimuth,elevation\n0,0\n90,0\n", Path::new("beams.csv"))?;
    /// assert_eq!(pattern.shape(), [1, 2]);
    /// assert!((pattern.direction(1).y - 1.0).abs() < 1e-15);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Parse`] with the line for what is wrong in the text, [`Error::Limit`] when memory
    /// is short.
    pub fn read_csv(text: &[u8], path: &Path) -> Result<Self> {
        csv::read(text, path)
    }

    /// The source of the pattern: the name of a model or of a kind.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The numbers that it was made from, by name.
    pub fn parameters(&self) -> &BTreeMap<String, f64> {
        &self.parameters
    }

    /// Rows and columns.
    pub fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// The azimuths in degrees, row by row.
    pub fn azimuths(&self) -> &[f64] {
        &self.azimuths
    }

    /// The elevations in degrees, row by row.
    pub fn elevations(&self) -> &[f64] {
        &self.elevations
    }

    /// The directions in the scanner's frame, of length one, row by row.
    pub fn directions(&self) -> &[DVec3] {
        &self.directions
    }

    /// The times in seconds, row by row.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The number of each beam's laser, row by row.
    pub fn rings(&self) -> &[i32] {
        &self.rings
    }

    /// The direction of a pixel's beam in the scanner's frame, of length one.
    ///
    /// # Panics
    ///
    /// For a pixel that there is not.
    pub fn direction(&self, pixel: usize) -> DVec3 {
        self.directions[pixel]
    }
}

/// The direction of length one at an azimuth and an elevation, in degrees.
fn direction_of(azimuth: f64, elevation: f64) -> DVec3 {
    let (sine, cosine) = sincos_degrees(azimuth);
    let (up, level) = sincos_degrees(elevation);
    DVec3::new(level * cosine, level * sine, up)
}

/// Sine and cosine of degrees, exact at multiples of 90.
fn sincos_degrees(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    // Without rounding: the difference of numbers that are near each other.
    let rest = degrees - 90.0 * quarters;
    let (sine, cosine) = libm::sincos(rest.to_radians());
    match quarters.rem_euclid(4.0) {
        0.0 => (sine, cosine),
        1.0 => (cosine, -sine),
        2.0 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// A list with an entry for each laser, or an empty one, which stands for zeros.
pub(super) fn check_list(name: &'static str, list: &[f64], lasers: usize) -> Result<()> {
    if list.is_empty() || list.len() == lasers {
        return Ok(());
    }
    let got = format!("{} for {lasers} lasers", list.len());
    Err(Error::argument(name, "one for each laser, or none", got))
}
