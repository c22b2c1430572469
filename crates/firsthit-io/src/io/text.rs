//! Lines, words and numbers of text files, in every encoding and line ending that is met.

use std::borrow::Cow;

use super::decimal;
use crate::error::escape_controls;

/// The text as UTF-8, without its byte order mark. Text without a mark is never taken for UTF-16.
/// Invalid sequences become U+FFFD.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, [u8]> {
    if let Some(rest) = bytes.strip_prefix(b"\xef\xbb\xbf") {
        Cow::Borrowed(rest)
    } else if let Some(rest) = bytes.strip_prefix(b"\xff\xfe") {
        Cow::Owned(from_utf16(rest, u16::from_le_bytes))
    } else if let Some(rest) = bytes.strip_prefix(b"\xfe\xff") {
        Cow::Owned(from_utf16(rest, u16::from_be_bytes))
    } else {
        Cow::Borrowed(bytes)
    }
}

fn from_utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Vec<u8> {
    let (pairs, _) = bytes.as_chunks::<2>();
    char::decode_utf16(pairs.iter().map(|&pair| unit(pair)))
        .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect::<String>()
        .into_bytes()
}

/// The lines of a text, ended by LF, CR LF or CR.
#[derive(Debug, Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    /// The number of the line that came last, counted from 1.
    pub(super) number: u64,
    /// Whether a CR alone ends a line even before an LF, which is then content.
    pub(super) bare_cr: bool,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: text, number: 0, bare_cr: false }
    }

    /// Passes over a line that was read from [`Lines::rest`], to what follows it.
    pub(super) fn pass(&mut self, rest: &'a [u8]) {
        self.number += 1;
        self.rest = rest;
    }

    /// The text after the latest line.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = memchr::memchr2(b'\n', b'\r', self.rest).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at_checked(end)?;
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] if !self.bare_cr => rest,
            [_, rest @ ..] => rest,
            [] => rest,
        };
        Some(line)
    }
}

/// The last line of a text, if it has no line break: many whole files end so, and so do truncated
/// ones.
pub(super) fn unended_line(text: &[u8]) -> Option<&[u8]> {
    let start = memchr::memrchr2(b'\n', b'\r', text).map_or(0, |end| end + 1);
    text.get(start..).filter(|line| !line.is_empty())
}

/// The message about a last line without a line break that makes no sense as the last.
pub(super) fn unended(line: &[u8], why: &str) -> String {
    let line = shown(line);
    format!("its last line has no line break, and {why}: '{line}'")
}

/// The words of a line, between blanks.
#[derive(Debug, Clone, Default)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Words<'a> {
    pub(super) fn new(line: &'a [u8]) -> Self {
        Self { rest: line }
    }

    /// All that is left of the line, without blanks around it.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest.trim_ascii()
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|&byte| !is_blank(byte))?;
        let (_, rest) = self.rest.split_at_checked(start)?;
        let end = rest.iter().position(|&byte| is_blank(byte));
        let (word, rest) = rest.split_at_checked(end.unwrap_or(rest.len()))?;
        self.rest = rest;
        Some(word)
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

/// The number that a word spells, with any of `.5`, `5.`, `1E+05`, `inf`, `nan`.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    if let Some((number, [])) = decimal::number(word) {
        return Some(number);
    }
    str::from_utf8(word).ok()?.parse().ok()
}

/// The next word as a number.
///
/// # Errors
///
/// In words, for a word that is missing or no number.
pub(super) fn next_number(words: &mut Words) -> Result<f64, String> {
    let word = words.next().ok_or("a number is missing")?;
    number(word).ok_or_else(|| format!("'{}' is not a number", shown(word)))
}

/// A piece of a file as one short line for a message.
pub(super) fn shown(piece: &[u8]) -> String {
    const LONGEST: usize = 60;
    let text = String::from_utf8_lossy(piece);
    let mut line: String = text.chars().take(LONGEST).collect();
    if line.len() < text.len() {
        line.push_str("...");
    }
    escape_controls(&line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_with_any_of_the_three_endings() {
        let lines: Vec<_> = Lines::new(b"a\nb\r\n\rc").collect();
        assert_eq!(lines, [&b"a"[..], b"b", b"", b"c"]);
        let mut lines = Lines::new(b"a\r\nb");
        lines.bare_cr = true;
        assert_eq!(lines.next().unwrap(), b"a");
        assert_eq!(lines.rest(), b"\nb");
    }

    #[test]
    fn marks_tell_the_encoding() {
        assert_eq!(&*decode(b"\xef\xbb\xbfv 1"), b"v 1");
        assert_eq!(&*decode(b"\xff\xfev\0\xe9\0"), "v\u{e9}".as_bytes());
        assert_eq!(&*decode(b"\xfe\xff\0v\xd8\0"), "v\u{fffd}".as_bytes());
    }

    #[test]
    fn numbers_are_spelled_in_many_ways() {
        for (word, value) in [(".5", 0.5), ("-5.", -5.0), ("1E+05", 1e5), ("+1e-007", 1e-7)] {
            assert_eq!(number(word.as_bytes()), Some(value));
        }
        assert!(number(b"nan").is_some_and(f64::is_nan));
        for word in ["1.#IND", "0x10", "1,5", "", "--1"] {
            assert_eq!(number(word.as_bytes()), None);
        }
    }

    #[test]
    fn what_is_shown_is_short_and_harmless() {
        assert_eq!(shown(b"a\x1b[2J"), "a\\u{1b}[2J");
        assert!(shown(&[b'x'; 1000]).len() < 70);
    }
}
