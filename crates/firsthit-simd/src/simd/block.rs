//! Memory that is read and never written: a mapped file, or a copy of one.

use std::fmt::{self, Debug, Formatter};
use std::fs::File;
use std::io::{self, Read};
use std::ptr::NonNull;

use bytemuck::Zeroable;

/// The alignment of every block, in bytes.
pub const BLOCK_ALIGNMENT: usize = 64;

/// The bytes of a cache line.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
struct Line([u8; BLOCK_ALIGNMENT]);

const _: () = assert!(align_of::<Line>() == BLOCK_ALIGNMENT);

/// Bytes that do not change and stay where they are. They begin at a multiple of
/// [`BLOCK_ALIGNMENT`].
pub struct Block {
    start: NonNull<u8>,
    length: usize,
    owner: Owner,
}

/// The owner of the memory, which gives it back.
enum Owner {
    /// The memory is that of these lines, which are never touched by their own name.
    Lines(#[expect(dead_code, reason = "held, so that the memory stays")] Vec<Line>),
    /// The memory is a mapping of its own.
    #[cfg(target_os = "linux")]
    Mapping,
}

// SAFETY: no code writes the bytes while the block lives, so that any thread may read them; and
// what gives them back, the vector's drop or `munmap`, may run on any thread.
unsafe impl Send for Block {}
// SAFETY: as above.
unsafe impl Sync for Block {}

impl Block {
    /// The first `length` bytes of a file, mapped where the system can do that, else read.
    ///
    /// Processes that map a file share its pages. A mapped file must not be changed while the block
    /// lives: what is read changes with it, and to read what was cut off ends the process.
    pub fn map(file: &File, length: usize) -> io::Result<Self> {
        #[cfg(target_os = "linux")]
        if let Some(mapped) = Self::mapped(file, length) {
            return Ok(mapped);
        }
        Self::read(file, length)
    }

    #[cfg(target_os = "linux")]
    fn mapped(file: &File, length: usize) -> Option<Self> {
        use rustix::mm::{MapFlags, ProtFlags, mmap};
        if length == 0 {
            return None;
        }
        // SAFETY: without an address of ours the system takes one that is free, so no memory in use
        // is replaced.
        let start = unsafe {
            mmap(std::ptr::null_mut(), length, ProtFlags::READ, MapFlags::SHARED, file, 0)
        };
        Some(Self { start: NonNull::new(start.ok()?.cast())?, length, owner: Owner::Mapping })
    }

    /// The first `length` bytes that `from` gives.
    pub fn read(from: impl Read, length: usize) -> io::Result<Self> {
        let mut lines = Vec::new();
        let count = length.div_ceil(BLOCK_ALIGNMENT);
        lines.try_reserve_exact(count).map_err(|_| io::ErrorKind::OutOfMemory)?;
        lines.resize(count, Line::zeroed());
        let start = NonNull::from(lines.as_mut_slice()).cast::<u8>();
        // SAFETY: the lines are at least `length` bytes, which are all set, and this block alone
        // has the vector.
        let bytes = unsafe { std::slice::from_raw_parts_mut(start.as_ptr(), length) };
        from.take(length as u64).read_exact(bytes)?;
        Ok(Self { start, length, owner: Owner::Lines(lines) })
    }

    /// All of it.
    pub fn bytes(&self) -> &[u8] {
        // SAFETY: that many bytes from there on belong to the owner, and live and stay as they are
        // as long as it does.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.length) }
    }
}

impl Drop for Block {
    fn drop(&mut self) {
        match &self.owner {
            Owner::Lines(_) => {}
            #[cfg(target_os = "linux")]
            Owner::Mapping => {
                // SAFETY: the mapping is this block's alone, and every part of it holds the block.
                let unmapped =
                    unsafe { rustix::mm::munmap(self.start.as_ptr().cast(), self.length) };
                // Memory that cannot be unmapped stays mapped: that costs addresses and nothing
                // else.
                unmapped.ok();
            }
        }
    }
}

impl Debug for Block {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Block").field("bytes", &self.length).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_aligned_and_has_the_bytes_of_what_it_was_read_from() {
        for length in [0, 1, 63, 64, 65, 1000] {
            let bytes: Vec<u8> = (0..=250).cycle().take(length).collect();
            let block = Block::read(&bytes[..], length).unwrap();
            assert_eq!(block.bytes(), bytes);
            assert_eq!(block.bytes().as_ptr() as usize % BLOCK_ALIGNMENT, 0);
            assert!(Block::read(&bytes[..], length + 1).is_err());
        }
    }
}
