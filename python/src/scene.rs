//! Scenes.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use firsthit::scene::{BuildSettings, Label};
use firsthit::watch::Watch;
use firsthit::{DAffine3, DMat3, DVec3, Material, Object, Transform};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyIndexError;
use pyo3::ffi::PyObject;
use pyo3::prelude::*;
use pyo3::types::{PyInt, PyList};

use crate::environment::{EnvironmentIn, environment_in};
use crate::errors::{Outcome, Raised};
use crate::load::Objects;
use crate::material::{MaterialIn, material};
use crate::run::{Report, guarded, run, run_reported};
use crate::shading::{LightIn, light_in};
use crate::shape::Shape;

/// The number of objects from which on the tree over them is built by several threads. A pool's
/// threads must be the call's own, since the global pool does not survive `fork`, and making them
/// takes longer than the move.
const FEW_OBJECTS: usize = 4096;

/// A built scene.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Scene(pub(crate) firsthit::Scene);

/// An object: shape, name, its transform, (4, 4), if it has one, its materials, its mask, whether
/// it is hidden and whether it was removed, and what node and what mesh of a file it comes from.
#[derive(FromPyObject)]
struct ObjectIn<'py>(
    PyRef<'py, Shape>,
    String,
    Option<Rows>,
    Bound<'py, PyList>,
    u32,
    (bool, bool),
    [Option<LabelTuple>; 2],
);

/// An object, or the number of one of a file.
enum Given<'py> {
    OfFile(usize),
    New(Box<ObjectIn<'py>>),
}

impl<'py> FromPyObject<'_, 'py> for Given<'py> {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if given.is_instance_of::<PyInt>() {
            return given.extract().map(Self::OfFile);
        }
        given.extract().map(|object| Self::New(Box::new(object)))
    }
}

/// The rows of a transform, copied from an array, (4, 4). To borrow the arrays of all objects takes
/// time in proportion to the square of their number where they are parts of one.
struct Rows([[f64; 4]; 4]);

impl<'py> FromPyObject<'_, 'py> for Rows {
    type Error = Raised;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> Outcome<Self> {
        let array: PyReadonlyArray2<'_, f64> = given.extract()?;
        let rows = transforms(array.as_slice()?).first();
        let wrong = || Raised::value("expected an array of shape (4, 4)");
        Ok(Self(*rows.ok_or_else(wrong)?))
    }
}

/// A label: its number and its name.
pub(crate) type LabelTuple = (u64, String);

fn label(label: Option<&LabelTuple>) -> Option<Label> {
    label.map(|(number, name)| Label { number: *number, name: name.as_str().into() })
}

/// The numbers of objects, (n,), and the transform of each, (n, 4, 4).
type Places<'py> = (PyReadonlyArray1<'py, i64>, PyReadonlyArray3<'py, f64>);

#[pymethods]
impl Scene {
    /// Builds a scene, sharing with `previous` what did not change, and building as that did. Which
    /// way is up, and whether that is guessed, is asked for the environment.
    #[new]
    #[expect(clippy::too_many_arguments, reason = "a scene's parts, sent by the Python half alone")]
    fn new(
        py: Python<'_>,
        objects: (Vec<Given<'_>>, Option<PyRef<'_, Objects>>),
        lights: Vec<LightIn>,
        environment: Option<EnvironmentIn<'_>>,
        up: ([f64; 3], bool),
        previous: Option<&Self>,
        build: &str,
        report: Report<'_, '_>,
    ) -> Outcome<Self> {
        let trees = BuildSettings { build: build.parse()?, rays: None };
        let mut known = Materials::default();
        let (objects, of_file) = objects;
        let objects: Vec<Object> = objects
            .iter()
            .map(|given| match (given, &of_file) {
                (Given::New(object), _) => object_in(object, &mut known),
                (Given::OfFile(number), Some(file)) => Ok(file.object(*number)?.clone()),
                (Given::OfFile(_), None) => Err(PyIndexError::new_err("there is no file").into()),
            })
            .collect::<Outcome<_>>()?;
        let lights = lights.iter().map(light_in);
        let lights = lights.collect::<firsthit::Result<_>>()?;
        let scene = run_reported(py, 0, report, |stop| match previous {
            Some(Self(previous)) => {
                previous.try_clone()?.with_build(trees).with_objects_watched(objects, stop)
            }
            None => firsthit::Scene::build_watched(objects, trees, stop),
        })?;
        let (up, up_is_guessed) = up;
        let up = if up_is_guessed && environment.is_some() {
            run(py, 0, |_| Ok(scene.likely_up(up.into())))?
        } else {
            up.into()
        };
        let environment = environment.map(|environment| environment_in(&environment, up));
        let environment = environment.transpose()?.map(Arc::new);
        Ok(Self(scene.with_lights(lights).with_environment(environment)))
    }

    /// The scene with other objects in the place of some, or behind all, with objects moved, and
    /// some hidden (`true`) or shown.
    fn changed(
        &self,
        py: Python<'_>,
        replaced: Vec<(usize, ObjectIn<'_>)>,
        places: Places<'_>,
        hidden: Vec<(usize, bool)>,
        report: Report<'_, '_>,
    ) -> Outcome<Self> {
        let mut known = Materials::default();
        let replaced: Vec<(usize, Object)> = replaced
            .iter()
            .map(|(identifier, object)| Ok((*identifier, object_in(object, &mut known)?)))
            .collect::<Outcome<_>>()?;
        let (moved, rows) = places;
        let moved = moved.as_slice()?;
        let rows = rows.as_slice()?;
        let places: Vec<(usize, Transform)> = (moved.iter().zip(transforms(rows)))
            .map(|(&identifier, rows)| {
                // A negative one is that of no object.
                let identifier = usize::try_from(identifier).unwrap_or(usize::MAX);
                Ok((identifier, transform(rows)?))
            })
            .collect::<Outcome<_>>()?;
        let has_new_objects = !replaced.is_empty();
        let changed = |watch: &dyn Watch| {
            let mut scene = self.0.try_clone()?;
            if has_new_objects {
                let mut objects = scene.objects().to_vec();
                for (identifier, object) in replaced {
                    let count = objects.len();
                    match objects.get_mut(identifier) {
                        Some(place) => *place = object,
                        None if identifier == count => objects.push(object),
                        None => {
                            let expected = "one of the scene's, or the next";
                            let got = format!("{identifier}; there are {count}");
                            return Err(firsthit::Error::argument("object", expected, got));
                        }
                    }
                }
                scene = scene.with_objects_watched(objects, watch)?;
            }
            if !places.is_empty() {
                scene.move_objects_watched(&places, watch)?;
            }
            if !hidden.is_empty() {
                scene.hide_objects_watched(&hidden, watch)?;
            }
            Ok(scene)
        };
        // Those that shared a tree get their own.
        let objects = self.0.objects();
        let parts = |&(k, to): &(usize, Transform)| {
            let is_elsewhere = objects.get(k).is_some_and(|it| *it.transform() != to);
            is_elsewhere && u32::try_from(k).is_ok_and(|k| self.0.numbers_of(k).is_some())
        };
        let has_new_trees = has_new_objects
            || places.iter().any(parts)
            || hidden.iter().any(|(_, is_hidden)| !is_hidden);
        if objects.len() < FEW_OBJECTS && !has_new_trees {
            return Ok(Self(guarded(|| py.detach(|| changed(&())))??));
        }
        run_reported(py, 0, report, |stop| changed(stop)).map(Self)
    }

    /// The scene in which rays meet only the objects that have a bit in common with `mask`, and are
    /// in `only` if that is given; translucent surfaces are cut out below an alpha, if that is
    /// given.
    fn seen_by(
        &self,
        py: Python<'_>,
        mask: u32,
        only: Option<Vec<usize>>,
        blend_below: Option<f64>,
    ) -> Outcome<Self> {
        let objects = self.0.objects();
        let mut hidden = vec![only.is_some(); objects.len()];
        for identifier in only.into_iter().flatten() {
            if let Some(is_hidden) = hidden.get_mut(identifier) {
                *is_hidden = false;
            }
        }
        let hidden: Vec<(usize, bool)> = objects
            .iter()
            .zip(hidden)
            .enumerate()
            .filter(|(_, (object, is_hidden))| *is_hidden || object.mask() & mask == 0)
            .map(|(identifier, _)| (identifier, true))
            .collect();
        if hidden.is_empty() && blend_below.is_none() {
            return Ok(Self(self.0.clone()));
        }
        let seen = || {
            let mut scene = match blend_below {
                Some(cutoff) => self.0.with_blend_below(cutoff)?,
                None => self.0.try_clone()?,
            };
            scene.hide_objects(&hidden).map(|()| scene)
        };
        if objects.len() < FEW_OBJECTS {
            return Ok(Self(guarded(|| py.detach(seen))??));
        }
        run(py, 0, |_| seen()).map(Self)
    }

    /// The scene in another environment, with the sun of a sky; `up` is the scene's.
    fn lit_by(
        &self,
        py: Python<'_>,
        environment: EnvironmentIn<'_>,
        up: [f64; 3],
    ) -> Outcome<Self> {
        let environment = environment_in(&environment, up.into())?;
        let lit = || {
            let scene = self.0.try_clone()?;
            let lights = scene.lights().iter().copied().chain(environment.sun());
            let lights = lights.collect();
            let scene = scene.with_lights(lights);
            Ok(Self(scene.with_environment(Some(Arc::new(environment)))))
        };
        guarded(|| py.detach(lit))?
    }

    /// The names of what the identifiers of a channel stand for: objects, nodes, meshes or
    /// materials.
    fn names(&self, py: Python<'_>, channel: &str) -> Outcome<Vec<String>> {
        let catalog = guarded(|| py.detach(|| self.0.catalog()))?;
        let names = match channel {
            "node" => catalog.nodes(),
            "mesh" => catalog.meshes(),
            "material" => catalog.materials(),
            _ => {
                let objects = self.0.objects().iter();
                return Ok(objects.map(|object| object.name().to_owned()).collect());
            }
        };
        Ok(names.iter().map(ToString::to_string).collect())
    }

    /// The direction upwards where by `convention` it is +y or +z, as far as the meshes tell.
    fn likely_up(&self, py: Python<'_>, convention: [f64; 3]) -> Outcome<[f64; 3]> {
        let up = run(py, 0, |_| Ok(self.0.likely_up(DVec3::from(convention))))?;
        Ok(up.to_array())
    }

    /// The two corners of the box around all objects, or `None`.
    fn bounds(&self, py: Python<'_>) -> Outcome<Option<[[f64; 3]; 2]>> {
        let bounds = guarded(|| py.detach(|| self.0.bounds()))?;
        let corners = [bounds.low.to_array(), bounds.high.to_array()];
        Ok((!bounds.is_empty()).then_some(corners))
    }
}

/// The index of the first of some transforms, (n, 4, 4), that cannot be undone, and why.
#[pyfunction]
pub(crate) fn check_transforms(
    rows: PyReadonlyArray3<'_, f64>,
) -> Outcome<Option<(usize, String)>> {
    let rows = rows.as_slice()?;
    let wrong = transforms(rows).iter().map(transform).enumerate();
    let mut wrong = wrong.filter_map(|(k, made)| Some((k, made.err()?.to_string())));
    Ok(wrong.next())
}

/// Arrays of transforms as the rows of each.
fn transforms(rows: &[f64]) -> &[[[f64; 4]; 4]] {
    rows.as_chunks::<4>().0.as_chunks::<4>().0
}

fn transform(rows: &[[f64; 4]; 4]) -> firsthit::Result<Transform> {
    let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
    let matrix = DMat3::from_cols(column(0), column(1), column(2));
    Transform::new(DAffine3::from_mat3_translation(matrix, column(3)))
}

/// The materials of objects, by the list that they come from: objects that share that share them.
type Materials = HashMap<*mut PyObject, Arc<[Material]>>;

fn object_in(object: &ObjectIn<'_>, known: &mut Materials) -> Outcome<Object> {
    let ObjectIn(shape, name, rows, materials, mask, seen, [node, mesh]) = object;
    let (is_hidden, is_removed) = *seen;
    let mut object = Object::new(shape.0.clone()).named(name.clone());
    if let Some(rows) = rows {
        object = object.placed(transform(&rows.0)?);
    }
    let materials = match known.entry(materials.as_ptr()) {
        Entry::Occupied(known) => Arc::clone(known.get()),
        Entry::Vacant(new) => {
            let all: Vec<MaterialIn<'_>> = materials.extract()?;
            let all: Vec<Material> = all.iter().map(material).collect::<Outcome<_>>()?;
            Arc::clone(new.insert(all.into()))
        }
    };
    let object = object.masked(*mask).hidden(is_hidden).removed(is_removed);
    let object = object.from_node(label(node.as_ref()));
    let object = object.from_mesh(label(mesh.as_ref()));
    Ok(object.with_materials(materials))
}
