//! A fast reader for the lines that most files consist of.
//!
//! It returns `None` for any other line. The reader of all lines takes those, and gives the same
//! result for a plain one.

use crate::io::decimal;

/// A line of numbers and nothing else, after its keyword; and what follows the line.
#[inline]
pub(super) fn numbers<const N: usize>(text: &[u8]) -> Option<([f64; N], &[u8])> {
    let mut rest = text;
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        rest = after_blanks(rest)?;
        (*number, rest) = decimal::number(rest)?;
    }
    Some((numbers, line_end(rest)?))
}

/// The indices of a corner, as they are stated; 0 where there is none.
pub(super) type Corner = [i64; 3];

/// The corners of a face; returns what follows the line.
#[inline]
pub(super) fn face<'a>(text: &'a [u8], corners: &mut Vec<Corner>) -> Option<&'a [u8]> {
    corners.clear();
    let mut rest = text;
    loop {
        if !corners.is_empty()
            && let Some(rest) = line_end(rest)
        {
            return Some(rest);
        }
        rest = after_blanks(rest)?;
        let corner;
        (corner, rest) = read_corner(rest)?;
        corners.push(corner);
    }
}

#[inline]
fn read_corner(text: &[u8]) -> Option<(Corner, &[u8])> {
    let (vertex, rest) = index(text)?;
    let [b'/', rest @ ..] = rest else {
        return Some(([vertex, 0, 0], rest));
    };
    let (uv, rest) = match rest {
        [b'/', ..] => (0, rest),
        _ => index(rest)?,
    };
    let [b'/', rest @ ..] = rest else {
        return Some(([vertex, uv, 0], rest));
    };
    let (normal, rest) = index(rest)?;
    Some(([vertex, uv, normal], rest))
}

/// An index that is stated, so never 0.
#[inline]
fn index(text: &[u8]) -> Option<(i64, &[u8])> {
    decimal::integer(text).filter(|&(index, _)| index != 0)
}

/// The text after at least one blank.
#[inline]
fn after_blanks(text: &[u8]) -> Option<&[u8]> {
    let [b' ' | b'\t', rest @ ..] = text else {
        return None;
    };
    Some(passed_blanks(rest))
}

#[inline]
fn passed_blanks(mut text: &[u8]) -> &[u8] {
    while let [b' ' | b'\t', rest @ ..] = text {
        text = rest;
    }
    text
}

#[inline]
fn line_end(text: &[u8]) -> Option<&[u8]> {
    match passed_blanks(text) {
        [b'\r', b'\n', rest @ ..] | [b'\n' | b'\r', rest @ ..] | rest @ [] => Some(rest),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_lines_are_read_and_others_are_left() {
        assert_eq!(numbers(b" 1 -2.5\t3 \r\nv"), Some(([1.0, -2.5, 3.0], &b"v"[..])));
        for line in [&b" 1 2"[..], b" 1 2 3 4", b" 1 2 3 # x", b" 1 2 nan", b" 1 2 \\\n3"] {
            assert_eq!(numbers::<3>(line), None);
        }
        let mut corners = Vec::new();
        assert_eq!(face(b" 1 2/3 -1//4 5/6/7\rf", &mut corners), Some(&b"f"[..]));
        assert_eq!(corners, [[1, 0, 0], [2, 3, 0], [-1, 0, 4], [5, 6, 7]]);
        for line in [&b""[..], b" ", b" 1 0 2", b" 1/ 2 3", b" 1 2 3 x", b" 1/2/3/4", b" 1//"] {
            assert_eq!(face(line, &mut corners), None);
        }
    }
}
