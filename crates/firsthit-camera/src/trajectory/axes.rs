//! The axes of a body.

use crate::geometry::{DQuat, named};

named! {
    /// The directions of a body's x, y and z axes, seen from the body. The caller names them; they
    /// are never guessed.
    ///
    /// ```
    /// use firsthit::DVec3;
    /// use firsthit::trajectory::BodyAxes;
    ///
    /// // OpenCV's forwards is z, which for firsthit's camera is -z.
    /// let axes: BodyAxes = "right-down-forwards".parse()?;
    /// assert_eq!(axes.body_from_camera() * DVec3::NEG_Z, DVec3::Z);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum BodyAxes, "body axes":
    /// Right, up, backwards: cameras of firsthit, OpenGL, Blender and glTF.
    #[default]
    "right-up-backwards" => RightUpBackwards;
    /// Right, down, forwards: cameras of OpenCV, COLMAP, TUM and KITTI, and optical frames of ROS.
    "right-down-forwards" => RightDownForwards;
    /// Forwards, left, up: bodies of ROS (REP 103) and laser scanners of KITTI.
    "forwards-left-up" => ForwardsLeftUp;
}

impl BodyAxes {
    /// The rotation that takes the coordinates of firsthit's camera (right, up, backwards) to those
    /// of the body. Its numbers are 0, 1 and 1/2, so it permutes and negates coordinates without
    /// rounding.
    pub const fn body_from_camera(self) -> DQuat {
        match self {
            Self::RightUpBackwards => DQuat::IDENTITY,
            // Half a turn about x.
            Self::RightDownForwards => DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0),
            // Right is -y, up is z, backwards is -x: a third of a turn about (1, -1, -1).
            Self::ForwardsLeftUp => DQuat::from_xyzw(0.5, -0.5, -0.5, 0.5),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::DVec3;

    #[test]
    fn every_axis_of_the_camera_is_the_one_of_the_body_that_its_name_says() {
        for &axes in BodyAxes::ALL {
            let words: Vec<&str> = axes.name().split('-').collect();
            let toward = |way: &str, opposite: &str| {
                let at = |word| words.iter().position(|&w| w == word);
                let plus = at(way).map(|axis| DVec3::AXES[axis]);
                plus.unwrap_or_else(|| -DVec3::AXES[at(opposite).unwrap()])
            };
            let rotation = axes.body_from_camera();
            assert_eq!(rotation * DVec3::X, toward("right", "left"), "{axes:?}");
            assert_eq!(rotation * DVec3::Y, toward("up", "down"), "{axes:?}");
            assert_eq!(rotation * DVec3::NEG_Z, toward("forwards", "backwards"));
            assert_eq!(axes.name().parse::<BodyAxes>().unwrap(), axes);
        }
    }
}
