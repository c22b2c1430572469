//! Answers lines of rays as they come, for a program that waits for each answer.

use std::io::{self, Write};

use firsthit::channel::ChannelKind;
use firsthit::image::Frame;
use firsthit::watch::Watch as _;
use firsthit::{Rays as _, Scene};
use rayon::prelude::*;

use super::shot::{Counts, shot};
use crate::failure::Failure;
use crate::hits_csv::{write_header, write_rows};
use crate::progress::Progress;
use crate::rays::{Feed, RayLines};

/// The number of lines that a thread formats at a time.
const ROWS: usize = 1 << 12;

/// Answers the lines of `feed` on standard output. All lines that have arrived are shot together,
/// and their answers are flushed before it waits for more.
pub(super) fn answer(
    feed: &Feed,
    mut lines: RayLines,
    (scene, kinds): (&Scene, &[&ChannelKind]),
    progress: &Progress,
) -> Result<Counts, Failure> {
    let is_stopped = || progress.is_stopped();
    let mut out = io::stdout().lock();
    let mut counts = Counts::default();
    let mut has_header = false;
    loop {
        let text = feed.lines(&is_stopped)?;
        let (rays, read) = lines.read(text.as_deref().unwrap_or_default());
        let is_answer = !rays.is_empty() || (text.is_none() && read.is_ok() && !has_header);
        if is_answer {
            let (frame, more) = shot(scene, &rays, kinds, progress)?;
            let written = write(&frame, !has_header, &mut out);
            written.map_err(|error| Failure::stdout(&error))?;
            has_header = true;
            counts += more;
        }
        read?;
        if text.is_none() {
            return Ok(counts);
        }
    }
}

fn write(frame: &Frame, with_header: bool, out: &mut dyn Write) -> io::Result<()> {
    let count: usize = frame.shape().iter().product();
    if with_header {
        write_header(frame, out)?;
    }
    let pieces: Vec<io::Result<Vec<u8>>> = (0..count.div_ceil(ROWS))
        .into_par_iter()
        .map(|piece| {
            let mut text = Vec::new();
            let rows = piece * ROWS..count.min((piece + 1) * ROWS);
            write_rows(frame, rows, &mut text).map(|()| text)
        })
        .collect();
    for piece in pieces {
        out.write_all(&piece?)?;
    }
    out.flush()
}
