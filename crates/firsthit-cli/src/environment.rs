//! Light from all around, as the command line has it.

use std::path::PathBuf;
use std::sync::Arc;

use firsthit::geometry::rotation;
use firsthit::load::{LoadSettings, load_environment};
use firsthit::scene::{Daylight, Environment, EnvironmentKind};
use firsthit::{DVec3, Scene};

use crate::args::{LightingArgs, LoadArgs};
use crate::console::warn;
use crate::failure::Failure;

/// A picture of all directions, or the sky of a day.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum EnvironmentArg {
    File { path: PathBuf, degrees: f64 },
    Daylight { elevation: f64, azimuth: f64 },
}

const DAYLIGHT: &str = "daylight:";

pub(crate) fn parse(text: &str) -> Result<EnvironmentArg, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    if let Some(angles) = text.strip_prefix(DAYLIGHT) {
        let (elevation, azimuth) = angles.split_once(',').unwrap_or((angles, "0"));
        let (low, high) = Daylight::ELEVATIONS;
        let elevation = number(elevation).filter(|&degrees| (low..=high).contains(&degrees));
        return match (elevation, number(azimuth)) {
            (Some(elevation), Some(azimuth)) => Ok(EnvironmentArg::Daylight { elevation, azimuth }),
            _ => Err(format!(
                "expected degrees above the horizon, from {low} to {high}, and around, such as daylight:35,120"
            )),
        };
    }
    // A file may have an @ in its name.
    let turned = text.rsplit_once('@');
    let turned = turned.and_then(|(path, degrees)| Some((path, number(degrees)?)));
    let (path, degrees) = turned.unwrap_or((text, 0.0));
    if path.is_empty() {
        return Err("expected a file, such as studio.hdr@30, or daylight:35,120".into());
    }
    let path = path.into();
    Ok(EnvironmentArg::File { path, degrees })
}

/// The scene with the environment that the command line gives, if any, and with its sun.
pub(crate) fn lit(
    scene: Scene,
    args: &LightingArgs,
    load: &LoadArgs,
    up: DVec3,
) -> Result<Scene, Failure> {
    let Some(given) = &args.environment else {
        return Ok(scene);
    };
    let kind = match given {
        EnvironmentArg::File { path, degrees } => {
            let settings = LoadSettings {
                max_memory: load.max_memory,
                max_texture: load.max_texture,
                ..LoadSettings::default()
            };
            let (map, warnings) = load_environment(path, &settings)?;
            warn(&warnings);
            EnvironmentKind::of_map(map.into(), up, &rotation(up, *degrees))
        }
        &EnvironmentArg::Daylight { elevation, azimuth } => {
            let ground = Daylight::GROUND;
            let day = Daylight::new(up, elevation, azimuth, Daylight::CLEAR, ground)?;
            EnvironmentKind::Daylight(day)
        }
    };
    let environment = Environment {
        kind,
        strength: args.environment_strength.unwrap_or(1.0),
        is_seen: !args.environment_hidden,
    };
    let mut lights = scene.lights().to_vec();
    // The sun of a sky goes with it.
    if let Some(gone) = scene.environment().and_then(Environment::sun) {
        lights.retain(|light| *light != gone);
    }
    lights.extend(environment.sun());
    let scene = scene.with_lights(lights);
    Ok(scene.with_environment(Some(Arc::new(environment))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_may_be_turned_and_may_have_an_at_in_its_name() {
        let file = |text: &str| match parse(text).unwrap() {
            EnvironmentArg::File { path, degrees } => {
                (path.to_string_lossy().into_owned(), degrees)
            }
            EnvironmentArg::Daylight { .. } => panic!("{text}"),
        };
        assert_eq!(file("a.hdr"), ("a.hdr".into(), 0.0));
        assert_eq!(file("a.hdr@-30.5"), ("a.hdr".into(), -30.5));
        assert_eq!(file("a@2x.hdr"), ("a@2x.hdr".into(), 0.0));
        assert_eq!(file("a@2.hdr@90"), ("a@2.hdr".into(), 90.0));
        assert!(parse("@30").is_err() && parse("").is_err());
    }

    #[test]
    fn a_day_has_one_angle_or_two() {
        let day = |elevation, azimuth| Ok(EnvironmentArg::Daylight { elevation, azimuth });
        assert_eq!(parse("daylight:35"), day(35.0, 0.0));
        assert_eq!(parse("daylight:35,-120"), day(35.0, -120.0));
        for wrong in ["daylight:", "daylight:91", "daylight:1,2,3", "daylight:nan"] {
            assert!(parse(wrong).unwrap_err().contains("from 0 to 90"), "{wrong}");
        }
    }
}
