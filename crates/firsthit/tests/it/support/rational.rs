//! Numbers without rounding.

use firsthit::{DVec2, DVec3};
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

pub(crate) type Exact = [BigRational; 3];

pub(crate) fn number(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

pub(crate) fn exact(v: DVec3) -> Exact {
    v.to_array().map(number)
}

pub(crate) fn minus(p: &Exact, q: &Exact) -> Exact {
    std::array::from_fn(|k| &p[k] - &q[k])
}

pub(crate) fn cross(p: &Exact, q: &Exact) -> Exact {
    [(1, 2), (2, 0), (0, 1)].map(|(k, l)| &p[k] * &q[l] - &p[l] * &q[k])
}

pub(crate) fn dot(p: &Exact, q: &Exact) -> BigRational {
    &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
}

/// The float64 nearest to `t`.
pub(crate) fn nearest(t: &BigRational) -> f64 {
    let first = t.to_f64().unwrap();
    let off = |x: &f64| {
        let off = number(*x) - t;
        if off < number(0.0) { -off } else { off }
    };
    let around = [first.next_down(), first, first.next_up()];
    around.into_iter().min_by(|x, y| off(x).cmp(&off(y))).unwrap()
}

/// The point of a triangle that a ray leaves. A weight is zero where it moves the point by no more
/// than the point's rounding, 2^-49 of the largest coordinate.
pub(crate) fn point_left(corners: [DVec3; 3], barycentric: DVec2) -> Exact {
    let largest_of = |vectors: [DVec3; 3]| {
        let largest = vectors.map(|v| v.abs().max_element());
        number(largest.into_iter().fold(0.0, f64::max))
    };
    let [a, b, c] = corners;
    let rounding = number(8.0 * f64::EPSILON) * largest_of(corners);
    let longest = largest_of([b - a, c - a, c - b]);
    let (zero, one) = (BigRational::zero(), BigRational::one());
    let [v, w] = barycentric.to_array().map(|weight| number(weight.clamp(0.0, 1.0)));
    let u = &one - &v - &w;
    let [has_u, has_v, has_w] = [&u, &v, &w].map(|weight| weight * &longest > rounding);
    let w = match (has_u, has_v, has_w) {
        (_, _, false) => zero.clone(),
        (false, false, true) => one.clone(),
        _ => w,
    };
    let v = match (has_u, has_v) {
        (_, false) => zero,
        (false, true) => one - &w,
        _ => v,
    };
    let (e, f) = (minus(&exact(b), &exact(a)), minus(&exact(c), &exact(a)));
    let a = exact(a);
    std::array::from_fn(|k| &a[k] + &v * &e[k] + &w * &f[k])
}
