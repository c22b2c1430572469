//! A panorama on a cylinder around `up`: longitude is linear across, and straight lines along `up`
//! stay straight.

use super::central::Central;
use super::equirectangular::radians;
use crate::geometry::{DVec2, DVec3, Domain, settings};

settings! {
    /// See [`Projection::Cylindrical`](super::Projection::Cylindrical). Rays start at the camera.
    pub struct Cylindrical {
        /// Degrees of longitude from the left edge to the right one. Default: 360.
        horizontal_fov: f64, Domain::UpTo(360.0), default 360.0;
        /// Degrees from the lower edge to the upper one. Default: 90.
        vertical_fov: f64, Domain::Between(0.0, 180.0), default 90.0;
    }
}

impl Cylindrical {
    /// The cylinder's height, with a radius of one.
    fn height(&self) -> f64 {
        2.0 * libm::tan(0.5 * radians(self.vertical_fov))
    }
}

impl Central for Cylindrical {
    fn direction(&self, [rows, columns]: [usize; 2], pixel: DVec2) -> Option<DVec3> {
        let longitude = radians(self.horizontal_fov) * (pixel.x / columns as f64 - 0.5);
        let (across, ahead) = libm::sincos(longitude);
        let down = self.height() * (pixel.y / rows as f64 - 0.5);
        Some(DVec3::new(across, down, ahead))
    }

    fn pixel(&self, [rows, columns]: [usize; 2], direction: DVec3) -> Option<DVec2> {
        let DVec3 { x, y, z } = direction;
        let longitude = libm::atan2(x, z);
        let down = y / libm::hypot(x, z);
        Some(DVec2::new(
            columns as f64 * (0.5 + longitude / radians(self.horizontal_fov)),
            rows as f64 * (0.5 + down / self.height()),
        ))
    }

    fn scaled(&self, _factors: [f64; 2]) -> Self {
        *self
    }
}
