//! The position and orientation of a camera.

use crate::error::Result;
use crate::geometry::{DVec3, require, require_direction, require_finite, unit};

/// A camera's frame in the world, right-handed: `right`, `upwards` and backwards (`-aim`), each of
/// length one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub(super) position: DVec3,
    pub(super) aim: DVec3,
    pub(super) right: DVec3,
    pub(super) upwards: DVec3,
}

impl Pose {
    /// The pose at `position`, looking along `aim`, which `unit_aim` brings to length one.
    pub(super) fn new(
        position: DVec3,
        aim: DVec3,
        up: DVec3,
        unit_aim: impl Fn(DVec3) -> DVec3,
    ) -> Result<Self> {
        require_finite("position", position)?;
        require_direction("aim", aim)?;
        require_direction("up", up)?;
        let unit_aim = unit_aim(aim);
        let across = unit_aim.cross(unit(up));
        // Below this the cross product is nothing but the rounding of its factors.
        let apart = across.length() > 4.0 * f64::EPSILON;
        let both = format!("{up} (aim is {aim})");
        require("up", "in another direction than aim", apart, both)?;
        // Where `up` is close to `aim`, what is left of the product is not perpendicular to them.
        let right = unit(across - across.dot(unit_aim) * unit_aim);
        // u_y = u_z x u_x with u_z = -u_c.
        let upwards = (-unit_aim).cross(right);
        Ok(Self { position, aim: unit_aim, right, upwards })
    }
}
