use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use firsthit::image::WriteSettings;
use firsthit::io::{Model, Output};
use firsthit::render::{develop, shoulder_light};
use firsthit::shoot::shoot_all;
use firsthit::{Background, Camera, Color, Light, Scene, Shader, Shading};

use crate::args::{LightingArgs, RenderArgs, RunArgs};
use crate::camera::{camera, check, of_file};
use crate::console::{counted, say, warn};
use crate::failure::Failure;
use crate::loading::{self, Loaded, with_threads};
use crate::output::{self, Order, Source};
use crate::progress::Progress;
use crate::values::LightArg;

const DEFAULT_CHANNEL: &str = "color";

/// The only one that looks at lights.
const DEFAULT_SHADER: &str = "lambert";

pub(super) const WITHOUT_COLOR: &str = "without color among the --channels";

pub(crate) fn run(args: &RenderArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    check(&args.camera)?;
    // What is wrong with these is told before large files are read.
    let asked = (!args.picture.output.is_empty())
        .then(|| orders(args, &[]))
        .transpose()?;
    output::kinds(&args.picture.channels, Source::Camera, true)?;
    with_threads(&args.run, || {
        let Loaded {
            scene,
            up,
            warnings,
            model,
        } = loading::read(&args.file, &args.load, args.light.color)?;
        let is_of_file = asked.is_none() && args.picture.channels.is_empty();
        let blamed = |failure: Failure| {
            if is_of_file {
                failure.in_file(&args.file)
            } else {
                failure
            }
        };
        let orders = asked.map_or_else(|| orders(args, &model.outputs), Ok);
        let orders = orders.map_err(blamed)?;
        output::check_not_inputs(&orders, &model.files).map_err(blamed)?;
        let shader = shader(&args.light, model.shader.as_ref())?;
        warn(&idle_options(args, &orders, &shader));
        warn(&warnings);
        let base = of_file(&args.camera, &model)?;
        let camera = camera(&args.camera, (&args.file, &base), scene.bounds(), up)?;
        let lights = lights(&args.light, &model, &scene, &camera);
        let scene = if args.light.light.is_empty() && model.lights.is_empty() {
            scene.with_borrowed_lights(lights)
        } else {
            scene.with_lights(lights)
        };
        let shade = Shading {
            scene: &scene,
            shader,
            background: background(&args.light, &model, &camera),
        };
        let job = Job {
            scene: &scene,
            camera: &camera,
            shade: &shade,
            samples: args.picture.samples.or(model.samples).unwrap_or(1),
            settings: settings(args.picture.png_scale, &orders),
        };
        picture(&job, &orders, &args.run, interrupted)
    })
}

/// What goes where: as the command line says, else as the file says, else a picture with the file's name.
fn orders(args: &RenderArgs, of_file: &[Output]) -> Result<Vec<Order>, Failure> {
    let color = [DEFAULT_CHANNEL.to_owned()];
    let channels = match &args.picture.channels[..] {
        [] => &color[..],
        channels => channels,
    };
    let outputs: Vec<(PathBuf, &[String])> = if !args.picture.output.is_empty() {
        let paths = args.picture.output.iter().cloned();
        paths.map(|path| (path, channels)).collect()
    } else if of_file.is_empty() {
        vec![(default_output(&args.file), channels)]
    } else if args.picture.channels.is_empty() {
        let own = of_file.iter();
        own.map(|output| (output.path.clone(), &output.channels[..]))
            .collect()
    } else {
        let paths = of_file.iter().map(|output| output.path.clone());
        paths.map(|path| (path, channels)).collect()
    };
    output::orders(&outputs, &[&args.file], args.run.quiet)
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
    pub(crate) samples: u32,
    pub(crate) settings: WriteSettings,
}

/// How files are written; says so where the scale does nothing.
pub(super) fn settings(png_scale: Option<f64>, orders: &[Order]) -> WriteSettings {
    if png_scale.is_some() && !orders.iter().any(output::takes_scale) {
        warn(&["--png-scale does nothing without t, range or z in a .png"]);
    }
    WriteSettings { png_scale }
}

/// Makes a picture, writes it, and says so in one line.
pub(crate) fn picture(
    job: &Job<'_>,
    orders: &[Order],
    args: &RunArgs,
    interrupted: &AtomicBool,
) -> Result<(), Failure> {
    let started = Instant::now();
    let &Job {
        scene,
        camera,
        shade,
        samples,
        settings,
    } = job;
    let pixels = camera.pixels() as u64;
    let shaded = orders.iter().filter(|order| needs_shade(order)).count() as u64;
    let work = pixels * (1 + shaded * u64::from(samples));
    let progress = Progress::new(work, args.quiet, interrupted);
    let hits = shoot_all(scene, camera, &progress)?;
    let mut legends = Vec::new();
    for Order { kinds, targets } in orders {
        let frame = develop(scene, camera, &hits, shade, kinds, samples, &progress)?;
        legends.extend(output::write(&frame, targets, settings, interrupted)?);
    }
    drop(progress);
    warn(&crate::hints::hints(scene, camera, &hits));
    if !args.quiet {
        let hit = hits.t.iter().filter(|&&t| t < f64::INFINITY).count();
        say(format_args!(
            "{}: {} x {} pixels, {:.1} % hit, {}, {}, {:.2} s",
            output::names(orders.iter().flat_map(|order| &order.targets)),
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
fn idle_options(args: &RenderArgs, orders: &[Order], shader: &Shader) -> Vec<String> {
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
    if !orders.iter().any(needs_shade) {
        return given(
            &[for_color.as_slice(), &for_lambert].concat(),
            WITHOUT_COLOR,
        );
    }
    let mut idle = Vec::new();
    if shader.name() != DEFAULT_SHADER {
        let why = format!(
            "with --shader {}, only with {DEFAULT_SHADER}",
            shader.name()
        );
        idle = given(&for_lambert, &why);
    }
    if shader.name() == "normal" && light.color.is_some() {
        idle.push("--color does nothing with --shader normal, which shows directions".into());
    }
    idle
}

fn needs_shade(order: &Order) -> bool {
    order.kinds.iter().any(|kind| kind.needs_shade())
}

fn shader(args: &LightingArgs, of_file: Option<&Shader>) -> Result<Shader, Failure> {
    let mut shader = match (args.shader.as_deref(), of_file) {
        // The file's settings go with the file's shader.
        (Some(name), Some(shader)) if shader.name() == name => shader.clone(),
        (Some(name), _) => Shader::named(name)?,
        (None, Some(shader)) => shader.clone(),
        (None, None) => Shader::named(DEFAULT_SHADER)?,
    };
    if let Shader::Lambert(lambert) = &mut shader {
        lambert.ambient = args.ambient.unwrap_or(lambert.ambient);
        lambert.shadows &= !args.no_shadows;
    }
    Ok(shader)
}

fn background(args: &LightingArgs, model: &Model, camera: &Camera) -> Background {
    match (args.sky, args.background) {
        (Some(sky), _) => Background::Gradient {
            horizon: sky.horizon,
            zenith: sky.zenith,
            up: camera.view().up,
        },
        (None, Some(color)) => Background::Uniform(color),
        (None, None) => model
            .background
            .unwrap_or(Background::Uniform(Color::new(0.85, 0.87, 0.9))),
    }
}

fn lights(args: &LightingArgs, model: &Model, scene: &Scene, camera: &Camera) -> Vec<Light> {
    if args.light.is_empty() && model.lights.is_empty() {
        return vec![shoulder_light(camera)];
    }
    if args.light.is_empty() {
        return model.lights.clone();
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
