//! Radial distortion, as a quotient of polynomials, with tangential and thin prism distortion, for
//! the models that are made of them.
//!
//! [`opencv`](super::opencv) has the formulas and the papers: these are its steps 1 to 3, with
//! radial polynomials of any degree.

use super::Limit;
use super::newton::{Mapped, invert, invert_in_plane};
use super::polynomial::{product, sign_changes, value};
use crate::camera::quick::{Known, Pair, Start, polynomial, square, twice};
use crate::geometry::DVec2;
use crate::geometry::arithmetic::{Arithmetic, Scalar};

/// A distortion of the plane, whose radial polynomial has `N` coefficients.
#[derive(Debug, Clone, Copy)]
pub(super) struct Brown<const N: usize> {
    /// The coefficients of the powers of q, from the constant on.
    pub(super) radial: [f64; N],
    /// The coefficients of the divisor of the first.
    pub(super) divisor: [f64; 4],
    /// p1 and p2.
    pub(super) tangential: [f64; 2],
    /// s1 to s4.
    pub(super) prism: [f64; 4],
}

impl<const N: usize> Brown<N> {
    /// The limit at which the distortion folds over. `farthest` is about the largest radius of the
    /// distorted points that will be asked for.
    pub(super) fn limit(&self, farthest: f64) -> Limit {
        // The radius r times the factor n / d has the slope ((n + 2 q n') d - 2 q n d') / d².
        let (n, d) = (self.radial, self.divisor);
        let sum: [f64; N] = std::array::from_fn(|k| n[k] + 2.0 * k as f64 * n[k]);
        let d_slope: [f64; 4] = std::array::from_fn(|k| 2.0 * k as f64 * d[k]);
        let rises = product(&sum, &d);
        let falls = product(&n, &d_slope);
        let slope: Vec<f64> = rises.iter().zip(&falls).map(|(a, b)| a - b).collect();
        let mut folds = sign_changes(&slope);
        let poles = sign_changes(&d);
        let pole = poles.first().copied().unwrap_or(f64::INFINITY);
        folds.retain(|&q| q < pole);
        let first = folds.first().copied().unwrap_or(pole);
        let undistorted = first.sqrt();
        // Beyond the first fold of a radial distortion everything is upside down, until the next
        // one.
        let second = folds.get(1).copied().unwrap_or(pole);
        let is_lopsided = self.is_lopsided();
        let outermost = if !is_lopsided {
            undistorted
        } else if second.is_finite() {
            first.midpoint(second).sqrt()
        } else {
            f64::INFINITY
        };
        let probed = if is_lopsided { self.probed(undistorted) } else { undistorted };
        let distorted =
            if first < pole { undistorted * self.radial(first)[0] } else { f64::INFINITY };
        let limit = Limit { undistorted, distorted, outermost, probed, ..Limit::default() };
        // At the fold itself the inverse's slope is infinite, and no polynomial is near it.
        let end = farthest.min(0.999 * distorted);
        let factor = |q: f64| {
            let radius = q.sqrt();
            Some(self.undistorted_radius(&limit, radius)? / radius)
        };
        Limit { start: Start::through(end * end, factor), ..limit }
    }

    /// The distorted point of (x, y); `None` past the fold.
    pub(super) fn distort(&self, limit: &Limit, point: DVec2) -> Option<DVec2> {
        let mapped = self.distorted(limit, point)?;
        self.is_before_fold(limit, point).then_some(mapped.value)
    }

    /// The point whose distorted point is given; `None` where there is none on this side of the
    /// fold.
    pub(super) fn undistort(&self, limit: &Limit, point: DVec2) -> Option<DVec2> {
        let radius = point.length();
        let is_lopsided = self.is_lopsided();
        if radius == 0.0 && !is_lopsided {
            return Some(DVec2::ZERO);
        }
        let radial = if radius < limit.distorted {
            self.undistorted_radius(limit, radius)?
        } else if is_lopsided {
            // A little before the radial fold: the rest of the distortion may carry a point beyond
            // it.
            0.98 * limit.undistorted
        } else {
            return None;
        };
        if !is_lopsided {
            return Some(radial / radius * point);
        }
        let solve = |radial: f64| {
            let start = if radius == 0.0 { DVec2::ZERO } else { radial / radius * point };
            let start = self.before_fold(limit, start)?;
            let found = invert_in_plane(point, start, |at| self.distorted(limit, at))?;
            self.is_before_fold(limit, found).then_some(found)
        };
        // Where the radial distortion hardly rises, the rest of it moves the place far, and a fold
        // may be on the way from the first.
        let others = [1.5, 0.5, 2.5].into_iter();
        let mut others = others.take_while(|_| radius < limit.distorted);
        solve(radial).or_else(|| others.find_map(|share| solve(share * radial)))
    }

    /// [`undistort`](Self::undistort) for a single point or several at once, by Newton's method
    /// from the prepared start; known where it has settled on this side of the fold.
    #[inline(always)]
    pub(super) fn undistorted<A: Arithmetic>(
        &self,
        of: A,
        limit: &Limit,
        [u, v]: Pair<A>,
    ) -> Known<A, 2> {
        /// The most steps: from a start as near as usual, two lead to the last digit.
        const MOST_STEPS: usize = 8;
        /// A step of this share leaves its square, which is less than rounding.
        const SETTLED: f64 = 1e-8;
        let factor = limit.start.at(of, square(of, u, v));
        let (mut x, mut y) = (of.mul(factor, u), of.mul(factor, v));
        if self.is_lopsided() {
            // Once more without what is not radial, as far as it is known by now.
            let [across, down] = self.uneven(of, [x, y]);
            let (u, v) = (of.sub(u, across), of.sub(v, down));
            let factor = limit.start.at(of, square(of, u, v));
            (x, y) = (of.mul(factor, u), of.mul(factor, v));
        }
        let most = of.number(limit.probed * limit.probed);
        let mut settled = of.lt(x, x);
        for _ in 0..MOST_STEPS {
            let (there, jacobian) = self.mapped(of, [x, y]);
            let residual = [of.sub(there[0], u), of.sub(there[1], v)];
            let [xx, xy, yx, yy] = jacobian;
            let determinant = of.sub(of.mul(xx, yy), of.mul(xy, yx));
            let inverse = of.div(of.number(1.0), determinant);
            let across = of.sub(of.mul(residual[0], yy), of.mul(xy, residual[1]));
            let down = of.sub(of.mul(xx, residual[1]), of.mul(yx, residual[0]));
            let step = [of.mul(across, inverse), of.mul(down, inverse)];
            let (next_x, next_y) = (of.sub(x, step[0]), of.sub(y, step[1]));
            let allowed = of.add(
                of.number(f64::MIN_POSITIVE),
                of.mul(of.number(SETTLED * SETTLED), square(of, next_x, next_y)),
            );
            let settles = of.lt(square(of, step[0], step[1]), allowed)
                & of.lt(of.number(0.0), determinant)
                & of.lt(square(of, next_x, next_y), most);
            // A settled point stays, whatever its neighbours do.
            x = of.select(settled, x, next_x);
            y = of.select(settled, y, next_y);
            settled = settled | settles;
            if of.is_everywhere(settled) {
                break;
            }
        }
        ([x, y], settled)
    }

    /// The factor of the radius, and its derivative by q.
    pub(super) fn radial(&self, q: f64) -> [f64; 2] {
        // By Horner's rule: powers of q on their own would leave float64 sooner.
        let (above, rise) = (value(&self.radial, q), value(&slope_of(&self.radial), q));
        let (below, fall) = (value(&self.divisor, q), value(&slope_of(&self.divisor), q));
        let factor = above / below;
        [factor, (rise - factor * fall) / below]
    }

    /// The radius up to which no fold was found, at 64 radii: there the derivative of the radial
    /// part stretches by half more than that of all else can come to. The first stretches by the
    /// factor across and by the slope along the radius, at least; the second by the sum of its
    /// numbers, at most. A fold that is narrower than a step may be missed.
    fn probed(&self, undistorted: f64) -> f64 {
        const STEPS: u32 = 64;
        /// Beyond it the way to each point is looked at ([`is_before_fold`](Self::is_before_fold)).
        const FARTHEST: f64 = 3.0;
        let end = undistorted.min(FARTHEST);
        let firsts = self.tangential[0].abs() + self.tangential[1].abs();
        let [s1, s2, s3, s4] = self.prism.map(f64::abs);
        let (seconds, fourths) = (s1 + s3, s2 + s4);
        let is_clear = |r: f64| {
            let q = r * r;
            let [factor, rate] = self.radial(q);
            let other = 2.0 * r * (6.0 * firsts + 2.0 * seconds + 4.0 * q * fourths);
            // Written so that a NaN fails.
            factor.min(factor + 2.0 * q * rate) > 1.5 * other
        };
        let radii = (0..=STEPS).map(|k| end * f64::from(k) / f64::from(STEPS));
        let fine = radii.clone().take_while(|&r| is_clear(r)).count();
        // The last radius before the first that is not, and a little less.
        radii.take(fine).last().map_or(0.0, |r| 0.9 * r)
    }

    /// Whether it is more than radial.
    #[inline]
    fn is_lopsided(&self) -> bool {
        is_any(&self.tangential) || is_any(&self.prism)
    }

    /// The distorted point of (x, y); `None` past the fold.
    fn distorted(&self, limit: &Limit, point: DVec2) -> Option<Mapped> {
        let DVec2 { x, y } = point;
        let q = x * x + y * y;
        // Written so that a NaN fails.
        let is_inside = q <= limit.outermost * limit.outermost;
        if !is_inside {
            return None;
        }
        let (value, [by_xx, by_xy, by_yx, by_yy]) = self.mapped(Scalar, [x, y]);
        let mapped = Mapped {
            value: value.into(),
            by_x: DVec2::new(by_xx, by_yx),
            by_y: DVec2::new(by_xy, by_yy),
        };
        (mapped.determinant() > 0.0).then_some(mapped)
    }

    /// The distorted point of (x, y) and its derivative: of x by x and y, of y by x and y.
    #[inline(always)]
    fn mapped<A: Arithmetic>(&self, of: A, [x, y]: Pair<A>) -> (Pair<A>, [A::Number; 4]) {
        let (xx, yy, xy) = (of.mul(x, x), of.mul(y, y), of.mul(x, y));
        let q = of.add(xx, yy);
        let [mut factor, mut rate] = value_and_slope(of, &self.radial, q);
        if is_any(&self.divisor[1..]) {
            let [below, fall] = value_and_slope(of, &self.divisor, q);
            let inverse = of.div(of.number(1.0), below);
            factor = of.mul(factor, inverse);
            rate = of.mul(of.sub(rate, of.mul(factor, fall)), inverse);
        }
        let double_rate = of.add(rate, rate);
        let (mut there_x, mut there_y) = (of.mul(x, factor), of.mul(y, factor));
        let mut by_xx = of.add(factor, of.mul(xx, double_rate));
        let mut by_yy = of.add(factor, of.mul(yy, double_rate));
        let mut by_xy = of.mul(xy, double_rate);
        let mut by_yx = by_xy;
        if is_any(&self.tangential) {
            let [p1, p2] = self.tangential;
            let (p1, p2) = (of.number(p1), of.number(p2));
            let (p1x, p1y) = (of.mul(p1, x), of.mul(p1, y));
            let (p2x, p2y) = (of.mul(p2, x), of.mul(p2, y));
            there_x = of.add(
                there_x,
                of.add(of.mul(twice(of, p1), xy), of.mul(p2, of.add(q, twice(of, xx)))),
            );
            there_y = of.add(
                there_y,
                of.add(of.mul(twice(of, p2), xy), of.mul(p1, of.add(q, twice(of, yy)))),
            );
            by_xx = of.add(by_xx, of.add(twice(of, p1y), of.mul(of.number(6.0), p2x)));
            by_yy = of.add(by_yy, of.add(twice(of, p2x), of.mul(of.number(6.0), p1y)));
            let both = twice(of, of.add(p1x, p2y));
            by_xy = of.add(by_xy, both);
            by_yx = of.add(by_yx, both);
        }
        let [s1, s2, s3, s4] = self.prism;
        if is_any(&self.prism) {
            let ([across, across_rate], [down, down_rate]) =
                (prism(of, s1, s2, q), prism(of, s3, s4, q));
            there_x = of.add(there_x, across);
            there_y = of.add(there_y, down);
            by_xx = of.add(by_xx, of.mul(across_rate, x));
            by_xy = of.add(by_xy, of.mul(across_rate, y));
            by_yx = of.add(by_yx, of.mul(down_rate, x));
            by_yy = of.add(by_yy, of.mul(down_rate, y));
        }
        ([there_x, there_y], [by_xx, by_xy, by_yx, by_yy])
    }

    /// The shift of a point by tangential and thin prism distortion.
    #[inline(always)]
    fn uneven<A: Arithmetic>(&self, of: A, [x, y]: Pair<A>) -> Pair<A> {
        let (xx, yy, xy) = (of.mul(x, x), of.mul(y, y), of.mul(x, y));
        let q = of.add(xx, yy);
        let [p1, p2] = self.tangential;
        let (p1, p2) = (of.number(p1), of.number(p2));
        let [s1, s2, s3, s4] = self.prism;
        let of_x = of.mul(p2, of.add(q, twice(of, xx)));
        let of_y = of.mul(p1, of.add(q, twice(of, yy)));
        let across = of.add(of.mul(twice(of, p1), xy), of_x);
        let down = of.add(of.mul(twice(of, p2), xy), of_y);
        let [prism_across, _] = prism(of, s1, s2, q);
        let [prism_down, _] = prism(of, s3, s4, q);
        [of.add(across, prism_across), of.add(down, prism_down)]
    }

    /// The radius before radial distortion of one after it, which is within the limit.
    fn undistorted_radius(&self, limit: &Limit, radius: f64) -> Option<f64> {
        if limit.distorted == f64::INFINITY && limit.undistorted.is_finite() {
            // Up to a pole, where the quotient is not even of a sign: numerator and divisor alone
            // are finite, and cross zero once.
            let crossing = |r: f64| {
                let q = r * r;
                let [above, rise] = value_and_slope(Scalar, &self.radial, q);
                let [below, fall] = value_and_slope(Scalar, &self.divisor, q);
                let slope = above + 2.0 * (q * rise - radius * r * fall);
                [r * above - radius * below, slope]
            };
            return Some(invert(0.0, [0.0, limit.undistorted], radius, crossing));
        }
        let radial = |r: f64| {
            let q = r * r;
            let [factor, rate] = self.radial(q);
            [r * factor, factor + 2.0 * q * rate]
        };
        let mut high = limit.undistorted;
        if high == f64::INFINITY {
            high = radius.max(1.0);
            // A divisor may keep the radius below some value for ever.
            while radial(high)[0] < radius {
                high *= 2.0;
                if high > 1e100 {
                    return None;
                }
            }
        }
        Some(invert(radius, [0.0, high], radius, radial))
    }

    /// Whether there is no fold on the way from the middle to a point: past it there may be other
    /// places that are not turned over.
    ///
    /// The way is looked at from where a fold may be on. A step is a sixteenth of the way at most,
    /// and a quarter of the radius: what folds near the middle is as wide as its radius, however
    /// far out the point is. Where the determinant is least between two steps, it is looked at more
    /// closely: a fold may be as narrow as it likes.
    fn is_before_fold(&self, limit: &Limit, point: DVec2) -> bool {
        let end = point.length();
        let mut radius = limit.probed;
        if end <= radius {
            return true;
        }
        if radius == 0.0 {
            radius = end / 256.0;
        }
        // A last step that tells whether it falls or rises at the point.
        let almost = end * (1.0 - 1.0 / 1024.0);
        let determinant = |radius: f64| {
            let mapped = self.distorted(limit, radius / end * point);
            mapped.map_or(0.0, |mapped| mapped.determinant())
        };
        let mut last = [[radius, f64::INFINITY]; 2];
        // Written so that a NaN is looked at.
        loop {
            let here = [radius, determinant(radius)];
            let [before, middle] = last;
            if here[1] == 0.0
                || (middle[1] < before[1] && middle[1] <= here[1])
                    && !is_above_zero([before, middle, here], determinant)
            {
                return false;
            }
            if radius >= end || radius.is_nan() {
                return true;
            }
            last = [middle, here];
            let next = radius + (end / 16.0).min(radius / 4.0);
            radius = if next < almost {
                next
            } else if radius < almost {
                almost
            } else {
                end
            };
        }
    }

    /// The point, or the first on the way to the middle that is on this side of the fold.
    fn before_fold(&self, limit: &Limit, start: DVec2) -> Option<DVec2> {
        let shares = (0..20).map(|k| 1.0 - 0.05 * f64::from(k));
        let mut points = shares.map(|share| share * start).chain([DVec2::ZERO]);
        points.find(|&point| self.distorted(limit, point).is_some())
    }
}

/// Whether a function is above zero between three places, the middle one of which is the least,
/// where it is at its least in between: by golden section (Kiefer, "Sequential Minimax Search for a
/// Maximum", Proceedings of the AMS 4(3), 1953).
fn is_above_zero([low, middle, high]: [[f64; 2]; 3], f: impl Fn(f64) -> f64) -> bool {
    /// The number of steps, which leave a hundred-thousandth of the interval.
    const STEPS: u32 = 24;
    const SHARE: f64 = 0.381_966_011_250_105_1;
    let (mut low, mut least, mut high) = (low[0], middle, high[0]);
    for _ in 0..STEPS {
        let is_below = least[0] - low > high - least[0];
        let end = if is_below { low } else { high };
        let x = least[0] + SHARE * (end - least[0]);
        let there = [x, f(x)];
        // Written so that a NaN fails.
        let is_above = there[1] > 0.0;
        if !is_above {
            return false;
        }
        let (kept, dropped) = if there[1] < least[1] { (there, least[0]) } else { (least, x) };
        if dropped < kept[0] {
            low = dropped;
        } else {
            high = dropped;
        }
        least = kept;
    }
    true
}

/// Whether any is not zero. A comparison of arrays would be a call.
#[inline(always)]
fn is_any(coefficients: &[f64]) -> bool {
    let mut is_any = false;
    for &coefficient in coefficients {
        is_any |= coefficient != 0.0;
    }
    is_any
}

/// A polynomial's value and slope; coefficients begin with the constant.
#[inline(always)]
fn value_and_slope<A: Arithmetic, const N: usize>(
    of: A,
    coefficients: &[f64; N],
    q: A::Number,
) -> Pair<A> {
    let slope = slope_of(coefficients);
    [polynomial(of, coefficients, q), polynomial(of, &slope[..N - 1], q)]
}

/// The coefficients of a polynomial's derivative, and a zero.
#[inline(always)]
fn slope_of<const N: usize>(coefficients: &[f64; N]) -> [f64; N] {
    let mut slope = [0.0; N];
    for k in 1..N {
        slope[k - 1] = k as f64 * coefficients[k];
    }
    slope
}

/// The shift of a point by a thin prism, and its derivative by x, divided by x.
#[inline(always)]
fn prism<A: Arithmetic>(of: A, first: f64, second: f64, q: A::Number) -> Pair<A> {
    [
        of.mul(q, of.add(of.number(first), of.mul(of.number(second), q))),
        of.add(of.number(2.0 * first), of.mul(of.number(4.0 * second), q)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fold within a quarter of its radius may be passed over; no other one is, however far out
    /// the point is.
    #[test]
    fn a_fold_near_the_middle_is_seen_from_far_out() {
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let (mut folded, mut kept) = (0, 0);
        for _ in 0..300 {
            let lens = Brown {
                radial: [1.0],
                divisor: [1.0, 0.0, 0.0, 0.0],
                tangential: [0.02 * random(), 0.02 * random()],
                prism: std::array::from_fn(|_| 0.1 * random()),
            };
            let limit = lens.limit(2.0);
            for far in [2.0, 10.0, 100.0, 1e4] {
                let point = far * DVec2::new(random(), random());
                // The first turned stretch of the way, in radii from the middle.
                let end = point.length();
                let radii: Vec<f64> = (0..=4000)
                    .map(|k| end * libm::pow(1e-3, 1.0 - f64::from(k) / 4000.0))
                    .collect();
                let is_turned =
                    |radius: &f64| lens.distorted(&limit, *radius / end * point).is_none();
                let own = lens.is_before_fold(&limit, point);
                match radii.iter().position(is_turned) {
                    None => {
                        assert!(own, "{lens:?} {point}");
                        kept += 1;
                    }
                    Some(start) => {
                        let turned = radii[start..].iter().take_while(|r| is_turned(r));
                        let width = turned.last().unwrap() / radii[start];
                        assert!(!own || width < 1.25, "{lens:?} {point}: {width}");
                        folded += 1;
                    }
                }
            }
        }
        assert!(folded > 300 && kept > 300, "{folded} {kept}");
    }
}
