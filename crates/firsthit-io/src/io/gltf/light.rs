//! Lights: `KHR_lights_punctual`.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::super::fault::Checked;
use super::super::report::Report;
use super::document::{Document, LightEntry};
use super::index::Index;
use super::nodes::Placed;
use super::place::Entry;
use crate::error::escape_controls;
use crate::geometry::{Color, DVec3, unit};
use crate::scene::{DirectionalLight, Light, PointLight, SpotLight};

/// The lights of the scene, in the order of their nodes.
pub(super) fn all(
    document: &Document<'_>,
    placed: &[Placed<'_>],
    report: &mut Report,
) -> Checked<Vec<Light>> {
    let Some(entries) = &document.extensions.lights else {
        return Ok(Vec::new());
    };
    let mut lights = Vec::new();
    for place in placed {
        let Some(light) = &place.node.extensions.light else {
            continue;
        };
        let Index(index) = light.light;
        let Some(light) = entries.lights.get(index) else {
            continue;
        };
        // A place within an extension of the whole document.
        let entry = Entry::new("extensions/KHR_lights_punctual/lights", index);
        if !takes_light_away(light, entry, report) {
            lights.push(at(light, entry, place, report)?);
        }
    }
    Ok(lights)
}

/// Whether the light is none, because it would take light away; warns of it.
fn takes_light_away(light: &LightEntry<'_>, entry: Entry, report: &mut Report) -> bool {
    let numbers = light.intensity.iter().map(|intensity| ("intensity", intensity));
    let colors = light.color.iter().flatten().map(|level| ("color", level));
    let Some((name, number)) = numbers.chain(colors).find(|(_, number)| **number < 0.0) else {
        return false;
    };
    report.warn("negative light", &entry.at(name), || {
        format!("must not be negative, got {number}: the light is left out")
    });
    true
}

fn at(
    light: &LightEntry<'_>,
    entry: Entry,
    place: &Placed<'_>,
    report: &mut Report,
) -> Checked<Light> {
    if let Some(range) = light.range {
        report.warn("range", &entry.at("range"), || {
            format!("the light reaches as far as it does, not only to {range}")
        });
    }
    let intensity = light.intensity.unwrap_or(1.0);
    // A white surface sends back 1 / pi of the light that it gets, to each side the same.
    let color = Color::from(light.color.unwrap_or([1.0; 3])) * (intensity / PI);
    let map = place.world_from_node;
    let (position, direction) = (map.translation, unit(map.transform_vector3(DVec3::NEG_Z)));
    let direction = if direction.is_finite() { direction } else { DVec3::NEG_Z };
    match &*light.kind {
        "directional" => Ok(Light::from(DirectionalLight { direction, color, angle_degrees: 0.0 })),
        "point" => Ok(Light::from(PointLight { position, intensity: color })),
        "spot" => {
            let spot = light.spot.as_ref();
            let inner = spot.and_then(|spot| spot.inner_cone_angle).unwrap_or(0.0);
            let outer = spot.and_then(|spot| spot.outer_cone_angle).unwrap_or(FRAC_PI_4);
            if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2 + 1e-6) {
                let what = format!(
                    "the angles of the cones must be 0 <= inner < outer <= pi / 2, got {inner} and {outer}"
                );
                return Err(entry.fault("spot", what));
            }
            Ok(Light::from(SpotLight {
                position,
                direction,
                intensity: color,
                // Pi / 2 as a float32 is above it.
                inner_angle: inner.min(FRAC_PI_2),
                outer_angle: outer.min(FRAC_PI_2),
            }))
        }
        kind => {
            let kind = escape_controls(kind);
            let what = format!("must be directional, point or spot, got '{kind}'");
            Err(entry.fault("type", what))
        }
    }
}
