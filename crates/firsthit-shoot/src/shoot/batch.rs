//! Many rays through the trees.

use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::Range;

use super::filter::{self, Place};
use super::instances::Instances;
use super::neighbours::Neighbours;
use super::ray_query::{RayQuery, Sink};
use super::ray_state::RayState;
use super::scene_packet::ScenePacket;
use super::scene_walk::SceneWalk;
use super::single::SingleRay;
use super::start::met_at_start;
use crate::accel::{
    self, InstructionSet, MeshPacket, MeshQuery, MeshTree, Packet, RAYS, Scratch, Traversal,
    TraversalMemory, WalkStack, Walks, lowest,
};
use crate::error::Result;
use crate::geometry::{DVec3, Ray, Rays, SurfaceId};
use crate::parallel;
use crate::scene::{Group, ObjectCandidates, Scene};
use crate::shape::Meshes;
use crate::shape::triangle::MeshFilter;
use crate::simd::{self, Kernel, Lanes, set_bits};
use crate::watch::{Watch, stop_if_asked};

/// The most rays that a thread takes at a time: enough to be worth it, few enough to stop within a
/// moment.
pub(super) const BATCH: usize = 1024;

/// Traces any rays, by all threads of the current rayon pool.
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

/// Whether all threads have enough of so many bands of a picture; with fewer, one of them would be
/// waited for.
pub(super) fn are_enough(bands: usize) -> bool {
    bands >= 8 * rayon::current_num_threads()
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

/// Rays that go alone among many objects are as many at a time: enough for each to wait while
/// others go on, few enough for the nearest caches.
const IN_FLIGHT: usize = 128;

thread_local! {
    /// Made once for each thread.
    static MEMORY: Cell<Option<Memory>> = const { Cell::new(None) };
}

/// Memory for traversals, to be used again.
pub(super) struct Memory {
    pub(super) scratch: Scratch,
    /// The ways of rays that go alone through the tree over the objects.
    pub(super) walks: Walks,
    /// One for each packet that goes there, by the number of its first ray's walk.
    pub(super) walk_stacks: Vec<WalkStack>,
    /// The filter of each filtered ray of a batch at the mesh that it is at.
    pub(super) in_meshes: Vec<MeshFilter>,
    pub(super) packets: Vec<Packet>,
    pub(super) traversals: TraversalMemory,
}

impl Memory {
    /// Takes this thread's memory; to be given back.
    pub(super) fn take() -> Self {
        let new = || Self {
            scratch: Scratch::default(),
            walks: Walks::default(),
            walk_stacks: vec![WalkStack::new(); BATCH],
            in_meshes: Vec::new(),
            packets: Vec::new(),
            traversals: TraversalMemory::default(),
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
        self,
        l: L,
        memory: &mut Memory,
        index: u32,
        (mesh, tree): (Meshes<'_>, &MeshTree),
    ) {
        let Self { scene, rays, first: start, .. } = self;
        let object = &scene.objects()[index as usize];
        let count = self.sink.len();
        memory.hold_packets(count.div_ceil(RAYS));
        let Memory { packets, traversals, .. } = &mut *memory;
        let (mut traversal, mut at_mesh) = (Traversal::new(traversals), Vec::new());
        at_mesh.reserve_exact(count.div_ceil(RAYS));
        // The rays that packets do not serve.
        let mut alone = Vec::new();
        let mut sink = OfMesh(index, scene.group_led_by(index), self.sink);
        let mut sixteen = [Ray::new(DVec3::ZERO, DVec3::ZERO); RAYS];
        for (packet, first) in packets.iter_mut().zip((0..count).step_by(RAYS)) {
            let length = (count - first).min(RAYS);
            let here = start + first..start + first + length;
            if let Some(array) = rays.array() {
                packet.put_rays(l, &array[here]);
            } else {
                rays.read(here.start, &mut sixteen[..length]);
                packet.put_rays(l, &sixteen[..length]);
            }
            prefetch(l, rays, start + count + first, length);
            let mut plain = packet.enter(l, object.transform());
            let mut unseen = 0;
            if S::Query::IS_FILTERED {
                let at_mesh = (scene, index, (mesh, tree));
                let lanes = start + first..start + first + length;
                let (easy, hidden) = set_filters(packet, at_mesh, rays, lanes);
                plain &= easy;
                unseen = hidden;
                packet.prepare_filtered(l, tree, length);
            } else {
                packet.prepare(l, tree, length);
            }
            let plain = plain & !packet.distant;
            packet.alive &= plain & !unseen;
            let all = lowest(length);
            for lane in set_bits(all & !plain) {
                alone.push(first + lane);
            }
            for lane in set_bits(all & plain & !packet.alive) {
                sink.2.put(first + lane, &S::Query::START);
            }
            let mut packet = MeshPacket::new(tree, mesh, packet);
            let numbered = (at_mesh.len(), &mut packet);
            try_together::<L, S::Query>(l, &mut traversal, numbered, &mut sink);
            at_mesh.push(packet);
        }
        finish::<L, S::Query>(l, &mut traversal, &at_mesh, &mut sink);
        for number in alone {
            let ray = rays.ray(start + number);
            let query = S::Query::begin(rays, start + number);
            sink.2.put(number, &l.call(SingleRay::new(memory, scene, &ray, query)));
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
        let mut instances = Instances::default();
        let mut rays = [Ray::new(DVec3::ZERO, DVec3::ZERO); RAYS];
        for start in (0..count).step_by(RAYS) {
            let first = walks.len();
            let rays = &mut rays[..RAYS.min(count - start)];
            self.rays.read(self.first + start, rays);
            prefetch(l, self.rays, self.first + count + start, rays.len());
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
            match stack.and_then(|stack| ScenePacket::new(l, scene, &mut walks, first, stack)) {
                Some(packet) => together.push(packet),
                None => left.extend(first..walks.len()),
            }
            let is_last = start + RAYS >= count;
            if is_last || (listed.is_none() && left.len() >= IN_FLIGHT) {
                let mut none = Vec::new();
                let (packets, most) =
                    if is_last { (&mut together, 0) } else { (&mut none, IN_FLIGHT - RAYS) };
                instances.pass(l, memory, scene, (packets, &mut left), &mut walks, most);
            }
        }
        for (number, walk) in numbers.into_iter().zip(&walks) {
            self.sink.put(number, &walk.state.query);
        }
    }
}

/// Prefetches `count` rays from `first` on: those of the next batch, which this thread mostly
/// takes.
#[inline(always)]
fn prefetch<L: Lanes>(l: L, rays: &dyn Rays, first: usize, count: usize) {
    for ray in rays.array().unwrap_or_default().iter().skip(first).take(count) {
        l.prefetch(ray);
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
            // The error of one ray widens the bounds of all.
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
#[inline(always)]
pub(super) fn dispatch<L: Lanes, Q: RayQuery>(
    l: L,
    traversals: &mut TraversalMemory,
    packets: &mut [MeshPacket<'_>],
    mut sink: impl accel::Sink<MeshAnswer<Q>>,
) {
    let mut traversal = Traversal::new(traversals);
    for packet in packets.iter_mut().enumerate() {
        try_together::<L, Q>(l, &mut traversal, packet, &mut sink);
    }
    finish::<L, Q>(l, &mut traversal, packets, &mut sink);
}

/// Tries a packet, by its number, as soon as it is ready: its rays are in the nearest cache still.
///
/// The traversals are compiled for each kind of sink: a common one made occlusion and shadow rays 3
/// to 5 % slower. Those of rare queries have it behind a pointer.
#[inline(always)]
fn try_together<'a, L: Lanes, Q: RayQuery>(
    l: L,
    traversal: &mut Traversal<'_, 'a>,
    packet: (usize, &mut MeshPacket<'a>),
    sink: &mut impl accel::Sink<MeshAnswer<Q>>,
) {
    if Q::ALL || Q::IS_FILTERED {
        let sink: &mut dyn accel::Sink<_> = sink;
        l.call(TryTogether::<Q::InMesh, _>(traversal, packet, sink, PhantomData));
    } else {
        l.call(TryTogether::<Q::InMesh, _>(traversal, packet, sink, PhantomData));
    }
}

/// Answers the rays of all packets that are open still, likewise.
#[inline(always)]
fn finish<'a, L: Lanes, Q: RayQuery>(
    l: L,
    traversal: &mut Traversal<'_, 'a>,
    packets: &[MeshPacket<'a>],
    sink: &mut impl accel::Sink<MeshAnswer<Q>>,
) {
    if Q::ALL || Q::IS_FILTERED {
        let sink: &mut dyn accel::Sink<_> = sink;
        l.call(Finish::<Q::InMesh, _>(traversal, packets, sink, PhantomData));
    } else {
        l.call(Finish::<Q::InMesh, _>(traversal, packets, sink, PhantomData));
    }
}

/// The kernel of [`try_together`], apart so that packet building and top-level traversal are not
/// compiled with traversals of meshes.
struct TryTogether<'r, 'd, 'a, Q: MeshQuery, S: ?Sized>(
    &'r mut Traversal<'d, 'a>,
    (usize, &'r mut MeshPacket<'a>),
    &'r mut S,
    PhantomData<Q>,
);

impl<Q: MeshQuery, S: accel::Sink<Q::Found> + ?Sized> Kernel for TryTogether<'_, '_, '_, Q, S> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self(traversal, packet, sink, _) = self;
        traversal.try_together::<L, Q>(l, packet, sink);
    }
}

/// The kernel of [`finish`], likewise.
struct Finish<'r, 'd, 'a, Q: MeshQuery, S: ?Sized>(
    &'r mut Traversal<'d, 'a>,
    &'r [MeshPacket<'a>],
    &'r mut S,
    PhantomData<Q>,
);

impl<Q: MeshQuery, S: accel::Sink<Q::Found> + ?Sized> Kernel for Finish<'_, '_, '_, Q, S> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self(traversal, packets, sink, _) = self;
        traversal.finish::<L, Q>(l, packets, sink);
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
