//! Lines, fields and numbers of a text, and the places of what is wrong with them.

use std::path::Path;

use super::super::pose::FARTHEST;
use crate::error::{Error, Place, Result, escape_controls};

/// The lines of a text, ended by LF, CR LF or CR, without those that are blank or start with `#`.
#[derive(Debug, Clone)]
pub(super) struct Lines<'a> {
    path: &'a Path,
    rest: &'a [u8],
    number: u64,
}

impl<'a> Lines<'a> {
    /// The lines of UTF-8, with a byte order mark or without one.
    pub(super) fn new(text: &'a [u8], path: &'a Path) -> Result<Self> {
        if text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff") {
            let what = "the text is UTF-16; save it as UTF-8";
            return Err(wrong(path, Place::File, what));
        }
        let rest = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let number = 0;
        Ok(Self { path, rest, number })
    }

    fn next_of_all(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let mut bytes = self.rest.iter();
        let end = bytes.position(|byte| matches!(byte, b'\n' | b'\r'));
        let (text, rest) = self.rest.split_at_checked(end.unwrap_or(self.rest.len()))?;
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => rest,
        };
        let (path, number) = (self.path, self.number);
        Some(Line { path, number, text })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let line = self.next_of_all()?;
            let text = line.text.trim_ascii_start();
            if !text.is_empty() && !text.starts_with(b"#") {
                return Some(line);
            }
        }
    }
}

/// A line, and where it stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    path: &'a Path,
    number: u64,
    text: &'a [u8],
}

impl<'a> Line<'a> {
    /// The error that the line as a whole is wrong.
    pub(super) fn error(&self, what: impl Into<String>) -> Error {
        wrong(self.path, Place::Line(self.number), what)
    }

    /// The words between blanks.
    pub(super) fn words(self) -> impl Iterator<Item = Field<'a>> {
        let mut at = 0;
        std::iter::from_fn(move || {
            let rest = self.text.get(at..)?;
            let start = at + rest.iter().position(|byte| !is_blank(*byte))?;
            let word = self.text.get(start..)?;
            let length = word.iter().position(|byte| is_blank(*byte));
            let length = length.unwrap_or(word.len());
            at = start + length;
            let text = word.get(..length)?;
            let line = self;
            Some(Field { line, start, text })
        })
    }

    /// The fields between commas, without blanks and quotes around them. There may be commas
    /// between quotes.
    pub(super) fn fields(self) -> impl Iterator<Item = Field<'a>> {
        let mut at = Some(0);
        std::iter::from_fn(move || {
            let from = at?;
            let rest = self.text.get(from..)?;
            let mut is_quoted = false;
            let end = rest.iter().position(|&byte| {
                is_quoted ^= byte == b'"';
                byte == b',' && !is_quoted
            });
            at = end.map(|end| from + end + 1);
            let text = rest.get(..end.unwrap_or(rest.len()))?;
            let inner = text.trim_ascii_start();
            let start = from + (text.len() - inner.len());
            let text = inner.trim_ascii_end();
            let line = self;
            let quoted = text.strip_prefix(b"\"").and_then(|t| t.strip_suffix(b"\""));
            Some(match quoted {
                Some(text) => {
                    let start = start + 1;
                    Field { line, start, text }
                }
                None => Field { line, start, text },
            })
        })
    }

    /// The words of a line that has exactly as many of them.
    ///
    /// # Errors
    ///
    /// For another number of them, with their `names`.
    pub(super) fn exactly<const COUNT: usize>(self, names: &str) -> Result<[Field<'a>; COUNT]> {
        let mut words = self.words();
        let mut got = 0;
        let found = std::array::from_fn(|_| {
            let word = words.next();
            got += usize::from(word.is_some());
            word.unwrap_or(Field::missing(self))
        });
        got += words.count();
        if got != COUNT {
            let what = format!("expected {COUNT} numbers ({names}), got {got}");
            return Err(self.error(what));
        }
        Ok(found)
    }
}

fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// A piece of a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    line: Line<'a>,
    /// The byte of the line that it starts with.
    start: usize,
    pub(super) text: &'a [u8],
}

impl<'a> Field<'a> {
    /// The missing field at the end of a line.
    pub(super) fn missing(line: Line<'a>) -> Self {
        let (start, text) = (line.text.len(), &[][..]);
        Self { line, start, text }
    }

    /// The error that the field is wrong.
    pub(super) fn error(&self, what: impl Into<String>) -> Error {
        let before = self.line.text.get(..self.start).unwrap_or_default();
        let column = String::from_utf8_lossy(before).chars().count() as u64 + 1;
        let line = self.line.number;
        wrong(self.line.path, Place::Position { line, column }, what)
    }

    /// The number here.
    ///
    /// # Errors
    ///
    /// For all but numbers whose size is at most 10^150.
    pub(super) fn number(&self) -> Result<f64> {
        self.seconds(Unit::SECOND)
    }

    /// The number here in units of time, as seconds. Decimals are rounded once:
    /// `1305031102175304000` nanoseconds are the float64 of `1305031102.175304` seconds.
    ///
    /// # Errors
    ///
    /// As [`number`](Self::number).
    pub(super) fn seconds(&self, unit: Unit) -> Result<f64> {
        let text = str::from_utf8(self.text).unwrap_or_default();
        let number: Option<f64> = if unit.exponent.is_empty() || text.contains(['e', 'E']) {
            // There cannot be a second exponent: such numbers are rounded twice.
            text.parse().ok().map(|number: f64| number / unit.of_a_second)
        } else {
            format!("{text}{}", unit.exponent).parse().ok()
        };
        // So that a NaN fails.
        let number = number.filter(|number| number.abs() <= FARTHEST);
        number.ok_or_else(|| {
            let got = shown(self.text);
            self.error(format!("'{got}' is not a finite number within 1e150"))
        })
    }
}

/// A unit of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    /// The exponent to append to a number of them, so that it is in seconds.
    exponent: &'static str,
    /// The number of them in a second.
    of_a_second: f64,
}

impl Unit {
    pub(super) const SECOND: Self = Self::new("", 1.0);
    pub(super) const MILLISECOND: Self = Self::new("e-3", 1e3);
    pub(super) const MICROSECOND: Self = Self::new("e-6", 1e6);
    pub(super) const NANOSECOND: Self = Self::new("e-9", 1e9);

    const fn new(exponent: &'static str, of_a_second: f64) -> Self {
        Self { exponent, of_a_second }
    }
}

/// A piece of a text as one short line for a message.
pub(super) fn shown(piece: &[u8]) -> String {
    const LONGEST: usize = 60;
    // Four bytes are the longest character.
    let start = piece.get(..4 * LONGEST).unwrap_or(piece);
    let text = String::from_utf8_lossy(start);
    let mut line: String = text.chars().take(LONGEST).collect();
    if line.len() < piece.len() {
        line.push_str("...");
    }
    escape_controls(&line)
}

/// The error that something is wrong at a place of a text.
pub(super) fn wrong(path: &Path, place: Place, what: impl Into<String>) -> Error {
    let (path, what) = (path.to_owned(), what.into());
    Error::Parse { path, place, what }
}
