//! The text of a scene file, parsed, with the place of everything in it.

use std::borrow::Cow;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::{Place, escape_controls};
use crate::io::fault::{Checked, Fault};
use crate::io::memory_budget::check_free;

pub(super) type Name<'t> = Spanned<Cow<'t, str>>;
pub(super) type Value<'t> = Spanned<DeValue<'t>>;

/// The most memory that parsing takes for each byte of the text: a token, an event and a value for
/// every two bytes of `1,1,1,`. Measured: 86 resident, and vectors that grow want more for a
/// moment.
const BYTES_PER_BYTE: usize = 160;

/// A text that places are counted in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Text<'t>(&'t str);

impl<'t> Text<'t> {
    /// The text of a file; a byte order mark is passed over.
    pub(super) fn new(bytes: &'t [u8]) -> Checked<Self> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let valid = bytes.get(..error.valid_up_to()).unwrap_or_default();
            let before = Self(std::str::from_utf8(valid).unwrap_or_default());
            before.fault(valid.len(), "the text is not UTF-8, which TOML must be")
        })?;
        Ok(Self(text.strip_prefix('\u{feff}').unwrap_or(text)))
    }

    /// The line and column of a byte, both counted from 1, columns in characters.
    pub(super) fn place(self, byte: usize) -> Place {
        let before = self.0.get(..byte).unwrap_or(self.0);
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let column = before.get(start..).unwrap_or_default().chars().count() + 1;
        Place::Position { line: line as u64, column: column as u64 }
    }

    /// The byte that a place is of.
    pub(super) fn byte(self, place: &Place) -> Option<usize> {
        let Place::Position { line, column } = *place else {
            return None;
        };
        let lines = self.0.split_inclusive('\n').take(usize::try_from(line).ok()? - 1);
        let start: usize = lines.map(str::len).sum();
        let before = self.0.get(start..)?.chars().take(usize::try_from(column).ok()? - 1);
        Some(start + before.map(char::len_utf8).sum::<usize>())
    }

    pub(super) fn fault(self, byte: usize, what: impl Into<String>) -> Fault {
        Fault::at(self.place(byte), what)
    }

    /// The bytes that parsing takes at most.
    pub(super) fn needed(self) -> usize {
        self.0.len().saturating_mul(BYTES_PER_BYTE)
    }

    /// The document's top table. The parser's own limit ends nesting at 80 levels.
    pub(super) fn parse(self) -> Checked<Spanned<DeTable<'t>>> {
        let needed = self.needed();
        // The parser cannot be told that memory is scarce: asked here, it is an error, not the end.
        check_free(needed)?;
        DeTable::parse(self.0).map_err(|error| {
            let byte = error.span().map_or(self.0.len(), |span| span.start);
            // One line, whatever the text holds.
            let what = escape_controls(error.message().trim());
            self.fault(byte, format!("this is not TOML: {what}"))
        })
    }
}

/// The name of a value in an error: its text where that is short, else its type.
pub(super) fn named(value: &DeValue<'_>) -> String {
    const LONGEST: usize = 40;
    match value {
        DeValue::String(text) if text.chars().count() <= LONGEST => {
            format!("\"{}\"", escape_controls(text))
        }
        DeValue::String(_) => "a long text".to_owned(),
        DeValue::Integer(digits) if digits.as_str().len() <= LONGEST => digits.to_string(),
        DeValue::Float(digits) if digits.as_str().len() <= LONGEST => digits.to_string(),
        DeValue::Integer(_) | DeValue::Float(_) => "a number of very many digits".to_owned(),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(items) if items.len() <= 4 && !items.iter().any(is_nested) => {
            let items: Vec<String> = items.iter().map(|item| named(item.get_ref())).collect();
            format!("[{}]", items.join(", "))
        }
        DeValue::Array(items) => format!("an array of {}", items.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

fn is_nested(value: &Value<'_>) -> bool {
    value.get_ref().is_array() || value.get_ref().is_table()
}

/// A number as float64; of an integer the nearest one.
pub(super) fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(digits) => digits.as_str().parse().ok(),
        DeValue::Integer(digits) if digits.radix() == 10 => digits.as_str().parse().ok(),
        DeValue::Integer(_) => integer(value).map(|value| value as f64),
        _ => None,
    }
    .filter(|number: &f64| number.is_finite())
}

/// A whole number that 64 bits hold.
pub(super) fn integer(value: &DeValue<'_>) -> Option<i64> {
    let digits = value.as_integer()?;
    i64::from_str_radix(digits.as_str(), digits.radix()).ok()
}

/// `N` things in an array.
pub(super) fn array<T, const N: usize>(
    value: &DeValue<'_>,
    read: impl Fn(&DeValue<'_>) -> Option<T>,
) -> Option<[T; N]> {
    let items = value.as_array()?.iter();
    let found: Option<Vec<T>> = items.map(|item| read(item.get_ref())).collect();
    found?.try_into().ok()
}

/// `N` numbers in an array.
pub(super) fn numbers<const N: usize>(value: &DeValue<'_>) -> Option<[f64; N]> {
    array(value, number)
}
