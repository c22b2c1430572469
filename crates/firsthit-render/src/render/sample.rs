//! The rays of a sample: through one point of every pixel, from one point of the lens.

use crate::error::Result;
use crate::geometry::{DVec2, Ray, require};
use crate::sampling::{offset, on_lens};
use crate::sensor::Sensor;

/// The rays of one sample of a sensor. Those of the first are through the pixels' centres and from
/// the middle of the lens.
///
/// ```
/// use firsthit::render::Sample;
/// use firsthit::{Camera, DVec3, View};
///
/// let camera = Camera::new(View::default())?.thin_lens(0.1, 4.0)?;
/// assert_eq!(Sample::new(&camera, 0).ray(321), camera.ray(0, 321));
/// assert!(Sample::new(&camera, 1).ray(321).origin != camera.ray(0, 321).origin);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug)]
pub struct Sample<'a> {
    sensor: &'a dyn Sensor,
    /// The sensor at the point of the lens, unless that is the middle.
    moved: Option<Box<dyn Sensor>>,
    offset: DVec2,
}

impl<'a> Sample<'a> {
    /// The sample of a number, from 0 on.
    pub fn new(sensor: &'a dyn Sensor, number: u32) -> Self {
        let mut sample = Self { sensor, moved: None, offset: DVec2::ZERO };
        sample.go_to(number);
        sample
    }

    /// The ray of a pixel, pixels counted row by row from the top.
    pub fn ray(&self, pixel: usize) -> Ray {
        self.sensor().ray_within(pixel, self.offset)
    }

    pub(super) fn go_to(&mut self, number: u32) {
        self.offset = offset(number);
        // The middle of the lens is the sensor itself, bit for bit.
        self.moved = if number == 0 { None } else { self.sensor.through(on_lens(number)) };
    }

    /// The sensor that the rays come from.
    pub(super) fn sensor(&self) -> &dyn Sensor {
        self.moved.as_deref().unwrap_or(self.sensor)
    }

    /// The point of every pixel that they go through.
    pub(super) fn offset(&self) -> DVec2 {
        self.offset
    }
}

/// Fails for a number of samples that colours and mattes cannot have: none, and only the first, a
/// pinhole's, where the sensor has an aperture.
///
/// # Errors
///
/// [`Error::Argument`](crate::error::Error::Argument).
pub fn check_samples(sensor: &dyn Sensor, samples: u32) -> Result<()> {
    require("samples", "at least 1", samples > 0, samples)?;
    let expected = "at least 2 for colours and mattes of a camera with an aperture";
    let is_pinhole = samples == 1 && sensor.through(DVec2::ZERO).is_some();
    require("samples", expected, !is_pinhole, samples)
}
