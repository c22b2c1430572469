//! The rows of a PLY file's body, in text or in bytes.

use super::header::{Element, Header, PropertyKind, Type};
use crate::error::Place;
use crate::io::fault::{Checked, Fault};
use crate::io::report::Report;
use crate::io::text::{Lines, Words, number, shown};

/// The values of a body, in order.
pub(super) trait Rows {
    /// The next row begins.
    #[inline]
    fn begin(&mut self, _element: &Element) -> Checked<()> {
        Ok(())
    }
    /// The row has been read.
    #[inline]
    fn finish(&mut self) {}
    /// The next value. Every integer type fits a float64.
    fn value(&mut self, kind: Type) -> Checked<f64>;
    /// All rows of an element at once, where they are all of one size; they are read then.
    fn table<'a>(&'a mut self, _element: &Element) -> Checked<Option<Table<'a>>> {
        Ok(None)
    }
    /// Reads a list of vertices if all is plain about it: 32 bit indices below `limit`. Else
    /// nothing is read.
    fn plain_list(&mut self, _count: Type, _item: Type, _limit: u64, _: &mut Vec<u32>) -> bool {
        false
    }
    /// Reads rows of nothing but a list of three vertices, at most `most`, as long as they are
    /// plain. Returns their number.
    fn plain_triangles(
        &mut self,
        _element: &Element,
        _most: u64,
        _limit: u64,
        _push: impl FnMut([u32; 3]),
    ) -> u64 {
        0
    }
    /// The place of the last value.
    fn place(&self) -> Place;
    /// The number of bytes that follow.
    fn left(&self) -> usize;
    /// The most values or rows of `size` bytes that can follow.
    fn room(&self, size: u64) -> u64 {
        self.left() as u64 / size
    }
    /// Warns about what was not read.
    fn end(&self, report: &mut Report);

    /// The length of a list, which comes before its items.
    fn length(&mut self, count: Type, item: Type) -> Checked<u64> {
        let length = self.value(count)?;
        if length < 0.0 || length.fract() != 0.0 || length.is_nan() {
            let what = format!("the length of a list must be a count from 0, got {length}");
            return Err(Fault::at(self.place(), what));
        }
        let room = self.room(item.size());
        if length > room as f64 {
            let what = format!("truncated: a list of {length} values, where at most {room} follow");
            return Err(Fault::at(self.place(), what));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and not negative, just checked"
        )]
        Ok(length as u64)
    }

    /// The number of rows to reserve memory for: as the header says, unless the file is too short
    /// for them.
    fn capacity(&self, element: &Element) -> usize {
        let most = self.room(element.smallest_row().max(1));
        usize::try_from(element.count.min(most)).unwrap_or(0)
    }
}

/// Rows of equal size.
pub(super) struct Table<'a> {
    rows: &'a [u8],
    /// Bytes in a row.
    row: usize,
    is_big: bool,
}

impl Table<'_> {
    /// The values of some columns, row by row; of each the offset in a row, and the type.
    pub(super) fn columns<const N: usize>(
        &self,
        columns: [(usize, Type); N],
    ) -> impl Iterator<Item = [f64; N]> {
        let rows = self.rows.chunks_exact(self.row.max(1));
        rows.map(move |row| {
            columns.map(|(offset, kind)| {
                let bytes = row.get(offset..).unwrap_or_default();
                // Every column lies within the row.
                value(bytes, kind, self.is_big).unwrap_or(f64::NAN)
            })
        })
    }
}

#[inline]
fn word(bytes: [u8; 4], is_big: bool) -> u32 {
    if is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
}

/// The value that some bytes begin with.
#[inline]
fn value(bytes: &[u8], kind: Type, is_big: bool) -> Option<f64> {
    #[inline]
    fn take<const N: usize>(bytes: &[u8], is_big: bool) -> Option<[u8; N]> {
        let mut bytes = *bytes.first_chunk::<N>()?;
        if is_big {
            bytes.reverse();
        }
        Some(bytes)
    }
    Some(match kind {
        Type::Int8 => i8::from_le_bytes(take(bytes, is_big)?).into(),
        Type::Uint8 => u8::from_le_bytes(take(bytes, is_big)?).into(),
        Type::Int16 => i16::from_le_bytes(take(bytes, is_big)?).into(),
        Type::Uint16 => u16::from_le_bytes(take(bytes, is_big)?).into(),
        Type::Int32 => i32::from_le_bytes(take(bytes, is_big)?).into(),
        Type::Uint32 => u32::from_le_bytes(take(bytes, is_big)?).into(),
        Type::Float32 => f32::from_le_bytes(take(bytes, is_big)?).into(),
        Type::Float64 => f64::from_le_bytes(take(bytes, is_big)?),
    })
}

/// A binary body.
pub(super) struct Binary<'a> {
    rest: &'a [u8],
    size: usize,
    is_big: bool,
    last: u64,
}

impl<'a> Binary<'a> {
    pub(super) fn new(header: &Header<'a>, size: usize, is_big: bool) -> Self {
        Self { rest: header.body, size, is_big, last: 0 }
    }
}

impl Rows for Binary<'_> {
    #[inline]
    fn value(&mut self, kind: Type) -> Checked<f64> {
        self.last = (self.size - self.rest.len()) as u64;
        let truncated = || Fault::at(Place::Byte(self.last), "truncated: the file ends here");
        let value = value(self.rest, kind, self.is_big).ok_or_else(truncated)?;
        let size = usize::try_from(kind.size()).unwrap_or(usize::MAX);
        self.rest = self.rest.get(size..).unwrap_or_default();
        Ok(value)
    }

    fn table<'a>(&'a mut self, element: &Element) -> Checked<Option<Table<'a>>> {
        if element.has_lists() {
            return Ok(None);
        }
        let size = element.smallest_row().checked_mul(element.count);
        let size = size.and_then(|size| usize::try_from(size).ok());
        let pieces = size.and_then(|size| self.rest.split_at_checked(size));
        let truncated = || {
            let place = Place::Byte((self.size - self.rest.len()) as u64);
            let (name, count) = (&element.name, element.count);
            let what = format!("truncated: not enough bytes for {count} rows of '{name}'");
            Fault::at(place, what)
        };
        let (rows, rest) = pieces.ok_or_else(truncated)?;
        self.rest = rest;
        Ok(Some(Table {
            rows,
            row: usize::try_from(element.smallest_row()).unwrap_or(usize::MAX),
            is_big: self.is_big,
        }))
    }

    fn plain_triangles(
        &mut self,
        element: &Element,
        most: u64,
        limit: u64,
        mut push: impl FnMut([u32; 3]),
    ) -> u64 {
        let [property] = element.properties.as_slice() else {
            return 0;
        };
        let PropertyKind::List { count: Type::Uint8, item: Type::Int32 | Type::Uint32 } =
            property.kind
        else {
            return 0;
        };
        // Negative indices are large here, and more than there can be vertices.
        let limit = u32::try_from(limit.min(1 << 31)).unwrap_or(0);
        let (mut rows, _) = self.rest.as_chunks::<13>();
        let mut read = 0;
        while read < most
            && let [[3, bytes @ ..], more @ ..] = rows
        {
            let (words, _) = bytes.as_chunks::<4>();
            let &[a, b, c] = words else {
                break;
            };
            let corners = [a, b, c].map(|bytes| word(bytes, self.is_big));
            if corners.iter().any(|&corner| corner >= limit) {
                break;
            }
            push(corners);
            rows = more;
            read += 1;
        }
        let size = usize::try_from(13 * read).unwrap_or(usize::MAX);
        self.rest = self.rest.get(size..).unwrap_or_default();
        read
    }

    #[inline]
    fn plain_list(&mut self, count: Type, item: Type, limit: u64, list: &mut Vec<u32>) -> bool {
        let (length, rest) = match (count, self.rest) {
            (Type::Uint8, &[length, ref rest @ ..]) => (usize::from(length), rest),
            (Type::Int32 | Type::Uint32, rest) => {
                let Some((&bytes, rest)) = rest.split_first_chunk::<4>() else {
                    return false;
                };
                (word(bytes, self.is_big) as usize, rest)
            }
            _ => return false,
        };
        let words = length.checked_mul(4).and_then(|size| rest.split_at_checked(size));
        let (Some((words, rest)), Type::Int32 | Type::Uint32) = (words, item) else {
            return false;
        };
        list.clear();
        let (words, _) = words.as_chunks::<4>();
        list.extend(words.iter().map(|&bytes| word(bytes, self.is_big)));
        // Negative ones are large here, and more than there can be vertices.
        let is_plain = list.iter().all(|&index| u64::from(index) < limit.min(1 << 31));
        if is_plain {
            self.rest = rest;
        }
        is_plain
    }

    fn place(&self) -> Place {
        Place::Byte(self.last)
    }

    fn left(&self) -> usize {
        self.rest.len()
    }

    fn end(&self, report: &mut Report) {
        let rest = self.rest.len();
        if !self.rest.trim_ascii().is_empty() {
            let place = Place::Byte((self.size - rest) as u64);
            report.warn("trailing", &place, || {
                format!("{rest} bytes after the last element are not read")
            });
        }
    }
}

/// A text body. Rows are lines where there are enough of them, so that values which the header does
/// not declare are passed over, as real files need; else a stream of words.
pub(super) struct Ascii<'a> {
    lines: Lines<'a>,
    words: Words<'a>,
    by_line: bool,
    /// The first line with values that the header does not declare, and how many lines have some.
    extra: Option<u64>,
    extras: u64,
}

impl<'a> Ascii<'a> {
    pub(super) fn new(header: &Header<'a>) -> Self {
        let mut lines = Lines::new(header.body);
        lines.number = header.lines;
        let filled = lines.clone().filter(|line| !line.trim_ascii().is_empty());
        let rows = header.elements.iter().filter(|e| !e.properties.is_empty());
        let needed = rows.fold(0, |sum: u64, element| sum.saturating_add(element.count));
        Self {
            by_line: filled.count() as u64 >= needed,
            lines,
            words: Words::default(),
            extra: None,
            extras: 0,
        }
    }

    fn next_line(&mut self) -> Checked<()> {
        for line in self.lines.by_ref() {
            if !line.trim_ascii().is_empty() {
                self.words = Words::new(line);
                return Ok(());
            }
        }
        let what = "truncated: the file ends before the last row";
        Err(Fault::at(self.place(), what))
    }

    fn word(&mut self) -> Checked<&'a [u8]> {
        loop {
            if let Some(word) = self.words.next() {
                return Ok(word);
            }
            if self.by_line {
                let what = "the row has fewer values than it must";
                return Err(Fault::at(self.place(), what));
            }
            self.next_line()?;
        }
    }
}

impl Rows for Ascii<'_> {
    fn begin(&mut self, element: &Element) -> Checked<()> {
        if self.by_line && !element.properties.is_empty() {
            self.next_line()?;
        }
        Ok(())
    }

    fn finish(&mut self) {
        if self.by_line && !self.words.rest().is_empty() {
            self.extra.get_or_insert(self.lines.number);
            self.extras += 1;
        }
    }

    fn value(&mut self, _: Type) -> Checked<f64> {
        let word = self.word()?;
        let wrong = || Fault::at(self.place(), format!("'{}' is not a number", shown(word)));
        number(word).ok_or_else(wrong)
    }

    fn place(&self) -> Place {
        Place::Line(self.lines.number)
    }

    fn left(&self) -> usize {
        self.words.rest().len() + self.lines.rest().len()
    }

    /// A value takes at least a digit and a blank, but for the last.
    fn room(&self, _: u64) -> u64 {
        (self.left() as u64).div_ceil(2)
    }

    fn end(&self, report: &mut Report) {
        if let (Some(first), rows) = (self.extra, self.extras) {
            report.warn("extra", &Place::Line(first), || {
                format!(
                    "{rows} rows have values that the header does not declare; they are not read"
                )
            });
        }
        let mut lines = self.lines.clone();
        if lines.any(|line| !line.trim_ascii().is_empty()) {
            report.warn("trailing", &Place::Line(lines.number), || {
                "lines after the last element are not read".to_owned()
            });
        }
    }
}

/// Passes over an element that is not read.
pub(super) fn skip<R: Rows>(element: &Element, rows: &mut R) -> Checked<()> {
    if element.properties.is_empty() || rows.table(element)?.is_some() {
        return Ok(());
    }
    for _ in 0..element.count {
        rows.begin(element)?;
        for property in &element.properties {
            skip_value(property.kind, rows)?;
        }
        rows.finish();
    }
    Ok(())
}

pub(super) fn skip_value<R: Rows>(kind: PropertyKind, rows: &mut R) -> Checked<()> {
    match kind {
        PropertyKind::Scalar(kind) => rows.value(kind).map(drop),
        PropertyKind::List { count, item } => {
            for _ in 0..rows.length(count, item)? {
                rows.value(item)?;
            }
            Ok(())
        }
    }
}

/// The places of properties among those of an element, by any of several names; the last counts.
pub(super) fn scalar_at(element: &Element, names: &[&str]) -> Option<(usize, Type)> {
    let properties = element.properties.iter().enumerate();
    let mut scalars = properties.filter_map(|(k, property)| match property.kind {
        PropertyKind::Scalar(kind) if names.contains(&property.name.as_str()) => Some((k, kind)),
        _ => None,
    });
    scalars.next_back()
}
