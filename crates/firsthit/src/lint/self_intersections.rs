//! Faces that meet other faces of their mesh.
//!
//! A tree over the boxes of all faces gives the candidates. The face and a candidate are then judged exactly ([`meet`]).

use std::ops::ControlFlow;

use super::meeting::{Face, meet};
use super::report::Found;
use super::subject::{CHUNK, Subject, stop_if_asked};
use crate::accel::Bvh;
use crate::error::Result;
use crate::geometry::Bounds;
use crate::memory;
use crate::parallel;
use crate::watch::Watch;

/// What the tree over a face's box takes while it is built, in bytes.
const TREE_BYTES: usize = 192;

pub(super) fn check(subject: &Subject<'_>, found: &mut Found<'_>, watch: &dyn Watch) -> Result<()> {
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
    let tree = Bvh::build(count, bounds, 0.0);
    stop_if_asked(watch)?;
    let chunks = 0..count.div_ceil(CHUNK_U32);
    let of_chunk = |chunk: u32| {
        let mut stack = Vec::new();
        let mut meeting = Vec::new();
        for triangle in chunk * CHUNK_U32..count.min((chunk + 1).saturating_mul(CHUNK_U32)) {
            let has_area = subject.has_area[triangle as usize];
            match has_area.then(|| meets_another(subject, &tree, triangle, &mut stack, watch)) {
                Some(ControlFlow::Continue(true)) => meeting.push(triangle),
                Some(ControlFlow::Break(())) => break,
                _ => {}
            }
        }
        stop_if_asked(watch).map(|()| meeting)
    };
    for triangle in parallel::try_map(chunks, of_chunk)?.into_iter().flatten() {
        found.add(subject, &[triangle], subject.middle(triangle));
    }
    Ok(())
}

#[expect(clippy::cast_possible_truncation, reason = "it is small")]
const CHUNK_U32: u32 = CHUNK as u32;

/// Whether a face meets another in more than what they share; it breaks off when the caller wants to stop.
fn meets_another(
    subject: &Subject<'_>,
    tree: &Bvh,
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
        is_stopped || other != triangle && meets(subject, &face, bounds, other)
    });
    if watch.is_stopped() {
        return ControlFlow::Break(());
    }
    ControlFlow::Continue(met)
}

fn meets(subject: &Subject<'_>, face: &Face, bounds: Bounds, other: u32) -> bool {
    let other = self::face(subject, other);
    let Bounds { low, high } = Bounds::of(other.corners);
    low.cmple(bounds.high).all() && bounds.low.cmple(high).all() && meet(face, &other)
}

fn face(subject: &Subject<'_>, triangle: u32) -> Face {
    Face {
        corners: subject.corners(triangle),
        places: subject.welded[triangle as usize],
    }
}
