//! Light from all around, from infinitely far away.

mod daylight;
mod directions;
mod irradiance;
mod map;

use std::f64::consts::PI;
use std::sync::Arc;

pub use daylight::Daylight;
pub use map::EnvironmentMap;

use super::light::{Light, LightSample};
use crate::error::Result;
use crate::geometry::{
    Color, DMat3, DVec2, DVec3, moderation, require, require_direction, unit, upright,
};
use directions::DirectionTable;

/// Light from all around: what rays see that meet nothing, and what lights surfaces.
///
/// ```
/// use firsthit::scene::{Environment, EnvironmentKind};
/// use firsthit::{Color, DVec3};
///
/// let overcast = Environment::new(EnvironmentKind::Uniform(Color::splat(0.8)));
/// assert_eq!(overcast.radiance(DVec3::X), Color::splat(0.8));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// The radiance by direction.
    pub kind: EnvironmentKind,
    /// The factor on the radiance.
    pub strength: f64,
    /// Whether the camera sees it too, in place of the background.
    pub is_seen: bool,
}

/// The radiance of an [`Environment`], by direction.
#[derive(Debug, Clone, PartialEq)]
pub enum EnvironmentKind {
    /// Equal radiance from all directions.
    Uniform(Color),
    /// One radiance from above the horizon, and another from below.
    Hemispheres {
        /// The radiance of the sky.
        above: Color,
        /// The radiance of the ground.
        below: Color,
        /// The direction upwards; any length but zero.
        up: DVec3,
    },
    /// A sky that goes from the horizon's radiance, which is that of all below too, to the
    /// zenith's, by the sine of the height.
    Gradient {
        /// The radiance at the horizon and below.
        horizon: Color,
        /// Straight up.
        zenith: Color,
        /// The direction upwards; any length but zero.
        up: DVec3,
    },
    /// The radiance of a picture of all directions.
    Map {
        /// The picture.
        map: Arc<EnvironmentMap>,
        /// A rotation: how the map's own frame, whose up is +y, lies in the world.
        world_from_map: DMat3,
    },
    /// The sky of a clear day.
    Daylight(Daylight),
}

impl Environment {
    /// The environment at strength 1, seen by the camera.
    pub fn new(kind: EnvironmentKind) -> Self {
        Self { kind, strength: 1.0, is_seen: true }
    }

    /// The radiance from a direction in the world, of any length; black where there is none.
    pub fn radiance(&self, direction: DVec3) -> Color {
        self.strength * self.kind.radiance(direction)
    }

    /// The sun of daylight, as strong as the sky. It is no part of the environment: a scene has it
    /// among its lights, or has none.
    pub fn sun(&self) -> Option<Light> {
        match &self.kind {
            EnvironmentKind::Daylight(day) => {
                Some(Light::from(day.sun_light()).scaled(self.strength))
            }
            _ => None,
        }
    }

    /// The sky where it is one of two hemispheres, or the same everywhere.
    #[doc(hidden)]
    pub fn hemispheres(&self) -> Option<Hemispheres> {
        match self.kind {
            EnvironmentKind::Hemispheres { above, below, up } => {
                Some(Hemispheres { colors: [above, below].map(|color| self.strength * color), up })
            }
            EnvironmentKind::Uniform(color) => {
                Some(Hemispheres { colors: [self.strength * color; 2], up: DVec3::Y })
            }
            _ => None,
        }
    }

    /// Light from a direction in the world that a point of the unit square stands for, bright ones
    /// more often. `None` where surfaces choose directions as well: where the radiance is nearly
    /// the same from everywhere.
    ///
    /// A dim direction is drawn seldom. So the mean over the square is all the light, but a noisy
    /// one, unless directions that surfaces choose count as well, each way by how
    /// [dense](Self::pdf) it is.
    pub fn sample(&self, u: DVec2) -> Option<LightSample> {
        let (table, world_from_own) = self.kind.table()?;
        let (direction, pdf) = table.draw(u);
        let towards = *world_from_own * direction;
        Some(LightSample {
            towards,
            distance: f64::INFINITY,
            light: self.radiance(towards) / (PI * pdf),
            pdf: Some(pdf),
        })
    }

    /// The probability density with which [`sample`](Self::sample) draws this direction, in the
    /// world and of length one, per steradian; 0 if it draws none.
    pub fn pdf(&self, towards: DVec3) -> f64 {
        let table = self.kind.table();
        table.map_or(0.0, |(table, world_from_own)| table.pdf(world_from_own.transpose() * towards))
    }

    /// Whether [`sample`](Self::sample) draws directions.
    pub fn is_drawn(&self) -> bool {
        self.kind.table().is_some()
    }

    /// Fails for numbers that make no sense.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument).
    pub fn check(&self) -> Result<()> {
        let fine = self.strength >= 0.0 && self.strength.is_finite();
        require("strength", "finite and not negative", fine, self.strength)?;
        self.kind.check()
    }
}

/// One radiance from above the horizon, and another from below.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Hemispheres {
    /// Above, and below.
    colors: [Color; 2],
    /// The direction upwards, of any length but zero.
    up: DVec3,
}

impl Hemispheres {
    /// See [`Environment::radiance`].
    #[inline(always)]
    pub fn radiance(&self, direction: DVec3) -> Color {
        let Self { colors: [above, below], up } = *self;
        // The sign alone counts: lengths do not.
        let height = (moderation(direction) * direction).dot(moderation(up) * up);
        if height > 0.0 {
            above
        } else if height <= 0.0 {
            below
        } else {
            Color::ZERO
        }
    }
}

impl EnvironmentKind {
    fn radiance(&self, direction: DVec3) -> Color {
        let height = |up: DVec3| unit(direction).dot(unit(up));
        match *self {
            Self::Uniform(color) => color,
            Self::Hemispheres { above, below, up } => {
                let colors = [above, below];
                Hemispheres { colors, up }.radiance(direction)
            }
            Self::Gradient { horizon, zenith, up } => {
                let height = height(up);
                if height.is_nan() {
                    return Color::ZERO;
                }
                horizon.lerp(zenith, height.clamp(0.0, 1.0))
            }
            Self::Map { ref map, ref world_from_map } => {
                map.radiance(world_from_map.transpose() * direction)
            }
            Self::Daylight(ref daylight) => daylight.radiance(direction),
        }
    }

    /// The table to draw directions from, and its frame in the world; `None` where that is not
    /// worth it.
    fn table(&self) -> Option<(&DirectionTable, &DMat3)> {
        match self {
            Self::Map { map, world_from_map } => Some((map.table()?, world_from_map)),
            Self::Daylight(daylight) => daylight.table(),
            Self::Uniform(_) | Self::Hemispheres { .. } | Self::Gradient { .. } => None,
        }
    }

    /// A map in a world with that direction upwards, of any length but zero, turned by a rotation.
    ///
    /// Where +y is up, the map's axes are the world's. Where it is another direction, they are
    /// tilted the shortest way: with +z up, the map's +x stays, its +y becomes +z, and its +z
    /// becomes -y.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use firsthit::geometry::rotation;
    /// use firsthit::scene::{Environment, EnvironmentMap, EnvironmentKind};
    /// use firsthit::{Color, DMat3, DVec3};
    ///
    /// // Four columns: the middle, between the second and the third, is +x.
    /// let texels = [1.0, 2.0, 3.0, 4.0].map(|x| [x; 3]).to_vec();
    /// let map = Arc::new(EnvironmentMap::new(4, 1, texels)?);
    /// let quarter = rotation(DVec3::Z, 90.0);
    /// let seen = Environment::new(EnvironmentKind::of_map(map, DVec3::Z, &quarter));
    /// assert_eq!(seen.radiance(DVec3::Y), Color::splat(2.5));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn of_map(map: Arc<EnvironmentMap>, up: DVec3, turn: &DMat3) -> Self {
        let world_from_map = *turn * upright(up);
        Self::Map { map, world_from_map }
    }

    fn check(&self) -> Result<()> {
        let colors = |colors: [Color; 2], up| {
            for color in colors {
                let fine = color.is_finite() && color.min_element() >= 0.0;
                require("color", "finite and not negative", fine, color)?;
            }
            require_direction("up", up).map(drop)
        };
        match *self {
            Self::Uniform(color) => colors([color; 2], DVec3::Y),
            Self::Hemispheres { above, below, up } => colors([above, below], up),
            Self::Gradient { horizon, zenith, up } => colors([horizon, zenith], up),
            Self::Map { world_from_map, .. } => {
                let off = world_from_map * world_from_map.transpose() - DMat3::IDENTITY;
                let fine = off.to_cols_array().iter().all(|x| x.abs() < 1e-9);
                require("world_from_map", "a rotation", fine, world_from_map)
            }
            // Checked when it was made.
            Self::Daylight(_) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::rotation;

    #[test]
    fn a_turned_map_is_seen_where_it_was_turned_to() {
        let texels = (0..8).map(|k| [k as f32; 3]).collect::<Vec<_>>();
        let map = Arc::new(EnvironmentMap::new(4, 2, texels).unwrap());
        let seen = |turn: &DMat3, up| {
            Environment::new(EnvironmentKind::of_map(Arc::clone(&map), up, turn))
        };
        let plain = seen(&DMat3::IDENTITY, DVec3::Y);
        let up = DVec3::new(0.2, 1.0, -0.4);
        let turn = rotation(DVec3::new(1.0, 2.0, -0.5), 77.0);
        let turned = seen(&turn, up);
        for direction in [DVec3::X, DVec3::new(-0.3, 0.2, 0.9), DVec3::new(0.1, -0.9, -0.3)] {
            let moved = turn * (upright(up) * direction);
            let (got, expected) = (turned.radiance(moved), plain.radiance(direction));
            assert!((got - expected).length() < 1e-9, "{got} {expected}");
        }
    }

    #[test]
    fn numbers_that_make_no_sense_are_refused() {
        let mut wrong = Environment::new(EnvironmentKind::Uniform(Color::ONE));
        assert!(wrong.check().is_ok());
        wrong.strength = -1.0;
        assert!(wrong.check().is_err());
        let wrong = Environment::new(EnvironmentKind::Uniform(Color::new(0.0, f64::NAN, 0.0)));
        assert!(wrong.check().is_err());
        let map = Arc::new(EnvironmentMap::new(1, 1, vec![[1.0; 3]]).unwrap());
        let squeezed = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 1.0));
        let wrong = EnvironmentKind::of_map(map, DVec3::Y, &squeezed);
        assert!(Environment::new(wrong).check().is_err());
    }
}
