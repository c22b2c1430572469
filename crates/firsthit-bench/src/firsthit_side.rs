//! Everything the bench asks of firsthit, in one place: its public functions as a user would call them.

use std::path::Path;

use firsthit::io::LoadSettings;
use firsthit::shoot::{BruteForce, any_hit, first_hit, shoot_all};
use firsthit::{Hit, Hits, Object, Ray, Rays, Scene};
use rayon::prelude::*;

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

/// The first hits of all rays, of a camera or from an array.
pub(crate) fn first_hits(scene: &Scene, rays: &(impl Rays + ?Sized)) -> Hits {
    shoot_all(scene, rays, &()).expect("there is memory for a million hits, and nobody stops it")
}

/// Whether each ray meets anything.
pub(crate) fn any_hits(scene: &Scene, rays: &[Ray]) -> Vec<bool> {
    let mut found = vec![false; rays.len()];
    let chunks = found.par_chunks_mut(1024).zip(rays.par_chunks(1024));
    chunks.for_each(|(found, rays)| {
        for (found, ray) in found.iter_mut().zip(rays) {
            *found = any_hit(scene, ray);
        }
    });
    found
}

/// The first hit by the judge: every triangle, in float64.
pub(crate) fn judge(scene: &Scene, ray: &Ray) -> Hit {
    first_hit::<BruteForce>(scene, ray)
}
