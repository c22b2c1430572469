use std::io::{self, Write};

/// Sixteen bytes of the checksum at a time: `TABLES[k][b]` is what byte `b` does `k` bytes later.
///
/// Kounavis and Berry, "Novel Table Lookup-Based Algorithms for High-Performance CRC Generation" (2008).
static TABLES: [[u32; 256]; 16] = tables();

#[expect(clippy::cast_possible_truncation, reason = "b is below 256")]
const fn tables() -> [[u32; 256]; 16] {
    let mut tables = [[0; 256]; 16];
    let mut b = 0;
    while b < 256 {
        let mut register = b as u32;
        let mut bit = 0;
        while bit < 8 {
            // ZIP's polynomial, reversed.
            register = (register >> 1) ^ (0xedb8_8320 * (register & 1));
            bit += 1;
        }
        tables[0][b] = register;
        b += 1;
    }
    let mut k = 1;
    while k < 16 {
        let mut b = 0;
        while b < 256 {
            let before = tables[k - 1][b];
            tables[k][b] = (before >> 8) ^ tables[0][(before & 255) as usize];
            b += 1;
        }
        k += 1;
    }
    tables
}

/// Counts and sums up what is written to it.
pub(super) struct Summary {
    /// The complement of the checksum so far.
    register: u32,
    size: u64,
}

impl Summary {
    /// The CRC-32 of ZIP, gzip and PNG.
    pub(super) fn checksum(&self) -> u32 {
        !self.register
    }

    /// The number of bytes.
    pub(super) fn size(&self) -> u64 {
        self.size
    }
}

impl Default for Summary {
    fn default() -> Self {
        Self {
            register: !0,
            size: 0,
        }
    }
}

impl Write for Summary {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let (blocks, rest) = bytes.as_chunks::<16>();
        for block in blocks {
            let mut block = *block;
            for (byte, register) in block.iter_mut().zip(self.register.to_le_bytes()) {
                *byte ^= register;
            }
            self.register = (block.iter().zip(TABLES.iter().rev()))
                .fold(0, |sum, (&byte, table)| sum ^ table[usize::from(byte)]);
        }
        for &byte in rest {
            let [low, ..] = self.register.to_le_bytes();
            self.register = (self.register >> 8) ^ TABLES[0][usize::from(low ^ byte)];
        }
        self.size += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of the CRC catalogue, <https://reveng.sourceforge.io/crc-catalogue/all.htm>.
    #[test]
    fn the_checksum_is_that_of_zip() {
        let mut summary = Summary::default();
        summary.write_all(b"123456789").unwrap();
        assert_eq!(summary.checksum(), 0xcbf4_3926);
        assert_eq!(summary.size(), 9);
    }

    #[test]
    fn the_checksum_does_not_depend_on_how_the_bytes_come() {
        let bytes: Vec<u8> = (0..=255).cycle().take(1000).collect();
        let mut whole = Summary::default();
        whole.write_all(&bytes).unwrap();
        for length in [1, 7, 16, 17, 33] {
            let mut parts = Summary::default();
            for part in bytes.chunks(length) {
                parts.write_all(part).unwrap();
            }
            assert_eq!(parts.checksum(), whole.checksum(), "{length}");
        }
    }
}
