//! All rays pass through the camera's position.

use super::{Camera, RayStart, Reach};
use crate::geometry::{DVec3, PixelGrid, Ray, unit};

pub(super) fn ray(camera: &Camera, point: DVec3) -> Ray {
    let origin = match camera.view.ray_start {
        RayStart::Viewplane => camera.position() + point,
        RayStart::Eye => camera.position(),
    };
    Ray::new(origin, unit(point))
}

pub(super) fn reach(camera: &Camera, point: DVec3) -> Reach {
    let distance = point.length();
    let offset = match camera.view.ray_start {
        RayStart::Viewplane => distance,
        RayStart::Eye => 0.0,
    };
    Reach {
        offset,
        cosine: camera.view.focal_length / distance,
    }
}

#[expect(
    clippy::unnecessary_wraps,
    reason = "other models have no flat viewplane"
)]
pub(super) fn grid(camera: &Camera) -> Option<PixelGrid> {
    Some(camera.pixel_grid(None))
}
