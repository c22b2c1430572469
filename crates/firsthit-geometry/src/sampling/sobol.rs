//! The sequence of Sobol': the direction numbers of its dimensions.

/// The direction numbers of a dimension, in units of 2^-32, from a primitive polynomial over two
/// elements and the first `degree` numbers: the recurrence of Bratley and Fox, "Algorithm 659", ACM
/// Transactions on Mathematical Software 14(1), 1988. `inner` has the polynomial's coefficients
/// between the first and the last, that of the highest power first.
pub(super) const fn directions(degree: usize, inner: u32, first: [u32; 3]) -> [u32; 32] {
    let mut numbers = [0_u32; 32];
    let mut k = 0;
    while k < 32 {
        numbers[k] = if k < degree {
            first[k] << (31 - k)
        } else {
            let mut number = numbers[k - degree] ^ (numbers[k - degree] >> degree);
            let mut j = 1;
            while j < degree {
                if inner >> (degree - 1 - j) & 1 == 1 {
                    number ^= numbers[k - j];
                }
                j += 1;
            }
            number
        };
        k += 1;
    }
    numbers
}

/// The polynomial x + 1, of the second dimension. The first is the index with its bits reversed.
pub(super) const SECOND: [u32; 32] = directions(1, 0, [1, 0, 0]);

#[cfg(test)]
mod tests {
    use super::*;

    /// Row k of the triangle has an odd number in place j where all bits of j are bits of k
    /// (Lucas).
    #[test]
    fn the_second_dimension_is_pascal_s_triangle_even_or_odd() {
        for (k, number) in (0_u32..).zip(SECOND) {
            let odd = (0..=k).filter(|j| j & k == *j);
            let row = odd.fold(0_u32, |row, j| row | 1 << (31 - j));
            assert_eq!(number, row, "{k}");
        }
    }
}
