use crate::geometry::{Color, DVec3};

/// A light without a size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Parallel light from infinitely far away.
    Directional {
        /// Where the light goes (not where it comes from); any length but zero.
        direction: DVec3,
        /// The linear colour that a white surface facing the light takes.
        color: Color,
    },
    /// Light from one point, falling off with the square of the distance.
    Point {
        /// Where the light is.
        position: DVec3,
        /// The linear colour that a white surface facing the light takes at distance one.
        intensity: Color,
    },
}
