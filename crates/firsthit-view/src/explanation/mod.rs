//! The explanation of a ray, as text and as JSON.

mod objects;
mod surface;

use std::borrow::Cow;

use firsthit::error::escape_controls;
use firsthit::explain::{Behind, Candidate, Explanation, Pixel};
use firsthit::{Ray, RayFilter, Side, SurfaceId};
use serde_json::{Value, json};

use crate::words::counted;
use crate::words::{exact_number, number, place, triple};

/// The explanation as lines for people, with a newline at the end of each. With `all`, every object
/// has a line of its own.
pub fn text(explained: &Explanation<'_>, all: bool) -> String {
    let mut lines = Vec::new();
    if let Some(pixel) = &explained.pixel {
        let Pixel { row, column, rows, columns, .. } = pixel;
        lines.push(format!("pixel      {row},{column} (row, column) of {columns} x {rows}"));
    }
    lines.extend(ray_lines(explained));
    match &explained.hit {
        Some(hit) => lines.extend(surface::lines(explained, hit)),
        None => lines.push("hit        none".to_owned()),
    }
    lines.extend(behind_lines(explained));
    lines.extend(objects::lines(&explained.candidates, all));
    let lines = lines.iter().map(|line| escape_controls(line) + "\n");
    lines.collect()
}

/// The explanation for programs. It has every object.
pub fn json(explained: &Explanation<'_>) -> Value {
    let counts = explained.counts().into_iter();
    let counts = counts.map(|(reason, count)| (reason.name().to_owned(), json!(count)));
    json!({
        "pixel": explained.pixel.as_ref().map(pixel_json),
        "ray": ray_json(&explained.ray, &explained.filter),
        "fault": explained.fault,
        "hit": explained.hit.as_ref().map(surface::json),
        "behind": explained.behind.iter().map(behind_json).collect::<Vec<_>>(),
        "behind_count": explained.behind_count,
        "counts": counts.collect::<serde_json::Map<_, _>>(),
        "candidates": explained.candidates.iter().map(candidate_json).collect::<Vec<_>>(),
    })
}

/// The ray, and what it does not meet.
fn ray_lines(explained: &Explanation<'_>) -> Vec<String> {
    let Explanation { ray, filter, .. } = explained;
    let mut lines = vec![format!(
        "ray        from {} along {}, {} < t <= {}",
        place(ray.origin, explained.extent),
        triple(ray.direction),
        exact_number(ray.t_min),
        exact_number(ray.t_max),
    )];
    let mut passes = Vec::new();
    if filter.mask != u32::MAX {
        passes.push(format!("sees objects of the mask {:#x}", filter.mask));
    }
    if let Some(only) = filter.only {
        passes.push(format!("meets object {only} alone"));
    }
    if let Some(side) = filter.cull {
        passes.push(format!("passes through {}s", side.name()));
    }
    for surface in filter.skip.iter().flatten() {
        let SurfaceId { object, primitive } = surface;
        passes.push(format!("skips object {object}, primitive {primitive}"));
    }
    if let Some(departure) = &filter.departure {
        let SurfaceId { object, primitive } = departure.surface;
        passes.push(format!("leaves object {object}, primitive {primitive}"));
    }
    if !passes.is_empty() {
        lines.push(format!("           it {}", passes.join(", ")));
    }
    if let Some(fault) = explained.fault {
        lines.push(format!("           it meets nothing: {fault}"));
    }
    lines
}

/// The lines about the crossings behind the hit.
fn behind_lines(explained: &Explanation<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    for (k, place) in explained.behind.iter().enumerate() {
        let label = if k == 0 { "behind" } else { "" };
        let side = if place.is_front { "front" } else { "back" };
        let named = named(place.hit.object, place.name, place.shape);
        lines.push(format!(
            "{label:<10} t {}: {named}, {}, {side}",
            exact_number(place.hit.t),
            part(place.shape, place.hit.primitive),
        ));
    }
    let more = explained.behind_count - explained.behind.len();
    if more > 0 {
        lines.push(format!("           ... and {}", counted(more as u64, "crossing")));
    }
    lines
}

/// An object in words.
fn named(object: i32, name: &str, shape: &str) -> String {
    if name.is_empty() {
        format!("object {object} ({shape})")
    } else {
        format!("object {object} '{}' ({shape})", short(name))
    }
}

/// The longest name in a text, in characters.
const LONGEST_NAME: usize = 100;

/// The start of a name: some files have names too long to read.
fn short(name: &str) -> Cow<'_, str> {
    match name.char_indices().nth(LONGEST_NAME) {
        Some((end, _)) => Cow::Owned(format!("{}...", &name[..end])),
        None => Cow::Borrowed(name),
    }
}

/// A part of a shape in words.
fn part(shape: &str, primitive: i32) -> String {
    let noun = if shape == "mesh" { "triangle" } else { "primitive" };
    format!("{noun} {primitive}")
}

/// A list of numbers to six digits.
fn list(numbers: &[f64]) -> String {
    let numbers = numbers.iter().map(|&x| number(x));
    numbers.collect::<Vec<_>>().join(",")
}

fn pixel_json(pixel: &Pixel) -> Value {
    json!({
        "row": pixel.row,
        "column": pixel.column,
        "rows": pixel.rows,
        "columns": pixel.columns,
        "range": pixel.range,
        "z": pixel.z,
    })
}

fn ray_json(ray: &Ray, filter: &RayFilter) -> Value {
    let surface = |surface: SurfaceId| json!([surface.object, surface.primitive]);
    json!({
        "origin": ray.origin.to_array(),
        "direction": ray.direction.to_array(),
        "t_min": ray.t_min,
        "t_max": ray.t_max,
        "mask": filter.mask,
        "only": filter.only,
        "cull": filter.cull.map(Side::name),
        "skip": filter.skip.iter().flatten().copied().map(surface).collect::<Vec<_>>(),
        "leaves": filter.departure.map(|departure| surface(departure.surface)),
    })
}

fn behind_json(place: &Behind<'_>) -> Value {
    json!({
        "t": place.hit.t,
        "object": place.hit.object,
        "primitive": place.hit.primitive,
        "name": place.name,
        "shape": place.shape,
        "front": place.is_front,
    })
}

fn candidate_json(candidate: &Candidate<'_>) -> Value {
    json!({
        "object": candidate.object,
        "name": candidate.name,
        "shape": candidate.shape,
        "reason": candidate.reason.name(),
        "t": candidate.place.map(|place| place.t),
        "primitive": candidate.place.map(|place| place.primitive),
    })
}
