//! From a file to a scene.

use std::path::Path;

use firsthit::io::{LoadSettings, Model, load};
use firsthit::{Color, Scene};

use crate::args::{LoadArgs, RunArgs};
use crate::failure::Failure;

/// A scene with what its file says beside it.
pub(crate) struct Loaded {
    pub(crate) scene: Scene,
    pub(crate) up: firsthit::DVec3,
    pub(crate) warnings: Vec<String>,
    /// What else the file says: the model without its objects.
    pub(crate) model: Model,
}

/// Reads a 3D file; `neutral` is the colour of objects that have none.
pub(crate) fn read(
    path: &Path,
    args: &LoadArgs,
    neutral: Option<Color>,
) -> Result<Loaded, Failure> {
    let settings = LoadSettings {
        strict: args.strict,
        ..LoadSettings::default()
    };
    let mut model = load(path, &settings)?;
    let objects = std::mem::take(&mut model.objects)
        .into_iter()
        .map(|object| match neutral {
            Some(color) if object.materials().is_empty() => object.colored(color),
            _ => object,
        });
    Ok(Loaded {
        scene: Scene::new(objects.collect())?,
        up: model.up,
        warnings: std::mem::take(&mut model.warnings),
        model,
    })
}

/// Runs `work` with as many threads as asked for.
pub(crate) fn with_threads<T: Send>(
    args: &RunArgs,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let threads = args.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| Failure::limit(format!("threads: {error}")))?
        .install(work)
}
