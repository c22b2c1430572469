//! The files of a laser scanner's scan.

#[cfg(feature = "cloud")]
use std::io::{self, Write};
use std::path::Path;

use super::content::WriteSettings;
use super::format::format_of;
use super::frame::Frame;
#[cfg(feature = "cloud")]
use super::{file::write_whole, frame::Data, las, ply};
use crate::error::{Error, Result, escaped};
use crate::watch::Watch;

/// The extensions of the files that a scan is written to, without the dot.
pub const SCAN_EXTENSIONS: &[&str] = &[
    #[cfg(feature = "npy")]
    "npz",
    #[cfg(feature = "cloud")]
    "ply",
    #[cfg(feature = "cloud")]
    "pcd",
    #[cfg(feature = "cloud")]
    "las",
    #[cfg(feature = "cloud")]
    "laz",
    #[cfg(feature = "cloud")]
    "csv",
];

/// Writes the returns of a scan to a file, whole or not at all, in the format that the extension
/// names.
#[doc(hidden)]
pub fn write_scan(frame: &Frame, path: &Path, watch: &dyn Watch) -> Result<()> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match &*extension.to_string_lossy() {
        #[cfg(feature = "cloud")]
        known @ ("las" | "laz") => {
            let content = las::encode(frame, known == "laz")?;
            write_whole(path, watch, |out| out.write_all(&content))
        }
        #[cfg(feature = "cloud")]
        "csv" => write_whole(path, watch, |out| write_csv(frame, out)),
        known if SCAN_EXTENSIONS.contains(&known) => {
            format_of(path)?.write(frame, None, WriteSettings::default(), path, watch)
        }
        _ => {
            let known: Vec<String> =
                SCAN_EXTENSIONS.iter().map(|known| format!(".{known}")).collect();
            let expected = format!("a name that ends in one of {}", known.join(", "));
            Err(Error::argument("path", expected, escaped(path)))
        }
    }
}

/// Writes a line for each return, after one with the names of the columns; numbers have as many
/// digits as tell them apart.
#[cfg(feature = "cloud")]
fn write_csv(frame: &Frame, out: &mut dyn Write) -> io::Result<()> {
    let names = frame.channels().iter().flat_map(|channel| ply::LAYOUT.names(channel));
    writeln!(out, "{}", names.collect::<Vec<_>>().join(","))?;
    for row in 0..frame.shape().iter().product() {
        let mut separator = "";
        for channel in frame.channels() {
            for place in row * channel.components..(row + 1) * channel.components {
                match &channel.data {
                    Data::Int32(values) => write!(out, "{separator}{}", values[place])?,
                    data => write!(out, "{separator}{:?}", data.value(place))?,
                }
                separator = ",";
            }
        }
        writeln!(out)?;
    }
    Ok(())
}
