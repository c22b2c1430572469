//! Describes an output by its metadata.

use firsthit::error::escape_controls;
use firsthit::image::{
    Array, CameraRecord, ChannelRecord, Format, Metadata, Output, SensorRecord, Stored, read,
};
use serde_json::{Value, json};

use super::listing::{listed, most_listed};
use crate::args::InfoArgs;
use crate::console::{json_text, warn};
use crate::failure::Failure;
use crate::hints::{coordinate, number, place, triple};

/// The report as text or as JSON, with a line break at the end.
pub(super) fn text(args: &InfoArgs, format: &Format) -> Result<String, Failure> {
    let path = args.file.as_path();
    let output = read(path)?;
    let most = most_listed(args);
    if args.json {
        return Ok(json_text(&json(&output, format, most)) + "\n");
    }
    let notes = output.notes.iter();
    let notes = notes.map(|note| format!("{}: {note}", firsthit::error::escaped(path)));
    warn(&notes.collect::<Vec<_>>());
    let mut lines = vec![format!("format         {}", format.name)];
    if let Some(metadata) = &output.metadata {
        describe(metadata, most, &mut lines);
    } else {
        lines.push("metadata       none: not written by firsthit, or lost since".to_owned());
        lines.push(format!("channels       {}", output.arrays.len()));
        lines.extend(listed(most, "  ", output.arrays.iter().map(unknown)));
    }
    Ok(lines.join("\n") + "\n")
}

fn json(output: &Output, format: &Format, most: usize) -> Value {
    let array = |array: &Array| {
        json!({
            "name": array.name,
            "shape": array.shape,
            "dtype": array.dtype,
        })
    };
    json!({
        "format": format.name,
        "arrays": output.arrays.iter().take(most).map(array).collect::<Vec<_>>(),
        "counts": { "arrays": output.arrays.len() },
        "metadata": output.metadata,
        "notes": output.notes,
    })
}

/// A channel of a file that says nothing of itself.
fn unknown(array: &Array) -> String {
    let name = array.name.as_deref().unwrap_or("(no name)");
    let sides: Vec<String> = array.shape.iter().map(ToString::to_string).collect();
    let what = if array.is_picture { ", to look at" } else { "" };
    format!(
        "{}  {} of {}{what}",
        escape_controls(name),
        sides.join(" x "),
        escape_controls(&array.dtype)
    )
}

/// All strings are from a file: none of them reaches the terminal as it is.
pub(super) fn describe(metadata: &Metadata, most: usize, lines: &mut Vec<String>) {
    let mut say = |name: &str, text: String| {
        lines.push(format!("{name:<14} {}", escape_controls(&text)));
    };
    say("firsthit", metadata.firsthit.clone());
    if let Some(scene) = &metadata.scene {
        say("scene", scene.clone());
    }
    match (metadata.shape.as_slice(), &metadata.pixels) {
        ([rows, columns], Some(pixels)) => {
            let [x, y] = pixels.first_center;
            say(
                "picture",
                format!(
                    "{columns} x {rows} pixels; row 0 is the {}, column 0 the {} one, its pixel's centre at ({x}, {y})",
                    pixels.row_0, pixels.column_0
                ),
            );
        }
        (shape, _) => say("shape", format!("{shape:?}")),
    }
    if let Some(camera) = &metadata.camera {
        describe_camera(camera, &mut say);
    }
    if let Some(sensor) = &metadata.sensor {
        describe_sensor(sensor, &mut say);
    }
    if let Some(Value::Object(settings)) = &metadata.scan {
        let settings = settings.iter().filter(|(_, value)| !value.is_null());
        let settings = settings.map(|(name, value)| format!("{name} {}", setting(value)));
        say("scan", settings.collect::<Vec<_>>().join(", "));
    }
    if let Some(Value::Array(scans)) = &metadata.scans {
        say("scans", format!("{} put together", scans.len()));
    }
    if let Some(samples) = metadata.samples {
        say("samples", format!("{samples} for each pixel's colour"));
    }
    say("channels", metadata.channels.len().to_string());
    let channels = metadata.channels.iter().map(channel);
    let channels = channels.map(|line| escape_controls(&line));
    lines.extend(listed(most, "  ", channels));
    let names = metadata.names.as_ref();
    let left_out = names.iter().flat_map(|names| &names.left_out);
    let left_out: Vec<String> =
        left_out.map(|(of, count)| format!("{count} of {}", escape_controls(of))).collect();
    if !left_out.is_empty() {
        let what = left_out.join(", ");
        lines.push(format!("names          without {what}: there is room for 256 KiB"));
    }
}

/// A setting of a scan: words without quotes, numbers as they are written elsewhere.
fn setting(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        Value::Array(values) => values.iter().map(setting).collect::<Vec<_>>().join(" "),
        Value::Number(given) => given.as_f64().map_or_else(|| value.to_string(), number),
        _ => value.to_string(),
    }
}

fn describe_sensor(sensor: &SensorRecord, say: &mut impl FnMut(&str, String)) {
    let (columns, rows) = (sensor.columns, sensor.rows);
    say("sensor", format!("{}, {columns} x {rows} rays", sensor.kind));
    for (name, word) in &sensor.words {
        say(&format!("  {name}"), word.clone());
    }
    for (name, &value) in &sensor.parameters {
        say(&format!("  {name}"), number(value));
    }
    if let Some(body) = &sensor.trajectory {
        let [start, end] = [body.start, body.end].map(|time| coordinate(time, EXTENT));
        let poses = body.poses;
        let between = &body.interpolation;
        say("  trajectory", format!("{poses} poses from {start} to {end} s, {between}"));
    }
}

/// Parameters of lenses that the viewplane and K tell.
const TOLD: [&str; 8] = ["focal_length", "width", "height", "fx", "fy", "cx", "cy", "skew"];

/// The extent of a scene that is not here, and the length of a drive, where neither is known.
const EXTENT: f64 = 1000.0;

fn describe_camera(camera: &CameraRecord, say: &mut impl FnMut(&str, String)) {
    let triple = |v: [f64; 3]| triple(v.into());
    let row = |row: &[f64]| {
        let row: Vec<String> = row.iter().map(|&x| coordinate(x, EXTENT)).collect();
        format!("[{}]", row.join(", "))
    };
    let matrix = |rows: Vec<String>| format!("[{}]", rows.join(", "));
    say("camera", format!("{}, rays start at the {}", camera.projection, camera.ray_start));
    say("  position", place(camera.position.into(), EXTENT));
    say("  aim", triple(camera.aim));
    say("  up", triple(camera.up));
    if let Some(focal_length) = camera.focal_length {
        say("  focal_length", number(focal_length));
    }
    if let (Some(width), Some(height)) = (camera.width, camera.height) {
        say("  viewplane", format!("{}x{}", number(width), number(height)));
    }
    if let Some(intrinsics) = &camera.intrinsics {
        let center = intrinsics.first_pixel_center;
        say(
            "  K",
            format!(
                "{} (camera axes {}; the first pixel's centre is at {center})",
                matrix(intrinsics.k.iter().map(|k| row(k)).collect()),
                intrinsics.axes
            ),
        );
    }
    // Those that are zero change nothing.
    let parameters = camera.parameters.iter();
    let own = parameters.filter(|(name, value)| **value != 0.0 && !TOLD.contains(&name.as_str()));
    let own: Vec<String> = own.map(|(name, &x)| format!("{name} {}", number(x))).collect();
    if !own.is_empty() {
        say("  lens", own.join(", "));
    }
    say(
        "  pose",
        format!(
            "{} (world from camera, axes {})",
            matrix((camera.pose.world_from_camera.iter()).map(|r| row(r)).collect()),
            camera.pose.axes
        ),
    );
}

fn channel(channel: &ChannelRecord) -> String {
    let components = (channel.components > 1).then(|| format!(" x {}", channel.components));
    let details = [
        channel.unit.as_ref().map(|unit| format!(", in {unit}")),
        channel.frame.as_ref().map(|frame| format!(", {frame} frame")),
        Some(format!(", a miss is {}", channel.miss)),
        channel.stored.as_ref().map(|own| format!(", {}", stored(own))),
    ];
    let rest: String = components.into_iter().chain(details.into_iter().flatten()).collect();
    format!("{}  {}{rest}", channel.name, channel.dtype)
}

fn stored(stored: &Stored) -> String {
    let Stored { names, dtype, encoding, miss, scale, far, legend, exposure, tone_map } = stored;
    let names = names.join(" ");
    let meaning = match scale {
        Some(scale) => format!("steps of {scale}"),
        None => encoding.name().to_owned(),
    };
    let far = (far.as_ref()).map_or_else(String::new, |far| format!(", what is beyond is {far}"));
    let exposure = exposure.map_or_else(String::new, |stops| format!(", exposure {stops}"));
    let tone_map = (tone_map.as_ref()).map_or_else(String::new, |map| format!(", tone map {map}"));
    let legend = legend.as_ref().map(|legend| format!(": {legend}")).unwrap_or_default();
    format!(
        "stored as {names} ({dtype}, {meaning}{far}{exposure}{tone_map}, a miss is {miss}){legend}"
    )
}
