//! Makes a scene of a file.

use std::path::Path;

use firsthit::error::escaped;
use firsthit::load::{self, LoadSettings, load_watched};
use firsthit::scene::{Build, BuildSettings};
use firsthit::world::World;
use firsthit::{Color, Object, Scene};

use crate::args::{LoadArgs, PickArgs, SceneArgs};
use crate::failure::Failure;
use crate::hints::meant;
use crate::progress::Progress;

/// A scene with what its file says beside it.
pub(crate) struct Loaded {
    pub(crate) scene: Scene,
    pub(crate) warnings: Vec<String>,
    /// The rest of the file's world: its objects are in the scene.
    pub(crate) model: World,
    /// See [`load::Loaded::variants`].
    pub(crate) variants: Vec<String>,
    /// See [`load::Loaded::vertices`].
    pub(crate) vertices: Option<u64>,
}

/// The build settings of a command that shoots no rays, if it builds any trees.
pub(crate) const NO_RAYS: BuildSettings = BuildSettings { build: Build::Auto, rays: Some(0) };

/// Reads a 3D file.
pub(crate) fn read(
    path: &Path,
    args: &LoadArgs,
    build: BuildSettings,
    progress: &Progress,
) -> Result<Loaded, Failure> {
    read_with(path, &settings(path, args), |_| build, None, progress)
}

/// Reads a 3D file that about so many rays are shot at, and picks its objects.
pub(crate) fn read_picked(
    path: &Path,
    args: &SceneArgs,
    rays: Option<u64>,
    progress: &Progress,
) -> Result<Loaded, Failure> {
    read(path, &args.load, args.trees.settings(rays), progress)?.picked(&args.pick)
}

/// The settings of the arguments for the file at `path`.
pub(crate) fn settings(path: &Path, args: &LoadArgs) -> LoadSettings {
    let mut resources = args.resources.clone();
    if args.allow_parent {
        let folder = path.parent().filter(|folder| *folder != Path::new(""));
        let folder = folder.unwrap_or(Path::new("."));
        // Canonical: what is above a link is not what is above the folder that it leads to.
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        resources.push(folder.join(".."));
    }
    LoadSettings {
        resources,
        scale: args.units.or(args.scale).unwrap_or(1.0),
        strict: args.strict,
        max_memory: args.max_memory,
        max_texture: args.max_texture,
        variant: args.variant.clone(),
        ..LoadSettings::default()
    }
}

/// Reads a file with settings that are no arguments; `neutral` is the colour of objects that have
/// none. The build settings may depend on the file's world.
pub(crate) fn read_with(
    path: &Path,
    settings: &LoadSettings,
    build: impl FnOnce(&World) -> BuildSettings,
    neutral: Option<Color>,
    progress: &Progress,
) -> Result<Loaded, Failure> {
    let load::Loaded { world: mut model, mut warnings, variants, vertices, scene: built, .. } =
        load_watched(path, settings, progress)?;
    let is_neutral = |object: &Object| object.materials().is_empty();
    if neutral.is_some() && !model.objects.iter().any(is_neutral) {
        let why = "--color does nothing here: every object has a material of its own";
        warnings.push(why.to_owned());
    }
    let build = build(&model);
    let has_trees = |built: &Scene| built.objects().len() == model.objects.len();
    if build.build != Build::Auto && built.as_ref().is_some_and(has_trees) {
        warnings.push("--build does nothing here: the file has its trees".to_owned());
    }
    let objects = std::mem::take(&mut model.objects).into_iter().map(|object| match neutral {
        Some(color) if object.materials().is_empty() => object.colored(color),
        _ => object,
    });
    let objects = objects.collect();
    let scene = match built {
        // Trees that the file does not hold are built.
        Some(built) => built.with_build(build).with_objects_watched(objects, progress)?,
        None => Scene::build_watched(objects, build, progress)?,
    };
    Ok(Loaded {
        // The fingerprint is that of the file, with its light.
        scene: scene.with_lights(model.lights.clone()).with_environment(model.environment.clone()),
        warnings,
        model,
        variants,
        vertices,
    })
}

impl Loaded {
    /// Refuses a cloud of points without any surface, of which every picture is empty.
    pub(crate) fn check_surfaces(&self, path: &Path) -> Result<(), Failure> {
        let mut points = 0;
        for object in self.scene.objects() {
            match object.mesh() {
                Some(mesh) if mesh.triangles().is_empty() => points += mesh.positions().len(),
                _ => return Ok(()),
            }
        }
        if points == 0 {
            return Ok(());
        }
        let path = escaped(path);
        Err(Failure::bad_input(format!(
            "{path}: {points} points without a face, and so nothing to see; MeshLab and Open3D make a mesh of a cloud"
        )))
    }

    /// The scene without the objects that the arguments leave out, and with translucent surfaces
    /// cut out as they say.
    pub(crate) fn picked(mut self, args: &PickArgs) -> Result<Self, Failure> {
        let objects = self.scene.objects();
        let mut is_hidden = vec![!args.only.is_empty(); objects.len()];
        for (names, hide) in [(&args.only, false), (&args.hide, true)] {
            for name in names {
                for identifier in called(objects, name)? {
                    is_hidden[identifier] = hide;
                }
            }
        }
        let hidden = is_hidden.iter().enumerate().filter(|(_, hidden)| **hidden);
        let hidden: Vec<_> = hidden.map(|(identifier, _)| (identifier, true)).collect();
        if !hidden.is_empty() {
            self.scene.hide_objects(&hidden)?;
        }
        if let Some(cutoff) = args.blend_below {
            if !self.scene.has_translucent() {
                let why = "--blend-below does nothing here: no material is translucent";
                self.warnings.push(why.to_owned());
            }
            self.scene = self.scene.with_blend_below(cutoff)?;
        }
        Ok(self)
    }
}

/// The objects with a name, or else the one with that identifier.
pub(crate) fn called(objects: &[Object], name: &str) -> Result<Vec<usize>, Failure> {
    let named = objects.iter().enumerate();
    let named = named.filter(|(_, object)| object.name() == name);
    let named: Vec<usize> = named.map(|(identifier, _)| identifier).collect();
    let identifier = name.parse().ok().filter(|&k: &usize| k < objects.len());
    match (named.is_empty(), identifier) {
        (false, _) => Ok(named),
        (true, Some(identifier)) => Ok(vec![identifier]),
        (true, None) => Err(Failure::usage(format!(
            "there is no object {name:?}; firsthit info lists the {} there are{}",
            objects.len(),
            meant(name, objects.iter().map(Object::name))
        ))),
    }
}

/// Whether a file's name says that it is a 3D file; one that is packed is.
pub(crate) fn has_model_extension(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let extension = extension.to_ascii_lowercase();
    extension == "gz" || load::extensions().any(|known| known == extension)
}
