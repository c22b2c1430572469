//! Streams that are written to: what is waited for in steps, so that a watch can end it.

#[cfg(target_os = "linux")]
use std::fs;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;
use std::time::Duration;

use crate::watch::Watch;

/// The time that a stream is waited for before the watch is asked again.
const PATIENCE: Duration = Duration::from_millis(50);

/// A stream to append to. A FIFO is waited for in steps, here and where it is full: the system's
/// own wait ends for no watch.
#[cfg(target_os = "linux")]
pub(super) fn opened_stream(path: &Path, watch: &dyn Watch) -> io::Result<File> {
    use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
    let mut options = OpenOptions::new();
    options.append(true);
    if !fs::metadata(path)?.file_type().is_fifo() {
        return options.open(path);
    }
    options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits().cast_signed());
    let has_no_reader = rustix::io::Errno::NXIO.raw_os_error();
    loop {
        match options.open(path) {
            Err(error) if error.raw_os_error() == Some(has_no_reader) => {
                check_watch(watch)?;
                std::thread::sleep(PATIENCE);
            }
            opened => return opened,
        }
    }
}

#[cfg(not(target_os = "linux"))]
pub(super) fn opened_stream(path: &Path, _watch: &dyn Watch) -> io::Result<File> {
    OpenOptions::new().append(true).open(path)
}

/// Waits until a stream takes bytes, but not for long.
#[cfg(target_os = "linux")]
pub(super) fn wait_for_room(file: &File) {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let patience = Timespec { tv_sec: 0, tv_nsec: PATIENCE.subsec_nanos().into() };
    // The next write tells an error of the stream.
    let _ = poll(&mut [PollFd::new(file, PollFlags::OUT)], Some(&patience));
}

#[cfg(not(target_os = "linux"))]
pub(super) fn wait_for_room(_file: &File) {
    std::thread::sleep(PATIENCE);
}

/// Fails once the watch says stop. Not by `ErrorKind::Interrupted`, which means: try again.
pub(super) fn check_watch(watch: &dyn Watch) -> io::Result<()> {
    if watch.is_stopped() {
        return Err(io::Error::other("interrupted"));
    }
    Ok(())
}
