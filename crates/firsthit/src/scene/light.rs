use crate::geometry::{Color, DVec3};

/// A light without a size.
///
/// ```
/// use firsthit::{Color, DVec3, Light, Scene};
///
/// let sun = Light::Directional {
///     direction: DVec3::new(0.5, 0.5, -1.0),
///     color: Color::splat(0.9),
/// };
/// let scene = Scene::new(vec![])?.with_lights(vec![sun]);
/// assert_eq!(scene.lights(), [sun]);
/// # Ok::<(), firsthit::Error>(())
/// ```
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
    /// Light from one point into a cone, falling off with the square of the distance, and from full light at
    /// the inner angle to none at the outer one.
    Spot {
        /// Where the light is.
        position: DVec3,
        /// Where the middle of the cone goes; any length but zero.
        direction: DVec3,
        /// The linear colour that a white surface facing the light takes at distance one.
        intensity: Color,
        /// Between the middle and the end of full light, in radians; less than `outer_angle`.
        inner_angle: f64,
        /// Between the middle and the end of all light, in radians; at most a quarter turn.
        outer_angle: f64,
    },
}
