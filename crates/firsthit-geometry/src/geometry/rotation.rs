use super::{DMat3, DVec3, unit};

/// The rotation about an axis of any length but zero; seen against it, it is counter-clockwise.
/// Quarter turns about the axes of coordinates are exact.
///
/// ```
/// use firsthit::DVec3;
/// use firsthit::geometry::rotation;
///
/// assert_eq!(rotation(DVec3::Z, 90.0) * DVec3::X, DVec3::Y);
/// ```
pub fn rotation(axis: DVec3, degrees: f64) -> DMat3 {
    // Rodrigues' formula.
    let axis = unit(axis);
    let (sin, cos) = sin_cos(degrees);
    let across = crossed(axis);
    let along = DMat3::from_cols(axis.x * axis, axis.y * axis, axis.z * axis);
    DMat3::from_diagonal(DVec3::splat(cos)) + across * sin + along * (1.0 - cos)
}

/// The rotation that takes +y the shortest way to `up`, of any length but zero; straight down it is
/// half a turn about +x.
#[doc(hidden)]
pub fn upright(up: DVec3) -> DMat3 {
    let up = unit(up);
    let nearness = 1.0 + up.y;
    if nearness <= 0.0 {
        return DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    }
    // Rodrigues' formula, in which the sine is the axis' length: 1 - cos = sin^2 / (1 + cos).
    let across = crossed(DVec3::Y.cross(up));
    DMat3::IDENTITY + across + across * across * (1.0 / nearness)
}

/// The matrix whose product with a vector is `axis` crossed with it.
fn crossed(axis: DVec3) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.0, axis.z, -axis.y),
        DVec3::new(-axis.z, 0.0, axis.x),
        DVec3::new(axis.y, -axis.x, 0.0),
    )
}

/// Sine and cosine of degrees, exact for quarter turns: radians could not say those.
fn sin_cos(degrees: f64) -> (f64, f64) {
    // Both steps are exact.
    let within = degrees % 360.0;
    let quarters = (within / 90.0).round();
    let (sin, cos) = libm::sincos((within - 90.0 * quarters).to_radians());
    if quarters == 1.0 || quarters == -3.0 {
        (cos, -sin)
    } else if quarters == 2.0 || quarters == -2.0 {
        (-sin, -cos)
    } else if quarters == 3.0 || quarters == -1.0 {
        (-cos, sin)
    } else {
        (sin, cos)
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let quarter = rotation(DVec3::Z, 90.0);
        assert_eq!(quarter * DVec3::X, DVec3::Y);
        assert_eq!(rotation(DVec3::X, -90.0) * DVec3::Z, DVec3::Y);
        for (degrees, expected) in [
            (0.0, (0.0, 1.0)),
            (90.0, (1.0, 0.0)),
            (180.0, (0.0, -1.0)),
            (270.0, (-1.0, 0.0)),
            (-90.0, (-1.0, 0.0)),
            (-450.0, (-1.0, 0.0)),
            (360e9, (0.0, 1.0)),
        ] {
            assert_eq!(sin_cos(degrees), expected, "{degrees}");
        }
    }

    #[test]
    fn what_is_up_becomes_up_the_shortest_way() {
        assert_eq!(upright(DVec3::Y), DMat3::IDENTITY);
        let of_z = upright(3.0 * DVec3::Z);
        assert_eq!(of_z, DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y));
        for up in [DVec3::NEG_Y, DVec3::X, DVec3::new(1.0, -2.0, 0.5), DVec3::new(1e-9, -1.0, 0.0)]
        {
            let turn = upright(up);
            let axis = DVec3::Y.cross(unit(up));
            assert!((turn * DVec3::Y - unit(up)).length() < 1e-6, "{up}");
            assert!((turn * axis - axis).length() < 1e-6, "{up}");
            assert!((turn.determinant() - 1.0).abs() < 1e-6, "{up}");
        }
    }

    /// glam's own rotation goes by another way, the quaternion.
    #[test]
    fn an_axis_and_degrees_are_the_quaternion_of_half_the_angle() {
        for degrees in [-300.0, -100.0, -33.0, 12.5, 44.9, 45.1, 135.0, 200.0, 359.0] {
            let axis = DVec3::new(1.0, -2.0, 0.5).normalize();
            let ours = rotation(axis, degrees);
            let theirs = DMat3::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians()));
            assert!((ours - theirs).to_cols_array().iter().all(|x| x.abs() < 1e-15), "{degrees}");
        }
    }
}
