use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use firsthit::channel::Kind;
use firsthit::render::{develop, shoulder_light};
use firsthit::shoot::shoot_all;
use firsthit::{Background, Camera, Color, Light, Scene, Shader, Shading};

use crate::args::{LightingArgs, RenderArgs, RunArgs};
use crate::camera::{camera, size};
use crate::console::{counted, say, warn};
use crate::failure::Failure;
use crate::loading::{self, Loaded, with_threads};
use crate::output::{self, Source, Target};
use crate::progress::Progress;
use crate::values::LightArg;

/// The only one that looks at lights.
const DEFAULT_SHADER: &str = "lambert";

pub(super) const WITHOUT_COLOR: &str = "without color among the --channels";

pub(crate) fn run(args: &RenderArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let kinds = output::kinds(&args.picture.channels, Source::Camera, args.run.quiet)?;
    warn(&idle_options(args, &kinds));
    size(&args.camera)?;
    let default = [default_output(&args.file)];
    let outputs = if args.picture.output.is_empty() {
        &default[..]
    } else {
        &args.picture.output
    };
    let targets = output::targets(outputs, &kinds, Source::Camera, &[&args.file])?;
    output::check_all_go_somewhere(&targets, &kinds)?;
    with_threads(&args.run, || {
        let Loaded {
            scene,
            up,
            warnings,
        } = loading::read(&args.file, &args.load, args.light.color)?;
        warn(&warnings);
        let camera = camera(&args.camera, scene.bounds(), up)?;
        let lights = lights(&args.light, &scene, &camera);
        let scene = scene.with_lights(lights);
        let shade = Shading {
            scene: &scene,
            shader: shader(&args.light)?,
            background: background(&args.light, &camera),
        };
        let job = Job {
            scene: &scene,
            camera: &camera,
            shade: &shade,
            kinds: &kinds,
            samples: args.picture.samples.unwrap_or(1),
        };
        picture(&job, &targets, &args.run, interrupted)
    })
}

/// The input's name with the extension of a picture, in the current folder.
fn default_output(input: &Path) -> PathBuf {
    // Not `set_extension`: `part.v2.stl` becomes `part.v2.png`.
    let mut name = input
        .file_stem()
        .unwrap_or_else(|| "render".as_ref())
        .to_owned();
    name.push(".png");
    name.into()
}

/// A picture to be made.
pub(crate) struct Job<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) camera: &'a Camera,
    pub(crate) shade: &'a Shading<'a>,
    pub(crate) kinds: &'a [&'static Kind],
    pub(crate) samples: u32,
}

/// Makes a picture, writes it, and says so in one line.
pub(crate) fn picture(
    job: &Job<'_>,
    targets: &[Target],
    args: &RunArgs,
    interrupted: &AtomicBool,
) -> Result<(), Failure> {
    let started = Instant::now();
    let &Job {
        scene,
        camera,
        shade,
        kinds,
        samples,
    } = job;
    let pixels = camera.pixels() as u64;
    let colors = if kinds.iter().any(|kind| kind.needs_shade()) {
        u64::from(samples)
    } else {
        0
    };
    let progress = Progress::new(pixels * (1 + colors), args.quiet, interrupted);
    let hits = shoot_all(scene, camera, &progress)?;
    let frame = develop(scene, camera, &hits, shade, kinds, samples, &progress)?;
    drop(progress);
    let legends = output::write(&frame, targets, interrupted)?;
    warn(&crate::hints::hints(scene, camera, &hits));
    if !args.quiet {
        let hit = hits.t.iter().filter(|&&t| t < f64::INFINITY).count();
        say(format_args!(
            "{}: {} x {} pixels, {:.1} % hit, {}, {}, {:.2} s",
            output::names(targets),
            camera.columns(),
            camera.rows(),
            100.0 * hit as f64 / pixels as f64,
            counted(scene.objects().len() as u64, "object"),
            counted(scene.triangles(), "triangle"),
            started.elapsed().as_secs_f64(),
        ));
        legends.iter().for_each(say);
    }
    Ok(())
}

/// Says of options that would do nothing that they do: whoever gives them may expect something else, or
/// may give the same options to all runs.
fn idle_options(args: &RenderArgs, kinds: &[&'static Kind]) -> Vec<String> {
    let light = &args.light;
    let for_lambert = [
        ("--light", !light.light.is_empty()),
        ("--ambient", light.ambient.is_some()),
        ("--no-shadows", light.no_shadows),
    ];
    let for_color = [
        ("--samples", args.picture.samples.is_some()),
        ("--shader", light.shader.is_some()),
        ("--color", light.color.is_some()),
        ("--background", light.background.is_some()),
        ("--sky", light.sky.is_some()),
    ];
    let given = |options: &[(&'static str, bool)], why: &str| -> Vec<String> {
        let given = options.iter().filter(|(_, is_given)| *is_given);
        given
            .map(|(name, _)| format!("{name} does nothing {why}"))
            .collect()
    };
    if !kinds.iter().any(|kind| kind.needs_shade()) {
        return given(
            &[for_color.as_slice(), &for_lambert].concat(),
            WITHOUT_COLOR,
        );
    }
    let mut idle = Vec::new();
    if let Some(shader) = light
        .shader
        .as_deref()
        .filter(|&shader| shader != DEFAULT_SHADER)
    {
        idle = given(
            &for_lambert,
            &format!("with --shader {shader}, only with {DEFAULT_SHADER}"),
        );
    }
    if light.shader.as_deref() == Some("normal") && light.color.is_some() {
        idle.push("--color does nothing with --shader normal, which shows directions".into());
    }
    idle
}

fn shader(args: &LightingArgs) -> Result<Shader, Failure> {
    let mut shader = Shader::named(args.shader.as_deref().unwrap_or(DEFAULT_SHADER))?;
    if let Shader::Lambert(lambert) = &mut shader {
        lambert.ambient = args.ambient.unwrap_or(lambert.ambient);
        lambert.shadows = !args.no_shadows;
    }
    Ok(shader)
}

fn background(args: &LightingArgs, camera: &Camera) -> Background {
    match args.sky {
        Some(sky) => Background::Gradient {
            horizon: sky.horizon,
            zenith: sky.zenith,
            up: camera.view().up,
        },
        None => Background::Uniform(args.background.unwrap_or(Color::new(0.85, 0.87, 0.9))),
    }
}

fn lights(args: &LightingArgs, scene: &Scene, camera: &Camera) -> Vec<Light> {
    if args.light.is_empty() {
        return vec![shoulder_light(camera)];
    }
    let centre = if scene.bounds().is_empty() {
        camera.position()
    } else {
        scene.bounds().centre()
    };
    let light = |light: &LightArg| match *light {
        LightArg::Directional(direction) => Light::Directional {
            direction,
            color: Color::splat(0.95),
        },
        // As bright in the middle of the scene as a directional light.
        LightArg::Point(position) => {
            let intensity = Color::splat(0.95 * (centre - position).length_squared());
            Light::Point {
                position,
                intensity,
            }
        }
    };
    args.light.iter().map(light).collect()
}
