//! Newton's method, guarded so that it cannot leave the place where the solution is.

use crate::geometry::DVec2;

/// Solves `f(x) = y` for an `f` that rises from below `y` at `low` to above it at `high`; `f` gives
/// value and slope.
///
/// Newton's method, safeguarded by bisection (`rtsafe` of Press and others, "Numerical Recipes",
/// 2007, section 9.4). A Newton step is taken if it stays in the interval and is at most half as
/// long as the step before; else the interval is halved. Where a power x^p dominates, Newton
/// shortens the distance to the root only by the factor (p - 1) / p a step, and bisection is
/// faster.
pub(super) fn invert(
    y: f64,
    [mut low, mut high]: [f64; 2],
    start: f64,
    f: impl Fn(f64) -> [f64; 2],
) -> f64 {
    /// Bisection alone would be done by then, from the largest number to the smallest.
    const MOST_STEPS: usize = 2200;
    /// Steps shorter than this are rounding: they need not halve.
    const SMALL: f64 = 16.0 * f64::EPSILON;
    let mut x = start.clamp(low, high);
    let mut last_step = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let [value, slope] = f(x);
        let off = value - y;
        if off > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - off / slope;
        if off == 0.0 || (newton - x).abs() <= f64::EPSILON * x.abs() {
            break;
        }
        // Written so that a NaN leads to the middle.
        let is_inside = newton > low && newton < high;
        let allowed = (0.5 * last_step).max(SMALL * x.abs());
        let next =
            if is_inside && (newton - x).abs() <= allowed { newton } else { low.midpoint(high) };
        last_step = (next - x).abs();
        x = next;
    }
    x
}

/// A map of the plane at a point: its value, and the columns of its derivative.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mapped {
    pub(super) value: DVec2,
    pub(super) by_x: DVec2,
    pub(super) by_y: DVec2,
}

impl Mapped {
    /// The determinant of the derivative: positive up to the fold.
    pub(super) fn determinant(&self) -> f64 {
        self.by_x.perp_dot(self.by_y)
    }
}

/// Solves `f(x) = y` near `start`, where the derivative is regular and turns nothing over.
///
/// `f` gives nothing outside its domain. A step that would leave it, cross the fold or lead farther
/// away is halved. `None` where there is no solution.
pub(super) fn invert_in_plane(
    y: DVec2,
    start: DVec2,
    f: impl Fn(DVec2) -> Option<Mapped>,
) -> Option<DVec2> {
    const MOST_STEPS: usize = 100;
    const MOST_HALVES: usize = 40;
    let off = |mapped: &Mapped| (mapped.value - y).length();
    let mut x = start;
    let mut at = f(x)?;
    for _ in 0..MOST_STEPS {
        let residual = at.value - y;
        let determinant = at.determinant();
        let step = DVec2::new(residual.perp_dot(at.by_y), at.by_x.perp_dot(residual)) / determinant;
        // Written so that a NaN ends it.
        let moves = step.abs().max_element() > 0.25 * f64::EPSILON * x.abs().max_element();
        if residual == DVec2::ZERO || !moves {
            break;
        }
        let mut share = 1.0;
        let mut next = None;
        for _ in 0..MOST_HALVES {
            let there = x - share * step;
            next = f(there).filter(|mapped| off(mapped) < off(&at)).map(|mapped| (there, mapped));
            if next.is_some() {
                break;
            }
            share *= 0.5;
        }
        // As near as rounding allows.
        let Some(better) = next else { break };
        (x, at) = better;
    }
    let size = y.abs().max_element().max(x.abs().max_element());
    (off(&at) <= 1e-13 * size.max(f64::MIN_POSITIVE)).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_many_magnitudes_below_the_start_are_found() {
        for (k, power) in [(0.1, 5), (1e100, 5), (1e300, 5), (1e120, 3), (1e90, 11), (1e300, 2)] {
            let f = |r: f64| {
                let high = k * libm::pow(r, f64::from(power - 1));
                [r + r * high, 1.0 + f64::from(power) * high]
            };
            let r = invert(0.7, [0.0, 0.7], 0.7, f);
            assert!((f(r)[0] - 0.7).abs() < 1e-13, "{k:e} {power}: {r:e}");
        }
    }
}
