//! Faces that meet other faces of their mesh.
//!
//! A tree over the boxes of all faces gives the candidates. The face and a candidate are then
//! judged exactly ([`meet`]). A pair that one face has found, the other need not
//! find out again.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

use super::meeting::{Face, meet};
use super::report::FindingCollector;
use super::subject::{CHUNK, Subject};
use crate::accel::Bvh;
use crate::error::Result;
use crate::geometry::Bounds;
use crate::memory;
use crate::parallel;
use crate::watch::{Watch, stop_if_asked};

/// The memory of a face in bytes: its box's part of the tree while that is built, and one byte of
/// [`UNKNOWN`], [`CLEAN`] or [`MEETING`].
const TREE_BYTES: usize = 193;

/// A face is not judged yet, meets no other, or meets one. Two threads may judge one face, and come
/// to the same.
const UNKNOWN: u8 = 0;
const CLEAN: u8 = 1;
const MEETING: u8 = 2;

pub(super) fn check(
    subject: &Subject<'_>,
    found: &mut FindingCollector<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    let count = subject.len();
    let bytes = (count as usize).saturating_mul(TREE_BYTES);
    memory::check("the tree over the faces of a mesh", bytes)?;
    let bounds = |triangle: u32| {
        if subject.has_area[triangle as usize] {
            Bounds::of(subject.corners(triangle))
        } else {
            Bounds::EMPTY
        }
    };
    let tree = Bvh::build_watched(count, bounds, 0.0, watch)?;
    let known: Vec<AtomicU8> = (0..count).map(|_| AtomicU8::new(UNKNOWN)).collect();
    let chunks = 0..count.div_ceil(CHUNK_U32);
    let of_chunk = |chunk: u32| {
        let mut stack = Vec::new();
        for triangle in chunk * CHUNK_U32..count.min((chunk + 1).saturating_mul(CHUNK_U32)) {
            let of_face = &known[triangle as usize];
            if !subject.has_area[triangle as usize] || of_face.load(Relaxed) == MEETING {
                continue;
            }
            let found = meets_another(subject, (&tree, &known), triangle, &mut stack, watch);
            let ControlFlow::Continue(meets) = found else {
                break;
            };
            of_face.store(if meets { MEETING } else { CLEAN }, Relaxed);
        }
        stop_if_asked(watch)
    };
    parallel::try_map(chunks, of_chunk)?;
    for (triangle, known) in (0..).zip(&known) {
        if known.load(Relaxed) == MEETING {
            found.add(subject, &[triangle], subject.middle(triangle));
        }
    }
    Ok(())
}

#[expect(clippy::cast_possible_truncation, reason = "it is small")]
const CHUNK_U32: u32 = CHUNK as u32;

/// Whether a face meets another in more than what they share; it breaks off when the caller wants
/// to stop.
fn meets_another(
    subject: &Subject<'_>,
    (tree, known): (&Bvh, &[AtomicU8]),
    triangle: u32,
    stack: &mut Vec<u32>,
    watch: &dyn Watch,
) -> ControlFlow<(), bool> {
    let face = face(subject, triangle);
    let bounds = Bounds::of(face.corners);
    let mut candidates = 0;
    let met = tree.any_overlapping(bounds, stack, |other| {
        candidates += 1;
        // One face may have millions of candidates.
        let is_stopped = candidates % CHUNK == 0 && watch.is_stopped();
        let of_other = &known[other as usize];
        let meets = other != triangle
            && of_other.load(Relaxed) != CLEAN
            && meets(subject, &face, bounds, other);
        if meets {
            of_other.store(MEETING, Relaxed);
        }
        is_stopped || meets
    });
    if watch.is_stopped() {
        return ControlFlow::Break(());
    }
    ControlFlow::Continue(met)
}

pub(super) fn meets(subject: &Subject<'_>, face: &Face, bounds: Bounds, other: u32) -> bool {
    let other = self::face(subject, other);
    let Bounds { low, high } = Bounds::of(other.corners);
    low.cmple(bounds.high).all() && bounds.low.cmple(high).all() && meet(face, &other)
}

pub(super) fn face(subject: &Subject<'_>, triangle: u32) -> Face {
    Face { corners: subject.corners(triangle), places: subject.welded[triangle as usize] }
}
