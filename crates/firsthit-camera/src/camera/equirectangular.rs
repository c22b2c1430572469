//! A panorama in which longitude and latitude are linear in the picture.
//!
//! The middle of the picture is the aim. Longitude grows to the right, latitude upwards. The whole
//! sphere has 360 by 180 degrees.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it is compiled for the kernel's instruction set"
)]

use std::f64::consts::TAU;

use super::central::Central;
use super::quick::{Known, Pair, sincos};
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{DVec2, DVec3, Domain, settings};

settings! {
    /// See [`Projection::Equirectangular`](super::Projection::Equirectangular). Rays start at the
    /// camera.
    pub struct Equirectangular {
        /// Degrees of longitude from the left edge to the right one. Default: 360.
        horizontal_fov: f64, Domain::UpTo(360.0), default 360.0;
        /// Degrees of latitude from the lower edge to the upper one. Default: 180.
        vertical_fov: f64, Domain::UpTo(180.0), default 180.0;
    }
}

/// An angle in degrees as radians: 360 are [`TAU`] to the last digit.
pub(super) fn radians(degrees: f64) -> f64 {
    TAU * (degrees / 360.0)
}

impl Central for Equirectangular {
    const IS_UNIT: bool = true;

    fn direction(&self, size: [usize; 2], pixel: DVec2) -> Option<DVec3> {
        let (direction, _) = self.directions(Scalar, size, pixel.to_array());
        Some(direction.into())
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(
        &self,
        of: A,
        [rows, columns]: [usize; 2],
        [u, v]: Pair<A>,
    ) -> Known<A, 3> {
        let longitude = of.sub(of.div(u, of.number(columns as f64)), of.number(0.5));
        let longitude = of.mul(of.number(radians(self.horizontal_fov)), longitude);
        let latitude = of.sub(of.div(v, of.number(rows as f64)), of.number(0.5));
        let latitude = of.mul(of.number(radians(self.vertical_fov)), latitude);
        let [across, ahead] = sincos(of, longitude);
        let [below, level] = sincos(of, latitude);
        let direction = [of.mul(level, across), below, of.mul(level, ahead)];
        (direction, of.lt(of.number(0.0), of.number(1.0)))
    }

    fn pixel(&self, [rows, columns]: [usize; 2], direction: DVec3) -> Option<DVec2> {
        let DVec3 { x, y, z } = direction;
        let longitude = libm::atan2(x, z);
        let latitude = libm::atan2(-y, libm::hypot(x, z));
        Some(DVec2::new(
            columns as f64 * (0.5 + longitude / radians(self.horizontal_fov)),
            rows as f64 * (0.5 - latitude / radians(self.vertical_fov)),
        ))
    }

    fn scaled(&self, _factors: [f64; 2]) -> Self {
        *self
    }
}
