//! Everything the bench asks of firsthit, in one place: its public functions as a user would call them.

use std::path::Path;

use firsthit::io::LoadSettings;
use firsthit::shoot::{BruteForce, first_hit, occluded_all, shoot_all_into};
use firsthit::{Hit, Hits, Object, Ray, Rays, Scene};

/// The objects of a file.
pub(crate) fn load(path: &Path) -> Result<Vec<Object>, String> {
    let model =
        firsthit::io::load(path, &LoadSettings::default()).map_err(|error| error.to_string())?;
    Ok(model.objects)
}

/// Builds the trees.
pub(crate) fn build(objects: &[Object]) -> Result<Scene, String> {
    Scene::new(objects.to_vec()).map_err(|error| error.to_string())
}

/// The first hits of all rays, of a camera or from an array, into memory that is used again.
pub(crate) fn first_hits(scene: &Scene, rays: &(impl Rays + ?Sized), hits: &mut Hits) {
    shoot_all_into(scene, rays, hits, &()).expect(STOPPED);
}

/// Whether each ray meets anything.
pub(crate) fn any_hits(scene: &Scene, rays: &[Ray]) -> Vec<bool> {
    occluded_all(scene, rays, &()).expect(STOPPED)
}

const STOPPED: &str = "there is memory for a million hits, and nobody stops it";

/// The first hit by the judge: every triangle, in float64.
pub(crate) fn judge(scene: &Scene, ray: &Ray) -> Hit {
    first_hit::<BruteForce>(scene, ray)
}
