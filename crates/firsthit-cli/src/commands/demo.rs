use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use firsthit::{Shader, Shading, example};

use super::render::{Job, WITHOUT_COLOR, picture, settings};
use crate::args::DemoArgs;
use crate::camera::check_size;
use crate::console::warn;
use crate::failure::Failure;
use crate::loading::with_threads;
use crate::output::Order;
use crate::output::{self, Source};

/// The embedded scene is small: it can be made well.
const DEFAULT_SAMPLES: u32 = 16;

pub(crate) fn run(args: &DemoArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let kinds = output::kinds(
        &args.channels,
        Source::Camera,
        args.run.quiet || args.run.json,
    )?;
    check_size("--size", args.size)?;
    if args.samples.is_some() && !kinds.iter().any(|kind| kind.needs_shade()) {
        warn(&[format!("--samples does nothing {WITHOUT_COLOR}")]);
    }
    let default = [PathBuf::from("demo.png")];
    let outputs = if args.output.is_empty() {
        &default[..]
    } else {
        &args.output
    };
    let targets = output::targets(outputs, &kinds, Source::Camera, &[])?;
    output::check_all_go_somewhere(&targets, &kinds)?;
    let orders = [Order { kinds, targets }];
    let settings = settings(args.png_scale, &orders);
    with_threads(&args.run, || {
        let scene = example::scene()?;
        let (columns, rows) = args.size;
        let camera = example::camera(rows, columns)?;
        let shade = Shading {
            background: example::background(),
            ..Shader::default().on(&scene)
        };
        let job = Job {
            scene: &scene,
            camera: &camera,
            shade: &shade,
            samples: args.samples.unwrap_or(DEFAULT_SAMPLES),
            settings,
            guessed: &[],
            legend: None,
        };
        picture(&job, &orders, &args.run, interrupted)
    })
}
