//! Points that are packed by `LASzip`.

use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

use ::laz::{LasZipDecompressor, LazItemType, LazVlr};

/// The number of bytes of points that are unpacked at a time.
const PIECE: usize = 1 << 20;

/// The rows of `count` points, of `row` bytes each. `how` is the record of the packing.
pub(super) fn unpacked(
    how: &[u8],
    packed: &[u8],
    row: usize,
    count: usize,
) -> Result<Vec<u8>, String> {
    let work = || {
        let how = LazVlr::from_buffer(how).map_err(|error| damaged(&error))?;
        // Of items that are not layered there are none.
        let layers: usize = how.items().iter().map(|item| layers(item.item_type())).sum();
        if how.items_size() != row as u64 {
            return Err(format!("packs {} bytes of points of {row}", how.items_size()));
        }
        if layers > 0 {
            check_layers(packed, row, layers, count)?;
        }
        let mut rows: Vec<u8> = Vec::new();
        if count == 0 {
            return Ok(rows);
        }
        let mut unpack = LasZipDecompressor::new(InOrder(Cursor::new(packed)), how);
        let unpack = unpack.as_mut().map_err(|error| damaged(error))?;
        let length = row.checked_mul(count).ok_or("has too many points")?;
        // Not all at once: a file may claim more points than it has.
        let piece = (PIECE / row).max(1) * row;
        while rows.len() < length {
            let start = rows.len();
            let end = length.min(start + piece);
            rows.try_reserve(end - start).map_err(|_| "no memory is free for its points")?;
            rows.resize(end, 0);
            let next = rows.get_mut(start..).unwrap_or_default();
            unpack.decompress_many(next).map_err(|error| damaged(&error))?;
        }
        Ok(rows)
    };
    // It panics where a file is none that a program has written.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err(damaged(&"its reader gave up")))
}

fn damaged(error: &dyn std::fmt::Display) -> String {
    format!("has packed points that cannot be unpacked: {error}")
}

/// The number of layers of an item in each chunk.
fn layers(item: LazItemType) -> usize {
    match item {
        LazItemType::Point14 => 9,
        LazItemType::RGB14 | LazItemType::WavePacket14 => 1,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(bytes) => usize::from(bytes),
        _ => 0,
    }
}

/// Fails for chunks whose layers claim more bytes than there are: memory would be taken for them.
fn check_layers(packed: &[u8], row: usize, layers: usize, count: usize) -> Result<(), String> {
    // Behind the place of the table of chunks.
    let mut rest = packed.get(8..).unwrap_or_default();
    let mut known = 0_usize;
    while known < count {
        let cut = || "ends within its packed points".to_owned();
        let sizes = rest.get(row..).ok_or_else(cut)?;
        let (points, sizes) = sizes.split_at_checked(4).ok_or_else(cut)?;
        let (sizes, data) = sizes.split_at_checked(4 * layers).ok_or_else(cut)?;
        let number = |bytes: &[u8]| u32::from_le_bytes(super::padded(bytes)) as usize;
        let length = sizes.chunks_exact(4).map(number);
        let length = length.fold(0_usize, usize::saturating_add);
        rest = data.get(length..).ok_or_else(cut)?;
        known = known.saturating_add(number(points).max(1));
    }
    Ok(())
}

/// A reader from front to back. Without seeking, the table of chunks is not looked for, which is
/// not needed, and for which a file may claim any memory.
struct InOrder<'a>(Cursor<&'a [u8]>);

impl Read for InOrder<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.read(bytes)
    }
}

impl Seek for InOrder<'_> {
    fn seek(&mut self, _: SeekFrom) -> io::Result<u64> {
        Err(io::ErrorKind::Unsupported.into())
    }
}
