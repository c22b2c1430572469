//! Rays whose triangle is known, gathered until there are enough of them to find out in lanes where it is met.

use super::goal::{Place, Question};
use super::search::Answers;
use super::verdict::{Pencil, verdict_at};
use crate::simd::{Aligned, Lanes, WIDE};

/// The number of its search, the ray, and its triangle: a lane of a leaf.
type Ray<'a> = (usize, Place<'a>, (u32, usize));

/// Up to eight rays, of any searches.
pub(super) struct Waiting<'a> {
    count: usize,
    all: [Option<Ray<'a>>; WIDE],
    numbers: Aligned<[[f64; WIDE]; 15]>,
}

impl<'a> Waiting<'a> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            all: [None; WIDE],
            numbers: Aligned([[0.0; WIDE]; 15]),
        }
    }

    /// Answers a question, now or later.
    #[inline(always)]
    pub(super) fn answer<L: Lanes, Q: Question>(
        &mut self,
        l: L,
        (search, place): (usize, Place<'a>),
        question: &Q,
        answers: &mut impl Answers<Q::Answer>,
    ) {
        let Some((leaf, triangle)) = question.pending() else {
            answers.take(search, place.lane, question.answer(l, &place));
            return;
        };
        let lane = self.count % WIDE;
        let [a, b, c] = place.corners(leaf, triangle);
        let ray = place.packet.ray(place.lane);
        for (k, vector) in [ray.origin, ray.direction, a, b, c].into_iter().enumerate() {
            for axis in 0..3 {
                self.numbers.0[3 * k + axis][lane] = vector[axis];
            }
        }
        self.all[lane] = Some((search, place, (leaf, triangle)));
        self.count += 1;
        if self.count == WIDE {
            self.answer_all::<L, Q>(l, answers);
        }
    }

    /// Answers all that wait.
    #[inline(always)]
    pub(super) fn answer_all<L: Lanes, Q: Question>(
        &mut self,
        l: L,
        answers: &mut impl Answers<Q::Answer>,
    ) {
        if self.count == 0 {
            return;
        }
        let number = |k: usize| l.load64(&self.numbers.0[k]);
        let rays = Pencil {
            origin: [number(0), number(1), number(2)],
            direction: [number(3), number(4), number(5)],
        };
        let corners = [
            [number(6), number(7), number(8)],
            [number(9), number(10), number(11)],
            [number(12), number(13), number(14)],
        ];
        #[expect(clippy::cast_possible_truncation, reason = "eight bits")]
        let wanted = ((1_u32 << self.count) - 1) as u8;
        let (sound, places) = verdict_at(l, &rays, &corners, wanted);
        let mut out = Aligned([[0.0; WIDE]; 3]);
        for (place, out) in places.into_iter().zip(&mut out.0) {
            l.store64(place, out);
        }
        for lane in 0..self.count {
            let Some((search, place, (leaf, triangle))) = self.all[lane] else {
                continue;
            };
            let crossing = if sound >> lane & 1 == 1 {
                let [t, v, w] = [out.0[0][lane], out.0[1][lane], out.0[2][lane]];
                place.crossing_at(leaf, triangle, [t, v, w])
            } else {
                place.locate(l, leaf, triangle)
            };
            answers.take(search, place.lane, Q::from_crossing(crossing));
        }
        self.count = 0;
    }
}
