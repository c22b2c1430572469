//! Neighbouring rays on their way through a scene together: the top-level traversal of packets.
//!
//! 1. Take the next object that any of the rays may meet, and the rays that may meet it. Ask memory
//!    for it, and do as much for the other packets.
//! 2. Take these rays into the space of a mesh, all at once. Leave out those that meet no box of
//!    the root of its tree; where none is left, go on with step 1.
//! 3. Where that does not serve, the rays come to the object one by one, as `scene_walk.rs` has it.

use std::ops::Range;

use super::batch::Memory;
use super::ray_query::RayQuery;
use super::scene_walk::SceneWalk;
use crate::accel::{FEWEST, MeshTree, Packet, RAYS, WalkStack, WorldRays};
use crate::geometry::Transform;
use crate::scene::{PacketCandidates, Scene};
use crate::shape::Meshes;
use crate::simd::{Kernel, Lanes, set_bits};

/// See [the module](self).
pub(super) struct ScenePacket<'a> {
    /// The numbers of the rays' walks.
    walks: Range<usize>,
    rays: WorldRays,
    /// Beyond these nothing matters to a ray; below zero nothing does at all.
    limits: [f64; RAYS],
    objects: PacketCandidates<'a>,
    /// The next object, and the rays that may meet it, a bit each; `None` where none is left.
    next: Option<(u32, u16)>,
}

/// A mesh that rays of a packet have entered.
pub(super) struct EnteredMesh<'a> {
    pub(super) object: u32,
    pub(super) mesh: Meshes<'a>,
    pub(super) tree: &'a MeshTree,
    /// The number of the walk of the packet's first ray.
    pub(super) first: usize,
    /// Whether the rays are so far apart that each meets leaves of its own.
    pub(super) is_scattered: bool,
}

impl<'a> ScenePacket<'a> {
    /// A packet of the rays with the walks from `first` on; `None` where their ways differ too
    /// much.
    #[inline(always)]
    pub(super) fn new<L: Lanes, Q: RayQuery>(
        l: L,
        scene: &'a Scene,
        walks: &mut [SceneWalk<'a, Q>],
        first: usize,
        stack: &mut WalkStack,
    ) -> Option<Self> {
        let end = walks.len();
        let walks = &mut walks[first..];
        if Q::ALL || Q::IS_FILTERED || walks.len() < FEWEST as usize {
            return None;
        }
        // Most rays that do not go together tell so at a glance.
        let side = |walk: &SceneWalk<'_, Q>| {
            let scaled = walk.state.scaled.as_ref();
            let scaled = scaled.filter(|scaled| scaled.t_scale == 1.0)?;
            Some(scaled.ray.direction.is_negative_bitmask())
        };
        let first_side = side(&walks[0])?;
        if walks.iter().any(|walk| side(walk) != Some(first_side)) {
            return None;
        }
        let rays = WorldRays::new(walks.iter().filter_map(|walk| walk.state.ray()));
        let objects = scene.packet_candidates(l, (&rays, walks.len()), stack)?;
        walks.iter_mut().for_each(SceneWalk::join);
        Some(Self { walks: first..end, rays, limits: [-1.0; RAYS], objects, next: None })
    }

    /// Advances packets, each to the next mesh that rays of it enter, or to an object that rays
    /// come to one by one: the numbers of these go to `alone`. Rays that enter a mesh go into a
    /// packet of `memory`, and `entered` says so. Packets without more objects are dropped.
    #[inline(always)]
    pub(super) fn step_all<L: Lanes, Q: RayQuery>(
        l: L,
        scene: &'a Scene,
        walks: &mut [SceneWalk<'a, Q>],
        (memory, together): (&mut Memory, &mut Vec<Self>),
        (entered, alone): (&mut Vec<EnteredMesh<'a>>, &mut Vec<usize>),
    ) {
        let mut waiting: Vec<usize> = (0..together.len()).collect();
        while !waiting.is_empty() {
            waiting.retain(|&number| {
                let rays = &mut together[number];
                // No ray of a packet that walks alone has objects of its own, so it needs no stack.
                rays.find_next(l, scene, walks, &mut memory.walk_stacks[rays.walks.start])
            });
            waiting.retain(|&number| {
                let packet = &mut memory.packets[entered.len()];
                !together[number].enter(l, scene, walks, packet, (entered, alone))
            });
        }
        together.retain(|rays| rays.next.is_some());
    }

    /// Finds the next object, and asks memory for it; returns whether there is one.
    #[inline(always)]
    fn find_next<L: Lanes, Q: RayQuery>(
        &mut self,
        l: L,
        scene: &Scene,
        walks: &[SceneWalk<'a, Q>],
        stack: &mut WalkStack,
    ) -> bool {
        for (limit, walk) in self.limits.iter_mut().zip(&walks[self.walks.clone()]) {
            *limit = walk.state.t_max;
        }
        self.next = self.objects.next(l, &self.limits, stack);
        if let Some((index, _)) = self.next {
            l.prefetch(&scene.objects()[index as usize]);
        }
        self.next.is_some()
    }

    /// Comes to the next object; returns `false` where no ray meets anything of it.
    #[inline(always)]
    fn enter<L: Lanes, Q: RayQuery>(
        &self,
        l: L,
        scene: &'a Scene,
        walks: &mut [SceneWalk<'a, Q>],
        packet: &mut Packet,
        (entered, alone): (&mut Vec<EnteredMesh<'a>>, &mut Vec<usize>),
    ) -> bool {
        let Some((index, met)) = self.next else {
            return false;
        };
        let first = self.walks.start;
        let object = &scene.objects()[index as usize];
        let plain = scene.plain_mesh(index).filter(|_| !object.is_out_of_range());
        let (mut easy, mut has_entered) = (0, false);
        if let Some((mesh, tree)) = plain {
            let rays = (&self.rays, &self.limits, met);
            let at = (mesh, tree);
            let is_scattered;
            (easy, is_scattered) =
                l.call(Enter { packet, at, transform: object.transform(), rays });
            has_entered = packet.alive != 0;
            if has_entered {
                entered.push(EnteredMesh { object: index, mesh, tree, first, is_scattered });
            }
        }
        for lane in set_bits(met & !easy) {
            walks[first + lane].come_to(index);
            alone.push(first + lane);
        }
        has_entered || met != easy
    }
}

/// Takes rays into the space of a mesh, as the rays of `packet`, and keeps those that meet a box of
/// its root. Returns the rays that the traversals of packets can take, and whether they are
/// [scattered](Packet::is_scattered). It is compiled once for all queries.
struct Enter<'r, 'a> {
    packet: &'r mut Packet,
    at: (Meshes<'a>, &'a MeshTree),
    transform: &'r Transform,
    /// All rays, their limits, and those that may meet the mesh.
    rays: (&'r WorldRays, &'r [f64; RAYS], u16),
}

impl Kernel for Enter<'_, '_> {
    type Output = (u16, bool);

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Self::Output {
        let Self { packet, at: (mesh, tree), transform, rays: (rays, limits, met) } = self;
        packet.put_all(rays, limits);
        let plain = packet.enter(l, transform);
        packet.prepare(l, tree, RAYS - met.leading_zeros() as usize);
        let easy = met & plain & !packet.distant;
        packet.alive &= easy;
        packet.keep_at_root(l, tree);
        (easy, packet.is_scattered(mesh, tree))
    }
}
