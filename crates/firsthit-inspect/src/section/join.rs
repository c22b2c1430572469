//! Joins segments to polylines, by the edges at which they meet.
//!
//! 1. Sort the ends of all segments by their edges.
//! 2. At each edge, link the ends of segments with the starts of others, in the order of the
//!    triangles. That is one of each where a mesh is closed and wound consistently. Ends left
//!    over, two starts or two ends, are linked in pairs, in the same order; and a last one stays
//!    open.
//! 3. Follow the links from the first segment that is not in a polyline yet. Where they end, the
//!    polyline is open; it then starts at the end that is found by going backwards.
//!
//! Distances decide nothing, so that a polyline is open only where the mesh is.

use rayon::prelude::*;

use super::plane::SectionPlane;
use super::segments::{CHUNK, Edge, Segment};
use super::{Extent, Section};
use crate::error::Result;
use crate::geometry::{DVec3, compare_points};
use crate::memory;
use crate::watch::{Watch, stop_if_asked};

/// One end of a segment: twice its number, and one more for the end after the start.
type End = u32;

/// The number of no end.
const NONE: End = End::MAX;

/// The memory for a segment while polylines are made, in bytes: its ends, their edges, points and
/// links.
const SEGMENT_BYTES: usize = 2 * (size_of::<(Edge, End)>() + size_of::<DVec3>() + size_of::<End>());

/// Segments, and where they meet.
struct Links<'a> {
    segments: &'a [Segment],
    /// The end that each end meets, or [`NONE`].
    met: Vec<End>,
    /// The place of each end.
    points: Vec<DVec3>,
}

/// Adds the polylines of an object's segments to a section.
pub(super) fn join(
    object: i32,
    segments: &[Segment],
    section: &mut Section,
    watch: &dyn Watch,
) -> Result<()> {
    let count = segments.len();
    memory::check("the ends of a section's segments", count.saturating_mul(SEGMENT_BYTES))?;
    let no_room = |_| memory::no_room_for("the points of a section");
    section.points.try_reserve(2 * count).map_err(no_room)?;
    section.primitives.try_reserve(count).map_err(no_room)?;
    section.extents.try_reserve(count).map_err(no_room)?;
    let links = Links::new(segments, &section.plane, watch)?;
    let mut is_done = memory::filled(count, false)?;
    for segment in 0..count {
        if segment.is_multiple_of(CHUNK) {
            stop_if_asked(watch)?;
        }
        if !is_done[segment] {
            let first = links.first(number(segment));
            links.follow(object, first, &mut is_done, section);
        }
    }
    Ok(())
}

#[expect(clippy::cast_possible_truncation, reason = "a mesh holds at most `i32::MAX` triangles")]
fn number(segment: usize) -> End {
    2 * segment as End
}

impl<'a> Links<'a> {
    fn new(segments: &'a [Segment], plane: &SectionPlane, watch: &dyn Watch) -> Result<Self> {
        let of_segment = |(k, segment): (usize, &Segment)| {
            let [start, end] = segment.edges;
            [(start, number(k)), (end, number(k) + 1)]
        };
        let mut ends: Vec<(Edge, End)> = segments.iter().enumerate().flat_map(of_segment).collect();
        ends.par_sort_unstable_by(|(a, i), (b, j)| {
            let by_point = |k: usize| compare_points(a[k], b[k]);
            by_point(0).then_with(|| by_point(1)).then(i.cmp(j))
        });
        let mut links = memory::filled(ends.len(), NONE)?;
        let mut points = memory::filled(ends.len(), DVec3::ZERO)?;
        let mut unpaired = [Vec::new(), Vec::new()];
        for (k, meeting) in ends.chunk_by(|(a, _), (b, _)| a == b).enumerate() {
            if k.is_multiple_of(CHUNK) {
                stop_if_asked(watch)?;
            }
            let point = plane.crossing(meeting[0].0);
            for &(_, end) in meeting {
                points[end as usize] = point;
            }
            link(meeting, &mut unpaired, &mut links);
        }
        Ok(Self { segments, met: links, points })
    }

    /// The end from which a polyline through a segment, given by its start, is followed: that
    /// start, or the open end before it.
    fn first(&self, start: End) -> End {
        let mut end = start;
        loop {
            match self.met[end as usize] {
                NONE => return end,
                met if met == start + 1 => return start,
                met => end = met ^ 1,
            }
        }
    }

    /// Adds the polyline that begins at an end. A segment without a length, of a triangle that has
    /// only a corner in the plane, is left out, and so is a polyline of nothing else.
    fn follow(&self, object: i32, first: End, is_done: &mut [bool], section: &mut Section) {
        let [point, segment] = [section.points.len(), section.primitives.len()];
        let mut start = first;
        let is_closed = loop {
            let end = start ^ 1;
            let [from, to] = [start, end].map(|end| self.points[end as usize]);
            is_done[start as usize / 2] = true;
            if from != to {
                section.points.push(from);
                section.primitives.push(self.segments[start as usize / 2].primitive);
            }
            match self.met[end as usize] {
                NONE => {
                    if section.primitives.len() > segment {
                        section.points.push(to);
                    }
                    break false;
                }
                next if next == first => break true,
                next => start = next,
            }
        };
        if section.primitives.len() > segment {
            section.extents.push(Extent {
                object,
                is_closed,
                points: [point, section.points.len()],
                segments: [segment, section.primitives.len()],
            });
        }
    }
}

/// Links the ends of segments that meet at one edge. `unpaired` is memory to be used again.
fn link(meeting: &[(Edge, End)], unpaired: &mut [Vec<End>; 2], links: &mut [End]) {
    let mut pair = |a: End, b: End| {
        links[a as usize] = b;
        links[b as usize] = a;
    };
    // Nearly always.
    if let [(_, a), (_, b)] = *meeting {
        return pair(a, b);
    }
    let [starts, ends] = unpaired;
    starts.clear();
    ends.clear();
    for &(_, end) in meeting {
        if end % 2 == 0 {
            starts.push(end);
        } else {
            ends.push(end);
        }
    }
    let both = starts.len().min(ends.len());
    starts.iter().zip(&*ends).for_each(|(&a, &b)| pair(a, b));
    for rest in [&starts[both..], &ends[both..]] {
        rest.chunks_exact(2).for_each(|two| pair(two[0], two[1]));
    }
}
