use std::io::{self, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::content::Content;
use super::npy;

/// The size from which on an entry needs ZIP64, with some room for its header.
const LARGE: u64 = u32::MAX as u64 - 65_536;

/// The entry that holds the metadata: a text, in an array without dimensions.
pub(super) const METADATA: &str = "metadata";

/// Writes all channels as an NPZ archive: an entry `NAME.npy` for each, packed where the settings
/// say so, in their order, and then the metadata, packed.
///
/// As a stream, so that a pipe will do. All dates are 1 January 1980, the earliest that ZIP can
/// say: today's would change the bytes every day.
pub(super) fn encode(content: &Content<'_>, out: &mut dyn Write) -> io::Result<()> {
    let mut archive = ZipWriter::new_stream(out);
    let method = if content.settings.compress {
        CompressionMethod::Deflated
    } else {
        CompressionMethod::Stored
    };
    let options = SimpleFileOptions::default()
        .compression_method(method)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    for channel in &content.channels {
        let large = channel.data.len() as u64 * 8 > LARGE;
        archive.start_file(format!("{}.npy", channel.name), options.large_file(large))?;
        npy::encode(content.shape, channel, &mut archive)?;
    }
    // The names of a thousand objects, in UTF-32, would be more than a few hits.
    let packed = options.compression_method(CompressionMethod::Deflated);
    archive.start_file(format!("{METADATA}.npy"), packed)?;
    npy::encode_text(&content.metadata.to_json(), &mut archive)?;
    archive.finish()?.into_inner().flush()
}
