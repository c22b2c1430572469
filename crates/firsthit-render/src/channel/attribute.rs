//! Attributes of meshes where rays met them, by name.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::CHUNK;
use crate::error::{Error, Result, escape_controls, there_are};
use crate::memory::filled;
use crate::parallel;
use crate::scene::{Object, Scene};
use crate::shape::{Mesh, NamedAttribute, PropertyOf};
use crate::shoot::Hits;
use crate::watch::{Watch, stop_if_asked};

/// Numbers for each hit: those of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub struct AttributeValues {
    /// The number of components of each hit's value.
    pub components: usize,
    /// The numbers, those of one hit after the other; NaN where there are none.
    pub values: Vec<f64>,
}

/// An attribute of the meshes that were hit, by its name, at each hit: a property that a file or a
/// program gave the mesh, or its `normals`, `uvs`, `colors` or `alphas`. Of several with this name
/// [`Mesh::attribute`] takes one; `of` chooses.
///
/// [`NamedAttribute::look_up`] says what the value between the corners of a triangle is. The
/// numbers are NaN for misses, for shapes that are no mesh, and for meshes without the attribute.
/// There are as many for each hit as in the mesh of the scene where there are most; a mesh with
/// fewer has NaN for the rest. All threads of the current rayon pool work; few hits are looked up
/// by the calling thread alone. `watch` is told of every hit once.
///
/// ```
/// use std::sync::Arc;
///
/// use firsthit::shape::{Property, PropertyOf, PropertyValues};
/// use firsthit::shoot::{First, trace};
/// use firsthit::{DVec3, Mesh, Object, Positions, Ray, Scene, channel};
///
/// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let heat = PropertyValues::Single(vec![10.0, 20.0, 40.0].into());
/// let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2]])?;
/// let mesh = mesh.with_properties(vec![Property::new("heat", PropertyOf::Vertices, heat)])?;
/// let scene = Scene::new(vec![Object::new(Arc::new(mesh))])?;
/// let rays = [1.0, 9.0].map(|x| Ray::new(DVec3::new(x, 2.0, 5.0), DVec3::NEG_Z));
/// let hits = trace(&scene, &rays[..], First, &())?;
/// let heat = channel::attribute("heat", None, &scene, &hits, &())?;
/// assert_eq!(heat.values[0], 0.25 * 10.0 + 0.25 * 20.0 + 0.5 * 40.0);
/// assert!(heat.values[1].is_nan());
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for a name that no mesh of the scene has, [`Error::Limit`] when the numbers
/// do not fit into memory, [`Error::Interrupted`] when `watch` stops it.
pub fn attribute(
    name: &str,
    of: Option<PropertyOf>,
    scene: &Scene,
    hits: &Hits,
    watch: &dyn Watch,
) -> Result<AttributeValues> {
    let components = components(name, of, scene)?;
    let count = hits.len();
    let mut values = filled(count.saturating_mul(components), f64::NAN)?;
    let fill = |(index, values): (usize, &mut [f64])| {
        stop_if_asked(watch)?;
        let first = index * CHUNK;
        let mut known = Known { scene, name, of, last: None };
        for (k, value) in values.chunks_exact_mut(components).enumerate() {
            known.look_up(hits, first + k, value);
        }
        watch.advance((values.len() / components) as u64);
        Ok(())
    };
    // No more than all of them, so that the product is one of what there is.
    let chunk = CHUNK.min(count.max(1)) * components;
    parallel::try_each(values.chunks_mut(chunk).enumerate(), fill)?;
    Ok(AttributeValues { components, values })
}

/// The number of components of an attribute at each hit: as many as in the mesh where there are
/// most.
pub(super) fn components(name: &str, of: Option<PropertyOf>, scene: &Scene) -> Result<usize> {
    let meshes = meshes(scene).filter_map(|mesh| mesh.attribute(name, of));
    let most = meshes.map(|found| found.components()).max();
    most.ok_or_else(|| unknown(name, of, scene))
}

/// An attribute that meshes of a scene have, see [`attributes`].
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct AttributeName<'a> {
    /// The name.
    pub name: &'a str,
    /// The elements that have the values.
    pub of: PropertyOf,
    /// The largest number of components of a value.
    pub components: usize,
}

/// The attributes that the meshes of a scene have, sorted by name, and then by what has them: first
/// vertices, then corners and faces.
pub fn attributes(scene: &Scene) -> Vec<AttributeName<'_>> {
    let all = meshes(scene).flat_map(Mesh::attributes);
    let mut known: BTreeMap<(&str, PropertyOf), usize> = BTreeMap::new();
    for found in all {
        let most = known.entry((found.name(), found.of())).or_default();
        *most = found.components().max(*most);
    }
    let name = |((name, of), components)| AttributeName { name, of, components };
    known.into_iter().map(name).collect()
}

/// The meshes of a scene, each as often as objects have it, but for neighbours that share it.
fn meshes(scene: &Scene) -> impl Iterator<Item = &Mesh> {
    let mut last = std::ptr::null();
    let meshes = scene.objects().iter().filter_map(|object| object.mesh());
    meshes.filter_map(move |mesh| {
        let is_new = !std::ptr::eq(last, Arc::as_ptr(mesh));
        last = Arc::as_ptr(mesh);
        is_new.then_some(&**mesh)
    })
}

fn unknown(name: &str, of: Option<PropertyOf>, scene: &Scene) -> Error {
    let known = attributes(scene).into_iter();
    let known = known.filter(|known| of.is_none_or(|of| known.of == of));
    let mut names: Vec<String> = known.map(|known| escape_controls(known.name)).collect();
    names.dedup();
    let there = there_are(&names, "no mesh has any");
    let got = format!("'{}'; {there}", escape_controls(name));
    Error::argument("attribute", "the name of one that a mesh of the scene has", got)
}

/// The attribute of the object that was hit last: the next hit is often of the same.
struct Known<'a> {
    scene: &'a Scene,
    name: &'a str,
    of: Option<PropertyOf>,
    last: Option<(i32, Option<NamedAttribute<'a>>)>,
}

impl Known<'_> {
    fn look_up(&mut self, hits: &Hits, index: usize, value: &mut [f64]) {
        let hit = hits.get(index);
        if hit.is_miss() {
            return;
        }
        let found = match self.last {
            Some((object, found)) if object == hit.object => found,
            _ => {
                let mesh = self.scene.object(&hit).and_then(Object::mesh);
                let found = mesh.and_then(|mesh| mesh.attribute(self.name, self.of));
                self.last = Some((hit.object, found));
                found
            }
        };
        if let (Some(found), Ok(triangle)) = (found, usize::try_from(hit.primitive)) {
            found.look_up(triangle, hit.barycentric, value);
        }
    }
}
