//! Point clouds as binary PCD, version 0.7, for PCL and ROS: floats are float32, but times and far
//! positions are float64; a colour is one number.

use std::io::{self, Write};

use super::content::Content;
use super::points::{Layout, Type, comments, points, write_rows};

/// All that comes before the metadata's own words.
pub(super) const MARK: &str = "# .PCD v0.7 - Point Cloud Data file format\n# ";

pub(super) const LAYOUT: Layout = Layout {
    normal: ["normal_x", "normal_y", "normal_z"],
    has_doubles: false,
    has_packed_colors: true,
};

/// Writes a header in text, then the points, as a cloud of one row.
pub(super) fn encode(content: &Content<'_>, out: &mut dyn Write) -> io::Result<()> {
    let comments = comments(content, "#");
    let comments = comments.strip_prefix("# ").unwrap_or_default();
    let mut lines = ["FIELDS", "SIZE", "TYPE", "COUNT"].map(str::to_owned);
    let columns = LAYOUT.columns(content);
    for &(channel, of_columns) in &columns {
        for name in LAYOUT.names(channel) {
            let (size, kind) = match of_columns {
                Type::Float64 => (8, 'F'),
                // PCL's own type of points keeps the bytes of `rgb` in a float, those of `rgba` in
                // a whole number.
                Type::Packed if name == "rgba" => (4, 'U'),
                Type::Float32 | Type::Packed => (4, 'F'),
                Type::Int32 => (4, 'I'),
                Type::Byte => (1, 'U'),
            };
            let words = [name, size.to_string(), kind.to_string(), "1".to_owned()];
            for (line, word) in lines.iter_mut().zip(words) {
                line.push(' ');
                line.push_str(&word);
            }
        }
    }
    let count = points(content).count();
    write!(out, "{MARK}{comments}VERSION 0.7\n{}\n", lines.join("\n"))?;
    write!(out, "WIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n")?;
    write_rows(content, &columns, out)
}
