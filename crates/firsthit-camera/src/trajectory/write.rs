//! Trajectories as text, in the shortest decimals that are read as the same float64.

use std::io::{self, Write};

use super::Trajectory;

impl Trajectory {
    /// Writes the poses as TUM's RGB-D benchmark does: a line `timestamp tx ty tz qx qy qz qw` for
    /// each, in seconds.
    ///
    /// # Errors
    ///
    /// The errors of `out`.
    pub fn write_tum(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "# timestamp tx ty tz qx qy qz qw")?;
        self.write_rows(' ', out)
    }

    /// Writes the poses as CSV with a header: a line `time,x,y,z,qx,qy,qz,qw` for each, in seconds.
    ///
    /// ```
    /// use std::path::Path;
    ///
    /// use firsthit::trajectory::read_csv;
    /// use firsthit::{Pose, Trajectory};
    ///
    /// let trajectory = Trajectory::new(vec![0.1], vec![Pose::IDENTITY])?;
    /// let mut text = Vec::new();
    /// trajectory.write_csv(&mut text)?;
    /// assert_eq!(text, b"time,x,y,z,qx,qy,qz,qw\n0.1,0.0,0.0,0.0,0.0,0.0,0.0,1.0\n");
    /// assert_eq!(read_csv(&text, Path::new("poses.csv"))?, trajectory);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of `out`.
    pub fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "time,x,y,z,qx,qy,qz,qw")?;
        self.write_rows(',', out)
    }

    fn write_rows(&self, separator: char, out: &mut dyn Write) -> io::Result<()> {
        for (time, pose) in self.times.iter().zip(&self.poses) {
            write!(out, "{time:?}")?;
            let position = pose.position.to_array();
            let rotation = pose.rotation.to_array();
            for number in position.iter().chain(&rotation) {
                write!(out, "{separator}{number:?}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}
