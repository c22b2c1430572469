//! The header and the table of sections.

use std::ops::Range;
use std::sync::Arc;

use bytemuck::Pod;

use crate::accel::{Meshlet, Node};
use crate::error::Place;
use crate::io::fault::{Checked, Fault};
use crate::memory::{BLOCK_ALIGNMENT, Block, Storage};
use crate::parallel;
use crate::watch::{Watch, stop_if_asked};

/// The first bytes, like PNG's: a byte beyond ASCII, and line ends that a transfer as text would
/// change.
pub(super) const MAGIC: [u8; 8] = *b"\x89fhs\r\n\x1a\n";

/// The version, to be changed with the format, and with the meaning of any array that it has from
/// another room: nodes and leaves.
pub(super) const VERSION: u32 = 5;

/// The header's length, that of an entry of the table, and what sections are aligned to.
pub(super) const UNIT: usize = BLOCK_ALIGNMENT;

/// The number of the header's bytes before its checksum.
pub(super) const BEFORE_DIGEST: usize = 32;

/// A checksum: BLAKE3.
pub(super) type Sum = [u8; 32];

/// A type that sections are arrays of.
pub(super) trait Element: Pod {
    const KIND: SectionKind;
}

/// The table of kinds of sections: names, and the types of elements. The first has the code 1.
macro_rules! elements {
    ($($kind:ident: $type:ty;)*) => {
        /// The type of a section's elements. Numbers are little-endian.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(super) enum SectionKind {
            $($kind,)*
        }

        impl SectionKind {
            const ALL: &[Self] = &[$(Self::$kind),*];

            /// The bytes of an element.
            fn size(self) -> usize {
                match self {
                    $(Self::$kind => size_of::<$type>(),)*
                }
            }
        }

        $(impl Element for $type {
            const KIND: SectionKind = SectionKind::$kind;
        })*
    };
}

// The record is text in UTF-8.
elements! {
    Record: u8;
    U32: u32;
    U32x2: [u32; 2];
    U32x3: [u32; 3];
    F32: f32;
    F32x2: [f32; 2];
    F32x3: [f32; 3];
    F64: f64;
    F64x3: [f64; 3];
    F64x6: [f64; 6];
    U8x4: [u8; 4];
    Node: Node;
    Leaf: Meshlet;
    F32x4: [f32; 4];
}

impl SectionKind {
    /// The number in the table of sections.
    pub(super) fn code(self) -> u32 {
        self as u32 + 1
    }

    fn of(code: u32) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.code() == code)
    }
}

/// Alphas are attributes of one number.
impl Element for [f32; 1] {
    const KIND: SectionKind = SectionKind::F32;
}

/// The sum of what is compared whenever a file is opened: the header up to the sum, the table, and
/// the record.
pub(super) fn sum_of_structure(header: &[u8], table: &[u8], record: &[u8]) -> Sum {
    let mut hasher = blake3::Hasher::new();
    for part in [header, table, record] {
        hasher.update(part);
    }
    *hasher.finalize().as_bytes()
}

/// The place and type of a section.
#[derive(Debug)]
struct Entry {
    kind: SectionKind,
    range: Range<usize>,
    sum: Sum,
    is_taken: bool,
}

/// The sections of a file. Each can be taken once, so that what is made of them is no larger than
/// the file.
#[derive(Debug)]
pub(super) struct Sections {
    block: Arc<Block>,
    entries: Vec<Entry>,
}

impl Sections {
    /// Opens the sections of a file, whose header and table are checked, and whose record is
    /// compared with its checksum.
    pub(super) fn open(block: Arc<Block>) -> Checked<Self> {
        let bytes = block.bytes();
        let count = check_header(bytes)?;
        let table_end = UNIT * (count + 1);
        let table = part(bytes, UNIT..table_end)?;
        let mut entries = Vec::new();
        let room = entries.try_reserve_exact(count);
        room.map_err(|_| crate::memory::no_room_for("the file's sections"))?;
        let mut next = table_end;
        for (k, bytes_of) in table.chunks_exact(UNIT).enumerate() {
            let entry = entry(bytes_of, next, bytes.len());
            let entry =
                entry.map_err(|what| wrong((k + 1) * UNIT, &format!("section {k}: {what}")))?;
            let end = entry.range.end;
            next = end.next_multiple_of(UNIT).min(bytes.len());
            if part(bytes, end..next)?.iter().any(|&byte| byte != 0) {
                return Err(wrong(end, "there is something between the sections"));
            }
            entries.push(entry);
        }
        if next != bytes.len() {
            return Err(wrong(next, "there is something after the sections"));
        }
        let sections = Self { block, entries };
        sections.check_structure()?;
        Ok(sections)
    }

    fn check_structure(&self) -> Checked<()> {
        let bytes = self.block.bytes();
        let record = self.entries.first().filter(|entry| entry.kind == SectionKind::Record);
        let record = record.ok_or_else(|| wrong(UNIT, "the first section is not the record"))?;
        let sum = sum_of_structure(
            part(bytes, 0..BEFORE_DIGEST)?,
            part(bytes, UNIT..UNIT * (self.entries.len() + 1))?,
            part(bytes, record.range.clone())?,
        );
        if part(bytes, BEFORE_DIGEST..UNIT)? != sum {
            return Err(wrong(BEFORE_DIGEST, "the file is damaged: its checksum does not match"));
        }
        Ok(())
    }

    /// Compares every section with its checksum, as the step of that name.
    pub(super) fn verify(&self, step: &str, watch: &dyn Watch) -> Checked<()> {
        /// The number of bytes between two questions whether to stop.
        const PIECE: usize = 1 << 22;
        let lengths = self.entries.iter().map(|entry| entry.range.len() as u64);
        watch.begin(step, lengths.sum(), "bytes");
        let bytes = self.block.bytes();
        let is_damaged = |entry: &Entry| {
            let part = bytes.get(entry.range.clone()).unwrap_or_default();
            let mut hasher = blake3::Hasher::new();
            for piece in part.chunks(PIECE) {
                stop_if_asked(watch)?;
                hasher.update(piece);
                watch.advance(piece.len() as u64);
            }
            Ok(*hasher.finalize().as_bytes() != entry.sum)
        };
        // The first, whichever thread is faster.
        let damaged = parallel::try_map(&self.entries, is_damaged)?;
        match self.entries.iter().zip(damaged).find(|(_, is_damaged)| *is_damaged) {
            None => Ok(()),
            Some((entry, _)) => {
                let what = "the file is damaged: the checksum of this section does not match";
                Err(wrong(entry.range.start, what))
            }
        }
    }

    /// An array, by its number.
    pub(super) fn take<T: Element>(&mut self, number: usize) -> Checked<Storage<T>> {
        let entry = self.entries.get_mut(number);
        let Some(entry) = entry.filter(|entry| entry.kind == T::KIND && !entry.is_taken) else {
            let what = format!("the record names section {number} as the wrong type, or twice");
            return Err(Fault::file(what));
        };
        entry.is_taken = true;
        let start = entry.range.start;
        let part = Storage::part(&self.block, entry.range.clone());
        part.ok_or_else(|| wrong(start, "a section is not whole"))
    }

    /// Fails where the record left a section out.
    pub(super) fn finish(&self) -> Checked<()> {
        match self.entries.iter().find(|entry| !entry.is_taken) {
            None => Ok(()),
            Some(entry) => Err(wrong(entry.range.start, "the record has no use for this section")),
        }
    }
}

fn wrong(place: usize, what: &str) -> Fault {
    Fault::at(Place::Byte(place as u64), what)
}

fn part(bytes: &[u8], range: Range<usize>) -> Checked<&[u8]> {
    let start = range.start;
    let part = bytes.get(range);
    part.ok_or_else(|| wrong(start, "the file ends too early"))
}

/// Checks the header; returns the number of sections.
fn check_header(bytes: &[u8]) -> Checked<usize> {
    if !bytes.starts_with(&MAGIC) {
        let what = "this is no built scene: it does not begin as one; firsthit build makes them";
        return Err(wrong(0, what));
    }
    if cfg!(target_endian = "big") {
        return Err(wrong(0, "built scenes are not read on big-endian machines"));
    }
    if bytes.len() < UNIT {
        return Err(wrong(bytes.len(), "the file ends too early"));
    }
    let version = u32_at(bytes, 8);
    if version != VERSION {
        let what = format!(
            "a file of version {version}, where this firsthit reads version {VERSION}: build it again"
        );
        return Err(wrong(8, &what));
    }
    let [length, count] = [16, 24].map(|at| u64_at(bytes, at));
    if u32_at(bytes, 12) != 0 {
        return Err(wrong(12, "four bytes that must be zero are not"));
    }
    if length != bytes.len() as u64 {
        let what = format!(
            "the file has {} bytes and must have {length}: it is truncated, or has grown",
            bytes.len()
        );
        return Err(wrong(16, &what));
    }
    let most = bytes.len() / UNIT;
    let count = usize::try_from(count).ok().filter(|&count| count < most);
    count.ok_or_else(|| wrong(24, "there are more sections than the file has room for"))
}

/// An entry of the table, whose section starts at `start`, in a file of `length` bytes; or what is
/// wrong with it.
fn entry(bytes: &[u8], start: usize, length: usize) -> Result<Entry, String> {
    let code = u32_at(bytes, 0);
    let kind =
        SectionKind::of(code).ok_or_else(|| format!("there is no kind of section {code}"))?;
    let [from, size] = [8, 16].map(|at| u64_at(bytes, at));
    if from != start as u64 {
        return Err(format!("it begins at {from}, and should at {start}"));
    }
    let end = from.checked_add(size).and_then(|end| usize::try_from(end).ok());
    let Some(end) = end.filter(|&end| end <= length) else {
        return Err(format!("its {size} bytes go beyond the end of the file"));
    };
    if !size.is_multiple_of(kind.size() as u64) {
        let of_one = kind.size();
        return Err(format!("its {size} bytes are no multiple of {of_one}"));
    }
    if u64::from(u32_at(bytes, 4)) | u64_at(bytes, 24) != 0 {
        return Err("bytes that must be zero are not".to_owned());
    }
    let sum = bytes.get(BEFORE_DIGEST..).and_then(|sum| sum.try_into().ok());
    Ok(Entry { kind, range: start..end, sum: sum.ok_or("it is not whole")?, is_taken: false })
}

/// A number that must be there, as lengths were checked; else zero.
fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let bytes = bytes.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
    bytes.map_or(0, u32::from_le_bytes)
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let bytes = bytes.get(at..at + 8).and_then(|bytes| bytes.try_into().ok());
    bytes.map_or(0, u64::from_le_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers and sizes are those of `docs/fhs.md`.
    #[test]
    fn kinds_have_their_codes_and_sizes() {
        for (code, size) in [(1, 1), (2, 4), (7, 12), (10, 48), (12, 448), (13, 256), (14, 16)] {
            let kind = SectionKind::of(code).unwrap();
            assert_eq!((kind.code(), kind.size()), (code, size));
        }
        assert_eq!((SectionKind::of(0), SectionKind::of(15)), (None, None));
    }
}
