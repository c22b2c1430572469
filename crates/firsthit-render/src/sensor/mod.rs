//! Sensors make frames: rays in rows and columns, with distances of their own and a record for
//! files. A file per sensor.

mod camera;
mod lidar;
mod moving;
mod pushbroom;
mod rays;
mod rolling_shutter;

pub use camera::{camera_of, camera_record};
pub use lidar::{Lidar, LidarModel, Lissajous, Pattern, Raster, Return, Rosette, Spinning, Turn};
pub use pushbroom::Pushbroom;
pub use rays::RaySensor;
pub use rolling_shutter::{Readout, RollingShutter};

use std::fmt::Debug;

use crate::camera::Camera;
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray, Rays};
use crate::image::{CameraRecord, SensorRecord};

/// A ray for every pixel, row by row from the top, and for every point of a pixel. A [`Camera`] is
/// one.
pub trait Sensor: Rays + Debug {
    /// Rows and columns.
    fn shape(&self) -> [usize; 2];

    /// The ray through a point of a pixel, pixels counted row by row from the top. `offset` runs
    /// from 0 to 1 rightwards and upwards; [`Rays::ray`] is the one at (0.5, 0.5). A sensor whose
    /// pixels are single rays has the same one for all offsets.
    fn ray_within(&self, pixel: usize, offset: DVec2) -> Ray;

    /// Fills `rays` with those through a point of pixels that lie in one row, from `first` on: what
    /// [`ray_within`](Self::ray_within) gives, sooner than one by one.
    fn row_within(&self, first: usize, offset: DVec2, rays: &mut [Ray]) {
        for (pixel, ray) in (first..).zip(rays) {
            *ray = self.ray_within(pixel, offset);
        }
    }

    /// Fills the slices with x, y and z of the directions of such rays.
    fn directions_within(&self, first: usize, offset: DVec2, [x, y, z]: [&mut [f64]; 3]) {
        for (pixel, ((x, y), z)) in (first..).zip(x.iter_mut().zip(y).zip(z)) {
            (*x, *y, *z) = self.ray_within(pixel, offset).direction.into();
        }
    }

    /// The grid of the rays of [`ray_within`](Self::ray_within) for one offset, as [`Rays::grid`]
    /// says.
    fn grid_within(&self, _offset: DVec2) -> Option<PixelGrid> {
        None
    }

    /// The sensor at a point of its lens, in units of the lens' radius, to the right and upwards:
    /// what the rays of a sample come from. `None` where it has no aperture.
    fn through(&self, _point: DVec2) -> Option<Box<dyn Sensor>> {
        None
    }

    /// The distance from the sensor along the ray, and that along its aim, of what the ray through
    /// a pixel's centre meets at its parameter `t`. Where the sensor moves, both are those from
    /// where it is at the time of the ray. Both are infinite for a miss.
    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2];

    /// Whether it has an aim, along which a `z` is measured.
    fn has_aim(&self) -> bool {
        true
    }

    /// The sensor's position at the time of a pixel's ray, and its aim then, if it has one.
    fn place(&self, pixel: usize) -> (DVec3, Option<DVec3>);

    /// The time of a pixel's ray in seconds, where the sensor knows of time.
    fn time(&self, _pixel: usize) -> Option<f64> {
        None
    }

    /// The camera that it is, or that it is in the middle of its picture.
    fn camera(&self) -> Option<&Camera> {
        None
    }

    /// The record of the sensor in files.
    fn record(&self) -> Record;
}

/// The record of a sensor in files.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// A camera.
    Camera(Box<CameraRecord>),
    /// Any other sensor.
    Other(Box<SensorRecord>),
}
