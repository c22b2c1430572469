//! The eye: the point or direction that a picture is seen from.

use std::cmp::Ordering;

use crate::camera::{Camera, Lens};
use crate::geometry::orientation::{along_normal, orient_3d};
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray, Transform};

/// An eye, in the world or in the space of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Eye {
    /// The eye is at a point.
    At(DVec3),
    /// Infinitely far away in a direction.
    Toward(DVec3),
}

impl Eye {
    /// The eye in an object's space.
    pub(super) fn in_object(self, transform: &Transform) -> Self {
        let ray = match self {
            Self::At(point) => Ray::new(point, DVec3::ZERO),
            Self::Toward(direction) => Ray::new(DVec3::ZERO, direction),
        };
        let ray = transform.ray_in_object(&ray);
        match self {
            Self::At(_) => Self::At(ray.origin),
            Self::Toward(_) => Self::Toward(ray.direction),
        }
    }

    /// The direction from a point to the eye, of any length: to a point, the whole way.
    pub(super) fn from(self, point: DVec3) -> DVec3 {
        match self {
            Self::At(eye) => eye - point,
            Self::Toward(direction) => direction,
        }
    }

    /// Whether it sees the front of a triangle, decided exactly. Edge-on it does not.
    pub(super) fn sees_front(self, [a, b, c]: [DVec3; 3]) -> bool {
        let side = match self {
            Self::At(eye) => orient_3d([a, b, c, eye]),
            Self::Toward(direction) => along_normal([a, b, c], direction),
        };
        side == Ordering::Greater
    }
}

/// A camera the other way round: from points to the eye.
#[derive(Debug)]
pub(super) struct View<'a> {
    camera: &'a Camera,
    pub(super) eye: Eye,
    /// The pixels of a flat viewplane.
    grid: Option<PixelGrid>,
}

impl<'a> View<'a> {
    pub(super) fn new(camera: &'a Camera) -> Self {
        let grid = camera.grid_within(PixelGrid::CENTRE);
        let parallel = grid.and_then(|grid| grid.parallel);
        Self {
            camera,
            eye: match parallel {
                Some(direction) => Eye::Toward(-direction),
                None => Eye::At(camera.position()),
            },
            grid,
        }
    }

    /// Whether the picture of a straight line is straight.
    pub(super) fn is_flat(&self) -> bool {
        self.grid.is_some()
    }

    /// The width of the picture where its left and right edges are the same directions, as in a
    /// panorama all around.
    pub(super) fn period(&self) -> Option<f64> {
        let fov = match self.camera.lens() {
            Lens::Equirectangular(lens) => lens.horizontal_fov,
            Lens::Cylindrical(lens) => lens.horizontal_fov,
            _ => return None,
        };
        (fov == 360.0).then_some(self.camera.columns() as f64)
    }

    /// The depth of a point and that at which rays start, in units of the viewplane's distance.
    fn depth(&self, point: DVec3) -> Option<[f64; 2]> {
        let grid = self.grid.as_ref()?;
        let normal = grid.right.cross(grid.upwards);
        let depth = normal.dot(point - grid.position) / normal.dot(grid.toward);
        Some([depth, f64::from(u8::from(grid.starts_on_viewplane))])
    }

    /// The position of a point in the picture; `None` where it is behind the start of the camera's
    /// rays or the lens does not see it.
    pub(super) fn pixel(&self, point: DVec3) -> Option<DVec2> {
        let is_ahead = |[depth, start]: [f64; 2]| depth > start;
        let is_seen = self.depth(point).is_none_or(is_ahead);
        is_seen.then(|| self.camera.project(point)).flatten()
    }

    /// The ray from a point to the start of the camera's ray to it.
    pub(super) fn ray_from(&self, point: DVec3) -> Ray {
        let [depth, start] = self.depth(point).unwrap_or([1.0, 0.0]);
        let ray = Ray::new(point, self.eye.from(point));
        match (self.eye, &self.grid) {
            (Eye::Toward(direction), Some(grid)) => {
                ray.up_to((start - depth) * grid.toward.dot(direction))
            }
            _ => ray.up_to(1.0 - start / depth),
        }
    }
}
