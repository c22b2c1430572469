//! ZIP, as much of it as NPZ needs: entries stored as they are.
//!
//! Written here because the `zip` crate under `npyz` must seek back into its output, which a pipe cannot.
//! So each entry's checksum is computed first, from a first encoding into nothing.
//! The layout is that of APPNOTE 6.3.10, <https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT>.

use std::io::{self, Write};

use super::checksum::Summary;
use super::{Channel, npy};

/// 1 January 1980, the earliest that ZIP can say: today's date would change the bytes every day.
const DATE: u16 = 1 << 5 | 1;

/// Sizes and places from here on stand in ZIP64's fields, and the old fields say so with this number.
const OVER: u32 = u32::MAX;

/// What the archive's directory says about one entry.
struct Entry {
    name: String,
    checksum: u32,
    size: u64,
    /// Where it starts in the file.
    start: u64,
}

/// Writes all channels as an NPZ archive: an entry `NAME.npy` for each, uncompressed, in their order.
pub(super) fn encode(
    shape: &[usize],
    channels: &[&Channel],
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut entries = Vec::with_capacity(channels.len());
    let mut place = 0;
    for channel in channels {
        let mut summary = Summary::default();
        npy::encode(shape, channel, &mut summary)?;
        let entry = Entry {
            name: npyz::npz::file_name_from_array_name(channel.name),
            checksum: summary.checksum(),
            size: summary.size(),
            start: place,
        };
        let header = entry.local_header();
        out.write_all(&header)?;
        npy::encode(shape, channel, out)?;
        place += header.len() as u64 + entry.size;
        entries.push(entry);
    }
    let directory: Vec<u8> = entries.iter().flat_map(Entry::directory_header).collect();
    out.write_all(&directory)?;
    out.write_all(&end(entries.len() as u64, directory.len() as u64, place))
}

impl Entry {
    /// What stands before the entry's bytes.
    fn local_header(&self) -> Vec<u8> {
        let mut wide = Wide::default();
        let size = wide.field(self.size);
        // Both sizes must stand in a local header's ZIP64 field, and are the same.
        let sizes = [
            size,
            if size == OVER {
                wide.field(self.size)
            } else {
                size
            },
        ];
        let mut bytes = b"PK\x03\x04".to_vec();
        self.common(&mut bytes, &wide, sizes);
        bytes.extend(self.name.as_bytes());
        bytes.extend(wide.bytes());
        bytes
    }

    /// What the directory at the end says.
    fn directory_header(&self) -> Vec<u8> {
        let mut wide = Wide::default();
        let sizes = [wide.field(self.size), wide.field(self.size)];
        let start = wide.field(self.start);
        let mut bytes = b"PK\x01\x02".to_vec();
        // Made by: Unix (3), so that the attributes below are its permissions.
        bytes.extend([wide.version(), 3]);
        self.common(&mut bytes, &wide, sizes);
        // No comment, on the first disk, a binary file.
        bytes.extend([0; 6]);
        bytes.extend((0o100_644_u32 << 16).to_le_bytes());
        bytes.extend(start.to_le_bytes());
        bytes.extend(self.name.as_bytes());
        bytes.extend(wide.bytes());
        bytes
    }

    /// The fields that both headers have, from the version needed to the lengths of what follows.
    fn common(&self, bytes: &mut Vec<u8>, wide: &Wide, sizes: [u32; 2]) {
        let name_length = u16::try_from(self.name.len()).expect("names are short words");
        let wide_length = u16::try_from(wide.bytes().len()).expect("at most three numbers");
        // Then flags and method: none, stored; and the time of day, midnight.
        for field in [u16::from(wide.version()), 0, 0, 0, DATE] {
            bytes.extend(field.to_le_bytes());
        }
        for field in [self.checksum, sizes[0], sizes[1]] {
            bytes.extend(field.to_le_bytes());
        }
        bytes.extend(name_length.to_le_bytes());
        bytes.extend(wide_length.to_le_bytes());
    }
}

/// The numbers of one header that need 64 bits.
#[derive(Default)]
struct Wide(Vec<u64>);

impl Wide {
    /// What goes into the 32 bit field for `number`.
    fn field(&mut self, number: u64) -> u32 {
        let field = u32::try_from(number).unwrap_or(OVER);
        if field == OVER {
            self.0.push(number);
        }
        field
    }

    /// The version of ZIP that a reader needs, times 10: that of plain files or of ZIP64.
    fn version(&self) -> u8 {
        if self.0.is_empty() { 20 } else { 45 }
    }

    /// The ZIP64 field, empty if there is nothing to say.
    fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        if !self.0.is_empty() {
            let length = u16::try_from(8 * self.0.len()).expect("at most three numbers");
            bytes.extend([1, 0]);
            bytes.extend(length.to_le_bytes());
            bytes.extend(self.0.iter().flat_map(|number| number.to_le_bytes()));
        }
        bytes
    }
}

/// What ends the archive and tells where its directory is.
fn end(entries: u64, directory_size: u64, directory_start: u64) -> Vec<u8> {
    let mut wide = Wide::default();
    let size = wide.field(directory_size);
    let start = wide.field(directory_start);
    let count = u16::try_from(entries).unwrap_or(u16::MAX);
    let mut bytes = Vec::new();
    if wide.version() == 45 || count == u16::MAX {
        // ZIP64's own end, its size after this number, made by and needed: 4.5, the two disks ...
        bytes.extend(b"PK\x06\x06");
        bytes.extend(44_u64.to_le_bytes());
        bytes.extend([45, 3, 45, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        for field in [entries, entries, directory_size, directory_start] {
            bytes.extend(field.to_le_bytes());
        }
        // ... and where it is: on disk 0 of 1.
        bytes.extend(b"PK\x06\x07\0\0\0\0");
        bytes.extend((directory_start + directory_size).to_le_bytes());
        bytes.extend(1_u32.to_le_bytes());
    }
    bytes.extend(b"PK\x05\x06\0\0\0\0");
    bytes.extend([count.to_le_bytes(), count.to_le_bytes()].concat());
    bytes.extend([size.to_le_bytes(), start.to_le_bytes()].concat());
    bytes.extend([0, 0]); // no comment
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIVE_GIB: u64 = 5 << 30;

    fn entry(size: u64, start: u64) -> Entry {
        Entry {
            name: "t.npy".into(),
            checksum: 0x0102_0304,
            size,
            start,
        }
    }

    /// Offsets by APPNOTE 4.3.7: version 4, date 12, checksum 14, sizes 18 and 22, lengths 26 and 28.
    #[test]
    fn a_large_entry_has_its_sizes_in_the_zip64_field() {
        let small = entry(1000, 0).local_header();
        assert_eq!(small.len(), 35);
        assert_eq!(small[4..14], [20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0]);
        assert_eq!(small[18..26], [0xe8, 3, 0, 0, 0xe8, 3, 0, 0]);
        let large = entry(FIVE_GIB, 0).local_header();
        assert_eq!(large.len(), 55);
        assert_eq!(
            (large[4], &large[18..30]),
            (
                45,
                &[255, 255, 255, 255, 255, 255, 255, 255, 5, 0, 20, 0][..]
            )
        );
        assert_eq!(large[35..39], [1, 0, 16, 0]);
        assert_eq!(large[39..47], FIVE_GIB.to_le_bytes());
        assert_eq!(large[47..55], FIVE_GIB.to_le_bytes());
    }

    #[test]
    fn an_entry_behind_four_gib_has_only_its_place_in_the_zip64_field() {
        let header = entry(1000, FIVE_GIB).directory_header();
        assert_eq!(header.len(), 46 + 5 + 12);
        assert_eq!(header[20..24], [0xe8, 3, 0, 0]);
        assert_eq!(header[42..46], [255; 4]);
        assert_eq!(header[51..55], [1, 0, 8, 0]);
        assert_eq!(header[55..], FIVE_GIB.to_le_bytes());
    }

    #[test]
    fn the_end_is_plain_below_four_gib_and_zip64_above() {
        assert_eq!(end(2, 100, 1000).len(), 22);
        let large = end(2, 100, FIVE_GIB);
        assert_eq!(large.len(), 56 + 20 + 22);
        assert_eq!(large[56 + 8..56 + 16], (FIVE_GIB + 100).to_le_bytes());
        // The limit itself means "look at ZIP64", so it needs it too.
        assert_eq!(end(2, 100, u64::from(OVER)).len(), 98);
        assert_eq!(end(2, 100, u64::from(OVER) - 1).len(), 22);
    }
}
