//! The placement of an object: scale, then rotate, then translate; or a matrix.

use super::document::{named, numbers};
use super::form::{matrix, scale};
use super::material::MATERIAL;
use super::section::Section;
use super::table::{Form, Key, Pick, Record, Rule, keys, optional, record};
use crate::error::Error;
use crate::geometry::{DAffine3, DMat3, DQuat, DVec3, Transform, rotation};
use crate::io::fault::Checked;

pub(super) const PLACED: &[Key] = keys! {
    /// The object's name. Default: the shape's or the file's name; of a file with several objects
    /// their own names follow a slash.
    name: optional(Form::Text),
    /// The colour: linear [red, green, blue], or sRGB as "#rrggbb" or by a name of CSS; of a file,
    /// instead of its materials. Colours of vertices are multiplied by it.
    color: optional(Form::COLOR),
    /// The material; of a file, instead of its materials. Its colour stands beside it.
    material: optional(Form::Table(&MATERIAL)),
    /// A factor, or one for each axis; applied first, negative ones mirror.
    scale: optional(Form::Scale),
    /// A rotation, or several in their order; applied after scale.
    rotate: optional(Form::Either(&TURN, &TURNS)),
    /// The place of the object's origin; applied last.
    translate: optional(Form::VECTOR),
    /// The rows of a matrix that takes columns [x, y, z, 1] to the world, instead of the three.
    matrix: optional(Form::Matrix),
};

pub(super) const PLACED_RULES: &[Rule] = &[
    Rule::NotBoth("matrix", "scale"),
    Rule::NotBoth("matrix", "rotate"),
    Rule::NotBoth("matrix", "translate"),
];

pub(super) static TURN: Form = Form::Table(&ROTATION);
static TURNS: Form = Form::List(&ROTATION);

pub(super) static ROTATION: Record = record! {
    "rotation", "A rotation about the origin: an axis and degrees, or a quaternion.";
    Pick::Always => [keys! {
        /// The axis, of any length; seen against it, the rotation is counter-clockwise.
        axis: optional(Form::DIRECTION),
        /// The angle. Quarter turns are exact.
        degrees: optional(Form::NUMBER),
        /// [x, y, z, w], of any length.
        quaternion: optional(Form::Quaternion),
    }] [
        Rule::OneOf("axis", "quaternion"),
        Rule::Needs("axis", "degrees"),
        Rule::Needs("degrees", "axis"),
    ];
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

/// The rotation that a table says.
pub(super) fn rotation_matrix(section: &Section<'_, '_>) -> DMat3 {
    let Some(axis) = section.vector("axis") else {
        let [x, y, z, w] =
            (section.raw("quaternion")).and_then(numbers::<4>).unwrap_or([0.0, 0.0, 0.0, 1.0]);
        // Scaled first: squares of very large and very small numbers leave float64.
        let largest = [x, y, z, w].map(f64::abs).into_iter().fold(0.0, f64::max);
        let quaternion = DQuat::from_xyzw(x / largest, y / largest, z / largest, w / largest);
        return DMat3::from_quat(quaternion.normalize());
    };
    rotation(axis, section.number("degrees").unwrap_or(0.0))
}
