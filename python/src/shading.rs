//! Lights and shaders: what they are, and their settings by name.

use firsthit::geometry::{Domain, Setting, Value};
use firsthit::sampling::Draws;
use firsthit::scene::Coloring;
use firsthit::shade::{Appearance, LightRig, Resolved};
use firsthit::{Camera, Light, Shader};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::colors::{ColorsIn, ColorsOut, coloring_in, coloring_out};
use crate::errors::Outcome;
use crate::frame::background_in;
use crate::run::run;
use crate::scene::Scene;
use crate::sensor::SensorIn;

/// A setting's value on its way in. A flag is no number.
#[derive(FromPyObject, Clone, Copy)]
pub(crate) enum ValueIn {
    Flag(bool),
    Number(f64),
    Vector([f64; 3]),
}

impl From<ValueIn> for Value {
    fn from(value: ValueIn) -> Self {
        match value {
            ValueIn::Flag(flag) => Self::Flag(flag),
            ValueIn::Number(number) => Self::Number(number),
            ValueIn::Vector(vector) => Self::Vector(vector.into()),
        }
    }
}

/// A setting's value on its way out. Tuples, since Python is to compare and hash them.
#[derive(IntoPyObject)]
pub(crate) enum ValueOut {
    Flag(bool),
    Number(f64),
    Vector((f64, f64, f64)),
}

impl From<Value> for ValueOut {
    fn from(value: Value) -> Self {
        match value {
            Value::Flag(flag) => Self::Flag(flag),
            Value::Number(number) => Self::Number(number),
            Value::Vector(vector) => Self::Vector(vector.into()),
        }
    }
}

pub(crate) type SettingsOut = Vec<(&'static str, ValueOut)>;

pub(crate) fn settings_out(settings: Vec<(&'static str, Value)>) -> SettingsOut {
    let settings = settings.into_iter();
    settings.map(|(name, value)| (name, value.into())).collect()
}

/// A light: its kind, and its settings.
#[derive(FromPyObject)]
pub(crate) struct LightIn(String, Vec<(String, ValueIn)>);

/// The light on its way out.
pub(crate) type LightOut = (&'static str, SettingsOut);

pub(crate) fn light_in(LightIn(kind, settings): &LightIn) -> firsthit::Result<Light> {
    let mut light = Light::named(kind)?;
    for (name, value) in settings {
        light.set(name, (*value).into())?;
    }
    Ok(light)
}

pub(crate) fn light_out(light: &Light) -> LightOut {
    (light.name(), settings_out(light.settings()))
}

/// The shader's name and its settings, the name of lights that go with the camera, whether there is
/// a ground, samples; each if it is said.
#[derive(FromPyObject, Default)]
pub(crate) struct ShadingIn(
    Option<String>,
    Vec<(String, ValueIn)>,
    Option<String>,
    Option<bool>,
    Option<u32>,
    Option<ColorsIn>,
);

/// The shading on its way out.
pub(crate) type ShadingOut = (
    Option<&'static str>,
    SettingsOut,
    Option<&'static str>,
    Option<bool>,
    Option<u32>,
    Option<ColorsOut>,
);

impl ShadingIn {
    pub(crate) fn appearance(
        &self,
        background: Option<&[[f64; 3]]>,
    ) -> firsthit::Result<Appearance> {
        let Self(name, settings, rig, ground, samples, colors) = self;
        let shader = name.as_deref().map(|name| shader(name, settings));
        Ok(Appearance {
            shader: shader.transpose()?,
            rig: rig.as_deref().map(str::parse).transpose()?,
            background: background.map(background_in),
            ground: *ground,
            samples: *samples,
            coloring: colors.as_ref().map(coloring_in).transpose()?,
        })
    }

    /// Resolves all settings, in a pool of threads, for the view of a sensor in a scene with that
    /// direction upwards.
    pub(crate) fn resolve(
        &self,
        scene: &firsthit::Scene,
        camera: Option<&Camera>,
        background: Option<&[[f64; 3]]>,
        up: [f64; 3],
    ) -> firsthit::Result<Resolved> {
        let scene = scene.clone().with_up(up.into());
        self.appearance(background)?.resolve(&scene, camera)
    }
}

fn shader(name: &str, settings: &[(String, ValueIn)]) -> firsthit::Result<Shader> {
    let mut shader = Shader::named(name)?;
    for (name, value) in settings {
        shader.set(name, (*value).into())?;
    }
    Ok(shader)
}

pub(crate) fn shading_out(
    shader: Option<&Shader>,
    rig: Option<LightRig>,
    ground: Option<bool>,
    samples: Option<u32>,
    coloring: Option<&Coloring>,
) -> ShadingOut {
    (
        shader.map(Shader::name),
        shader.map_or_else(Vec::new, |shader| settings_out(shader.settings())),
        rig.map(LightRig::name),
        ground,
        samples,
        coloring.map(coloring_out),
    )
}

/// Every setting of a shader with what is to be given for it: `flag`, `number`, `color` or
/// `vector`.
#[pyfunction]
pub(crate) fn shader_settings(name: &str) -> Vec<(&'static str, &'static str)> {
    let form = |setting: &Setting| match setting.domain {
        Domain::Flag => "flag",
        Domain::Color | Domain::Light => "color",
        Domain::Position | Domain::Direction => "vector",
        _ => "number",
    };
    let kind = Shader::KINDS.iter().find(|kind| kind.name == name);
    let list = kind.map_or(&[][..], |kind| kind.settings).iter();
    list.map(|setting| (setting.name, form(setting))).collect()
}

/// Refuses a light that cannot be.
#[pyfunction]
pub(crate) fn check_light(light: LightIn) -> Outcome<()> {
    light_in(&light)?;
    Ok(())
}

/// All settings of a shader, some of which are given; refuses what makes no sense.
#[pyfunction]
pub(crate) fn check_shader(name: &str, settings: Vec<(String, ValueIn)>) -> Outcome<SettingsOut> {
    let shader = shader(name, &settings)?;
    Ok(settings_out(shader.settings()))
}

/// The samples of a pixel.
#[pyfunction]
pub(crate) fn resolve(
    py: Python<'_>,
    scene: &Scene,
    camera: SensorIn<'_>,
    shading: ShadingIn,
    up: [f64; 3],
) -> Outcome<u32> {
    let (scene, camera) = (&scene.0, camera.sensor().camera());
    let resolved = run(py, 0, |_| shading.resolve(scene, camera, None, up))?;
    Ok(resolved.samples)
}

/// The numbers of some pixels' sample: `count` of the set of that number for each, one pixel after
/// the other.
#[pyfunction]
pub(crate) fn draws<'py>(
    py: Python<'py>,
    pixels: PyReadonlyArray1<'py, i64>,
    sample: u32,
    number: u32,
    count: usize,
) -> Outcome<Bound<'py, PyArray1<f64>>> {
    let pixels = pixels.as_slice()?;
    let mut drawn = Vec::with_capacity(pixels.len() * count);
    for &pixel in pixels {
        let four = Draws::new(pixel.cast_unsigned(), sample).skipped(number).four();
        drawn.extend_from_slice(&four[..count.min(4)]);
    }
    Ok(PyArray1::from_vec(py, drawn))
}
