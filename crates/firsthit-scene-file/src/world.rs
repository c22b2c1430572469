//! A scene as plain data, before anything is built from it: the type that loaders return.

use std::path::PathBuf;
use std::sync::Arc;

use crate::edge::Edges;
use crate::error::Result;
use crate::geometry::summary::{Few, summary};
use crate::geometry::{DVec3, DisplayTransform};
use crate::io::Model;
use crate::scene::{Environment, Light, Object, Scene};
use crate::shade::Appearance;

pub(crate) mod loaded;

pub use crate::io::NamedCamera;
pub(crate) use loaded::{Loaded, WorldFormat, unknown_variant};

/// Everything that a scene is made from: objects, cameras, lights, a background, and how to shade.
///
/// [`load()`](crate::load::load()) returns one in a [`Loaded`]. [`World::into_scene`] builds the
/// [`Scene`] that rays are shot at.
#[derive(Clone, Default)]
pub struct World {
    /// The objects, in the order of their identifiers. Those without materials got no colour from
    /// the file.
    pub objects: Vec<Object>,
    /// The cameras, in the file's order.
    pub cameras: Vec<NamedCamera>,
    /// The lights.
    pub lights: Vec<Light>,
    /// Whether the first camera is the default one: scene files say how they are to be seen, models
    /// only how they can be.
    pub has_view: bool,
    /// The appearance of pictures, as far as the file says.
    pub appearance: Appearance,
    /// The light from all around, if the file has any.
    pub environment: Option<Arc<Environment>>,
    /// The display of colours in PNGs, as the file says; by default, unchanged.
    pub display: DisplayTransform,
    /// The lines along edges over pictures, if the file asks for them.
    pub edges: Option<Edges>,
    /// The outputs that the file asks for.
    pub outputs: Vec<Output>,
    /// The direction upwards: as the scene file says, else by the format's rule or convention. +y
    /// for glTF and OBJ, +z for STL and PLY. Zero where nothing says so, as in `World::default()`:
    /// then +z.
    pub up: DVec3,
    /// Whether `up` is only a convention, as for OBJ, STL and PLY. glTF has a rule.
    pub up_is_guessed: bool,
}

// The first objects, and counts.
summary!(
    World, "World", |world| "objects": Few(&world.objects), "cameras": world.cameras.len(), "lights": world.lights.len(),
    "up": world.up
);

impl World {
    /// The world of a model: how it looks is not said.
    pub(crate) fn of(model: Model) -> Self {
        Self {
            objects: model.objects,
            cameras: model.cameras,
            lights: model.lights,
            up: model.up,
            up_is_guessed: model.up_is_guessed,
            ..Self::default()
        }
    }

    /// The scene of the objects and the lights, with [`Scene::up`] as the file says, or as
    /// [`Scene::likely_up`] guesses if it does not say. Cameras, background and the rest are
    /// dropped: take them before.
    ///
    /// ```
    /// use firsthit::world::World;
    /// use firsthit::{DVec3, Object, Sphere};
    ///
    /// let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0)?);
    /// let scene = World { objects: vec![ball], ..World::default() }.into_scene()?;
    /// assert_eq!((scene.objects().len(), scene.up()), (1, DVec3::Z));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::new`].
    pub fn into_scene(self) -> Result<Scene> {
        self.into_scene_after(None)
    }

    /// The scene of the world; parts that it has in common with a scene `before` are not built
    /// again.
    pub(crate) fn into_scene_after(mut self, before: Option<&Scene>) -> Result<Scene> {
        let objects = std::mem::take(&mut self.objects);
        let scene = match before {
            Some(before) => before.with_objects(objects)?,
            None => Scene::new(objects)?,
        };
        let up = self.up_in(&scene);
        let lit = scene.with_lights(self.lights);
        Ok(lit.with_environment(self.environment).with_up(up))
    }

    /// The direction upwards in `scene`, the scene of the objects: as the file says, or as
    /// [`Scene::likely_up`] guesses if it does not say.
    pub fn up_in(&self, scene: &Scene) -> DVec3 {
        let up = if self.up == DVec3::ZERO { DVec3::Z } else { self.up };
        if self.up_is_guessed { scene.likely_up(up) } else { up }
    }
}

/// An output that a scene file asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    /// The path, in the scene file's folder or below. `{channel}` stands for a channel's name.
    pub path: PathBuf,
    /// The channels' names, at least one.
    pub channels: Vec<String>,
}
