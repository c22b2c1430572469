//! Points, a file per format. A binary file has rows of numbers without padding: all
//! formats become little-endian ones, and the columns of those are put together here.

mod las;
mod laz;
mod lzf;
mod pcd;
mod ply;
mod rows;
mod text;

pub(in crate::image) use las::las;
pub(in crate::image) use pcd::pcd;
pub(in crate::image) use ply::{ply, vertices};
pub(in crate::image) use text::text;

use std::collections::HashSet;

use super::super::metadata::{ChannelRecord, Encoding, KEY, Metadata};
use super::output::{Array, ArrayValues, Output, collected, elements, metadata_of};
use rows::Order;

/// The next line of a header, without its end; it is then gone from `rest`.
fn next_line<'a>(rest: &mut &'a [u8]) -> Result<&'a str, String> {
    let end = rest.iter().position(|&byte| byte == b'\n');
    let (line, after) =
        end.and_then(|end| rest.split_at_checked(end + 1)).ok_or("ends within its header")?;
    *rest = after;
    let line = std::str::from_utf8(line).map_err(|_| "a header that is no text")?;
    Ok(line.trim_end_matches(['\r', '\n']))
}

fn unknown(what: &str) -> String {
    let start: String = what.chars().take(40).collect();
    format!("'{}' is not read", crate::error::escape_controls(&start))
}

/// The type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Type {
    Float64,
    Float32,
    /// A signed whole number of this many bytes.
    Signed(usize),
    Unsigned(usize),
}

impl Type {
    fn of_ply(name: &str) -> Option<Self> {
        Some(match name {
            "double" | "float64" => Self::Float64,
            "float" | "float32" => Self::Float32,
            "char" | "int8" => Self::Signed(1),
            "short" | "int16" => Self::Signed(2),
            "int" | "int32" => Self::Signed(4),
            "uchar" | "uint8" => Self::Unsigned(1),
            "ushort" | "uint16" => Self::Unsigned(2),
            "uint" | "uint32" => Self::Unsigned(4),
            _ => return None,
        })
    }

    fn of_pcd(kind: &str, size: &str) -> Option<Self> {
        let bytes = [1, 2, 4, 8].into_iter().find(|bytes| bytes.to_string() == size)?;
        Some(match (kind, bytes) {
            ("F", 8) => Self::Float64,
            ("F", 4) => Self::Float32,
            ("I", _) => Self::Signed(bytes),
            ("U", _) => Self::Unsigned(bytes),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Float64 => 8,
            Self::Float32 => 4,
            Self::Signed(size) | Self::Unsigned(size) => size,
        }
    }

    fn dtype(self) -> String {
        match self {
            Self::Float64 => "float64".to_owned(),
            Self::Float32 => "float32".to_owned(),
            Self::Signed(size) => format!("int{}", 8 * size),
            Self::Unsigned(size) => format!("uint{}", 8 * size),
        }
    }

    /// Numbers of this type.
    fn numbers<'a>(
        self,
        count: usize,
        cells: impl Iterator<Item = &'a [u8]>,
    ) -> Result<ArrayValues, String> {
        Ok(match self {
            Self::Float64 => {
                let values = cells.map(|cell| f64::from_le_bytes(padded(cell)));
                ArrayValues::Float64(collected(count, values)?)
            }
            Self::Float32 => {
                let values = cells.map(|cell| f32::from_le_bytes(padded(cell)));
                ArrayValues::Float32(collected(count, values)?)
            }
            Self::Signed(size) => {
                let unused = 64 - 8 * size;
                let whole = |cell| i64::from_le_bytes(padded(cell)) << unused >> unused;
                ArrayValues::Integer(collected(count, cells.map(whole))?)
            }
            Self::Unsigned(_) => {
                // The largest of 64 bits stand for all beyond.
                let whole =
                    |cell| i64::try_from(u64::from_le_bytes(padded(cell))).unwrap_or(i64::MAX);
                ArrayValues::Integer(collected(count, cells.map(whole))?)
            }
        })
    }
}

/// The bytes of a number, with zeros after them.
fn padded<const N: usize>(cell: &[u8]) -> [u8; N] {
    let mut bytes = [0; N];
    for (byte, &given) in bytes.iter_mut().zip(cell) {
        *byte = given;
    }
    bytes
}

/// The most columns: far above any real file's, since taking columns out goes through all of them.
const MOST_COLUMNS: usize = 256;

/// A column that the file keeps room for, and that says nothing.
const PADDING: &str = "_";

/// The content of a header.
#[derive(Default)]
struct Header {
    count: Option<u64>,
    columns: Vec<(String, Type)>,
    /// The metadata, put together from the comments.
    text: Option<String>,
}

impl Header {
    fn set_count(&mut self, word: &str) -> Result<(), String> {
        self.count = Some(word.parse().map_err(|_| unknown(word))?);
        Ok(())
    }

    /// Takes up the next piece of the metadata.
    fn comment(&mut self, line: &str, mark: &str) {
        let piece = line.strip_prefix(mark).and_then(|rest| rest.strip_prefix(' '));
        let piece =
            piece.and_then(|rest| rest.strip_prefix(KEY)).and_then(|rest| rest.strip_prefix(' '));
        self.text.get_or_insert_default().push_str(piece.unwrap_or_default());
    }

    /// The columns as arrays: those that the metadata know as one channel are put together, then
    /// those that go together by convention, then the others.
    fn read(self, data: &[u8], order: Order, most: u64) -> Result<Output, String> {
        let Self { count, columns, text } = self;
        let count = count.ok_or("does not say how many points it has")?;
        let named = columns.iter().filter(|(name, _)| name != PADDING);
        let names: HashSet<&String> = named.clone().map(|(name, _)| name).collect();
        if names.is_empty() || names.len() < named.count() {
            return Err("has no columns, or two of one name".to_owned());
        }
        if columns.len() > MOST_COLUMNS {
            return Err(format!("has more than {MOST_COLUMNS} columns"));
        }
        let kinds: Vec<Type> = columns.iter().map(|&(_, kind)| kind).collect();
        // In memory every number takes 8 bytes.
        elements(&[count, columns.len() as u64], 8, most)?;
        let count = usize::try_from(count).map_err(|_| "has too many points")?;
        let (rows, more) = order.rows(data, &kinds, count)?;
        let mut output = Output::default();
        output.metadata = metadata_of(text.as_deref(), &mut output.notes);
        if more > 0 {
            output.notes.push(format!("{more} bytes after the last point are not read"));
        }
        let mut start = 0;
        let columns = columns.into_iter().map(|(name, kind)| {
            start += kind.size();
            Column { name, kind, start: start - kind.size() }
        });
        let columns = columns.filter(|column| column.name != PADDING).collect();
        let row = kinds.iter().map(|kind| kind.size()).sum();
        let table = Table { data: &rows, row, count };
        output.arrays = arrays(columns, &table, output.metadata.as_ref())?;
        Ok(output)
    }
}

/// The points' bytes.
struct Table<'a> {
    data: &'a [u8],
    row: usize,
    count: usize,
}

/// A column: the place of a number in a point's row.
struct Column {
    name: String,
    kind: Type,
    start: usize,
}

/// The names by which columns are a channel.
const CONVENTIONS: [(&str, &[&str], bool); 6] = [
    ("position", &["x", "y", "z"], false),
    ("normal", &["nx", "ny", "nz"], false),
    ("normal", &["normal_x", "normal_y", "normal_z"], false),
    ("color", &["red", "green", "blue", "alpha"], true),
    ("color", &["red", "green", "blue"], true),
    ("z", &["depth"], false),
];

fn arrays(
    mut columns: Vec<Column>,
    table: &Table<'_>,
    metadata: Option<&Metadata>,
) -> Result<Vec<Array>, String> {
    let mut arrays = Vec::new();
    let records = metadata.map_or(&[][..], |metadata| &metadata.channels);
    // No more records than columns can have a column.
    for ChannelRecord { name, stored, components, .. } in records.iter().take(MOST_COLUMNS) {
        let Some(stored) = stored else { continue };
        let is_picture = stored.encoding == Encoding::Picture;
        let taken = take(&mut columns, &stored.names);
        if let Some(taken) = taken {
            arrays.push(match taken[..] {
                [ref column] if is_picture => {
                    table.packed(name, column, if *components == 4 { 4 } else { 3 })?
                }
                _ => table.array(name, &taken, is_picture)?,
            });
        }
    }
    for (name, names, is_picture) in CONVENTIONS {
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        if let Some(taken) = take(&mut columns, &names) {
            arrays.push(table.array(name, &taken, is_picture)?);
        }
    }
    for column in columns {
        let name = column.name.clone();
        arrays.push(match name.as_str() {
            "rgb" => table.packed("color", &column, 3)?,
            "rgba" => table.packed("color", &column, 4)?,
            _ => table.array(&name, &[column], false)?,
        });
    }
    Ok(arrays)
}

/// The columns of these names, if all are there and of one type; they are then gone.
fn take(columns: &mut Vec<Column>, names: &[String]) -> Option<Vec<Column>> {
    let place = |name: &String| columns.iter().position(|column| column.name == *name);
    let places: Vec<usize> = names.iter().map(place).collect::<Option<_>>()?;
    let kind = |&place: &usize| columns.get(place).map(|column| column.kind);
    let first = kind(places.first()?);
    let are_different: HashSet<usize> = places.iter().copied().collect();
    if are_different.len() < places.len() || places.iter().any(|place| kind(place) != first) {
        return None;
    }
    let mut taken = Vec::new();
    for name in names {
        let place = columns.iter().position(|column| column.name == *name)?;
        taken.push(columns.remove(place));
    }
    Some(taken)
}

impl Table<'_> {
    /// Columns of one type as one array.
    fn array(&self, name: &str, columns: &[Column], is_picture: bool) -> Result<Array, String> {
        let kind = columns.first().map_or(Type::Float64, |column| column.kind);
        let starts: Vec<usize> = columns.iter().map(|column| column.start).collect();
        self.interleaved(name, kind, &starts, is_picture)
    }

    /// The bytes of one column as an array of red, green, blue, and alpha.
    fn packed(&self, name: &str, column: &Column, components: usize) -> Result<Array, String> {
        if column.kind.size() != 4 {
            return self.array(name, std::slice::from_ref(column), false);
        }
        let starts = [2, 1, 0, 3].map(|byte| column.start + byte);
        let starts = starts.get(..components).unwrap_or(&starts);
        self.interleaved(name, Type::Unsigned(1), starts, true)
    }

    fn interleaved(
        &self,
        name: &str,
        kind: Type,
        starts: &[usize],
        is_picture: bool,
    ) -> Result<Array, String> {
        let rows = self.data.chunks_exact(self.row).take(self.count);
        let cells = rows.flat_map(|row| {
            let cell = move |&start: &usize| row.get(start..start + kind.size());
            starts.iter().filter_map(cell)
        });
        let numbers = kind.numbers(self.count * starts.len(), cells)?;
        let shape = vec![self.count];
        let (name, count) = (Some(name), starts.len());
        let dtype = kind.dtype();
        Ok(Array::new(name, shape, count, numbers, dtype, is_picture))
    }
}
