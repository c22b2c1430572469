//! Materials, textures on surfaces, lights, backgrounds and shaders, to the record and back.

mod background;
mod edges;
mod environment;
mod kind;
mod map;
mod material;
mod shading;

pub(super) use kind::KindRecord;
pub(super) use map::MapRecord;
pub(super) use material::MaterialRecord;
pub(super) use shading::ShadingRecord;

use super::number::Triple;
use crate::error::{Error, Result};
use crate::geometry::DVec3;

/// A direction: finite and not zero.
pub(super) fn direction_of(direction: Triple) -> Result<DVec3> {
    let direction = DVec3::from(direction);
    if direction.is_finite() && direction != DVec3::ZERO {
        Ok(direction)
    } else {
        Err(Error::argument("direction", "finite and not zero", direction))
    }
}

/// The error that the record names something by a number that it has not.
pub(super) fn missing(what: &'static str, number: usize) -> Error {
    Error::argument(what, "one of the record's", number)
}
