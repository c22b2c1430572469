//! Files that hold scenes, taken apart into what Python makes a scene from.

use std::path::PathBuf;
use std::sync::Arc;

use firsthit::fhs;
use firsthit::load::{LoadSettings, Loaded};
use firsthit::render::SAMPLES;
use firsthit::scene::Label;
use firsthit::world::{NamedCamera, World};
use firsthit::{Background, DAffine3, Light, Object, Shader, Shape};
use pyo3::prelude::*;

use crate::camera::{Camera, ViewOut, view_out};
use crate::errors::raise;
use crate::frame::{background_in, shader_in};
use crate::material::{MaterialOut, Texels, material_out};
use crate::run::run;
use crate::scene::{LabelTuple, Scene};
use crate::shape::Mesh;

/// A shape: the number of a mesh, or a kind and its numbers in the order of Python's arguments.
#[derive(IntoPyObject)]
enum ShapeOut {
    Mesh(usize),
    Analytic(&'static str, Vec<f64>),
}

/// Name, shape, the rows of the transform, materials, mask, whether it is hidden and whether it was removed, the labels of its node
/// and its mesh.
type ObjectOut = (
    String,
    ShapeOut,
    Option<[[f64; 4]; 4]>,
    Vec<MaterialOut>,
    (u32, bool, bool),
    (Option<LabelTuple>, Option<LabelTuple>),
);

/// Name; what it is made from; whether rows, columns and width are the file's own.
type CameraOut = (String, ViewOut, bool);

/// Kind, direction or position, colour or intensity; of a spot light its direction and its inner and outer angle.
type LightOut = (
    &'static str,
    [f64; 3],
    [f64; 3],
    Option<([f64; 3], [f64; 2])>,
);

/// The shader's name, Lambert's ambient light, its shadows, samples.
type ShadingOut = (&'static str, Option<[f64; 3]>, bool, u32);

/// All that a file holds.
#[derive(IntoPyObject)]
pub(crate) struct ModelOut {
    meshes: Vec<Mesh>,
    textures: Vec<Texels>,
    objects: Vec<ObjectOut>,
    cameras: Vec<CameraOut>,
    lights: Vec<LightOut>,
    /// One colour, or horizon, zenith and up.
    background: Option<Vec<[f64; 3]>>,
    shading: Option<ShadingOut>,
    /// Whether the first camera is the one to look through.
    has_view: bool,
    up: [f64; 3],
    up_is_guessed: bool,
    warnings: Vec<String>,
    /// Where the file holds it built.
    scene: Option<Scene>,
}

/// Reads a file.
#[pyfunction]
pub(crate) fn load(
    py: Python<'_>,
    path: PathBuf,
    strict: bool,
    max_memory: u64,
    max_texture: u32,
) -> PyResult<ModelOut> {
    let settings = LoadSettings {
        strict,
        max_memory,
        max_texture,
        verify: false,
    };
    let load = || firsthit::load::load(&path, &settings);
    run(py, 0, |_| load().and_then(with_lit_scene)).map(taken_apart)
}

/// Opens a built scene.
#[pyfunction]
pub(crate) fn open(py: Python<'_>, path: PathBuf, verify: bool) -> PyResult<ModelOut> {
    let open = || fhs::open(&path, verify);
    run(py, 0, |_| open().and_then(with_lit_scene)).map(taken_apart)
}

/// Makes the scene of a file that holds one built that of all its objects and lights.
fn with_lit_scene(mut loaded: Loaded) -> firsthit::Result<Loaded> {
    if let Some(built) = &loaded.scene {
        let scene = built.with_objects(loaded.world.objects.clone())?;
        loaded.scene = Some(scene.with_lights(loaded.world.lights.clone()));
    }
    Ok(loaded)
}

/// Saves a built scene with the cameras, the background (see `background_in`) and the shading of a scene in Python, whether the
/// first camera is the one to look through, which way is up, and whether that is guessed.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "a scene's parts, sent by the Python half alone"
)]
pub(crate) fn save(
    py: Python<'_>,
    path: PathBuf,
    scene: &Scene,
    cameras: Vec<CameraIn<'_>>,
    background: Option<Vec<[f64; 3]>>,
    shading: Option<ShadingIn>,
    has_view: bool,
    up: [f64; 3],
    up_is_guessed: bool,
) -> PyResult<()> {
    let shader = |shading: &ShadingIn| {
        let ShadingIn(name, ambient, shadows, _) = shading;
        shader_in(name, *ambient, *shadows).map_err(|error| raise(py, &error))
    };
    let world = World {
        cameras: cameras.iter().map(CameraIn::named).collect(),
        lights: scene.0.lights().to_vec(),
        has_view,
        background: background.as_deref().map(background_in),
        shader: shading.as_ref().map(shader).transpose()?,
        samples: shading.map(|ShadingIn(.., samples)| samples),
        up: up.into(),
        up_is_guessed,
        ..World::default()
    };
    run(py, 0, |stop| fhs::save(&path, &scene.0, &world, stop))
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

/// The shader's name, Lambert's ambient light if not the usual one, its shadows, samples.
#[derive(FromPyObject)]
pub(crate) struct ShadingIn(String, Option<[f64; 3]>, bool, u32);

fn taken_apart(loaded: Loaded) -> ModelOut {
    let Loaded {
        world,
        warnings,
        scene,
        ..
    } = loaded;
    let model = &world;
    let (mut meshes, mut textures) = (Shared::default(), Shared::default());
    let mut object_out = |object: &Object| {
        let materials = object.materials().iter();
        let materials = materials
            .map(|material| material_out(material, |texture| textures.number(texture)))
            .collect();
        let transform = object.transform();
        let rows = (!transform.is_identity()).then(|| rows(transform.world_from_object()));
        let shape = shape_out(object.shape(), |mesh| meshes.number(mesh));
        let seen = (object.mask(), object.is_hidden(), object.is_removed());
        let labels = (label_out(object.node()), label_out(object.mesh_label()));
        (
            object.name().to_owned(),
            shape,
            rows,
            materials,
            seen,
            labels,
        )
    };
    let objects = model.objects.iter().map(&mut object_out).collect();
    ModelOut {
        objects,
        meshes: meshes.list.into_iter().map(Mesh).collect(),
        textures: textures.list.into_iter().map(Texels).collect(),
        cameras: model.cameras.iter().map(camera_out).collect(),
        lights: model.lights.iter().map(light_out).collect(),
        background: model.background.map(background_out),
        shading: shading_out(model),
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

/// Things that many share, each once, by number.
struct Shared<T> {
    list: Vec<Arc<T>>,
    numbers: std::collections::HashMap<*const T, usize>,
}

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self {
            list: Vec::new(),
            numbers: std::collections::HashMap::new(),
        }
    }
}

impl<T> Shared<T> {
    fn number(&mut self, thing: &Arc<T>) -> usize {
        *self.numbers.entry(Arc::as_ptr(thing)).or_insert_with(|| {
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
        Shape::Plane(plane) => (
            "plane",
            [plane.point(), plane.facing()]
                .map(|v| v.to_array())
                .concat(),
        ),
        Shape::Disc(disc) => {
            let vectors = [disc.center(), disc.facing()]
                .map(|v| v.to_array())
                .concat();
            ("disc", [vectors, vec![disc.radius()]].concat())
        }
        Shape::Box(cuboid) => (
            "box",
            [cuboid.low(), cuboid.high()].map(|v| v.to_array()).concat(),
        ),
        Shape::Cylinder(cylinder) => {
            let vectors = [cylinder.bottom(), cylinder.top()]
                .map(|v| v.to_array())
                .concat();
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

fn light_out(light: &Light) -> LightOut {
    match *light {
        Light::Directional { direction, color } => {
            ("directional", direction.to_array(), color.to_array(), None)
        }
        Light::Point {
            position,
            intensity,
        } => ("point", position.to_array(), intensity.to_array(), None),
        Light::Spot {
            position,
            direction,
            intensity,
            inner_angle,
            outer_angle,
        } => {
            let cone = (direction.to_array(), [inner_angle, outer_angle]);
            let (position, intensity) = (position.to_array(), intensity.to_array());
            ("spot", position, intensity, Some(cone))
        }
    }
}

fn shading_out(model: &World) -> Option<ShadingOut> {
    if model.shader.is_none() && model.samples.is_none() {
        return None;
    }
    let shader = model.shader.clone().unwrap_or_default();
    let (ambient, shadows) = match &shader {
        Shader::Lambert(lambert) => (Some(lambert.ambient.to_array()), lambert.shadows),
        _ => (None, true),
    };
    let samples = model.samples.unwrap_or(SAMPLES);
    Some((shader.name(), ambient, shadows, samples))
}

pub(crate) fn background_out(background: Background) -> Vec<[f64; 3]> {
    match background {
        Background::Transparent => Vec::new(),
        Background::Uniform(color) => vec![color.to_array()],
        Background::Gradient {
            horizon,
            zenith,
            up,
        } => [horizon, zenith, up]
            .map(|vector| vector.to_array())
            .to_vec(),
    }
}
