//! Beams that mirrors or prisms lead over a field of view ahead.

use std::f64::consts::TAU;

use super::Pattern;
use super::pattern::Beam;
use crate::error::Result;
use crate::geometry::{require, require_positive};

/// Rows and columns of equal angles, as of a mirror that turns about two axes, or of a flash.
///
/// The beam of row r of M and column c of N has the azimuth `H (1/2 - (c + 1/2) / N)` and the
/// elevation `V (1/2 - (r + 1/2) / M)`. Points are scanned row by row from the top, from the left,
/// or every other row from the right: point k of all has the time `start + k / (M N) / rate`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// H, in degrees.
    pub horizontal_fov: f64,
    /// V, in degrees.
    pub vertical_fov: f64,
    /// M.
    pub rows: usize,
    /// N.
    pub columns: usize,
    /// Pictures in a second; zero for all points at once.
    pub rate: f64,
    /// Whether every other row is scanned from the right.
    pub is_serpentine: bool,
    /// The time of the first point, in seconds.
    pub start: f64,
}

/// Two prisms that turn, each of which leads the beam around a circle: the sum is a rose.
///
/// Point k has the time `T = start + k / point_rate`. The beam is off forwards by the vector
/// `a (cos 2 pi f1 T, sin 2 pi f1 T) + b (cos 2 pi f2 T, sin 2 pi f2 T)` in degrees to the left and
/// upwards: its length is the angle. `a = fov / 2 * share` and `b = fov / 2 * (1 - share)`.
/// Frequencies of opposite signs and a share of one half make the rose of the Risley prisms
/// (Marshall, "Risley prism scan patterns", Proceedings of SPIE 3787, 1999).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rosette {
    /// The diameter of the circular field of view, in degrees.
    pub fov: f64,
    /// f1 and f2, in turns a second; negative ones turn clockwise, as the scanner sees it from
    /// behind.
    pub frequencies: [f64; 2],
    /// The first prism's share of the deflection, from 0 to 1.
    pub share: f64,
    /// The number of points.
    pub points: usize,
    /// Points in a second.
    pub point_rate: f64,
    /// The time of the first point, in seconds.
    pub start: f64,
}

/// A mirror that swings about two axes.
///
/// Point k has the time `T = start + k / point_rate`, the azimuth `H / 2 sin(2 pi f1 T)` and the
/// elevation `V / 2 sin(2 pi f2 T + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lissajous {
    /// H, in degrees.
    pub horizontal_fov: f64,
    /// V, in degrees.
    pub vertical_fov: f64,
    /// f1 and f2, in swings a second.
    pub frequencies: [f64; 2],
    /// The phase, in degrees.
    pub phase: f64,
    /// The number of points.
    pub points: usize,
    /// Points in a second.
    pub point_rate: f64,
    /// The time of the first point, in seconds.
    pub start: f64,
}

impl Pattern {
    /// Rows and columns of equal angles. A row is a ring.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for fields of view that are not positive
    /// or beyond 360 and 180 degrees, a rate below zero, no rows or columns, and numbers that are
    /// not finite.
    pub fn raster(scan: &Raster) -> Result<Self> {
        check_fields(scan.horizontal_fov, scan.vertical_fov)?;
        let fine = scan.rate >= 0.0 && scan.rate.is_finite();
        require("rate", "finite and not negative", fine, scan.rate)?;
        let (rows, columns) = (scan.rows as f64, scan.columns as f64);
        let parameters = [
            ("horizontal_fov", scan.horizontal_fov),
            ("vertical_fov", scan.vertical_fov),
            ("rate", scan.rate),
            ("serpentine", f64::from(u8::from(scan.is_serpentine))),
            ("start", scan.start),
        ];
        let size = [scan.rows, scan.columns];
        Self::of("raster", size, &parameters, |row, column| {
            let is_back = scan.is_serpentine && row % 2 == 1;
            let place = if is_back { scan.columns - 1 - column } else { column };
            let share = (row as f64 * columns + place as f64) / (rows * columns);
            let later = if scan.rate > 0.0 { share / scan.rate } else { 0.0 };
            Beam {
                azimuth: scan.horizontal_fov * (0.5 - (column as f64 + 0.5) / columns),
                elevation: scan.vertical_fov * (0.5 - (row as f64 + 0.5) / rows),
                time: scan.start + later,
                ring: i32::try_from(row).unwrap_or(i32::MAX),
            }
        })
    }

    /// The rose of two prisms: one row of points.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a field of view that is not positive
    /// or beyond 180 degrees, a share that is not from 0 to 1, a rate that is not positive, no
    /// points, and numbers that are not finite.
    pub fn rosette(scan: &Rosette) -> Result<Self> {
        let fine = scan.fov > 0.0 && scan.fov <= 180.0;
        require("fov", "above 0, up to 180 degrees", fine, scan.fov)?;
        let fine = (0.0..=1.0).contains(&scan.share);
        require("share", "from 0 to 1", fine, scan.share)?;
        check_points(scan.points, scan.point_rate, scan.frequencies)?;
        let [f1, f2] = scan.frequencies;
        let amplitudes = [0.5 * scan.fov * scan.share, 0.5 * scan.fov * (1.0 - scan.share)];
        let parameters = [
            ("fov", scan.fov),
            ("frequency_1", f1),
            ("frequency_2", f2),
            ("share", scan.share),
            ("point_rate", scan.point_rate),
            ("start", scan.start),
        ];
        let size = [1, scan.points];
        Self::of("rosette", size, &parameters, |_, point| {
            let time = scan.start + point as f64 / scan.point_rate;
            let (mut left, mut up) = (0.0, 0.0);
            for (amplitude, frequency) in amplitudes.into_iter().zip(scan.frequencies) {
                let (sine, cosine) = libm::sincos(TAU * frequency * time);
                left += amplitude * cosine;
                up += amplitude * sine;
            }
            let (azimuth, elevation) = toward(left, up);
            Beam { azimuth, elevation, time, ring: 0 }
        })
    }

    /// The figure of a mirror that swings about two axes: one row of points.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) as of the others.
    pub fn lissajous(scan: &Lissajous) -> Result<Self> {
        check_fields(scan.horizontal_fov, scan.vertical_fov)?;
        check_points(scan.points, scan.point_rate, scan.frequencies)?;
        require("phase", "finite", scan.phase.is_finite(), scan.phase)?;
        let [f1, f2] = scan.frequencies;
        let parameters = [
            ("horizontal_fov", scan.horizontal_fov),
            ("vertical_fov", scan.vertical_fov),
            ("frequency_1", f1),
            ("frequency_2", f2),
            ("phase", scan.phase),
            ("point_rate", scan.point_rate),
            ("start", scan.start),
        ];
        let size = [1, scan.points];
        Self::of("lissajous", size, &parameters, |_, point| {
            let time = scan.start + point as f64 / scan.point_rate;
            let swing = libm::sin(TAU * f1 * time);
            let nod = libm::sin(TAU * f2 * time + scan.phase.to_radians());
            Beam {
                azimuth: 0.5 * scan.horizontal_fov * swing,
                elevation: 0.5 * scan.vertical_fov * nod,
                time,
                ring: 0,
            }
        })
    }
}

fn check_fields(horizontal: f64, vertical: f64) -> Result<()> {
    let fine = horizontal > 0.0 && horizontal <= 360.0;
    require("horizontal_fov", "above 0, up to 360 degrees", fine, horizontal)?;
    let fine = vertical > 0.0 && vertical <= 180.0;
    require("vertical_fov", "above 0, up to 180 degrees", fine, vertical)
}

fn check_points(points: usize, point_rate: f64, frequencies: [f64; 2]) -> Result<()> {
    require("points", "at least 1", points >= 1, points)?;
    require_positive("point_rate", point_rate)?;
    for frequency in frequencies {
        require("frequencies", "finite", frequency.is_finite(), frequency)?;
    }
    Ok(())
}

/// The azimuth and the elevation of what is off forwards by a vector of degrees to the left and
/// upwards.
fn toward(left: f64, up: f64) -> (f64, f64) {
    let angle = (left * left + up * up).sqrt();
    if angle == 0.0 {
        return (0.0, 0.0);
    }
    let (sine, cosine) = libm::sincos(angle.to_radians());
    let (y, z) = (sine * left / angle, sine * up / angle);
    let level = (cosine * cosine + y * y).sqrt();
    (libm::atan2(y, cosine).to_degrees(), libm::atan2(z, level).to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rose_stays_in_its_field_and_reaches_its_edge() {
        let scan = Rosette {
            fov: 40.0,
            frequencies: [77.0, -31.0],
            share: 0.5,
            points: 5000,
            point_rate: 1e5,
            start: 0.0,
        };
        let pattern = Pattern::rosette(&scan).unwrap();
        let angles =
            pattern.directions().iter().map(|d| libm::acos(d.x.clamp(-1.0, 1.0)).to_degrees());
        let widest = angles.fold(0.0, f64::max);
        assert!((widest - 20.0).abs() < 1e-9, "{widest}");
    }

    #[test]
    fn a_serpentine_goes_back_in_time_only() {
        let scan = Raster {
            horizontal_fov: 40.0,
            vertical_fov: 20.0,
            rows: 2,
            columns: 4,
            rate: 1.0,
            is_serpentine: true,
            start: 0.0,
        };
        let pattern = Pattern::raster(&scan).unwrap();
        assert_eq!(pattern.azimuths()[..4], [15.0, 5.0, -5.0, -15.0]);
        assert_eq!(pattern.azimuths()[4..], [15.0, 5.0, -5.0, -15.0]);
        assert_eq!(pattern.times()[4..], [7.0 / 8.0, 6.0 / 8.0, 5.0 / 8.0, 0.5]);
    }
}
