use std::io::{self, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::{Channel, npy};

/// From here on an entry needs ZIP64, with some room for its header.
const LARGE: u64 = u32::MAX as u64 - 65_536;

/// Writes all channels as an NPZ archive: an entry `NAME.npy` for each, uncompressed, in their order.
///
/// As a stream, so that a pipe will do. All dates are 1 January 1980, the earliest that ZIP can say:
/// today's would change the bytes every day.
pub(super) fn encode(
    shape: &[usize],
    channels: &[&Channel],
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut archive = ZipWriter::new_stream(out);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    for channel in channels {
        let large = channel.data.len() as u64 * 8 > LARGE;
        archive.start_file(format!("{}.npy", channel.name), options.large_file(large))?;
        npy::encode(shape, channel, &mut archive)?;
    }
    archive.finish()?.into_inner().flush()
}
