//! A picture to be made: from a scene with its look to files.

use std::path::Path;
use std::time::Instant;

use firsthit::channel::ChannelKind;
use firsthit::edge::Edges;
use firsthit::image::{Data, Frame, WriteSettings};
use firsthit::render::{Picture, work};
use firsthit::watch::Watch as _;
use firsthit::{Camera, DisplayTransform, Scene, Shading, Side};
use serde_json::{Value, json};

use super::idle::without_files;
use crate::args::{DisplayArgs, FileArgs, Given, RunArgs};
use crate::console::{counted, end_report, is_quiet, say, warn};
use crate::failure::Failure;
use crate::legend;
use crate::output::{self, Order};
use crate::progress::{Keeping, Progress, RAYS};

/// A picture to be made.
pub(crate) struct Job<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) camera: &'a Camera,
    pub(crate) shade: &'a Shading<'a>,
    pub(crate) samples: u32,
    /// The noise at which no more samples are taken.
    pub(crate) noise: Option<f64>,
    /// The file of the state, to continue from.
    pub(crate) resume: Option<&'a Path>,
    pub(crate) settings: WriteSettings,
    /// Whether float64 numbers are rounded to float32.
    pub(crate) is_rounded: bool,
    /// The guesses, in words, each with the option that says otherwise.
    pub(crate) guessed: &'a [String],
    /// The file of `--legend`.
    pub(crate) legend: Option<&'a Path>,
    /// The side of surfaces that the camera's rays pass through.
    pub(crate) cull: Option<Side>,
    /// Lines along edges.
    pub(crate) edges: Option<Edges>,
}

/// The settings for writing files; warns where one of their options does nothing. Colours are shown
/// as the command line says, the rest as the file says.
pub(crate) fn settings(
    given: &Given,
    files: &FileArgs,
    (args, of_file): (&DisplayArgs, DisplayTransform),
    orders: &[Order],
) -> WriteSettings {
    warn(&without_files(given, orders));
    let display = DisplayTransform {
        exposure: args.exposure.unwrap_or(of_file.exposure),
        tone_map: args.tone_map.unwrap_or(of_file.tone_map),
    };
    WriteSettings {
        png_scale: files.png_scale,
        png_far: files.far,
        png_labels: files.png_labels,
        compress: files.compress,
        display,
    }
}

/// Makes a picture, writes it, and says so in one line.
pub(crate) fn picture(
    job: &Job<'_>,
    orders: &[Order],
    args: &RunArgs,
    progress: &Progress,
) -> Result<(), Failure> {
    let started = Instant::now();
    let &Job {
        scene, camera, shade, samples, noise, resume, settings, legend, cull, edges, ..
    } = job;
    let kinds = all_kinds(orders, noise)?;
    let total = work(camera.pixels(), &kinds, samples);
    progress.begin("shooting", total, RAYS);
    let picture =
        Picture { samples, noise, cull, edges, ..Picture::new(scene, camera, shade, &kinds) };
    let mut whole = match resume {
        Some(path) => {
            let _keeping = Keeping::begin();
            let resumed = picture.render_resumed(path, progress);
            resumed.map_err(|error| Failure::of_options(error, &["resume"]))?
        }
        None => picture.render(progress)?,
    };
    progress.end();
    if job.is_rounded {
        whole = whole.rounded()?;
    }
    let objects = match whole.channel("object").map(|channel| &channel.data) {
        Some(Data::Int32(objects)) => objects.as_slice(),
        _ => &[],
    };
    let taken = Taken::of(&whole, job);
    let hit = objects.iter().filter(|&&object| object >= 0).count();
    let rows = legend.map(|_| legend::rows(scene, objects));
    let legends = write_all(&mut whole, orders, settings, progress)?;
    if let (Some(path), Some(rows)) = (legend, rows) {
        legend::write(path, &rows, progress)?;
    }
    warn(&crate::hints::hints(scene, camera, hit));
    let seconds = started.elapsed().as_secs_f64();
    tell(job, (orders, &legends), args, (hit, &taken, seconds))
}

/// The numbers of samples that pixels had.
struct Taken {
    /// The most that a pixel had.
    most: u32,
    /// The mean, and the share of pixels that had all samples that were allowed. `None` where no
    /// noise could end them sooner.
    by_noise: Option<(f64, f64)>,
}

impl Taken {
    fn of(whole: &Frame, job: &Job<'_>) -> Self {
        let counts = match whole.channel("samples").map(|channel| &channel.data) {
            Some(Data::Int32(counts)) if job.noise.is_some() => Some(counts),
            _ => None,
        };
        let by_noise = counts.map(|counts| {
            let pixels = counts.len() as f64;
            let sum: f64 = counts.iter().map(|&count| f64::from(count)).sum();
            let is_all = |count: &&i32| i64::from(**count) == i64::from(job.samples);
            (sum / pixels, counts.iter().filter(is_all).count() as f64 / pixels)
        });
        Self { most: whole.origin().samples.unwrap_or(job.samples), by_noise }
    }
}

/// Says that a picture is made.
fn tell(
    job: &Job<'_>,
    (orders, legends): (&[Order], &[Vec<Option<String>>]),
    args: &RunArgs,
    (hit, taken, seconds): (usize, &Taken, f64),
) -> Result<(), Failure> {
    let &Job { scene, camera, guessed, .. } = job;
    let pixels = camera.pixels() as u64;
    if args.json {
        let done = done(job, orders, legends, (hit, taken, seconds));
        end_report(done)?;
    } else if !is_quiet() {
        let guessed = if guessed.is_empty() {
            String::new()
        } else {
            format!("; guessed: {}", guessed.join(", "))
        };
        let samples = taken.by_noise.map_or_else(String::new, |(mean, all)| {
            let (share, most) = (100.0 * all, job.samples);
            format!(", {mean:.1} samples a pixel ({share:.1} % took all {most})")
        });
        say(format_args!(
            "{}: {} x {} pixels, {:.1} % hit, {}, {}{samples}, {:.2} s{guessed}",
            output::names(orders.iter().flat_map(|order| &order.targets)),
            camera.columns(),
            camera.rows(),
            100.0 * hit as f64 / pixels as f64,
            counted(scene.objects().len() as u64, "object"),
            counted(scene.triangles(), "triangle"),
            seconds,
        ));
        for (order, legends) in orders.iter().zip(legends) {
            output::say_legends(&order.targets, legends);
        }
    }
    Ok(())
}

/// Writes each output its channels of the picture, which are taken out where no later one has them;
/// returns their legends.
fn write_all(
    picture: &mut Frame,
    orders: &[Order],
    settings: WriteSettings,
    progress: &Progress,
) -> Result<Vec<Vec<Option<String>>>, Failure> {
    let mut legends = Vec::new();
    for (number, Order { kinds, targets }) in (1..).zip(orders) {
        let names: Vec<&str> = kinds.iter().map(|kind| &*kind.name).collect();
        let later = orders[number..].iter().flat_map(|order| &order.kinds);
        let is_last = |name: &str| !later.clone().any(|kind| kind.name == name);
        let frame = picture.select(&names, is_last)?;
        legends.push(output::write(&frame, targets, settings, progress)?);
    }
    Ok(legends)
}

/// The kinds of all outputs, each once; the object, from which it is known what was hit; and the
/// samples where a noise ends them.
fn all_kinds(orders: &[Order], noise: Option<f64>) -> Result<Vec<&'static ChannelKind>, Failure> {
    let mut kinds: Vec<&'static ChannelKind> = vec![firsthit::channel::kind("object")?];
    if noise.is_some() && orders.iter().any(needs_shade) {
        kinds.push(firsthit::channel::kind("samples")?);
    }
    for kind in orders.iter().flat_map(|order| &order.kinds) {
        if !output::has(&kinds, kind)? {
            kinds.push(kind);
        }
    }
    Ok(kinds)
}

/// The JSON about a picture.
fn done(
    job: &Job<'_>,
    orders: &[Order],
    legends: &[Vec<Option<String>>],
    (hits, taken, seconds): (usize, &Taken, f64),
) -> Value {
    let of_order = |(order, legends): (&Order, &Vec<Option<String>>)| {
        output::as_json(&order.targets, &order.kinds, legends)
    };
    let outputs = orders.iter().zip(legends).flat_map(of_order);
    json!({
        "outputs": outputs.collect::<Vec<_>>(),
        "legend_file": job.legend.map(Path::to_string_lossy),
        "columns": job.camera.columns(),
        "rows": job.camera.rows(),
        "hits": hits,
        "samples": taken.most,
        "mean_samples": taken.by_noise.map(|(mean, _)| mean),
        "share_with_all_samples": taken.by_noise.map(|(_, all)| all),
        "guessed": job.guessed,
        "objects": job.scene.objects().len(),
        "triangles": job.scene.triangles(),
        "seconds": seconds,
    })
}

pub(crate) fn needs_samples(order: &Order) -> bool {
    order.kinds.iter().any(|kind| kind.needs_samples())
}

pub(super) fn needs_shade(order: &Order) -> bool {
    order.kinds.iter().any(|kind| kind.needs_shade())
}
