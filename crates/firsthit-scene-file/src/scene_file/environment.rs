//! The light from all around, of a scene file.

use super::placement::{ROTATION, TURN, rotation_matrix};
use super::section::Section;
use super::table::{Form, Key, Pick, Record, Variant, keys, optional, record, required};
use crate::error::{Error, escape_controls};
use crate::geometry::{Color, DMat3, DVec3, Domain, rotation};
use crate::io::fault::Checked;
use crate::io::{Report, load_environment_part};
use crate::scene::{Daylight, Environment, EnvironmentKind, EnvironmentMap, Light};

const COMMON: &[Key] = keys! {
    /// The factor on the radiance. Default: 1.
    strength: optional(Form::NON_NEGATIVE),
    /// Whether the camera sees it, in place of the background. Default: true.
    seen: optional(Form::FLAG),
};

const UP: &[Key] = keys! {
    /// The direction upwards. Default: the scene's up.
    up: optional(Form::DIRECTION),
};

const FILE: &[Key] = keys! {
    /// A picture of all directions by longitude and latitude, .hdr or .exr, relative to the scene
    /// file and in its folder or below.
    file: required(Form::Path),
    /// A rotation: degrees about up, counter-clockwise seen from above, or a table as for objects.
    rotate: optional(Form::Either(&Form::NUMBER, &TURN)),
};

const COLOR: &[Key] = keys! {
    /// The radiance, equal from all directions.
    color: required(Form::COLOR),
};

const HEMISPHERES: &[Key] = keys! {
    /// The light from above the horizon.
    above: required(Form::COLOR),
    /// The light from below.
    below: required(Form::COLOR),
};

const GRADIENT: &[Key] = keys! {
    /// The light from the horizon, and from below.
    horizon: required(Form::COLOR),
    /// The light from straight above.
    zenith: required(Form::COLOR),
};

const DAYLIGHT_KEY: &[Key] = keys! {
    /// The sky of a clear day, and its sun.
    daylight: required(Form::Table(&DAYLIGHT)),
};

const fn with(key: &'static str, keys: &'static [&'static [Key]]) -> Variant {
    Variant { pick: Pick::Has(key), keys, rules: &[] }
}

pub(super) static ENVIRONMENT: Record = Record {
    name: "environment",
    about: "Light from all around, from infinitely far away: a picture, one colour, two, a gradient, or daylight.",
    variants: &[
        with("file", &[FILE, UP, COMMON]),
        with("color", &[COLOR, COMMON]),
        with("above", &[HEMISPHERES, UP, COMMON]),
        with("horizon", &[GRADIENT, UP, COMMON]),
        with("daylight", &[DAYLIGHT_KEY, UP, COMMON]),
    ],
};

pub(super) static DAYLIGHT: Record = record! {
    "daylight", "The sky of a clear day, exposed so that a white, level surface takes 1 of it and its sun.";
    Pick::Always => [keys! {
        /// The sun's elevation above the horizon, in degrees.
        elevation: required(Form::Of(Domain::From(Daylight::ELEVATIONS.0, Daylight::ELEVATIONS.1))),
        /// The sun's azimuth in degrees, counter-clockwise seen from above; with +z or +y up
        /// from +x. Default: 0.
        azimuth: optional(Form::NUMBER),
        /// The haze of the air: 2 very clear, 3 clear, 6 hazy. Default: 3.
        turbidity: optional(Form::Of(Domain::From(Daylight::TURBIDITIES.0, Daylight::TURBIDITIES.1))),
        /// The share of light that the ground sends back. Default: [0.2, 0.2, 0.2].
        ground: optional(Form::COLOR),
        /// Whether the sun is one of the lights. Default: true.
        sun: optional(Form::FLAG),
    }];
};

/// The environment of the whole file, and the light that comes with it; `up` is the scene's.
pub(super) fn read(
    scene: &Section<'_, '_>,
    up: DVec3,
    report: &mut Report,
) -> Checked<Option<(Environment, Option<Light>)>> {
    let Some(section) = scene.table("environment", &ENVIRONMENT)? else {
        return Ok(None);
    };
    let up = section.vector("up").unwrap_or(up);
    let color = |name| section.color(name).unwrap_or(Color::ZERO);
    let mut has_sun = false;
    let kind = if section.has("file") {
        let turn = turn(&section, up)?;
        EnvironmentKind::of_map(map(&section, report)?.into(), up, &turn)
    } else if section.has("color") {
        EnvironmentKind::Uniform(color("color"))
    } else if section.has("above") {
        let (above, below) = (color("above"), color("below"));
        EnvironmentKind::Hemispheres { above, below, up }
    } else if section.has("horizon") {
        let (horizon, zenith) = (color("horizon"), color("zenith"));
        EnvironmentKind::Gradient { horizon, zenith, up }
    } else {
        let (day, with_sun) = daylight(&section, up)?;
        has_sun = with_sun;
        EnvironmentKind::Daylight(day)
    };
    let strength = section.number("strength").unwrap_or(1.0);
    let environment =
        Environment { kind, strength, is_seen: section.boolean("seen").unwrap_or(true) };
    section.checked(environment.check())?;
    let sun = environment.sun().filter(|_| has_sun);
    Ok(Some((environment, sun)))
}

fn turn(section: &Section<'_, '_>, up: DVec3) -> Checked<DMat3> {
    if let Some(degrees) = section.number("rotate") {
        return Ok(rotation(up, degrees));
    }
    let table = section.table("rotate", &ROTATION)?;
    Ok(table.map_or(DMat3::IDENTITY, |table| rotation_matrix(&table)))
}

fn map(section: &Section<'_, '_>, report: &mut Report) -> Checked<EnvironmentMap> {
    let name = section.need("file", Section::text)?;
    let refused = |reason: &str| {
        let name = escape_controls(name);
        section.fault_at("file", format!("'{name}' is not read: {reason}"))
    };
    let path = report.sibling(name).map_err(|reason| refused(&reason))?;
    load_environment_part(&path, report).map_err(|error| match error {
        Error::Parse { .. } | Error::Read { .. } => refused(&error.to_string()),
        other => other.into(),
    })
}

/// The sky, and whether its sun is a light.
fn daylight(section: &Section<'_, '_>, up: DVec3) -> Checked<(Daylight, bool)> {
    let Some(table) = section.table("daylight", &DAYLIGHT)? else {
        return Err(section.fault("daylight is missing"));
    };
    let daylight = Daylight::new(
        up,
        table.need("elevation", Section::number)?,
        table.number("azimuth").unwrap_or(0.0),
        table.number("turbidity").unwrap_or(Daylight::CLEAR),
        table.color("ground").unwrap_or(Daylight::GROUND),
    );
    let has_sun = table.boolean("sun").unwrap_or(true);
    Ok((table.checked(daylight)?, has_sun))
}
