//! Shared parts of the decoders of packed bytes.

/// The result of a step of a decoder.
pub(super) type Decoded<T> = Result<T, &'static str>;

pub(super) const TRUNCATED: &str = "truncated: the packed bytes end too early";

/// The rest of a stream that is being read.
pub(super) struct Stream<'a> {
    pub(super) rest: &'a [u8],
}

impl<'a> Stream<'a> {
    pub(super) fn take(&mut self, count: usize) -> Decoded<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(TRUNCATED)?;
        self.rest = rest;
        Ok(taken)
    }

    pub(super) fn byte(&mut self) -> Decoded<u8> {
        let (&byte, rest) = self.rest.split_first().ok_or(TRUNCATED)?;
        self.rest = rest;
        Ok(byte)
    }

    /// The end of what asks for no more.
    pub(super) fn finish(&self) -> Decoded<()> {
        if self.rest.is_empty() {
            Ok(())
        } else {
            Err("there are more packed bytes than the count asks for")
        }
    }

    /// A number in as many groups of seven bits as it needs, the lowest first (unsigned LEB128).
    pub(super) fn varint(&mut self) -> Decoded<u32> {
        let mut value = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err("a number of the packed bytes never ends")
    }
}

/// A difference from its zigzag code.
pub(super) fn unzigzag(code: u32) -> u32 {
    (code >> 1) ^ 0_u32.wrapping_sub(code & 1)
}

/// Adds an index in the width that the view has.
pub(super) fn push_index(index: u32, stride: usize, bytes: &mut Vec<u8>) {
    let word = index.to_le_bytes();
    bytes.extend(word.iter().take(stride));
}
