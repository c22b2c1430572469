//! `EXT_meshopt_compression` and `KHR_meshopt_compression`: packed buffer views, after the
//! bitstreams that the extensions' texts specify. A decoder reads the whole stream or reports that
//! it ends early; nothing in a stream sizes an allocation.

mod attributes;
mod filters;
mod indices;
mod stream;
mod triangles;

use super::super::report::Report;
use super::document::Meshopt;
use super::problem::Problem;
use crate::error::escape_controls;
use stream::{Decoded, TRUNCATED};

/// Unpacks a number of elements of a size.
type Decode = fn(&[u8], usize, usize, &mut Vec<u8>) -> Decoded<()>;

/// The bytes that a packed view stands for.
pub(super) fn unpack(
    source: &[u8],
    packed: &Meshopt<'_>,
    report: &mut Report,
) -> Result<Vec<u8>, Problem> {
    let (count, stride) = (packed.count.0, packed.byte_stride.0);
    let filter = packed.filter.as_deref().unwrap_or("NONE");
    let size = count.checked_mul(stride).ok_or("count times byteStride is out of range")?;
    let mut bytes = Vec::new();
    let mut make_room = || -> Result<(), Problem> {
        // A stream can be far smaller than what it stands for, so the limit decides.
        report.budget.charge(size as u64, "a packed buffer view")?;
        let reserved = bytes.try_reserve_exact(size);
        reserved
            .map_err(|_| format!("{size} unpacked bytes are more than what memory is free").into())
    };
    match &*packed.mode {
        "ATTRIBUTES" => {
            if stride == 0 || !stride.is_multiple_of(4) || stride > 256 {
                return Err(format!("byteStride must be 4, 8, ... 256, got {stride}").into());
            }
            filters::check(filter, stride)?;
            attributes::check(source, count, stride)?;
            make_room()?;
            attributes::decode(source, count, stride, &mut bytes)?;
            filters::apply(filter, stride, &mut bytes);
        }
        mode @ ("TRIANGLES" | "INDICES") => {
            if stride != 2 && stride != 4 {
                return Err(format!("byteStride must be 2 or 4, got {stride}").into());
            }
            if filter != "NONE" {
                return Err(format!("mode {mode} takes no filter").into());
            }
            // Every triangle and every index takes a byte at least.
            let (least, decode): (usize, Decode) = match mode {
                "TRIANGLES" => (count / 3, triangles::decode),
                _ => (count, indices::decode),
            };
            if least > source.len() {
                return Err(TRUNCATED.into());
            }
            make_room()?;
            decode(source, count, stride, &mut bytes)?;
        }
        mode => {
            let mode = escape_controls(mode);
            return Err(format!("mode '{mode}' is not ATTRIBUTES, TRIANGLES or INDICES").into());
        }
    }
    Ok(bytes)
}
