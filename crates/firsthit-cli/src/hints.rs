//! Hints for a picture that may not be what was expected.

use firsthit::explain::before_viewplane;
use firsthit::scene_file::nearest_word;
use firsthit::{Bounds, Camera, DVec3, Scene};
pub(crate) use firsthit_view::words::{
    coordinate, exact_triple, extent, number, place, six_digits, triple,
};

use crate::console::counted;

/// The end of a message about a word that is none of those known.
pub(crate) fn meant<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let meant = nearest_word(word, known);
    meant.map_or(String::new(), |meant| format!("; did you mean {meant}?"))
}

/// A hint for each thing that is probably not meant.
pub(crate) fn hints(scene: &Scene, camera: &Camera, hits: usize) -> Vec<String> {
    let mut hints = Vec::new();
    let bounds = scene.bounds();
    let between = before_viewplane(scene, camera).objects;
    if hits == 0 {
        if bounds.is_empty() {
            hints.push("nothing was hit: there is nothing to see".into());
        } else if between == 0 {
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
    if between > 0 {
        let are = if between == 1 { "is" } else { "are" };
        hints.push(format!(
            "{} {are} between the eye and the viewplane, where rays start: what is there is not seen; use --ray-start eye",
            counted(between as u64, "object")
        ));
    }
    hints
}

/// The warning that all `points` are farther from the scene than its own size: their units may be
/// others.
pub(crate) fn far_off(scene: &Scene, points: impl IntoIterator<Item = DVec3>) -> Option<String> {
    let bounds = scene.bounds();
    let is_far = |point: DVec3| {
        let nearest = point.clamp(bounds.low, bounds.high);
        point.distance(nearest) > extent(bounds)
    };
    let mut points = points.into_iter().peekable();
    let is_asked = !bounds.is_empty() && points.peek().is_some();
    (is_asked && points.all(is_far)).then(|| {
        format!(
            "every point is farther from the model than its own size: bounds {}; --units and --scale change the model alone",
            span(bounds)
        )
    })
}

/// A box as text.
pub(crate) fn span(bounds: Bounds) -> String {
    let [low, high] = [bounds.low, bounds.high].map(|corner| place(corner, extent(bounds)));
    format!("{low} to {high}")
}

fn looks_away(camera: &Camera, bounds: Bounds) -> bool {
    let sees_ahead = camera.lens().viewplane().is_some();
    let corners = bounds.corners();
    sees_ahead
        && corners.iter().all(|&corner| (corner - camera.position()).dot(camera.aim()) <= 0.0)
}
