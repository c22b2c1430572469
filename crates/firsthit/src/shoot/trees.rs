//! Rays through the trees, one by one and many at a time.

use std::cell::Cell;
use std::marker::PhantomData;

use super::fit::SquareRays;
use super::hits::Square;
use super::journey::{AnyHit, FirstHit, Journey, Leg, Quest};
use super::plan;
use crate::accel::{
    self, Answers, MeshTree, Packet, Question, RAYS, Scratch, Search, Searcher, WalkStack,
};
use crate::geometry::{DVec3, Hit, Ray, Rays};
use crate::scene::{Object, Scene};
use crate::shape::Mesh;
use crate::shape::triangle::clear_of;
use crate::simd::{self, Kernel, Lanes};

/// The trees propose, float64 decides.
#[derive(Debug, Clone, Copy)]
pub struct Trees;

impl super::Search for Trees {
    fn first_hit(scene: &Scene, ray: &Ray) -> Hit {
        let FirstHit(hit) = simd::run(scene.instruction_set(), Single(scene, ray, FirstHit::START));
        hit
    }
}

/// [`super::any_hit`].
pub(super) fn any_hit(scene: &Scene, ray: &Ray) -> bool {
    let AnyHit(is_hit) = simd::run(scene.instruction_set(), Single(scene, ray, AnyHit::START));
    is_hit
}

/// How many rays a thread takes at a time at most: enough to be worth it, few enough to stop within a moment.
pub(super) const BATCH: usize = 1024;

thread_local! {
    /// What rays work with; made once for each thread.
    static MEMORY: Cell<Option<Memory>> = const { Cell::new(None) };
}

/// Memory for searches.
pub(super) struct Memory {
    pub(super) scratch: Scratch,
    /// One for each ray of a batch.
    walk_stacks: Vec<WalkStack>,
    packets: Vec<Packet>,
    searcher: Searcher,
    /// Made when there is a picture, and when its rays are an array's.
    pub(super) square: Option<Square>,
    pub(super) square_rays: Option<SquareRays>,
}

impl Memory {
    /// This thread's; to be given back.
    pub(super) fn take() -> Self {
        let new = || Self {
            scratch: Scratch::new(),
            walk_stacks: vec![WalkStack::new(); BATCH],
            packets: Vec::new(),
            searcher: Searcher::new(),
            square: None,
            square_rays: None,
        };
        MEMORY.take().unwrap_or_else(new)
    }

    pub(super) fn give_back(self) {
        MEMORY.set(Some(self));
    }
}

struct Single<'a, Q>(&'a Scene, &'a Ray, Q);

impl<Q: Quest> Kernel for Single<'_, Q> {
    type Output = Q;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Q {
        let Self(scene, ray, quest) = self;
        let mut memory = Memory::take();
        let quest = l.call(SingleRay::new(&mut memory, scene, ray, quest));
        memory.give_back();
        quest
    }
}

/// One ray through the scene, by single-ray traversal.
pub(super) struct SingleRay<'a, Q> {
    memory: &'a mut Memory,
    scene: &'a Scene,
    ray: &'a Ray,
    /// What the ray has met already, at `t_max` or before.
    quest: Q,
    t_max: f64,
    /// Whether to skip an object, by its number; objects beyond the end are not skipped.
    is_skipped: &'a [bool],
}

impl<'a, Q: Quest> SingleRay<'a, Q> {
    pub(super) fn new(memory: &'a mut Memory, scene: &'a Scene, ray: &'a Ray, quest: Q) -> Self {
        Self {
            memory,
            scene,
            ray,
            quest,
            t_max: f64::INFINITY,
            is_skipped: &[],
        }
    }
}

impl<'a> SingleRay<'a, FirstHit> {
    /// The same ray after it has met `known`, among the objects that are not skipped.
    pub(super) fn after(self, known: Hit, is_skipped: &'a [bool]) -> Self {
        Self {
            quest: FirstHit(known),
            t_max: clear_of(known.t),
            is_skipped,
            ..self
        }
    }
}

impl<Q: Quest> Kernel for SingleRay<'_, Q> {
    type Output = Q;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Q {
        let Memory {
            scratch,
            walk_stacks,
            ..
        } = self.memory;
        let stack = &mut walk_stacks[0];
        let scene = self.scene;
        let mut journey = Journey::new(scene, self.ray, self.quest, self.t_max);
        let is_wanted = |object: u32| self.is_skipped.get(object as usize) != Some(&true);
        while let Some(leg) = journey.next(l, scratch, (scene, stack), is_wanted) {
            let answer = accel::ask::<L, Q::Question>(l, scratch, (leg.tree, leg.mesh), &leg.ray);
            journey.answer(scene, answer);
        }
        journey.quest
    }
}

/// Many rays, from `first` on.
pub(super) struct Batch<'a, T> {
    pub(super) scene: &'a Scene,
    pub(super) rays: &'a dyn Rays,
    pub(super) first: usize,
    pub(super) count: usize,
    pub(super) take: T,
}

/// Takes what came of the rays of a batch, by their number in it.
pub(super) trait Take {
    /// What is asked about them.
    type Quest: Quest;
    /// Takes the answer for one of them; they come in any order.
    fn take(&mut self, index: usize, quest: &Self::Quest);
}

impl<T: Take> Kernel for Batch<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let mut memory = Memory::take();
        debug_assert!(self.count <= BATCH, "there are as many stacks as that");
        match (self.scene.objects(), plan::tileable(self.scene, 0)) {
            ([object], Some(mesh)) => self.through_mesh(l, &mut memory, object, mesh),
            _ => self.through_scene(l, &mut memory),
        }
        memory.give_back();
    }
}

impl<T: Take> Batch<'_, T> {
    /// Through the one mesh of a scene: no ray has a way to find.
    #[inline(always)]
    fn through_mesh<L: Lanes>(
        mut self,
        l: L,
        memory: &mut Memory,
        object: &Object,
        (mesh, tree): (&Mesh, &MeshTree),
    ) {
        let count = self.count;
        let packets = count.div_ceil(RAYS);
        if memory.packets.len() < packets {
            memory.packets.resize(packets, Packet::default());
        }
        let mut sixteen = [Ray::new(DVec3::ZERO, DVec3::ZERO); RAYS];
        for number in 0..packets {
            let first = number * RAYS;
            let length = (count - first).min(RAYS);
            self.rays.read(self.first + first, &mut sixteen[..length]);
            for (lane, ray) in sixteen.iter().enumerate() {
                memory.packets[number].put(lane, ray);
            }
        }
        for number in 0..packets {
            let packet = &mut memory.packets[number];
            let first = number * RAYS;
            let length = (count - first).min(RAYS);
            let plain = packet.enter(l, object.transform());
            packet.prepare(l, tree, length);
            let plain = plain & !packet.distant;
            packet.alive &= plain;
            let alive = packet.alive;
            for lane in 0..length {
                if plain >> lane & 1 == 0 {
                    let ray = self.rays.ray(self.first + first + lane);
                    let single = SingleRay::new(memory, self.scene, &ray, T::Quest::START);
                    self.take.take(first + lane, &l.call(single));
                } else if alive >> lane & 1 == 0 {
                    self.take.take(first + lane, &T::Quest::START);
                }
            }
        }
        let Memory {
            packets: all,
            searcher,
            ..
        } = memory;
        let packets = &all[..packets];
        let mut searches = Vec::with_capacity(packets.len());
        for packet in packets {
            searches.push(Search::new(tree, mesh, packet));
        }
        l.call(Searching {
            searcher,
            searches: &mut searches,
            answers: Ends(self.take),
            question: PhantomData::<<T::Quest as Quest>::Question>,
        });
    }

    /// From object to object.
    #[inline(always)]
    fn through_scene<L: Lanes>(mut self, l: L, memory: &mut Memory) {
        let scene = self.scene;
        let count = self.count;
        let mut journeys: Vec<Journey<'_, T::Quest>> = Vec::with_capacity(count);
        for index in 0..count {
            let ray = self.rays.ray(self.first + index);
            journeys.push(Journey::new(scene, &ray, T::Quest::START, f64::INFINITY));
        }
        let mut legs = Vec::with_capacity(count);
        // Those that are not yet at their ends.
        let mut left: Vec<usize> = (0..count).collect();
        loop {
            legs.clear();
            for index in left.drain(..) {
                let place = (scene, &mut memory.walk_stacks[index]);
                if let Some(leg) = journeys[index].next(l, &mut memory.scratch, place, |_| true) {
                    legs.push((index, leg));
                }
            }
            if legs.is_empty() {
                break;
            }
            legs.sort_by_key(|(_, leg)| leg.object);
            go_together(l, memory, scene, &legs, &mut journeys);
            left.extend(legs.iter().map(|(index, _)| index));
        }
        for (index, journey) in journeys.iter().enumerate() {
            self.take.take(index, &journey.quest);
        }
    }
}

/// Runs searches in a function of their own, so that packet building and top-level traversal are not compiled with them. There is
/// one function for each kind of `answers`: a common one made occlusion and shadow rays 3 to 5 % slower.
struct Searching<'r, 'a, Q, A> {
    searcher: &'r mut Searcher,
    searches: &'r mut [Search<'a>],
    answers: A,
    question: PhantomData<Q>,
}

impl<Q: Question, A: Answers<Q::Answer>> Kernel for Searching<'_, '_, Q, A> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) {
        self.searcher
            .run::<L, Q>(l, self.searches, &mut self.answers);
    }
}

/// Takes the answers in a scene of one mesh: they are final.
struct Ends<T>(T);

impl<T: Take> Answers<Answer<T>> for Ends<T> {
    #[inline(always)]
    fn take(&mut self, search: usize, lane: usize, answer: Answer<T>) {
        let quest = T::Quest::of_answer(0, answer);
        self.0.take(search * RAYS + lane, &quest);
    }
}

/// What a mesh answers.
type Answer<T> = <<<T as Take>::Quest as Quest>::Question as Question>::Answer;

/// Takes rays a leg further. Legs to the same object stand side by side.
#[inline(always)]
fn go_together<'a, L: Lanes, Q: Quest>(
    l: L,
    memory: &mut Memory,
    scene: &'a Scene,
    legs: &[(usize, Leg<'a>)],
    journeys: &mut [Journey<'a, Q>],
) {
    let mut count = 0;
    let mut firsts = Vec::with_capacity(legs.len());
    for same in legs.chunk_by(|(_, a), (_, b)| a.object == b.object) {
        for chunk in same.chunks(RAYS) {
            if memory.packets.len() == firsts.len() {
                memory.packets.push(Packet::default());
            }
            let packet = &mut memory.packets[firsts.len()];
            for (lane, (_, leg)) in chunk.iter().enumerate() {
                packet.put(lane, &leg.ray);
            }
            firsts.push((count, chunk.len()));
            count += chunk.len();
        }
    }
    for (packet, &(first, length)) in memory.packets.iter_mut().zip(&firsts) {
        packet.prepare(l, legs[first].1.tree, length);
    }
    let search = |(packet, &(first, _)): (_, &(usize, usize))| {
        let Leg { tree, mesh, .. } = legs[first].1;
        Search::new(tree, mesh, packet)
    };
    let mut searches: Vec<Search<'_>> = memory.packets.iter().zip(&firsts).map(search).collect();
    let arrivals = Arrivals {
        scene,
        legs,
        firsts: &firsts,
        journeys,
    };
    l.call(Searching {
        searcher: &mut memory.searcher,
        searches: &mut searches,
        answers: arrivals,
        question: PhantomData::<Q::Question>,
    });
}

/// Takes the answers of one object: the rays go on to the next.
struct Arrivals<'r, 'a, Q> {
    scene: &'a Scene,
    legs: &'r [(usize, Leg<'a>)],
    /// The first leg of each search.
    firsts: &'r [(usize, usize)],
    journeys: &'r mut [Journey<'a, Q>],
}

impl<Q: Quest> Answers<<Q::Question as Question>::Answer> for Arrivals<'_, '_, Q> {
    #[inline(always)]
    fn take(&mut self, search: usize, lane: usize, answer: <Q::Question as Question>::Answer) {
        let (index, _) = self.legs[self.firsts[search].0 + lane];
        self.journeys[index].answer(self.scene, answer);
    }
}
