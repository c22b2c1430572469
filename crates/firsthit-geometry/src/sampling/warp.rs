//! Maps from the unit square to other sets. Each keeps shares of areas, so that even samples stay
//! even.

use std::f64::consts::{FRAC_PI_4, PI};

use crate::geometry::{DVec2, DVec3};

/// Maps the unit square to the disc of radius one: squares around the middle become circles
/// (Shirley and Chiu, "A Low Distortion Map Between Disk and Square", Journal of Graphics Tools
/// 2(3), 1997).
#[inline(always)]
#[doc(hidden)]
pub fn disc(u: DVec2) -> DVec2 {
    let point = 2.0 * u - 1.0;
    let is_along_x = point.x.abs() > point.y.abs();
    // Selects instead of branching: the branch is unpredictable.
    let (radius, across) = if is_along_x { (point.x, point.y) } else { (point.y, point.x) };
    // The angle from the nearest axis, an eighth of a turn at most; none in the middle.
    let share = across / if radius == 0.0 { 1.0 } else { radius };
    let [sin, cos] = sin_cos(FRAC_PI_4 * share);
    let (along, across) = (radius * cos, radius * sin);
    if is_along_x { DVec2::new(along, across) } else { DVec2::new(across, along) }
}

/// Sine and cosine of an angle of an eighth of a turn at most: Taylor's series up to x^15 and x^16,
/// of which what is left out is below 2^-54. It takes a fraction of the time of `libm`, which has
/// to reduce angles of any size. Terms are summed in pairs (Estrin's scheme), so that few of them
/// wait for each other.
#[inline(always)]
fn sin_cos(x: f64) -> [f64; 2] {
    /// 1 / first!, -1 / (first + 2)!, ...
    const fn coefficients<const N: usize>(first: u32) -> [f64; N] {
        let mut coefficients = [1.0; N];
        let (mut k, mut n) = (1, first as f64);
        while k < N {
            coefficients[k] = -coefficients[k - 1] / ((n + 1.0) * (n + 2.0));
            k += 1;
            n += 2.0;
        }
        coefficients
    }
    const SIN: [f64; 8] = coefficients(1);
    const COS: [f64; 9] = coefficients(0);
    let y = x * x;
    let y4 = (y * y) * (y * y);
    [x * polynomial(&SIN, y), polynomial(&COS[..8], y) + COS[8] * (y4 * y4)]
}

/// One of eight coefficients.
#[inline(always)]
fn polynomial(c: &[f64], y: f64) -> f64 {
    let y2 = y * y;
    let low = (c[0] + c[1] * y) + y2 * (c[2] + c[3] * y);
    let high = (c[4] + c[5] * y) + y2 * (c[6] + c[7] * y);
    low + (y2 * y2) * high
}

/// Maps the unit square to the directions around +z, in proportion to their cosine (Malley's
/// method): a point of the disc, lifted. The density per solid angle is z / pi.
#[inline(always)]
#[doc(hidden)]
pub fn cosine_hemisphere(u: DVec2) -> DVec3 {
    let point = disc(u);
    point.extend((1.0 - point.length_squared()).max(0.0).sqrt())
}

/// Maps the unit square to the directions around +z whose cosine is at least `1 - height`, evenly.
/// The density per solid angle is 1 / (2 pi height).
#[inline(always)]
#[doc(hidden)]
pub fn cap(u: DVec2, height: f64) -> DVec3 {
    let point = disc(u);
    // A zone's area is in proportion to its height (Archimedes), so the square of the disc's radius
    // is the height.
    let squared = point.length_squared();
    let below = squared * height;
    let stretched = (height * (2.0 - below)).max(0.0).sqrt();
    (stretched * point).extend(1.0 - below)
}

/// Maps the unit square to the weights of a triangle's corners 1 and 2, evenly (Heitz, "A
/// Low-Distortion Map Between Triangle and Square", 2019).
#[doc(hidden)]
pub fn triangle(u: DVec2) -> DVec2 {
    if u.y > u.x {
        let x = 0.5 * u.x;
        DVec2::new(x, u.y - x)
    } else {
        let y = 0.5 * u.y;
        DVec2::new(u.x - y, y)
    }
}

/// The density per solid angle of [`cap`].
#[inline(always)]
#[doc(hidden)]
pub fn cap_density(height: f64) -> f64 {
    1.0 / (2.0 * PI * height)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The middles of the cells of an even grid.
    fn grid() -> impl Iterator<Item = DVec2> + Clone {
        let each = |k: u32| DVec2::new(f64::from(k % 64) + 0.5, f64::from(k / 64) + 0.5) / 64.0;
        (0..64 * 64).map(each)
    }

    fn mean(of: impl Fn(DVec2) -> f64) -> f64 {
        grid().map(of).sum::<f64>() / 4096.0
    }

    #[test]
    fn cosines_are_as_frequent_as_they_are_large() {
        // The mean of z is 2/3, that of z^2 1/2, with this density.
        assert!((mean(|u| cosine_hemisphere(u).z) - 2.0 / 3.0).abs() < 3e-3);
        let squares = mean(|u| cosine_hemisphere(u).z * cosine_hemisphere(u).z);
        assert!((squares - 0.5).abs() < 1e-3);
        assert!(grid().all(|u| (cosine_hemisphere(u).length() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn sine_and_cosine_are_those_of_libm() {
        for k in -1000..=1000 {
            let x = FRAC_PI_4 * f64::from(k) / 1000.0;
            let [sin, cos] = sin_cos(x);
            assert!((sin - libm::sin(x)).abs() < 3e-16 && (cos - libm::cos(x)).abs() < 3e-16);
        }
    }

    #[test]
    fn a_cap_is_filled_evenly() {
        for height in [1e-9, 0.1, 1.0, 2.0] {
            assert!(grid().all(|u| (cap(u, height).length() - 1.0).abs() < 1e-9));
            // Even by height: the mean is the middle.
            let mean = mean(|u| (1.0 - cap(u, height).z) / height);
            assert!((mean - 0.5).abs() < 1e-3, "{height} {mean}");
        }
    }

    #[test]
    fn a_triangle_is_filled_evenly() {
        let mut weights = grid().map(triangle);
        assert!(weights.all(|w| w.min_element() >= 0.0 && w.element_sum() <= 1.0));
        assert!((mean(|u| triangle(u).x) - 1.0 / 3.0).abs() < 1e-3);
        assert!((mean(|u| triangle(u).y * triangle(u).y) - 1.0 / 6.0).abs() < 1e-3);
    }
}
