//! A camera that does not see what is in front of a plane.

use firsthit::geometry::{DVec2, DVec3, Ray, Rays};
use firsthit::sensor::{Record, Sensor};
use firsthit::{Camera, Error, Result};

use crate::look::Cut;

/// An upper bound on the rounding of a crossing, and of a hit in the plane: a share of the numbers
/// that they are made from.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A plane whose front is not seen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CutPlane {
    normal: DVec3,
    offset: f64,
}

impl CutPlane {
    /// # Errors
    ///
    /// [`Error::Argument`] for a normal that is zero, and for numbers that are not finite.
    pub(crate) fn new(cut: &Cut) -> Result<Self> {
        let normal = DVec3::from(cut.normal);
        let is_plane = normal.is_finite() && normal != DVec3::ZERO && cut.offset.is_finite();
        let expected = "a finite normal other than zero, and a finite offset";
        if !is_plane {
            return Err(Error::argument("cut", expected, format!("{cut:?}")));
        }
        // Of length one, so that no product of numbers in the scene overflows.
        let largest = normal.abs().max_element();
        let scaled = normal / largest;
        let length = scaled.length();
        Ok(Self { normal: scaled / length, offset: cut.offset / largest / length })
    }

    /// The normal, of length one.
    pub(crate) fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The point of the plane next to the world's origin.
    pub(crate) fn origin(&self) -> DVec3 {
        self.offset * self.normal
    }

    /// Two directions in the plane, of length one and at right angles.
    pub(crate) fn axes(&self) -> [DVec3; 2] {
        let (x, y) = self.normal.any_orthonormal_pair();
        [x, y]
    }

    /// The distance of a ray's start before the plane, and the ray's speed away from it, along the
    /// normal.
    fn before_and_slope(&self, ray: &Ray) -> [f64; 2] {
        let before = self.normal.dot(ray.origin) - self.offset;
        [before, self.normal.dot(ray.direction)]
    }

    /// The parameter at which a ray crosses the plane.
    pub(crate) fn crossing(&self, ray: &Ray) -> f64 {
        let [before, slope] = self.before_and_slope(ray);
        -before / slope
    }

    /// The part of a ray that is behind the plane, by more than rounding. So surfaces in the plane
    /// are not seen, rather than in some pixels.
    pub(crate) fn behind(&self, ray: Ray) -> Ray {
        let [before, slope] = self.before_and_slope(&ray);
        let crossing = -before / slope;
        let largest = self.normal.abs().dot(ray.origin.abs()) + self.offset.abs();
        let rounding = ROUNDING * (largest / slope.abs() + crossing.abs());
        if before > 0.0 && slope >= 0.0 {
            // It never comes behind the plane.
            ray.up_to(ray.t_min)
        } else if before > 0.0 {
            ray.beyond((crossing + rounding).max(ray.t_min))
        } else if slope > 0.0 {
            ray.up_to((crossing - rounding).min(ray.t_max))
        } else {
            ray
        }
    }

    /// Whether a camera's ray, or the part of it that is [behind](Self::behind) a plane, begins on
    /// the plane.
    pub(crate) fn is_begin(ray: &Ray) -> bool {
        ray.t_min > 0.0
    }
}

/// A camera whose rays are only behind a plane.
#[derive(Debug)]
pub(crate) struct CutCamera<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) plane: CutPlane,
}

impl Rays for CutCamera<'_> {
    fn len(&self) -> usize {
        self.camera.len()
    }

    fn ray(&self, index: usize) -> Ray {
        self.plane.behind(Rays::ray(self.camera, index))
    }
}

impl Sensor for CutCamera<'_> {
    fn shape(&self) -> [usize; 2] {
        self.camera.shape()
    }

    fn ray_within(&self, pixel: usize, offset: DVec2) -> Ray {
        self.plane.behind(Sensor::ray_within(self.camera, pixel, offset))
    }

    fn row_within(&self, first: usize, offset: DVec2, rays: &mut [Ray]) {
        Sensor::row_within(self.camera, first, offset, rays);
        for ray in rays {
            *ray = self.plane.behind(*ray);
        }
    }

    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2] {
        self.camera.range_and_z(pixel, t)
    }

    fn place(&self, pixel: usize) -> (DVec3, Option<DVec3>) {
        self.camera.place(pixel)
    }

    fn camera(&self) -> Option<&Camera> {
        Some(self.camera)
    }

    fn record(&self) -> Record {
        self.camera.record()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_ray_the_part_behind_the_plane_is_left() {
        let plane = |normal: [f64; 3], offset| CutPlane::new(&Cut { normal, offset }).unwrap();
        let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
        let ends = |plane: CutPlane| {
            let ray = plane.behind(ray);
            [ray.t_min, ray.t_max]
        };
        let near = |t: f64, expected: f64| {
            let behind = t - expected;
            assert!((0.0..1e-12).contains(&behind), "{t} {expected}");
        };
        let [begin, end] = ends(plane([0.0, 0.0, 2.0], 4.0));
        near(begin, 3.0);
        assert_eq!(end, f64::INFINITY);
        assert_eq!(plane([0.0, 0.0, 2.0], 4.0).crossing(&ray), 3.0);
        for huge in [1e308, 5e-324] {
            near(ends(plane([0.0, 0.0, huge], huge))[0], 4.0);
        }
        let [begin, end] = ends(plane([0.0, 0.0, -1.0], -2.0));
        assert_eq!(begin, 0.0);
        near(3.0, end);
        assert_eq!(ends(plane([0.0, 0.0, 1.0], 6.0)), [0.0, f64::INFINITY]);
        let [first, last] = ends(plane([0.0, 0.0, -1.0], -7.0));
        assert!(first >= last, "in front of it all the way");
        let along = ends(plane([1.0, 0.0, 0.0], 0.0));
        assert_eq!(along, [0.0, f64::INFINITY], "a ray in the plane is behind it");
    }

    #[test]
    fn what_is_no_plane_is_refused() {
        for (normal, offset) in
            [([0.0; 3], 0.0), ([f64::NAN, 0.0, 0.0], 0.0), ([1.0, 0.0, 0.0], f64::INFINITY)]
        {
            let error = CutPlane::new(&Cut { normal, offset }).unwrap_err();
            assert!(error.to_string().contains("cut"), "{error}");
        }
    }
}
