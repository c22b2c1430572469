//! Vertices that should not be there. Objects may share them: each buffer is looked at once.

use std::collections::HashMap;
use std::sync::Arc;

use super::Facts;
use super::report::FindingCollector;
use crate::error::Result;
use crate::geometry::DVec3;
use crate::memory;
use crate::scene::Scene;
use crate::shape::{Mesh, Positions};
use crate::watch::{Watch, stop_if_asked};

/// The distinct buffers of vertices: the first object that has it, and all its meshes.
fn buffers<'a>(facts: &Facts<'a>) -> Vec<(i32, &'a Positions, Vec<&'a Mesh>)> {
    let mut known: HashMap<*const Positions, usize> = HashMap::new();
    let mut buffers: Vec<(i32, &Positions, Vec<&Mesh>)> = Vec::new();
    for &(object, mesh) in &facts.meshes {
        let positions = mesh.positions();
        let index = *known.entry(Arc::as_ptr(positions)).or_insert_with(|| {
            buffers.push((object, positions, Vec::new()));
            buffers.len() - 1
        });
        buffers[index].2.push(mesh);
    }
    buffers
}

/// Counts the vertices of a buffer that are `wanted`; the first is the place.
fn add(
    scene: &Scene,
    (object, positions): (i32, &Positions),
    wanted: impl Fn(u32) -> bool,
    (found, watch): (&mut FindingCollector<'_>, &dyn Watch),
) -> Result<()> {
    stop_if_asked(watch)?;
    let in_scene = usize::try_from(object).ok().and_then(|k| scene.objects().get(k));
    let in_world =
        |point| in_scene.map_or(point, |object| object.transform().point_in_world(point));
    let count = u32::try_from(positions.len()).unwrap_or(u32::MAX);
    for vertex in (0..count).filter(|&vertex| wanted(vertex)) {
        found.add_elsewhere(Some(object), in_world(positions.get(vertex)));
    }
    Ok(())
}

/// Vertices that are nowhere.
pub(super) fn non_finite(
    facts: &Facts<'_>,
    found: &mut FindingCollector<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    for (object, positions, _) in buffers(facts) {
        let is_nowhere = |vertex: u32| !positions.get(vertex).is_finite();
        add(facts.scene, (object, positions), is_nowhere, (&mut *found, watch))?;
    }
    found.places.iter_mut().for_each(|place| place.position = DVec3::NAN);
    Ok(())
}

/// Vertices of no face.
pub(super) fn unreferenced(
    facts: &Facts<'_>,
    found: &mut FindingCollector<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    for (object, positions, meshes) in buffers(facts) {
        let mut is_used = memory::filled(positions.len(), false)?;
        let triangles = meshes.into_iter().flat_map(Mesh::triangles);
        for &vertex in triangles.flatten() {
            is_used[vertex as usize] = true;
        }
        let is_free = |vertex: u32| !is_used[vertex as usize];
        add(facts.scene, (object, positions), is_free, (&mut *found, watch))?;
    }
    Ok(())
}
