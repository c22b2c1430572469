//! Rays, hits, boxes, transforms, colours and how they are shown. Imports `error` and `parallel`
//! alone of this crate; glam is the vector maths.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

#[doc(hidden)]
pub mod arithmetic;
#[doc(hidden)]
pub mod arrays;
mod beam;
mod bounds;
mod color;
mod color_map;
mod color_names;
mod digest;
mod display_transform;
#[doc(hidden)]
pub mod double;
#[doc(hidden)]
pub mod exact;
#[doc(hidden)]
pub mod exact_sum;
#[doc(hidden)]
pub mod fused;
mod grid;
mod hit;
mod named;
#[doc(hidden)]
pub mod orientation;
mod ray;
mod ray_filter;
mod require;
mod rotation;
#[doc(hidden)]
pub mod rows;
mod settings;
#[doc(hidden)]
pub mod summary;
mod tone_map;
mod transform;

pub use bounds::Bounds;
pub use color::{Color, luminance, srgb_decode, srgb_encode};
pub use color_map::ColorMap;
pub use color_names::{COLOR_NAMES, color_of, meant_as_levels};
pub use digest::Digest;
pub use display_transform::DisplayTransform;
pub use grid::PixelGrid;
pub use hit::Hit;
pub use ray::{Filtered, Ray, Rays};
pub use ray_filter::{Departure, RayFilter, Side, SurfaceId};
pub use rotation::rotation;
pub use settings::{Domain, Field, Setting, Settings, SettingsSchema, Value};
pub use tone_map::ToneMap;
pub use transform::Transform;
#[doc(hidden)]
pub use {
    beam::Beam,
    color::srgb_decode_level,
    color_map::fraction,
    named::{named, names, none_of},
    require::{require, require_direction, require_finite, require_positive},
    rotation::upright,
    settings::{kinds, setting_list, settings},
};

use std::cmp::Ordering;

pub use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};

/// `v` at length one, or NaN for the zero vector. Any length from the smallest float64 to the
/// largest will do.
#[inline(always)]
pub fn unit(v: DVec3) -> DVec3 {
    let v = moderation(v) * v;
    v / v.length()
}

/// The factor that brings `v` to a length whose square is in the range of float64: a power of two,
/// which scales without rounding, and 1 for all but extreme lengths.
#[inline(always)]
#[doc(hidden)]
pub fn moderation(v: DVec3) -> f64 {
    const TWO_TO_600: f64 = f64::from_bits((1023 + 600) << 52);
    let largest = v.abs().max_element();
    if largest > 1e100 {
        1.0 / TWO_TO_600
    } else if largest < 1e-100 {
        TWO_TO_600
    } else {
        1.0
    }
}

/// The largest distance of a surface's point from it by rounding, as a share of the largest
/// coordinate: 2^-40, some hundred times what transforms and positions round. A surface that
/// touches the one that is left may seem to be ahead of it or behind: from an object of another
/// transform, only surfaces farther away are met. A surface nearer to an end of a line of sight is
/// at that end.
#[doc(hidden)]
pub const ROUNDED: f64 = 4096.0 * f64::EPSILON;

/// The share of a line of sight that counts as its end, by [`ROUNDED`].
#[doc(hidden)]
pub fn share_at_end(from: DVec3, to: DVec3) -> f64 {
    let largest = from.abs().max(to.abs()).max_element();
    ROUNDED * largest / (to - from).abs().max_element()
}

/// Whether a colour adds or takes light away: whether it is finite and not black.
#[inline]
#[doc(hidden)]
pub fn is_light(color: Color) -> bool {
    color.is_finite() && color != Color::ZERO
}

/// The order of points by x, then y, then z, in which zeros of both signs are one.
#[doc(hidden)]
pub fn compare_points(a: DVec3, b: DVec3) -> Ordering {
    // Adding zero makes negative zeros positive.
    let (a, b) = (a + DVec3::ZERO, b + DVec3::ZERO);
    let by_axis = |axis: usize| a[axis].total_cmp(&b[axis]);
    by_axis(0).then_with(|| by_axis(1)).then_with(|| by_axis(2))
}

/// The nearest float32.
#[expect(clippy::cast_possible_truncation, reason = "it rounds")]
#[inline]
#[doc(hidden)]
pub fn single(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_has_length_one_at_every_scale() {
        for scale in [1e-300, 1e-160, 1e-10, 1.0, 1e10, 1e160, 1e307] {
            let v = unit(DVec3::new(3.0, -4.0, 12.0) * scale);
            assert!((v.length() - 1.0).abs() < 4.0 * f64::EPSILON, "{scale}");
            assert!((v - DVec3::new(3.0, -4.0, 12.0) / 13.0).length() < 1e-15, "{scale}");
        }
        assert!(unit(DVec3::ZERO).is_nan());
    }
}
