//! Poses of KITTI's odometry benchmark.

use std::path::Path;

use super::super::Trajectory;
use super::super::rotation::unit_rotation;
use super::rows::Rows;
use super::text::{Line, Lines};
use crate::error::{Error, Result};
use crate::geometry::{DMat3, DQuat, DVec3};
use crate::memory;

/// Poses in a second.
const RATE: f64 = 10.0;

/// How far the columns may be from being at right angles and of length one.
const SKEW: f64 = 1e-4;

/// Reads KITTI's odometry poses: in each line the twelve numbers of a 3 x 4 matrix, row by row, which takes coordinates of the
/// left camera to those of the world. `path` is what errors call the text.
///
/// The `times`, in seconds, stand in another file ([`read_kitti_times`]). Without them there are ten poses a second, the first
/// at zero, as KITTI's scanner turns.
///
/// The matrix must be a rotation within 0.0001; the nearest rotation is taken. KITTI's bodies are cameras of
/// [right, down, forwards](super::super::BodyAxes::RightDownForwards), and its world is the first of them.
///
/// # Errors
///
/// Those of [`TrajectoryFormat::read`](super::TrajectoryFormat::read), and [`Error::Argument`] for times that are not as many
/// as the poses, and for those that [`Trajectory::new`] refuses.
pub fn read_kitti(text: &[u8], path: &Path, times: Option<&[f64]>) -> Result<Trajectory> {
    let mut rows = Rows::default();
    for line in Lines::new(text, path)? {
        let fields = line.exactly::<12>("the rows of a 3 x 4 matrix")?;
        let mut numbers = [0.0; 12];
        for (number, field) in numbers.iter_mut().zip(&fields) {
            *number = field.number()?;
        }
        let [a, b, c, x, d, e, f, y, g, h, i, z] = numbers;
        let matrix = DMat3::from_cols_array(&[a, d, g, b, e, h, c, f, i]);
        let rotation = rotation_of(matrix, line)?;
        let time = rows.len() as f64 / RATE;
        rows.push(time, DVec3::new(x, y, z), rotation)?;
    }
    let trajectory = rows.finish(path)?;
    let Some(times) = times else {
        return Ok(trajectory);
    };
    let count = trajectory.poses.len();
    if times.len() != count {
        let got = format!("{} for {count} poses", times.len());
        return Err(Error::argument("times", "as many as poses", got));
    }
    let mut copy = memory::filled(times.len(), 0.0)?;
    copy.copy_from_slice(times);
    Trajectory::new(copy, trajectory.poses)
}

/// Reads KITTI's `times.txt`: the seconds of each pose, one in a line. `path` is what errors call the text.
///
/// # Errors
///
/// Those of [`TrajectoryFormat::read`](super::TrajectoryFormat::read).
pub fn read_kitti_times(text: &[u8], path: &Path) -> Result<Vec<f64>> {
    let mut times: Vec<f64> = Vec::new();
    for line in Lines::new(text, path)? {
        let [field] = line.exactly::<1>("seconds")?;
        let time = field.number()?;
        if let Some(before) = times.last().filter(|&&before| time <= before) {
            let what = format!("time {time} s is not after {before} s, that of the line before");
            return Err(field.error(what));
        }
        let full = |_| memory::no_room_for("times of a trajectory");
        times.try_reserve(1).map_err(full)?;
        times.push(time);
    }
    Ok(times)
}

/// The rotation that is nearest to a matrix that is nearly one.
///
/// # Errors
///
/// For others, at their line.
fn rotation_of(matrix: DMat3, line: Line<'_>) -> Result<DQuat> {
    let skew = matrix.transpose() * matrix - DMat3::IDENTITY;
    let skew = skew.to_cols_array().map(f64::abs);
    // So that a NaN fails.
    if !skew.iter().all(|&x| x <= SKEW) {
        let worst = skew.into_iter().fold(0.0, f64::max);
        return Err(line.error(format!(
            "the matrix is not a rotation: the products of its columns are off by {worst:.2e}, at most {SKEW} is expected"
        )));
    }
    if matrix.determinant() < 0.0 {
        return Err(line.error("the matrix is not a rotation: it mirrors"));
    }
    // The polar decomposition by Newton's iteration (Higham, "Computing the Polar Decomposition - with Applications", SIAM
    // Journal on Scientific and Statistical Computing 7(4), 1986). Each step squares what it is off: three are enough from 1e-4
    // on.
    let mut nearest = matrix;
    for _ in 0..3 {
        nearest = 0.5 * (nearest + nearest.inverse().transpose());
    }
    let rotation = DQuat::from_mat3(&nearest);
    unit_rotation(rotation).ok_or_else(|| line.error("the matrix is not a rotation"))
}
