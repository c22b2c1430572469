//! Neighbouring rays on their way through a scene together: the top-level traversal of packets.
//!
//! 1. Take the next object that any of the rays may meet, and the rays that may meet it.
//! 2. Take these into the space of a mesh, all at once.
//! 3. Where that does not serve, the rays come to the object one by one, as `scene_walk.rs` has it.

use std::ops::Range;

use super::ray_query::RayQuery;
use super::scene_walk::SceneWalk;
use crate::accel::{FEWEST, MeshTree, Packet, RAYS, WalkStack};
use crate::geometry::Transform;
use crate::scene::{PacketCandidates, Scene};
use crate::shape::Meshes;
use crate::simd::{Kernel, Lanes, set_bits};

/// See [the module](self).
pub(super) struct ScenePacket<'a> {
    /// The numbers of the rays' walks.
    walks: Range<usize>,
    objects: PacketCandidates<'a>,
}

/// A mesh that rays of a packet have entered.
pub(super) struct EnteredMesh<'a> {
    pub(super) object: u32,
    pub(super) mesh: Meshes<'a>,
    pub(super) tree: &'a MeshTree,
    /// The number of the walk of the packet's first ray.
    pub(super) first: usize,
}

impl<'a> ScenePacket<'a> {
    /// A packet of the rays with the walks from `first` on; `None` where their ways differ too
    /// much.
    pub(super) fn new<Q: RayQuery>(
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
        let rays = walks.iter().filter_map(|walk| walk.state.ray());
        let objects = scene.packet_candidates(rays, stack)?;
        walks.iter_mut().for_each(SceneWalk::join);
        Some(Self { walks: first..end, objects })
    }

    /// The number of its first walk.
    pub(super) fn first(&self) -> usize {
        self.walks.start
    }

    /// Advances to the next object; returns `false` where none is left. Rays that enter a mesh go
    /// into `packet`, and `entered` says so; the numbers of those that come to it one by one go to
    /// `alone`.
    #[inline(always)]
    pub(super) fn step<L: Lanes, Q: RayQuery>(
        &mut self,
        l: L,
        scene: &'a Scene,
        walks: &mut [SceneWalk<'a, Q>],
        (packet, stack): (&mut Packet, &mut WalkStack),
        (entered, alone): (&mut Vec<EnteredMesh<'a>>, &mut Vec<usize>),
    ) -> bool {
        let first = self.walks.start;
        let walks = &mut walks[self.walks.clone()];
        let mut limits = [-1.0; RAYS];
        for (limit, walk) in limits.iter_mut().zip(&*walks) {
            *limit = walk.state.t_max;
        }
        while let Some((index, met)) = self.objects.next(l, &limits, stack) {
            let object = &scene.objects()[index as usize];
            let plain = scene.plain_mesh(index);
            let (mut easy, mut has_entered) = (0, false);
            if let Some((mesh, tree)) = plain.filter(|_| !object.is_out_of_range()) {
                for lane in set_bits(met) {
                    if let Some(ray) = walks[lane].state.ray() {
                        packet.put(lane, &ray.up_to(limits[lane].min(ray.t_max)));
                    }
                }
                let enter = Enter { packet, tree, transform: object.transform(), met };
                easy = l.call(enter);
                has_entered = packet.alive != 0;
                if has_entered {
                    entered.push(EnteredMesh { object: index, mesh, tree, first });
                }
            }
            for lane in set_bits(met & !easy) {
                walks[lane].come_to(index);
                alone.push(first + lane);
            }
            if has_entered || met != easy {
                return true;
            }
        }
        false
    }
}

/// Transforms the rays of a packet into the space of a mesh. Returns those that the traversals of
/// packets can take. It is compiled once for all queries.
struct Enter<'r> {
    packet: &'r mut Packet,
    tree: &'r MeshTree,
    transform: &'r Transform,
    /// The rays that may meet the mesh.
    met: u16,
}

impl Kernel for Enter<'_> {
    type Output = u16;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> u16 {
        let Self { packet, tree, transform, met } = self;
        let plain = packet.enter(l, transform);
        let count = RAYS - met.leading_zeros() as usize;
        packet.prepare(l, tree, count);
        let easy = met & plain & !packet.distant;
        packet.alive &= easy;
        easy
    }
}
