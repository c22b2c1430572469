//! Ear clipping with a queue.

use std::collections::VecDeque;

use robust::orient2d;

use super::columns::{Columns, Point};

const NONE: u32 = u32::MAX;

/// The most points that are looked at for each corner before a polygon counts as hopeless: it must
/// cross itself in every way to need as many.
const PATIENCE: u64 = 1 << 13;

/// A polygon whose ears are being cut off.
pub(super) struct Clipper<'a> {
    points: &'a [Point],
    /// The ring of corners that are left.
    next: Vec<u32>,
    previous: Vec<u32>,
    left: usize,
    is_left: Vec<bool>,
    /// Corners that do not turn left, which alone can lie in an ear: so none is convex again in
    /// vain.
    blocks: Vec<bool>,
    blocking: usize,
    columns: Columns,
    /// Corners to test, first in first out: neighbours are not cut in a row, which would make
    /// slivers.
    queue: VecDeque<u32>,
    is_queued: Vec<bool>,
    /// Corners on a straight line: cut when there is no ear.
    straight: Vec<u32>,
    /// A linked list for each corner of those that it keeps from being ears.
    first_waiting: Vec<u32>,
    waiting: Vec<Waiting>,
    /// The place that the search for any corner at all has reached.
    walk: u32,
    patience: u64,
    triangles: Vec<[u32; 3]>,
}

struct Waiting {
    corner: u32,
    next: u32,
}

enum Test {
    Ear,
    Straight,
    Reflex,
    BlockedBy(u32),
}

impl<'a> Clipper<'a> {
    /// Starts on a counter-clockwise polygon of at least three corners, fewer than 2^32 - 1.
    pub(super) fn new(points: &'a [Point]) -> Self {
        let count = points.len();
        #[expect(clippy::cast_possible_truncation, reason = "the contract above")]
        let corners = 0..count as u32;
        let last = corners.end - 1;
        let mut clipper = Self {
            points,
            next: corners.clone().map(|k| if k == last { 0 } else { k + 1 }).collect(),
            previous: corners.clone().map(|k| if k == 0 { last } else { k - 1 }).collect(),
            left: count,
            is_left: vec![true; count],
            blocks: vec![false; count],
            blocking: 0,
            columns: Columns::new(points, Vec::new()),
            queue: corners.clone().collect(),
            is_queued: vec![true; count],
            straight: Vec::new(),
            first_waiting: vec![NONE; count],
            waiting: Vec::new(),
            walk: 0,
            patience: PATIENCE.saturating_mul(count as u64),
            triangles: Vec::with_capacity(count - 2),
        };
        let blocking: Vec<u32> = corners.filter(|&k| clipper.turn(k) <= 0.0).collect();
        for &k in &blocking {
            clipper.blocks[k as usize] = true;
        }
        clipper.blocking = blocking.len();
        clipper.columns = Columns::new(points, blocking);
        clipper
    }

    /// The triangles.
    pub(super) fn run(mut self) -> Vec<[u32; 3]> {
        while self.left > 3 {
            let corner = self.choose();
            self.clip(corner);
        }
        let corner = self.walk;
        self.triangles.push(self.triangle(corner));
        self.triangles
    }

    /// The corner to cut off: an ear if there is one, else one without area, else any.
    fn choose(&mut self) -> u32 {
        while self.patience > 0
            && let Some(corner) = self.queue.pop_front()
        {
            self.is_queued[corner as usize] = false;
            if self.is_left[corner as usize] {
                match self.test(corner) {
                    Test::Ear => return corner,
                    Test::Straight => self.straight.push(corner),
                    Test::Reflex => {}
                    Test::BlockedBy(blocker) => self.wait(corner, blocker),
                }
            }
        }
        while let Some(corner) = self.straight.pop() {
            if self.is_left[corner as usize] && self.turn(corner) == 0.0 {
                return corner;
            }
        }
        self.choose_any()
    }

    /// A convex corner even if something lies in its triangle; when patience is over, any corner.
    fn choose_any(&mut self) -> u32 {
        for _ in 0..self.left {
            if self.patience == 0 {
                break;
            }
            self.patience -= 1;
            self.walk = self.next[self.walk as usize];
            if self.turn(self.walk) > 0.0 {
                return self.walk;
            }
        }
        self.patience = 0;
        self.next[self.walk as usize]
    }

    fn test(&mut self, corner: u32) -> Test {
        let turn = self.turn(corner);
        if turn == 0.0 {
            return Test::Straight;
        }
        if turn < 0.0 {
            return Test::Reflex;
        }
        match self.blocker(corner) {
            Some(blocker) => Test::BlockedBy(blocker),
            None => Test::Ear,
        }
    }

    /// A corner in the triangle that cutting off `corner` would make.
    fn blocker(&mut self, corner: u32) -> Option<u32> {
        if self.blocking == 0 {
            return None;
        }
        let triangle = self.triangle(corner);
        let [a, b, c] = triangle.map(|k| self.points[k as usize]);
        let end =
            |of: fn(f64, f64) -> f64| Point { x: of(of(a.x, b.x), c.x), y: of(of(a.y, b.y), c.y) };
        let (low, high) = (end(f64::min), end(f64::max));
        let mut seen = 1;
        let blocker = self.columns.within(self.points, low, high).find(|&k| {
            seen += 1;
            self.blocks[k as usize] && !triangle.contains(&k) && self.is_inside(k, [a, b, c])
        });
        self.patience = self.patience.saturating_sub(seen);
        blocker
    }

    /// Whether a corner lies in a triangle or on its border in a way that keeps it from being an
    /// ear.
    fn is_inside(&self, corner: u32, [a, b, c]: [Point; 3]) -> bool {
        let point = self.points[corner as usize];
        // Corners at the same point, as at both ends of a bridge to a hole, do not block: their
        // neighbours do, if they lie inside. Those at the ear's tip block when they point into it.
        if point == a || point == c {
            return false;
        }
        if point == b {
            let within = |k: u32| {
                let q = self.points[k as usize];
                orient2d(a, b, q) > 0.0 && orient2d(b, c, q) > 0.0
            };
            return within(self.next[corner as usize]) || within(self.previous[corner as usize]);
        }
        orient2d(a, b, point) >= 0.0 && orient2d(b, c, point) >= 0.0 && orient2d(c, a, point) >= 0.0
    }

    fn clip(&mut self, corner: u32) {
        let [before, _, after] = self.triangle(corner);
        self.triangles.push([before, corner, after]);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.is_left[corner as usize] = false;
        self.left -= 1;
        if self.walk == corner {
            self.walk = before;
        }
        self.unblock(corner);
        for neighbour in [before, after] {
            if self.turn(neighbour) > 0.0 {
                self.unblock(neighbour);
            }
            self.enqueue(neighbour);
        }
        if self.blocking < self.columns.len() / 2 {
            let still = (0..).zip(&self.blocks).filter(|&(_, &blocks)| blocks);
            self.columns = Columns::new(self.points, still.map(|(k, _)| k).collect());
        }
    }

    /// `corner` blocks no ear any more: the ears that waited for it are tested again.
    fn unblock(&mut self, corner: u32) {
        if !std::mem::take(&mut self.blocks[corner as usize]) {
            return;
        }
        self.blocking -= 1;
        let mut entry = std::mem::replace(&mut self.first_waiting[corner as usize], NONE);
        while entry != NONE {
            let Waiting { corner, next } = self.waiting[entry as usize];
            self.enqueue(corner);
            entry = next;
        }
    }

    fn wait(&mut self, corner: u32, blocker: u32) {
        let Ok(entry) = u32::try_from(self.waiting.len()) else {
            return;
        };
        let next = std::mem::replace(&mut self.first_waiting[blocker as usize], entry);
        self.waiting.push(Waiting { corner, next });
    }

    fn enqueue(&mut self, corner: u32) {
        if !std::mem::replace(&mut self.is_queued[corner as usize], true) {
            self.queue.push_back(corner);
        }
    }

    fn triangle(&self, corner: u32) -> [u32; 3] {
        let (before, after) = (self.previous[corner as usize], self.next[corner as usize]);
        [before, corner, after]
    }

    /// Positive at a left turn, exactly zero on a straight line.
    fn turn(&self, corner: u32) -> f64 {
        let [a, b, c] = self.triangle(corner).map(|k| self.points[k as usize]);
        orient2d(a, b, c)
    }
}
