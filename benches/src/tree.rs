//! Building: time and memory.

use rayon::ThreadPool;

use crate::embree::{self, Device};
use crate::firsthit_side;
use crate::measure::{self, Timing};
use crate::memory;
use crate::row::Row;
use crate::scenes::BenchScene;
use crate::settings::Settings;

/// The trees of both sides over one scene, and what they cost.
#[derive(Debug)]
pub(crate) struct Trees<'a> {
    pub(crate) firsthit: firsthit::Scene,
    pub(crate) embree: Option<EmbreeTrees<'a>>,
    /// Nanoseconds for each triangle.
    pub(crate) firsthit_build: Timing,
    /// The time of refitting the tree to its triangles with their vertices moved a little.
    pub(crate) firsthit_refit: Timing,
    /// The bytes of the trees, for each triangle.
    pub(crate) firsthit_bytes: f64,
    /// The bytes of all that the scene holds beside the meshes it was made from.
    pub(crate) firsthit_held: isize,
    /// The speedup of two threads that build.
    pub(crate) speedup: f64,
}

/// Embree's trees.
#[derive(Debug)]
pub(crate) struct EmbreeTrees<'a> {
    pub(crate) plain: embree::Scene<'a>,
    pub(crate) robust: embree::Scene<'a>,
    /// The two once more, for filter functions, where a row wants them.
    gathering: Option<[embree::Scene<'a>; 2]>,
    /// Nanoseconds for each triangle, medium quality.
    pub(crate) build: Timing,
    pub(crate) bytes: f64,
}

impl EmbreeTrees<'_> {
    /// The tree that is traversed robustly, or not.
    pub(crate) fn of(&self, robust: bool) -> &embree::Scene<'_> {
        if robust { &self.robust } else { &self.plain }
    }

    /// The scene for rays with filter functions.
    pub(crate) fn gathering(&self, robust: bool) -> &embree::Scene<'_> {
        let both = self.gathering.as_ref().expect("the row is measured");
        &both[usize::from(robust)]
    }
}

/// Builds are long and steady: they take no more rounds than this.
const MOST_ROUNDS: u32 = 3;

/// Builds the trees of both sides, in turns. Triangle buffers are given to both beforehand.
pub(crate) fn measure<'a>(
    scene: &'a BenchScene,
    device: Option<&'a Device<'_>>,
    settings: &Settings,
    pool: &ThreadPool,
) -> Result<Trees<'a>, String> {
    let before = memory::held();
    let firsthit = firsthit_side::build(&scene.objects)?;
    let firsthit_held = memory::held() - before;
    let triangles = scene.model.triangles();
    let rounds = settings.rounds.min(MOST_ROUNDS);
    let mut ours = || drop(firsthit_side::build(&scene.objects));
    let moved = firsthit_side::moved(&scene.objects)?;
    let mut refit = || drop(firsthit.with_objects(moved.clone()));
    let mut theirs = || drop(device.map(|device| device.scene(&scene.model, false, false)));
    let times = measure::in_turns(rounds, triangles, &mut [&mut ours, &mut theirs, &mut refit]);
    let speedup = measure::speedup(rounds, pool, &|| {
        drop(firsthit_side::build(&scene.objects));
    });
    let embree = match device {
        None => None,
        Some(device) => {
            let tree = |robust, filters| device.scene(&scene.model, robust, filters);
            let (plain, robust) = (tree(false, false)?, tree(true, false)?);
            let gathering = if settings.rows().contains(&Row::AllHits) {
                Some([tree(false, true)?, tree(true, true)?])
            } else {
                None
            };
            let bytes = plain.bytes as f64 / triangles as f64;
            Some(EmbreeTrees { plain, robust, gathering, build: times[1], bytes })
        }
    };
    Ok(Trees {
        firsthit_bytes: firsthit.tree_bytes() as f64 / triangles as f64,
        firsthit_held,
        firsthit,
        embree,
        firsthit_build: times[0],
        firsthit_refit: times[2],
        speedup,
    })
}
