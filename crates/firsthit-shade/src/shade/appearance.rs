//! The default appearance of a picture: light, shader, ground and samples.

use std::sync::Arc;

use super::{Direct, Ground, Lambert, LightRig, Lighting, Shader, Shading};
use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::{Color, DVec3, Value, unit};
use crate::scene::{Background, Coloring, Environment, EnvironmentKind, Light, Scene};
use crate::shoot::Engine;

/// The appearance of a picture. A field that is `None` is decided by the scene and the camera.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Appearance {
    /// The shader of hits. By default [`Direct`]; with the light [`LightRig::Shoulder`],
    /// [`Lambert`].
    pub shader: Option<Shader>,
    /// Lights that go with the camera, in place of the scene's. By default there are some where
    /// nothing shines: [`Shader::default_rig`].
    pub rig: Option<LightRig>,
    /// The background of misses, unless that is the scene's environment.
    pub background: Option<Background>,
    /// Whether there is a ground that shadows fall on, under everything. By default there is one
    /// with lights that were chosen automatically, if the camera is above it and outside of the
    /// scene.
    pub ground: Option<bool>,
    /// Colours by numbers, in place of the surfaces' own. By default those of the scene, if it has
    /// any.
    pub coloring: Option<Coloring>,
    /// The number of samples of a pixel. By default [`default_samples`].
    pub samples: Option<u32>,
}

/// An [`Appearance`] with everything decided.
#[derive(Debug, Clone)]
pub struct Resolved {
    /// The scene with its light.
    pub scene: Scene,
    /// The shader of hits.
    pub shader: Shader,
    /// The direction upwards for the viewer.
    pub upwards: DVec3,
    /// The background of misses.
    pub background: Background,
    /// The ground.
    pub ground: Option<Ground>,
    /// The number of samples of a pixel.
    pub samples: u32,
    /// The choices that were made automatically.
    pub guessed: Vec<Guess>,
}

/// A choice that was made automatically.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guess {
    /// The choice, in words.
    pub what: &'static str,
    /// The setting that says otherwise: `light`, `shader` or `ground`.
    pub setting: &'static str,
}

/// The default fill light in the shadows of a scene whose lights are its own: as much as Lambert's
/// ambient light.
const FILL: Color = Color::splat(0.25);

/// The distance up to which things darken each other in a room, as a share of its diagonal:
/// farther, all of a closed room would be dark.
const SHARE_OF_ROOM: f64 = 0.25;

/// Said where lights that go with the camera would have walls between them and what it sees.
const NO_SHADOWS: Guess = of_light("no shadows of lights outside of the room");

impl Appearance {
    /// Decides what is open, for a camera; for another sensor there is none.
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::with_coloring`].
    pub fn resolve(&self, scene: &Scene, camera: Option<&Camera>) -> Result<Resolved> {
        let resolved = self.resolve_light(scene, camera);
        let Some(coloring) = self.coloring.clone() else {
            return Ok(resolved);
        };
        let scene = resolved.scene.with_coloring(Some(coloring))?;
        Ok(Resolved { scene, ..resolved })
    }

    #[expect(clippy::too_many_lines, reason = "one decision after the other")]
    fn resolve_light(&self, scene: &Scene, camera: Option<&Camera>) -> Resolved {
        let mut guessed = Vec::new();
        let up = world_up(scene, camera);
        let is_dark = scene.is_unlit();
        let rig = self.rig.or_else(|| {
            let usual = (self.shader.as_ref()).map_or(Some(LightRig::Auto), Shader::default_rig);
            usual.filter(|_| is_dark)
        });
        let is_rig_guessed = rig.is_some() && self.rig.is_none();
        let mut shader = self.shader.clone().unwrap_or_else(|| default_shader(rig));
        let is_filled = rig.is_none() && self.shader.is_none() && scene.environment().is_none();
        let is_within = camera.is_some_and(|camera| is_within(scene, camera));
        let lit = match (rig, camera) {
            (Some(rig), Some(camera)) => {
                let Lighting { lights, environment } = rig.lighting(camera, up);
                if is_rig_guessed {
                    guessed.push(of_rig(rig));
                }
                borrowing(scene, lights, environment)
            }
            // Without a camera there is light from all around alone.
            (Some(_), None) => borrowing(scene, vec![], Some(fill(LightRig::WHITE))),
            (None, _) if is_filled => {
                let what = "some light from all around";
                guessed.push(Guess { what, setting: "shader" });
                scene.clone().with_borrowed_environment(Some(fill(FILL)))
            }
            (None, _) => scene.clone(),
        };
        let reach = SHARE_OF_ROOM * scene.bounds().size().length();
        // Walls would keep all of it out.
        if is_within
            && is_filled
            && let Shader::Direct(direct) = &mut shader
        {
            direct.reach = direct.reach.min(reach);
        }
        if is_within && rig.is_some() {
            match &mut shader {
                Shader::Path(_) => guessed.push(of_light("light from outside of the room")),
                Shader::Direct(direct) => {
                    guessed.push(NO_SHADOWS);
                    direct.shadows = false;
                    direct.reach = direct.reach.min(reach);
                }
                // One that casts none has no such setting.
                shader => {
                    if shader.set("shadows", Value::Flag(false)).is_ok() {
                        guessed.push(NO_SHADOWS);
                    }
                }
            }
        }
        let ground = self.ground(
            (scene, up),
            camera,
            rig.is_some_and(|rig| rig != LightRig::Shoulder) && !is_within,
        );
        if ground.is_some() && self.ground.is_none() {
            guessed.push(Guess { what: "a ground for shadows", setting: "ground" });
        }
        let is_random = shader.is_random() || ground.is_some();
        Resolved {
            scene: lit,
            shader,
            upwards: camera.map_or_else(|| scene.up(), Camera::upwards),
            background: self.background.unwrap_or(BACKGROUND),
            ground,
            samples: self.samples.unwrap_or(default_samples(is_random)),
            guessed,
        }
    }

    fn ground(
        &self,
        (scene, up): (&Scene, DVec3),
        camera: Option<&Camera>,
        is_default: bool,
    ) -> Option<Ground> {
        if !self.ground.unwrap_or(is_default) {
            return None;
        }
        let ground = Ground::under(scene, up)?;
        let is_above = camera.is_none_or(|camera| ground.is_seen_from(camera.position()));
        (self.ground.is_some() || is_above).then_some(ground)
    }
}

impl Resolved {
    /// The [`Shade`](crate::shade::Shade) of the picture.
    pub fn shading<'a>(&'a self, engine: &'a dyn Engine) -> Shading<'a> {
        Shading {
            upwards: self.upwards,
            background: self.background,
            ground: self.ground,
            engine,
            ..self.shader.clone().on(&self.scene)
        }
    }
}

/// The default number of samples per pixel, of shaders that draw no numbers.
pub const SAMPLES: u32 = 4;

/// The default number of samples per pixel, of shaders that draw numbers.
pub const RANDOM_SAMPLES: u32 = 16;

/// The default number of samples per pixel, of shaders that draw numbers or do not.
pub const fn default_samples(is_random: bool) -> u32 {
    if is_random { RANDOM_SAMPLES } else { SAMPLES }
}

/// The default background of pictures.
pub const BACKGROUND: Background = Background::NEUTRAL;

/// The default shader, in lights that go with the camera if there are any.
pub fn default_shader(rig: Option<LightRig>) -> Shader {
    match rig {
        Some(LightRig::Shoulder) => Shader::Lambert(Lambert::default()),
        _ => Shader::Direct(Direct::default()),
    }
}

/// The direction upwards in the world that a camera looks at: its own up, or the scene's where it
/// looks straight up or down.
///
/// So a picture from a camera that is kept has the light and the ground that it had.
pub fn world_up(scene: &Scene, camera: Option<&Camera>) -> DVec3 {
    /// The cosine of two degrees and a half.
    const STRAIGHT: f64 = 0.999;
    let up = scene.up();
    match camera {
        Some(camera) if unit(camera.aim()).dot(unit(up)).abs() < STRAIGHT => camera.view().up,
        _ => up,
    }
}

/// Whether a camera is in a room: in the box around the scene, or with a picture of all around.
fn is_within(scene: &Scene, camera: &Camera) -> bool {
    let bounds = scene.bounds();
    let is_inside = !bounds.is_empty() && bounds.contains(camera.position());
    camera.lens().is_panorama() || is_inside
}

const fn of_light(what: &'static str) -> Guess {
    Guess { what, setting: "light" }
}

fn of_rig(rig: LightRig) -> Guess {
    of_light(match rig {
        LightRig::Shoulder => "light over the shoulder",
        _ => "automatic light",
    })
}

fn borrowing(scene: &Scene, lights: Vec<Light>, environment: Option<Arc<Environment>>) -> Scene {
    let lit = scene.clone().with_automatic_lights(lights);
    lit.with_borrowed_environment(environment)
}

/// Light that is the same from everywhere.
fn fill(color: Color) -> Arc<Environment> {
    Arc::new(Environment { is_seen: false, ..Environment::new(EnvironmentKind::Uniform(color)) })
}
