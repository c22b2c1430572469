//! Masks: a bit for each lane.

/// The lanes whose bits are set, the lowest first.
#[inline(always)]
pub fn set_bits(mask: u16) -> SetBits {
    SetBits(mask)
}

/// See [`set_bits`].
pub struct SetBits(u16);

impl Iterator for SetBits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        // The remainder is the number itself; it spares the caller a bounds check.
        let lane = self.0.trailing_zeros() as usize % super::LANES;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_bits_are_the_lanes_of_a_mask() {
        assert_eq!(set_bits(0).next(), None);
        let lanes: Vec<usize> = set_bits(0b1000_0000_0001_0110).collect();
        assert_eq!(lanes, [1, 2, 4, 15]);
        assert_eq!(set_bits(u16::MAX).count(), 16);
    }
}
