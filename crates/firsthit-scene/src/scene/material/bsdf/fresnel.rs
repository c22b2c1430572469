//! The reflectance of a smooth boundary.

use crate::geometry::{Color, DVec3};

/// The fifth power by which reflection grows towards grazing directions (Schlick, "An Inexpensive
/// BRDF Model for Physically-based Rendering", Computer Graphics Forum 13(3), 1994).
pub(super) fn grazing(cosine: f64) -> f64 {
    let left = (1.0 - cosine.abs()).clamp(0.0, 1.0);
    let squared = left * left;
    squared * squared * left
}

/// Schlick's reflectance of what reflects `f0` head on.
pub(super) fn schlick(f0: Color, cosine: f64) -> Color {
    f0 + (Color::ONE - f0) * grazing(cosine)
}

/// The reflectance at normal incidence, with the relative index of refraction `ior`.
pub(super) fn head_on(ior: f64) -> f64 {
    let root = (1.0 - ior) / (1.0 + ior);
    root * root
}

/// The exact reflectance for light without a polarisation (Fresnel, 1823), from the cosine on this
/// side. `ior` is the other side's index divided by this side's. One where all light is reflected.
pub(super) fn dielectric(cosine: f64, ior: f64) -> f64 {
    if ior == 1.0 {
        return 0.0;
    }
    let Some(beyond) = cosine_beyond(cosine, ior) else {
        return 1.0;
    };
    let parallel = (ior * cosine - beyond) / (ior * cosine + beyond);
    let across = (cosine - ior * beyond) / (cosine + ior * beyond);
    0.5 * (parallel * parallel + across * across)
}

/// The cosine on the other side (Snell's law); `None` where no light goes there.
fn cosine_beyond(cosine: f64, ior: f64) -> Option<f64> {
    let squared = 1.0 - (1.0 - cosine * cosine) / (ior * ior);
    (squared > 0.0).then(|| squared.sqrt())
}

/// The direction that light comes from that leaves towards `out`, both away from the boundary, on
/// whose side `out` the normal is. `None` where all light is reflected.
pub(super) fn refracted(out: DVec3, normal: DVec3, ior: f64) -> Option<DVec3> {
    if ior == 1.0 {
        return Some(-out);
    }
    let cosine = out.dot(normal);
    let beyond = cosine_beyond(cosine, ior)?;
    Some((cosine * normal - out) / ior - beyond * normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of a boundary of index 1.5, from the formulas by another program: degrees,
    /// reflectance, degrees beyond.
    const TABLE: [[f64; 3]; 5] = [
        [0.0, 0.04, 0.0],
        [30.0, 0.041_522_625_975_821_52, 19.471_220_634_490_69],
        [56.3099, 0.073_964_385_250_947_5, 33.690_053_093_076_99],
        [75.0, 0.253_060_562_990_319_7, 40.087_036_908_483_284],
        [89.0, 0.904_184_949_780_188_6, 41.802_510_219_635_45],
    ];

    #[test]
    fn reflectance_is_that_of_the_table_on_both_sides() {
        for [degrees, reflectance, beyond] in TABLE {
            let [here, there] = [degrees, beyond].map(|angle| libm::cos(angle.to_radians()));
            assert!((dielectric(here, 1.5) - reflectance).abs() < 1e-12, "{degrees}");
            assert!((dielectric(there, 1.0 / 1.5) - reflectance).abs() < 1e-9);
        }
        assert_eq!(dielectric(libm::cos(60_f64.to_radians()), 1.0 / 1.5), 1.0);
    }

    #[test]
    fn refraction_keeps_the_law_of_snell_and_can_be_turned_round() {
        for degrees in [0.0, 10.0, 45.0, 80.0] {
            let (sin, cos) = libm::sincos(f64::to_radians(degrees));
            let out = DVec3::new(sin, 0.0, cos);
            let into = refracted(out, DVec3::Z, 1.5).unwrap();
            assert!((into.x + sin / 1.5).abs() < 1e-15 && into.z < 0.0);
            assert!((into.length() - 1.0).abs() < 1e-15);
            let back = refracted(into, DVec3::NEG_Z, 1.0 / 1.5).unwrap();
            assert!((back - out).length() < 1e-14, "{degrees}");
        }
        let steep = DVec3::new(0.8, 0.0, 0.6);
        assert_eq!(refracted(steep, DVec3::Z, 1.0 / 1.5), None);
        assert_eq!(refracted(steep, DVec3::Z, 1.0), Some(-steep));
    }
}
