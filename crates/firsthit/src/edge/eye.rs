//! Where a picture is seen from.

use std::cmp::Ordering;

use crate::camera::Camera;
use crate::geometry::orientation::{along_normal, orient_3d};
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray, Transform};

/// An eye, in the world or in the space of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Eye {
    /// In a point.
    At(DVec3),
    /// Infinitely far away in a direction.
    Toward(DVec3),
}

impl Eye {
    /// The same in an object's space.
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

    /// The way from a point to the eye, of any length.
    pub(super) fn from(self, point: DVec3) -> DVec3 {
        match self {
            Self::At(eye) => eye - point,
            Self::Toward(direction) => direction,
        }
    }

    /// Whether a triangle shows it its front, exactly. Seen edge-on, it does not.
    pub(super) fn sees_front(self, [a, b, c]: [DVec3; 3]) -> bool {
        let side = match self {
            Self::At(eye) => orient_3d([a, b, c, eye]),
            Self::Toward(direction) => along_normal([a, b, c], direction),
        };
        side == Ordering::Greater
    }
}

/// A camera, asked the other way round: from points to the eye.
#[derive(Debug)]
pub(super) struct View<'a> {
    camera: &'a Camera,
    pub(super) eye: Eye,
    /// What rays have in common that go through a flat viewplane.
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

    /// Whether straight lines are straight in the picture.
    pub(super) fn is_flat(&self) -> bool {
        self.grid.is_some()
    }

    /// How far away a point is, in units of the viewplane's distance, and from where on rays see.
    fn depth(&self, point: DVec3) -> Option<[f64; 2]> {
        let grid = self.grid.as_ref()?;
        let normal = grid.right.cross(grid.upwards);
        let depth = normal.dot(point - grid.position) / normal.dot(grid.toward);
        Some([depth, f64::from(u8::from(grid.starts_on_viewplane))])
    }

    /// Where in the picture a point is, unless it is behind the start of the camera's rays, or the lens does not see it.
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
