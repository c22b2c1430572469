//! Point clouds as binary PLY: float64 stays exact.

use std::io::{self, Write};

use super::content::Content;
use super::points::{Layout, Type, comments, points, write_rows};

/// All that comes before the metadata's own words.
pub(super) const MARK: &str = "ply\nformat binary_little_endian 1.0\ncomment ";

pub(super) const LAYOUT: Layout =
    Layout { normal: ["nx", "ny", "nz"], has_doubles: true, has_packed_colors: false };

/// Writes a header in text, then the points as the element `vertex`.
pub(super) fn encode(content: &Content<'_>, out: &mut dyn Write) -> io::Result<()> {
    let comments = comments(content, "comment");
    // The first of them has its mark already.
    let comments = comments.strip_prefix("comment ").unwrap_or_default();
    write!(out, "{MARK}{comments}")?;
    writeln!(out, "element vertex {}", points(content).count())?;
    let columns = LAYOUT.columns(content);
    for &(channel, of_columns) in &columns {
        let kind = match of_columns {
            Type::Float64 => "double",
            Type::Float32 => "float",
            Type::Int32 => "int",
            Type::Byte | Type::Packed => "uchar",
        };
        for name in LAYOUT.names(channel) {
            writeln!(out, "property {kind} {name}")?;
        }
    }
    writeln!(out, "end_header")?;
    write_rows(content, &columns, out)
}
