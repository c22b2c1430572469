//! Numbers in words, as the program prints them.

use firsthit::DVec3;

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
