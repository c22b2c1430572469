//! Polynomials of one variable: their values, products, and where they change their sign at
//! positive x.

/// The value at `x`; coefficients begin with the constant.
pub(super) fn value(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The derivative's coefficients.
fn derivative(coefficients: &[f64]) -> Vec<f64> {
    let terms = coefficients.iter().enumerate().skip(1);
    terms.map(|(power, c)| power as f64 * c).collect()
}

/// The product's coefficients.
pub(super) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; (a.len() + b.len()).saturating_sub(1)];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// The positive x at which the polynomial changes its sign, in rising order.
///
/// Between two neighbouring roots of the derivative it is monotone, so a change of sign there
/// encloses one root, which bisection finds to the last digit.
pub(super) fn sign_changes(coefficients: &[f64]) -> Vec<f64> {
    let degree = coefficients.iter().rposition(|&c| c != 0.0).unwrap_or(0);
    let coefficients = &coefficients[..(degree + 1).min(coefficients.len())];
    if degree == 0 {
        return Vec::new();
    }
    // Cauchy's bound of all roots.
    let leading = coefficients[degree].abs();
    let largest = coefficients[..degree].iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let bound = 1.0 + largest / leading;
    let mut ends = vec![0.0];
    ends.extend(sign_changes(&derivative(coefficients)));
    ends.push(bound.min(f64::MAX));
    let mut roots = Vec::new();
    let mut is_positive = coefficients.iter().find(|&&c| c != 0.0) > Some(&0.0);
    for pair in ends.windows(2) {
        let (mut low, mut high) = (pair[0], pair[1]);
        // Where it only touches zero, its sign stays.
        let end = value(coefficients, high);
        if low >= high || end == 0.0 || is_positive == (end > 0.0) {
            continue;
        }
        loop {
            let middle = low.midpoint(high);
            if middle <= low || middle >= high {
                break;
            }
            if (value(coefficients, middle) > 0.0) == is_positive {
                low = middle;
            } else {
                high = middle;
            }
        }
        roots.push(high);
        is_positive = !is_positive;
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_found_in_order() {
        // (x - 1)(x - 2)(x + 3)(x - 1000).
        let mut coefficients = vec![1.0];
        for root in [1.0, 2.0, -3.0, 1000.0] {
            coefficients = product(&coefficients, &[-root, 1.0]);
        }
        let roots = sign_changes(&coefficients);
        assert_eq!(roots.len(), 3);
        for (root, expected) in roots.iter().zip([1.0, 2.0, 1000.0]) {
            assert!((root - expected).abs() < 1e-12 * expected, "{root}");
        }
    }

    #[test]
    fn a_root_that_only_touches_is_no_change_of_sign() {
        let squared = product(&[-1.0, 1.0], &[-1.0, 1.0]);
        assert!(sign_changes(&squared).is_empty());
        assert!(sign_changes(&[1.0]).is_empty());
        assert!(sign_changes(&[1.0, 0.0, 0.0]).is_empty());
        let root = sign_changes(&[-2.0, 1.0, 0.0])[0];
        assert!((root - 2.0).abs() < 1e-15, "{root}");
    }
}
