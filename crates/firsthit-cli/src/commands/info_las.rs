//! A LAS or LAZ file's own account: its header, and the metadata of a cloud that firsthit wrote.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use firsthit::error::{escape_controls, escaped};
use firsthit::image::Metadata;
use serde_json::json;

use super::info_output::describe;
use super::listing::{listed, most_listed};
use crate::args::InfoArgs;
use crate::console::{json_text, warn};
use crate::failure::Failure;
use crate::hints::{span, triple};

/// Metadata are short; a record that is longer is none.
const LONGEST: u64 = 1 << 24;

pub(super) fn is_las(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    ["las", "laz"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// The report as text or as JSON, with a line break at the end.
pub(super) fn text(args: &InfoArgs) -> Result<String, Failure> {
    let path = args.file.as_path();
    let wrong = |what: &str| Failure::bad_input(format!("{}: {what}", escaped(path)));
    let is_regular = path.metadata().map(|metadata| metadata.is_file());
    if !is_regular.map_err(|error| wrong(&error.to_string()))? {
        return Err(wrong("not a regular file"));
    }
    let file = File::open(path).map_err(|error| wrong(&error.to_string()))?;
    let las = Las::read(file).map_err(|what| wrong(&what))?;
    let most = most_listed(args);
    if args.json {
        let document = json!({
            "format": las.format(),
            "points": las.points,
            "bounds": [las.low, las.high],
            "arrays": las.columns.iter().take(most).collect::<Vec<_>>(),
            "counts": { "arrays": las.columns.len() },
            "metadata": las.metadata,
            "notes": las.notes,
        });
        return Ok(json_text(&document) + "\n");
    }
    let notes = las.notes.iter().map(|note| format!("{}: {note}", escaped(path)));
    warn(&notes.collect::<Vec<_>>());
    let mut lines =
        vec![format!("format         {}", las.format()), format!("points         {}", las.points)];
    if las.points > 0 {
        let (low, high) = (las.low.into(), las.high.into());
        lines.push(format!("bounds         {}", span(firsthit::Bounds { low, high })));
        lines.push(format!("step           {}", triple(las.step.into())));
    }
    lines.push(format!("extra          {}", las.columns.len()));
    lines.extend(listed(most, "  ", las.columns.iter().map(|name| escape_controls(name))));
    match &las.metadata {
        Some(metadata) => describe(metadata, most, &mut lines),
        None => {
            lines.push("metadata       none: not written by firsthit, or lost since".to_owned());
        }
    }
    Ok(lines.join("\n") + "\n")
}

#[derive(Default)]
struct Las {
    version: [u8; 2],
    point_format: u8,
    points: u64,
    step: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
    /// Numbers of points beside those of their format.
    columns: Vec<String>,
    metadata: Option<Metadata>,
    notes: Vec<String>,
}

impl Las {
    fn format(&self) -> String {
        let [major, minor] = self.version;
        // The upper bits say that LASzip packed it.
        let packed = if self.point_format >= 64 { "LAZ" } else { "LAS" };
        format!("{packed} {major}.{minor}, points of format {}", self.point_format & 63)
    }

    fn read(mut file: impl Read + Seek) -> Result<Self, String> {
        let mut header = Vec::new();
        let read = file.by_ref().take(375).read_to_end(&mut header);
        read.map_err(|error| error.to_string())?;
        let header = Bytes(&header);
        if !header.0.starts_with(b"LASF") {
            return Err("not a LAS file: it must begin with LASF".to_owned());
        }
        let cut = || "truncated: the header ends early".to_owned();
        let axes = |start: usize, step: usize| -> Option<[f64; 3]> {
            Some([
                header.float(start)?,
                header.float(start + step)?,
                header.float(start + 2 * step)?,
            ])
        };
        let versions = header.array::<2>(24).ok_or_else(cut)?;
        let is_long = versions >= [1, 4];
        let points = if is_long {
            header.array(247).map(u64::from_le_bytes)
        } else {
            header.array(107).map(|count| u32::from_le_bytes(count).into())
        };
        let mut las = Self {
            version: versions,
            point_format: header.array::<1>(104).ok_or_else(cut)?[0],
            points: points.ok_or_else(cut)?,
            step: axes(131, 8).ok_or_else(cut)?,
            high: axes(179, 16).ok_or_else(cut)?,
            low: axes(187, 16).ok_or_else(cut)?,
            ..Self::default()
        };
        let size = header.array(94).map(u16::from_le_bytes).ok_or_else(cut)?;
        let count = header.array(100).map(u32::from_le_bytes).ok_or_else(cut)?;
        las.records(&mut file, size.into(), count, 54);
        if is_long {
            let start = header.array(235).map(u64::from_le_bytes).ok_or_else(cut)?;
            let count = header.array(243).map(u32::from_le_bytes).ok_or_else(cut)?;
            las.records(&mut file, start, count, 60);
        }
        Ok(las)
    }

    /// Reads the records from a place on, whose headers have `size` bytes. Records that cannot be
    /// read become a note.
    fn records(&mut self, file: &mut (impl Read + Seek), start: u64, count: u32, size: usize) {
        if count == 0 {
            return;
        }
        if file.seek(SeekFrom::Start(start)).is_err() {
            return;
        }
        for _ in 0..count {
            let mut header = vec![0; size];
            if file.read_exact(&mut header).is_err() {
                self.notes.push("its records end early".to_owned());
                return;
            }
            let header = Bytes(&header);
            let length = if size == 54 {
                header.array(20).map_or(0, |length| u16::from_le_bytes(length).into())
            } else {
                header.array(20).map_or(0, u64::from_le_bytes)
            };
            let number = header.array(18).map_or(0, u16::from_le_bytes);
            let owner = header.word(2, 16);
            let is_ours = owner == "firsthit" && number == 1;
            let is_extra = owner == "LASF_Spec" && number == 4;
            if !(is_ours || is_extra) || length > LONGEST {
                let Ok(length) = i64::try_from(length) else {
                    return;
                };
                if file.seek(SeekFrom::Current(length)).is_err() {
                    return;
                }
                continue;
            }
            let mut content = Vec::new();
            if file.by_ref().take(length).read_to_end(&mut content).is_err() {
                return;
            }
            if is_extra {
                let (extras, _) = content.as_chunks::<192>();
                self.columns.extend(extras.iter().map(|extra| Bytes(extra).word(4, 32)));
            } else {
                match Metadata::from_json(&String::from_utf8_lossy(&content)) {
                    Ok(metadata) => self.metadata = Some(metadata),
                    Err(what) => self.notes.push(escape_controls(&what)),
                }
            }
        }
    }
}

struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn array<const N: usize>(&self, start: usize) -> Option<[u8; N]> {
        self.0.get(start..)?.first_chunk().copied()
    }

    fn float(&self, start: usize) -> Option<f64> {
        self.array(start).map(f64::from_le_bytes)
    }

    /// A text that ends with a zero.
    fn word(&self, start: usize, length: usize) -> String {
        let bytes = self.0.get(start..start + length).unwrap_or_default();
        let end = bytes.iter().position(|&byte| byte == 0);
        String::from_utf8_lossy(&bytes[..end.unwrap_or(bytes.len())]).into_owned()
    }
}
