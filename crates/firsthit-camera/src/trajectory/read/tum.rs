//! The text format of TUM's RGB-D benchmark.

use std::path::Path;

use super::super::Trajectory;
use super::rows::Rows;
use super::text::Lines;
use crate::error::Result;

/// Reads what TUM's RGB-D benchmark and most SLAM programs write: `timestamp tx ty tz qx qy qz qw`
/// in each line, in seconds, with blanks between. Lines that start with `#` are comments. `path` is
/// what errors call the text.
///
/// TUM's bodies are cameras of [right, down, forwards](super::super::BodyAxes::RightDownForwards).
///
/// # Errors
///
/// The errors of [`TrajectoryFormat::read`](super::TrajectoryFormat::read).
pub fn read_tum(text: &[u8], path: &Path) -> Result<Trajectory> {
    let mut rows = Rows::default();
    for line in Lines::new(text, path)? {
        let [at, ref pose @ ..] = line.exactly::<8>("timestamp tx ty tz qx qy qz qw")?;
        rows.add(at.number()?, at, pose)?;
    }
    rows.finish(path)
}
