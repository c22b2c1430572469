//! A panorama of the whole sphere, where longitude and latitude are linear in the picture.
//!
//! The middle of the picture is the aim. Longitude runs from -180 degrees at the left edge to 180 at the right one, latitude
//! from 90 degrees at the top, which is upwards, to -90 at the bottom.

use std::f64::consts::PI;

use super::lens::{Model, Reach};
use super::pose::Pose;
use crate::geometry::{DVec2, PixelGrid, Ray, unit};

/// See [`Projection::Equirectangular`](super::Projection::Equirectangular). Rays start at the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Equirectangular {}

impl Model for Equirectangular {
    fn ray(
        &self,
        pose: &Pose,
        [rows, columns]: [usize; 2],
        [row, column]: [usize; 2],
        offset: DVec2,
    ) -> Ray {
        let longitude = 2.0 * PI * ((column as f64 + offset.x) / columns as f64 - 0.5);
        // Offsets run upwards, rows downwards.
        let latitude = PI * (0.5 - (row as f64 + (1.0 - offset.y)) / rows as f64);
        let (across, ahead) = libm::sincos(longitude);
        let (above, level) = libm::sincos(latitude);
        let direction = level * (ahead * pose.aim + across * pose.right) + above * pose.upwards;
        Ray::new(pose.position, unit(direction))
    }

    fn reach(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2]) -> Reach {
        let ray = self.ray(pose, size, pixel, PixelGrid::CENTRE);
        Reach {
            offset: 0.0,
            cosine: ray.direction.dot(pose.aim),
        }
    }
}
