//! Poses of KITTI's odometry benchmark.

use std::path::Path;

use super::super::Trajectory;
use super::super::rotation::nearest_rotation;
use super::rows::Rows;
use super::text::Lines;
use crate::error::{Error, Result};
use crate::geometry::{DMat3, DVec3};
use crate::memory;

/// Poses in a second.
const RATE: f64 = 10.0;

/// Reads KITTI's odometry poses: in each line the twelve numbers of a 3 x 4 matrix, row by row,
/// which takes coordinates of the left camera to those of the world. `path` is what errors call the
/// text.
///
/// The `times`, in seconds, stand in another file ([`read_kitti_times`]). Without them there are
/// ten poses a second, the first at zero, as KITTI's scanner turns.
///
/// The matrix must be a rotation within 0.0001; the nearest rotation is taken. KITTI's bodies are
/// cameras of [right, down, forwards](super::super::BodyAxes::RightDownForwards), and its world is
/// the first of them.
///
/// # Errors
///
/// The errors of [`TrajectoryFormat::read`](super::TrajectoryFormat::read), and [`Error::Argument`]
/// for times that are not as many as the poses, and for those that [`Trajectory::new`] refuses.
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
        let rotation = nearest_rotation(matrix).map_err(|what| line.error(what))?;
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

/// Reads KITTI's `times.txt`: the seconds of each pose, one in a line. `path` is what errors call
/// the text.
///
/// # Errors
///
/// The errors of [`TrajectoryFormat::read`](super::TrajectoryFormat::read).
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
