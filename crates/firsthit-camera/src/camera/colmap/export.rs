//! Cameras in COLMAP's words.

use super::{ColmapModel, PixelMatrix};
use crate::camera::{Camera, Convention, Projection, RayStart};
use crate::error::{Error, Result};

/// A camera as COLMAP has it; the centre of the first pixel is at (0.5, 0.5).
///
/// ```
/// use firsthit::camera::ColmapCamera;
/// use firsthit::{Camera, RayStart, View};
///
/// let camera = Camera::new(View::default())?.starting_at(RayStart::Eye);
/// let camera = ColmapCamera::of(&camera)?;
/// assert_eq!((camera.model.name, camera.qvec), ("PINHOLE", [0.0, 1.0, 0.0, 0.0]));
/// assert!(camera.camera_line(1).starts_with("1 PINHOLE 640 480 "));
/// assert!(camera.image_lines("a.png", 1, 1).ends_with(" 1 a.png\n"));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ColmapCamera {
    /// The model.
    pub model: &'static ColmapModel,
    /// The columns.
    pub width: usize,
    /// The rows.
    pub height: usize,
    /// The model's parameters, in COLMAP's order.
    pub params: Vec<f64>,
    /// The rotation from the world to the camera as a quaternion, real part first.
    pub qvec: [f64; 4],
    /// The translation from the world to the camera.
    pub tvec: [f64; 3],
}

/// The numbers that distort nothing: K, the viewplane, and a thin lens, which COLMAP does not have.
const WITHOUT_DISTORTION: [&str; 10] =
    ["fx", "fy", "cx", "cy", "skew", "focal_length", "width", "height", "aperture", "focus"];

impl ColmapCamera {
    /// A camera in COLMAP's words.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a camera that COLMAP has no model for.
    pub fn of(camera: &Camera) -> Result<Self> {
        let projection = camera.lens().projection();
        let viewplane = camera.lens().viewplane();
        let start = viewplane.map_or(RayStart::Eye, |viewplane| viewplane.ray_start);
        let matrix = camera.pixel_matrix();
        let matrix = matrix.filter(|matrix| matrix.skew == 0.0 && start == RayStart::Eye);
        let Some(matrix) = matrix else {
            let expected =
                "perspective or calibrated for COLMAP, without skew, with rays from the eye";
            let skew = camera.pixel_matrix().map_or(0.0, |matrix| matrix.skew);
            let (name, start) = (projection.name(), start.name());
            let got = format!("{name} with skew {skew} and rays from the {start}");
            return Err(Error::argument("camera", expected, got));
        };
        let others = camera.lens().parameters().into_iter();
        let mut others: Vec<(&str, f64)> =
            others.filter(|(name, _)| !WITHOUT_DISTORTION.contains(name)).collect();
        // COLMAP's fisheyes have no edge.
        others.retain(|&(name, value)| value != 0.0 && (name, value) != ("fov", 360.0));
        let is_enough = |model: &&ColmapModel| {
            let has = |(name, _): &(&str, f64)| model.parameters.contains(name);
            let is_simple = model.parameters.contains(&"f");
            let has_all = projection == Projection::Perspective || others.iter().all(has);
            !is_simple && model.projection == projection && has_all
        };
        let Some(model) = ColmapModel::ALL.iter().find(is_enough) else {
            let mut names: Vec<&str> = others.iter().map(|&(name, _)| name).collect();
            names.sort_unstable();
            let got = format!("{} with {}", projection.name(), names.join(", "));
            return Err(Error::argument("camera", "one that COLMAP has a model for", got));
        };
        let PixelMatrix { fx, fy, cx, cy, .. } = matrix;
        others.extend([("fx", fx), ("fy", fy), ("cx", cx), ("cy", cy)]);
        let number = |name: &&str| {
            let found = others.iter().find(|(own, _)| own == name);
            found.map_or(0.0, |&(_, value)| value)
        };
        let rows = Convention::Colmap.matrix(&camera.world_from_camera());
        let [[_, _, _, x], [_, _, _, y], [_, _, _, z], _] = rows;
        Ok(Self {
            model,
            width: camera.columns(),
            height: camera.rows(),
            params: model.parameters.iter().map(number).collect(),
            qvec: quaternion(&rows),
            tvec: [x, y, z],
        })
    }

    /// The line of `cameras.txt`.
    pub fn camera_line(&self, camera_id: u32) -> String {
        let Self { model, width, height, .. } = self;
        format!("{camera_id} {} {width} {height} {}", model.name, words(&self.params))
    }

    /// The two lines of `images.txt`; the second, of observed points, is empty.
    pub fn image_lines(&self, name: &str, image_id: u32, camera_id: u32) -> String {
        let (qvec, tvec) = (words(&self.qvec), words(&self.tvec));
        format!("{image_id} {qvec} {tvec} {camera_id} {name}\n")
    }
}

/// Numbers with blanks between them, that are read back to the last bit.
fn words(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    words.join(" ")
}

/// The quaternion of a rotation: its real part first, which is not negative.
fn quaternion(&[[a, b, c, _], [d, e, f, _], [g, h, i, _], _]: &[[f64; 4]; 4]) -> [f64; 4] {
    let trace = a + e + i;
    let largest = trace.max(a).max(e).max(i);
    // The largest of the four is the divisor.
    let made = if trace == largest {
        [1.0 + trace, h - f, c - g, d - b]
    } else if a == largest {
        [h - f, 1.0 + a - e - i, d + b, g + c]
    } else if e == largest {
        [c - g, d + b, 1.0 + e - i - a, h + f]
    } else {
        [d - b, g + c, h + f, 1.0 + i - a - e]
    };
    let length = made.iter().map(|x| x * x).sum::<f64>().sqrt();
    let length = if made[0] < 0.0 { -length } else { length };
    made.map(|x| x / length)
}
