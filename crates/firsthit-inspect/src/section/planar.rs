//! Line segments in the section's plane: how they meet, and how often they go around what is beside
//! them. All signs are exact for the float64 coordinates.

use std::cmp::Ordering;

use super::segments::CHUNK;
use crate::accel::Bvh;
use crate::error::Result;
use crate::geometry::orientation::orient_2d;
use crate::geometry::{Bounds, DVec3};
use crate::parallel;
use crate::watch::{Watch, stop_if_asked};

/// A segment from one point to another of the plane, whose third coordinate is zero. No zero in it
/// is negative, and the points differ.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) from: DVec3,
    pub(super) to: DVec3,
}

/// The relation of two lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meeting {
    Nowhere,
    /// The lines meet at an end of both, and at nothing else.
    AtEnds,
    /// The lines have equal ends, in opposite order.
    Opposite,
    /// One goes through the other's inside, or along a part of it.
    Inside,
}

/// The order of points by x, then y. It is that of x where the plane is sheared by less than any
/// number; then no line is vertical.
fn order(p: DVec3, q: DVec3) -> Ordering {
    p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
}

pub(super) fn side(line: Line, point: DVec3) -> Ordering {
    orient_2d([line.from, line.to, point], 2)
}

impl Line {
    fn bounds(self) -> Bounds {
        Bounds::of([self.from, self.to])
    }

    /// Whether it goes to the right.
    pub(super) fn is_rightwards(self) -> bool {
        order(self.from, self.to) == Ordering::Less
    }

    /// The line in the direction to the right.
    fn rightwards(self) -> Self {
        if self.is_rightwards() {
            return self;
        }
        Self { from: self.to, to: self.from }
    }

    /// Whether a point on the endless line is between the ends, or at one.
    fn spans(self, point: DVec3) -> bool {
        let Self { from, to } = self.rightwards();
        order(from, point) != Ordering::Greater && order(point, to) != Ordering::Greater
    }

    /// Whether a point is on it, but at no end.
    pub(super) fn has_inside(self, point: DVec3) -> bool {
        point != self.from
            && point != self.to
            && self.spans(point)
            && side(self, point) == Ordering::Equal
    }

    /// Whether each goes through the other, from side to side.
    pub(super) fn crosses(self, other: Self) -> bool {
        let are_apart = |line, p, q| {
            let sides = [side(line, p), side(line, q)];
            sides[0] == sides[1].reverse() && sides[0] != Ordering::Equal
        };
        are_apart(self, other.from, other.to) && are_apart(other, self.from, self.to)
    }

    pub(super) fn meeting(self, other: Self) -> Meeting {
        if self.from == other.to && self.to == other.from {
            return Meeting::Opposite;
        }
        let is_same = self.from == other.from && self.to == other.to;
        let is_inside = is_same
            || [other.from, other.to].into_iter().any(|end| self.has_inside(end))
            || [self.from, self.to].into_iter().any(|end| other.has_inside(end))
            || self.crosses(other);
        let ends = [other.from, other.to];
        if is_inside {
            Meeting::Inside
        } else if ends.contains(&self.from) || ends.contains(&self.to) {
            Meeting::AtEnds
        } else {
            Meeting::Nowhere
        }
    }

    /// Whether it is above another line, just to the right of where that begins. It is there, and
    /// the two do not cross. Both go to the right.
    fn is_above(self, other: Self) -> bool {
        if self.from == other.from {
            return side(other, self.to) == Ordering::Greater;
        }
        side(self, other.from) == Ordering::Less
    }
}

/// Lines, and a tree over them.
pub(super) struct Lines<'a> {
    pub(super) all: &'a [Line],
    tree: Bvh,
    top: f64,
}

impl<'a> Lines<'a> {
    pub(super) fn new(lines: &'a [Line]) -> Self {
        let count = u32::try_from(lines.len()).unwrap_or(u32::MAX);
        let tree = Bvh::build(count, |k| lines[k as usize].bounds(), 0.0);
        let tops = lines.iter().map(|line| line.from.y.max(line.to.y));
        Self { all: lines, tree, top: tops.fold(f64::NEG_INFINITY, f64::max) }
    }

    /// Calls `visit` with each other line that may meet a line.
    pub(super) fn near(&self, line: usize, stack: &mut Vec<u32>, mut visit: impl FnMut(usize)) {
        let bounds = self.all[line].bounds();
        self.tree.any_overlapping(bounds, stack, |other| {
            if other as usize != line {
                visit(other as usize);
            }
            false
        });
    }

    /// Calls `visit` with each line that is above one, just to the right of where that begins.
    pub(super) fn above(&self, line: usize, stack: &mut Vec<u32>, mut visit: impl FnMut(usize)) {
        let own = self.all[line].rightwards();
        let start = own.from;
        let bounds = Bounds { low: start, high: DVec3::new(start.x, self.top, 0.0) };
        self.tree.any_overlapping(bounds, stack, |other| {
            let that = self.all[other as usize].rightwards();
            let is_there = order(that.from, start) != Ordering::Greater
                && order(start, that.to) == Ordering::Less;
            if other as usize != line && is_there && that.is_above(own) {
                visit(other as usize);
            }
            false
        });
    }

    /// Maps `of` over the numbers of the lines, with memory for the tree's stack, by all threads.
    pub(super) fn each<T: Send>(
        &self,
        watch: &dyn Watch,
        of: impl Fn(usize, &mut Vec<u32>) -> T + Sync,
    ) -> Result<Vec<T>> {
        let count = self.all.len();
        let part = |chunk: usize| {
            stop_if_asked(watch)?;
            let mut stack = Vec::new();
            let lines = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
            Ok(lines.map(|line| of(line, &mut stack)).collect::<Vec<T>>())
        };
        let parts = parallel::try_map(0..count.div_ceil(CHUNK), part)?;
        Ok(parts.into_iter().flatten().collect())
    }
}
