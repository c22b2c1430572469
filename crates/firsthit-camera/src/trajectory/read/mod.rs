//! Trajectories from text: a file for each format. Opening files is for others.
//!
//! A text is untrusted: no count in it sizes an allocation, and what is kept of it takes at most
//! eight times its size.

// A reader that panics is a reader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

mod csv;
mod kitti;
mod ros;
mod rows;
mod table;
mod text;
mod tum;

pub use csv::read_csv;
pub use kitti::{read_kitti, read_kitti_times};
pub use ros::read_ros;
pub use tum::read_tum;

use std::path::Path;

use super::Trajectory;
use crate::error::Result;
use crate::geometry::named;

named! {
    /// The texts that trajectories are read from. A path's extension does not tell them apart.
    ///
    /// ```
    /// use std::path::Path;
    ///
    /// use firsthit::trajectory::TrajectoryFormat;
    ///
    /// let format: TrajectoryFormat = "tum".parse()?;
    /// let error = format.read(b"0 0 0 0 0 0 0 1\n1 2 3\n", Path::new("poses.txt")).unwrap_err();
    /// assert_eq!(error.to_string(), "poses.txt:2: expected 8 numbers (timestamp tx ty tz qx qy qz qw), got 3");
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum TrajectoryFormat, "trajectory format":
    /// Columns by their names, see [`read_csv`].
    #[default]
    "csv" => Csv;
    /// TUM's RGB-D benchmark, see [`read_tum`].
    "tum" => Tum;
    /// KITTI's odometry benchmark at ten poses a second, see [`read_kitti`].
    "kitti" => Kitti;
    /// A topic of a ROS bag as `rostopic echo -p` prints it, see [`read_ros`].
    "ros" => Ros;
}

impl TrajectoryFormat {
    /// Reads a trajectory. `path` is what errors call the text; nothing is opened.
    ///
    /// # Errors
    ///
    /// [`Error::Parse`](crate::error::Error::Parse) with line and column for what is wrong in the
    /// text, and [`Error::Limit`](crate::error::Error::Limit) when memory is short.
    pub fn read(self, text: &[u8], path: &Path) -> Result<Trajectory> {
        match self {
            Self::Csv => read_csv(text, path),
            Self::Tum => read_tum(text, path),
            Self::Kitti => read_kitti(text, path, None),
            Self::Ros => read_ros(text, path),
        }
    }
}

#[cfg(test)]
mod tests;
