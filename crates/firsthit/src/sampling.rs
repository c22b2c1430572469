//! Points within a pixel: stratified, and a function of their numbers alone.

use crate::geometry::DVec2;

/// Point `k` of the `count` in a pixel, each coordinate from 0 up to 1.
///
/// The pixel is cut into `count` cells of one size, in about the square root of `count` strips, and each
/// cell has its point at a place that depends on (pixel, k): the picture is the same for any order in
/// which the points are taken. (Stratified sampling: Cook, "Stochastic Sampling in Computer Graphics",
/// ACM Transactions on Graphics 5(1), 1986.) The only point of a pixel is its centre.
pub(crate) fn offset(pixel: u64, k: u32, count: u32) -> DVec2 {
    if count == 1 {
        return DVec2::splat(0.5);
    }
    // The strips when the points are dealt out as evenly as whole numbers go.
    let (k64, strips, all) = (u64::from(k), u64::from(count.isqrt()), u64::from(count));
    let strip = k64 * strips / all;
    let (start, end) = (
        (strip * all).div_ceil(strips),
        ((strip + 1) * all).div_ceil(strips),
    );
    let (first, cells) = (start as f64, (end - start) as f64);
    let x = (f64::from(k) - first + random(pixel, k, 0)) / cells;
    // Strips are as high as they have cells, so all cells have one size.
    let y = (first + cells * random(pixel, k, 1)) / f64::from(count);
    DVec2::new(x, y)
}

/// A number from 0 up to 1, by the mixing function of Steele, Lea and Flood, "Fast Splittable Pseudorandom
/// Number Generators", OOPSLA 2014.
fn random(pixel: u64, k: u32, dimension: u64) -> f64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let mix = |z: u64| {
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let seed = mix(pixel.wrapping_add(GOLDEN))
        .wrapping_add((2 * u64::from(k) + dimension).wrapping_mul(GOLDEN));
    (mix(seed.wrapping_add(GOLDEN)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_has_one_point_and_all_cells_have_one_size() {
        for count in [2_u32, 3, 4, 5, 7, 8, 9, 16, 17, 64] {
            let strips = count.isqrt();
            let points: Vec<DVec2> = (0..count).map(|k| offset(77, k, count)).collect();
            // The strips, by another rule: as many points as the ceiling of k * count / strips says.
            for strip in 0..strips {
                let edge = |strip: u32| (strip * count).div_ceil(strips);
                let (start, end) = (edge(strip), edge(strip + 1));
                for k in start..end {
                    let p = points[k as usize] * f64::from(count);
                    assert!(
                        p.y >= f64::from(start) && p.y < f64::from(end),
                        "{count} {k} {p}"
                    );
                    let x = points[k as usize].x * f64::from(end - start);
                    assert_eq!(x.floor(), f64::from(k - start), "{count} {k}");
                }
            }
        }
    }

    #[test]
    fn the_only_point_is_the_centre() {
        assert_eq!(offset(3, 0, 1), DVec2::splat(0.5));
    }

    #[test]
    fn pixels_have_different_points() {
        assert_ne!(offset(1, 0, 4), offset(2, 0, 4));
        assert_ne!(offset(1, 0, 4), offset(1, 1, 4));
    }
}
