//! Cubic splines through points and through rotations, at times that need not be regular.
//!
//! Both are made from their rates at the knots: velocities, and angular velocities in the body's
//! axes. The rates are those of the natural cubic spline, which bends least and whose second
//! derivative is zero at its ends (de Boor, "A Practical Guide to Splines", 2001, chapter IV).

use super::rotation::{exp, log};
use crate::error::Result;
use crate::geometry::{DQuat, DVec3};
use crate::memory;

/// The rates at the knots of the natural cubic spline whose mean rates between the knots are
/// `means`, one less than `times`.
///
/// At each inner knot the second derivatives of both sides are equal, which with shares of `a`, `b`
/// of the stretches after and before it says
/// `a * before + 2 * here + b * after = 3 * (a * mean_before + b * mean_after)`. The system is
/// diagonally dominant, so that Gaussian elimination without pivots is stable (Thomas' algorithm).
pub(super) fn natural_rates(times: &[f64], means: &[DVec3]) -> Result<Vec<DVec3>> {
    let mut rates: Vec<DVec3> = memory::filled(times.len(), DVec3::ZERO)?;
    let mut above: Vec<f64> = memory::filled(times.len(), 0.0)?;
    let (mut last_above, mut last_rate) = (0.0, DVec3::ZERO);
    for (k, (rate, above)) in rates.iter_mut().zip(&mut above).enumerate() {
        let before = k.checked_sub(1).and_then(|k| means.get(k));
        let after = means.get(k);
        let share_after = match (before, after) {
            (Some(_), Some(_)) => (times[k + 1] - times[k]) / (times[k + 1] - times[k - 1]),
            (Some(_), None) => 1.0,
            (None, _) => 0.0,
        };
        let [before, after] = [before, after].map(|mean| mean.copied().unwrap_or_default());
        let share_before = 1.0 - share_after;
        let right = 3.0 * (share_after * before + share_before * after);
        let pivot = 2.0 - share_after * last_above;
        last_above = share_before / pivot;
        last_rate = (right - share_after * last_rate) / pivot;
        (*above, *rate) = (last_above, last_rate);
    }
    let mut next = DVec3::ZERO;
    for (rate, above) in rates.iter_mut().zip(&above).rev() {
        *rate -= *above * next;
        next = *rate;
    }
    Ok(rates)
}

/// The displacement along the cubic curve at the share `s` of a stretch over which it moves by
/// `whole`. `ends` are the rates at its ends, times its duration (Hermite's form).
pub(super) fn cubic(s: f64, whole: DVec3, ends: [DVec3; 2]) -> DVec3 {
    let [first, last] = ends;
    let squared = 3.0 * whole - 2.0 * first - last;
    let cubed = first + last - 2.0 * whole;
    s * (first + s * (squared + s * cubed))
}

/// The rotation at the share `s` of the way between two. `ends` are the angular velocities at its
/// ends, in the body's axes, times its duration.
///
/// It is the cumulative cubic Bezier curve of Kim, Kim and Shin, "A General Construction Scheme for
/// Unit Quaternion Curves with Simple High Order Derivatives", SIGGRAPH 1995, section 4.2: three
/// turns one after the other, the first and the last of them by a third of the rates at the ends.
pub(super) fn cubic_turn(s: f64, [from, to]: [DQuat; 2], ends: [DVec3; 2]) -> DQuat {
    let [first, last] = ends.map(|rate| rate / 3.0);
    let middle = log(exp(-first) * (from.conjugate() * to) * exp(-last));
    let rest = 1.0 - s;
    let [of_first, of_middle, of_last] =
        [1.0 - rest * rest * rest, s * s * (3.0 - 2.0 * s), s * s * s];
    from * exp(of_first * first) * exp(of_middle * middle) * exp(of_last * last)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The natural cubic spline through three values, from its second derivative at the middle,
    /// which alone is not zero: `2 (h + k) m = 6 (mean rate after - mean rate before)`.
    fn through_three(times: [f64; 3], values: [f64; 3], time: f64) -> f64 {
        let [h, k] = [times[1] - times[0], times[2] - times[1]];
        let bend = 3.0 * ((values[2] - values[1]) / k - (values[1] - values[0]) / h) / (h + k);
        let (from, to, length, outer) = if time < times[1] {
            (values[0], values[1], h, time - times[0])
        } else {
            (values[2], values[1], k, times[2] - time)
        };
        let slope = (to - from) / length - bend * length / 6.0;
        from + slope * outer + bend * outer * outer * outer / (6.0 * length)
    }

    #[test]
    fn three_knots_have_the_closed_form() {
        let (times, values) = ([-1.0, 0.5, 1.25], [2.0, -1.0, 4.0]);
        let means =
            [0, 1].map(|k| DVec3::splat((values[k + 1] - values[k]) / (times[k + 1] - times[k])));
        let rates = natural_rates(&times, &means).unwrap();
        for step in 0..=90 {
            let time = -1.0 + 0.025 * f64::from(step);
            let k = usize::from(time >= times[1]);
            let length = times[k + 1] - times[k];
            let ends = [rates[k], rates[k + 1]].map(|rate| length * rate);
            let moved = cubic((time - times[k]) / length, length * means[k], ends).x;
            let expected = through_three(times, values, time);
            assert!((values[k] + moved - expected).abs() < 1e-13, "{time}");
        }
    }

    #[test]
    fn a_constant_rate_is_that_of_every_knot() {
        let rate = DVec3::new(0.1, -7.0, 1e6);
        let times: Vec<f64> = (0..100).map(|k| f64::from(k * k) * 0.3).collect();
        for found in natural_rates(&times, &vec![rate; 99]).unwrap() {
            // A few roundings on the way down, and as many back.
            assert!((found - rate).length() < 1e-14 * rate.length(), "{found}");
        }
    }

    #[test]
    fn a_turn_starts_and_ends_where_it_should_at_the_rates_that_it_should() {
        let [from, to] = [DVec3::new(0.4, -1.0, 2.0), DVec3::new(-0.9, 0.1, 1.2)].map(exp);
        let ends = [DVec3::new(0.5, 0.2, -0.7), DVec3::new(-1.0, 0.4, 0.3)];
        let at = |s| cubic_turn(s, [from, to], ends);
        let step = 1e-6;
        // The error of a one-sided difference is half of the second derivative, here below 20,
        // times the step.
        let bound = 20.0 * step;
        let first = log(at(0.0).conjugate() * at(step)) / step;
        let last = log(at(1.0 - step).conjugate() * at(1.0)) / step;
        assert!((first - ends[0]).length() < bound, "{first}");
        assert!((last - ends[1]).length() < bound, "{last}");
        assert!(log(from.conjugate() * at(0.0)).length() < 1e-14);
        assert!(log(to.conjugate() * at(1.0)).length() < 1e-14);
    }
}
