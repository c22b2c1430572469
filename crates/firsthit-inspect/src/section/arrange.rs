//! Polylines that cross, taken apart and put together anew as outlines of what is inside.
//!
//! 1. Split lines where others cross them, end on them or run along them. A crossing is rounded to
//!    float64, which moves lines a little, so that they may cross others: again, until none does.
//! 2. Lines in one place are one, which counts as often as they go one way more than the other.
//! 3. Count how often the lines go around both sides of each, and keep those with the inside on one
//!    side: that becomes their left.
//! 4. As many of them come to a point as leave it, so that they are closed curves. Where several
//!    leave, the sharpest turn to the left is next: then curves that touch in a point stay apart.
//!
//! Every sign is exact, so that what is put together fits. After Hobby, "Practical segment
//! intersection with finite precision output", Computational Geometry 13(4), 1999, without its
//! grid.

use std::cmp::Ordering;
use std::collections::HashMap;

use super::outline::{Winding, in_plane};
use super::planar::{Line, Lines, side};
use super::{Extent, Section};
use crate::error::Result;
use crate::geometry::DVec3;
use crate::solid::FillRule;
use crate::watch::Watch;

/// The most rounds of splitting lines. Two or three are enough in practice.
const ROUNDS: usize = 40;

/// The points of lines, in the plane and in space.
#[derive(Default)]
struct Nodes {
    numbers: HashMap<[u64; 2], u32>,
    in_plane: Vec<DVec3>,
    in_space: Vec<DVec3>,
}

impl Nodes {
    fn number(&mut self, in_plane: DVec3, in_space: DVec3) -> u32 {
        let next = u32::try_from(self.in_plane.len()).unwrap_or(u32::MAX);
        let key = [in_plane.x.to_bits(), in_plane.y.to_bits()];
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.in_plane.push(in_plane);
            self.in_space.push(in_space);
        }
        number
    }

    fn line(&self, edge: &Edge) -> Line {
        let [from, to] = edge.ends.map(|end| self.in_plane[end as usize]);
        Line { from, to }
    }
}

/// A line between two nodes.
#[derive(Clone, Copy)]
struct Edge {
    ends: [u32; 2],
    primitive: i32,
}

/// Puts the polylines of one object, those from number `first` on, together anew. Returns whether
/// it could: else they are as they were.
pub(super) fn arrange(
    section: &mut Section,
    first: usize,
    rule: FillRule,
    watch: &dyn Watch,
) -> Result<bool> {
    let mut nodes = Nodes::default();
    let mut edges = Vec::new();
    for extent in &section.extents[first..] {
        let points = &section.points[extent.points[0]..extent.points[1]];
        let primitives = &section.primitives[extent.segments[0]..extent.segments[1]];
        let numbers: Vec<u32> =
            points.iter().map(|&point| nodes.number(in_plane(section, point), point)).collect();
        for (k, &primitive) in primitives.iter().enumerate() {
            let ends = [numbers[k], numbers[(k + 1) % numbers.len()]];
            edges.push(Edge { ends, primitive });
        }
    }
    let Some(edges) = split(&mut nodes, edges, watch)? else {
        return Ok(false);
    };
    let outline = boundary(&nodes, edges, rule, watch)?;
    let object = section.extents[first].object;
    let [point, segment] = section.extents[first].starts();
    section.extents.truncate(first);
    section.points.truncate(point);
    section.primitives.truncate(segment);
    join(&nodes, &outline, object, section);
    Ok(true)
}

/// The lines split so that they meet at their ends alone, or have both ends in common; `None` if
/// that has no end.
fn split(nodes: &mut Nodes, mut edges: Vec<Edge>, watch: &dyn Watch) -> Result<Option<Vec<Edge>>> {
    for _ in 0..ROUNDS {
        edges.retain(|edge| edge.ends[0] != edge.ends[1]);
        let lines: Vec<Line> = edges.iter().map(|edge| nodes.line(edge)).collect();
        let lines = Lines::new(&lines);
        let cuts = lines.each(watch, |line, stack| {
            let mut cuts = Vec::new();
            lines.near(line, stack, |other| {
                cut(lines.all, [line, other], &mut cuts);
            });
            cuts
        })?;
        if cuts.iter().all(Vec::is_empty) {
            return Ok(Some(edges));
        }
        let mut pieces = Vec::new();
        for ((edge, mut cuts), line) in edges.iter().zip(cuts).zip(lines.all) {
            let way = line.to - line.from;
            let along = |point: &DVec3| (*point - line.from).dot(way);
            cuts.sort_by(|p, q| along(p).total_cmp(&along(q)));
            let [start, end] = edge.ends.map(|end| nodes.in_space[end as usize]);
            let mut from = edge.ends[0];
            for point in cuts {
                let share = along(&point) / way.length_squared();
                let to = nodes.number(point, start.lerp(end, share.clamp(0.0, 1.0)));
                pieces.push(Edge { ends: [from, to], ..*edge });
                from = to;
            }
            pieces.push(Edge { ends: [from, edge.ends[1]], ..*edge });
        }
        edges = pieces;
    }
    Ok(None)
}

/// Adds the points at which the second of two lines cuts the first in pieces.
fn cut(lines: &[Line], [own, other]: [usize; 2], cuts: &mut Vec<DVec3>) {
    let (line, that) = (lines[own], lines[other]);
    let ends = [that.from, that.to];
    cuts.extend(ends.into_iter().filter(|&end| line.has_inside(end)));
    if line.crosses(that) {
        // The same bits for both.
        let point = crossing(lines[own.min(other)], lines[own.max(other)]);
        if point != line.from && point != line.to {
            cuts.push(point);
        }
    }
}

/// The crossing of two lines, within the boxes of both.
fn crossing(a: Line, b: Line) -> DVec3 {
    let (way, across) = (a.to - a.from, b.to - b.from);
    let slope = way.x * across.y - way.y * across.x;
    let offset = b.from - a.from;
    let share = (offset.x * across.y - offset.y * across.x) / slope;
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 };
    let low = a.from.min(a.to).max(b.from.min(b.to));
    let high = a.from.max(a.to).min(b.from.max(b.to));
    (a.from + share * way).min(high).max(low) + DVec3::ZERO
}

/// The lines that have the inside on one side, which is their left.
fn boundary(
    nodes: &Nodes,
    mut edges: Vec<Edge>,
    rule: FillRule,
    watch: &dyn Watch,
) -> Result<Vec<Edge>> {
    let key = |edge: &Edge| {
        let [a, b] = edge.ends;
        [a.min(b), a.max(b)]
    };
    edges.sort_by_key(|edge| (key(edge), edge.primitive));
    let mut single = Vec::new();
    let mut weights = Vec::new();
    for same in edges.chunk_by(|a, b| key(a) == key(b)) {
        let rightwards = same.iter().filter(|edge| nodes.line(edge).is_rightwards());
        let (rightwards, count) = (rightwards.count(), same.len());
        let [rightwards, count] = [rightwards, count].map(|n| i32::try_from(n).unwrap_or(i32::MAX));
        single.push(same[0]);
        weights.push((2 * rightwards - count, count.cast_unsigned()));
    }
    let lines: Vec<Line> = single.iter().map(|edge| nodes.line(edge)).collect();
    let lines = Lines::new(&lines);
    let kept = lines.each(watch, |line, stack| {
        let mut above = Winding::default();
        let pass = |around: &mut Winding, line: usize| {
            around.turns -= weights[line].0;
            around.crossings += weights[line].1;
        };
        lines.above(line, stack, |other| pass(&mut above, other));
        let mut below = above;
        pass(&mut below, line);
        let [above, below] = [above, below].map(|around| around.is_inside(rule));
        let edge = single[line];
        let is_along = above == lines.all[line].is_rightwards();
        let [from, to] = edge.ends;
        let ends = if is_along { [from, to] } else { [to, from] };
        (above != below).then_some(Edge { ends, ..edge })
    })?;
    Ok(kept.into_iter().flatten().collect())
}

/// Adds the closed curves of lines, those of the lowest primitives first.
fn join(nodes: &Nodes, edges: &[Edge], object: i32, section: &mut Section) {
    let mut order: Vec<u32> = (0..).take(edges.len()).collect();
    order.sort_by_key(|&k| (edges[k as usize].primitive, k));
    let mut onwards: Vec<(u32, u32)> =
        (edges.iter().zip(0..)).map(|(edge, k)| (edge.ends[0], k)).collect();
    onwards.sort_unstable();
    let mut is_done = vec![false; edges.len()];
    for first in order {
        if is_done[first as usize] {
            continue;
        }
        let (mut points, mut primitives) = (Vec::new(), Vec::new());
        let mut current = first;
        loop {
            is_done[current as usize] = true;
            let edge = &edges[current as usize];
            points.push(nodes.in_space[edge.ends[0] as usize]);
            primitives.push(edge.primitive);
            let to = edge.ends[1];
            if to == edges[first as usize].ends[0] {
                break;
            }
            let start = onwards.partition_point(|&(node, _)| node < to);
            let next = onwards[start..].iter().take_while(|&&(node, _)| node == to);
            let next = next.map(|&(_, k)| k).filter(|&k| !is_done[k as usize]);
            let line = nodes.line(edge);
            let next = next.reduce(|a, b| {
                let [p, q] = [a, b].map(|k| nodes.line(&edges[k as usize]).to);
                if is_sharper(line, q, p) { b } else { a }
            });
            // As many leave as come.
            let Some(next) = next else { break };
            current = next;
        }
        section.add_closed(object, &points, &primitives);
    }
}

/// Whether from the end of a line on it is a sharper turn to the left to go to `p` than to `q`.
fn is_sharper(line: Line, p: DVec3, q: DVec3) -> bool {
    let rank = |point: DVec3| match side(line, point) {
        Ordering::Greater => 3,
        Ordering::Equal if (point - line.to).dot(line.to - line.from) > 0.0 => 2,
        Ordering::Less => 1,
        Ordering::Equal => 0,
    };
    let (of_p, of_q) = (rank(p), rank(q));
    let between = Line { from: line.to, to: q };
    of_p > of_q || of_p == of_q && side(between, p) == Ordering::Greater
}

impl Extent {
    /// The indices of its first point and of its first segment.
    fn starts(&self) -> [usize; 2] {
        [self.points[0], self.segments[0]]
    }
}
