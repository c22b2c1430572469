//! The points of a PLY, in text or binary of either byte order.

use super::super::super::metadata::KEY;
use super::rows::Order;
use super::{Header, Type, next_line, unknown};
use crate::image::Output;

/// A point cloud, and nothing more.
pub(in crate::image) fn ply(bytes: &[u8], most: u64) -> Result<Output, String> {
    read(bytes, most, false)
}

/// The points of a cloud, or the vertices of a mesh.
pub(in crate::image) fn vertices(bytes: &[u8], most: u64) -> Result<Output, String> {
    read(bytes, most, true)
}

fn read(bytes: &[u8], most: u64, takes_meshes: bool) -> Result<Output, String> {
    let mut header = Header::default();
    let mut order = Order::Text;
    let mut rest = bytes;
    let mut is_first = true;
    let mut others: Vec<String> = Vec::new();
    loop {
        let line = next_line(&mut rest)?;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            ["ply"] if is_first => {}
            _ if is_first => return Err("not a PLY".to_owned()),
            ["format", "ascii", "1.0"] => order = Order::Text,
            ["format", "binary_little_endian", "1.0"] => order = Order::Little,
            ["format", "binary_big_endian", "1.0"] => order = Order::Big,
            ["comment", KEY, ..] => header.comment(line, "comment"),
            ["comment" | "obj_info", ..] | [] => {}
            ["element", "vertex", count] if header.count.is_none() => header.set_count(count)?,
            ["element", name, count] if takes_meshes && header.count.is_some() => {
                others.push(format!("{count} of the element {name}"));
            }
            ["element", ..] if takes_meshes => {
                return Err("has another element before its points".to_owned());
            }
            ["element", ..] => return Err("more than points: a mesh, not a point cloud".to_owned()),
            ["property", ..] if !others.is_empty() => {}
            ["property", kind, name] if header.count.is_some() => {
                let kind = Type::of_ply(kind).ok_or_else(|| unknown(kind))?;
                header.columns.push((name.to_owned(), kind));
            }
            ["end_header"] => {
                let mut output = header.read(rest, order, most)?;
                if !others.is_empty() {
                    // The bytes after the points are theirs.
                    output.notes.retain(|note| !note.contains("bytes after"));
                    others.retain(|other| !other.starts_with("0 "));
                }
                let unread = others.iter().map(|other| {
                    let other = crate::error::escape_controls(other);
                    format!("{other} are not read: the points are the vertices")
                });
                output.notes.extend(unread);
                return Ok(output);
            }
            _ => return Err(unknown(line)),
        }
        is_first = false;
    }
}
