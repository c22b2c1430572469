use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use firsthit::{Shader, Shading, example};

use super::render::{Job, picture};
use crate::args::DemoArgs;
use crate::failure::Failure;
use crate::loading::with_threads;
use crate::output;

pub(crate) fn run(args: &DemoArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let kinds = output::kinds(&args.channels)?;
    let default = [PathBuf::from("demo.png")];
    let outputs = if args.output.is_empty() {
        &default[..]
    } else {
        &args.output
    };
    let targets = output::targets(outputs, &kinds, None)?;
    with_threads(&args.run, || {
        let scene = example::scene()?;
        let (columns, rows) = args.size;
        let camera = example::camera(rows, columns)?;
        let shade = Shading {
            scene: &scene,
            shader: Shader::default(),
            background: example::background(),
        };
        let job = Job {
            scene: &scene,
            camera: &camera,
            shade: &shade,
            kinds: &kinds,
            samples: args.samples,
        };
        picture(&job, &targets, &args.run, interrupted)
    })
}
