//! The points of LAS 1.0 to 1.4 and of LAZ:
//! <https://www.asprs.org/wp-content/uploads/2019/07/LAS_1_4_r15.pdf>.

use super::super::super::metadata::KEY;
use super::super::output::{collected, elements, metadata_of};
use super::{Table, Type, laz, padded};
use crate::image::{Array, ArrayValues, Output};

/// The length of a point in each format, without extra bytes.
const LENGTHS: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];

/// The first of the formats in which a pulse has up to 15 returns.
const LONG: u8 = 6;

/// The bit of the format that says that points are packed, as LAZ has it.
const PACKED: u8 = 0x80;

/// The length of the description of some extra bytes.
const DESCRIPTION: usize = 192;

/// A record that says something of all points: whose it is, its number, and its content.
struct Record<'a> {
    user: &'a [u8],
    number: u16,
    content: &'a [u8],
}

/// A column whose numbers are as they are in the file.
struct Plain {
    name: String,
    kind: Type,
    start: usize,
}

/// The bytes of a file by their places.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn cell<const N: usize>(&self, start: usize) -> Result<[u8; N], String> {
        let cell = start.checked_add(N).and_then(|end| self.0.get(start..end));
        Ok(padded(cell.ok_or("ends within its header")?))
    }

    fn byte(&self, start: usize) -> Result<u8, String> {
        Ok(u8::from_le_bytes(self.cell(start)?))
    }

    fn short(&self, start: usize) -> Result<u16, String> {
        Ok(u16::from_le_bytes(self.cell(start)?))
    }

    fn long(&self, start: usize) -> Result<u64, String> {
        Ok(u64::from_le_bytes(self.cell(start)?))
    }

    fn size(&self, start: usize) -> Result<usize, String> {
        let size = u32::from_le_bytes(self.cell(start)?);
        usize::try_from(size).map_err(|error| error.to_string())
    }

    fn triple(&self, start: usize) -> Result<[f64; 3], String> {
        let at = |axis: usize| self.cell(start + 8 * axis).map(f64::from_le_bytes);
        Ok([at(0)?, at(1)?, at(2)?])
    }
}

pub(in crate::image) fn las(content: &[u8], most: u64) -> Result<Output, String> {
    let bytes = Bytes(content);
    let (minor, packed_format, row) = (bytes.byte(25)?, bytes.byte(104)?, bytes.short(105)?);
    let (format, row) = (packed_format & 0x3f, usize::from(row));
    let length = LENGTHS.get(usize::from(format));
    let length =
        *length.ok_or_else(|| format!("has points of format {format}, not one of 0 to 10"))?;
    if row < length {
        return Err(format!("has points of {row} bytes, shorter than format {format}"));
    }
    let count = match u64::from(u32::from_le_bytes(bytes.cell(107)?)) {
        _ if minor >= 4 => bytes.long(247)?,
        count => count,
    };
    let (scale, offset) = (bytes.triple(131)?, bytes.triple(155)?);
    let records = records(&bytes)?;
    let mut columns = columns(format);
    if let Some(extra) = find(&records, b"LASF_Spec", 4) {
        columns.extend(extra_columns(extra.content, length, row));
    }
    // In memory every number takes 8 bytes.
    elements(&[count, columns.len() as u64 + 5], 8, most)?;
    let count = usize::try_from(count).map_err(|_| "has too many points")?;
    let start = bytes.size(96)?;
    let points = content.get(start..).ok_or("ends before its points")?;
    let unpacked;
    let data = if packed_format & PACKED == 0 {
        points
    } else {
        let record = find(&records, b"laszip encoded", 22204);
        let record = record.ok_or("is packed, and does not say how")?;
        unpacked = laz::unpacked(record.content, points, row, count)?;
        &unpacked
    };
    if data.len() / row < count {
        return Err(format!("holds {} points of {count}", data.len() / row));
    }
    let table = Table { data, row, count };
    let mut output =
        Output { arrays: arrays(&table, format, columns, (scale, offset))?, ..Output::default() };
    let said =
        find(&records, KEY.as_bytes(), 1).and_then(|own| std::str::from_utf8(own.content).ok());
    output.metadata = metadata_of(said, &mut output.notes);
    Ok(output)
}

fn find<'a, 'b>(records: &'b [Record<'a>], user: &[u8], number: u16) -> Option<&'b Record<'a>> {
    let is_it = |record: &&Record<'_>| record.user == user && record.number == number;
    records.iter().find(is_it)
}

/// The records before the points, and those behind, of which there are some from version 1.4 on.
fn records<'a>(bytes: &Bytes<'a>) -> Result<Vec<Record<'a>>, String> {
    let before = (usize::from(bytes.short(94)?), bytes.size(100)?, 54);
    let behind = if bytes.byte(25)? >= 4 {
        let start = usize::try_from(bytes.long(235)?).unwrap_or(usize::MAX);
        (start, bytes.size(243)?, 60)
    } else {
        (0, 0, 60)
    };
    let mut records = Vec::new();
    for (mut start, count, header) in [before, behind] {
        for _ in 0..count {
            // A file may end before the records that it counts.
            let Some(end) = start.checked_add(header).filter(|&end| end <= bytes.0.len()) else {
                break;
            };
            let length = if header == 54 {
                u64::from(bytes.short(start + 20)?)
            } else {
                bytes.long(start + 20)?
            };
            let length = usize::try_from(length).unwrap_or(usize::MAX);
            let Some(content) = end.checked_add(length).and_then(|next| bytes.0.get(end..next))
            else {
                break;
            };
            let user = bytes.0.get(start + 2..start + 18).unwrap_or_default();
            records.push(Record { user: text(user), number: bytes.short(start + 18)?, content });
            start = end + length;
        }
    }
    Ok(records)
}

/// A text that zeros fill up.
fn text(bytes: &[u8]) -> &[u8] {
    bytes.split(|&byte| byte == 0).next().unwrap_or_default()
}

/// The columns of a format that are numbers as they are.
fn columns(format: u8) -> Vec<Plain> {
    let (short, byte) = (Type::Unsigned(2), Type::Unsigned(1));
    let mut columns = vec![("intensity", short, 12)];
    if format < LONG {
        columns.extend([
            ("scan_angle", Type::Signed(1), 16),
            ("user_data", byte, 17),
            ("point_source_id", short, 18),
        ]);
    } else {
        columns.extend([
            ("classification", byte, 16),
            ("user_data", byte, 17),
            ("scan_angle", Type::Signed(2), 18),
            ("point_source_id", short, 20),
        ]);
    }
    let time = match format {
        1 | 3 | 4 | 5 => Some(20),
        LONG.. => Some(22),
        _ => None,
    };
    columns.extend(time.map(|start| ("gps_time", Type::Float64, start)));
    let color = match format {
        2 => Some(20),
        3 | 5 => Some(28),
        7 | 8 | 10 => Some(30),
        _ => None,
    };
    if let Some(start) = color {
        columns.extend([
            ("red", short, start),
            ("green", short, start + 2),
            ("blue", short, start + 4),
        ]);
    }
    if matches!(format, 8 | 10) {
        columns.push(("nir", short, 36));
    }
    let named =
        columns.into_iter().map(|(name, kind, start)| Plain { name: name.to_owned(), kind, start });
    named.collect()
}

/// The columns behind those of the format, as far as they are described.
fn extra_columns(descriptions: &[u8], mut start: usize, row: usize) -> Vec<Plain> {
    let mut columns: Vec<Plain> = Vec::new();
    for description in descriptions.chunks_exact(DESCRIPTION) {
        let bytes = Bytes(description);
        let (Ok(code), Ok(options)) = (bytes.byte(2), bytes.byte(3)) else {
            break;
        };
        let kind = match code {
            // As many bytes as the options say, of unknown meaning.
            0 => {
                start += usize::from(options);
                continue;
            }
            1 => Type::Unsigned(1),
            2 => Type::Signed(1),
            3 => Type::Unsigned(2),
            4 => Type::Signed(2),
            5 => Type::Unsigned(4),
            6 => Type::Signed(4),
            7 => Type::Unsigned(8),
            8 => Type::Signed(8),
            9 => Type::Float32,
            10 => Type::Float64,
            _ => break,
        };
        if start + kind.size() > row {
            break;
        }
        let name = text(description.get(4..36).unwrap_or_default());
        columns.push(Plain { name: String::from_utf8_lossy(name).into_owned(), kind, start });
        start += kind.size();
    }
    columns
}

fn arrays(
    table: &Table<'_>,
    format: u8,
    columns: Vec<Plain>,
    (scale, offset): ([f64; 3], [f64; 3]),
) -> Result<Vec<Array>, String> {
    let rows = || table.data.chunks_exact(table.row).take(table.count);
    let axes = rows().flat_map(|row| {
        let at = |axis: usize| {
            let whole =
                i32::from_le_bytes(padded(row.get(4 * axis..4 * axis + 4).unwrap_or_default()));
            (axis, f64::from(whole))
        };
        [at(0), at(1), at(2)]
    });
    let places = axes.map(|(axis, whole)| match (scale.get(axis), offset.get(axis)) {
        (Some(scale), Some(offset)) => whole * scale + offset,
        _ => whole,
    });
    let places = ArrayValues::Float64(collected(3 * table.count, places)?);
    let shape = || vec![table.count];
    let positions = Array::new(Some("position"), shape(), 3, places, "float64", false);
    let mut arrays = vec![positions];
    let mut bits = |name: &str, place: usize, shift: u32, mask: u8| -> Result<(), String> {
        let values =
            rows().map(|row| i64::from(row.get(place).copied().unwrap_or(0) >> shift & mask));
        let values = ArrayValues::Integer(collected(table.count, values)?);
        arrays.push(Array::new(Some(name), shape(), 1, values, "uint8", false));
        Ok(())
    };
    if format < LONG {
        bits("return_number", 14, 0, 7)?;
        bits("number_of_returns", 14, 3, 7)?;
        bits("classification", 15, 0, 31)?;
    } else {
        bits("return_number", 14, 0, 15)?;
        bits("number_of_returns", 14, 4, 15)?;
    }
    for Plain { name, kind, start } in columns {
        arrays.push(table.interleaved(&name, kind, &[start], false)?);
    }
    Ok(arrays)
}
