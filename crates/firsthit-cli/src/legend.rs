//! `--legend`: which colour of a picture of objects is which object.

use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;

use firsthit::error::escaped;
use firsthit::image::{color_of_identifier, write_whole};
use firsthit::{Object, Scene};
use serde_json::json;

use crate::console::json_text;
use crate::failure::Failure;
use crate::output::{self, Order};
use crate::progress::Progress;

/// The identifier of a miss.
const MISS: i32 = -1;

/// A line of the table.
pub(crate) struct Row<'a> {
    object: i32,
    name: &'a str,
    /// The colour in the picture: sRGB, `#rrggbb`.
    color: String,
    pixels: u64,
}

/// Refuses a table without a picture, and one that would overwrite another file of the run.
pub(crate) fn check(path: &Path, orders: &[Order]) -> Result<(), Failure> {
    if !is_json(path) && !has_extension(path, "csv") {
        return Err(Failure::usage(format!(
            "--legend: {} must end in .csv or .json",
            escaped(path)
        )));
    }
    let mut kinds = orders.iter().flat_map(|order| &order.kinds);
    if !kinds.any(|kind| kind.name == "object") {
        return Err(Failure::usage(
            "--legend is of a picture of objects: it needs object among the --channels",
        ));
    }
    output::check_other(path, orders)
}

/// Writes the table.
pub(crate) fn write(path: &Path, rows: &[Row<'_>], progress: &Progress) -> Result<(), Failure> {
    write_whole(path, progress, |out| {
        if is_json(path) { write_json(rows, out) } else { write_csv(rows, out) }
    })?;
    Ok(())
}

fn is_json(path: &Path) -> bool {
    has_extension(path, "json")
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    let extension = path.extension().unwrap_or_default();
    extension.eq_ignore_ascii_case(wanted)
}

/// The table of the objects that pixels show: misses, then all objects in the order of their
/// numbers, seen or not.
pub(crate) fn rows<'a>(scene: &'a Scene, seen: &[i32]) -> Vec<Row<'a>> {
    let objects = scene.objects();
    let mut misses = 0;
    let mut pixels = vec![0; objects.len()];
    for &object in seen {
        let count = usize::try_from(object).map(|object| pixels.get_mut(object));
        *count.ok().flatten().unwrap_or(&mut misses) += 1;
    }
    let row = |object: i32, name, pixels| {
        let [red, green, blue] = color_of_identifier(object);
        Row { object, name, color: format!("#{red:02x}{green:02x}{blue:02x}"), pixels }
    };
    let names = objects.iter().map(Object::name).zip(pixels);
    let objects = (0..).zip(names);
    let objects = objects.map(|(object, (name, pixels))| row(object, name, pixels));
    std::iter::once(row(MISS, "", misses)).chain(objects).collect()
}

/// A name as spreadsheets take it for text: one that begins like a formula gets an apostrophe, so
/// that a file's names compute nothing.
fn as_text(name: &str) -> Cow<'_, str> {
    if name.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        format!("'{name}").into()
    } else {
        name.into()
    }
}

fn write_csv(rows: &[Row<'_>], out: &mut dyn Write) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(["object", "name", "color", "pixels"])?;
    for row in rows {
        let (object, pixels) = (row.object.to_string(), row.pixels.to_string());
        writer.write_record([
            object.as_str(),
            &*as_text(row.name),
            row.color.as_str(),
            pixels.as_str(),
        ])?;
    }
    writer.flush()
}

fn write_json(rows: &[Row<'_>], out: &mut dyn Write) -> io::Result<()> {
    let row = |row: &Row<'_>| {
        json!({
            "object": row.object,
            "name": row.name,
            "color": row.color,
            "pixels": row.pixels,
        })
    };
    let table: Vec<_> = rows.iter().map(row).collect();
    writeln!(out, "{}", json_text(&json!(table)))
}
