//! Numbers without rounding.

use firsthit::DVec3;
use num_rational::BigRational;
use num_traits::ToPrimitive;

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
    around
        .into_iter()
        .min_by(|x, y| off(x).cmp(&off(y)))
        .unwrap()
}
