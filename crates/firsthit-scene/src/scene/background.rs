use crate::geometry::{Color, DVec3, Digest, unit};

/// The radiance of a ray that meets nothing, as a function of its direction alone.
///
/// ```
/// use firsthit::{Background, Color, DVec3};
///
/// let sky = Background::Gradient {
///     horizon: Color::ONE,
///     zenith: Color::new(0.1, 0.3, 0.6),
///     up: DVec3::Z,
/// };
/// assert_eq!(sky.color(DVec3::X), Color::ONE);
/// assert_eq!(sky.color(5.0 * DVec3::Z), Color::new(0.1, 0.3, 0.6));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Background {
    /// One linear colour everywhere.
    Uniform(Color),
    /// A sky: from `horizon` to `zenith` by the height of the direction, the same below the
    /// horizon.
    Gradient {
        /// The linear colour where the direction is level.
        horizon: Color,
        /// The linear colour straight up.
        zenith: Color,
        /// The direction upwards; any length but zero.
        up: DVec3,
    },
    /// Transparent. Colours get a fourth number, the pixel's coverage (alpha), and are
    /// premultiplied by it.
    Transparent,
}

impl Background {
    /// The default of pictures: a dark blue grey, which contrasts with white and with black models.
    pub const NEUTRAL: Self = Self::Uniform(Color::new(0.12, 0.17, 0.24));

    /// The linear colour in a direction of any length; of a sky black where there is none, as
    /// beyond a fisheye's circle.
    pub fn color(&self, direction: DVec3) -> Color {
        match *self {
            Self::Uniform(color) => color,
            Self::Transparent => Color::ZERO,
            Self::Gradient { horizon, zenith, up } => {
                let height = unit(direction).dot(unit(up));
                if height.is_nan() {
                    return Color::ZERO;
                }
                horizon.lerp(zenith, height.clamp(0.0, 1.0))
            }
        }
    }
}

impl Background {
    /// Adds it to a digest.
    #[doc(hidden)]
    pub fn digest(&self, digest: &mut Digest) {
        match *self {
            Self::Uniform(color) => {
                digest.word("uniform");
                digest.vector(color);
            }
            Self::Gradient { horizon, zenith, up } => {
                digest.word("gradient");
                digest.vector(horizon);
                digest.vector(zenith);
                digest.vector(up);
            }
            Self::Transparent => digest.word("transparent"),
        }
    }
}

impl Default for Background {
    /// Black.
    fn default() -> Self {
        Self::Uniform(Color::ZERO)
    }
}
