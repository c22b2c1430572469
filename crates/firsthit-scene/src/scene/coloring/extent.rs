//! The least and the largest number that a scene has, in the picture or not, but for hidden
//! objects: so a part of a picture has the colours of the whole.

use std::collections::{BTreeSet, HashSet};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use super::by::{ColorBy, MOST, magnitude};
use super::unit;
use crate::error::{Error, Result, escape_controls};
use crate::scene::{Object, Scene};
use crate::shape::{Mesh, NamedAttribute, Shape};

/// The most names that an error lists.
const NAMES: usize = 20;

impl ColorBy {
    /// The least and the largest finite number, of all objects but hidden ones; `None` where there
    /// is none.
    pub(super) fn extent(&self, scene: &Scene) -> Result<Option<[f64; 2]>> {
        let objects = scene.objects().len();
        Ok(match self {
            Self::Attribute(name) => {
                let meshes = meshes(scene);
                let found = meshes.iter().filter_map(|mesh| mesh.attribute(name, None));
                let found: Vec<NamedAttribute<'_>> = found.collect();
                if found.is_empty() {
                    return Err(unknown(name, &meshes));
                }
                extent(found.into_iter().flat_map(numbers))
            }
            Self::Values(values) if values.len() != objects => {
                let got = format!("{} for {objects} objects", values.len());
                return Err(Error::argument("values", "a number for each object", got));
            }
            Self::Values(values) => extent(shown(scene).map(|(index, _)| values[index])),
            // A scene in which nothing is shown has no number either, but needs no range.
            Self::Object => extent(shown(scene).map(|(index, _)| index as f64)).or(Some([0.0; 2])),
            Self::Face => extent(shown(scene).flat_map(|(_, object)| faces(object))),
            Self::Height => {
                let up = unit(scene.up());
                extent([-scene.support(-up), scene.support(up)].into_iter())
            }
            Self::Incidence => Some([0.0, FRAC_PI_2]),
        })
    }
}

/// The least and the largest of the finite ones.
fn extent(numbers: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = numbers.filter(|number| number.is_finite());
    finite.fold(None, |known, number| {
        let [low, high] = known.unwrap_or([number; 2]);
        Some([low.min(number), high.max(number)])
    })
}

/// The objects that are not hidden, each with its identifier.
fn shown(scene: &Scene) -> impl Iterator<Item = (usize, &Object)> {
    let objects = scene.objects().iter().enumerate();
    objects.filter(|(_, object)| !object.is_hidden())
}

/// The meshes of what is not hidden, each once.
fn meshes(scene: &Scene) -> Vec<&Mesh> {
    let mut known = HashSet::new();
    shown(scene)
        .filter_map(|(_, object)| object.mesh())
        .filter(|mesh| known.insert(Arc::as_ptr(mesh)))
        .map(|mesh| &**mesh)
        .collect()
}

/// All numbers of an attribute.
fn numbers(attribute: NamedAttribute<'_>) -> impl Iterator<Item = f64> {
    let components = attribute.components().min(MOST);
    (0..attribute.count()).map(move |index| {
        let mut numbers = [f64::NAN; MOST];
        let numbers = &mut numbers[..components];
        attribute.value(index, numbers);
        magnitude(numbers)
    })
}

/// The first and the last face of an object.
fn faces(object: &Object) -> [f64; 2] {
    let last = match object.shape() {
        Shape::Mesh(mesh) => match mesh.faces() {
            Some(faces) => faces.iter().copied().max().map_or(0.0, f64::from),
            None => mesh.triangles().len().saturating_sub(1) as f64,
        },
        Shape::Box(_) => 5.0,
        Shape::Cylinder(_) | Shape::Cone(_) => 2.0,
        Shape::Sphere(_) | Shape::Plane(_) | Shape::Disc(_) => 0.0,
    };
    [0.0, last]
}

fn unknown(name: &str, meshes: &[&Mesh]) -> Error {
    let known = meshes.iter().flat_map(|mesh| mesh.attributes());
    let known: BTreeSet<&str> = known.map(|known| known.name()).collect();
    let names: Vec<String> = known.into_iter().map(escape_controls).take(NAMES).collect();
    let there = if names.is_empty() {
        "no mesh has any".to_owned()
    } else {
        format!("there are {}", names.join(", "))
    };
    Error::argument(
        "attribute",
        "the name of one that a mesh of the scene has",
        format!("'{}'; {there}", escape_controls(name)),
    )
}
