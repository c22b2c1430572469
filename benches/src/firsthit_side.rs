//! Everything the bench asks of firsthit, in one place: its public functions as a user would call
//! them.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use firsthit::channel::kind;
use firsthit::image::Data;
use firsthit::load::LoadSettings;
use firsthit::shape::{Mesh, Positions};
use firsthit::shoot::{
    All, AllHits, Any, BruteForce, Cpu, Engine, First, trace, trace_into, trace_with,
};
use firsthit::{Camera, Hit, Hits, Object, Ray, Rays, Scene, Shading, render};

/// The objects of a file.
pub(crate) fn load(path: &Path) -> Result<Vec<Object>, String> {
    let model =
        firsthit::load::load(path, &LoadSettings::default()).map_err(|error| error.to_string())?;
    Ok(model.world.objects)
}

/// Builds the trees.
pub(crate) fn build(objects: &[Object]) -> Result<Scene, String> {
    Scene::new(objects.to_vec()).map_err(|error| error.to_string())
}

/// Copies of objects with the vertices of their meshes moved a little. Meshes that were shared are
/// shared.
pub(crate) fn moved(objects: &[Object]) -> Result<Vec<Object>, String> {
    let mut known: HashMap<*const Mesh, Arc<Mesh>> = HashMap::new();
    let moved = |object: &Object| {
        let Some(mesh) = object.mesh() else {
            return Ok(object.clone());
        };
        let place = |mesh: &Arc<Mesh>| Object::new(Arc::clone(mesh)).placed(*object.transform());
        if let Some(moved) = known.get(&Arc::as_ptr(mesh)) {
            return Ok(place(moved));
        }
        let positions = match &**mesh.positions() {
            Positions::Single(points) => {
                Positions::Single(points.iter().map(|p| p.map(|x| 1.001 * x)).collect())
            }
            Positions::Double(points) => {
                Positions::Double(points.iter().map(|p| p.map(|x| 1.001 * x)).collect())
            }
        };
        let moved = Mesh::new(positions, mesh.triangles().to_vec()).map_err(|e| e.to_string())?;
        let moved = known.entry(Arc::as_ptr(mesh)).or_insert(Arc::new(moved));
        Ok(place(moved))
    };
    objects.iter().map(moved).collect()
}

/// The first hits of all rays, of a camera or from an array, into memory that is used again.
pub(crate) fn first_hits(scene: &Scene, rays: &(impl Rays + ?Sized), hits: &mut Hits) {
    trace_into(&Cpu::default(), scene, rays, (First, hits), &()).expect(STOPPED);
}

/// Whether each ray meets anything.
pub(crate) fn any_hits(scene: &Scene, rays: &[Ray]) -> Vec<bool> {
    trace(scene, rays, Any, &()).expect(STOPPED)
}

/// All hits of all rays, into memory that is used again.
pub(crate) fn all_hits(scene: &Scene, rays: &[Ray], all: &mut AllHits) {
    trace_into(&Cpu::default(), scene, rays, (All::default(), all), &()).expect(STOPPED);
}

/// The colours of a picture, three numbers for each pixel.
pub(crate) fn colors(
    scene: &Scene,
    camera: &Camera,
    shading: &Shading<'_>,
    samples: u32,
) -> Vec<f32> {
    let color = kind("color").expect("there is such a channel");
    let frame = render(scene, camera, shading, &[color], samples, &()).expect(STOPPED);
    let channel = frame.into_channels().pop();
    match channel.expect("one was asked for").data {
        Data::Float32(colors) => colors,
        other => unreachable!("colours are float32, not {other:?}"),
    }
}

const STOPPED: &str = "there is memory for a million hits, and the watch stops nothing";

/// The first hit by the judge: every triangle, in float64.
pub(crate) fn judge(scene: &Scene, ray: &Ray) -> Hit {
    BruteForce.first_hit(scene, ray)
}

/// All hits by the judge.
pub(crate) fn judge_all(scene: &Scene, ray: &Ray) -> Hits {
    let all = trace_with(&BruteForce, scene, std::slice::from_ref(ray), All::default(), &());
    all.expect(STOPPED).hits
}
