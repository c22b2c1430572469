//! Bounds for rounding, in the tree's space.

/// The unit of float32's rounding: half of `f32::EPSILON`.
pub(super) const U: f32 = f32::EPSILON / 2.0;

/// The test of a box lets rays pass that are farther from it than their blur twice by this much at most: 12 times
/// the reach, and its own rounding.
pub(super) const MARGIN: f32 = 150.0 * U;

/// Starts beyond this are moved. The tree is in the cube from -1 to 1.
pub(super) const FAR: f64 = 8.0;
// What the test of a box allows for, which has a reach of at most `FAR + 1`.
const _: () = assert!(14.0 * (FAR + 1.0) * (U as f64) < MARGIN as f64);
