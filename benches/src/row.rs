//! A row of the table: its rays, and its numbers.

use clap::ValueEnum;

use crate::check::Checked;
use crate::embree::Door;
use crate::measure::Timing;
use crate::tinybvh::Beside;
use crate::visits::Visits;

/// A kind of rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Row {
    /// The pixels of a perspective camera, from its description
    Primary,
    /// The pixels of an orthographic camera, from its description
    Orthographic,
    /// The pixels of the first row's camera with OpenCV's distortion, from its description; Embree
    /// gets the same rays, made before
    Distorted,
    /// The pixels of an equidistant fisheye of 180 degrees in the same place, likewise
    Fisheye,
    /// The first row's as an array of rays in float32, row by row
    Array,
    /// From each hit of the first row to the light: anything in between?
    Shadow,
    /// Four from each hit, as far as the scene's reach: anything there?
    Occlusion,
    /// One from each hit, as a matt surface scatters: the first hit
    Bounce,
    /// From points all over the scene's box in all directions: the first hit
    Random,
    /// All hits of those rays, in order
    AllHits,
    /// The picture of the first row's camera, unlit, four points to a pixel, whole; of Embree the
    /// rays alone
    Antialiased,
    /// The picture of the first row's camera, lit and with shadows, whole; of Embree the rays alone
    Shaded,
}

impl Row {
    /// Every row, in the table's order.
    pub(crate) const ALL: &[Self] = &[
        Self::Primary,
        Self::Orthographic,
        Self::Distorted,
        Self::Fisheye,
        Self::Array,
        Self::Shadow,
        Self::Occlusion,
        Self::Bounce,
        Self::Random,
        Self::AllHits,
        Self::Antialiased,
        Self::Shaded,
    ];

    /// The name, as on the command line.
    pub(crate) fn name(self) -> String {
        let value = self.to_possible_value().expect("no row is hidden");
        value.get_name().to_owned()
    }
}

/// Embree's columns: robust or not, and the door.
pub(crate) const DOORS: [(bool, Door); 6] = [
    (false, Door::Single),
    (false, Door::Packet),
    (false, Door::Coherent),
    (true, Door::Single),
    (true, Door::Packet),
    (true, Door::Coherent),
];

/// A row for one scene. Times are nanoseconds of one thread for each ray.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    pub(crate) row: Row,
    pub(crate) rays: usize,
    pub(crate) firsthit: Timing,
    /// The times by [`DOORS`]; none without Embree.
    pub(crate) embree: Vec<Timing>,
    /// The speedup of firsthit by two threads.
    pub(crate) speedup: f64,
    pub(crate) checked: Checked,
    /// The visits of rows whose rays go through one tree one by one.
    pub(crate) visits: Option<Visits>,
    /// The times of tinybvh; `None` without it.
    pub(crate) tinybvh: Option<Beside>,
}
