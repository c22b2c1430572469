use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use firsthit::channel::Kind;
use firsthit::edge::{EdgeKind, Edges};
use firsthit::geometry::{Setting, Value as SettingValue, meant_as_levels};
use firsthit::image::{Data, Frame, Origin, WriteSettings};
use firsthit::render::{Appearance, BACKGROUND, Picture, Resolved, work, world_up};
use firsthit::shade::LightRig;
use firsthit::shoot::Cpu;
use firsthit::world::{Output, World};
use firsthit::{
    Background, Camera, Color, DVec2, DisplayTransform, Light, Scene, Shader, Shading, Side,
};
use serde_json::{Value, json};

use super::coloring;
use crate::args::{ColorsArgs, DisplayArgs, EdgeArgs, LightingArgs, RenderArgs, RunArgs};
use crate::asked;
use crate::camera::{Chosen, camera, check, of_file};
use crate::console::{counted, end_report, say, warn};
use crate::environment;
use crate::failure::Failure;
use crate::legend;
use crate::loading::{self, Loaded, with_threads};
use crate::output::{self, Order, Source};
use crate::progress::Progress;
use crate::values::LightArg;

const DEFAULT_SHADER: &str = "direct";
const LAMBERT: &str = "lambert";

// Settings that have options of their own.
const AMBIENT: &str = "ambient";
const SHADOWS: &str = "shadows";

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
        let files = files.into_iter().chain(environment::file(&args.light));
        let files: Vec<PathBuf> = files.collect();
        let orders = all_orders(args, asked, &model.outputs, &files)?;
        let shader = shader(&args.light, model.shader.as_ref())?;
        let edges = edges(&args.edges, model.edges);
        warn(&idle_edges(&args.edges, edges.as_ref(), &orders));
        warn(&doubtful_colors(
            &args.light,
            &args.colors,
            args.edges.edge_color,
        ));
        warn(&warnings);
        let base = of_file(&args.camera, &model)?;
        let chosen = camera(&args.camera, (&args.file, &base), &scene, &model)?;
        let Chosen {
            camera,
            mut guessed,
        } = chosen;
        let seen = seen(args, &model, scene, &camera, shader)?;
        warn(&idle_options(args, &orders, &seen.shader));
        if orders.iter().any(needs_shade) {
            guessed.extend(seen.guessed.iter().map(|&what| what.to_owned()));
        }
        let job = Job {
            scene: &seen.scene,
            camera: &camera,
            shade: &seen.shading(Cpu::shared()),
            samples: seen.samples,
            noise: args.picture.noise,
            resume: args.picture.resume.as_deref(),
            settings: settings(
                args.picture.png_scale,
                &args.picture.display,
                model.display,
                &orders,
            ),
            guessed: &guessed,
            legend: args.picture.legend.as_deref(),
            cull: args.cull.map(From::from),
            edges,
        };
        picture(&job, &orders, &args.run, interrupted)
    })
}

/// The scene with its light, and all else that a picture of it looks like.
fn seen(
    args: &RenderArgs,
    model: &World,
    scene: Scene,
    camera: &Camera,
    shader: Option<Shader>,
) -> Result<Resolved, Failure> {
    let scene = match lights(&args.light, &scene, camera) {
        Some(lights) => scene.with_lights(lights),
        None => scene.with_lights(model.lights.clone()),
    };
    // Of a standard view, up is the world's; of a camera that is aimed, it may be the picture's alone.
    let is_view = args.camera.aim.is_none() && args.camera.look_at.is_none();
    let scene_up = (args.camera.up.filter(|_| is_view)).unwrap_or_else(|| model.up_in(&scene));
    let scene = scene
        .with_environment(model.environment.clone())
        .with_up(scene_up);
    let up = world_up(&scene, Some(camera));
    let scene = environment::lit(scene, &args.light, &args.load, up)?;
    // What the file says of sets of lights is about its own light.
    let rig = rig(&args.light).or(model.rig.filter(|_| args.light.environment.is_none()));
    let appearance = Appearance {
        shader,
        rig,
        background: Some(background(&args.light, model, camera)),
        ground: ground(&args.light).or(model.ground),
        coloring: coloring::coloring(&args.colors, model.coloring.as_ref())?,
        samples: args.picture.samples.or(model.samples),
    };
    Ok(appearance.resolve(&scene, Some(camera))?)
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
    /// The noise at which no more samples are taken.
    pub(crate) noise: Option<f64>,
    /// The file of the state, to go on with.
    pub(crate) resume: Option<&'a Path>,
    pub(crate) settings: WriteSettings,
    /// What was guessed, in words, each with the option that says otherwise.
    pub(crate) guessed: &'a [String],
    /// The file of `--legend`.
    pub(crate) legend: Option<&'a Path>,
    /// The side of surfaces that the camera's rays pass through.
    pub(crate) cull: Option<Side>,
    /// Lines along edges.
    pub(crate) edges: Option<Edges>,
}

/// How files are written; says so where the scale, the exposure or the tone map does nothing. `of_file` is how the input wants
/// its colours shown.
pub(super) fn settings(
    png_scale: Option<f64>,
    args: &DisplayArgs,
    of_file: DisplayTransform,
    orders: &[Order],
) -> WriteSettings {
    if png_scale.is_some() && !orders.iter().any(output::takes_scale) {
        warn(&["--png-scale does nothing without t, range or z in a .png"]);
    }
    let for_color = [
        ("--exposure", args.exposure.is_some()),
        ("--tone-map", args.tone_map.is_some()),
    ];
    if !orders.iter().any(output::shows_colors) {
        warn(&do_nothing(&for_color, "without color in a .png"));
    }
    let display = DisplayTransform {
        exposure: args.exposure.unwrap_or(of_file.exposure),
        tone_map: args.tone_map.unwrap_or(of_file.tone_map),
    };
    WriteSettings { png_scale, display }
}

/// Says of those options that are given that they do nothing.
fn do_nothing(options: &[(&str, bool)], why: &str) -> Vec<String> {
    let given = options.iter().filter(|(_, is_given)| *is_given);
    given
        .map(|(name, _)| format!("{name} does nothing {why}"))
        .collect()
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
        noise,
        resume,
        settings,
        legend,
        cull,
        edges,
        ..
    } = job;
    let kinds = all_kinds(orders)?;
    let total = work(camera.pixels(), &kinds, samples);
    let progress = Progress::new(total, args.quiet || args.json, interrupted);
    let picture = Picture {
        samples,
        noise,
        cull,
        edges,
        ..Picture::new(scene, camera, shade, &kinds)
    };
    let mut whole = match resume {
        Some(path) => resumed(&picture, path, &progress)?,
        None => picture.render(&progress)?,
    };
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
    tell(job, (orders, &legends), args, (hit, seconds))
}

/// Says that a picture is made.
fn tell(
    job: &Job<'_>,
    (orders, legends): (&[Order], &[Vec<Option<String>>]),
    args: &RunArgs,
    (hit, seconds): (usize, f64),
) -> Result<(), Failure> {
    let &Job {
        scene,
        camera,
        guessed,
        ..
    } = job;
    let pixels = camera.pixels() as u64;
    if args.json {
        let done = done(job, orders, legends, (hit, seconds));
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
        for (order, legends) in orders.iter().zip(legends) {
            output::say_legends(&order.targets, legends);
        }
    }
    Ok(())
}

/// Makes a picture from where a file says it was left, if it is there, and keeps its state in that file.
fn resumed(picture: &Picture<'_>, path: &Path, progress: &Progress) -> Result<Frame, Failure> {
    let (shaded, plain): (Vec<&Kind>, Vec<&Kind>) =
        picture.channels.iter().partition(|kind| kind.needs_shade());
    let shaded = Picture {
        channels: &shaded,
        ..picture.clone()
    };
    let plain = Picture {
        channels: &plain,
        noise: None,
        ..picture.clone()
    };
    let mut going_on = if path.exists() {
        shaded.resume_from(path)?
    } else {
        shaded.start()?
    };
    let mut kept = Instant::now();
    while going_on.samples() < picture.samples && going_on.add_sample(progress)? {
        // What is done is not lost, whatever happens.
        if kept.elapsed() > KEPT_EVERY {
            going_on.state()?.save(path)?;
            kept = Instant::now();
        }
    }
    going_on.state()?.save(path)?;
    let (colors, others) = (going_on.frame()?, plain.render(progress)?);
    let origin = colors.origin().clone();
    let mut whole = Frame::new(colors.shape().to_vec()).from_origin(Origin {
        names: others.origin().names.clone(),
        cryptomatte: others.origin().cryptomatte.clone(),
        ..origin
    });
    let mut made = [colors.into_channels(), others.into_channels()].concat();
    // In the order that was asked for.
    let place = |name: &str| picture.channels.iter().position(|kind| kind.name == name);
    made.sort_by_key(|channel| place(&channel.name));
    for channel in made {
        whole.push(channel)?;
    }
    Ok(whole)
}

/// How often the state of a picture is kept.
const KEPT_EVERY: Duration = Duration::from_secs(20);

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
    let for_lights = [
        ("--light", !light.light.is_empty()),
        ("--environment", light.environment.is_some()),
    ];
    let for_shader = [
        (
            "--ambient",
            light.ambient.is_some() && setting(shader, AMBIENT).is_none(),
        ),
        (
            "--no-shadows",
            light.no_shadows && setting(shader, SHADOWS).is_none(),
        ),
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
    if !orders.iter().any(needs_shade) {
        let for_shader = [
            ("--ambient", light.ambient.is_some()),
            ("--no-shadows", light.no_shadows),
            ("--set", !light.set.is_empty()),
            ("--ground", light.ground),
            ("--no-ground", light.no_ground),
        ];
        let all = [for_color.as_slice(), &for_lights, &for_shader].concat();
        let mut idle = do_nothing(&all, WITHOUT_COLOR);
        idle.extend(coloring::idle(&args.colors, shader, Some(WITHOUT_COLOR)));
        return idle;
    }
    let with_shader = format!("with --shader {}", shader.name());
    let mut idle = do_nothing(&for_shader, &with_shader);
    if !shader.is_lit() {
        idle.extend(do_nothing(&for_lights, &with_shader));
    }
    idle.extend(coloring::idle(&args.colors, shader, None));
    if shader.name() == "normal" && light.color.is_some() {
        idle.push("--color does nothing with --shader normal, which shows directions".into());
    }
    idle
}

/// The lines along edges: as the command line says, the rest as the file says; `None` where neither asks for any.
fn edges(args: &EdgeArgs, of_file: Option<Edges>) -> Option<Edges> {
    let is_asked = args.given().iter().any(|(_, is_given)| *is_given);
    let usual = of_file.unwrap_or_default();
    let mut kinds = args.edge_kinds.unwrap_or(usual.kinds);
    if args.wireframe {
        kinds = kinds.with(EdgeKind::Wireframe);
    }
    let asked = Edges {
        width: args.edges.unwrap_or(usual.width),
        angle: args.edge_angle.unwrap_or(usual.angle),
        kinds,
        hidden: args.hidden_edges.or(usual.hidden),
        color: args.edge_color.unwrap_or(usual.color),
    };
    if is_asked { Some(asked) } else { of_file }
}

/// Says the same of options for edges.
fn idle_edges(args: &EdgeArgs, edges: Option<&Edges>, orders: &[Order]) -> Vec<String> {
    let has_color = orders.iter().any(needs_shade);
    let has_edge = (orders.iter()).any(|order| order.kinds.iter().any(|kind| kind.is_edge()));
    let has_creases = edges.is_none_or(|edges| edges.kinds.has(EdgeKind::Crease));
    let why = |name: &str| {
        if !has_color && !has_edge {
            Some("without color or edge among the --channels")
        } else if name == "--edge-color" && !has_color {
            Some(WITHOUT_COLOR)
        } else if name == "--edge-angle" && !has_creases {
            Some("without crease among the --edge-kinds")
        } else {
            None
        }
    };
    let given = args.given().into_iter();
    let given = given.filter(|(_, is_given)| *is_given);
    given
        .filter_map(|(name, _)| Some(format!("{name} does nothing {}", why(name)?)))
        .collect()
}

/// Warns of linear colours that look like levels of sRGB.
fn doubtful_colors(
    light: &LightingArgs,
    numbers: &ColorsArgs,
    of_edges: Option<Color>,
) -> Vec<String> {
    let of_background = match light.background {
        Some(Background::Uniform(color)) => Some(color),
        _ => None,
    };
    let colors = [
        ("--color-below", numbers.color_below),
        ("--color-above", numbers.color_above),
        ("--color-missing", numbers.color_missing),
        ("--ambient", light.ambient),
        ("--color", light.color),
        ("--background", of_background),
        ("--sky", light.sky.map(|sky| sky.horizon)),
        ("--sky", light.sky.map(|sky| sky.zenith)),
        ("--edge-color", of_edges),
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

/// The shader that the command line and the file ask for; `None` where they do not.
fn shader(args: &LightingArgs, of_file: Option<&Shader>) -> Result<Option<Shader>, Failure> {
    let named = args.shader.as_deref();
    // Ambient light is that of one shader.
    let named = named.or_else(|| args.ambient.map(|_| LAMBERT));
    let mut shader = match (named, of_file) {
        // The file's settings go with the file's shader.
        (Some(name), Some(shader)) if shader.name() == name => shader.clone(),
        (Some(name), _) => Shader::named(name)?,
        (None, Some(shader)) => shader.clone(),
        (None, None) if args.set.is_empty() && !args.no_shadows => return Ok(None),
        (None, None) => Shader::named(DEFAULT_SHADER)?,
    };
    for (name, text) in &args.set {
        set(&mut shader, name, text)?;
    }
    if let Some(ambient) = args.ambient.filter(|_| setting(&shader, AMBIENT).is_some()) {
        shader.set(AMBIENT, SettingValue::Vector(ambient))?;
    }
    if args.no_shadows && setting(&shader, SHADOWS).is_some() {
        shader.set(SHADOWS, SettingValue::Flag(false))?;
    }
    Ok(Some(shader))
}

/// Sets what `--set` says.
fn set(shader: &mut Shader, name: &str, text: &str) -> Result<(), Failure> {
    let Some(setting) = setting(shader, name) else {
        let known: Vec<&str> = shader.list().iter().map(|known| known.name).collect();
        let known = if known.is_empty() {
            "none".to_owned()
        } else {
            known.join(", ")
        };
        return Err(Failure::usage(format!(
            "--set {name}: the shader {} has the settings {known}",
            shader.name()
        )));
    };
    let value = setting.domain.parsed(text).ok_or_else(|| {
        let expected = setting.domain.expected();
        Failure::usage(format!("--set {name} must be {expected}, got {text}"))
    })?;
    Ok(shader.set(name, value)?)
}

fn setting(shader: &Shader, name: &str) -> Option<&'static Setting> {
    shader.list().iter().find(|known| known.name == name)
}

fn rig(args: &LightingArgs) -> Option<LightRig> {
    args.light.iter().find_map(|light| match light {
        LightArg::LightRig(rig) => Some(*rig),
        LightArg::Light(_) => None,
    })
}

fn ground(args: &LightingArgs) -> Option<bool> {
    (args.ground || args.no_ground).then_some(args.ground)
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

/// What a white surface takes in the middle of the scene that faces a light of the command line.
const BRIGHTNESS: f64 = 0.95;

/// The lights that the command line gives, if any, each as bright in the middle of the scene.
fn lights(args: &LightingArgs, scene: &Scene, camera: &Camera) -> Option<Vec<Light>> {
    let centre = if scene.bounds().is_empty() {
        camera.position()
    } else {
        scene.bounds().centre()
    };
    let scaled = |light: &LightArg| match light {
        LightArg::LightRig(_) => None,
        LightArg::Light(light) => {
            let arriving = light.arriving(centre, DVec2::splat(0.5));
            let taken = arriving.map_or(1.0, |arriving| arriving.light.max_element());
            Some(light.scaled(BRIGHTNESS / taken))
        }
    };
    let lights: Vec<Light> = args.light.iter().filter_map(scaled).collect();
    (!args.light.is_empty()).then_some(lights)
}
