//! Files that hold scenes, taken apart into what Python makes a scene from.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use firsthit::fhs;
use firsthit::load::{LoadSettings, Loaded, UNITS};
use firsthit::scene::Label;
use firsthit::shade::Appearance;
use firsthit::watch::Watch;
use firsthit::world::{NamedCamera, World};
use firsthit::{Background, DAffine3, Object, Shape};
use numpy::PyArray2;
use numpy::ndarray::arr2;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::camera::{Camera, ViewOut, view_out};
use crate::edges::{EdgesIn, EdgesOut, edges_out};
use crate::environment::{EnvironmentOut, environment_out};
use crate::errors::Outcome;
use crate::frame::DisplayIn;
use crate::material::{MaterialOut, Texels, material_out};
use crate::run::{Report, Stop, run_reported};
use crate::scene::{LabelTuple, Scene};
use crate::shading::{LightOut, ShadingIn, ShadingOut, light_out, shading_out};
use crate::shape::Mesh;

/// A shape: the number of a mesh, or a kind and its numbers in the order of Python's arguments.
#[derive(IntoPyObject)]
enum ShapeOut {
    Mesh(usize),
    Analytic(&'static str, Vec<f64>),
}

/// The labels of an object's node and of its mesh.
type LabelsOut = (Option<LabelTuple>, Option<LabelTuple>);

/// An object, as `ObjectIn` has it, but with the numbers of its mesh and of its materials.
type ObjectOut = (ShapeOut, String, Option<Py<PyArray2<f64>>>, usize, u32, (bool, bool), LabelsOut);

/// The objects of a file. Python makes its own of one when that is asked for.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Objects {
    list: Vec<Object>,
    /// The numbers of meshes and of lists of materials, by where they are in memory.
    meshes: HashMap<usize, usize>,
    looks: HashMap<usize, usize>,
}

impl Objects {
    pub(crate) fn object(&self, number: usize) -> PyResult<&Object> {
        let found = self.list.get(number);
        found.ok_or_else(|| PyIndexError::new_err(format!("the file has no object {number}")))
    }
}

#[pymethods]
impl Objects {
    fn __len__(&self) -> usize {
        self.list.len()
    }

    fn get(&self, py: Python<'_>, number: usize) -> PyResult<ObjectOut> {
        let object = self.object(number)?;
        let transform = object.transform();
        let rows = (!transform.is_identity()).then(|| rows(transform.world_from_object()));
        let rows = rows.map(|rows| PyArray2::from_owned_array(py, arr2(&rows)).unbind());
        Ok((
            shape_out(object.shape(), |mesh| self.meshes[&address(mesh)]),
            object.name().to_owned(),
            rows,
            self.looks[&object.materials().as_ptr().addr()],
            object.mask(),
            (object.is_hidden(), object.is_removed()),
            (label_out(object.node()), label_out(object.mesh_label())),
        ))
    }

    fn triangles(&self, number: usize) -> PyResult<usize> {
        self.object(number).map(Object::triangles)
    }
}

/// Name; what it is made from; whether rows, columns and width are the file's own.
type CameraOut = (String, ViewOut, bool);

/// All that a file holds.
#[derive(IntoPyObject)]
pub(crate) struct ModelOut {
    meshes: Vec<Mesh>,
    textures: Vec<Texels>,
    /// The materials that objects have.
    looks: Vec<Vec<MaterialOut>>,
    objects: Objects,
    cameras: Vec<CameraOut>,
    lights: Vec<LightOut>,
    environment: Option<EnvironmentOut>,
    /// One colour, or horizon, zenith and up.
    background: Option<Vec<[f64; 3]>>,
    shading: Option<ShadingOut>,
    /// The exposure in stops, and the tone map.
    display: (f64, &'static str),
    edges: Option<EdgesOut>,
    /// Whether the first camera is the one to look through.
    has_view: bool,
    up: [f64; 3],
    up_is_guessed: bool,
    warnings: Vec<String>,
    /// The built scene, where the file holds one.
    scene: Option<Scene>,
}

/// Reads a file.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the settings, one by one")]
pub(crate) fn load(
    py: Python<'_>,
    path: PathBuf,
    strict: bool,
    max_memory: u64,
    max_texture: u32,
    scale: f64,
    resources: Vec<PathBuf>,
    variant: Option<String>,
    report: Report<'_, '_>,
) -> Outcome<ModelOut> {
    let settings =
        LoadSettings { strict, max_memory, max_texture, verify: false, resources, scale, variant };
    let load =
        |stop: &Stop| with_lit_scene(firsthit::load::load_watched(&path, &settings, stop)?, stop);
    let loaded = run_reported(py, 0, report, load)?;
    Ok(taken_apart(loaded))
}

/// The units of lengths by name, as metres.
#[pyfunction]
pub(crate) fn units() -> Vec<(&'static str, f64)> {
    UNITS.to_vec()
}

/// Opens a built scene.
#[pyfunction]
pub(crate) fn open(
    py: Python<'_>,
    path: PathBuf,
    verify: bool,
    report: Report<'_, '_>,
) -> Outcome<ModelOut> {
    let open = |stop: &Stop| with_lit_scene(fhs::open_watched(&path, verify, stop)?, stop);
    let loaded = run_reported(py, 0, report, open)?;
    Ok(taken_apart(loaded))
}

/// Makes the scene of a file that holds one built that of all its objects, lights and its
/// environment.
fn with_lit_scene(mut loaded: Loaded, watch: &dyn Watch) -> firsthit::Result<Loaded> {
    if let Some(built) = &loaded.scene {
        let scene = built.with_objects_watched(loaded.world.objects.clone(), watch)?;
        let lit = scene.with_lights(loaded.world.lights.clone());
        loaded.scene = Some(lit.with_environment(loaded.world.environment.clone()));
    }
    Ok(loaded)
}

/// Saves a built scene with the cameras, the background (see `background_in`), the shading, the
/// display and the lines of edges of a scene in Python, whether the first camera is the one to look
/// through, which way is up, and whether that is guessed.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "a scene's parts, sent by the Python half alone")]
pub(crate) fn save(
    py: Python<'_>,
    path: PathBuf,
    scene: &Scene,
    cameras: Vec<CameraIn<'_>>,
    background: Option<Vec<[f64; 3]>>,
    shading: ShadingIn,
    display: DisplayIn,
    edges: Option<EdgesIn>,
    has_view: bool,
    up: [f64; 3],
    up_is_guessed: bool,
    report: Report<'_, '_>,
) -> Outcome<()> {
    let world = World {
        cameras: cameras.iter().map(CameraIn::named).collect(),
        lights: scene.0.lights().to_vec(),
        has_view,
        appearance: shading.appearance(background.as_deref())?,
        environment: scene.0.environment().cloned().map(Arc::new),
        display: display.transform()?,
        edges: edges.as_ref().map(EdgesIn::edges).transpose()?,
        up: up.into(),
        up_is_guessed,
        ..World::default()
    };
    run_reported(py, 0, report, |stop| fhs::save(&path, &scene.0, &world, stop))
}

/// Name, camera, whether rows, columns and width are the file's own.
#[derive(FromPyObject)]
pub(crate) struct CameraIn<'py>(String, PyRef<'py, Camera>, bool);

impl CameraIn<'_> {
    fn named(&self) -> NamedCamera {
        let Self(name, camera, has_size) = self;
        NamedCamera {
            name: name.clone(),
            own_name: String::new(),
            view: *camera.0.view(),
            has_size: *has_size,
            description: None,
        }
    }
}

fn taken_apart(loaded: Loaded) -> ModelOut {
    let Loaded { mut world, warnings, scene, .. } = loaded;
    let list = std::mem::take(&mut world.objects);
    let model = &world;
    let (mut meshes, mut textures) = (Shared::default(), Shared::default());
    let (mut looks, mut numbers) = (Vec::new(), HashMap::new());
    for object in &list {
        if let Some(mesh) = object.mesh() {
            meshes.number(mesh);
        }
        let materials = object.materials();
        numbers.entry(materials.as_ptr().addr()).or_insert_with(|| {
            let made = materials.iter();
            let made = made.map(|it| material_out(it, |texture| textures.number(texture)));
            looks.push(made.collect());
            looks.len() - 1
        });
    }
    ModelOut {
        looks,
        objects: Objects { list, meshes: meshes.numbers, looks: numbers },
        meshes: meshes.list.into_iter().map(Mesh).collect(),
        textures: textures.list.into_iter().map(Texels).collect(),
        cameras: model.cameras.iter().map(camera_out).collect(),
        lights: model.lights.iter().map(light_out).collect(),
        environment: model.environment.as_deref().map(environment_out),
        background: model.appearance.background.map(background_out),
        shading: shading_of(&model.appearance),
        display: (model.display.exposure, model.display.tone_map.name()),
        edges: model.edges.as_ref().map(edges_out),
        has_view: model.has_view,
        up: model.up.to_array(),
        up_is_guessed: model.up_is_guessed,
        warnings,
        scene: scene.map(Scene),
    }
}

fn label_out(label: Option<&Label>) -> Option<LabelTuple> {
    label.map(|label| (label.number, label.name.to_string()))
}

fn address<T>(thing: &Arc<T>) -> usize {
    Arc::as_ptr(thing).addr()
}

/// Things that many share, each once, by number.
struct Shared<T> {
    list: Vec<Arc<T>>,
    numbers: HashMap<usize, usize>,
}

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self { list: Vec::new(), numbers: HashMap::new() }
    }
}

impl<T> Shared<T> {
    fn number(&mut self, thing: &Arc<T>) -> usize {
        *self.numbers.entry(address(thing)).or_insert_with(|| {
            self.list.push(Arc::clone(thing));
            self.list.len() - 1
        })
    }
}

fn shape_out(shape: &Shape, mut number: impl FnMut(&Arc<firsthit::Mesh>) -> usize) -> ShapeOut {
    let (kind, numbers) = match shape {
        Shape::Mesh(mesh) => return ShapeOut::Mesh(number(mesh)),
        Shape::Sphere(sphere) => {
            let [x, y, z] = sphere.center().to_array();
            ("sphere", vec![x, y, z, sphere.radius()])
        }
        Shape::Plane(plane) => {
            ("plane", [plane.point(), plane.facing()].map(|v| v.to_array()).concat())
        }
        Shape::Disc(disc) => {
            let vectors = [disc.center(), disc.facing()].map(|v| v.to_array()).concat();
            ("disc", [vectors, vec![disc.radius()]].concat())
        }
        Shape::Box(cuboid) => ("box", [cuboid.low(), cuboid.high()].map(|v| v.to_array()).concat()),
        Shape::Cylinder(cylinder) => {
            let vectors = [cylinder.bottom(), cylinder.top()].map(|v| v.to_array()).concat();
            ("cylinder", [vectors, vec![cylinder.radius()]].concat())
        }
        Shape::Cone(cone) => {
            let vectors = [cone.bottom(), cone.top()].map(|v| v.to_array()).concat();
            let radii = vec![cone.bottom_radius(), cone.top_radius()];
            ("cone", [vectors, radii].concat())
        }
    };
    ShapeOut::Analytic(kind, numbers)
}

fn rows(affine: &DAffine3) -> [[f64; 4]; 4] {
    let (m, t) = (affine.matrix3, affine.translation);
    let row = |k: usize| [m.x_axis[k], m.y_axis[k], m.z_axis[k], t[k]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

fn camera_out(camera: &NamedCamera) -> CameraOut {
    (camera.name.clone(), view_out(&camera.view), camera.has_size)
}

fn shading_of(said: &Appearance) -> Option<ShadingOut> {
    let nothing = Appearance { background: said.background, ..Appearance::default() };
    (*said != nothing).then(|| {
        let (shader, coloring) = (said.shader.as_ref(), said.coloring.as_ref());
        shading_out(shader, said.rig, said.ground, said.samples, coloring)
    })
}

pub(crate) fn background_out(background: Background) -> Vec<[f64; 3]> {
    match background {
        Background::Transparent => Vec::new(),
        Background::Uniform(color) => vec![color.to_array()],
        Background::Gradient { horizon, zenith, up } => {
            [horizon, zenith, up].map(|vector| vector.to_array()).to_vec()
        }
    }
}
