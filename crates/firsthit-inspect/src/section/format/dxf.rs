//! DXF of release 12, which all programs read: a POLYLINE for each curve, on a layer for each
//! object.

use std::io::{self, Write};

use crate::section::Section;

pub(super) fn write(section: &Section, out: &mut dyn Write) -> io::Result<()> {
    pairs(out, &[(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"), (0, "ENDSEC")])?;
    pairs(out, &[(0, "SECTION"), (2, "ENTITIES")])?;
    for polyline in section.polylines() {
        let layer = format!("object-{}", polyline.object);
        let closed = if polyline.is_closed { "1" } else { "0" };
        // 66: vertices follow. 10, 20, 30: nothing but the height of all, which is zero.
        pairs(out, &[(0, "POLYLINE"), (8, &layer), (66, "1"), (70, closed)])?;
        pairs(out, &[(10, "0.0"), (20, "0.0"), (30, "0.0")])?;
        for point in section.in_plane(&polyline) {
            let [x, y] = point.to_array().map(|x| format!("{x:?}"));
            pairs(out, &[(0, "VERTEX"), (8, &layer)])?;
            pairs(out, &[(10, &x), (20, &y), (30, "0.0")])?;
        }
        pairs(out, &[(0, "SEQEND"), (8, &layer)])?;
    }
    pairs(out, &[(0, "ENDSEC"), (0, "EOF")])
}

/// Writes group codes with their values.
fn pairs(out: &mut dyn Write, pairs: &[(u32, &str)]) -> io::Result<()> {
    let mut pairs = pairs.iter();
    pairs.try_for_each(|(code, value)| writeln!(out, "{code:>3}\n{value}"))
}
