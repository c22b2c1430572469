//! Makes the outlines of the inside from the closed polylines of a mesh.
//!
//! 1. Nearly always they are that already: no two of them meet, and each has the inside on its left
//!    alone. How often they go around the two sides of a line is counted along a ray in the plane
//!    (`planar.rs`).
//! 2. Else the mesh is asked which way its triangles face. A polyline with the inside on its right
//!    is turned around, and one that has it on both sides or on neither is left out.
//! 3. Where polylines cross, or run along each other, they are taken apart into lines that meet at
//!    their ends alone, and put together anew from those lines that have the inside on one side
//!    (`arrange.rs`).
//!
//! A line that a polyline goes along there and back is left to it: the mesh touches the plane
//! there.

use super::planar::{Line, Lines, Meeting};
use super::segments::CHUNK;
use super::{Extent, Section};
use crate::error::Result;
use crate::geometry::DVec3;
use crate::memory;
use crate::solid::FillRule;
use crate::watch::{Watch, stop_if_asked};

/// The winding number of an outline around a place, and the number of its crossings.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Winding {
    pub(super) turns: i32,
    pub(super) crossings: u32,
}

impl Winding {
    pub(super) fn is_inside(self, rule: FillRule) -> bool {
        match rule {
            FillRule::Nonzero => self.turns != 0,
            FillRule::Parity => self.crossings % 2 == 1,
        }
    }
}

/// The change that a polyline needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    Stays,
    IsTurned,
    IsLeftOut,
}

/// The state of the polylines of an object.
pub(super) enum Outlines {
    /// The polylines are the outlines.
    Done,
    /// The polylines are the outlines after the change of each.
    Simple(Vec<Fate>),
    /// The polylines cross or run along each other.
    Tangled,
}

/// A polyline's line: its polyline's number, and its own within that.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Place {
    polyline: usize,
    number: usize,
}

/// A point of space in the plane's coordinates.
pub(super) fn in_plane(section: &Section, point: DVec3) -> DVec3 {
    let place = section.plane.coordinates(point);
    // Adding zero makes negative zeros positive.
    DVec3::new(place.x + 0.0, place.y + 0.0, 0.0)
}

/// Looks at the polylines of one object, those from number `first` on, all of which are closed.
pub(super) fn judge(
    section: &Section,
    first: usize,
    rule: FillRule,
    watch: &dyn Watch,
) -> Result<Outlines> {
    let extents = &section.extents[first..];
    let count: usize = extents.iter().map(Extent::len).sum();
    memory::check("the outlines of a section", count.saturating_mul(LINE_BYTES))?;
    let (mut lines, mut places) = (Vec::new(), Vec::new());
    for (polyline, extent) in extents.iter().enumerate() {
        let points = &section.points[extent.points[0]..extent.points[1]];
        let points: Vec<DVec3> = points.iter().map(|&p| in_plane(section, p)).collect();
        for (number, &from) in points.iter().enumerate() {
            let to = points[(number + 1) % points.len()];
            if from != to {
                lines.push(Line { from, to });
                places.push(Place { polyline, number });
            }
        }
    }
    let lines = Lines::new(&lines);
    let meetings = lines.each(watch, |line, stack| look(&lines, &places, extents, line, stack))?;
    if meetings.iter().any(|seen| seen.is_tangled) {
        return Ok(Outlines::Tangled);
    }
    // Where polylines meet at ends, one may have its inside on the left here and on the right
    // there.
    let is_pinched = meetings.iter().any(|seen| seen.is_pinched);
    let mut fates = vec![Fate::Stays; extents.len()];
    let mut is_judged = vec![false; extents.len()];
    let mut stack = Vec::new();
    for (line, place) in places.iter().enumerate() {
        if line.is_multiple_of(CHUNK) {
            stop_if_asked(watch)?;
        }
        let polyline = place.polyline;
        if meetings[line].is_back || is_judged[polyline] && !is_pinched {
            continue;
        }
        let mut above = Winding::default();
        lines.above(line, &mut stack, |other| {
            above.turns -= if lines.all[other].is_rightwards() { 1 } else { -1 };
            above.crossings += 1;
        });
        let is_rightwards = lines.all[line].is_rightwards();
        let below = Winding {
            turns: above.turns - if is_rightwards { 1 } else { -1 },
            crossings: above.crossings + 1,
        };
        let [above, below] = [above, below].map(|around| around.is_inside(rule));
        let fate = match above == is_rightwards {
            _ if above == below => Fate::IsLeftOut,
            true => Fate::Stays,
            false => Fate::IsTurned,
        };
        if is_judged[polyline] && fates[polyline] != fate {
            return Ok(Outlines::Tangled);
        }
        (fates[polyline], is_judged[polyline]) = (fate, true);
    }
    if fates.iter().all(|&fate| fate == Fate::Stays) {
        return Ok(Outlines::Done);
    }
    Ok(Outlines::Simple(fates))
}

/// The memory for a line while outlines are looked at, in bytes: the line, its place, the lines it
/// meets, its part of the tree.
const LINE_BYTES: usize = 256;

/// The relation of a line to others.
struct LineRelations {
    is_tangled: bool,
    /// Whether it has an end in common with a line that is not its neighbour.
    is_pinched: bool,
    /// Whether its polyline comes back along it.
    is_back: bool,
}

fn look(
    lines: &Lines<'_>,
    places: &[Place],
    extents: &[Extent],
    line: usize,
    stack: &mut Vec<u32>,
) -> LineRelations {
    let mut seen = LineRelations { is_tangled: false, is_pinched: false, is_back: false };
    let own = places[line];
    lines.near(line, stack, |other| {
        let that = places[other];
        let is_own = own.polyline == that.polyline;
        match lines.all[line].meeting(lines.all[other]) {
            Meeting::Nowhere => {}
            Meeting::Opposite if is_own => seen.is_back = true,
            Meeting::Opposite | Meeting::Inside => seen.is_tangled = true,
            Meeting::AtEnds => {
                let count = extents[own.polyline].len();
                let follows = |a: usize, b: usize| (a + 1) % count == b;
                let are_neighbours = is_own
                    && (follows(own.number, that.number) || follows(that.number, own.number));
                seen.is_pinched |= !are_neighbours;
            }
        }
    });
    seen
}

/// Gives each polyline of one object, those from number `first` on, its fate.
pub(super) fn apply(section: &mut Section, first: usize, fates: &[Fate]) {
    let old: Vec<Extent> = section.extents.drain(first..).collect();
    let Some(start) = old.first() else { return };
    let points = section.points.split_off(start.points[0]);
    let primitives = section.primitives.split_off(start.segments[0]);
    let (from, from_segments) = (start.points[0], start.segments[0]);
    for (extent, fate) in old.iter().zip(fates) {
        let points = &points[extent.points[0] - from..extent.points[1] - from];
        let primitives =
            &primitives[extent.segments[0] - from_segments..extent.segments[1] - from_segments];
        let (mut points, mut primitives) = (points.to_vec(), primitives.to_vec());
        match fate {
            Fate::IsLeftOut => continue,
            Fate::Stays => {}
            Fate::IsTurned => {
                // It begins at the same point.
                points[1..].reverse();
                primitives.reverse();
            }
        }
        section.add_closed(extent.object, &points, &primitives);
    }
}
