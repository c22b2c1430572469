//! Conventions of other programs for cameras: the directions of their axes and matrices, and the
//! centre of the first pixel.

use super::{Camera, Lens, PixelMatrix, View, Viewplane};
use crate::error::{Error, Result};
use crate::geometry::{DAffine3, DMat3, DVec3, named, require};

named! {
    /// The conventions by name.
    ///
    /// | name | x, y, z of the camera | the matrix takes | centre of the first pixel |
    /// |---|---|---|---|
    /// | `opencv` | right, down, forwards | the world to the camera | (0, 0) |
    /// | `colmap` | right, down, forwards | the world to the camera | (0.5, 0.5) |
    /// | `ros` | right, down, forwards | the camera to the world | (0, 0) |
    /// | `opengl` | right, up, backwards | the camera to the world | (0.5, 0.5) |
    /// | `blender` | right, up, backwards | the camera to the world | (0.5, 0.5) |
    /// | `gltf` | right, up, backwards | the camera to the world | (0.5, 0.5) |
    /// | `nerfstudio` | right, up, backwards | the camera to the world | (0.5, 0.5) |
    /// | `pytorch3d` | left, up, forwards | rows of the world to rows of the camera | (0.5, 0.5) |
    ///
    /// ```
    /// use firsthit::camera::Convention;
    ///
    /// assert_eq!("colmap".parse::<Convention>()?.first_pixel_center(), 0.5);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum Convention, "convention":
    /// OpenCV: `[R | t]`, as `cv2.solvePnP` and `cv2.calibrateCamera` give them.
    #[default]
    "opencv" => OpenCv;
    /// OpenGL: the inverse of the view matrix, as pyrender and trimesh take poses, and radiance
    /// fields.
    "opengl" => OpenGl;
    /// COLMAP: `images.txt`.
    "colmap" => Colmap;
    /// Blender: `camera.matrix_world`.
    "blender" => Blender;
    /// ROS: the pose of the optical frame of REP 103, with K of `CameraInfo`.
    "ros" => Ros;
    /// `PyTorch3D`: `get_world_to_view_transform().get_matrix()`, which is applied to rows; K in
    /// screen space.
    "pytorch3d" => PyTorch3d;
    /// nerfstudio: `transform_matrix` of `transforms.json`.
    "nerfstudio" => Nerfstudio;
    /// glTF: the global matrix of the camera's node.
    "gltf" => Gltf;
}

/// The direction of a convention's matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MatrixForm {
    WorldFromCamera,
    CameraFromWorld,
    /// The matrix maps rows: transposed.
    RowsOfCamera,
}

impl Convention {
    /// The coordinates, both of them, of the first pixel's centre.
    pub fn first_pixel_center(self) -> f64 {
        match self {
            Self::OpenCv | Self::Ros => 0.0,
            _ => 0.5,
        }
    }

    fn matrix_form(self) -> MatrixForm {
        match self {
            Self::OpenCv | Self::Colmap => MatrixForm::CameraFromWorld,
            Self::PyTorch3d => MatrixForm::RowsOfCamera,
            _ => MatrixForm::WorldFromCamera,
        }
    }

    /// The signs that take this convention's camera coordinates to right, up and backwards.
    fn signs(self) -> DVec3 {
        match self {
            Self::OpenCv | Self::Colmap | Self::Ros => DVec3::new(1.0, -1.0, -1.0),
            Self::PyTorch3d => DVec3::new(-1.0, 1.0, -1.0),
            _ => DVec3::ONE,
        }
    }

    /// The pose that this convention writes as `matrix`, row by row: from right, up and backwards
    /// to the world.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a matrix that is no rigid motion to
    /// 1e-4: scaled, mirrored, sheared, or with another last row than (0, 0, 0, 1).
    pub fn pose(self, matrix: [[f64; 4]; 4]) -> Result<DAffine3> {
        let rows = if self.matrix_form() == MatrixForm::RowsOfCamera {
            [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| matrix[column][row]))
        } else {
            matrix
        };
        let is_finite = rows.iter().flatten().all(|x| x.is_finite());
        let fine = is_finite && rows[3] == [0.0, 0.0, 0.0, 1.0];
        let expected = "a finite 4 x 4 matrix with (0, 0, 0, 1) as its last row (its last column, for pytorch3d)";
        require("pose", expected, fine, format!("{matrix:?}"))?;
        let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
        let rotation = DMat3::from_cols(column(0), column(1), column(2));
        require_rotation(&rotation, || format!("{matrix:?}"))?;
        let given = DAffine3::from_mat3_translation(rotation, column(3));
        let world_from_camera = if self.matrix_form() == MatrixForm::WorldFromCamera {
            given
        } else {
            // Of a rotation the inverse is the transpose.
            let back = rotation.transpose();
            DAffine3::from_mat3_translation(back, DVec3::ZERO - back * column(3))
        };
        let signs = DMat3::from_diagonal(self.signs());
        let rotation = world_from_camera.matrix3 * signs;
        Ok(DAffine3::from_mat3_translation(rotation, world_from_camera.translation))
    }

    /// The matrix, row by row, that this convention writes a pose as, which goes from right, up and
    /// backwards to the world.
    pub fn matrix(self, pose: &DAffine3) -> [[f64; 4]; 4] {
        let signs = DMat3::from_diagonal(self.signs());
        let rotation = pose.matrix3 * signs;
        let (rotation, translation) = if self.matrix_form() == MatrixForm::WorldFromCamera {
            (rotation, pose.translation)
        } else {
            let back = rotation.transpose();
            (back, DVec3::ZERO - back * pose.translation)
        };
        let row = |k: usize| {
            let [x, y, z] = rotation.row(k).to_array();
            [x, y, z, translation[k]]
        };
        let rows = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]];
        if self.matrix_form() == MatrixForm::RowsOfCamera {
            return [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| rows[column][row]));
        }
        rows
    }

    /// A matrix K of this convention as this library counts pixels.
    pub fn pixel_matrix(self, given: PixelMatrix) -> PixelMatrix {
        let offset = 0.5 - self.first_pixel_center();
        PixelMatrix { cx: given.cx + offset, cy: given.cy + offset, ..given }
    }

    /// The matrix in the convention's own pixels, from one in ours.
    pub fn own_pixel_matrix(self, matrix: PixelMatrix) -> PixelMatrix {
        let offset = 0.5 - self.first_pixel_center();
        PixelMatrix { cx: matrix.cx - offset, cy: matrix.cy - offset, ..matrix }
    }
}

/// Whether a matrix is a rotation to 1e-4: neither scaled nor sheared nor mirrored. One with a NaN
/// is none.
fn is_rotation(matrix: &DMat3) -> bool {
    let off = (matrix.transpose() * *matrix - DMat3::IDENTITY).to_cols_array();
    off.iter().all(|x| x.abs() < 1e-4) && matrix.determinant() > 0.0
}

/// Fails for a pose whose `matrix` is no rotation to 1e-4, with how far it is off one; `got` is the
/// pose.
pub(super) fn require_rotation(matrix: &DMat3, got: impl FnOnce() -> String) -> Result<()> {
    if is_rotation(matrix) {
        return Ok(());
    }
    let volume = matrix.determinant();
    let why = if volume < 0.0 {
        "it mirrors".to_owned()
    } else if volume > 0.0 {
        let off = largest(&(polar_factor(matrix, 64) - *matrix));
        format!(
            "its numbers are up to {off:.1e} off the nearest rotation, and what is rounded by up to {FARTHEST:.0e} is mended"
        )
    } else {
        "it flattens space".to_owned()
    };
    let expected = "a rotation and a translation, without a scale or a mirror";
    let got = format!("{}; {why}", got());
    Err(Error::argument("pose", expected, got))
}

/// The largest distance of a number of a rounded pose from that of the nearest rotation.
const FARTHEST: f64 = 1e-3;

/// The polar factor of a matrix that does not mirror, by Newton's method: near a rotation each step
/// squares what is off, and far from it halves it (Higham, "Computing the Polar Decomposition",
/// 1986).
fn polar_factor(matrix: &DMat3, steps: u32) -> DMat3 {
    (0..steps).fold(*matrix, |m, _| (m + m.inverse().transpose()) * 0.5)
}

fn largest(matrix: &DMat3) -> f64 {
    let numbers = matrix.to_cols_array();
    numbers.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// A pose whose rotation is none to 1e-4, but no number of which is farther than 1e-3 from one, as
/// where a file has three decimals: the pose with the nearest rotation, and how far a number was
/// off. `None` for all others. It is the same for every [`Convention`].
///
/// ```
/// use firsthit::camera::orthonormalised;
///
/// let turned = |c: f64| [[c, 0.5, 0.0, 1.0], [-0.5, c, 0.0, 2.0], [0.0, 0.0, 1.0, 3.0], [0.0, 0.0, 0.0, 1.0]];
/// assert_eq!(orthonormalised(turned(0.866)), None);
/// let (again, off) = orthonormalised(turned(0.867)).unwrap();
/// assert!((again[0][0].hypot(again[0][1]) - 1.0).abs() < 1e-15 && off < 1e-3);
/// ```
pub fn orthonormalised(pose: [[f64; 4]; 4]) -> Option<([[f64; 4]; 4], f64)> {
    let column = |k: usize| DVec3::new(pose[0][k], pose[1][k], pose[2][k]);
    let given = DMat3::from_cols(column(0), column(1), column(2));
    let square = (given.transpose() * given - DMat3::IDENTITY).to_cols_array();
    // Else the steps below may not come near. Written so that a NaN fails.
    let is_near = square.iter().all(|x| x.abs() < 0.1) && given.determinant() > 0.0;
    if !is_near || is_rotation(&given) {
        return None;
    }
    let nearest = polar_factor(&given, 5);
    let off = largest(&(nearest - given));
    let mut turned = pose;
    for (k, row) in turned.iter_mut().take(3).enumerate() {
        row[..3].copy_from_slice(&nearest.row(k).to_array());
    }
    (off <= FARTHEST).then_some((turned, off))
}

/// The warning about a pose that is [`orthonormalised`], whose numbers were `off` by so much.
pub fn rounded_pose(off: f64) -> String {
    format!(
        "the rotation is rounded, and the nearest one is taken: numbers change by up to {off:.1e}"
    )
}

/// The rotation about `vector` by its length in radians, as `cv2.Rodrigues` has it.
///
/// ```
/// use firsthit::DVec3;
/// use firsthit::camera::rotation;
///
/// let quarter = rotation(DVec3::Z * std::f64::consts::FRAC_PI_2);
/// assert!((quarter * DVec3::X).abs_diff_eq(DVec3::Y, 1e-15));
/// ```
pub fn rotation(vector: DVec3) -> DMat3 {
    let angle = vector.length();
    let cross = DMat3::from_cols(
        DVec3::new(0.0, vector.z, -vector.y),
        DVec3::new(-vector.z, 0.0, vector.x),
        DVec3::new(vector.y, -vector.x, 0.0),
    );
    // Rodrigues' formula; near zero by the series of its two quotients.
    let (sine, versine) = if angle < 1e-4 {
        let square = angle * angle;
        (1.0 - square / 6.0, 0.5 - square / 24.0)
    } else {
        let half = libm::sin(0.5 * angle) / angle;
        (libm::sin(angle) / angle, 2.0 * half * half)
    };
    DMat3::IDENTITY + sine * cross + versine * (cross * cross)
}

impl Camera {
    /// A camera with a lens, at a pose: from right, up and backwards to the world.
    ///
    /// # Errors
    ///
    /// All that [`Camera::new`] refuses.
    pub fn at_pose(pose: &DAffine3, lens: Lens, rows: usize, columns: usize) -> Result<Self> {
        Self::new(View {
            position: pose.translation,
            // Written so that no zero is negative.
            aim: DVec3::ZERO - pose.matrix3.z_axis,
            up: pose.matrix3.y_axis,
            rows,
            columns,
            lens,
        })
    }

    /// A pinhole camera by its intrinsic matrix, in this library's pixel coordinates, at a pose.
    ///
    /// ```
    /// use firsthit::camera::{Convention, PixelMatrix};
    /// use firsthit::{Camera, DVec3};
    ///
    /// // OpenCV's: looking along +z, the principal point at the centre of pixel (319, 239).
    /// let k = PixelMatrix { fx: 500.0, fy: 500.0, cx: 319.0, cy: 239.0, skew: 0.0 };
    /// let k = Convention::OpenCv.pixel_matrix(k);
    /// let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    /// let pose = Convention::OpenCv.pose(identity)?;
    /// let camera = Camera::from_intrinsics(&k, &pose, 480, 640)?;
    /// assert_eq!(camera.aim(), DVec3::Z);
    /// assert!(camera.ray(239, 319).direction.abs_diff_eq(DVec3::Z, 1e-15));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for focal lengths that are not positive, and all that [`Camera::new`]
    /// refuses.
    pub fn from_intrinsics(
        matrix: &PixelMatrix,
        pose: &DAffine3,
        rows: usize,
        columns: usize,
    ) -> Result<Self> {
        let viewplane = Viewplane::from_pixel_matrix(matrix, rows, columns)?;
        Self::at_pose(pose, Lens::Flat(viewplane), rows, columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written out by hand: what each convention's matrix makes of a point that is 2 to the right,
    /// 3 up and 5 ahead.
    #[test]
    fn every_convention_puts_a_point_where_its_axes_say() {
        let camera = Camera::new(View {
            position: DVec3::new(1.0, -2.0, 0.5),
            aim: DVec3::new(0.6, 0.0, -0.8),
            up: DVec3::Y,
            ..View::default()
        })
        .unwrap();
        let point =
            camera.position() + 2.0 * camera.right() + 3.0 * camera.upwards() + 5.0 * camera.aim();
        let expected = |convention| match convention {
            Convention::OpenCv | Convention::Colmap | Convention::Ros => DVec3::new(2.0, -3.0, 5.0),
            Convention::PyTorch3d => DVec3::new(-2.0, 3.0, 5.0),
            _ => DVec3::new(2.0, 3.0, -5.0),
        };
        for &convention in Convention::ALL {
            let m = convention.matrix(&camera.world_from_camera());
            let apply = |m: [[f64; 4]; 4], p: DVec3| {
                DVec3::from_array(
                    [0, 1, 2].map(|r| m[r][0] * p.x + m[r][1] * p.y + m[r][2] * p.z + m[r][3]),
                )
            };
            let transposed = [0, 1, 2, 3].map(|r| [0, 1, 2, 3].map(|c| m[c][r]));
            let in_camera = expected(convention);
            let (found, wanted) = match convention {
                Convention::OpenCv | Convention::Colmap => (apply(m, point), in_camera),
                Convention::PyTorch3d => (apply(transposed, point), in_camera),
                _ => (apply(m, in_camera), point),
            };
            assert!((found - wanted).length() < 1e-13, "{convention:?}: {found}");
            let back = convention.pose(m).unwrap();
            assert!(back.abs_diff_eq(camera.world_from_camera(), 1e-14));
        }
    }

    /// The columns of a rotation, rounded.
    #[test]
    fn poses_of_three_decimals_are_made_orthonormal_and_others_left() {
        let mut made = 0;
        for k in 0..200 {
            let angle = f64::from(k);
            let vector =
                DVec3::new(libm::sin(angle), libm::cos(2.0 * angle), libm::sin(0.7 * angle));
            let pose_of = |m: DMat3| {
                let row = |k: usize| [m.row(k).x, m.row(k).y, m.row(k).z, 4.0];
                [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
            };
            let turn = rotation(vector);
            assert_eq!(orthonormalised(pose_of(turn)), None);
            let rounded = turn.to_cols_array().map(|x| (1000.0 * x).round() / 1000.0);
            let given = pose_of(DMat3::from_cols_array(&rounded));
            if Convention::Ros.pose(given).is_ok() {
                continue;
            }
            made += 1;
            let (again, off) = orthonormalised(given).unwrap();
            assert!(off <= 1e-3, "{off}");
            let pose = Convention::Ros.pose(again).unwrap();
            let square = pose.matrix3.transpose() * pose.matrix3 - DMat3::IDENTITY;
            assert!(square.to_cols_array().iter().all(|x| x.abs() < 1e-15));
            assert_eq!(pose.translation, DVec3::splat(4.0));
            for factor in [1.01, -1.0] {
                assert_eq!(orthonormalised(given.map(|row| row.map(|x| factor * x))), None);
            }
        }
        assert!(made > 100, "{made}");
    }

    #[test]
    fn what_is_no_rigid_motion_is_refused() {
        let identity = [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        for (row, column, value) in
            [(0, 0, 2.0), (0, 0, -1.0), (0, 1, 0.1), (3, 0, 1.0), (1, 3, f64::NAN)]
        {
            let mut matrix = identity;
            matrix[row][column] = value;
            assert!(Convention::OpenCv.pose(matrix).is_err(), "{matrix:?}");
        }
    }
}
