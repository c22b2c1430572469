use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use firsthit::channel::{Kind, Shots};
use firsthit::image::{Frame, WriteSettings};
use firsthit::render::origin;
use firsthit::shoot::{Hits, shoot_all};
use firsthit::{Background, Rays as _, Scene, Shader, Shading};

use crate::args::{ShootArgs, StreamFormat};
use crate::console::{counted, say, warn};
use crate::failure::Failure;
use crate::hits_csv::write_csv;
use crate::loading::{self, Loaded, with_threads};
use crate::output::{self, Source, Target};
use crate::progress::Progress;
use crate::rays::{self, RayArrays};

/// Where a result goes.
struct Sinks {
    files: Vec<Target>,
    stdout: Option<StreamFormat>,
}

impl Sinks {
    fn names(&self) -> String {
        match (self.stdout, &self.files[..]) {
            (Some(_), []) => "standard output".into(),
            (Some(_), files) => format!("standard output, {}", output::names(files)),
            (None, files) => output::names(files),
        }
    }
}

pub(crate) fn run(args: &ShootArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let kinds = output::kinds(&args.channels, Source::Rays, args.run.quiet)?;
    let sinks = sinks(args, &kinds)?;
    let started = Instant::now();
    with_threads(&args.run, || {
        let ends = (args.t_min, args.t_max);
        if let (Some(t_min), Some(t_max)) = ends
            && t_min >= t_max
        {
            return Err(Failure::usage("--t-min must be below --t-max"));
        }
        let rays = rays::read(&args.rays, args.directions.as_deref(), ends)?;
        let Loaded {
            scene, warnings, ..
        } = loading::read(&args.file, &args.load, None)?;
        warn(&warnings);
        let progress = Progress::new(rays.len() as u64, args.run.quiet, interrupted);
        let hits = shoot_all(&scene, &rays, &progress)?;
        let frame = frame(&scene, &rays, &hits, &kinds, &progress)?;
        drop(progress);
        // Files first: a reader of standard output who has had enough ends the program.
        output::write(&frame, &sinks.files, WriteSettings::default(), interrupted)?;
        if let Some(format) = sinks.stdout {
            stream(&frame, format)?;
        }
        if scene.bounds().is_empty() && !rays.is_empty() {
            warn(&["nothing was hit: there is nothing to see"]);
        }
        if !args.run.quiet {
            let hit = hits.t.iter().filter(|&&t| t < f64::INFINITY).count();
            let share = if rays.is_empty() {
                0.0
            } else {
                100.0 * hit as f64 / rays.len() as f64
            };
            say(format_args!(
                "{}: {}, {share:.1} % hit, {:.2} s",
                sinks.names(),
                counted(rays.len() as u64, "ray"),
                started.elapsed().as_secs_f64()
            ));
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
    let mut frame = Frame::new([rays.len()]).from_origin(origin(scene, None, None));
    for kind in kinds {
        frame.push(kind.make(&shots, &shade, watch)?)?;
    }
    Ok(frame)
}

fn sinks(args: &ShootArgs, kinds: &[&'static Kind]) -> Result<Sinks, Failure> {
    let stdout = |path: &&PathBuf| path.as_path() == Path::new("-");
    let streams = match args.output.iter().filter(stdout).count() {
        0 => args.output.is_empty(),
        1 => true,
        _ => return Err(Failure::usage("- is named twice as an output")),
    };
    let files: Vec<PathBuf> = (args.output.iter().filter(|path| !stdout(path)))
        .cloned()
        .collect();
    let inputs = [Some(&args.file), Some(&args.rays), args.directions.as_ref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
    let files = output::targets(&files, kinds, Source::Rays, &inputs)?;
    if !streams {
        if args.format.is_some() {
            return Err(Failure::usage(
                "--format is for standard output (-o -); a file's format is that of its extension",
            ));
        }
        output::check_all_go_somewhere(&files, kinds)?;
    }
    let format = args.format.unwrap_or(StreamFormat::Csv);
    if format == StreamFormat::Npy && kinds.len() != 1 {
        return Err(Failure::usage(
            "--format npy holds one channel; choose one with --channels, or npz",
        ));
    }
    let stdout = streams.then_some(format);
    Ok(Sinks { files, stdout })
}

fn stream(frame: &Frame, format: StreamFormat) -> Result<(), Failure> {
    match format {
        StreamFormat::Npy => output::stream(frame, "npy"),
        StreamFormat::Npz => output::stream(frame, "npz"),
        StreamFormat::Csv => {
            let mut out = std::io::BufWriter::new(std::io::stdout().lock());
            let written = write_csv(frame, &mut out).and_then(|()| out.flush());
            written.map_err(|error| Failure::stdout(&error))
        }
    }
}
