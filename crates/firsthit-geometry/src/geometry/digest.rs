use std::fmt::Write;

use super::DVec3;

/// Makes a fingerprint of numbers: the same on every machine, because their bytes are
/// little-endian.
///
/// Each addition has to say where it ends: add a [`count`](Self::count) before what may have any
/// length.
#[derive(Debug, Clone, Default)]
pub struct Digest(blake3::Hasher);

impl Digest {
    /// The number of BLAKE3's 32 bytes that a [name](Self::name) shows: no two scenes will share
    /// them by chance.
    const SHOWN: usize = 16;

    /// Adds a word, such as the name of a kind.
    pub fn word(&mut self, word: &str) {
        self.count(word.len());
        self.0.update(word.as_bytes());
    }

    /// Adds how many there are of what follows.
    pub fn count(&mut self, count: usize) {
        self.0.update(&(count as u64).to_le_bytes());
    }

    /// Adds numbers, as they are to the bit.
    pub fn numbers(&mut self, numbers: &[f64]) {
        if cfg!(target_endian = "little") {
            // All at once: eight blocks of 1024 bytes go side by side.
            self.0.update(bytemuck::cast_slice(numbers));
            return;
        }
        let mut bytes = [0; 8 * 512];
        for numbers in numbers.chunks(512) {
            for (place, number) in bytes.chunks_exact_mut(8).zip(numbers) {
                place.copy_from_slice(&number.to_le_bytes());
            }
            self.0.update(&bytes[..8 * numbers.len()]);
        }
    }

    /// Adds a point, a direction or a colour.
    pub fn vector(&mut self, vector: DVec3) {
        let mut bytes = [0; 24];
        for (place, number) in bytes.chunks_exact_mut(8).zip(vector.to_array()) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        self.0.update(&bytes);
    }

    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// The digest of all that was added.
    pub fn finish(&self) -> [u8; 32] {
        *self.0.finalize().as_bytes()
    }

    /// The digest of all that was added, as text: `blake3:` and its first half.
    pub fn name(&self) -> String {
        let mut name = String::from("blake3:");
        for byte in &self.finish()[..Self::SHOWN] {
            let _ = write!(name, "{byte:02x}");
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_blake3_of_the_bytes() {
        // The first input of BLAKE3's own test vectors.
        let name = "blake3:af1349b9f5f9a1a6a0404dea36dcc949";
        assert_eq!(Digest::default().name(), name);
        let (mut number, mut bytes) = (Digest::default(), Digest::default());
        number.numbers(&[1.5]);
        bytes.bytes(&[0, 0, 0, 0, 0, 0, 0xf8, 0x3f]);
        assert_eq!(number.finish(), bytes.finish());
    }
}
