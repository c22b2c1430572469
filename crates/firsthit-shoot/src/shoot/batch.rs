//! Many rays through the trees.

use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::Range;

use super::filter::{self, Place};
use super::instances::through_objects;
use super::neighbours::Neighbours;
use super::ray_query::{RayQuery, Sink};
use super::ray_state::RayState;
use super::scene_packet::ScenePacket;
use super::scene_walk::SceneWalk;
use super::single::SingleRay;
use super::start::met_at_start;
use crate::accel::{
    self, Dispatcher, InstructionSet, MeshPacket, MeshQuery, MeshTree, Packet, RAYS, Scratch,
    WalkStack,
};
use crate::error::Result;
use crate::geometry::{DVec3, Ray, Rays, SurfaceId};
use crate::parallel;
use crate::scene::{Group, ObjectCandidates, Scene};
use crate::shape::Meshes;
use crate::shape::triangle::MeshFilter;
use crate::simd::{self, Kernel, Lanes};
use crate::watch::{Watch, stop_if_asked};

/// The most rays that a thread takes at a time: enough to be worth it, few enough to stop within a
/// moment.
pub(super) const BATCH: usize = 1024;

/// Rays that need have nothing in common, by all threads of the current rayon pool.
// Its name must stand in programs that have packets; see the test below.
#[inline(never)]
pub(super) fn trace_array<S: Sink>(
    set: InstructionSet,
    scene: &Scene,
    rays: &dyn Rays,
    sink: S,
    watch: &dyn Watch,
) -> Result<()> {
    each_chunk(sink, BATCH, watch, |index, sink| {
        fill_batch(set, scene, rays, index * BATCH, sink);
    })
}

/// Fills a sink for at most [`BATCH`] rays, from `first` on.
pub(super) fn fill_batch<S: Sink>(
    set: InstructionSet,
    scene: &Scene,
    rays: &dyn Rays,
    first: usize,
    sink: S,
) {
    let batch = Batch { scene, rays, first, sink };
    simd::run(set, batch);
}

/// Fills a sink, `size` rays at a time, by all threads of the current rayon pool.
pub(super) fn each_chunk<S: Sink>(
    sink: S,
    size: usize,
    watch: &dyn Watch,
    fill: impl Fn(usize, S) + Sync,
) -> Result<()> {
    let fill = |(index, chunk): (usize, S)| {
        stop_if_asked(watch)?;
        let count = chunk.len() as u64;
        fill(index, chunk);
        watch.advance(count);
        Ok(())
    };
    let chunks = sink.chunks(size.max(1));
    parallel::try_each(chunks.into_iter().enumerate(), fill)
}

thread_local! {
    /// Made once for each thread.
    static MEMORY: Cell<Option<Memory>> = const { Cell::new(None) };
}

/// Memory for traversals, to be used again.
pub(super) struct Memory {
    pub(super) scratch: Scratch,
    /// One for each ray of a batch.
    pub(super) walk_stacks: Vec<WalkStack>,
    /// The filter of each filtered ray of a batch at the mesh that it is at.
    pub(super) in_meshes: Vec<MeshFilter>,
    pub(super) packets: Vec<Packet>,
    pub(super) dispatcher: Dispatcher,
}

impl Memory {
    /// Takes this thread's memory; to be given back.
    pub(super) fn take() -> Self {
        let new = || Self {
            scratch: Scratch::default(),
            walk_stacks: vec![WalkStack::new(); BATCH],
            in_meshes: Vec::new(),
            packets: Vec::new(),
            dispatcher: Dispatcher::default(),
        };
        MEMORY.take().unwrap_or_else(new)
    }

    pub(super) fn give_back(self) {
        MEMORY.set(Some(self));
    }

    /// Makes room for `count` packets.
    #[inline(never)]
    pub(super) fn hold_packets(&mut self, count: usize) {
        if self.packets.len() < count {
            self.packets.resize(count, Packet::default());
        }
    }

    /// Makes room for the mesh filters of `rays` rays.
    #[inline(never)]
    pub(super) fn hold_filters(&mut self, rays: usize) {
        if self.in_meshes.len() < rays {
            self.in_meshes.resize(rays, MeshFilter::NONE);
        }
    }
}

/// Many rays, from `first` on, as many as the sink is for.
struct Batch<'a, S> {
    scene: &'a Scene,
    rays: &'a dyn Rays,
    first: usize,
    sink: S,
}

impl<S: Sink> Kernel for Batch<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let mut memory = Memory::take();
        debug_assert!(self.sink.len() <= BATCH, "there are as many stacks as that");
        // All crossings with filters are asked for so rarely that packets would not repay their
        // machine code.
        if !L::HAS_PACKETS || (S::Query::ALL && S::Query::IS_FILTERED) {
            self.one_by_one(l, &mut memory);
            return memory.give_back();
        }
        let only = self.scene.only_object();
        let only = only.and_then(|only| Some((only, self.scene.plain_mesh(only)?)));
        match only {
            Some((object, mesh)) => self.through_mesh(l, &mut memory, object, mesh),
            None => self.through_scene(l, &mut memory),
        }
        memory.give_back();
    }
}

impl<S: Sink> Batch<'_, S> {
    /// Traces the rays by single-ray traversal.
    #[inline(always)]
    fn one_by_one<L: Lanes>(mut self, l: L, memory: &mut Memory) {
        for index in 0..self.sink.len() {
            let ray = self.rays.ray(self.first + index);
            let query = S::Query::begin(self.rays, self.first + index);
            let single = SingleRay::new(memory, self.scene, &ray, query);
            self.sink.put(index, &l.call(single));
        }
    }

    /// Through the only mesh of a scene, or the only one that is joined of several: there is no
    /// top-level traversal.
    #[inline(always)]
    fn through_mesh<L: Lanes>(
        mut self,
        l: L,
        memory: &mut Memory,
        index: u32,
        (mesh, tree): (Meshes<'_>, &MeshTree),
    ) {
        let object = &self.scene.objects()[index as usize];
        let count = self.sink.len();
        let packets = count.div_ceil(RAYS);
        memory.hold_packets(packets);
        self.read(&mut memory.packets[..packets]);
        for number in 0..packets {
            let packet = &mut memory.packets[number];
            let first = number * RAYS;
            let length = (count - first).min(RAYS);
            self.prefetch(l, first, length);
            let mut plain = packet.enter(l, object.transform());
            let mut unseen = 0;
            if S::Query::IS_FILTERED {
                let at_mesh = (self.scene, index, (mesh, tree));
                let lanes = self.first + first..self.first + first + length;
                let (easy, hidden) = set_filters(packet, at_mesh, self.rays, lanes);
                plain &= easy;
                unseen = hidden;
                packet.prepare_filtered(l, tree, length);
            } else {
                packet.prepare(l, tree, length);
            }
            let plain = plain & !packet.distant;
            packet.alive &= plain & !unseen;
            let alive = packet.alive;
            for lane in 0..length {
                if plain >> lane & 1 == 0 {
                    let ray = self.rays.ray(self.first + first + lane);
                    let query = S::Query::begin(self.rays, self.first + first + lane);
                    let single = SingleRay::new(memory, self.scene, &ray, query);
                    self.sink.put(first + lane, &l.call(single));
                } else if alive >> lane & 1 == 0 {
                    self.sink.put(first + lane, &S::Query::START);
                }
            }
        }
        let Memory { packets: all, dispatcher, .. } = memory;
        let packets = &all[..packets];
        let mut at_mesh = Vec::with_capacity(packets.len());
        for packet in packets {
            at_mesh.push(MeshPacket::new(tree, mesh, packet));
        }
        let sink = OfMesh(index, self.scene.group_led_by(index), self.sink);
        dispatch::<L, S::Query>(l, dispatcher, &mut at_mesh, sink);
    }

    /// Puts the rays into packets.
    #[inline(always)]
    fn read(&self, packets: &mut [Packet]) {
        let count = self.sink.len();
        let mut sixteen = [Ray::new(DVec3::ZERO, DVec3::ZERO); RAYS];
        for (packet, first) in packets.iter_mut().zip((0..count).step_by(RAYS)) {
            let length = (count - first).min(RAYS);
            self.rays.read(self.first + first, &mut sixteen[..length]);
            for (lane, ray) in sixteen.iter().enumerate() {
                packet.put(lane, ray);
            }
        }
    }

    /// Prefetches rays of the next batch, which this thread mostly takes: `count`, at the same
    /// places as those from `start` on in this one.
    #[inline(always)]
    fn prefetch<L: Lanes>(&self, l: L, start: usize, count: usize) {
        let Some(rays) = self.rays.array() else {
            return;
        };
        let next = self.first + self.sink.len() + start;
        for ray in rays.iter().skip(next).take(count) {
            l.prefetch(ray);
        }
    }

    /// Traces the rays from object to object.
    #[inline(always)]
    fn through_scene<L: Lanes>(mut self, l: L, memory: &mut Memory) {
        let scene = self.scene;
        let count = self.sink.len();
        // Those that may meet more than lone shapes, and the numbers of their rays.
        let mut walks: Vec<SceneWalk<'_, S::Query>> = Vec::new();
        let mut numbers = Vec::new();
        // Neighbours that go together, and the rays that go alone and may meet more.
        let (mut together, mut left) = (Vec::new(), Vec::new());
        let mut rays = [Ray::new(DVec3::ZERO, DVec3::ZERO); RAYS];
        for start in (0..count).step_by(RAYS) {
            let first = walks.len();
            let rays = &mut rays[..RAYS.min(count - start)];
            self.rays.read(self.first + start, rays);
            self.prefetch(l, start, rays.len());
            let mut neighbours = Neighbours::new(rays, (self.rays, self.first + start));
            let listed = neighbours.meet_shapes(l, scene);
            let has_more = listed.is_none_or(|it| it.has_others() || S::Query::ALL);
            for (index, number) in (start..start + rays.len()).enumerate() {
                let known = neighbours.known(index);
                if has_more && known.is_none_or(RayState::is_open) {
                    let among = |listed| ObjectCandidates::among(listed, S::Query::ALL);
                    let objects = listed.map_or_else(|| scene.candidates(), among);
                    if walks.is_empty() {
                        walks.reserve(count - start);
                        numbers.reserve(count - start);
                    }
                    walks.push(SceneWalk::new(neighbours.take(index), objects));
                    numbers.push(number);
                } else {
                    match known {
                        Some(state) => self.sink.put(number, &state.query),
                        None => self.sink.put(number, &S::Query::START),
                    }
                }
            }
            // With a list there is no tree to walk.
            let stack = memory.walk_stacks.get_mut(first).filter(|_| listed.is_none());
            match stack.and_then(|stack| ScenePacket::new(scene, &mut walks, first, stack)) {
                Some(packet) => together.push(packet),
                None => left.extend(first..walks.len()),
            }
        }
        through_objects(l, memory, scene, (together, left), &mut walks);
        for (number, walk) in numbers.into_iter().zip(&walks) {
            self.sink.put(number, &walk.state.query);
        }
    }
}

/// Sets the filters of some rays that have entered the only mesh of a scene. Returns the rays whose
/// filter does not matter there, a bit each, and those that do not see the object.
fn set_filters(
    packet: &mut Packet,
    (scene, index, (mesh, tree)): (&Scene, u32, (Meshes<'_>, &MeshTree)),
    rays: &dyn Rays,
    range: Range<usize>,
) -> (u16, u16) {
    let object = &scene.objects()[index as usize];
    let place = Place::Leader(index);
    let (mut easy, mut unseen) = (0, 0);
    for (lane, number) in range.enumerate() {
        let whole = rays.filter(number);
        unseen |= u16::from(!filter::sees_any(scene, &whole, index, object)) << lane;
        let ray = packet.ray(lane);
        let filter = packet.filter_mut(lane);
        filter::set_mesh_filter(filter, scene, &whole, place);
        let departure = filter.departure();
        let is_easy = match departure {
            Some(point) => {
                tree.is_sharp_from(point)
                    && met_at_start(scene, &whole, (place, &ray, filter)).is_none()
            }
            // It leaves no triangle of this mesh.
            None => whole.departure.is_none(),
        };
        let is_behind = is_easy && filter.leaves_all_of(mesh);
        unseen |= u16::from(is_behind) << lane;
        let start = departure.map(|point| point.rounded);
        if !is_easy {
            // What is unsure of one ray widens the bounds of all.
            *filter = MeshFilter::NONE;
        }
        if let Some(start) = start {
            packet.set_origin(lane, start);
        }
        easy |= u16::from(is_easy) << lane;
    }
    (easy, unseen)
}

/// Takes rays through the meshes that they have come to, and puts the answers into `sink`.
///
/// The traversals are compiled for each kind of sink: a common one made occlusion and shadow rays 3
/// to 5 % slower. Those of rare queries have it behind a pointer.
#[inline(always)]
pub(super) fn dispatch<L: Lanes, Q: RayQuery>(
    l: L,
    dispatcher: &mut Dispatcher,
    packets: &mut [MeshPacket<'_>],
    mut sink: impl accel::Sink<MeshAnswer<Q>>,
) {
    if Q::ALL || Q::IS_FILTERED {
        let sink: &mut dyn accel::Sink<_> = &mut sink;
        l.call(Dispatch::<Q::InMesh, _>(dispatcher, packets, sink, PhantomData));
    } else {
        l.call(Dispatch::<Q::InMesh, _>(dispatcher, packets, &mut sink, PhantomData));
    }
}

/// A function of its own, so that packet building and top-level traversal are not compiled with
/// traversals of meshes.
struct Dispatch<'r, 'a, Q: MeshQuery, S: ?Sized>(
    &'r mut Dispatcher,
    &'r mut [MeshPacket<'a>],
    &'r mut S,
    PhantomData<Q>,
);

impl<Q: MeshQuery, S: accel::Sink<Q::Found> + ?Sized> Kernel for Dispatch<'_, '_, Q, S> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self(dispatcher, packets, sink, _) = self;
        dispatcher.run::<L, Q>(l, packets, sink);
    }
}

/// Takes the answers in a scene of one mesh, that of an object or of a group which it leads: they
/// are final.
struct OfMesh<'a, S>(u32, Option<&'a Group>, S);

impl<S: Sink> accel::Sink<MeshAnswer<S::Query>> for OfMesh<'_, S> {
    #[inline(always)]
    fn put(&mut self, packet: usize, lane: usize, found: MeshAnswer<S::Query>) {
        let Self(object, group, sink) = self;
        let (object, group) = (*object, *group);
        let surface = |primitive| match group {
            Some(group) => group.surface(primitive),
            None => SurfaceId { object: object.cast_signed(), primitive },
        };
        sink.put(packet * RAYS + lane, &S::Query::of_mesh(surface, found));
    }
}

/// The answer of a mesh.
pub(super) type MeshAnswer<Q> = <<Q as RayQuery>::InMesh as MeshQuery>::Found;

#[cfg(test)]
mod tests {
    /// A unit test that traces rays has all packets compiled for it once more, which takes as long
    /// as the library. `tests/it` has them.
    #[test]
    fn no_unit_test_has_packets_compiled() {
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let holds = |name: &str| {
            // The whole name would stand in the program for being named here.
            let name = name.replace('-', "");
            program.windows(name.len()).any(|bytes| bytes == name.as_bytes())
        };
        // It has symbols.
        assert!(holds("5batch5tests-33no_unit_test_has_packets_compiled"));
        assert!(!holds("5shoot5batch-11trace_array"));
    }
}
