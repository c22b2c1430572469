//! The sky's luminance and its colour, by the formula of Perez, Seals and Michalsky (1993) with the
//! numbers of Preetham, Shirley and Smits (1999), appendix A.2.

use std::f64::consts::PI;

use super::cells;
use crate::geometry::{Color, DVec3};

/// A function of the zenith's angle and of that to the sun, times its value at the zenith.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Perez {
    coefficients: [f64; 5],
    /// The value at the zenith over that of the function there.
    scale: f64,
}

/// The sky in its own frame, +y up: its luminance, in thousands of candelas for a square metre, and
/// its chromaticity x and y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sky {
    towards_sun: DVec3,
    luminance: Perez,
    x: Perez,
    y: Perez,
}

/// The coefficients A to E: each a multiple of the turbidity, and a constant.
const LUMINANCE: [[f64; 2]; 5] =
    [[0.1787, -1.4630], [-0.3554, 0.4275], [-0.0227, 5.3251], [0.1206, -2.5771], [-0.0670, 0.3703]];
const X: [[f64; 2]; 5] = [
    [-0.0193, -0.2592],
    [-0.0665, 0.0008],
    [-0.0004, 0.2125],
    [-0.0641, -0.8989],
    [-0.0033, 0.0452],
];
const Y: [[f64; 2]; 5] = [
    [-0.0167, -0.2608],
    [-0.0950, 0.0092],
    [-0.0079, 0.2102],
    [-0.0441, -1.6537],
    [-0.0109, 0.0529],
];

/// The zenith's chromaticity: rows by falling powers of the turbidity, columns by those of the
/// sun's angle from the zenith.
const ZENITH_X: [[f64; 4]; 3] = [
    [0.001_66, -0.003_75, 0.002_09, 0.0],
    [-0.029_03, 0.063_77, -0.032_02, 0.003_94],
    [0.116_93, -0.211_96, 0.060_52, 0.258_86],
];
const ZENITH_Y: [[f64; 4]; 3] = [
    [0.002_75, -0.006_10, 0.003_17, 0.0],
    [-0.042_14, 0.089_70, -0.041_53, 0.005_16],
    [0.153_46, -0.267_56, 0.066_70, 0.266_88],
];

impl Sky {
    /// The sky for a direction of length one towards the sun, not below the horizon.
    pub(super) fn new(towards_sun: DVec3, turbidity: f64) -> Self {
        let from_zenith = libm::acos(towards_sun.y.clamp(0.0, 1.0));
        let chi = (4.0 / 9.0 - turbidity / 120.0) * (PI - 2.0 * from_zenith);
        let zenith = (4.0453 * turbidity - 4.9710) * libm::tan(chi) - 0.2155 * turbidity + 2.4192;
        let perez =
            |of_turbidity, zenith| Perez::new(of_turbidity, turbidity, towards_sun.y, zenith);
        let chromaticity = |rows| zenith_chromaticity(rows, turbidity, from_zenith);
        Self {
            towards_sun,
            luminance: perez(LUMINANCE, zenith),
            x: perez(X, chromaticity(ZENITH_X)),
            y: perez(Y, chromaticity(ZENITH_Y)),
        }
    }

    /// The luminance of each primary, in a direction of length one above the horizon.
    pub(super) fn luminance(&self, direction: DVec3) -> Color {
        let to_sun = direction.dot(self.towards_sun).clamp(-1.0, 1.0);
        let angle = libm::acos(to_sun);
        let value = |perez: &Perez| perez.scale * perez.shape(direction.y, angle, to_sun);
        let (luminance, x, y) = (value(&self.luminance), value(&self.x), value(&self.y));
        linear(luminance * DVec3::new(x / y, 1.0, (1.0 - x - y) / y))
    }

    /// The illuminance of a level surface by the sky, in thousands of lumens for a square metre.
    pub(super) fn illuminance(&self) -> Color {
        let above = cells().filter(|(direction, _)| direction.y > 0.0);
        above
            .map(|(direction, solid_angle)| solid_angle * direction.y * self.luminance(direction))
            .fold(Color::ZERO, |sum, light| sum + light)
    }
}

impl Perez {
    fn new(of_turbidity: [[f64; 2]; 5], turbidity: f64, sun_height: f64, zenith: f64) -> Self {
        let coefficients = of_turbidity.map(|[factor, constant]| factor * turbidity + constant);
        let shape = Self { coefficients, scale: 1.0 };
        let to_sun = libm::acos(sun_height.clamp(0.0, 1.0));
        Self { scale: zenith / shape.shape(1.0, to_sun, sun_height), ..shape }
    }

    /// The model's factor for the height of a direction, which is the cosine of its angle from the
    /// zenith, and for its angle to the sun.
    fn shape(&self, height: f64, to_sun: f64, cosine_to_sun: f64) -> f64 {
        let [a, b, c, d, e] = self.coefficients;
        // Where the height is 0 the exponent is minus infinity, as `b` is negative.
        let gradient = 1.0 + a * libm::exp(b / height.max(0.0));
        gradient * (1.0 + c * libm::exp(d * to_sun) + e * cosine_to_sun * cosine_to_sun)
    }
}

fn zenith_chromaticity(rows: [[f64; 4]; 3], turbidity: f64, angle: f64) -> f64 {
    let row = |[a, b, c, d]: [f64; 4]| ((a * angle + b) * angle + c) * angle + d;
    let [a, b, c] = rows.map(row);
    (a * turbidity + b) * turbidity + c
}

/// XYZ as linear Rec. 709 with the white point D65 (ITU-R BT.709-6). A colour outside of it
/// is cut off at 0.
pub(super) fn linear(xyz: DVec3) -> Color {
    let rows = [
        DVec3::new(3.240_969_941_904_521, -1.537_383_177_570_093, -0.498_610_760_293_003),
        DVec3::new(-0.969_243_636_280_879, 1.875_967_501_507_72, 0.041_555_057_407_175),
        DVec3::new(0.055_630_079_696_993, -0.203_976_958_888_976, 1.056_971_514_242_878),
    ];
    DVec3::from(rows.map(|row| row.dot(xyz))).max(DVec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turbidity, the sun's elevation, a direction's elevation and its azimuth from the sun; and Y,
    /// x, y there, by a program in another language that was written from the paper, with angles as
    /// they are printed there.
    const CASES: &[([f64; 4], [f64; 3])] = &[
        ([3.0, 40.0, 90.0, 0.0], [6.525_041_112_282, 0.244_411_891_105, 0.250_520_792_709]),
        ([3.0, 40.0, 5.0, 0.0], [17.246_164_420_399, 0.330_066_564_112, 0.332_419_993_922]),
        ([2.5, 15.0, 30.0, 180.0], [4.432_468_810_012, 0.261_503_372_733, 0.279_801_471_161]),
        ([6.0, 70.0, 45.0, 90.0], [16.869_023_092_702, 0.262_902_230_891, 0.282_704_414_326]),
        ([2.0, 0.0, 60.0, 10.0], [3.201_523_164_534, 0.295_553_670_103, 0.315_019_146_171]),
        ([2.0, 10.0, 1.0, 0.0], [59.422_650_416_306, 0.404_186_178_731, 0.415_526_167_350]),
    ];

    fn towards(elevation: f64, azimuth: f64) -> DVec3 {
        let (height, level) = libm::sincos(elevation.to_radians());
        let (z, x) = libm::sincos(azimuth.to_radians());
        DVec3::new(level * x, height, level * z)
    }

    #[test]
    fn luminance_and_chromaticity_are_the_paper_s() {
        for &([turbidity, sun, elevation, azimuth], [luminance, x, y]) in CASES {
            let sky = Sky::new(towards(sun, 0.0), turbidity);
            let got = sky.luminance(towards(elevation, azimuth));
            let expected = linear(luminance / y * DVec3::new(x, y, 1.0 - x - y));
            let off = (got - expected).abs().max_element() / expected.max_element();
            assert!(off < 1e-9, "{turbidity} {sun} {elevation}: {got} {expected}");
        }
    }

    #[test]
    fn white_is_white_and_what_no_screen_shows_is_cut_off() {
        let white = linear(DVec3::new(0.312_7, 0.329_0, 0.358_3) / 0.329_0);
        assert!((white - 1.0).abs().max_element() < 1e-3, "{white}");
        assert_eq!(linear(DVec3::new(0.1, 0.0, 0.0)).y, 0.0);
    }

    #[test]
    fn every_sky_is_bright_all_over() {
        for turbidity in [2.0, 3.0, 6.0, 10.0] {
            for sun in [0.0, 1.0, 30.0, 89.0, 90.0] {
                let sky = Sky::new(towards(sun, 0.0), turbidity);
                for (direction, _) in cells().filter(|(direction, _)| direction.y > 0.0) {
                    let light = sky.luminance(direction);
                    assert!(
                        light.is_finite() && light.max_element() > 0.0,
                        "{turbidity} {sun} {light}"
                    );
                }
            }
        }
    }
}
