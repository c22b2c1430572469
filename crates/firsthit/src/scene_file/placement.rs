//! Where an object stands: scale, then rotate, then translate; or a matrix.

use super::document::{named, numbers};
use super::form::{matrix, scale};
use super::section::Section;
use super::table::{Form, Key, Pick, Record, Rule, Variant, keys, optional};
use crate::error::Error;
use crate::geometry::{DAffine3, DMat3, DQuat, DVec3, Transform, unit};
use crate::io::fault::Checked;

pub(super) const PLACED: &[Key] = keys! {
    /// What it is called. Default: the shape's or the file's name; of a file with several objects their own names follow a
    /// slash.
    name: optional(Form::Text),
    /// Its colour: linear [red, green, blue], or sRGB as "#rrggbb" or by a name of CSS; of a file, instead of its materials.
    /// Colours of vertices are multiplied by it.
    color: optional(Form::Color),
    /// A factor, or one for each axis; applied first, negative ones mirror.
    scale: optional(Form::Scale),
    /// A rotation, or several in their order; applied after scale.
    rotate: optional(Form::TableOrList(&ROTATION)),
    /// Where its origin goes; applied last.
    translate: optional(Form::Vector),
    /// Instead of the three: the rows of a matrix that takes columns [x, y, z, 1] to the world.
    matrix: optional(Form::Matrix),
};

pub(super) const PLACED_RULES: &[Rule] = &[
    Rule::NotBoth("matrix", "scale"),
    Rule::NotBoth("matrix", "rotate"),
    Rule::NotBoth("matrix", "translate"),
];

pub(super) static ROTATION: Record = Record {
    name: "rotation",
    about: "A rotation about the origin: an axis and degrees, or a quaternion.",
    variants: &[Variant {
        pick: Pick::Always,
        keys: &[keys! {
            /// The axis, of any length; seen against it, the rotation is counter-clockwise.
            axis: optional(Form::Direction),
            /// How far to turn. Quarter turns are exact.
            degrees: optional(Form::Number),
            /// [x, y, z, w], of any length.
            quaternion: optional(Form::Quaternion),
        }],
        rules: &[
            Rule::OneOf("axis", "quaternion"),
            Rule::Needs("axis", "degrees"),
            Rule::Needs("degrees", "axis"),
        ],
    }],
};

/// The way from the object's own space to the world.
pub(super) fn read(section: &Section<'_, '_>) -> Checked<DAffine3> {
    if let Some(rows) = section.raw("matrix").and_then(matrix) {
        return checked(section, "matrix", from_rows(&rows));
    }
    let factors = section.raw("scale").and_then(scale).unwrap_or(DVec3::ONE);
    let scaled = DAffine3::from_scale(factors);
    checked(section, "scale", scaled)?;
    let mut turned = DMat3::IDENTITY;
    for rotation in section.list("rotate", &ROTATION)? {
        turned = rotation_matrix(&rotation) * turned;
    }
    let offset = section.vector("translate").unwrap_or(DVec3::ZERO);
    let placed = DAffine3::from_mat3_translation(turned, offset) * scaled;
    checked(section, "translate", placed)
}

/// Refuses a transform without an inverse, at the key that causes it.
fn checked(section: &Section<'_, '_>, name: &str, map: DAffine3) -> Checked<DAffine3> {
    match Transform::new(map) {
        Ok(_) => Ok(map),
        Err(Error::Argument { expected, .. }) => {
            let got = section.raw(name).map_or_else(String::new, named);
            let what = format!("`{name}` must make {expected}, got {got}");
            Err(section.fault_at(name, what))
        }
        Err(error) => Err(error.into()),
    }
}

fn from_rows(rows: &[[f64; 4]; 3]) -> DAffine3 {
    let [first, second, third] = rows.map(|[x, y, z, _]| DVec3::new(x, y, z));
    let [x, y, z] = rows.map(|[.., offset]| offset);
    DAffine3::from_mat3_translation(
        DMat3::from_cols(first, second, third).transpose(),
        DVec3::new(x, y, z),
    )
}

fn rotation_matrix(section: &Section<'_, '_>) -> DMat3 {
    let Some(axis) = section.vector("axis") else {
        let [x, y, z, w] = (section.raw("quaternion"))
            .and_then(numbers::<4>)
            .unwrap_or([0.0, 0.0, 0.0, 1.0]);
        // Scaled first: squares of very large and very small numbers leave float64.
        let largest = [x, y, z, w].map(f64::abs).into_iter().fold(0.0, f64::max);
        let quaternion = DQuat::from_xyzw(x / largest, y / largest, z / largest, w / largest);
        return DMat3::from_quat(quaternion.normalize());
    };
    about(unit(axis), section.number("degrees").unwrap_or(0.0))
}

/// The rotation about an axis of length one (Rodrigues' formula).
fn about(axis: DVec3, degrees: f64) -> DMat3 {
    let (sin, cos) = sin_cos(degrees);
    let across = DMat3::from_cols(
        DVec3::new(0.0, axis.z, -axis.y),
        DVec3::new(-axis.z, 0.0, axis.x),
        DVec3::new(axis.y, -axis.x, 0.0),
    );
    let along = DMat3::from_cols(axis.x * axis, axis.y * axis, axis.z * axis);
    DMat3::from_diagonal(DVec3::splat(cos)) + across * sin + along * (1.0 - cos)
}

/// Sine and cosine of degrees, exact for quarter turns: radians could not say those.
fn sin_cos(degrees: f64) -> (f64, f64) {
    // Both steps are exact.
    let within = degrees % 360.0;
    let quarters = (within / 90.0).round();
    let (sin, cos) = libm::sincos((within - 90.0 * quarters).to_radians());
    if quarters == 1.0 || quarters == -3.0 {
        (cos, -sin)
    } else if quarters == 2.0 || quarters == -2.0 {
        (-sin, -cos)
    } else if quarters == 3.0 || quarters == -1.0 {
        (-cos, sin)
    } else {
        (sin, cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let quarter = about(DVec3::Z, 90.0);
        assert_eq!(quarter * DVec3::X, DVec3::Y);
        assert_eq!(about(DVec3::X, -90.0) * DVec3::Z, DVec3::Y);
        for (degrees, expected) in [
            (0.0, (0.0, 1.0)),
            (90.0, (1.0, 0.0)),
            (180.0, (0.0, -1.0)),
            (270.0, (-1.0, 0.0)),
            (-90.0, (-1.0, 0.0)),
            (-450.0, (-1.0, 0.0)),
            (360e9, (0.0, 1.0)),
        ] {
            assert_eq!(sin_cos(degrees), expected, "{degrees}");
        }
    }

    /// glam's own rotation goes by another way, the quaternion.
    #[test]
    fn an_axis_and_degrees_are_the_quaternion_of_half_the_angle() {
        for degrees in [-300.0, -100.0, -33.0, 12.5, 44.9, 45.1, 135.0, 200.0, 359.0] {
            let axis = DVec3::new(1.0, -2.0, 0.5).normalize();
            let ours = about(axis, degrees);
            let theirs = DMat3::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians()));
            assert!(
                (ours - theirs)
                    .to_cols_array()
                    .iter()
                    .all(|x| x.abs() < 1e-15),
                "{degrees}"
            );
        }
    }
}
