//! The nearest points found so far.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::NearestSettings;
use crate::shape::Nearest;

/// A point of an object.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) object: u32,
    pub(super) nearest: Nearest,
}

impl Ord for Candidate {
    /// Compares the squares of the distances, which are not NaN, and then identifiers.
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |found: &Self| (found.object, found.nearest.primitive);
        let by_distance = self.nearest.squared.total_cmp(&other.nearest.squared);
        by_distance.then_with(|| key(self).cmp(&key(other)))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// See [the module](self).
#[derive(Debug)]
pub(super) struct Best {
    wanted: NearestSettings,
    /// The farthest on top.
    heap: BinaryHeap<Candidate>,
    /// The largest square of a distance that is wanted.
    most: f64,
    /// Whether memory was short.
    pub(super) is_short: bool,
}

impl Best {
    pub(super) fn new(wanted: NearestSettings) -> Self {
        Self { wanted, heap: BinaryHeap::new(), most: f64::INFINITY, is_short: false }
    }

    /// Forgets what was found. `hint` bounds the squared distance of what is wanted; it may be too
    /// small.
    pub(super) fn start(&mut self, hint: f64) {
        self.heap.clear();
        // A little more than the square: the root decides.
        let NearestSettings { radius, .. } = self.wanted;
        let most = radius * radius * (1.0 + 8.0 * f64::EPSILON) + f64::MIN_POSITIVE;
        self.most = most.min(hint);
    }

    /// Whether points farther than the nearest are wanted too.
    pub(super) fn is_many(&self) -> bool {
        self.wanted.count > 1
    }

    /// The largest square of a distance that still matters.
    #[inline(always)]
    pub(super) fn limit(&self) -> f64 {
        match self.heap.peek() {
            Some(last) if self.heap.len() >= self.wanted.count => {
                last.nearest.squared.min(self.most)
            }
            _ => self.most,
        }
    }

    #[inline(always)]
    pub(super) fn take(&mut self, object: u32, nearest: Nearest) {
        // Written so that a NaN fails.
        let is_near =
            nearest.squared < f64::INFINITY && nearest.squared.sqrt() <= self.wanted.radius;
        if !is_near {
            return;
        }
        let found = Candidate { object, nearest };
        if self.heap.len() < self.wanted.count {
            if self.heap.try_reserve(1).is_err() {
                self.is_short = true;
                return;
            }
            self.heap.push(found);
        } else if let Some(mut last) = self.heap.peek_mut()
            && found < *last
        {
            *last = found;
        }
    }

    /// The square of the smallest distance, infinite if there is none.
    pub(super) fn least(&self) -> f64 {
        let squared = self.heap.iter().map(|found| found.nearest.squared);
        squared.fold(f64::INFINITY, f64::min)
    }

    /// Takes all that was found, the nearest first.
    pub(super) fn in_order(&mut self) -> Vec<Candidate> {
        let heap = std::mem::take(&mut self.heap);
        heap.into_sorted_vec()
    }

    /// The nearest alone.
    pub(super) fn one(&self) -> Option<Candidate> {
        self.heap.peek().copied()
    }
}
