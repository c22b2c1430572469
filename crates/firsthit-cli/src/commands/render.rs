use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use firsthit::channel::Kind;
use firsthit::geometry::meant_as_levels;
use firsthit::image::WriteSettings;
use firsthit::image::{Data, Frame};
use firsthit::render::{BACKGROUND, Picture, SAMPLES, has_shoulder_shadows, shoulder_light, work};
use firsthit::world::{Output, World};
use firsthit::{Background, Camera, Color, Light, Scene, Shader, Shading, Side};
use serde_json::{Value, json};

use crate::args::{LightingArgs, RenderArgs, RunArgs};
use crate::asked;
use crate::camera::{Chosen, camera, check, of_file};
use crate::console::{counted, end_report, say, warn};
use crate::failure::Failure;
use crate::legend;
use crate::loading::{self, Loaded, with_threads};
use crate::output::{self, Order, Source};
use crate::progress::Progress;
use crate::values::LightArg;

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
    if let Some(orders) = &asked {
        check_legend(args, orders, &[])?;
    }
    with_threads(&args.run, || {
        let Loaded {
            scene,
            warnings,
            model,
            files,
            ..
        } = loading::read(&args.file, &args.load, args.light.color)?.picked(&args.pick)?;
        let orders = all_orders(args, asked, &model.outputs, &files)?;
        let mut shader = shader(&args.light, model.shader.as_ref())?;
        warn(&idle_options(args, &orders, &shader));
        warn(&doubtful_colors(&args.light));
        warn(&warnings);
        let base = of_file(&args.camera, &model)?;
        let chosen = camera(&args.camera, (&args.file, &base), &scene, &model)?;
        let Chosen {
            camera,
            mut guessed,
        } = chosen;
        let (scene, is_light_guessed) = lit(scene, &args.light, &model, &camera);
        if is_light_guessed
            && let Shader::Lambert(lambert) = &mut shader
            && orders.iter().any(needs_shade)
        {
            guessed.push("light over the shoulder (--light)".into());
            if lambert.shadows && !has_shoulder_shadows(&camera) {
                lambert.shadows = false;
                guessed.push("no shadows of it (--light)".into());
            }
        }
        let shade = Shading {
            background: background(&args.light, &model, &camera),
            ..shader.on(&scene)
        };
        let job = Job {
            scene: &scene,
            camera: &camera,
            shade: &shade,
            samples: args.picture.samples.or(model.samples).unwrap_or(SAMPLES),
            settings: settings(args.picture.png_scale, &orders),
            guessed: &guessed,
            legend: args.picture.legend.as_deref(),
            cull: args.cull.map(From::from),
        };
        picture(&job, &orders, &args.run, interrupted)
    })
}

/// What goes where, none of it over an input. `asked` is what the command line says already.
fn all_orders(
    args: &RenderArgs,
    asked: Option<Vec<Order>>,
    outputs: &[Output],
    files: &[PathBuf],
) -> Result<Vec<Order>, Failure> {
    let is_of_file = asked.is_none() && args.picture.channels.is_empty() && !outputs.is_empty();
    let blamed = |failure: Failure| {
        if is_of_file {
            failure.in_file(&args.file)
        } else {
            failure
        }
    };
    let orders = asked.map_or_else(|| orders(args, outputs), Ok);
    let orders = orders.map_err(blamed)?;
    output::check_not_inputs(&orders, files).map_err(blamed)?;
    check_legend(args, &orders, files)?;
    Ok(orders)
}

fn check_legend(args: &RenderArgs, orders: &[Order], inputs: &[PathBuf]) -> Result<(), Failure> {
    match &args.picture.legend {
        Some(path) => legend::check(path, orders, inputs),
        None => Ok(()),
    }
}

/// What goes where: as the command line says, else as the file says, else a picture with the file's name.
fn orders(args: &RenderArgs, of_file: &[Output]) -> Result<Vec<Order>, Failure> {
    let asked = &args.picture.channels;
    let with_channels = |path: &PathBuf| (path.clone(), asked::channels(asked, path));
    let outputs: Vec<(PathBuf, Vec<String>)> = if !args.picture.output.is_empty() {
        args.picture.output.iter().map(with_channels).collect()
    } else if of_file.is_empty() {
        let path = default_output(&args.file);
        if path.to_string_lossy().contains(output::PLACEHOLDER) {
            let name = firsthit::error::escaped(&path);
            return Err(Failure::usage(format!(
                "--output must be given: {name} would be a template of names"
            )));
        }
        vec![with_channels(&path)]
    } else if asked.is_empty() {
        let own = of_file.iter();
        own.map(|output| (output.path.clone(), output.channels.clone()))
            .collect()
    } else {
        of_file
            .iter()
            .map(|output| with_channels(&output.path))
            .collect()
    };
    output::orders(&outputs, &[&args.file], args.run.quiet || args.run.json)
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
    /// What was guessed, in words, each with the option that says otherwise.
    pub(crate) guessed: &'a [String],
    /// The file of `--legend`.
    pub(crate) legend: Option<&'a Path>,
    /// The side of surfaces that the camera's rays pass through.
    pub(crate) cull: Option<Side>,
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
        guessed,
        legend,
        cull,
    } = job;
    let pixels = camera.pixels() as u64;
    let kinds = all_kinds(orders)?;
    let total = work(camera.pixels(), &kinds, samples);
    let progress = Progress::new(total, args.quiet || args.json, interrupted);
    let picture = Picture {
        samples,
        cull,
        ..Picture::new(scene, camera, shade, &kinds)
    };
    let mut whole = picture.render(&progress)?;
    let objects = match whole.channel("object").map(|channel| &channel.data) {
        Some(Data::Int32(objects)) => objects.as_slice(),
        _ => &[],
    };
    let hit = objects.iter().filter(|&&object| object >= 0).count();
    let rows = legend.map(|_| legend::rows(scene, objects));
    let legends = write_all(&mut whole, orders, settings, interrupted)?;
    if let (Some(path), Some(rows)) = (legend, rows) {
        legend::write(path, &rows, interrupted)?;
    }
    drop(progress);
    warn(&crate::hints::hints(scene, camera, hit));
    let seconds = started.elapsed().as_secs_f64();
    if args.json {
        let done = done(job, orders, &legends, (hit, seconds));
        end_report(done).map_err(|error| Failure::stdout(&error))?;
    } else if !args.quiet {
        let guessed = if guessed.is_empty() {
            String::new()
        } else {
            format!("; guessed: {}", guessed.join(", "))
        };
        say(format_args!(
            "{}: {} x {} pixels, {:.1} % hit, {}, {}, {:.2} s{guessed}",
            output::names(orders.iter().flat_map(|order| &order.targets)),
            camera.columns(),
            camera.rows(),
            100.0 * hit as f64 / pixels as f64,
            counted(scene.objects().len() as u64, "object"),
            counted(scene.triangles(), "triangle"),
            seconds,
        ));
        for (order, legends) in orders.iter().zip(&legends) {
            output::say_legends(&order.targets, legends);
        }
    }
    Ok(())
}

/// Writes each output its channels of the picture, which are taken out where no later one has them; returns their legends.
fn write_all(
    picture: &mut Frame,
    orders: &[Order],
    settings: WriteSettings,
    interrupted: &AtomicBool,
) -> Result<Vec<Vec<Option<String>>>, Failure> {
    let mut legends = Vec::new();
    for (number, Order { kinds, targets }) in (1..).zip(orders) {
        let names: Vec<&str> = kinds.iter().map(|kind| &*kind.name).collect();
        let later = orders[number..].iter().flat_map(|order| &order.kinds);
        let is_last = |name: &str| !later.clone().any(|kind| kind.name == name);
        let frame = picture.select(&names, is_last)?;
        legends.push(output::write(&frame, targets, settings, interrupted)?);
    }
    Ok(legends)
}

/// The kinds of all outputs, each once, and the object, from which it is known what was hit.
fn all_kinds(orders: &[Order]) -> Result<Vec<&'static Kind>, Failure> {
    let mut kinds: Vec<&'static Kind> = vec![firsthit::channel::kind("object")?];
    for kind in orders.iter().flat_map(|order| &order.kinds) {
        if kinds.iter().all(|known| known.name != kind.name) {
            kinds.push(kind);
        }
    }
    Ok(kinds)
}

/// What `--json` says of a picture.
fn done(
    job: &Job<'_>,
    orders: &[Order],
    legends: &[Vec<Option<String>>],
    (hits, seconds): (usize, f64),
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
        "samples": job.samples,
        "guessed": job.guessed,
        "objects": job.scene.objects().len(),
        "triangles": job.scene.triangles(),
        "seconds": seconds,
    })
}

/// Says of options that would do nothing that they do: whoever gives them may expect something else, or
/// may give the same options to all runs.
fn idle_options(args: &RenderArgs, orders: &[Order], shader: &Shader) -> Vec<String> {
    let light = &args.light;
    // Mattes take samples and a lens, but no light.
    let has_samples = orders.iter().any(needs_samples);
    let for_lambert = [
        ("--light", !light.light.is_empty()),
        ("--ambient", light.ambient.is_some()),
        ("--no-shadows", light.no_shadows),
    ];
    let for_color = [
        ("--samples", args.picture.samples.is_some() && !has_samples),
        ("--aperture", args.camera.aperture.is_some() && !has_samples),
        ("--focus", args.camera.focus.is_some() && !has_samples),
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

/// Warns of linear colours that look like levels of sRGB.
fn doubtful_colors(light: &LightingArgs) -> Vec<String> {
    let of_background = match light.background {
        Some(Background::Uniform(color)) => Some(color),
        _ => None,
    };
    let colors = [
        ("--ambient", light.ambient),
        ("--color", light.color),
        ("--background", of_background),
        ("--sky", light.sky.map(|sky| sky.horizon)),
        ("--sky", light.sky.map(|sky| sky.zenith)),
    ];
    let doubt = |(name, color): (&str, Option<Color>)| {
        let color = color?;
        let meant = meant_as_levels(color)?;
        let given = crate::hints::triple(color);
        Some(format!(
            "{name} {given}: colours are linear, from 0 to 1; levels from 0 to 255 are written '{meant}'"
        ))
    };
    colors.into_iter().filter_map(doubt).collect()
}

pub(super) fn needs_samples(order: &Order) -> bool {
    order.kinds.iter().any(|kind| kind.needs_samples())
}

pub(super) fn needs_shade(order: &Order) -> bool {
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

fn background(args: &LightingArgs, model: &World, camera: &Camera) -> Background {
    match (args.sky, args.background) {
        (Some(sky), _) => Background::Gradient {
            horizon: sky.horizon,
            zenith: sky.zenith,
            up: camera.view().up,
        },
        (None, Some(background)) => background,
        (None, None) => model.background.unwrap_or(BACKGROUND),
    }
}

/// The scene with its lights, and whether they are guessed.
fn lit(scene: Scene, args: &LightingArgs, model: &World, camera: &Camera) -> (Scene, bool) {
    let lights = lights(args, model, &scene, camera);
    if args.light.is_empty() && model.lights.is_empty() {
        (scene.with_borrowed_lights(lights), true)
    } else {
        (scene.with_lights(lights), false)
    }
}

fn lights(args: &LightingArgs, model: &World, scene: &Scene, camera: &Camera) -> Vec<Light> {
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
