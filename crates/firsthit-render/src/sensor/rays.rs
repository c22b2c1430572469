//! A table of rays.

use super::{Record, Sensor};
use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec2, DVec3, Digest, Ray, Rays, require, require_direction, unit};
use crate::image::SensorRecord;
use crate::memory;

/// A table of rays: one for every pixel, whatever computed them.
///
/// Directions have any length, in units of which `t` counts, as for arrays of rays; `range` is the
/// distance from the ray's own origin in scene units. A pixel whose direction is zero, or not
/// finite, has no ray: it is a miss, and the channel `valid` is false there. There is no `z` unless
/// an [aim](Self::aimed) is given.
///
/// ```
/// use firsthit::sensor::{RaySensor, Sensor};
/// use firsthit::{DVec3, Rays};
///
/// // A line scanner: three parallel rays from points one unit apart.
/// let origins = (0..3).map(|k| DVec3::new(f64::from(k), 0.0, 5.0)).collect();
/// let sensor = RaySensor::new(origins, vec![2.0 * DVec3::NEG_Z], [1, 3])?;
/// assert_eq!(sensor.ray(2).origin.x, 2.0);
/// assert_eq!(sensor.range_and_z(2, 1.5)[0], 3.0);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct RaySensor {
    /// One for all pixels, or one for each.
    origins: Vec<DVec3>,
    /// The directions: one for all pixels, or one for each.
    directions: Vec<DVec3>,
    shape: [usize; 2],
    aim: Option<DVec3>,
}

summary!(RaySensor, "RaySensor", |it| "shape": it.shape, "aim": it.aim);

impl RaySensor {
    /// The sensor of `[rows, columns]` whose rays have these origins and directions, row by row
    /// from the top: of each one for all pixels, or one for each.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for no pixels, and for another number of
    /// origins or directions.
    pub fn new(
        origins: Vec<DVec3>,
        directions: Vec<DVec3>,
        [rows, columns]: [usize; 2],
    ) -> Result<Self> {
        require("rows", "at least 1", rows >= 1, rows)?;
        require("columns", "at least 1", columns >= 1, columns)?;
        let pixels = rows.saturating_mul(columns);
        for (name, vectors) in [("origins", &origins), ("directions", &directions)] {
            let fits = vectors.len() == 1 || vectors.len() == pixels;
            require(name, "one, or one for each pixel", fits, vectors.len())?;
        }
        Ok(Self { origins, directions, shape: [rows, columns], aim: None })
    }

    /// The rays that a sensor has through its pixels' centres. They are those rays, bit for bit,
    /// whatever becomes of the sensor.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when memory is short.
    pub fn of(sensor: &dyn Sensor) -> Result<Self> {
        let count = sensor.len();
        let mut origins = memory::filled(count, DVec3::ZERO)?;
        let mut directions = memory::filled(count, DVec3::ZERO)?;
        for (pixel, (origin, direction)) in origins.iter_mut().zip(&mut directions).enumerate() {
            let ray = sensor.ray(pixel);
            (*origin, *direction) = (ray.origin, ray.direction);
        }
        Self::new(origins, directions, sensor.shape())
    }

    /// The sensor with a direction along which `z` is measured, from each ray's own origin.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for an `aim` that is zero or not finite.
    pub fn aimed(mut self, aim: DVec3) -> Result<Self> {
        self.aim = Some(unit(require_direction("aim", aim)?));
        Ok(self)
    }

    /// The origins of the rays: one for all pixels, or one for each.
    pub fn origins(&self) -> &[DVec3] {
        &self.origins
    }

    /// The directions of the rays: one for all pixels, or one for each.
    pub fn directions(&self) -> &[DVec3] {
        &self.directions
    }

    /// The direction along which `z` is measured, of length one.
    pub fn aim(&self) -> Option<DVec3> {
        self.aim
    }
}

/// The element of a pixel: its own, or the one for all.
fn of(vectors: &[DVec3], pixel: usize) -> DVec3 {
    vectors[if vectors.len() == 1 { 0 } else { pixel }]
}

impl Rays for RaySensor {
    fn len(&self) -> usize {
        self.shape[0].saturating_mul(self.shape[1])
    }

    fn ray(&self, index: usize) -> Ray {
        Ray::new(of(&self.origins, index), of(&self.directions, index))
    }
}

impl Sensor for RaySensor {
    fn shape(&self) -> [usize; 2] {
        self.shape
    }

    fn ray_within(&self, pixel: usize, _offset: DVec2) -> Ray {
        self.ray(pixel)
    }

    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2] {
        if t == f64::INFINITY {
            return [t; 2];
        }
        let along = t * of(&self.directions, pixel);
        let z = self.aim.map_or(f64::NAN, |aim| along.dot(aim));
        [along.length(), z]
    }

    fn has_aim(&self) -> bool {
        self.aim.is_some()
    }

    fn place(&self, pixel: usize) -> (DVec3, Option<DVec3>) {
        (of(&self.origins, pixel), self.aim)
    }

    fn record(&self) -> Record {
        let mut digest = Digest::default();
        for vectors in [&self.origins, &self.directions] {
            digest.count(vectors.len());
            for &vector in vectors {
                digest.vector(vector);
            }
        }
        let named = |aim: DVec3| ["aim_x", "aim_y", "aim_z"].into_iter().zip(aim.to_array());
        let parameters = self.aim.into_iter().flat_map(named);
        Record::Other(Box::new(SensorRecord {
            kind: "rays".to_owned(),
            rows: self.shape[0] as u64,
            columns: self.shape[1] as u64,
            digest: digest.name(),
            parameters: parameters.map(|(name, value)| (name.to_owned(), value)).collect(),
            ..SensorRecord::default()
        }))
    }
}
