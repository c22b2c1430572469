//! The interpolation of a trajectory between its poses, and the extrapolation beyond them.

use crate::geometry::named;

named! {
    /// The interpolation from one pose to the next. Each passes through every pose, and turns the
    /// short way.
    ///
    /// ```
    /// use firsthit::trajectory::Interpolation;
    ///
    /// assert_eq!("se3".parse::<Interpolation>()?, Interpolation::Se3);
    /// assert_eq!(Interpolation::default().name(), "linear");
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum Interpolation, "interpolation":
    /// Positions along straight lines, rotations by slerp: both at constant speed between two
    /// poses.
    #[default]
    "linear" => Linear;
    /// Positions by the natural cubic spline, whose velocity and acceleration are continuous.
    /// Rotations by a cubic spline whose angular velocity is continuous; about one fixed axis it is
    /// the natural spline of the angle. With two poses it is `Linear`.
    "spline" => Spline;
    /// Screw motions: each turns and moves about one line at constant speed, the shortest way in
    /// SE(3). So moves a body that turns and drives at constant rates.
    "se3" => Se3;
}

named! {
    /// The answer of a trajectory before its first and after its last pose.
    pub enum Extrapolation, "extrapolation":
    /// An error: where the body was is not known.
    #[default]
    "refuse" => Refuse;
    /// The first or the last pose.
    "hold" => Hold;
}
