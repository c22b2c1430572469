//! Describes a file's environment.

use std::sync::Arc;

use firsthit::scene::{Environment, EnvironmentKind, EnvironmentMap};
use firsthit::{Color, DMat3, DQuat, DVec3};
use serde_json::{Value, json};

use crate::hints::{number, triple};

/// The environment as JSON, in the words of scene files; `up` is the scene's.
pub(super) fn as_json(environment: &Environment, up: DVec3) -> Value {
    let mut said = match &environment.kind {
        EnvironmentKind::Uniform(color) => json!({"kind": "uniform", "color": color.to_array()}),
        EnvironmentKind::Hemispheres { above, below, up } => json!({
            "kind": "hemispheres",
            "above": above.to_array(),
            "below": below.to_array(),
            "up": up.to_array(),
        }),
        EnvironmentKind::Gradient { horizon, zenith, up } => json!({
            "kind": "gradient",
            "horizon": horizon.to_array(),
            "zenith": zenith.to_array(),
            "up": up.to_array(),
        }),
        EnvironmentKind::Map { map, world_from_map } => {
            let Turn { axis, degrees } = Turn::of(map, world_from_map, up);
            json!({
                "kind": "map",
                "columns": map.columns(),
                "rows": map.rows(),
                "rotate": {"axis": axis.to_array(), "degrees": degrees},
            })
        }
        EnvironmentKind::Daylight(day) => json!({
            "kind": "daylight",
            "elevation": day.elevation_degrees(),
            "azimuth": day.azimuth_degrees(),
            "turbidity": day.turbidity(),
            "ground": day.ground().to_array(),
            "up": day.up().to_array(),
        }),
    };
    said["strength"] = json!(environment.strength);
    said["seen"] = json!(environment.is_seen);
    said
}

/// The line of the text.
pub(super) fn line(environment: &Environment, up: DVec3) -> String {
    let kind = match &environment.kind {
        EnvironmentKind::Uniform(color) => format!("uniform, {}", triple(*color)),
        EnvironmentKind::Hemispheres { above, below, .. } => {
            format!("hemispheres, {}", from_to(("above", above), ("below", below)))
        }
        EnvironmentKind::Gradient { horizon, zenith, .. } => {
            format!("gradient, {}", from_to(("horizon", horizon), ("zenith", zenith)))
        }
        EnvironmentKind::Map { map, world_from_map } => {
            let turned = Turn::of(map, world_from_map, up).in_words(up);
            format!("map, {} x {} texels{turned}", map.columns(), map.rows())
        }
        EnvironmentKind::Daylight(day) => format!(
            "daylight, elevation {}, azimuth {}, turbidity {}",
            number(day.elevation_degrees()),
            number(day.azimuth_degrees()),
            number(day.turbidity()),
        ),
    };
    let strength = number(environment.strength);
    let seen = if environment.is_seen { "" } else { ", not seen" };
    format!("environment {kind}, strength {strength}{seen}")
}

fn from_to((first, a): (&str, &Color), (second, b): (&str, &Color)) -> String {
    format!("{first} {}, {second} {}", triple(*a), triple(*b))
}

/// The turn of a map from where it lies with the scene's up: about an axis of length one,
/// counter-clockwise seen against it.
struct Turn {
    axis: DVec3,
    degrees: f64,
}

impl Turn {
    fn of(map: &Arc<EnvironmentMap>, world_from_map: &DMat3, up: DVec3) -> Self {
        let lying = EnvironmentKind::of_map(Arc::clone(map), up, &DMat3::IDENTITY);
        let EnvironmentKind::Map { world_from_map: lying, .. } = lying else {
            unreachable!("it was made of a map");
        };
        let turn = *world_from_map * lying.transpose();
        let (axis, angle) = DQuat::from_mat3(&turn).to_axis_angle();
        // The digits that a rotation of float64 does not keep.
        let degrees = (angle.to_degrees() * 1e9).round() / 1e9;
        let up = unit(up);
        if degrees == 0.0 {
            return Self { axis: up, degrees };
        }
        let degrees = if degrees > 180.0 { degrees - 360.0 } else { degrees };
        match axis.dot(up) {
            along if along > ALONG => Self { axis: up, degrees },
            along if along < -ALONG => Self { axis: up, degrees: -degrees },
            _ => Self { axis, degrees },
        }
    }

    /// The turn in words; empty where there is none.
    fn in_words(&self, up: DVec3) -> String {
        let degrees = number(self.degrees);
        if self.degrees == 0.0 {
            String::new()
        } else if self.axis == unit(up) {
            format!(", turned by {degrees} degrees")
        } else {
            format!(", turned by {degrees} degrees about {}", triple(self.axis))
        }
    }
}

/// A direction of any length but zero, of length one.
fn unit(direction: DVec3) -> DVec3 {
    (direction / direction.abs().max_element()).normalize()
}

/// The cosine of an angle within which two directions are the same.
const ALONG: f64 = 1.0 - 1e-12;
