//! Makes indices of the words of an OBJ file, here alone.

use crate::io::fault::{Checked, Fault};
use crate::io::text::shown;

/// An index that a corner does not have.
pub(super) const NONE: u32 = u32::MAX;

/// The number of values of a kind so far, and the largest index into them.
#[derive(Debug)]
pub(super) struct Indices {
    kind: &'static str,
    count: u32,
    /// The largest index, counted from 0, and its line.
    largest: Option<(u32, u64)>,
}

impl Indices {
    pub(super) fn new(kind: &'static str) -> Self {
        Self { kind, count: 0, largest: None }
    }

    /// Another value has come.
    pub(super) fn add(&mut self, line: u64) -> Checked<()> {
        let too_many = || Fault::line(line, format!("too many {}", self.kind));
        let count = self.count.checked_add(1).filter(|&count| count < NONE);
        self.count = count.ok_or_else(too_many)?;
        Ok(())
    }

    /// The index that a word states.
    pub(super) fn parse(&mut self, word: &[u8], line: u64) -> Checked<u32> {
        let stated = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        let stated = stated.ok_or_else(|| {
            let what = format!("'{}' is not an index of {}", shown(word), self.kind);
            Fault::line(line, what)
        })?;
        self.resolve(stated, line)
    }

    /// The index, from 0, of a stated one: from 1 upwards from the first, from -1 downwards from
    /// the last that has come. Values that are yet to come may be named: see [`Indices::check`].
    #[inline]
    pub(super) fn resolve(&mut self, stated: i64, line: u64) -> Checked<u32> {
        let index = match stated {
            0 => return Err(self.fault("0", line)),
            1.. => stated - 1,
            _ => i64::from(self.count).saturating_add(stated),
        };
        match u32::try_from(index) {
            Ok(index) if index != NONE => {
                if self.largest.is_none_or(|(largest, _)| index > largest) {
                    self.largest = Some((index, line));
                }
                Ok(index)
            }
            _ => Err(self.fault(&stated.to_string(), line)),
        }
    }

    /// Whether nothing names the value that came last.
    pub(super) fn last_is_unused(&self) -> bool {
        self.largest.is_none_or(|(largest, _)| largest.saturating_add(1) < self.count)
    }

    /// Whether all indices have a value, now that all values have come.
    pub(super) fn check(&self) -> Checked<()> {
        match self.largest {
            Some((largest, line)) if largest >= self.count => {
                Err(self.fault(&(u64::from(largest) + 1).to_string(), line))
            }
            _ => Ok(()),
        }
    }

    fn fault(&self, got: &str, line: u64) -> Fault {
        let (kind, count) = (self.kind, self.count);
        let what = match count {
            0 => format!("index {got} of {kind}, but there are none"),
            _ => format!(
                "an index of {kind} must be from 1 to {count} or from -{count} to -1, got {got}"
            ),
        };
        Fault::line(line, what)
    }
}
