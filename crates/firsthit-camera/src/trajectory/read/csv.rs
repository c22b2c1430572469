//! CSV with a header.

use std::path::Path;

use super::super::Trajectory;
use super::table::{Columns, Names, read_table};
use super::text::Unit;
use crate::error::Result;

/// The names of a column of the time, and the unit that each says.
const TIMES: [(&str, Unit); 15] = [
    ("time", Unit::SECOND),
    ("time_s", Unit::SECOND),
    ("time_ms", Unit::MILLISECOND),
    ("time_us", Unit::MICROSECOND),
    ("time_ns", Unit::NANOSECOND),
    ("t", Unit::SECOND),
    ("t_s", Unit::SECOND),
    ("t_ms", Unit::MILLISECOND),
    ("t_us", Unit::MICROSECOND),
    ("t_ns", Unit::NANOSECOND),
    ("timestamp", Unit::SECOND),
    ("timestamp_s", Unit::SECOND),
    ("timestamp_ms", Unit::MILLISECOND),
    ("timestamp_us", Unit::MICROSECOND),
    ("timestamp_ns", Unit::NANOSECOND),
];

/// The names of the pose's columns.
const POSE: [Names; 7] = [
    &["x", "tx", "position_x"],
    &["y", "ty", "position_y"],
    &["z", "tz", "position_z"],
    &["qx"],
    &["qy"],
    &["qz"],
    &["qw"],
];

/// Reads CSV with commas and a header, which names the columns `time`, `x`, `y`, `z`, `qx`, `qy`,
/// `qz` and `qw` in any order, in small or capital letters. `path` is what errors call the text.
///
/// The time may also be `t` or `timestamp`. It is in seconds, unless the name ends in `_ms`, `_us`
/// or `_ns`. The position may also be `tx`, `ty`, `tz` or `position_x` and so on. Other columns are
/// passed over, and so are lines that start with `#`.
///
/// # Errors
///
/// The errors of [`TrajectoryFormat::read`](super::TrajectoryFormat::read).
pub fn read_csv(text: &[u8], path: &Path) -> Result<Trajectory> {
    read_table(text, path, |header| {
        let found = header.find(&TIMES.map(|(name, _)| name))?;
        let Some((time, (_, unit))) =
            found.and_then(|(column, which)| Some((column, *TIMES.get(which)?)))
        else {
            return Err(header.missing(&["time", "t", "timestamp"]));
        };
        Ok(Columns { time, unit, pose: header.pose(POSE)? })
    })
}
