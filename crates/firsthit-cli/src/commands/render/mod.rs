//! `firsthit render`: what the command line and the file ask for, put together.

mod coloring;
mod idle;
mod job;
mod light;
mod resume;
mod shader;

use std::path::{Path, PathBuf};

use firsthit::channel::PLACEHOLDER;
use firsthit::edge::{EdgeKind, Edges};
use firsthit::inputs;
use firsthit::render::check_state_file;
use firsthit::shade::{Appearance, LightRig, default_samples, default_shader, world_up};
use firsthit::shoot::Cpu;
use firsthit::world::{Output, World};
use firsthit::{Camera, Scene};

use crate::args::{CameraArgs, ColorsArgs, EdgeArgs, Given, LightingArgs, LoadArgs, RenderArgs};
use crate::asked;
use crate::camera::{Chosen, camera, check, of_file};
use crate::console::{is_quiet, warn};
use crate::environment;
use crate::failure::Failure;
use crate::legend;
use crate::loading::{self, Loaded};
use crate::output::{self, ChannelSource, Order};
use crate::progress::Progress;
use crate::threads::with_threads;
use job::{needs_samples, needs_shade};

pub(super) use idle::without_channels;
pub(super) use job::{Job, picture, settings};

/// The default samples of a picture with a noise: it ends them where they are enough.
const SAMPLES_WITH_NOISE: u32 = 256;

pub(crate) fn run(args: &RenderArgs, progress: &Progress) -> Result<(), Failure> {
    check(&args.camera)?;
    light::check(&args.light)?;
    inputs::note(&args.file);
    // Errors in these are told before large files are read.
    if let Some(path) = &args.picture.resume {
        check_state_file(path).map_err(|error| Failure::of_options(error, &["resume"]))?;
    }
    let asked = (!args.picture.output.is_empty()).then(|| orders(args, &[])).transpose()?;
    output::kinds(&args.picture.channels, ChannelSource::Camera, true)?;
    if let Some(orders) = &asked {
        check_others(args, orders)?;
    }
    with_threads(args.run.threads, || {
        let settings = loading::settings(&args.file, &args.scene.load);
        let build = |model: &World| args.scene.trees.settings(rays(args, model, asked.as_deref()));
        let loaded = loading::read_with(&args.file, &settings, build, args.light.color, progress)?;
        loaded.check_surfaces(&args.file)?;
        rendered(args, loaded.picked(&args.scene.pick)?, asked, progress)
    })
}

/// The approximate number of rays of a picture; `None` where it depends on its camera, its shader
/// or its noise. `asked` are the outputs that the command line names.
fn rays(args: &RenderArgs, model: &World, asked: Option<&[Order]>) -> Option<u64> {
    let made;
    let orders = if let Some(orders) = asked {
        orders
    } else {
        made = orders(args, &model.outputs).ok()?;
        &made
    };
    let mut kinds = orders.iter().flat_map(|order| &order.kinds);
    if args.picture.noise.is_some() || kinds.any(|kind| kind.name.starts_with("ao")) {
        return None;
    }
    let [rows, columns] = match args.camera.size {
        Some(size) => size,
        None if args.camera.colmap.is_some() => return None,
        None => of_file(&args.camera, model).ok()?.size(),
    };
    let pixels = (columns as u64).saturating_mul(rows as u64);
    if !orders.iter().any(needs_samples) {
        return Some(pixels);
    }
    let said = &model.appearance;
    let rig = light::rig(&args.light).or(said.rig);
    let shader = shader::shader(&args.light, said.shader.as_ref(), rig).ok()?;
    let shader = shader.unwrap_or_else(|| default_shader(rig));
    let of_hit = shader.rays_per_hit(model.lights.len().max(1))?;
    let has_ground = light::ground(&args.light).or(said.ground);
    let has_ground = has_ground.unwrap_or(rig.is_some_and(|rig| rig != LightRig::Shoulder));
    let samples = args.picture.samples.or(said.samples);
    let samples = samples.unwrap_or(default_samples(shader.is_random() || has_ground));
    let of_pixel = u64::from(samples).saturating_mul(1 + of_hit as u64);
    Some(pixels.saturating_mul(of_pixel))
}

/// Makes the picture. `asked` is what the command line says already of what goes where.
fn rendered(
    args: &RenderArgs,
    loaded: Loaded,
    asked: Option<Vec<Order>>,
    progress: &Progress,
) -> Result<(), Failure> {
    let Loaded { scene, warnings, model, .. } = loaded;
    let orders = all_orders(args, asked, &model.outputs)?;
    let has_colors = orders.iter().any(needs_shade);
    let edges = edges(&args.edges, model.edges);
    warn(&idle::doubtful_colors(args));
    warn(&warnings);
    let base = of_file(&args.camera, &model)?;
    let chosen = camera(&args.camera, (&args.file, &base), &scene, &model)?;
    let Chosen { camera, mut guessed } = chosen;
    let noise = args.picture.noise.filter(|_| has_colors);
    let (lit, mut appearance) = asked_for(&Asked::of(args), &model, scene, &camera)?;
    // Now everything is read.
    output::check_orders(&orders)?;
    check_others(args, &orders)?;
    let samples = args.picture.samples.or(model.appearance.samples);
    appearance.samples = samples.or(noise.map(|_| SAMPLES_WITH_NOISE));
    let seen = appearance.resolve(&lit, Some(&camera))?;
    warn(&idle::options(args, &orders, edges.as_ref(), &seen));
    if has_colors {
        warn(&light::turned_away(&args.light, &seen));
        warn(light::unseen_ground(&args.light, &seen, &camera).as_slice());
        let shown =
            seen.guessed.iter().map(|guess| format!("{} (--{})", guess.what, guess.setting));
        guessed.extend(shown);
        if noise.is_some() && args.picture.samples.or(model.appearance.samples).is_none() {
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
        settings: settings(&args.given, &args.picture.files, shown, &orders),
        is_rounded: args.picture.files.is_rounded(),
        guessed: &guessed,
        legend: args.picture.legend.as_deref(),
        cull: args.cull,
        edges,
    };
    picture(&job, &orders, &args.run, progress)
}

/// The command line's words on a picture's appearance.
pub(crate) struct Asked<'a> {
    pub(crate) given: &'a Given,
    pub(crate) camera: &'a CameraArgs,
    pub(crate) light: &'a LightingArgs,
    pub(crate) colors: &'a ColorsArgs,
    pub(crate) load: &'a LoadArgs,
}

impl<'a> Asked<'a> {
    fn of(args: &'a RenderArgs) -> Self {
        Self {
            given: &args.given,
            camera: &args.camera,
            light: &args.light,
            colors: &args.colors,
            load: &args.scene.load,
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
    // The file's word on sets of lights is about its own light.
    let has_light = args.light.environment.is_some() || !args.light.light.is_empty();
    let said = &model.appearance;
    let rig = light::rig(args.light).or(said.rig.filter(|_| !has_light));
    let shader = shader::shader(args.light, said.shader.as_ref(), rig)?;
    let scene = match light::lights(args.light, &scene, camera) {
        Some(lights) => scene.with_lights(lights),
        None => scene.with_lights(model.lights.clone()),
    };
    // Of a standard view, up is the world's; of a camera that is aimed, it may be the picture's
    // alone.
    let is_view = args.camera.aim.is_none() && args.camera.look_at.is_none();
    let scene_up = (args.camera.up.filter(|_| is_view)).unwrap_or_else(|| model.up_in(&scene));
    let scene = scene.with_environment(model.environment.clone()).with_up(scene_up);
    let up = world_up(&scene, Some(camera));
    let scene = environment::lit(scene, args.light, args.load, up)?;
    let appearance = Appearance {
        shader,
        rig,
        background: Some(light::background(args.light, model, camera)),
        ground: light::ground(args.light).or(said.ground),
        coloring: coloring::coloring((args.given, args.colors), said.coloring.as_ref())?,
        samples: said.samples,
    };
    Ok((scene, appearance))
}

/// Outputs and their files, none of them a file that was read so far.
fn all_orders(
    args: &RenderArgs,
    asked: Option<Vec<Order>>,
    outputs: &[Output],
) -> Result<Vec<Order>, Failure> {
    let is_of_file = asked.is_none() && args.picture.channels.is_empty() && !outputs.is_empty();
    let blamed = |failure: Failure| {
        if is_of_file { failure.in_file(&args.file) } else { failure }
    };
    let orders = asked.map_or_else(|| orders(args, outputs), Ok);
    let orders = orders.map_err(blamed)?;
    output::check_orders(&orders).map_err(blamed)?;
    check_others(args, &orders)?;
    Ok(orders)
}

/// Checks the files beside the outputs.
fn check_others(args: &RenderArgs, orders: &[Order]) -> Result<(), Failure> {
    if let Some(path) = &args.picture.legend {
        legend::check(path, orders)?;
    }
    if let Some(path) = &args.picture.resume {
        resume::check(path, orders)?;
    }
    Ok(())
}

/// The outputs with their channels: as the command line says, else as the file says, else a picture
/// with the file's name.
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
        own.map(|output| (output.path.clone(), output.channels.clone())).collect()
    } else {
        let own = of_file.iter();
        own.map(|output| {
            let output = output.with_channels(&args.file, asked.clone())?;
            Ok((output.path, output.channels))
        })
        .collect::<Result<_, Failure>>()?
    };
    output::orders(&outputs, is_quiet())
}

/// The input's name with the extension of a picture, in the current folder.
fn default_output(input: &Path) -> PathBuf {
    // Not `set_extension`: `part.v2.stl` becomes `part.v2.png`.
    let mut name = input.file_stem().unwrap_or_else(|| "render".as_ref()).to_owned();
    name.push(".png");
    name.into()
}

/// The lines along edges: as the command line says, the rest as the file says; `None` where neither
/// asks for any.
fn edges(args: &EdgeArgs, of_file: Option<Edges>) -> Option<Edges> {
    if args.no_edges {
        return None;
    }
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
    if *args == EdgeArgs::default() { of_file } else { Some(asked) }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use firsthit::Shader;

    use super::*;

    /// About how many rays the options stand for, with 100 pixels and a file without lights.
    fn rays_of(options: &str) -> Option<u64> {
        #[derive(Parser)]
        struct Options {
            #[command(flatten)]
            render: RenderArgs,
        }
        let words = format!("render a.ply --size 20x5 {options}");
        let args = Options::try_parse_from(words.split_whitespace()).unwrap().render;
        rays(&args, &World::default(), None)
    }

    #[test]
    fn rays_are_those_of_samples_that_a_picture_takes_and_of_its_light() {
        for (options, expected) in [
            ("", Some(100 * 16 * 3)),
            ("--samples 1", Some(100 * 3)),
            ("--channels z,normal -o z.exr", Some(100)),
            ("--channels z -o z.exr --samples 9", Some(100)),
            ("--channels color,z -o a.exr --shader lambert", Some(100 * 4 * 2)),
            ("--light shoulder", Some(100 * 4 * 2)),
            ("--ambient 0.1,0.1,0.1", Some(100 * 4 * 2)),
            ("--shader lambert --ground", Some(100 * 16 * 2)),
            ("--shader phong --samples 2", Some(100 * 2 * 2)),
            ("--shader ao", Some(100 * 16 * 2)),
            ("--channels color,ao -o a.exr", None),
            ("--noise 0.1", None),
        ] {
            assert_eq!(rays_of(options), expected, "{options}");
        }
    }

    #[test]
    fn shaders_whose_rays_go_on_have_no_number_of_rays() {
        for name in Shader::NAMES {
            let expected = match *name {
                "hemisphere" | "matcap" | "unlit" | "normal" => Some(100),
                "direct" => Some(100 * 3),
                "lambert" | "phong" | "blinn-phong" | "ao" => Some(100 * 2),
                _ => None,
            };
            let found = rays_of(&format!("--shader {name} --samples 1"));
            assert_eq!(found, expected, "{name}");
        }
    }
}
