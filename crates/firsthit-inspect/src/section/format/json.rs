//! JSON: the plane's frame, totals, and a polyline on each line.

use std::io::{self, Write};

use serde_json::{Value, json};

use crate::geometry::DVec3;
use crate::section::{Polyline, Section};

pub(super) fn write(section: &Section, out: &mut dyn Write) -> io::Result<()> {
    let plane = section.plane();
    let vector = |v: DVec3| json!(v.to_array());
    writeln!(out, "{{")?;
    for (key, value) in [
        ("origin", vector(plane.origin())),
        ("normal", vector(plane.normal())),
        ("u", vector(plane.u())),
        ("v", vector(plane.v())),
        ("area", json!(section.area())),
        ("perimeter", json!(section.perimeter())),
        ("left_out", json!(section.left_out())),
        ("warnings", json!(section.warnings())),
    ] {
        writeln!(out, "  \"{key}\": {value},")?;
    }
    write!(out, "  \"polylines\": [")?;
    for (k, polyline) in section.polylines().enumerate() {
        let comma = if k == 0 { "" } else { "," };
        write!(out, "{comma}\n    {}", one(section, &polyline))?;
    }
    let end = if section.is_empty() { "" } else { "\n  " };
    writeln!(out, "{end}]\n}}")
}

fn one(section: &Section, polyline: &Polyline<'_>) -> Value {
    let points: Vec<[f64; 3]> = polyline.points.iter().map(DVec3::to_array).collect();
    let in_plane: Vec<[f64; 2]> = (section.in_plane(polyline)).map(|p| p.to_array()).collect();
    json!({
        "object": polyline.object,
        "is_closed": polyline.is_closed,
        "area": polyline.area(section.plane()),
        "length": polyline.length(),
        "points": points,
        "points_2d": in_plane,
        "primitives": polyline.primitives,
    })
}
