//! Decimal numbers, fast where that is exact.

/// Powers of ten that float64 holds exactly.
const TENS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Integers up to here are float64.
const LARGEST_WHOLE: u64 = 1 << 53;

/// The most digits that surely fit.
const MOST_DIGITS: usize = 18;

/// The number at the start of `text`, and the rest of the text, if float64 holds both its digits
/// and its power of ten exactly: then one operation rounds correctly (Clinger, "How to Read
/// Floating Point Numbers Accurately", PLDI 1990). `None` says nothing about the text.
#[inline]
pub(super) fn number(text: &[u8]) -> Option<(f64, &[u8])> {
    let (is_negative, rest) = sign(text);
    let (whole, rest, before) = digits(0, rest);
    let (digits, rest, after) = match rest {
        [b'.', rest @ ..] => digits(whole, rest),
        _ => (whole, rest, 0),
    };
    if before + after == 0 || before + after > MOST_DIGITS || digits > LARGEST_WHOLE {
        return None;
    }
    let (exponent, rest) = match rest {
        [b'e' | b'E', rest @ ..] => exponent(rest)?,
        _ => (0, rest),
    };
    let power = exponent - i32::try_from(after).ok()?;
    let size = *TENS.get(power.unsigned_abs() as usize)?;
    let magnitude = if power < 0 { digits as f64 / size } else { digits as f64 * size };
    Some((if is_negative { -magnitude } else { magnitude }, rest))
}

/// Whether a text begins with a minus, and what follows its sign.
#[inline]
fn sign(text: &[u8]) -> (bool, &[u8]) {
    match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    }
}

/// Appends the digits at the start of a text to a number; with it come what follows, and how many
/// there were.
#[inline]
fn digits(mut number: u64, text: &[u8]) -> (u64, &[u8], usize) {
    let mut rest = text;
    while let [digit @ b'0'..=b'9', more @ ..] = rest {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        rest = more;
    }
    (number, rest, text.len() - rest.len())
}

fn exponent(text: &[u8]) -> Option<(i32, &[u8])> {
    let (is_negative, rest) = sign(text);
    let (exponent, rest, count) = digits(0, rest);
    let exponent = i32::try_from(exponent).ok()?;
    (1..=4).contains(&count).then_some((if is_negative { -exponent } else { exponent }, rest))
}

/// The integer at the start of `text`, of at most nine digits, and what follows it.
#[inline]
pub(super) fn integer(text: &[u8]) -> Option<(i64, &[u8])> {
    let (is_negative, rest) = match text {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, text),
    };
    let (number, rest, count) = digits(0, rest);
    let number = i64::try_from(number).ok()?;
    (1..=9).contains(&count).then_some((if is_negative { -number } else { number }, rest))
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;

    #[test]
    fn what_is_read_fast_is_what_the_standard_library_reads() {
        let mut state = 1_u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            usize::try_from((state >> 33) % below).unwrap()
        };
        let mut fast = 0;
        for _ in 0..200_000 {
            let sign = ["", "-", "+"][random(3)];
            let (whole, power) = (random(1 << 40), random(60));
            let places = random(12);
            let mut word = format!("{sign}{whole}.{:0places$}", random(1 << 20));
            if random(2) == 0 {
                write!(word, "e{}", i64::try_from(power).unwrap() - 30).unwrap();
            }
            if let Some((number, rest)) = number(word.as_bytes()) {
                assert_eq!((number, rest), (word.parse().unwrap(), &b""[..]), "{word}");
                fast += 1;
            }
        }
        assert!(fast > 20_000, "{fast}");
    }

    #[test]
    fn a_number_ends_where_its_digits_end() {
        assert_eq!(number(b"-.5 7"), Some((-0.5, &b" 7"[..])));
        assert_eq!(number(b"5.e1x"), Some((50.0, &b"x"[..])));
        assert_eq!(number(b"-0").map(|(zero, _)| zero.is_sign_negative()), Some(true));
        for text in [&b""[..], b".", b"-", b"e5", b"nan", b"1e", b"1e+", b"12345678901234567890"] {
            assert_eq!(number(text), None);
        }
        assert_eq!(integer(b"-12/3"), Some((-12, &b"/3"[..])));
        assert_eq!(integer(b"1234567890"), None);
    }
}
