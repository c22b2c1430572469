//! The numbers beside a bar, as short as they can be.

/// The numbers at `steps` even steps of a range, from its low end on: with the decimals that tell a
/// hundredth of the range, or as powers of ten where those are many.
pub(super) fn labels([low, high]: [f64; 2], steps: usize) -> Vec<String> {
    let last = steps as f64;
    let number = |step: usize| {
        let share = step as f64 / last;
        low * (1.0 - share) + high * share
    };
    // Halves, because the difference of two float64 may be infinite.
    let step = (high / 2.0 - low / 2.0) / 50.0;
    let most = low.abs().max(high.abs());
    let decimals = (0..=MOST).find(|&decimals| step == 0.0 || scaled(step, decimals) >= 1.0);
    let text = |number: f64| match decimals {
        Some(decimals) if step > 0.0 && most < 1e7 => trimmed(&format!("{number:.decimals$}")),
        _ => rounded(number),
    };
    (0..=steps).map(|step| text(number(step))).collect()
}

/// The most decimals of a short number.
const MOST: usize = 5;

fn scaled(number: f64, decimals: usize) -> f64 {
    (0..decimals).fold(number, |number, _| 10.0 * number)
}

/// The number rounded to four digits.
fn rounded(number: f64) -> String {
    let number = format!("{number:.3e}").parse().unwrap_or(number);
    if number == 0.0 || (1e-4..1e7).contains(&number.abs()) {
        trimmed(&number.to_string())
    } else {
        format!("{number:e}")
    }
}

/// The number without zeros at the end of decimals, and without the sign of a zero.
fn trimmed(text: &str) -> String {
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    };
    if text == "-0" { "0" } else { text }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_differ() {
        assert_eq!(labels([0.0, 1.0], 4), ["0", "0.25", "0.5", "0.75", "1"]);
        assert_eq!(labels([-1.0, 3.0], 2), ["-1", "1", "3"]);
        assert_eq!(labels([20.0, 1250.0], 1), ["20", "1250"]);
        assert_eq!(labels([-0.001, 0.001], 2), ["-0.001", "0", "0.001"]);
        assert_eq!(labels([1000.0, 1000.1], 1), ["1000", "1000.1"]);
        assert_eq!(labels([0.0, 3e9], 2), ["0", "1.5e9", "3e9"]);
        assert_eq!(labels([0.0, 2e-9], 1), ["0", "2e-9"]);
        assert_eq!(labels([5.0, 5.0], 1), ["5", "5"]);
        assert_eq!(labels([-1.7e308, 1.7e308], 2)[1], "0");
    }
}
