//! Viewers of files with default options.

use firsthit::camera::{Aim, Description};
use firsthit::load::Loaded;
use firsthit::shade::{Appearance, BACKGROUND, Lambert, Shader};
use firsthit::world::World;
use firsthit::{Camera, Result, Scene, example};

use crate::viewer::Viewer;

impl Viewer {
    /// The viewer that `firsthit view` shows of a file without options: through the file's camera
    /// if it says that it is to be looked through, else framed; in the file's light, or else in the
    /// automatic one.
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::new`] and [`Description::camera`].
    pub fn of_file(title: impl Into<String>, loaded: Loaded) -> Result<Self> {
        let Loaded { world: mut model, warnings, scene: built, .. } = loaded;
        let objects = std::mem::take(&mut model.objects);
        let scene = match built {
            Some(built) => built.with_objects(objects)?,
            None => Scene::new(objects)?,
        };
        let camera = camera(&model, &scene)?;
        let up = model.up_in(&scene);
        let scene = scene.with_lights(model.lights);
        let scene = scene.with_environment(model.environment).with_up(up);
        let appearance = Appearance {
            background: Some(model.appearance.background.unwrap_or(BACKGROUND)),
            ..model.appearance
        };
        let viewer = Self::new(title, scene, appearance, &camera)?;
        Ok(viewer.shown(model.display, model.edges).warned(warnings))
    }

    /// The embedded example, as `firsthit demo` shows it.
    ///
    /// # Errors
    ///
    /// None that its constants could cause.
    pub fn of_example() -> Result<Self> {
        let appearance = Appearance {
            shader: Some(Shader::Lambert(Lambert::default())),
            background: Some(example::background()),
            ..Appearance::default()
        };
        let camera = example::camera(480, 640)?;
        Self::new("demo", example::scene()?, appearance, &camera)
    }
}

/// The camera that the page begins with.
fn camera(model: &World, scene: &Scene) -> Result<Camera> {
    let first = model.cameras.first().filter(|_| model.has_view);
    let described = first.map_or_else(Description::default, |camera| camera.described(None));
    // With a position or an aim, up is the format's convention: it must not depend on the model.
    let is_open = described.position.is_none() && !matches!(described.aim, Some(Aim::Along(_)));
    let up = if is_open { model.up_in(scene) } else { model.up };
    described.camera(scene.bounds(), |direction| scene.support(direction), up)
}
