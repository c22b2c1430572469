//! The rows of an OFF file.

use super::header::{Header, next_line};
use crate::error::Place;
use crate::io::fault::{Checked, Fault};
use crate::io::report::Report;
use crate::io::text::{Lines, Words, number, shown};

/// A colour as it is written.
pub(super) struct Color {
    pub(super) levels: [f64; 3],
    pub(super) has_fractions: bool,
}

/// Rows are lines where there are enough of them, so that values which the header does not declare
/// can be told; else a stream of words.
pub(super) struct Rows<'a> {
    lines: Lines<'a>,
    words: Words<'a>,
    by_line: bool,
}

impl<'a> Rows<'a> {
    /// Refuses counts that the text has no room for.
    pub(super) fn new(lines: Lines<'a>, header: &Header) -> Checked<Self> {
        /// A digit and a blank, but for the last.
        const LEAST: u64 = 2;
        let needed = header.vertices.saturating_mul(3);
        let needed = needed.saturating_add(header.faces);
        let room = (lines.rest().len() as u64).div_ceil(LEAST);
        if needed > room {
            let (vertices, faces) = (header.vertices, header.faces);
            let what = format!(
                "truncated: {vertices} vertices and {faces} faces are {needed} numbers at least, where at most {room} follow"
            );
            return Err(Fault::line(lines.number, what));
        }
        let rows = header.vertices.saturating_add(header.faces);
        let mut ahead = lines.clone();
        let filled = std::iter::from_fn(|| next_line(&mut ahead)).count() as u64;
        Ok(Self { by_line: filled >= rows, lines, words: Words::default() })
    }

    /// The number of bytes that follow.
    pub(super) fn left(&self) -> usize {
        self.words.rest().len() + self.lines.rest().len()
    }

    pub(super) fn place(&self) -> Place {
        Place::Line(self.lines.number)
    }

    fn fault(&self, what: impl Into<String>) -> Fault {
        Fault::at(self.place(), what)
    }

    /// The number of the next line that says anything.
    pub(super) fn next_line(&mut self) -> Option<u64> {
        next_line(&mut self.lines).map(|_| self.lines.number)
    }

    /// The next row begins.
    pub(super) fn begin(&mut self) -> Checked<()> {
        if self.by_line {
            self.words = Words::default();
            self.advance()?;
        }
        Ok(())
    }

    fn advance(&mut self) -> Checked<()> {
        let line = next_line(&mut self.lines);
        let line =
            line.ok_or_else(|| self.fault("truncated: the file ends before the last row"))?;
        self.words = Words::new(line);
        Ok(())
    }

    fn word(&mut self) -> Checked<&'a [u8]> {
        loop {
            if let Some(word) = self.words.next() {
                return Ok(word);
            }
            if self.by_line {
                return Err(self.fault("the row has fewer values than it must"));
            }
            self.advance()?;
        }
    }

    pub(super) fn numbers<const N: usize>(&mut self) -> Checked<[f64; N]> {
        let mut numbers = [0.0; N];
        for value in &mut numbers {
            let word = self.word()?;
            let wrong = || self.fault(format!("'{}' is not a number", shown(word)));
            *value = number(word).ok_or_else(wrong)?;
        }
        Ok(numbers)
    }

    /// Reads the number of corners of a face: at most as many as words can follow.
    pub(super) fn count(&mut self) -> Checked<u64> {
        let word = self.word()?;
        let count = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        let what = || format!("a face begins with the count of its corners, got '{}'", shown(word));
        let count: u64 = count.ok_or_else(|| self.fault(what()))?;
        let mut room = self.words.rest().len();
        if !self.by_line {
            room = room.saturating_add(self.lines.rest().len()).saturating_add(1);
        }
        if count > (room as u64).div_ceil(2) {
            return Err(
                self.fault(format!("truncated: a face of {count} corners, which do not follow"))
            );
        }
        Ok(count)
    }

    /// Reads the index of a vertex from a word, here alone.
    pub(super) fn vertex(&mut self, count: u64) -> Checked<u32> {
        let word = self.word()?;
        let index = str::from_utf8(word).ok().and_then(|word| word.parse::<i64>().ok());
        let vertex = index.and_then(|index| u32::try_from(index).ok());
        vertex.filter(|&vertex| u64::from(vertex) < count).ok_or_else(|| {
            let got = shown(word);
            self.fault(format!(
                "a vertex index must be whole and from 0 to below {count}, got '{got}'"
            ))
        })
    }

    /// The colour of a vertex, before `behind` further values: three numbers, or four with an
    /// alpha.
    pub(super) fn color(&mut self, behind: usize, report: &mut Report) -> Checked<Option<Color>> {
        // Without lines only the specification tells how many there are.
        let count =
            if self.by_line { self.words.clone().count().saturating_sub(behind) } else { 4 };
        match count {
            0 => Ok(None),
            1 | 2 => Err(self.fault("a colour must have 3 or 4 numbers")),
            _ => self.levels(count.min(4), report).map(Some),
        }
    }

    /// The colour of a face, which takes the rest of its line.
    pub(super) fn face_color(&mut self, report: &mut Report) -> Checked<Option<Color>> {
        if !self.by_line {
            return Ok(None);
        }
        match self.words.clone().count() {
            0 => Ok(None),
            1 => {
                report.warn("color map", &self.place(), || {
                    "colours of faces by their number in a colour map are not read".to_owned()
                });
                Ok(None)
            }
            count @ (3 | 4) => self.levels(count, report).map(Some),
            count => {
                report.warn("face values", &self.place(), || {
                    format!("{count} values after a face's corners are no colour, and are not read")
                });
                Ok(None)
            }
        }
    }

    fn levels(&mut self, count: usize, report: &mut Report) -> Checked<Color> {
        let is_fraction = |word: &[u8]| word.iter().any(|byte| b".eE".contains(byte));
        let has_fractions = self.by_line && self.words.clone().take(3).any(is_fraction);
        let levels = self.numbers()?;
        if count == 4 {
            let [alpha] = self.numbers()?;
            if alpha != 1.0 && alpha != 255.0 {
                report.warn("alpha", &self.place(), || {
                    format!("a surface that lets light through is seen as opaque: alpha {alpha}")
                });
            }
        }
        Ok(Color { levels, has_fractions })
    }

    /// Warns of what is left of a row.
    pub(super) fn end(&mut self, what: &str, report: &mut Report) {
        if self.by_line && !self.words.rest().is_empty() {
            report.warn("extra", &self.place(), || what.to_owned());
        }
    }
}
