//! Numbers in words, as the program prints them.

use firsthit::{Bounds, DVec3};

/// A vector as the command line has it, to six digits.
pub fn triple(v: DVec3) -> String {
    format!("{},{},{}", number(v.x), number(v.y), number(v.z))
}

/// A vector as the command line has it, to all its digits.
pub fn exact_triple(v: DVec3) -> String {
    v.to_array().map(exact_number).join(",")
}

/// `x` rounded to six significant digits. JSON has all digits.
pub fn six_digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// A number to six digits, in exponential notation if it would have many zeros.
pub fn number(x: f64) -> String {
    exact_number(six_digits(x))
}

/// A place in a scene that reaches so far: each coordinate to six digits, and to as many more as
/// tell it to a millionth of that.
pub fn place(v: DVec3, extent: f64) -> String {
    let [x, y, z] = v.to_array().map(|x| coordinate(x, extent));
    format!("{x},{y},{z}")
}

/// The extent of a scene: the longest side of the box around it.
pub fn extent(bounds: Bounds) -> f64 {
    bounds.size().max_element()
}

/// A length along an axis of such a scene.
pub fn coordinate(x: f64, extent: f64) -> String {
    let step = extent / 1e6;
    if !(x.is_normal() && step.is_normal()) {
        return number(x);
    }
    let digits = (leading(x) - leading(step) + 1).clamp(6, 17);
    let after = usize::try_from(digits - 1).unwrap_or(5);
    format!("{x:.after$e}").parse().map_or_else(|_| number(x), exact_number)
}

/// The power of ten of the first digit.
fn leading(x: f64) -> i32 {
    let text = format!("{x:e}");
    let power = text.split('e').nth(1);
    power.and_then(|power| power.parse().ok()).unwrap_or(0)
}

/// A number to all its digits, in exponential notation if it would have many zeros.
pub fn exact_number(x: f64) -> String {
    if x == 0.0 || (1e-9..1e16).contains(&x.abs()) {
        return x.to_string();
    }
    format!("{x:e}")
}

/// A number with its noun: `1 ray`, `2 rays`.
pub fn counted(count: u64, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_far_from_the_origin_is_told_to_a_millionth_of_the_scene() {
        let far = DVec3::new(500_003.812_345_678, -4_649_776.25, 12.345_678_9);
        assert_eq!(place(far, 100.0), "500003.8123,-4649776.25,12.3457");
        assert_eq!(place(far, 1e9), triple(far));
        for unknown in [0.0, f64::INFINITY, f64::NAN] {
            assert_eq!(place(far, unknown), triple(far), "{unknown}");
        }
        assert_eq!(place(DVec3::new(0.0, f64::NAN, f64::INFINITY), 1.0), "0,NaN,inf");
    }
}
