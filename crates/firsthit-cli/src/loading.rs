//! From a file to a scene.

use std::path::Path;

use firsthit::io::{LoadSettings, Model, load};
use firsthit::{Color, Object, Scene};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::args::{LoadArgs, RunArgs};
use crate::failure::Failure;

/// A scene with what its file says beside it.
pub(crate) struct Loaded {
    pub(crate) scene: Scene,
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
        max_memory: args.max_memory,
        max_texture: args.max_texture,
    };
    let mut model = load(path, &settings)?;
    let is_neutral = |object: &Object| object.materials().is_empty();
    if neutral.is_some() && !model.objects.iter().any(is_neutral) {
        let why = "--color does nothing here: every object has a material of its own";
        model.warnings.push(why.to_owned());
    }
    let objects = std::mem::take(&mut model.objects)
        .into_iter()
        .map(|object| match neutral {
            Some(color) if object.materials().is_empty() => object.colored(color),
            _ => object,
        });
    Ok(Loaded {
        scene: Scene::new(objects.collect())?,
        warnings: std::mem::take(&mut model.warnings),
        model,
    })
}

/// Runs `work` with as many threads as asked for.
pub(crate) fn with_threads<T: Send>(
    args: &RunArgs,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    pool(args.threads.map(usize::from))?.install(work)
}

/// Runs `work` with all cores.
pub(crate) fn with_all_cores<T: Send>(
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    pool(None)?.install(work)
}

/// So many threads, or as many as the system grants: the result is the same. The last resort is the thread
/// that runs already.
fn pool(threads: Option<usize>) -> Result<ThreadPool, Failure> {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let mut threads = threads.unwrap_or_else(cores);
    let builder = ThreadPoolBuilder::new;
    while threads > 0 {
        if let Ok(pool) = builder().num_threads(threads).build() {
            return Ok(pool);
        }
        threads /= 2;
    }
    let alone = builder().num_threads(1).use_current_thread().build();
    alone.map_err(|error| Failure::limit(format!("threads: {error}")))
}
