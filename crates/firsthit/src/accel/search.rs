//! Many rays through the trees of meshes: together those that have the same way or the same place, the others each on its own.

use super::beam::beam;
use super::goal::{Place, Question};
use super::masked::masked;
use super::mesh_tree::MeshTree;
use super::packet::{Packet, RAYS};
use super::waiting::Waiting;
use super::walk::Stack;
use super::wave::{Wave, wave};
use crate::shape::Mesh;
use crate::simd::Lanes;

/// Fewer rays of a packet are as well off alone as together.
pub(super) const FEWEST: u32 = 4;

/// A packet of rays that is [prepared](Packet::prepare) for the tree of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Search<'a> {
    pub(super) tree: &'a MeshTree,
    pub(super) mesh: &'a Mesh,
    pub(super) packet: &'a Packet,
    /// The rays that wait for an answer.
    pub(super) open: u16,
}

impl<'a> Search<'a> {
    pub(crate) fn new(tree: &'a MeshTree, mesh: &'a Mesh, packet: &'a Packet) -> Self {
        Self {
            tree,
            mesh,
            packet,
            open: packet.alive,
        }
    }

    /// Answers those of `rays` that have found what they ask for, and all of them where the search for them `is_done`.
    #[inline(always)]
    pub(super) fn close<L: Lanes, Q: Question>(
        &mut self,
        l: L,
        number: usize,
        (rays, is_done): (u16, bool),
        questions: &[Q; RAYS],
        answers: &mut impl Answers<Q::Answer>,
    ) {
        let mut waiting = Waiting::new();
        for (lane, question) in questions.iter().enumerate() {
            if rays >> lane & 1 == 1 && (is_done || question.limit() < 0.0) {
                waiting.answer(l, (number, self.place(lane)), question, answers);
                self.open &= !(1 << lane);
            }
        }
        waiting.answer_all::<L, Q>(l, answers);
    }

    /// One of its rays.
    #[inline(always)]
    pub(super) fn place(&self, lane: usize) -> Place<'a> {
        Place {
            tree: self.tree,
            mesh: self.mesh,
            packet: self.packet,
            lane,
        }
    }
}

/// Who wants to know what came of the searches.
pub(crate) trait Answers<A> {
    /// The answer for a ray of a search, by their numbers.
    fn take(&mut self, search: usize, lane: usize, answer: A);
}

/// Memory for searches, to be used again.
#[derive(Debug)]
pub(crate) struct Searcher {
    stack: Stack,
    wave: Wave,
}

impl Searcher {
    /// With its memory.
    pub(crate) fn new() -> Self {
        Self {
            stack: Stack::new(),
            wave: Wave::new(),
        }
    }

    /// Answers each ray of `searches` that may meet something.
    #[inline(always)]
    pub(crate) fn run<L: Lanes, Q: Question>(
        &mut self,
        l: L,
        searches: &mut [Search<'_>],
        answers: &mut impl Answers<Q::Answer>,
    ) {
        let (mut with_beams, mut with_masks) = (Patience::new(), Patience::new());
        let stack = &mut self.stack;
        for (number, search) in searches.iter_mut().enumerate() {
            if with_beams.tries() {
                with_beams.learn(beam::<L, Q>(l, stack, number, search, answers));
            }
            if !Q::ORDERED && search.open != 0 && with_masks.tries() {
                with_masks.learn(masked::<L, Q>(l, stack, number, search, answers));
            }
        }
        wave::<L, Q>(l, &mut self.wave, searches, answers);
    }
}

/// Whether to try: where one after the other fails, some are left out.
struct Patience {
    /// How many have failed since one did not.
    failures: u32,
    /// How many to leave out.
    pause: u32,
}

impl Patience {
    fn new() -> Self {
        Self {
            failures: 0,
            pause: 0,
        }
    }

    #[inline(always)]
    fn tries(&mut self) -> bool {
        let tries = self.pause == 0;
        self.pause = self.pause.saturating_sub(1);
        tries
    }

    #[inline(always)]
    fn learn(&mut self, is_done: bool) {
        self.failures = if is_done { 0 } else { self.failures + 1 };
        self.pause = self.failures.saturating_sub(2).min(8);
    }
}
