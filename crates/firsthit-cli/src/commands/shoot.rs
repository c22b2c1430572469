use std::path::{Path, PathBuf};
use std::time::Instant;

use firsthit::channel::{ChannelKind, RAY};
use firsthit::image::{Holds, format_of};
use firsthit::render::work;
use firsthit::shoot::All;
use firsthit::watch::Watch as _;
use firsthit::{Rays as _, Scene};
use serde_json::json;

use super::ends;
use super::shoot_stream;
use super::shot::{Counts, shot, shot_all};
use super::sinks::{self, Sinks};
use crate::args::ShootArgs;
use crate::asked;
use crate::console::{counted, end_report, is_quiet, say, warn};
use crate::failure::Failure;
use crate::loading::{self, Loaded};
use crate::output;
use crate::progress::{Progress, RAYS};
use crate::rays::{self, Feed, Limits, RayArrays, RayLines};
use crate::threads::with_threads;

const DEFAULT_CHANNELS: [&str; 3] = ["t", "object", "primitive"];

/// The default channels where one of the files is a point cloud.
const CLOUD_CHANNELS: [&str; 5] = ["position", "normal", "t", "object", "primitive"];

/// The channels that were asked for, and those that the files cannot do without.
fn channels(args: &ShootArgs) -> Vec<String> {
    let is_cloud = |path: &PathBuf| format_of(path).is_ok_and(|f| f.holds == Holds::Points);
    let named = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    let asked: Vec<String> = match &args.channels[..] {
        [] if args.output.iter().any(is_cloud) => named(&CLOUD_CHANNELS),
        [] => named(&DEFAULT_CHANNELS),
        asked => asked.to_vec(),
    };
    asked::with_required(&asked, &args.output)
}

/// The channels that are computed: of all hits, first the numbers of their rays.
fn kinds(args: &ShootArgs) -> Result<Vec<&'static ChannelKind>, Failure> {
    let is_quiet = is_quiet();
    let mut kinds = output::kinds(&channels(args), output::ChannelSource::Rays, is_quiet)?;
    if several(args).is_some() {
        kinds.insert(0, RAY);
    }
    Ok(kinds)
}

/// The hits that are asked for, where these are not the first ones.
fn several(args: &ShootArgs) -> Option<All> {
    let nearest = args.nearest.map(|k| k as usize);
    (args.all || nearest.is_some()).then_some(All { nearest })
}

/// The source of rays.
enum RayInput {
    Arrays(RayArrays),
    /// Answered as they arrive, if they are text.
    Stdin(Feed),
}

/// The limits of the rays.
fn limits(args: &ShootArgs) -> Result<Limits, Failure> {
    let (t_min, t_max) = ends(args.t_min, args.t_max)?;
    Ok(Limits { t_min, t_max, cull: args.cull })
}

pub(crate) fn run(args: &ShootArgs, progress: &Progress) -> Result<(), Failure> {
    sinks::announce(&args.output);
    let several = several(args);
    let kinds = kinds(args)?;
    let inputs = [Some(&args.file), Some(&args.rays), args.directions.as_ref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
    let sinks = Sinks::new((&args.output, args.format), &inputs, &kinds)?;
    let started = Instant::now();
    with_threads(args.run.threads, || {
        let limits = limits(args)?;
        let source = source(args, &sinks, limits)?;
        let rays = source.count();
        let Loaded { scene, warnings, .. } =
            loading::read_picked(&args.file, &args.scene, rays, progress)?;
        sinks.check()?;
        kinds.iter().try_for_each(|kind| kind.check(&scene))?;
        warn(&warnings);
        let counts = match source {
            RayInput::Arrays(rays) => {
                all_at_once(&rays, &scene, (several, &kinds), &sinks, progress)?
            }
            RayInput::Stdin(feed) => {
                let is_stopped = || progress.is_stopped();
                if rays::is_text(&feed.mark(&is_stopped)?) {
                    let lines = RayLines::new(limits);
                    shoot_stream::answer(&feed, lines, (&scene, &kinds), progress)?
                } else {
                    let rays = rays::read_bytes(feed.all(&is_stopped)?, limits)?;
                    all_at_once(&rays, &scene, (several, &kinds), &sinks, progress)?
                }
            }
        };
        if scene.bounds().is_empty() && counts.rays > 0 {
            warn(&["nothing was hit: there is nothing to see"]);
        }
        let seconds = started.elapsed().as_secs_f64();
        if args.run.json {
            let done = json!({
                "outputs": sinks.as_json(&kinds),
                "rays": counts.rays,
                "hits": counts.hits,
                "crossings": several.map(|_| counts.crossings),
                "objects": scene.objects().len(),
                "triangles": scene.triangles(),
                "seconds": seconds,
            });
            end_report(done)?;
        } else if !is_quiet() {
            let share = 100.0 * counts.hits as f64 / counts.rays.max(1) as f64;
            let crossings = counted(counts.crossings, "hit");
            let crossings = several.map_or(String::new(), |_| format!(", {crossings}"));
            say(format_args!(
                "{}: {}, {share:.1} % hit{crossings}, {seconds:.2} s",
                sinks.names(),
                counted(counts.rays, "ray"),
            ));
        }
        Ok(())
    })
}

impl RayInput {
    /// The number of rays; `None` for a stream.
    fn count(&self) -> Option<u64> {
        match self {
            Self::Arrays(rays) => Some(rays.len() as u64),
            Self::Stdin(_) => None,
        }
    }
}

/// The rays. A stream that may be answered line by line is not waited for here.
fn source(args: &ShootArgs, sinks: &Sinks, limits: Limits) -> Result<RayInput, Failure> {
    if let Some(from) = args.from {
        return rays::read_from(&args.rays, from, limits).map(RayInput::Arrays);
    }
    let is_pipe = args.rays.as_path() == Path::new("-") && args.directions.is_none();
    // A ray without hits has no line among all hits, for which a program would wait.
    if is_pipe
        && several(args).is_none()
        && sinks.is_csv_stream()
        && let Some(feed) = Feed::new()
    {
        return Ok(RayInput::Stdin(feed));
    }
    rays::read(&args.rays, args.directions.as_deref(), limits).map(RayInput::Arrays)
}

fn all_at_once(
    rays: &RayArrays,
    scene: &Scene,
    (several, kinds): (Option<All>, &[&ChannelKind]),
    sinks: &Sinks,
    progress: &Progress,
) -> Result<Counts, Failure> {
    progress.begin("shooting", work(rays.len(), kinds, 1), RAYS);
    let (frame, counts) = match several {
        Some(query) => shot_all(scene, rays, (query, kinds), progress)?,
        None => shot(scene, rays, kinds, progress)?,
    };
    progress.end();
    sinks.write(&frame, progress)?;
    Ok(counts)
}
