use std::ops::{Add, Mul, Sub};

use super::DVec3;

/// A number as the sum of two float64, about 106 bits long.
///
/// Dekker, "A Floating-Point Technique for Extending the Available Precision", Numerische Mathematik 18,
/// 1971; products by a fused multiply-add.
#[derive(Debug, Clone, Copy)]
struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// `a + b`, exactly (Knuth's sum, for numbers of any size).
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let of_b = high - a;
        let low = (a - (high - of_b)) + (b - of_b);
        Self { high, low }
    }

    /// `a - b`, exactly.
    fn difference(a: f64, b: f64) -> Self {
        Self::sum(a, -b)
    }

    /// The nearest float64.
    fn value(self) -> f64 {
        self.high + self.low
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = Self::sum(self.high, other.high);
        Self::sum(sum.high, sum.low + (self.low + other.low))
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + Self {
            high: -other.high,
            low: -other.low,
        }
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let rounded = self.high.mul_add(other.high, -high);
        Self::sum(
            high,
            rounded + (self.high * other.low + self.low * other.high),
        )
    }
}

/// A vector of [`Double`]s.
type Vector = [Double; 3];

/// `a - b`, exactly.
fn between(a: DVec3, b: DVec3) -> Vector {
    std::array::from_fn(|k| Double::difference(a[k], b[k]))
}

fn cross(a: Vector, b: Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(y, z)| a[y] * b[z] - a[z] * b[y])
}

fn dot(a: Vector, b: Vector) -> Double {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Where the line from `origin` along `direction` crosses the plane through three points, to the last
/// digits however far away the points are; NaN or infinite for a line along the plane.
pub fn plane_crossing(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = cross(between(b, a), between(c, a));
    let direction = direction.to_array().map(Double::from);
    dot(normal, between(a, origin)).value() / dot(normal, direction).value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_float64_loses_is_kept() {
        let twice = Double::difference(1.0, 1e-20) * Double::from(2.0);
        assert_eq!((twice - Double::from(2.0)).value(), -2e-20);
    }

    /// A floor whose corners are 10^12 away, seen from a hand's breadth above it.
    #[test]
    fn a_far_triangles_plane_is_where_it_is() {
        let far = 1e12;
        let corners =
            [(-far, -far), (far, -far), (0.0, far)].map(|(x, y)| DVec3::new(x, y, 0.25 * x));
        let t = plane_crossing(
            DVec3::new(0.7, 0.3, 0.5),
            DVec3::new(0.0, 0.5, -1.0),
            corners,
        );
        assert_eq!(t, 0.325);
    }
}
