//! Points as rows of little-endian numbers, of whatever a file has.

use std::borrow::Cow;

use super::super::output::collected;
use super::{Type, lzf, unknown};

/// The encoding of a file's points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// A line each.
    Text,
    Little,
    Big,
    /// Column by column, packed.
    Compressed,
}

impl Order {
    /// The rows of `count` points with columns of these types, and the number of bytes after them.
    pub(super) fn rows<'a>(
        self,
        data: &'a [u8],
        kinds: &[Type],
        count: usize,
    ) -> Result<(Cow<'a, [u8]>, usize), String> {
        let row: usize = kinds.iter().map(|kind| kind.size()).sum();
        let length = count.checked_mul(row).ok_or("has too many points")?;
        match self {
            Self::Text => Ok((from_text(data, kinds, count)?.into(), 0)),
            Self::Compressed => Ok((from_columns(data, kinds, count, length)?.into(), 0)),
            Self::Little | Self::Big => {
                let rows = (data.get(..length))
                    .ok_or_else(|| format!("holds {} points of {count}", data.len() / row))?;
                let more = data.len() - length;
                if self == Self::Little {
                    return Ok((rows.into(), more));
                }
                let mut turned: Vec<u8> = collected(length, rows.iter().copied())?;
                for row in turned.chunks_exact_mut(row) {
                    let mut rest = row;
                    for kind in kinds {
                        let Some((cell, after)) = rest.split_at_mut_checked(kind.size()) else {
                            break;
                        };
                        cell.reverse();
                        rest = after;
                    }
                }
                Ok((turned.into(), more))
            }
        }
    }
}

fn from_text(data: &[u8], kinds: &[Type], count: usize) -> Result<Vec<u8>, String> {
    // Every point takes a line.
    if count > data.len() {
        return Err(format!("is too short for {count} points"));
    }
    let mut rows: Vec<u8> = Vec::new();
    let lines = data.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut lines = lines.filter(|line| !line.is_empty());
    for index in 0..count {
        let line = lines.next();
        let line = line.ok_or_else(|| format!("holds {index} points of {count}"))?;
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        for kind in kinds {
            let word = words.next().unwrap_or_default();
            let cell = std::str::from_utf8(word).ok().and_then(|word| kind.cell(word));
            let cell = cell.ok_or_else(|| {
                let got = unknown(&String::from_utf8_lossy(word));
                format!("point {index}: expected {} numbers of their types: {got}", kinds.len())
            })?;
            rows.try_reserve(8).map_err(|_| "no memory is free for its points")?;
            rows.extend(cell.get(..kind.size()).unwrap_or_default());
        }
    }
    Ok(rows)
}

/// The rows from all numbers of the first column, then those of the second, and so on, packed by
/// LZF.
fn from_columns(
    data: &[u8],
    kinds: &[Type],
    count: usize,
    length: usize,
) -> Result<Vec<u8>, String> {
    let size = |bytes: Option<&[u8]>| {
        let bytes = bytes.and_then(|bytes| bytes.try_into().ok());
        bytes.map_or(0, |bytes| u32::from_le_bytes(bytes) as usize)
    };
    let (packed, unpacked) = (size(data.get(..4)), size(data.get(4..8)));
    let packed = (data.get(8..).and_then(|rest| rest.get(..packed)))
        .ok_or("ends within its compressed points")?;
    if unpacked != length {
        return Err(format!("has {unpacked} bytes of points, expected {length}"));
    }
    let columns = lzf::unpacked(packed, length)?;
    let row: usize = kinds.iter().map(|kind| kind.size()).sum();
    let mut rows = collected(length, std::iter::repeat_n(0_u8, length))?;
    let mut rest = &columns[..];
    let mut start = 0;
    for kind in kinds {
        let size = kind.size();
        let (column, after) = rest.split_at_checked(size * count).unwrap_or((rest, &[]));
        for (cell, row) in column.chunks_exact(size).zip(rows.chunks_exact_mut(row)) {
            if let Some(place) = row.get_mut(start..start + size) {
                place.copy_from_slice(cell);
            }
        }
        (rest, start) = (after, start + size);
    }
    Ok(rows)
}

impl Type {
    /// A number in text as the bytes of this type, and zeros behind; `None` for one that it does
    /// not hold.
    fn cell(self, word: &str) -> Option<[u8; 8]> {
        let mut cell = [0; 8];
        match self {
            Self::Float64 => cell = word.parse::<f64>().ok()?.to_le_bytes(),
            Self::Float32 => {
                let (place, _) = cell.split_at_mut_checked(4)?;
                place.copy_from_slice(&word.parse::<f32>().ok()?.to_le_bytes());
            }
            Self::Signed(size) | Self::Unsigned(size) => {
                let whole = whole(word)?;
                let bits = 8 * u32::try_from(size).ok()?;
                let (low, high) = if matches!(self, Self::Signed(_)) {
                    (-(1_i128 << (bits - 1)), (1_i128 << (bits - 1)) - 1)
                } else {
                    (0, (1_i128 << bits) - 1)
                };
                let bytes = (low..=high).contains(&whole).then(|| whole.to_le_bytes())?;
                cell.copy_from_slice(bytes.get(..8)?);
            }
        }
        Some(cell)
    }
}

/// A whole number, which some programs write with a point.
fn whole(word: &str) -> Option<i128> {
    word.parse().ok().or_else(|| {
        let number: f64 = word.parse().ok()?;
        #[expect(clippy::cast_possible_truncation, reason = "it is whole, and `as` saturates")]
        (number.fract() == 0.0).then_some(number as i128)
    })
}
