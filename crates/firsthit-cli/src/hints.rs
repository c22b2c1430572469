//! What a user wants to hear when the picture is not what was expected.

use firsthit::{Bounds, Camera, RayStart, Scene, occluded};
pub(crate) use firsthit_view::words::{number, six_digits, triple};

/// Rays tried for each row and column when looking for what is hidden.
const PROBES: usize = 128;

/// A hint for each thing that is probably not meant.
pub(crate) fn hints(scene: &Scene, camera: &Camera, hits: usize) -> Vec<String> {
    let mut hints = Vec::new();
    let bounds = scene.bounds();
    let between = hidden_in_front(scene, camera);
    if hits == 0 {
        if bounds.is_empty() {
            hints.push("nothing was hit: there is nothing to see".into());
        } else if !between {
            let how = if looks_away(camera, bounds) {
                "the camera looks away from the scene"
            } else {
                "the camera looks past the scene, or it is too small or too far away to be seen"
            };
            hints.push(format!(
                "nothing was hit: {how}: bounds {}, try --look-at auto",
                span(bounds)
            ));
        }
    }
    if between {
        hints.push("objects between the eye and the viewplane are not seen; to see them, use --ray-start eye".into());
    }
    hints
}

/// A box as text.
pub(crate) fn span(bounds: Bounds) -> String {
    format!("{} to {}", triple(bounds.low), triple(bounds.high))
}

fn looks_away(camera: &Camera, bounds: Bounds) -> bool {
    let sees_ahead = camera.lens().viewplane().is_some();
    let corners = bounds.corners();
    sees_ahead
        && corners
            .iter()
            .all(|&corner| (corner - camera.position()).dot(camera.aim()) <= 0.0)
}

/// Whether anything lies between the eye and the viewplane, on a grid of rays.
fn hidden_in_front(scene: &Scene, camera: &Camera) -> bool {
    let viewplane = camera.lens().viewplane();
    if viewplane.is_none_or(|viewplane| viewplane.ray_start == RayStart::Eye) {
        return false;
    }
    let from_eye = camera.starting_at(RayStart::Eye);
    let steps = |count: usize| (0..count).step_by(count.div_ceil(PROBES));
    steps(camera.rows()).any(|row| {
        steps(camera.columns()).any(|column| {
            let ray = from_eye.ray(row, column);
            // The range where t is zero is the way from the eye to the viewplane.
            let to_viewplane = camera.range(row, column, 0.0);
            occluded(scene, ray.origin, ray.direction, to_viewplane)
        })
    })
}
