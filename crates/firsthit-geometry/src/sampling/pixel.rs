//! Points within a pixel, and on a lens.

use super::{sobol, warp};
use crate::geometry::{DVec2, PixelGrid};

/// The point of every pixel that its ray `sample` goes through, each coordinate from 0 up to 1. The
/// first is the centre.
///
/// It is the same for all pixels, so that each sample of a picture is a grid of rays; samples are
/// added up as in Haeberli and Akeley, "The Accumulation Buffer", SIGGRAPH 1990. The points are the
/// (0,2)-sequence of Sobol', scrambled (Kollig and Keller, "Efficient Multidimensional Sampling",
/// Computer Graphics Forum 21(3), 2002): of 2^m of them each rectangle of 1 / 2^m of the pixel with
/// sides 1 / 2^k has one, and none depends on how many there will be. It departs in the first
/// point, which would be at two thirds of the sides.
#[doc(hidden)]
pub fn offset(sample: u32) -> DVec2 {
    if sample == 0 {
        return PixelGrid::CENTRE;
    }
    let second = combined(sample, &sobol::SECOND);
    DVec2::new(scrambled(sample.reverse_bits()), scrambled(second))
}

/// The point of the lens that the rays of a sample come from, in the disc of radius one. The first
/// is the middle.
///
/// These are two more dimensions of Sobol's sequence, scrambled as those of [`offset`], so that the
/// points of the pixel and of the lens are well distributed together. Their direction numbers are
/// chosen for that: of 2, 4, 8, 16 and 32 points each rectangle of the square of that share of its
/// area has one. The square becomes the disc by [`warp::disc`].
///
/// The sequence departs in its first point, as `offset` does. Distances and identifiers are those
/// of the first sample, so it is a pinhole's; the mean over n samples counts it once.
#[doc(hidden)]
pub fn on_lens(sample: u32) -> DVec2 {
    if sample == 0 {
        return DVec2::ZERO;
    }
    let square = DIRECTIONS.map(|directions| scrambled(combined(sample, &directions)));
    warp::disc(DVec2::from(square))
}

/// A coordinate from its bits, in units of 2^-32.
fn scrambled(bits: u32) -> f64 {
    /// Two thirds in binary: so that of 2^m points each is a third or two thirds into its interval,
    /// and their mean is the middle, nearly.
    const SCRAMBLE: u32 = 0xaaaa_aaaa;
    f64::from(bits ^ SCRAMBLE) / 4_294_967_296.0
}

/// The direction numbers of the lens' two dimensions.
const DIRECTIONS: [[u32; 32]; 2] = [
    // x^3 + x + 1.
    sobol::directions(3, 0b01, [1, 1, 5]),
    // x^3 + x^2 + 1.
    sobol::directions(3, 0b10, [1, 3, 1]),
];

/// The sum of the direction numbers of an index' bits.
fn combined(index: u32, directions: &[u32; 32]) -> u32 {
    let bits = directions.iter().enumerate();
    let taken = bits.filter(|&(k, _)| index >> k & 1 == 1);
    taken.fold(0, |sum, (_, direction)| sum ^ direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_point_is_the_centre() {
        assert_eq!(offset(0), DVec2::splat(0.5));
    }

    /// The points, 2^m but for the first, are one in each rectangle, and one rectangle of each
    /// shape has none.
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

    /// The test leaves out both departures of `on_lens`: with them one rectangle of each shape has
    /// none.
    #[test]
    fn rectangles_of_the_lens_have_a_point_each_up_to_32() {
        let square = |k: u32| DVec2::from(DIRECTIONS.map(|each| scrambled(combined(k, &each))));
        for m in 1..=5_u32 {
            for across in 0..=m {
                let sides = [across, m - across].map(|k| f64::from(1_u32 << k));
                let cell = |k| (square(k) * DVec2::from(sides)).floor().to_array();
                let mut cells: Vec<[f64; 2]> = (0..1 << m).map(cell).collect();
                cells.sort_by(|a, b| a.partial_cmp(b).unwrap());
                cells.dedup();
                assert_eq!(cells.len(), 1 << m, "{m} {across}");
            }
        }
    }

    /// A star in the square of a pixel has its own share of points of the lens: each quarter of a
    /// pixel's samples is spread over the lens, and the other way round.
    #[test]
    fn points_of_the_pixel_and_of_the_lens_do_not_depend_on_each_other() {
        let quarter = |point: DVec2, middle: f64| {
            usize::from(point.x >= middle) + 2 * usize::from(point.y >= middle)
        };
        let mut counts = [[0; 4]; 4];
        for k in 1..256 {
            counts[quarter(offset(k), 0.5)][quarter(on_lens(k), 0.0)] += 1;
        }
        // 16 in each, but for the first sample, which is left out.
        for count in counts.as_flattened() {
            assert!((15..=16).contains(count), "{counts:?}");
        }
    }

    /// The mean of x^2 and of y^2 over a disc of radius one is 1/4.
    #[test]
    fn points_of_the_lens_fill_the_disc_evenly() {
        assert_eq!(on_lens(0), DVec2::ZERO);
        for count in [64_u32, 256, 1024] {
            let points: Vec<DVec2> = (1..count).map(on_lens).collect();
            assert!(points.iter().all(|point| point.length() < 1.0));
            let mean = |of: &dyn Fn(DVec2) -> f64| {
                points.iter().map(|&point| of(point)).sum::<f64>() / f64::from(count - 1)
            };
            let close = 2.0 / f64::from(count);
            assert!(mean(&|point| point.x).abs() < close, "{count}");
            assert!(mean(&|point| point.y).abs() < close, "{count}");
            assert!((mean(&|point| point.x * point.x) - 0.25).abs() < close);
            assert!((mean(&|point| point.y * point.y) - 0.25).abs() < close);
            assert!(mean(&|point| point.x * point.y).abs() < close);
        }
    }

    #[test]
    fn the_mean_is_the_middle_nearly() {
        for count in [4_u32, 16, 64, 256] {
            let mean = (0..count).map(offset).sum::<DVec2>() / f64::from(count);
            assert!((mean - 0.5).abs().max_element() < 0.35 / f64::from(count), "{mean}");
        }
    }
}
