//! The memory that one file may use.
//!
//! Two limits hold. All memory, the file's own content included, counts against `max_memory`. What
//! the file describes (vertices, triangles, instances, names) counts against a multiple of the
//! bytes that were read as well, so that a small file cannot ask for much.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::fault::{Checked, Fault};
use crate::error::Place;
use crate::memory;
use crate::scene::Object;

/// The memory for what a file describes, in multiples of the file's size: the best compressed
/// meshes take half of that.
const TIMES_SIZE: u64 = 256;

/// The share of the allowed memory for what a file describes on top, 32 MiB by default: small files
/// may repeat themselves.
const FREE_SHARE: u64 = 256;

/// The inverse of the share of a texture that counts as described: a picture of one colour is a
/// file of a thousandth of its texels.
const TEXTURE_SHARE: u64 = 16;

/// The memory that an object takes without its mesh and its name: itself and its part of the tree.
pub const OBJECT_BYTES: u64 = size_of::<Object>() as u64 + 256;

/// A number of bytes, in the largest unit that keeps it from 1 on.
pub(crate) fn size_in_words(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    let mut words = format!("{bytes} bytes");
    let mut size = bytes as f64;
    for unit in UNITS {
        size /= 1024.0;
        if size >= 1.0 {
            words = format!("{size:.1} {unit}").replace(".0 ", " ");
        }
    }
    words
}

/// The memory that is left for one file and the files that it names.
#[derive(Debug)]
pub struct MemoryBudget {
    /// The bytes that are left of all that is allowed.
    left: u64,
    /// The bytes that are left for what the file describes.
    room: u64,
    /// The bytes that were read so far, packed as they are on the disk.
    size: u64,
    /// The files whose bytes these are.
    sized: HashSet<PathBuf>,
    grown: usize,
}

impl MemoryBudget {
    pub(crate) fn new(max_memory: u64) -> Self {
        Self {
            left: max_memory,
            room: max_memory / FREE_SHARE,
            size: 0,
            sized: HashSet::new(),
            grown: 0,
        }
    }

    /// The budget of a file that this one names: all that is left.
    pub(crate) fn part(&self) -> Self {
        Self { room: self.room, ..Self::new(self.left) }
    }

    /// Takes back what a [`part`](Self::part) left.
    pub(crate) fn absorb(&mut self, part: &Self) {
        self.left = part.left;
        self.room = part.room;
        self.size = self.size.saturating_add(part.size);
    }

    /// The bytes that are left in all.
    pub fn left(&self) -> u64 {
        self.left
    }

    /// The bytes that are left for what the file describes.
    pub(crate) fn left_to_describe(&self) -> u64 {
        self.left.min(self.room)
    }

    /// Charges memory for something that the file describes; `what` names it in the error.
    pub fn charge(&mut self, bytes: u64, what: &str) -> Checked<()> {
        self.charge_at(Place::File, bytes, what)
    }

    /// As [`charge`](Self::charge), for something at a place of the file.
    pub(crate) fn charge_at(&mut self, place: Place, bytes: u64, what: &str) -> Checked<()> {
        self.take_room(&place, bytes, bytes, what)?;
        self.take_memory(place, bytes, what)
    }

    /// As [`charge`](Self::charge), for a texture.
    pub(crate) fn charge_texture(&mut self, bytes: u64) -> Checked<()> {
        let what = "the texture";
        self.take_room(&Place::File, bytes, bytes / TEXTURE_SHARE, what)?;
        self.charge_content(bytes, what)
    }

    /// Charges memory for the file's own content, unpacked or parsed. It does not count as
    /// described.
    pub fn charge_content(&mut self, bytes: u64, what: &str) -> Checked<()> {
        self.take_memory(Place::File, bytes, what)
    }

    /// Charges the bytes that were read from a file. They make room for what they describe: once,
    /// however often the file is read.
    pub(crate) fn charge_read(&mut self, path: &Path, bytes: usize) -> Checked<()> {
        self.make_room(path, bytes);
        self.charge_content(bytes as u64, "its content")
    }

    /// Makes room for what a file of `bytes` bytes describes, without memory for them: once,
    /// however often the file is read.
    pub fn make_room(&mut self, path: &Path, bytes: usize) {
        let bytes = bytes as u64;
        if self.sized.insert(path.to_owned()) {
            self.size = self.size.saturating_add(bytes);
            self.room = self.room.saturating_add(bytes.saturating_mul(TIMES_SIZE));
        }
    }

    /// Charges the growth since the last call; `bytes` is the total by now. Loops in which few
    /// bytes can describe much call it from time to time.
    pub(crate) fn charge_growth(&mut self, bytes: usize) -> Checked<()> {
        let more = bytes.saturating_sub(self.grown);
        self.grown += more;
        // A vector that grows has room for twice as much, and is there twice meanwhile.
        check_free(bytes.saturating_mul(2))?;
        self.charge(more as u64, "what it describes")
    }

    /// Takes `counted` of `bytes` from what the file's size allows.
    fn take_room(&mut self, place: &Place, bytes: u64, counted: u64, what: &str) -> Checked<()> {
        let room = self.room;
        self.room = room.checked_sub(counted).ok_or_else(|| {
            let share = if counted == bytes {
                String::new()
            } else {
                format!(", of which 1/{TEXTURE_SHARE} counts")
            };
            let [bytes, room, size] = [bytes, room, self.size].map(size_in_words);
            let what = format!(
                "{what} would take {bytes} of memory{share}, {room} are left of what a file of {size} may describe: \
                 {TIMES_SIZE} times its size and 1/{FREE_SHARE} of what is allowed (--max-memory raises the limit)"
            );
            Fault::too_large(place.clone(), what)
        })?;
        Ok(())
    }

    fn take_memory(&mut self, place: Place, bytes: u64, what: &str) -> Checked<()> {
        let left = self.left;
        self.left = left.checked_sub(bytes).ok_or_else(|| {
            let (bytes, left) = (size_in_words(bytes), size_in_words(left));
            let what = format!(
                "{what} would take {bytes} of memory, {left} are left of what is allowed \
                 (--max-memory raises the limit)"
            );
            Fault::too_large(place, what)
        })?;
        Ok(())
    }
}

/// Fails where the system has less memory to give.
pub fn check_free(bytes: usize) -> Checked<()> {
    let checked = memory::check("the file's content", bytes);
    checked.map_err(|error| Fault::too_large(Place::File, error.to_string()))
}
