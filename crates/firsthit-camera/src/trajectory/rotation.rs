//! Rotations as unit quaternions, and as rotation vectors: axis times angle, in radians.

use crate::geometry::{DMat3, DQuat, DVec3};

/// `q` at length one. `None` where its length is further from one than 0.001, or no number.
///
/// A quaternion that is as near to length one as float64 comes stays as it is, so that a rotation
/// that is written and read again has the same bits.
pub(super) fn unit_rotation(q: DQuat) -> Option<DQuat> {
    // Four roundings of the components and four of the sum, each by half an epsilon of the square.
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    let (length, square) = (q.length(), q.length_squared());
    let is_near = (length - 1.0).abs() <= 1e-3;
    let is_unit = (square - 1.0).abs() <= ROUNDING;
    is_near.then(|| if is_unit { q } else { q / length })
}

/// The largest deviation of a matrix's columns from right angles and from length one.
const SKEW: f64 = 1e-4;

/// The rotation that is nearest to a matrix that is nearly one.
///
/// # Errors
///
/// For others, in words.
pub(super) fn nearest_rotation(matrix: DMat3) -> Result<DQuat, String> {
    let skew = matrix.transpose() * matrix - DMat3::IDENTITY;
    let skew = skew.to_cols_array().map(f64::abs);
    // So that a NaN fails.
    if !skew.iter().all(|&x| x <= SKEW) {
        let worst = skew.into_iter().fold(0.0, f64::max);
        return Err(format!(
            "the matrix is not a rotation: the products of its columns are off by {worst:.2e}, at most {SKEW} is expected"
        ));
    }
    if matrix.determinant() < 0.0 {
        return Err("the matrix is not a rotation: it mirrors".to_owned());
    }
    // The polar decomposition by Newton's iteration (Higham, "Computing the Polar Decomposition -
    // with Applications", SIAM Journal on Scientific and Statistical Computing 7(4), 1986). Each
    // step squares what it is off: three are enough from 1e-4 on.
    let mut nearest = matrix;
    for _ in 0..3 {
        nearest = 0.5 * (nearest + nearest.inverse().transpose());
    }
    let rotation = DQuat::from_mat3(&nearest);
    unit_rotation(rotation).ok_or_else(|| "the matrix is not a rotation".to_owned())
}

/// The rotation vector of a unit quaternion, the short way: its length is at most pi.
///
/// The angle comes from sine and cosine together, so that neither small angles nor those near pi
/// lose digits. Nothing cancels for small angles: the factor is `angle / sine`, and both go to zero
/// as one.
pub(super) fn log(q: DQuat) -> DVec3 {
    let q = if q.w < 0.0 { -q } else { q };
    let sine = q.xyz().length();
    let factor = if sine > 0.0 { libm::atan2(sine, q.w) / sine } else { 1.0 };
    2.0 * factor * q.xyz()
}

/// The unit quaternion of a rotation vector.
pub(super) fn exp(vector: DVec3) -> DQuat {
    let half = 0.5 * vector;
    let angle = half.length();
    let (sine, cosine) = libm::sincos(angle);
    let factor = if angle > 0.0 { sine / angle } else { 1.0 };
    let DVec3 { x, y, z } = factor * half;
    DQuat::from_xyzw(x, y, z, cosine)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// `exp` and `log` round a few times each; angles are below 4.
    const ROUNDING: f64 = 8.0 * f64::EPSILON;

    #[test]
    fn logarithms_keep_their_digits_near_zero_and_near_pi() {
        let axis = DVec3::new(2.0, -3.0, 6.0) / 7.0;
        let small = [1e-300, 1e-160, 1e-155, 1e-20, 1e-8, 1e-4];
        let large = [0.5, 1.0, 3.0, PI - 1e-6, PI - 1e-12, PI - 1e-15];
        for angle in small.into_iter().chain(large) {
            let vector = angle * axis;
            let back = log(exp(vector));
            let off = (back - vector).abs().max_element();
            assert!(off <= ROUNDING * angle, "{angle:e}: {off:e}");
        }
        assert_eq!(log(DQuat::IDENTITY), DVec3::ZERO);
        assert_eq!(exp(DVec3::ZERO), DQuat::IDENTITY);
        // Half a turn, exactly.
        assert_eq!(log(DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0)), PI * DVec3::Y);
    }

    #[test]
    fn both_signs_are_one_rotation() {
        let q = exp(DVec3::new(0.3, -2.0, 1.1));
        assert_eq!(log(q), log(-q));
    }

    #[test]
    fn what_has_length_one_stays_bit_for_bit() {
        for k in 0..10_000 {
            let k = f64::from(k);
            let vector = DVec3::new(k * 0.37 % 3.0, k * 0.91 % 2.0, k * 0.13 % 1.0 - 0.5);
            let q = unit_rotation(exp(vector) * 1.000_9).unwrap();
            assert!((q.length_squared() - 1.0).abs() <= ROUNDING);
            assert_eq!(unit_rotation(q), Some(q));
        }
    }

    #[test]
    fn lengths_far_from_one_and_numbers_that_are_none_are_refused() {
        for w in [0.0, 0.9985, 1.0015, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(unit_rotation(DQuat::from_xyzw(0.0, 0.0, 0.0, w)), None);
        }
    }
}
