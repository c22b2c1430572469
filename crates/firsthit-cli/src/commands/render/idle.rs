//! Options that would do nothing, or not what is meant.

use firsthit::channel::ChannelKind;
use firsthit::edge::{EdgeKind, Edges};
use firsthit::geometry::meant_as_levels;
use firsthit::render::{Resolved, idle, idle_in_files};
use firsthit::{Background, Color};

use super::job::needs_shade;
use super::shader::{AMBIENT, SHADOWS, setting};
use crate::args::{EdgeArgs, LightingArgs, RenderArgs};
use crate::output::Order;

/// The samples after which a noise is asked for first: those of `Picture::noise`.
const FIRST_ASKED: u32 = 32;

/// Says of those options that are given that they do nothing.
pub(crate) fn do_nothing(
    options: impl IntoIterator<Item = (&'static str, bool)>,
    why: &str,
) -> Vec<String> {
    let given = options.into_iter().filter(|(_, is_given)| *is_given);
    given.map(|(name, _)| format!("{name} does nothing {why}")).collect()
}

/// The warnings about options that would do nothing: users may expect something else of them, or
/// may give equal options to all runs.
pub(super) fn options(args: &RenderArgs, orders: &[Order], seen: &Resolved) -> Vec<String> {
    let light = &args.light;
    let options = [
        ("--samples", args.picture.samples.is_some()),
        ("--noise", args.picture.noise.is_some()),
        ("--aperture", args.camera.aperture.is_some()),
        ("--focus", args.camera.focus.is_some()),
        ("--shader", light.shader.is_some()),
        ("--color", light.color.is_some()),
        ("--background", light.background.is_some()),
        ("--sky", light.sky.is_some()),
        ("--light", !light.light.is_empty()),
        ("--environment", light.environment.is_some()),
        ("--ambient", light.ambient.is_some()),
        ("--no-shadows", light.no_shadows),
        ("--set", !light.set.is_empty()),
        ("--ground", light.ground),
        ("--no-ground", light.no_ground),
    ];
    let mut idle = without_channels(options.into_iter().chain(args.colors.given()), orders);
    if orders.iter().any(needs_shade) {
        idle.extend(with_color(args, seen));
    }
    idle
}

/// Says of those options that are given that they do nothing without other channels.
pub(crate) fn without_channels(
    options: impl IntoIterator<Item = (&'static str, bool)>,
    orders: &[Order],
) -> Vec<String> {
    let kinds = orders.iter().flat_map(|order| &order.kinds);
    let kinds: Vec<&ChannelKind> = kinds.copied().collect();
    without(options, " among the --channels", |name| idle(name, &kinds))
}

/// Says of those options that are given that they do nothing without other files.
pub(super) fn without_files(
    options: impl IntoIterator<Item = (&'static str, bool)>,
    orders: &[Order],
) -> Vec<String> {
    let needed = |name: &str| idle_in_files(name, orders.iter().flat_map(Order::files));
    without(options, "", needed)
}

fn without(
    options: impl IntoIterator<Item = (&'static str, bool)>,
    place: &str,
    needed: impl Fn(&str) -> Option<&'static str>,
) -> Vec<String> {
    let given = options.into_iter().filter(|(_, is_given)| *is_given);
    let idle = given.filter_map(|(option, _)| {
        let name = option.trim_start_matches("--").trim_start_matches("no-");
        let needed = needed(&name.replace('-', "_"))?;
        Some(format!("{option} does nothing without {needed}{place}"))
    });
    idle.collect()
}

fn with_color(args: &RenderArgs, seen: &Resolved) -> Vec<String> {
    let (light, shader) = (&args.light, &seen.shader);
    let lacks = |name| setting(shader, name).is_none();
    let with_shader = format!("with --shader {}", shader.name());
    // One that is not hidden is seen, whatever the shader.
    let is_hidden = light.environment.is_some() && light.environment_hidden;
    let of_shader = [
        ("--ambient", light.ambient.is_some() && lacks(AMBIENT)),
        ("--no-shadows", light.no_shadows && lacks(SHADOWS)),
        ("--light", !light.light.is_empty() && !shader.is_lit()),
        ("--environment", is_hidden && !shader.is_lit()),
    ];
    let of_colors = (args.colors.given().into_iter()).filter(|_| !shader.takes_color());
    let mut idle = do_nothing(of_shader.into_iter().chain(of_colors), &with_shader);
    if light.environment.is_some() && shader.is_lit() && !shader.takes_environment() {
        idle.push(format!(
            "--environment is a background alone {with_shader}: direct, path and whitted take light from it"
        ));
    }
    if shader.name() == "normal" && light.color.is_some() {
        idle.push("--color does nothing with --shader normal, which shows directions".into());
    }
    if seen.samples <= FIRST_ASKED {
        let noise = [("--noise", args.picture.noise.is_some())];
        let why = format!(
            "with {} samples: it is asked for after {FIRST_ASKED} first (--samples)",
            seen.samples
        );
        idle.extend(do_nothing(noise, &why));
    }
    idle.extend(behind_environment(light, seen));
    idle
}

/// The warnings about a background in whose place an environment is seen.
fn behind_environment(light: &LightingArgs, seen: &Resolved) -> Vec<String> {
    if !(seen.scene.environment()).is_some_and(|environment| environment.is_seen) {
        return Vec::new();
    }
    let alpha = match light.background {
        Some(Background::Transparent) => ", and there is no alpha",
        _ => "",
    };
    let why = match light.environment {
        Some(_) => "without --environment-hidden: the environment is seen in its place",
        None => "here: the file's environment is seen in its place",
    };
    let options = [("--background", light.background.is_some()), ("--sky", light.sky.is_some())];
    do_nothing(options, &format!("{why}{alpha}"))
}

/// Says the same of options for edges.
pub(super) fn of_edges(args: &EdgeArgs, edges: Option<&Edges>, orders: &[Order]) -> Vec<String> {
    let idle = without_channels(args.given(), orders);
    let has_creases = edges.is_none_or(|edges| edges.kinds.has(EdgeKind::Crease));
    if !idle.is_empty() || has_creases {
        return idle;
    }
    let angle = [("--edge-angle", args.edge_angle.is_some())];
    do_nothing(angle, "without crease among the --edge-kinds")
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
