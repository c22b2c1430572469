//! Lasers above one another on a head that turns.

use super::Pattern;
use super::pattern::{Beam, check_list};
use crate::error::Result;
use crate::geometry::{named, require};

named! {
    /// The direction of a head's rotation, seen from above.
    pub enum Turn, "direction":
    /// The head turns from the left to forwards to the right.
    #[default]
    "clockwise" => Clockwise;
    /// The head turns from the right to forwards to the left.
    "counterclockwise" => Counterclockwise;
}

/// A head with lasers above one another that turns about z.
///
/// Rows are lasers, the highest first; columns are firings, in the order of time. The head turns
/// from `azimuth_start` to `azimuth_end`; where these are the same direction, it turns once around.
/// With n columns and a turn of s degrees, column k fires at `azimuth_start ± s k / n`, at the time
/// `start + s / 360 / rate * k / n`. A laser that fires later than the column does so where the
/// head then is.
///
/// ```
/// use firsthit::sensor::{Pattern, Spinning};
///
/// let head = Spinning { elevations: vec![-10.0, 10.0], columns: 360, ..Spinning::default() };
/// let pattern = Pattern::spinning(&head)?;
/// assert_eq!(pattern.shape(), [2, 360]);
/// assert_eq!(pattern.rings()[..360], [1; 360]);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spinning {
    /// The elevation of each laser in degrees; a laser's number is its place here.
    pub elevations: Vec<f64>,
    /// The number of firings of each laser.
    pub columns: usize,
    /// The azimuth of the first column, in degrees to the left from forwards.
    pub azimuth_start: f64,
    /// The azimuth at which the turn ends; the last column is one step before.
    pub azimuth_end: f64,
    /// The direction of rotation.
    pub direction: Turn,
    /// Turns in a second; zero for a head that stands still in time: all columns are at once.
    pub rate: f64,
    /// The time of the first column, in seconds.
    pub start: f64,
    /// The angle of each laser to the left of the column, in degrees. Empty for zeros.
    pub azimuth_offsets: Vec<f64>,
    /// The delay of each laser after the column, in seconds. Empty for zeros.
    pub firing_offsets: Vec<f64>,
}

impl Default for Spinning {
    /// One level laser, which turns once around, clockwise from behind, in 1024 steps.
    fn default() -> Self {
        Self {
            elevations: vec![0.0],
            columns: 1024,
            azimuth_start: 180.0,
            azimuth_end: -180.0,
            direction: Turn::Clockwise,
            rate: 10.0,
            start: 0.0,
            azimuth_offsets: Vec::new(),
            firing_offsets: Vec::new(),
        }
    }
}

impl Pattern {
    /// The beams of a head that turns.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for no lasers or columns, elevations
    /// beyond 90 degrees, a rate below zero, numbers that are not finite, and lists of other
    /// lengths.
    pub fn spinning(head: &Spinning) -> Result<Self> {
        let sign = match head.direction {
            Turn::Clockwise => -1.0,
            Turn::Counterclockwise => 1.0,
        };
        let turned = (sign * (head.azimuth_end - head.azimuth_start)).rem_euclid(360.0);
        let turned = if turned == 0.0 { 360.0 } else { turned };
        Self::turned("spinning", head, turned)
    }

    /// The pattern of a spinning head that turns by `turned` degrees.
    pub(super) fn turned(name: &str, head: &Spinning, turned: f64) -> Result<Self> {
        let lasers = head.elevations.len();
        require("elevations", "at least one", lasers > 0, lasers)?;
        for &elevation in &head.elevations {
            let fine = (-90.0..=90.0).contains(&elevation);
            require("elevations", "from -90 to 90 degrees", fine, elevation)?;
        }
        let fine = head.rate >= 0.0 && head.rate.is_finite();
        require("rate", "finite and not negative", fine, head.rate)?;
        for (name, number) in [
            ("azimuth_start", head.azimuth_start),
            ("azimuth_end", head.azimuth_end),
            ("start", head.start),
        ] {
            require(name, "finite", number.is_finite(), number)?;
        }
        check_list("azimuth_offsets", &head.azimuth_offsets, lasers)?;
        check_list("firing_offsets", &head.firing_offsets, lasers)?;
        let mut order: Vec<usize> = (0..lasers).collect();
        // Stable: of equal elevations the lower number is the upper row.
        order.sort_by(|&a, &b| head.elevations[b].total_cmp(&head.elevations[a]));
        let sign = match head.direction {
            Turn::Clockwise => -1.0,
            Turn::Counterclockwise => 1.0,
        };
        let of = |list: &[f64], laser: usize| list.get(laser).copied().unwrap_or(0.0);
        let duration = if head.rate > 0.0 { turned / 360.0 / head.rate } else { 0.0 };
        let parameters = [
            ("azimuth_start", head.azimuth_start),
            ("azimuth_turned", sign * turned),
            ("rate", head.rate),
            ("start", head.start),
        ];
        Self::of(name, [lasers, head.columns], &parameters, |row, column| {
            let laser = order[row];
            let later = of(&head.firing_offsets, laser);
            let share = column as f64 / head.columns as f64;
            let head_turned = turned * share + 360.0 * head.rate * later;
            Beam {
                azimuth: head.azimuth_start + sign * head_turned + of(&head.azimuth_offsets, laser),
                elevation: head.elevations[laser],
                time: head.start + duration * share + later,
                ring: i32::try_from(laser).unwrap_or(i32::MAX),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_goes_its_own_way_and_takes_its_time() {
        let head = Spinning {
            columns: 4,
            azimuth_start: 60.0,
            azimuth_end: -60.0,
            rate: 2.0,
            start: 1.0,
            ..Spinning::default()
        };
        let right = Pattern::spinning(&head).unwrap();
        assert_eq!(right.azimuths(), [60.0, 30.0, 0.0, -30.0]);
        // A third of half a second.
        assert!((right.times()[2] - 1.0 - 1.0 / 12.0).abs() < 1e-15);
        let left = Spinning { direction: Turn::Counterclockwise, ..head.clone() };
        let left = Pattern::spinning(&left).unwrap();
        assert_eq!(left.azimuths(), [60.0, 120.0, 180.0, 240.0]);
        let once = Spinning { azimuth_end: 60.0, ..head };
        let once = Pattern::spinning(&once).unwrap();
        assert_eq!(once.azimuths(), [60.0, -30.0, -120.0, -210.0]);
    }

    #[test]
    fn a_laser_that_fires_later_points_where_the_head_then_is() {
        let head = Spinning {
            elevations: vec![1.0, 1.0],
            columns: 1,
            azimuth_start: 0.0,
            rate: 10.0,
            azimuth_offsets: vec![0.0, 2.0],
            firing_offsets: vec![0.0, 1e-3],
            ..Spinning::default()
        };
        let pattern = Pattern::spinning(&head).unwrap();
        assert!((pattern.azimuths()[1] - (2.0 - 3.6)).abs() < 1e-12);
        assert_eq!(pattern.times(), [0.0, 1e-3]);
    }
}
