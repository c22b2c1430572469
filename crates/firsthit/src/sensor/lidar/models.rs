//! Laser scanners by their makers' names.

use super::spinning::Spinning;
use super::{Pattern, Turn};
use crate::error::Result;
use crate::geometry::{named, require_positive};

named! {
    /// Spinning scanners whose beams their makers publish.
    ///
    /// Laser numbers are the makers'. The heads turn clockwise. Times and angles are nominal: those of one device are in its own
    /// calibration, and [`Spinning`] takes them.
    pub enum LidarModel, "lidar model":
    /// Velodyne VLP-16 (Puck): User Manual 63-9243, sections 9.3 and 9.4.
    #[default]
    "vlp-16" => Vlp16;
    /// Velodyne HDL-32E: User Manual 63-9113, section on the laser firing sequence.
    "hdl-32e" => Hdl32e;
    /// Velodyne VLP-32C (Ultra Puck): User Manual 63-9325, tables 9-2 and 9-6, section 9.4.
    "vlp-32c" => Vlp32c;
    /// Ouster OS0 with 32 uniform beams over 90 degrees: data sheet.
    "os0-32" => Os0x32;
    /// Ouster OS0 with 64 beams.
    "os0-64" => Os0x64;
    /// Ouster OS0 with 128 beams.
    "os0-128" => Os0x128;
    /// Ouster OS1 with 32 uniform beams over 45 degrees: data sheet.
    "os1-32" => Os1x32;
    /// Ouster OS1 with 64 beams.
    "os1-64" => Os1x64;
    /// Ouster OS1 with 128 beams.
    "os1-128" => Os1x128;
    /// Ouster OS2 with 32 uniform beams over 22.5 degrees: data sheet.
    "os2-32" => Os2x32;
    /// Ouster OS2 with 64 beams.
    "os2-64" => Os2x64;
    /// Ouster OS2 with 128 beams.
    "os2-128" => Os2x128;
}

/// The elevation of each laser of the VLP-16: the even numbers are the lower half.
const VLP_16: [f64; 16] = [
    -15.0, 1.0, -13.0, 3.0, -11.0, 5.0, -9.0, 7.0, -7.0, 9.0, -5.0, 11.0, -3.0, 13.0, -1.0, 15.0,
];

/// Those of the HDL-32E. Early prints of the manual cut -6.67 and -26.67 to -6.66 and -26.66.
const HDL_32E: [f64; 32] = [
    -30.67, -9.33, -29.33, -8.0, -28.0, -6.67, -26.67, -5.33, -25.33, -4.0, -24.0, -2.67, -22.67,
    -1.33, -21.33, 0.0, -20.0, 1.33, -18.67, 2.67, -17.33, 4.0, -16.0, 5.33, -14.67, 6.67, -13.33,
    8.0, -12.0, 9.33, -10.67, 10.67,
];

/// The elevation and the azimuth offset of each laser of the VLP-32C. Offsets are clockwise, as the manual counts azimuths.
const VLP_32C: [[f64; 2]; 32] = [
    [-25.0, 1.4],
    [-1.0, -4.2],
    [-1.667, 1.4],
    [-15.639, -1.4],
    [-11.31, 1.4],
    [0.0, -1.4],
    [-0.667, 4.2],
    [-8.843, -1.4],
    [-7.254, 1.4],
    [0.333, -4.2],
    [-0.333, 1.4],
    [-6.148, -1.4],
    [-5.333, 4.2],
    [1.333, -1.4],
    [0.667, 4.2],
    [-4.0, -1.4],
    [-4.667, 1.4],
    [1.667, -4.2],
    [1.0, 1.4],
    [-3.667, -4.2],
    [-3.333, 4.2],
    [3.333, -1.4],
    [2.333, 1.4],
    [-2.667, -1.4],
    [-3.0, 1.4],
    [7.0, -1.4],
    [4.667, 1.4],
    [-2.333, -4.2],
    [-2.0, 4.2],
    [15.0, -1.4],
    [10.333, 1.4],
    [-1.333, -1.4],
];

/// The columns of an Ouster where nobody says: its mode 1024x10.
const OUSTER_COLUMNS: usize = 1024;

/// Lasers, and how they fire.
struct Lasers {
    elevations: Vec<f64>,
    azimuth_offsets: Vec<f64>,
    firing_offsets: Vec<f64>,
    /// Seconds from one firing of all lasers to the next, where the device has a clock of its own.
    cycle: Option<f64>,
}

impl LidarModel {
    /// The beams of one turn, clockwise from behind, at so many turns a second. Without `columns` the lasers fire as often as they
    /// do: a Velodyne's by its clock, so that its last column is up to a firing short of a whole turn; an Ouster's 1024 times. With
    /// `columns` the firings are spread evenly over the turn.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) for a `rate` that is not positive, a `start` that is not finite, no columns,
    /// and a head that turns faster than its lasers fire.
    pub fn pattern(self, rate: f64, columns: Option<usize>, start: f64) -> Result<Pattern> {
        require_positive("rate", rate)?;
        let lasers = self.lasers();
        let mut turned = 360.0;
        let columns = match (columns, lasers.cycle) {
            (Some(columns), _) => columns,
            (None, None) => OUSTER_COLUMNS,
            (None, Some(cycle)) => {
                let firings = firings_of(1.0 / (rate * cycle));
                turned = 360.0 * rate * cycle * firings as f64;
                firings
            }
        };
        let head = Spinning {
            elevations: lasers.elevations,
            columns,
            direction: Turn::Clockwise,
            rate,
            start,
            azimuth_offsets: lasers.azimuth_offsets,
            firing_offsets: lasers.firing_offsets,
            ..Spinning::default()
        };
        Pattern::turned(self.name(), &head, turned)
    }

    fn lasers(self) -> Lasers {
        let every = |seconds: f64, lasers: usize, together: usize| {
            let times = (0..lasers).map(|laser| seconds * (laser / together) as f64);
            times.collect::<Vec<f64>>()
        };
        match self {
            Self::Vlp16 => Lasers {
                elevations: VLP_16.to_vec(),
                azimuth_offsets: Vec::new(),
                firing_offsets: every(2.304e-6, 16, 1),
                cycle: Some(55.296e-6),
            },
            Self::Hdl32e => Lasers {
                elevations: HDL_32E.to_vec(),
                azimuth_offsets: Vec::new(),
                firing_offsets: every(1.152e-6, 32, 1),
                cycle: Some(46.080e-6),
            },
            // Two lasers at a time.
            Self::Vlp32c => Lasers {
                elevations: VLP_32C.iter().map(|&[elevation, _]| elevation).collect(),
                azimuth_offsets: VLP_32C.iter().map(|&[_, offset]| -offset).collect(),
                firing_offsets: every(2.304e-6, 32, 2),
                cycle: Some(55.296e-6),
            },
            Self::Os0x32 => uniform(90.0, 32),
            Self::Os0x64 => uniform(90.0, 64),
            Self::Os0x128 => uniform(90.0, 128),
            Self::Os1x32 => uniform(45.0, 32),
            Self::Os1x64 => uniform(45.0, 64),
            Self::Os1x128 => uniform(45.0, 128),
            Self::Os2x32 => uniform(22.5, 32),
            Self::Os2x64 => uniform(22.5, 64),
            Self::Os2x128 => uniform(22.5, 128),
        }
    }
}

/// So many lasers that fire together, from the upper edge of a field of view to the lower one.
fn uniform(degrees: f64, lasers: u32) -> Lasers {
    let step = degrees / f64::from(lasers - 1);
    let elevations = (0..lasers).map(|laser| degrees / 2.0 - step * f64::from(laser));
    Lasers {
        elevations: elevations.collect(),
        azimuth_offsets: Vec::new(),
        firing_offsets: Vec::new(),
        cycle: None,
    }
}

/// How many whole firings there are.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive, and what is too large for memory is refused later"
)]
fn firings_of(quotient: f64) -> usize {
    quotient.floor() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_has_its_lasers_from_the_top_down_and_each_laser_once() {
        for &model in LidarModel::ALL {
            let pattern = model.pattern(10.0, None, 0.0).unwrap();
            let [rows, columns] = pattern.shape();
            let lasers: usize = model
                .name()
                .rsplit('-')
                .next()
                .unwrap()
                .trim_end_matches(['c', 'e'])
                .parse()
                .unwrap();
            assert_eq!(rows, lasers, "{}", model.name());
            let first: Vec<f64> = (0..rows)
                .map(|row| pattern.elevations()[row * columns])
                .collect();
            assert!(first.windows(2).all(|pair| pair[0] > pair[1]), "{first:?}");
            let mut rings: Vec<i32> = (0..rows)
                .map(|row| pattern.rings()[row * columns])
                .collect();
            rings.sort_unstable();
            assert!((0..).zip(&rings).all(|(k, &ring)| k == ring));
        }
    }

    #[test]
    fn the_lasers_of_the_vlp_16_and_the_hdl_32e_are_evenly_spaced() {
        for (mut elevations, step) in [(VLP_16.to_vec(), 2.0), (HDL_32E.to_vec(), 4.0 / 3.0)] {
            elevations.sort_by(f64::total_cmp);
            for pair in elevations.windows(2) {
                // The manual has two decimals.
                assert!((pair[1] - pair[0] - step).abs() < 0.011, "{pair:?}");
            }
        }
    }

    #[test]
    fn a_turn_of_the_vlp_16_takes_its_clock() {
        let pattern = LidarModel::Vlp16.pattern(10.0, None, 0.0).unwrap();
        let [_, columns] = pattern.shape();
        // 100 ms of 55.296 us, as the manual has it: 1808.4.
        assert_eq!(columns, 1808);
        // Laser 15 is the top row, and fires last.
        assert!((pattern.times()[0] - 15.0 * 2.304e-6).abs() < 1e-18);
        assert!((pattern.times()[1] - pattern.times()[0] - 55.296e-6).abs() < 1e-15);
        let step = pattern.azimuths()[0] - pattern.azimuths()[1];
        // 0.2 degrees at 600 turns a minute, says the manual.
        assert!((step - 0.199_065_6).abs() < 1e-9, "{step}");
    }
}
