//! Lenses through which all rays start at the camera's position: a direction for each point of the picture.

use super::lens::{Model, Reach};
use super::parameters::Parameters;
use super::pose::Pose;
use crate::error::Result;
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray, unit};

/// What every such lens can do. Directions are in the camera's coordinates x to the right, y down, z ahead, as in OpenCV; pixel
/// coordinates are counted from the picture's upper left corner, to the right and down. `size` is rows and columns.
pub(super) trait Central: Parameters + Send + Sync {
    /// Checks its numbers for a picture of a size, and computes what depends on them alone.
    fn prepare(&mut self, size: [usize; 2]) -> Result<()>;
    /// The direction that is seen at a point of the picture, of any length; `None` where nothing is.
    fn direction(&self, size: [usize; 2], pixel: DVec2) -> Option<DVec3>;
    /// Where in the picture a direction is seen, be it beyond its edges; `None` for nowhere.
    fn pixel(&self, size: [usize; 2], direction: DVec3) -> Option<DVec2>;
    /// The lens of a part of the picture from a row and a column on, where there is one.
    fn cropped(&self, _first: [usize; 2]) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }
    /// The lens of the same picture with so many times the rows and columns.
    fn scaled(&self, factors: [f64; 2]) -> Self
    where
        Self: Sized;
}

impl<C: Central> Model for C {
    fn prepare(&mut self, size: [usize; 2]) -> Result<()> {
        Central::prepare(self, size)
    }

    fn ray(&self, pose: &Pose, size: [usize; 2], [row, column]: [usize; 2], offset: DVec2) -> Ray {
        // Offsets run upwards, rows downwards.
        let pixel = DVec2::new(column as f64 + offset.x, row as f64 + (1.0 - offset.y));
        let direction = self.direction(size, pixel).map(|direction| {
            let DVec3 { x, y, z } = direction;
            unit(x * pose.right - y * pose.upwards + z * pose.aim)
        });
        Ray::new(pose.position, direction.unwrap_or(DVec3::NAN))
    }

    fn project(&self, size: [usize; 2], point: DVec3) -> Option<DVec2> {
        let pixel = self.pixel(size, point)?;
        pixel.is_finite().then_some(pixel)
    }

    fn reach(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2]) -> Reach {
        let ray = self.ray(pose, size, pixel, PixelGrid::CENTRE);
        Reach {
            offset: 0.0,
            cosine: ray.direction.dot(pose.aim),
        }
    }
}
