//! All rays are parallel to the aim.

use super::{Camera, RayStart, Reach};
use crate::geometry::{DVec3, PixelGrid, Ray};

pub(super) fn ray(camera: &Camera, point: DVec3) -> Ray {
    let start = match camera.view.ray_start {
        RayStart::Viewplane => point,
        RayStart::Eye => point - camera.view.focal_length * camera.aim(),
    };
    Ray::new(camera.position() + start, camera.aim())
}

pub(super) fn reach(camera: &Camera, _point: DVec3) -> Reach {
    let offset = match camera.view.ray_start {
        RayStart::Viewplane => camera.view.focal_length,
        RayStart::Eye => 0.0,
    };
    Reach {
        offset,
        cosine: 1.0,
    }
}

#[expect(
    clippy::unnecessary_wraps,
    reason = "other models have no flat viewplane"
)]
pub(super) fn grid(camera: &Camera) -> Option<PixelGrid> {
    Some(camera.pixel_grid(Some(camera.aim())))
}
