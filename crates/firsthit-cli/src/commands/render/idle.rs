//! Options that would do nothing, or not what is meant.

use firsthit::channel::ChannelKind;
use firsthit::edge::{EdgeKind, Edges};
use firsthit::geometry::meant_as_levels;
use firsthit::render::{idle, idle_in_files};
use firsthit::shade::Resolved;
use firsthit::{Background, Color};

use super::coloring::is_coloring;
use super::job::needs_shade;
use super::shader::{AMBIENT, SHADOWS, setting};
use crate::args::{Given, RenderArgs};
use crate::output::Order;

/// The samples after which a noise is asked for first: those of `Picture::noise`.
const FIRST_ASKED: u32 = 32;

/// Says of those `options` that are given that they do nothing.
fn do_nothing<'a>(
    given: &Given,
    options: impl IntoIterator<Item = &'a str>,
    why: &str,
) -> Vec<String> {
    let options = options.into_iter().filter(|option| given.has(option));
    options.map(|option| format!("--{option} does nothing {why}")).collect()
}

/// The warnings about options that would do nothing: users may expect something else of them, or
/// may give equal options to all runs.
pub(super) fn options(
    args: &RenderArgs,
    orders: &[Order],
    edges: Option<&Edges>,
    seen: &Resolved,
) -> Vec<String> {
    let given = &args.given;
    let mut idle = without_channels(given, orders);
    let has_creases = edges.is_none_or(|edges| edges.kinds.has(EdgeKind::Crease));
    let is_told = idle.iter().any(|it| it.starts_with("--edge-angle "));
    if !has_creases && !is_told {
        let why = "without crease among the --edge-kinds";
        idle.extend(do_nothing(given, ["edge-angle"], why));
    }
    if orders.iter().any(needs_shade) {
        idle.extend(with_color(args, seen));
    }
    idle
}

/// Says of those options that are given that they do nothing without other channels.
pub(crate) fn without_channels(given: &Given, orders: &[Order]) -> Vec<String> {
    let kinds = orders.iter().flat_map(|order| &order.kinds);
    let kinds: Vec<&ChannelKind> = kinds.copied().collect();
    without(given, " among the --channels", |name| idle(name, &kinds))
}

/// Says of those options that are given that they do nothing without other files.
pub(super) fn without_files(given: &Given, orders: &[Order]) -> Vec<String> {
    without(given, "", |name| idle_in_files(name, orders.iter().flat_map(Order::files)))
}

fn without(
    given: &Given,
    place: &str,
    needed: impl Fn(&str) -> Option<&'static str>,
) -> Vec<String> {
    let idle = given.options().filter_map(|option| {
        let name = option.trim_start_matches("no-").replace('-', "_");
        Some(format!("--{option} does nothing without {}{place}", needed(&name)?))
    });
    idle.collect()
}

fn with_color(args: &RenderArgs, seen: &Resolved) -> Vec<String> {
    let (given, light, shader) = (&args.given, &args.light, &seen.shader);
    let lacks = |name| setting(shader, name).is_none();
    let of_shader = given.options().filter(|&option| match option {
        "ambient" => lacks(AMBIENT),
        "no-shadows" => lacks(SHADOWS),
        "light" => !shader.is_lit(),
        // One that is not hidden is seen, whatever the shader.
        "environment" => light.environment_hidden && !shader.is_lit(),
        option => is_coloring(option) && !shader.takes_color(),
    });
    let with_shader = format!("with --shader {}", shader.name());
    let mut idle = do_nothing(given, of_shader, &with_shader);
    if light.environment.is_some() && shader.is_lit() && !shader.takes_environment() {
        idle.push(format!(
            "--environment is a background alone {with_shader}: direct, path and whitted take light from it"
        ));
    }
    if shader.name() == "normal" && light.color.is_some() {
        idle.push("--color does nothing with --shader normal, which shows directions".into());
    }
    if seen.samples <= FIRST_ASKED {
        let why = format!(
            "with {} samples: it is asked for after {FIRST_ASKED} first (--samples)",
            seen.samples
        );
        idle.extend(do_nothing(given, ["noise"], &why));
    }
    idle.extend(behind_environment(args, seen));
    idle
}

/// The warnings about a background in whose place an environment is seen.
fn behind_environment(args: &RenderArgs, seen: &Resolved) -> Vec<String> {
    if !(seen.scene.environment()).is_some_and(|environment| environment.is_seen) {
        return Vec::new();
    }
    let alpha = match args.light.background {
        Some(Background::Transparent) => ", and there is no alpha",
        _ => "",
    };
    let why = match args.light.environment {
        Some(_) => "without --environment-hidden: the environment is seen in its place",
        None => "here: the file's environment is seen in its place",
    };
    do_nothing(&args.given, ["background", "sky"], &format!("{why}{alpha}"))
}

/// Warns of linear colours that look like levels of sRGB.
pub(super) fn doubtful_colors(args: &RenderArgs) -> Vec<String> {
    let (light, numbers) = (&args.light, &args.colors);
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
        ("--edge-color", args.edges.edge_color),
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
