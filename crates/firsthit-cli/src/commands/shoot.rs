use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use firsthit::channel::{Kind, Shots};
use firsthit::error::escaped;
use firsthit::image::{Frame, write_whole};
use firsthit::shoot::{Hits, shoot_all};
use firsthit::{Background, Rays as _, Scene, Shader, Shading};

use crate::args::{ShootArgs, StreamFormat};
use crate::failure::Failure;
use crate::loading::{self, Loaded, with_threads};
use crate::output::{self, Target};
use crate::progress::Progress;
use crate::rays::{self, RayArrays};

/// Where a result goes.
enum Sink {
    Files(Vec<Target>),
    Csv(PathBuf),
    Stdout(StreamFormat),
}

pub(crate) fn run(args: &ShootArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let kinds = output::kinds(&args.channels)?;
    if let Some(kind) = kinds
        .iter()
        .find(|kind| kind.needs_camera() || kind.needs_shade())
    {
        return Err(Failure::usage(format!(
            "the channel {} takes a camera: it is for firsthit render",
            kind.name
        )));
    }
    let sinks = sinks(args, &kinds)?;
    let started = Instant::now();
    with_threads(&args.run, || {
        let rays = rays::read(&args.rays, args.directions.as_deref(), args.t_max)?;
        let Loaded {
            scene, warnings, ..
        } = loading::read(&args.file, &args.load, None)?;
        loading::warn(&warnings);
        let progress = Progress::new(rays.len() as u64, args.run.quiet, interrupted);
        let hits = shoot_all(&scene, &rays, &progress)?;
        let frame = frame(&scene, &rays, &hits, &kinds, &progress)?;
        drop(progress);
        for sink in &sinks {
            write(&frame, sink)?;
        }
        if !args.run.quiet {
            let hit = hits.t.iter().filter(|&&t| t < f64::INFINITY).count();
            let share = if rays.is_empty() {
                0.0
            } else {
                100.0 * hit as f64 / rays.len() as f64
            };
            eprintln!(
                "{} rays, {share:.1} % hit, {:.2} s",
                rays.len(),
                started.elapsed().as_secs_f64()
            );
        }
        Ok(())
    })
}

fn frame(
    scene: &Scene,
    rays: &RayArrays,
    hits: &Hits,
    kinds: &[&Kind],
    watch: &Progress<'_>,
) -> Result<Frame, Failure> {
    let shots = Shots {
        scene,
        rays,
        hits,
        camera: None,
    };
    let shade = Shading {
        scene,
        shader: Shader::default(),
        background: Background::default(),
    };
    let mut frame = Frame::new([rays.len()]);
    for kind in kinds {
        frame.push(kind.make(&shots, &shade, watch)?)?;
    }
    Ok(frame)
}

fn sinks(args: &ShootArgs, kinds: &[&'static Kind]) -> Result<Vec<Sink>, Failure> {
    let default = [PathBuf::from("-")];
    let outputs = if args.output.is_empty() {
        &default[..]
    } else {
        &args.output
    };
    let mut sinks = Vec::new();
    for path in outputs {
        let is_csv = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
        if path == Path::new("-") {
            if args.format == StreamFormat::Npy && kinds.len() != 1 {
                return Err(Failure::usage(
                    "--format npy holds one channel; choose one with --channels, or npz",
                ));
            }
            sinks.push(Sink::Stdout(args.format));
        } else if is_csv {
            sinks.push(Sink::Csv(path.clone()));
        } else {
            let files = output::targets(std::slice::from_ref(path), kinds, Some(&args.file))?;
            sinks.push(Sink::Files(files));
        }
    }
    let inputs = [Some(&args.file), Some(&args.rays), args.directions.as_ref()];
    for path in outputs {
        let path = path.canonicalize().ok();
        if path.is_some()
            && inputs
                .iter()
                .flatten()
                .any(|input| input.canonicalize().ok() == path)
        {
            let path = escaped(&path.unwrap_or_default());
            return Err(Failure::usage(format!(
                "{path} is an input; it will not be overwritten"
            )));
        }
    }
    Ok(sinks)
}

fn write(frame: &Frame, sink: &Sink) -> Result<(), Failure> {
    match sink {
        Sink::Files(targets) => output::write(frame, targets).map(drop),
        Sink::Csv(path) => Ok(write_whole(path, |out| rays::write_csv(frame, out))?),
        Sink::Stdout(StreamFormat::Npy) => output::stream(frame, "npy"),
        Sink::Stdout(StreamFormat::Npz) => output::stream(frame, "npz"),
        Sink::Stdout(StreamFormat::Csv) => {
            let mut out = std::io::BufWriter::new(std::io::stdout().lock());
            let written = rays::write_csv(frame, &mut out).and_then(|()| out.flush());
            written.map_err(|error| Failure::stdout(&error))
        }
    }
}
