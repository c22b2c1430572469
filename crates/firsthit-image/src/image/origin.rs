//! The origin of a frame: its scene and the sensor that made its rays.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::cryptomatte::Cryptomatte;
use super::names::Names;

/// The origin of a frame: the facts that no channel has. In JSON, the part of
/// [`Metadata`](super::Metadata) with these names.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The scene's fingerprint, such as that of `Scene::fingerprint`.
    pub scene: Option<String>,
    /// The camera that made the rays, if one did.
    pub camera: Option<CameraRecord>,
    /// The sensor that made the rays, if it is no camera.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<SensorRecord>,
    /// The number of samples whose mean is a pixel's colour, if there are colours or mattes; the
    /// most that a pixel has, where a noise ends them earlier.
    pub samples: Option<u32>,
    /// The shading of colours; a file says it of colours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shading: Option<ShadingRecord>,
    /// The colouring of surfaces by numbers, if there was one; a file says it if it has colours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colors: Option<ColorsRecord>,
    /// The row and column of the camera's pixel that is the first one of the frame: `[0, 0]` but
    /// for a region.
    #[serde(default)]
    pub first_pixel: [u64; 2],
    /// The names behind identifiers; a file says of it what its channels ask for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub names: Option<Names>,
    /// The names behind the identifiers of mattes, by the channel; a file says it of the channels
    /// that it has.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cryptomatte: BTreeMap<String, Cryptomatte>,
    /// The settings of a laser scanner's scan; its elements are returns, none of which is a miss.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scan: Option<serde_json::Value>,
    /// The scans that were put together, where there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scans: Option<serde_json::Value>,
}

/// The shading that made colours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShadingRecord {
    /// The shader's name.
    pub shader: String,
    /// The shader's settings, by their names: flags, numbers, or three numbers; `inf` for infinity.
    pub settings: BTreeMap<String, serde_json::Value>,
    /// A digest of this and of the lights, the environment, the background and the ground.
    pub digest: String,
}

/// How surfaces were coloured by numbers: the legend of such a picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ColorsRecord {
    /// The source of the numbers: `attribute:NAME`, `values`, or another word of `--color-by`.
    pub by: String,
    /// The name of the colour map.
    pub map: String,
    /// The numbers of its first and its last colour.
    pub range: [f64; 2],
    /// The linear colour of numbers below the range; `None` for the map's first.
    pub below: Option<[f64; 3]>,
    /// The linear colour of numbers above the range; `None` for the map's last.
    pub above: Option<[f64; 3]>,
    /// The linear colour where there is no number; `None` for the surface's own.
    pub missing: Option<[f64; 3]>,
}

/// A camera: in the specification's words, as intrinsic matrix, and as pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CameraRecord {
    /// The camera's position in the world.
    pub position: [f64; 3],
    /// The direction it looks in, of length one.
    pub aim: [f64; 3],
    /// The direction upwards, as it was given.
    pub up: [f64; 3],
    /// The distance from the camera to the viewplane; `None` for a projection without one, as for
    /// the next two.
    pub focal_length: Option<f64>,
    /// The viewplane's width.
    pub width: Option<f64>,
    /// The viewplane's height.
    pub height: Option<f64>,
    /// Pixels down.
    pub rows: u64,
    /// Pixels across.
    pub columns: u64,
    /// The projection's name.
    pub projection: String,
    /// The start that `t` counts from: `viewplane` or `eye`.
    pub ray_start: String,
    /// All numbers of the lens by their names, in the words of `Lens::parameters`; angles of fields
    /// of view and tilts are in degrees. Empty in files of before version 0.2.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
    /// The intrinsic matrix; `None` for parallel rays, which have none. It is applied after a
    /// lens's distortion.
    pub intrinsics: Option<Intrinsics>,
    /// The camera's position and orientation.
    pub pose: Pose,
}

/// The matrix K: `(u, v, 1)` is `K (x, y, z) / z`, where u counts pixels to the right and v
/// downwards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Intrinsics {
    /// Row by row.
    pub k: [[f64; 3]; 3],
    /// The coordinates (u and v) of the first pixel's centre: 0.5, as in COLMAP and OpenGL. For
    /// OpenCV, where they are 0, subtract 0.5 from the two numbers in the last column.
    pub first_pixel_center: f64,
    /// The meaning of x, y, z: the camera's right, down and forwards, as in OpenCV and COLMAP.
    pub axes: String,
}

/// The matrix that takes the camera's coordinates to the world's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Row by row; it is applied to columns.
    pub world_from_camera: [[f64; 4]; 4],
    /// The meaning of the camera's x, y, z: right, up and backwards, as in OpenGL, glTF and
    /// Blender.
    pub axes: String,
}

/// A sensor that is no camera. Lengths are scene units, times seconds, angles degrees.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SensorRecord {
    /// `rays`, `rolling_shutter`, `pushbroom` or `lidar`.
    pub kind: String,
    /// Pixels down.
    pub rows: u64,
    /// Pixels across.
    pub columns: u64,
    /// A digest of the origins and directions of all rays.
    pub digest: String,
    /// The sensor's numbers, by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, f64>,
    /// The sensor's words, by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub words: BTreeMap<String, String>,
    /// The meaning of x, y, z in the sensor's own coordinates, if it has some.
    pub axes: Option<String>,
    /// Row by row: the matrix that takes its coordinates to the world's, or to those of the body
    /// that carries it.
    pub pose: Option<[[f64; 4]; 4]>,
    /// The camera that is moved, in the coordinates of the body that carries it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraRecord>,
    /// The trajectory of the body that carries the sensor, if one does.
    pub trajectory: Option<TrajectoryRecord>,
}

/// A trajectory, in short.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryRecord {
    /// A digest of all times and poses.
    pub digest: String,
    /// The number of poses.
    pub poses: u64,
    /// The time of the first.
    pub start: f64,
    /// The time of the last.
    pub end: f64,
    /// The interpolation between poses.
    pub interpolation: String,
    /// The extrapolation beyond the poses.
    pub extrapolation: String,
    /// A sample of the poses between the first ray and the last.
    pub sampled: Vec<TimedPose>,
}

/// The pose of a body at a time.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TimedPose {
    /// The time.
    pub time: f64,
    /// Row by row: the matrix that takes the body's coordinates to the world's.
    pub world_from_body: [[f64; 4]; 4],
}
