//! The position and orientation of a body.

use super::axes::BodyAxes;
use super::rotation::{nearest_rotation, unit_rotation};
use crate::error::{Error, Result};
use crate::geometry::{DAffine3, DMat3, DQuat, DVec3, require};

/// The largest coordinate: beyond it squares leave float64, and rays meet nothing.
pub(super) const FARTHEST: f64 = 1e150;

/// The position and orientation of a body in the world: a rigid motion that takes the body's
/// coordinates to the world's.
///
/// The body's axes are whatever its maker says; see [`BodyAxes`]. `rotation` and its negative are
/// the same rotation.
///
/// ```
/// use firsthit::{DQuat, DVec3, Pose};
///
/// // At x = 10, turned to the left by a quarter, z being up.
/// let car = Pose::new(DVec3::new(10.0, 0.0, 0.0), DQuat::from_xyzw(0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()))?;
/// // A laser scanner two metres in front of the car's origin.
/// let scanner = car.then(&Pose::new(DVec3::new(2.0, 0.0, 0.0), DQuat::IDENTITY)?);
/// assert!(scanner.position.abs_diff_eq(DVec3::new(10.0, 2.0, 0.0), 1e-12));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The position of the body's origin in the world, in scene units.
    pub position: DVec3,
    /// The orientation of the body's axes in the world, a quaternion of length one.
    pub rotation: DQuat,
}

impl Pose {
    /// The pose at the world's origin, with the world's axes.
    pub const IDENTITY: Self = Self { position: DVec3::ZERO, rotation: DQuat::IDENTITY };

    /// The pose at `position`, turned by `rotation`, which is brought to length one.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for coordinates that are not finite or
    /// beyond 10^150, and for a quaternion whose length is further from one than 0.001.
    pub fn new(position: DVec3, rotation: DQuat) -> Result<Self> {
        let expected = "finite, within 1e150";
        require("position", expected, is_in_range(position), position)?;
        let unit = unit_rotation(rotation);
        let expected = "a quaternion of length one, within 0.001";
        require("rotation", expected, unit.is_some(), rotation)?;
        let rotation = unit.unwrap_or(rotation);
        Ok(Self { position, rotation })
    }

    /// The pose of a matrix that takes the body's coordinates to the world's. The rotation that is
    /// nearest to it is taken.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a matrix that is no rigid motion
    /// within 0.0001, and for coordinates that are not finite or beyond 10^150.
    pub fn from_matrix(world_from_body: &DAffine3) -> Result<Self> {
        let rotation = nearest_rotation(world_from_body.matrix3);
        let rotation = rotation.map_err(|what| {
            Error::argument("pose", "a rotation and a translation, within 0.0001", what)
        })?;
        Self::new(world_from_body.translation, rotation)
    }

    /// The map from the body's coordinates to the world's.
    pub fn world_from_body(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(DMat3::from_quat(self.rotation), self.position)
    }

    /// The pose of the world as the body sees it: `body_from_world`.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        let position = -(rotation * self.position);
        Self { position, rotation }
    }

    /// The pose in the world of what stands at `next` in this body's coordinates:
    /// `world_from_body * body_from_next`.
    pub fn then(&self, next: &Self) -> Self {
        let rotation = self.rotation * next.rotation;
        Self {
            position: self.position + self.rotation * next.position,
            // Products of many rotations would drift away from length one.
            rotation: unit_rotation(rotation).unwrap_or(rotation),
        }
    }

    /// The pose of a camera that looks along the body's forward axis: the same place, with
    /// firsthit's camera axes (right, up, backwards). `axes` says what the body's are.
    ///
    /// ```
    /// use firsthit::trajectory::BodyAxes;
    /// use firsthit::{DVec3, Pose};
    ///
    /// let camera = Pose::IDENTITY.camera(BodyAxes::ForwardsLeftUp);
    /// let aim = camera.rotation * DVec3::NEG_Z;
    /// assert_eq!(aim, DVec3::X);
    /// ```
    pub fn camera(&self, axes: BodyAxes) -> Self {
        Self { position: self.position, rotation: self.rotation * axes.body_from_camera() }
    }
}

/// Whether a position can be one of a pose.
pub(super) fn is_in_range(position: DVec3) -> bool {
    position
        .to_array()
        .iter()
        // So that a NaN fails.
        .all(|x| x.abs() <= FARTHEST)
}

#[cfg(test)]
mod tests {
    use super::super::rotation::exp;
    use super::*;

    fn poses() -> [Pose; 2] {
        [[0.3, -2.0, 1.1], [-1.0, 0.2, 0.7]]
            .map(DVec3::from_array)
            .map(|v| Pose::new(3.0 * v - 1.0, exp(v)).unwrap())
    }

    /// Maps of numbers below 10, by a few dozen roundings.
    const ROUNDING: f64 = 1e-13;

    #[test]
    fn poses_compose_and_are_undone_as_their_matrices() {
        let [a, b] = poses();
        let product = a.world_from_body() * b.world_from_body();
        assert!(a.then(&b).world_from_body().abs_diff_eq(product, ROUNDING));
        let inverse = a.world_from_body().inverse();
        assert!(a.inverse().world_from_body().abs_diff_eq(inverse, ROUNDING));
    }

    #[test]
    fn what_is_no_pose_is_refused() {
        for x in [f64::NAN, f64::INFINITY, -1e151] {
            let error = Pose::new(DVec3::new(0.0, x, 0.0), DQuat::IDENTITY).unwrap_err();
            assert!(error.to_string().starts_with("position must be finite"));
        }
        let error = Pose::new(DVec3::ZERO, DQuat::IDENTITY * 0.5).unwrap_err();
        let expected =
            "rotation must be a quaternion of length one, within 0.001, got [0, 0, 0, 0.5]";
        assert_eq!(error.to_string(), expected);
    }
}
