//! `firsthit render`: what the command line and the file ask for, put together.

mod coloring;
mod idle;
mod job;
mod light;
mod resume;
mod shader;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use firsthit::channel::PLACEHOLDER;
use firsthit::edge::{EdgeKind, Edges};
use firsthit::render::{Appearance, check_state_file, world_up};
use firsthit::shoot::Cpu;
use firsthit::world::{Output, World};
use firsthit::{Camera, Scene, Shader};

use crate::args::{CameraArgs, ColorsArgs, EdgeArgs, LightingArgs, LoadArgs, RenderArgs};
use crate::asked;
use crate::camera::{Chosen, camera, check, of_file};
use crate::console::warn;
use crate::environment;
use crate::failure::Failure;
use crate::legend;
use crate::loading::{self, Loaded, with_threads};
use crate::output::{self, Order, Source};
use job::needs_shade;

pub(super) use idle::{WITHOUT_COLOR, do_nothing};
pub(super) use job::{Job, needs_samples, picture, settings};

/// The samples of a picture with a noise, where nobody says how many: it ends them where they are enough.
const SAMPLES_WITH_NOISE: u32 = 256;

pub(crate) fn run(args: &RenderArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    check(&args.camera)?;
    light::check(&args.light)?;
    // What is wrong with these is told before large files are read.
    if let Some(path) = &args.picture.resume {
        check_state_file(path)?;
    }
    let asked = (!args.picture.output.is_empty())
        .then(|| orders(args, &[]))
        .transpose()?;
    output::kinds(&args.picture.channels, Source::Camera, true)?;
    if let Some(orders) = &asked {
        check_others(args, orders, &[])?;
    }
    with_threads(&args.run, || {
        let settings = loading::settings(&args.load);
        let build = |model: &World| args.trees.settings(rays(args, model));
        let loaded = loading::read_with(&args.file, &settings, build, args.light.color)?;
        rendered(args, loaded.picked(&args.pick)?, asked, interrupted)
    })
}

/// About how many rays a picture takes; `None` where nobody knows before its camera, its shader or its noise.
fn rays(args: &RenderArgs, model: &World) -> Option<u64> {
    /// Shaders that send no more than a ray to each light from what a camera's ray meets.
    const FEW: [&str; 7] = [
        "direct",
        "lambert",
        "phong",
        "blinn-phong",
        "matcap",
        "unlit",
        "normal",
    ];
    /// As many as there are by default at most.
    const SAMPLES: u32 = 16;
    let shader = args.light.shader.as_deref();
    let shader = shader.or(model.shader.as_ref().map(Shader::name));
    let goes_on = shader.is_some_and(|name| !FEW.contains(&name));
    let has_occlusion = |name: &String| name.starts_with("ao");
    let outputs = model.outputs.iter().flat_map(|output| &output.channels);
    let mut channels = args.picture.channels.iter().chain(outputs);
    if goes_on || args.picture.noise.is_some() || channels.any(has_occlusion) {
        return None;
    }
    let (columns, rows) = match args.camera.size {
        Some(size) => size,
        None if args.camera.colmap.is_some() => return None,
        None => of_file(&args.camera, model).ok()?.size(),
    };
    let samples = args.picture.samples.or(model.samples).unwrap_or(SAMPLES);
    let pixels = (columns as u64).saturating_mul(rows as u64);
    let of_sample = 1 + model.lights.len().max(1) as u64;
    Some(
        pixels
            .saturating_mul(u64::from(samples))
            .saturating_mul(of_sample),
    )
}

/// Makes the picture. `asked` is what the command line says already of what goes where.
fn rendered(
    args: &RenderArgs,
    loaded: Loaded,
    asked: Option<Vec<Order>>,
    interrupted: &AtomicBool,
) -> Result<(), Failure> {
    let Loaded {
        scene,
        warnings,
        model,
        files,
        ..
    } = loaded;
    let files = files.into_iter().chain(environment::file(&args.light));
    let files: Vec<PathBuf> = files.collect();
    let orders = all_orders(args, asked, &model.outputs, &files)?;
    let has_colors = orders.iter().any(needs_shade);
    let edges = edges(&args.edges, model.edges);
    warn(&idle::of_edges(&args.edges, edges.as_ref(), &orders));
    warn(&idle::doubtful_colors(args));
    warn(&warnings);
    let base = of_file(&args.camera, &model)?;
    let chosen = camera(&args.camera, (&args.file, &base), &scene, &model)?;
    let Chosen {
        camera,
        mut guessed,
    } = chosen;
    let noise = args.picture.noise.filter(|_| has_colors);
    let (lit, mut appearance) = asked_for(&Asked::of(args), &model, scene, &camera)?;
    let samples = args.picture.samples.or(model.samples);
    appearance.samples = samples.or(noise.map(|_| SAMPLES_WITH_NOISE));
    let seen = appearance.resolve(&lit, Some(&camera))?;
    warn(&idle::options(args, &orders, &seen));
    if has_colors {
        warn(&light::turned_away(&args.light, &seen));
        guessed.extend(seen.guessed.iter().map(|&what| what.to_owned()));
        if noise.is_some() && args.picture.samples.or(model.samples).is_none() {
            guessed.push(format!("up to {} samples (--samples)", seen.samples));
        }
    }
    let shown = (&args.picture.display, model.display);
    let job = Job {
        scene: &seen.scene,
        camera: &camera,
        shade: &seen.shading(Cpu::shared()),
        samples: seen.samples,
        noise,
        resume: args.picture.resume.as_deref(),
        settings: settings(args.picture.png_scale, shown, &orders),
        guessed: &guessed,
        legend: args.picture.legend.as_deref(),
        cull: args.cull.map(From::from),
        edges,
    };
    picture(&job, &orders, &args.run, interrupted)
}

/// What the command line says of how a picture looks.
pub(crate) struct Asked<'a> {
    pub(crate) camera: &'a CameraArgs,
    pub(crate) light: &'a LightingArgs,
    pub(crate) colors: &'a ColorsArgs,
    pub(crate) load: &'a LoadArgs,
}

impl<'a> Asked<'a> {
    fn of(args: &'a RenderArgs) -> Self {
        Self {
            camera: &args.camera,
            light: &args.light,
            colors: &args.colors,
            load: &args.load,
        }
    }

    /// Refuses lights of which some would be ignored.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        check(self.camera)?;
        light::check(self.light)
    }
}

/// The scene with its own light, and what a picture of it is to look like.
pub(crate) fn asked_for(
    args: &Asked<'_>,
    model: &World,
    scene: Scene,
    camera: &Camera,
) -> Result<(Scene, Appearance), Failure> {
    // What the file says of sets of lights is about its own light.
    let has_light = args.light.environment.is_some() || !args.light.light.is_empty();
    let rig = light::rig(args.light).or(model.rig.filter(|_| !has_light));
    let shader = shader::shader(args.light, model.shader.as_ref(), rig)?;
    let scene = match light::lights(args.light, &scene, camera) {
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
    let scene = environment::lit(scene, args.light, args.load, up)?;
    let appearance = Appearance {
        shader,
        rig,
        background: Some(light::background(args.light, model, camera)),
        ground: light::ground(args.light).or(model.ground),
        coloring: coloring::coloring(args.colors, model.coloring.as_ref())?,
        samples: model.samples,
    };
    Ok((scene, appearance))
}

/// What goes where, none of it over an input.
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
    check_others(args, &orders, files)?;
    Ok(orders)
}

/// Checks the files beside the outputs.
fn check_others(args: &RenderArgs, orders: &[Order], inputs: &[PathBuf]) -> Result<(), Failure> {
    if let Some(path) = &args.picture.legend {
        legend::check(path, orders, inputs)?;
    }
    if let Some(path) = &args.picture.resume {
        resume::check(path, orders, inputs)?;
    }
    Ok(())
}

/// What goes where: as the command line says, else as the file says, else a picture with the file's name.
fn orders(args: &RenderArgs, of_file: &[Output]) -> Result<Vec<Order>, Failure> {
    let asked = &args.picture.channels;
    let with_channels = |path: &PathBuf| (path.clone(), asked::channels(asked, path));
    let outputs: Vec<(PathBuf, Vec<String>)> = if !args.picture.output.is_empty() {
        args.picture.output.iter().map(with_channels).collect()
    } else if of_file.is_empty() {
        let path = default_output(&args.file);
        if path.to_string_lossy().contains(PLACEHOLDER) {
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
        let own = of_file.iter();
        own.map(|output| {
            let output = output.with_channels(&args.file, asked.clone())?;
            Ok((output.path, output.channels))
        })
        .collect::<Result<_, Failure>>()?
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

/// The lines along edges: as the command line says, the rest as the file says; `None` where neither asks for any.
fn edges(args: &EdgeArgs, of_file: Option<Edges>) -> Option<Edges> {
    if args.no_edges {
        return None;
    }
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
