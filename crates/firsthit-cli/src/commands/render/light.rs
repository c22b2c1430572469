//! Light, ground and background, as the command line has them.

use firsthit::scene::PointLight;
use firsthit::shade::{BACKGROUND, LightRig, Resolved};
use firsthit::world::World;
use firsthit::{Background, Camera, DVec2, DVec3, Light, Scene};

use crate::args::LightingArgs;
use crate::failure::Failure;
use crate::values::LightArg;

/// Refuses lights of which some would be ignored.
pub(super) fn check(args: &LightingArgs) -> Result<(), Failure> {
    let rigs: Vec<&str> = rigs(args).map(LightRig::name).collect();
    let own = args.light.iter().find_map(|light| match light {
        LightArg::Light(light) => Some(light.name()),
        LightArg::LightRig(_) => None,
    });
    match (rigs.as_slice(), own) {
        ([first, second, ..], _) => Err(Failure::usage(format!(
            "--light takes one set of lights, not {first} and {second}"
        ))),
        ([rig], Some(own)) => Err(Failure::usage(format!(
            "--light {rig}, a set of lights, and --light {own}, a light, exclude each other"
        ))),
        ([rig], None) if args.environment.is_some() => Err(Failure::usage(format!(
            "--light {rig}, a set of lights, and --environment exclude each other"
        ))),
        ([_], None) | ([], _) => Ok(()),
    }
}

fn rigs(args: &LightingArgs) -> impl Iterator<Item = LightRig> {
    args.light.iter().filter_map(|light| match light {
        LightArg::LightRig(rig) => Some(*rig),
        LightArg::Light(_) => None,
    })
}

/// The set of lights that is asked for; [`check`] knows that there is no second one.
pub(super) fn rig(args: &LightingArgs) -> Option<LightRig> {
    rigs(args).next()
}

pub(super) fn ground(args: &LightingArgs) -> Option<bool> {
    (args.ground || args.no_ground).then_some(args.ground)
}

pub(super) fn background(args: &LightingArgs, model: &World, camera: &Camera) -> Background {
    match (args.sky, args.background) {
        (Some(sky), _) => {
            Background::Gradient { horizon: sky.horizon, zenith: sky.zenith, up: camera.view().up }
        }
        (None, Some(background)) => background,
        (None, None) => model.appearance.background.unwrap_or(BACKGROUND),
    }
}

/// The radiance of a white surface in the middle of the scene that faces a light of the command
/// line.
const BRIGHTNESS: f64 = 0.95;

/// The lights that the command line gives, if any, each as bright in the middle of the scene.
pub(super) fn lights(args: &LightingArgs, scene: &Scene, camera: &Camera) -> Option<Vec<Light>> {
    let centre =
        if scene.bounds().is_empty() { camera.position() } else { scene.bounds().centre() };
    let scaled = |light: &LightArg| match light {
        LightArg::LightRig(_) => None,
        LightArg::Light(light) => Some(light.scaled(BRIGHTNESS / taken(light, centre))),
    };
    let lights: Vec<Light> = args.light.iter().filter_map(scaled).collect();
    (!args.light.is_empty()).then_some(lights)
}

/// The radiance of a white surface at a point that faces a light; 1 where that is no number to
/// divide by.
fn taken(light: &Light, at: DVec3) -> f64 {
    // A spot is as bright where it goes as it would be there.
    let light = match *light {
        Light::Spot(spot) => {
            Light::from(PointLight { position: spot.position, intensity: spot.intensity })
        }
        light => light,
    };
    let arriving = light.sample(at, DVec2::splat(0.5));
    let taken = arriving.map(|arriving| arriving.light.max_element());
    let taken = taken.filter(|&taken| taken > 0.0 && taken < f64::INFINITY);
    taken.unwrap_or(1.0)
}

/// Says that a ground that was asked for is not seen.
pub(super) fn unseen_ground(
    args: &LightingArgs,
    seen: &Resolved,
    camera: &Camera,
) -> Option<String> {
    let why = match seen.ground {
        None => "the scene has no lowest point",
        Some(ground) if ground.is_seen_from(camera.position()) => return None,
        Some(_) => "the camera is below it, as --up says",
    };
    args.ground.then(|| format!("--ground does nothing here: {why}"))
}

/// Says of lights that shine on one side that the whole scene is on the other.
pub(super) fn turned_away(args: &LightingArgs, seen: &Resolved) -> Vec<String> {
    let bounds = seen.scene.bounds();
    if bounds.is_empty() || !seen.shader.is_lit() {
        return Vec::new();
    }
    let corners = bounds.corners();
    let is_behind = |center: DVec3, normal: DVec3| {
        (corners.iter()).all(|&corner| (corner - center).dot(normal) <= 0.0)
    };
    let lights = args.light.iter().filter_map(|light| match light {
        LightArg::Light(Light::Disc(disc)) if is_behind(disc.center, disc.normal) => Some(
            "--light disc shines away from the whole scene: it shines to the side of its NORMAL",
        ),
        LightArg::Light(Light::Rectangle(rectangle))
            if is_behind(
                rectangle.center,
                rectangle.edge_u.cross(rectangle.edge_v),
            ) =>
        {
            Some(
                "--light rectangle shines away from the whole scene: give its two EDGEs in the other order",
            )
        }
        _ => None,
    });
    lights.map(str::to_owned).collect()
}
