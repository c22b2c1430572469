use crate::geometry::{Color, DVec3, unit};

/// What a ray sees that meets nothing: a function of its direction alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Background {
    /// One linear colour everywhere.
    Uniform(Color),
    /// A sky: from `horizon` to `zenith` by the height of the direction, the same below the horizon.
    Gradient {
        /// The linear colour where the direction is level.
        horizon: Color,
        /// The linear colour straight up.
        zenith: Color,
        /// Which way is up; any length but zero.
        up: DVec3,
    },
}

impl Background {
    /// The linear colour in a direction of any length.
    pub fn color(&self, direction: DVec3) -> Color {
        match *self {
            Self::Uniform(color) => color,
            Self::Gradient {
                horizon,
                zenith,
                up,
            } => {
                let height = unit(direction).dot(unit(up)).clamp(0.0, 1.0);
                horizon.lerp(zenith, height)
            }
        }
    }
}

impl Default for Background {
    /// Black.
    fn default() -> Self {
        Self::Uniform(Color::ZERO)
    }
}
