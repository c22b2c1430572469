//! Topics of ROS bags as text.

use std::path::Path;

use super::super::Trajectory;
use super::table::{Columns, read_table};
use super::text::Unit;
use crate::error::Result;

/// The fields of the position and the rotation in messages that have a pose.
const MESSAGES: [[&str; 2]; 4] = [
    // geometry_msgs/PoseStamped
    ["field.pose.position", "field.pose.orientation"],
    // nav_msgs/Odometry, geometry_msgs/PoseWithCovarianceStamped
    ["field.pose.pose.position", "field.pose.pose.orientation"],
    // geometry_msgs/TransformStamped
    ["field.transform.translation", "field.transform.rotation"],
    // geometry_msgs/Pose
    ["field.position", "field.orientation"],
];

/// Reads what `rostopic echo -p -b FILE.bag TOPIC` prints of poses, odometry and transforms: CSV
/// with a header such as `%time,field.header.stamp,field.pose.position.x` and so on. `path` is what
/// errors call the text.
///
/// Times are whole nanoseconds: those of `field.header.stamp`, when it was measured, or where there
/// are none those of `%time`, when it was recorded. A float64 holds the seconds of our days to a
/// quarter of a microsecond.
///
/// Bodies of ROS are [forwards, left, up](super::super::BodyAxes::ForwardsLeftUp), unless the frame
/// is an optical one.
///
/// # Errors
///
/// The errors of [`TrajectoryFormat::read`](super::TrajectoryFormat::read).
pub fn read_ros(text: &[u8], path: &Path) -> Result<Trajectory> {
    read_table(text, path, |header| {
        let stamp = match header.find(&["field.header.stamp"])? {
            Some(stamp) => Some(stamp),
            None => header.find(&["%time"])?,
        };
        let Some((time, _)) = stamp else {
            return Err(header.missing(&["field.header.stamp", "%time"]));
        };
        let names = MESSAGES.map(names_of);
        let mut pose = None;
        for names in &names {
            let names = names.each_ref().map(String::as_str);
            let [first, ..] = names;
            if header.find(&[first])?.is_some() {
                pose = Some(header.pose(names.each_ref().map(std::slice::from_ref))?);
                break;
            }
        }
        let Some(pose) = pose else {
            return Err(header.missing(&names.each_ref().map(|[first, ..]| first.as_str())));
        };
        Ok(Columns { time, unit: Unit::NANOSECOND, pose })
    })
}

/// The names of the columns of `x y z qx qy qz qw`.
fn names_of([position, rotation]: [&str; 2]) -> [String; 7] {
    let p = |axis| format!("{position}.{axis}");
    let q = |axis| format!("{rotation}.{axis}");
    [p("x"), p("y"), p("z"), q("x"), q("y"), q("z"), q("w")]
}
