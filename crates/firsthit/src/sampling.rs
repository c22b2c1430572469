//! Points within a pixel.

use crate::geometry::{DVec2, PixelGrid};

/// The point of every pixel that its ray `sample` goes through, each coordinate from 0 up to 1. The first is the centre.
///
/// It is the same for all pixels, so that each sample of a picture is a grid of rays; samples are added up as in Haeberli and
/// Akeley, "The Accumulation Buffer", SIGGRAPH 1990. The points are the (0,2)-sequence of Sobol', scrambled (Kollig and Keller,
/// "Efficient Multidimensional Sampling", Computer Graphics Forum 21(3), 2002): of 2^m of them each rectangle of 1 / 2^m of the
/// pixel with sides 1 / 2^k has one, and none depends on how many there will be. It departs in the first point, which would be at
/// two thirds of the sides.
pub(crate) fn offset(sample: u32) -> DVec2 {
    /// Two thirds in binary: so that of 2^m points each is a third or two thirds into its interval, and their mean is the middle,
    /// nearly.
    const SCRAMBLE: u32 = 0xaaaa_aaaa;
    if sample == 0 {
        return PixelGrid::CENTRE;
    }
    let coordinate = |bits: u32| f64::from(bits ^ SCRAMBLE) / 4_294_967_296.0;
    DVec2::new(coordinate(sample.reverse_bits()), coordinate(sobol(sample)))
}

/// The second dimension of Sobol's sequence, in units of 2^-32.
fn sobol(mut index: u32) -> u32 {
    let (mut direction, mut bits) = (1_u32 << 31, 0);
    while index != 0 {
        if index & 1 == 1 {
            bits ^= direction;
        }
        index >>= 1;
        direction ^= direction >> 1;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_point_is_the_centre() {
        assert_eq!(offset(0), DVec2::splat(0.5));
    }

    /// Of 2^m points, all but the first, each rectangle has one, and one rectangle of each shape has none.
    #[test]
    fn rectangles_have_a_point_each() {
        for m in 1..10_u32 {
            for across in 0..=m {
                let sides = [across, m - across].map(|k| f64::from(1_u32 << k));
                let cell = |k| (offset(k) * DVec2::from(sides)).floor().to_array();
                let mut cells: Vec<[f64; 2]> = (1..1 << m).map(cell).collect();
                cells.sort_by(|a, b| a.partial_cmp(b).unwrap());
                let count = cells.len();
                cells.dedup();
                assert_eq!(cells.len(), count, "{m} {across}");
            }
        }
    }

    #[test]
    fn the_mean_is_the_middle_nearly() {
        for count in [4_u32, 16, 64, 256] {
            let mean = (0..count).map(offset).sum::<DVec2>() / f64::from(count);
            assert!(
                (mean - 0.5).abs().max_element() < 0.35 / f64::from(count),
                "{mean}"
            );
        }
    }
}
