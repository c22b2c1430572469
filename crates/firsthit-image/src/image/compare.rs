use super::decode::output::{Array, ArrayValues};
use crate::geometry::single;

/// The difference of two channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The number of elements (pixels, rays).
    pub elements: usize,
    /// The number of elements that differ by more than the tolerance.
    pub differing: usize,
    /// The largest absolute difference of two numbers as the files have them; infinity where one of
    /// them is infinite or NaN.
    pub largest: f64,
    /// The two numbers whose difference is the largest, of equals the first; `None` where all are
    /// equal to the last digit.
    pub values: Option<[f64; 2]>,
    /// The element that these are of.
    pub element: usize,
    /// The largest difference between finite floats in units in the last place, that is how many
    /// floats lie between them, and one; `None` for whole numbers.
    pub ulps: Option<u64>,
    /// The type that the numbers were compared in.
    pub compared_as: &'static str,
}

/// Compares two channels number by number, by the lower precision of the two: a float64 is rounded
/// where the other file has float32. NaN equals NaN, an infinity itself. Whole numbers, which are
/// identifiers, differ or do not: the `tolerance` is for floats, and for bytes to look at.
///
/// # Errors
///
/// In words, why they cannot be compared: different shapes, or bytes to look at and values.
pub fn compare(a: &Array, b: &Array, tolerance: f64) -> Result<Difference, String> {
    if a.is_picture != b.is_picture {
        return Err("one holds bytes to look at, the other values".to_owned());
    }
    if a.shape != b.shape {
        return Err(format!("the shapes {:?} and {:?} differ", a.shape, b.shape));
    }
    let compared = match (&a.numbers, &b.numbers) {
        (ArrayValues::Integer(a_values), ArrayValues::Integer(b_values)) => {
            let tolerance = if a.is_picture { tolerance } else { 0.0 };
            let pairs = a_values.iter().zip(b_values).map(|(&a, &b)| Pair {
                difference: a.abs_diff(b) as f64,
                values: [a as f64, b as f64],
                ulps: 0,
            });
            Difference {
                ulps: None,
                compared_as: "whole numbers",
                ..largest(pairs, tolerance, a.components)
            }
        }
        (
            ArrayValues::Float64(_) | ArrayValues::Integer(_),
            ArrayValues::Float64(_) | ArrayValues::Integer(_),
        ) => {
            let pairs = doubles(&a.numbers).zip(doubles(&b.numbers));
            let pairs = pairs.map(|(a, b)| pair([a, b], [a, b], ordered(a).abs_diff(ordered(b))));
            Difference { compared_as: "float64", ..largest(pairs, tolerance, a.components) }
        }
        _ => {
            let pairs = doubles(&a.numbers).zip(doubles(&b.numbers));
            let pairs = pairs.map(|(a, b)| {
                let singles = [single(a), single(b)];
                let [one, other] = singles.map(ordered_single);
                pair([a, b], singles.map(f64::from), one.abs_diff(other))
            });
            Difference { compared_as: "float32", ..largest(pairs, tolerance, a.components) }
        }
    };
    Ok(compared)
}

struct Pair {
    /// As the numbers are compared.
    difference: f64,
    /// As the files have them.
    values: [f64; 2],
    ulps: u64,
}

fn pair(values: [f64; 2], compared: [f64; 2], ulps: u64) -> Pair {
    let is_finite = compared.iter().all(|value| value.is_finite());
    Pair { difference: apart(compared), values, ulps: if is_finite { ulps } else { 0 } }
}

/// The difference of two numbers; a NaN or an infinity on one side is as far away as can be.
fn apart([a, b]: [f64; 2]) -> f64 {
    if a == b || a.is_nan() && b.is_nan() {
        return 0.0;
    }
    let difference = (a - b).abs();
    if difference.is_nan() { f64::INFINITY } else { difference }
}

fn largest(pairs: impl Iterator<Item = Pair>, tolerance: f64, components: usize) -> Difference {
    let components = components.max(1);
    let mut found = Difference {
        elements: 0,
        differing: 0,
        largest: 0.0,
        values: None,
        element: 0,
        ulps: Some(0),
        compared_as: "",
    };
    let mut counted = None;
    let mut numbers = 0;
    for (index, pair) in pairs.enumerate() {
        numbers = index + 1;
        let difference = apart(pair.values);
        let element = index / components;
        found.ulps = found.ulps.max(Some(pair.ulps));
        if difference > found.largest {
            found.largest = difference;
            found.values = Some(pair.values);
            found.element = element;
        }
        if pair.difference > tolerance && counted != Some(element) {
            found.differing += 1;
            counted = Some(element);
        }
    }
    found.elements = numbers / components;
    found
}

fn doubles(numbers: &ArrayValues) -> Box<dyn Iterator<Item = f64> + '_> {
    match numbers {
        ArrayValues::Float64(values) => Box::new(values.iter().copied()),
        ArrayValues::Float32(values) => Box::new(values.iter().map(|&value| f64::from(value))),
        ArrayValues::Integer(values) => Box::new(values.iter().map(|&value| value as f64)),
    }
}

/// The place of a float among all floats: neighbours differ by one, and both zeros are the same.
fn ordered(value: f64) -> i64 {
    let bits = value.abs().to_bits().cast_signed();
    if value.is_sign_negative() { -bits } else { bits }
}

fn ordered_single(value: f32) -> i64 {
    let bits = i64::from(value.abs().to_bits());
    if value.is_sign_negative() { -bits } else { bits }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(numbers: ArrayValues, components: usize) -> Array {
        Array {
            name: None,
            shape: vec![numbers.len() / components, components],
            components,
            numbers,
            dtype: String::new(),
            is_picture: false,
        }
    }

    fn doubles_of(a: &[f64], b: &[f64], tolerance: f64) -> Difference {
        let [a, b] = [a, b].map(|values| array(ArrayValues::Float64(values.to_vec()), 1));
        compare(&a, &b, tolerance).unwrap()
    }

    #[test]
    fn nan_equals_nan_and_infinity_itself() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        let same = doubles_of(&[nan, inf, 0.0], &[-nan, inf, -0.0], 0.0);
        assert_eq!((same.differing, same.values, same.ulps), (0, None, Some(0)));
        for other in [nan, -inf, 1.0] {
            let found = doubles_of(&[1.0, inf], &[1.0, other], 1e300);
            assert_eq!((found.differing, found.largest, found.element), (1, inf, 1));
        }
    }

    #[test]
    fn the_largest_difference_is_told_with_its_place_and_its_ulps() {
        let next = 1.0 + f64::EPSILON;
        let found = doubles_of(&[1.0, 5.0, 2.0], &[next, 5.5, 2.25], 0.3);
        assert_eq!((found.differing, found.elements), (1, 3));
        assert_eq!((found.largest, found.element), (0.5, 1));
        assert_eq!(found.values, Some([5.0, 5.5]));
        assert_eq!(doubles_of(&[1.0], &[next], 0.0).ulps, Some(1));
        assert_eq!(doubles_of(&[-5e-324], &[5e-324], 0.0).ulps, Some(2));
    }

    #[test]
    fn the_lower_precision_decides() {
        let double = array(ArrayValues::Float64(vec![0.1, 0.2]), 1);
        let single = array(ArrayValues::Float32(vec![0.1, 0.200_000_03]), 1);
        let found = compare(&double, &single, 0.0).unwrap();
        assert_eq!((found.differing, found.ulps), (1, Some(2)));
        assert_eq!(found.compared_as, "float32");
        // A difference that float32 has no digits for is told all the same.
        let double = array(ArrayValues::Float64(vec![1.0, 4_500_000.2]), 1);
        let single = array(ArrayValues::Float32(vec![1.0, 4_500_000.0]), 1);
        let found = compare(&double, &single, 0.0).unwrap();
        assert_eq!((found.differing, found.ulps, found.element), (0, Some(0), 1));
        assert_eq!(found.values, Some([4_500_000.2, 4_500_000.0]));
        assert!((found.largest - 0.2).abs() < 1e-9);
    }

    #[test]
    fn elements_are_counted_once_and_identifiers_have_no_tolerance() {
        let [a, b] = [[1, 2, 3, 4, 5, 6], [1, 9, 9, 4, 5, 7]]
            .map(|values| array(ArrayValues::Integer(values.to_vec()), 3));
        let found = compare(&a, &b, 100.0).unwrap();
        assert_eq!((found.differing, found.elements, found.ulps), (2, 2, None));
        let mut picture = b.clone();
        picture.is_picture = true;
        assert!(compare(&a, &picture, 0.0).is_err());
        let other = array(ArrayValues::Integer(vec![0; 3]), 3);
        assert!(compare(&a, &other, 0.0).unwrap_err().contains("shapes"));
    }
}
