//! The ends of a packet's rays as depths in float32.
//!
//! A parameter `t` becomes a depth by a product, and a difference with the depth that the start was
//! moved by, both in float64; then it is rounded to float32. [`Limits`] are that depth, less or plus
//! its error and that of the depth of a hit at `t`. So each errs on its safe side.
//!
//! # Error bounds
//!
//! - `DEPTH` times the reach, and three blurs: what `filter.rs` computes for the depth of a hit.
//! - `ROUNDED_DEPTH` times the depth itself: its rounding to float32, and that of its sum with the
//!   error.

use super::packet::{Packet, RAYS, of};
use super::prepare::both;
use crate::accel::bounds::{BLURS, DEPTH, ROUNDED_DEPTH};
use crate::simd::Lanes;

/// The depths of a ray's `t_min` and `t_max`: a lower and an upper bound of each.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "the names of what they bound")]
pub(crate) struct Limits {
    /// A candidate that ends before this is before `t_min`, for certain.
    pub(in crate::accel) t_min_low: f32,
    /// A candidate that begins beyond this is beyond `t_min`, for certain.
    pub(in crate::accel) t_min_high: f32,
    /// A candidate that ends before this is within `t_max`, for certain.
    pub(in crate::accel) t_max_low: f32,
    /// A candidate that begins beyond this is beyond `t_max`, for certain.
    pub(in crate::accel) t_max_high: f32,
}

impl Limits {
    /// Whether depths up to `high` are before `t_min`, for certain.
    #[inline(always)]
    pub(in crate::accel) fn begin_after(&self, high: f32) -> bool {
        high < self.t_min_low
    }

    /// Whether depths from `low` on are beyond `t_min`, for certain.
    #[inline(always)]
    pub(in crate::accel) fn begin_before(&self, low: f32) -> bool {
        low > self.t_min_high
    }

    /// Whether the depths from `low` to `high` are between `t_min` and `t_max`, for certain.
    #[inline(always)]
    pub(in crate::accel) fn hold(&self, low: f32, high: f32) -> bool {
        self.begin_before(low) && high < self.t_max_low
    }
}

impl Packet {
    /// Computes the bounds on the depths of `t_min` and `t_max`, with the reach and the blur.
    #[inline(always)]
    pub(super) fn set_limits<L: Lanes>(
        &mut self,
        l: L,
        has_second: bool,
        (reach, blur): (L::Floats, L::Floats),
    ) {
        let error = l.mul_add(reach, l.splat(DEPTH), l.mul(blur, l.splat(BLURS)));
        l.store(error, &mut self.depth_error);
        // The depth at a parameter, less its error and plus its error.
        macro_rules! ends {
            ($t:ident) => {{
                let [first, second] = both!(l, has_second, half => {
                    let t = l.load64(of(&self.$t, half));
                    let depth = l.mul64(t, l.load64(of(&self.depth_per_t, half)));
                    l.sub64(depth, l.load64(of(&self.moved, half)))
                });
                // Infinity less a part of infinity is NaN.
                let depth = l.min(l.narrow(first, second), l.splat(f32::MAX));
                let slack = l.mul_add(l.abs(depth), l.splat(ROUNDED_DEPTH), error);
                (l.sub(depth, slack), l.add(depth, slack))
            }};
        }
        let (t_max_low, t_max_high) = ends!(t_max);
        l.store(t_max_high, &mut self.t_max_high);
        l.store(t_max_low, &mut self.t_max_low);
        let zero = l.splat(0.0);
        let (mut t_min_low, mut t_min_high) = (zero, zero);
        let mut begins = [0; 2];
        for (half, begins) in begins.iter_mut().enumerate() {
            *begins = l.lt64(l.splat64(0.0), l.load64(of(&self.t_min, half)));
        }
        let begins = u16::from_le_bytes(begins);
        if begins != 0 {
            let (less, more) = ends!(t_min);
            // Wherever the start was moved, what is ahead of it is ahead of the origin. A NaN makes
            // nothing certain.
            t_min_low = l.select(begins, l.max(less, zero), zero);
            t_min_high = l.select(begins, l.max(zero, more), zero);
        }
        l.store(t_min_low, &mut self.t_min_low);
        l.store(t_min_high, &mut self.t_min_high);
    }

    /// The limits of a ray.
    #[inline(always)]
    pub(in crate::accel) fn limits(&self, lane: usize) -> Limits {
        let lane = lane % RAYS;
        Limits {
            t_min_low: self.t_min_low[lane],
            t_min_high: self.t_min_high[lane],
            t_max_low: self.t_max_low[lane],
            t_max_high: self.t_max_high[lane],
        }
    }

    /// A depth at or beyond that of `t`, and of any hit at `t` as the filter computes it.
    #[inline(always)]
    pub(in crate::accel) fn depth_above(&self, lane: usize, t: f64) -> f32 {
        let depth = self.depth(lane, t);
        depth + depth.abs() * ROUNDED_DEPTH + self.depth_error[lane % RAYS]
    }

    /// A depth at or before that of `t`, and of any hit there. `t` is finite.
    #[inline(always)]
    pub(in crate::accel) fn depth_below(&self, lane: usize, t: f64) -> f32 {
        let depth = self.depth(lane, t);
        depth - depth.abs() * ROUNDED_DEPTH - self.depth_error[lane % RAYS]
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the rounding is allowed for")]
    fn depth(&self, lane: usize, t: f64) -> f32 {
        (t * self.depth_per_t[lane % RAYS] - self.moved[lane % RAYS]) as f32
    }
}
