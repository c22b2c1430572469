//! The sun's brightness and colour through the air.
//!
//! The sun shines as a black body of 5,778 K does. The loss by scattering in air, at
//! molecules (Rayleigh) and at haze (Ångström), is as in Preetham, Shirley and Smits (1999),
//! appendix A.1. The loss to ozone, water and oxygen, a few hundredths, is left out.

use super::perez::linear;
use crate::geometry::{Color, DVec3};

/// The illuminance of a surface that faces the sun above the air, in thousands of lumens for a
/// square metre.
const ABOVE_THE_AIR: f64 = 128.0;

const TEMPERATURE: f64 = 5778.0;

/// The illuminance of a surface that faces the sun, for each primary, in thousands of lumens for a
/// square metre.
pub(super) fn illuminance(elevation_degrees: f64, turbidity: f64) -> Color {
    let mass = air_mass(elevation_degrees);
    let (mut reached, mut above) = (DVec3::ZERO, 0.0);
    // In steps of 5 nanometres, over all that is seen.
    for step in 0..=80 {
        let micrometres = 0.38 + 0.005 * f64::from(step);
        let light = black_body(micrometres) * matching(1000.0 * micrometres);
        reached += transmitted(micrometres, mass, turbidity) * light;
        above += light.y;
    }
    linear(ABOVE_THE_AIR / above * reached)
}

/// The optical air mass: the length of the light's path through the air, where straight down is 1.
fn air_mass(elevation_degrees: f64) -> f64 {
    let sine = libm::sin(elevation_degrees.to_radians());
    1.0 / (sine + 0.15 * libm::pow(3.885 + elevation_degrees, -1.253))
}

/// The share of light of a wavelength that is not scattered away. (The paper prints the mass of air
/// in the exponent of the wavelength; its source, Iqbal's "An Introduction to Solar Radiation",
/// 1983, has it as here.)
fn transmitted(micrometres: f64, mass: f64, turbidity: f64) -> f64 {
    let molecules = 0.008_735 * libm::pow(micrometres, -4.08);
    let haze = (0.046_08 * turbidity - 0.045_86) * libm::pow(micrometres, -1.3);
    libm::exp(-mass * (molecules + haze))
}

/// Planck's law, but for a factor.
fn black_body(micrometres: f64) -> f64 {
    const SECOND_CONSTANT: f64 = 14_387.77;
    let exponent = SECOND_CONSTANT / (micrometres * TEMPERATURE);
    libm::pow(micrometres, -5.0) / (libm::exp(exponent) - 1.0)
}

/// The colour matching functions of the CIE's observer of 1931, by the sums of lobes of Wyman,
/// Sloan and Shirley ("Simple Analytic Approximations to the CIE XYZ Color Matching Functions",
/// Journal of Computer Graphics Techniques 2(2), 2013).
fn matching(nanometres: f64) -> DVec3 {
    let lobe = |height: f64, middle: f64, left: f64, right: f64| {
        let steepness = if nanometres < middle { left } else { right };
        let t = (nanometres - middle) * steepness;
        height * libm::exp(-0.5 * t * t)
    };
    DVec3::new(
        lobe(0.362, 442.0, 0.0624, 0.0374)
            + lobe(1.056, 599.8, 0.0264, 0.0323)
            + lobe(-0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reference is a program in another language, in steps of 1 nanometre, with Planck's law
    /// from its constants.
    #[test]
    fn the_sun_is_as_bright_and_as_red_as_its_spectrum_through_the_air() {
        for (elevation, turbidity, expected) in [
            (90.0, 2.0, [123.908, 101.929, 79.906]),
            (40.0, 3.0, [101.140, 77.682, 52.520]),
            (10.0, 3.0, [41.525, 22.291, 6.119]),
            // Redder than screens show: no blue.
            (2.0, 4.0, [0.318_28, 0.038_52, 0.0]),
        ] {
            let got = illuminance(elevation, turbidity);
            let off = (got - Color::from(expected)).abs().max_element();
            assert!(off < 0.002 * expected[0], "{elevation}: {got}");
        }
    }
}
