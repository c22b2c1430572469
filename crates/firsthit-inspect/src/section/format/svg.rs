//! SVG: a path of each object's closed polylines, filled by the even-odd rule, and one of its open
//! polylines.

use std::io::{self, Write};

use crate::geometry::DVec2;
use crate::section::Section;

pub(super) fn write(section: &Section, out: &mut dyn Write) -> io::Result<()> {
    let (low, size) = view(section);
    // SVG's y goes down.
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:?}mm\" height=\"{:?}mm\" viewBox=\"{:?} {:?} {:?} {:?}\">",
        size.x, size.y, low.x, low.y, size.x, size.y
    )?;
    writeln!(out, "<g stroke=\"black\" stroke-linejoin=\"round\" fill-rule=\"evenodd\">")?;
    let mut polylines = section.polylines().peekable();
    while let Some(first) = polylines.peek() {
        let object = first.object;
        let (mut closed, mut open) = (Vec::new(), Vec::new());
        while let Some(polyline) = polylines.next_if(|polyline| polyline.object == object) {
            if polyline.is_closed {
                closed.push(polyline);
            } else {
                open.push(polyline);
            }
        }
        for (these, fill, end) in [(closed, "#dddddd", "Z"), (open, "none", "")] {
            if these.is_empty() {
                continue;
            }
            write!(
                out,
                "<path class=\"object-{object}\" fill=\"{fill}\" vector-effect=\"non-scaling-stroke\" d=\""
            )?;
            for polyline in &these {
                for (k, point) in section.in_plane(polyline).enumerate() {
                    let command = if k == 0 { 'M' } else { 'L' };
                    write!(out, "{command}{:?} {:?}", point.x, 0.0 - point.y)?;
                }
                write!(out, "{end}")?;
            }
            writeln!(out, "\"/>")?;
        }
    }
    writeln!(out, "</g>\n</svg>")
}

/// The corner and the size of what is seen: all points and a margin. No side is zero.
fn view(section: &Section) -> (DVec2, DVec2) {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for polyline in section.polylines() {
        for point in section.in_plane(&polyline) {
            let point = DVec2::new(point.x, -point.y);
            (low, high) = (low.min(point), high.max(point));
        }
    }
    if section.is_empty() {
        return (DVec2::ZERO, DVec2::ONE);
    }
    let margin = match 0.02 * (high - low).max_element() {
        0.0 => 0.5,
        margin => margin,
    };
    (low - margin, high - low + 2.0 * margin)
}
