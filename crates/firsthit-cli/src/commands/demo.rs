use std::path::PathBuf;

use firsthit::shade::Lambert;
use firsthit::{DisplayTransform, Shader, Shading, example};

use super::render::{Job, picture, settings, without_channels};
use crate::args::DemoArgs;
use crate::asked;
use crate::camera::check_size;
use crate::console::{is_quiet, warn};
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use crate::threads::with_threads;

/// The embedded scene is small: it can be made well.
const DEFAULT_SAMPLES: u32 = 16;

pub(crate) fn run(args: &DemoArgs, progress: &Progress) -> Result<(), Failure> {
    check_size("--size", args.size)?;
    let default = [PathBuf::from("demo.png")];
    let outputs = if args.output.is_empty() { &default[..] } else { &args.output };
    let with_channels = |path: &PathBuf| (path.clone(), asked::channels(&args.channels, path));
    let outputs: Vec<_> = outputs.iter().map(with_channels).collect();
    let orders = output::orders(&outputs, is_quiet())?;
    warn(&without_channels(&args.given, &orders));
    let usual = DisplayTransform::default();
    let settings = settings(&args.given, &args.files, (&args.display, usual), &orders);
    with_threads(args.run.threads, || {
        let scene = example::scene()?;
        let [rows, columns] = args.size;
        let camera = example::camera(rows, columns)?;
        let shade = Shading {
            background: example::background(),
            ..Shader::Lambert(Lambert::default()).on(&scene)
        };
        let job = Job {
            scene: &scene,
            camera: &camera,
            shade: &shade,
            samples: args.samples.unwrap_or(DEFAULT_SAMPLES),
            noise: None,
            resume: None,
            settings,
            is_rounded: args.files.is_rounded(),
            guessed: &[],
            legend: None,
            cull: None,
            edges: None,
        };
        picture(&job, &orders, &args.run, progress)
    })
}
