//! The screw motion from one pose to another.

use crate::geometry::DVec3;

/// The displacement of a point at the share `s` of a screw motion that moves it by `whole` and
/// turns by the rotation vector `turn`, both in world axes.
///
/// The motion is `exp(s log(T))`, the geodesic of SE(3): at constant speed about and along one line
/// (Chasles' theorem; Murray, Li and Sastry, "A Mathematical Introduction to Robotic Manipulation",
/// 1994, chapter 2). Across that line the point goes round a circle. There, with complex numbers
/// for the plane, `(e^(i s angle) - 1) / (e^(i angle) - 1)` of the way is done. Written as sines of
/// half angles, as here, nothing cancels for small angles, and nothing grows for angles near pi.
pub(super) fn screw(s: f64, whole: DVec3, turn: DVec3) -> DVec3 {
    let angle = turn.length();
    if angle == 0.0 {
        return s * whole;
    }
    let axis = turn / angle;
    let half = 0.5 * angle;
    let ratio = libm::sin(s * half) / libm::sin(half);
    let (sine, cosine) = libm::sincos((s - 1.0) * half);
    let across = ratio * (cosine * whole + sine * axis.cross(whole));
    // Along the axis it is `s` of the way.
    across + (s - ratio * cosine) * axis.dot(whole) * axis
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::geometry::{DMat3, unit};

    /// The rotation about `axis` by Rodrigues' formula.
    fn rotation(axis: DVec3, angle: f64) -> DMat3 {
        let cross =
            DMat3::from_cols(axis.cross(DVec3::X), axis.cross(DVec3::Y), axis.cross(DVec3::Z));
        let (sine, cosine) = libm::sincos(angle);
        DMat3::IDENTITY + sine * cross + (1.0 - cosine) * (cross * cross)
    }

    /// A helix about a line through `centre`: it is turned, and moved along the line.
    #[test]
    fn a_screw_goes_along_the_helix() {
        let axis = unit(DVec3::new(1.0, -2.0, 0.5));
        let (start, centre) = (DVec3::new(3.0, 1.0, -4.0), DVec3::new(0.5, 0.2, 9.0));
        let pitch = 7.0;
        for angle in [1e-9, 1e-3, 0.5, 2.0, 3.0, PI - 1e-9, PI] {
            let at = |s: f64| {
                let turned = rotation(axis, s * angle) * (start - centre);
                centre + turned + s * pitch * axis - start
            };
            for step in 0..=20 {
                let s = f64::from(step) / 20.0;
                let moved = screw(s, at(1.0), angle * axis);
                // The helix rounds at coordinates below 20.
                assert!((moved - at(s)).length() < 2e-14, "{angle} {s}");
            }
        }
    }

    #[test]
    fn without_a_turn_it_is_a_straight_line() {
        let whole = DVec3::new(1.0, 2.0, -3.0);
        for angle in [0.0, 1e-300, 1e-170, 1e-160, 1e-20] {
            let moved = screw(0.3, whole, angle * DVec3::new(0.6, 0.0, 0.8));
            assert!((moved - 0.3 * whole).length() < 1e-15, "{angle:e} {moved}");
        }
    }
}
