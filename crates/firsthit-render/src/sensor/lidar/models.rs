//! Laser scanners by their makers' names.

use super::spinning::Spinning;
use super::tables::{HDL_32E, OS1_64_GEN1, PANDAR_40P, PANDAR_64, VLP_16, VLP_16_HI_RES, VLP_32C};
use super::{Pattern, Turn};
use crate::error::Result;
use crate::geometry::{named, require_positive};

named! {
    /// Spinning scanners whose beams their makers publish.
    ///
    /// Laser numbers are the makers'. The heads turn clockwise. Times and angles are nominal: those
    /// of one device are in its own calibration, and [`Spinning`] takes them.
    pub enum LidarModel, "lidar model":
    /// Velodyne VLP-16 (Puck, Puck LITE): User Manual 63-9243, table 9-1, section 9.4.
    #[default]
    "vlp-16" => Vlp16;
    /// Velodyne Puck Hi-Res: the same manual.
    "vlp-16-hi-res" => Vlp16HiRes;
    /// Velodyne HDL-32E: User's Manual 63-9113, "Laser Firing Sequence" and appendix E.
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
    /// Ouster OS1-64 of the first generation: 64 beams over 33.2 degrees in four columns.
    "os1-64-gen1" => Os1x64Gen1;
    /// Ouster OS1 with 128 beams.
    "os1-128" => Os1x128;
    /// Ouster OS2 with 32 uniform beams over 22.5 degrees: data sheet.
    "os2-32" => Os2x32;
    /// Ouster OS2 with 64 beams.
    "os2-64" => Os2x64;
    /// Ouster OS2 with 128 beams.
    "os2-128" => Os2x128;
    /// Hesai Pandar 40P.
    "pandar40p" => Pandar40P;
    /// Hesai Pandar 64; not the E3X.
    "pandar64" => Pandar64;
}

/// The columns of an Ouster unless others are given: its mode 1024x10.
const OUSTER_COLUMNS: usize = 1024;

/// Seconds from firing to firing of a Pandar: 0.2 degrees at ten turns a second.
const PANDAR_CYCLE: f64 = 1.0 / 18_000.0;

/// Lasers, and how they fire.
#[derive(Default)]
struct Lasers {
    elevations: Vec<f64>,
    azimuth_offsets: Vec<f64>,
    firing_offsets: Vec<f64>,
    /// Seconds from one firing of all lasers to the next, where the device has a clock of its own.
    cycle: Option<f64>,
}

impl LidarModel {
    /// The beams of one turn, clockwise from behind, at `rate` turns a second. Without `columns`
    /// the lasers fire as often as they do: a Velodyne's and a Pandar's by its clock, so that its
    /// last column is up to a firing short of a whole turn; an Ouster's 1024 times. With `columns`
    /// the firings are spread evenly over the turn.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a `rate` that is not positive, a
    /// `start` that is not finite, no columns, and a head that turns faster than its lasers fire.
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
                firing_offsets: every(2.304e-6, 16, 1),
                cycle: Some(55.296e-6),
                ..Lasers::default()
            },
            Self::Vlp16HiRes => {
                Lasers { elevations: VLP_16_HI_RES.to_vec(), ..Self::Vlp16.lasers() }
            }
            Self::Hdl32e => Lasers {
                elevations: HDL_32E.to_vec(),
                firing_offsets: every(1.152e-6, 32, 1),
                cycle: Some(46.080e-6),
                ..Lasers::default()
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
            Self::Os1x64Gen1 => Lasers {
                azimuth_offsets: (0..64).map(|laser| -OS1_64_GEN1[laser % 4]).collect(),
                ..uniform(33.222, 64)
            },
            Self::Os1x128 => uniform(45.0, 128),
            Self::Os2x32 => uniform(22.5, 32),
            Self::Os2x64 => uniform(22.5, 64),
            Self::Os2x128 => uniform(22.5, 128),
            Self::Pandar40P => pandar(&PANDAR_40P),
            Self::Pandar64 => pandar(&PANDAR_64),
        }
    }
}

/// A number of lasers that fire together, from the upper edge of a field of view to the lower one.
fn uniform(degrees: f64, lasers: u32) -> Lasers {
    let step = degrees / f64::from(lasers - 1);
    let elevations = (0..lasers).map(|laser| degrees / 2.0 - step * f64::from(laser));
    Lasers { elevations: elevations.collect(), ..Lasers::default() }
}

/// Lasers by elevation, azimuth offset to the right, and microseconds before the end of the firing.
fn pandar(table: &[[f64; 3]]) -> Lasers {
    let first = table.iter().map(|&[.., before]| before).fold(0.0, f64::max);
    Lasers {
        elevations: table.iter().map(|&[elevation, ..]| elevation).collect(),
        azimuth_offsets: table.iter().map(|&[_, offset, _]| -offset).collect(),
        firing_offsets: table.iter().map(|&[.., before]| 1e-6 * (first - before)).collect(),
        cycle: Some(PANDAR_CYCLE),
    }
}

/// The number of whole firings; one that is missing by rounding alone is there.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive, and what is too large for memory is refused later"
)]
fn firings_of(quotient: f64) -> usize {
    (quotient + 1e-9).floor() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_has_its_lasers_from_the_top_down_and_each_laser_once() {
        for &model in LidarModel::ALL {
            let pattern = model.pattern(10.0, None, 0.0).unwrap();
            let [rows, columns] = pattern.shape();
            let lasers = match model {
                LidarModel::Vlp16 | LidarModel::Vlp16HiRes => 16,
                LidarModel::Hdl32e
                | LidarModel::Vlp32c
                | LidarModel::Os0x32
                | LidarModel::Os1x32
                | LidarModel::Os2x32 => 32,
                LidarModel::Pandar40P => 40,
                LidarModel::Os0x64
                | LidarModel::Os1x64
                | LidarModel::Os1x64Gen1
                | LidarModel::Os2x64
                | LidarModel::Pandar64 => 64,
                LidarModel::Os0x128 | LidarModel::Os1x128 | LidarModel::Os2x128 => 128,
            };
            assert_eq!(rows, lasers, "{}", model.name());
            let first: Vec<f64> =
                (0..rows).map(|row| pattern.elevations()[row * columns]).collect();
            assert!(first.windows(2).all(|pair| pair[0] > pair[1]), "{first:?}");
            let mut rings: Vec<i32> = (0..rows).map(|row| pattern.rings()[row * columns]).collect();
            rings.sort_unstable();
            assert!((0..).zip(&rings).all(|(k, &ring)| k == ring));
        }
    }

    #[test]
    fn the_lasers_of_the_vlp_16s_and_the_hdl_32e_are_evenly_spaced() {
        for (mut elevations, step) in [
            (VLP_16.to_vec(), 2.0),
            (VLP_16_HI_RES.to_vec(), 4.0 / 3.0),
            (HDL_32E.to_vec(), 4.0 / 3.0),
        ] {
            elevations.sort_by(f64::total_cmp);
            for pair in elevations.windows(2) {
                // The manual has two decimals.
                assert!((pair[1] - pair[0] - step).abs() < 0.011, "{pair:?}");
            }
        }
    }

    /// The sums of each column's numbers, each number as often as its row says, counted from 1:
    /// another digit and another order have another sum. Taken from lists of other people's
    /// programs: for the VLP-32C a decoder of its packets, for the elevations of Hesai's the driver
    /// of Apollo.
    #[test]
    fn a_laser_with_a_wrong_digit_is_told_from_its_makers() {
        fn check<const N: usize>(name: &str, table: &[[f64; N]], sums: [f64; N]) {
            for (column, sum) in sums.into_iter().enumerate() {
                let rows = (1_u32..).zip(table);
                let got: f64 = rows.map(|(row, of)| f64::from(row) * of[column]).sum();
                assert!((got - sum).abs() < 1e-6, "{name}, column {column}: {got}");
            }
        }
        check("VLP-32C", &VLP_32C, [256.086, -2.8]);
        check("Pandar 40P", &PANDAR_40P, [-5918.19, -887.628, 20_829.49]);
        check("Pandar64", &PANDAR_64, [-12_271.448, -800.216, 46_288.704]);
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

    #[test]
    fn lasers_in_columns_point_to_the_side_that_the_maker_says() {
        // In degrees to the left: makers count to the right. A laser, and one that fires at the
        // same time.
        for (model, [laser, other], left) in [
            (LidarModel::Vlp32c, [0, 1], -1.4 - 4.2),
            (LidarModel::Os1x64Gen1, [0, 3], -3.164 - 3.164),
            (LidarModel::Pandar64, [50, 60], -5.208 - 1.042),
            (LidarModel::Pandar40P, [3, 39], 0.0),
        ] {
            let pattern = model.pattern(10.0, None, 0.0).unwrap();
            let azimuth = |ring: i32| {
                let beam = pattern.rings().iter().position(|&r| r == ring).unwrap();
                (pattern.azimuths()[beam], pattern.times()[beam])
            };
            let ((a, at_a), (b, at_b)) = (azimuth(laser), azimuth(other));
            assert!((at_a - at_b).abs() < 1e-15, "{}", model.name());
            assert!((a - b - left).abs() < 1e-9, "{}: {}", model.name(), a - b);
        }
    }

    #[test]
    fn the_gen_1_os1_64_has_the_design_values_of_the_maker() {
        let pattern = LidarModel::Os1x64Gen1.pattern(10.0, Some(1), 0.0).unwrap();
        // The first, some in the middle and the last of the maker's list, which has three decimals.
        for (row, elevation) in [(0, 16.611), (1, 16.084), (17, 7.646), (31, 0.264), (63, -16.611)]
        {
            assert!((pattern.elevations()[row] - elevation).abs() < 6e-4, "{row}");
        }
    }

    #[test]
    fn a_turn_of_a_pandar_has_1800_columns_and_fires_within_one() {
        for (model, [first, last]) in
            [(LidarModel::Pandar40P, [8, 4]), (LidarModel::Pandar64, [12, 51])]
        {
            let pattern = model.pattern(10.0, None, 0.0).unwrap();
            let [_, columns] = pattern.shape();
            assert_eq!(columns, 1800);
            // Channels count from 1, from the top.
            let time = |channel: usize| pattern.times()[(channel - 1) * columns];
            assert_eq!(time(first), 0.0);
            assert!(time(last) > 50e-6 && time(last) < PANDAR_CYCLE);
            assert!(pattern.times()[..].iter().all(|&t| t < 0.1));
        }
    }
}
