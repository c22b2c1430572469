//! Rays through the meshes that they have come to, among many objects.
//!
//! 1. Find the next object of each ray that goes alone, through the tree over the objects.
//!    Neighbours that go together have found theirs (`scene_packet.rs`).
//! 2. Put the rays into packets. Those at one object go into one that may be traversed together, if
//!    they are enough. Most rays are alone at their objects where there are thousands: sixteen of
//!    them share a packet, with a tree for each lane, and are interleaved.
//! 3. Make them ready, and traverse the meshes.
//! 4. Hand the answers to the rays' walks, which continue with the next objects.

use super::batch::{Memory, MeshAnswer, dispatch};
use super::ray_query::RayQuery;
use super::scene_packet::{EnteredMesh, ScenePacket};
use super::scene_walk::{Instance, SceneWalk};
use crate::accel::{self, FEWEST, MeshPacket, Packet, RAYS, TreePerRay, Trees, Walks};
use crate::scene::Scene;
use crate::simd::Lanes;

/// The meshes that rays have come to. Memory to be used again.
#[derive(Default)]
pub(super) struct Instances<'a> {
    /// The meshes of packets of neighbours.
    entered: Vec<EnteredMesh<'a>>,
    /// The meshes of rays that go alone, with the numbers of the rays' walks.
    alone: Vec<(usize, Instance<'a>)>,
    packing: Packing,
    /// The trees of packets of rays that are at different ones.
    trees: Vec<TreePerRay<'a>>,
}

impl<'a> Instances<'a> {
    /// Takes rays from mesh to mesh until at most `most` may meet more: packets of neighbours that
    /// go together, and those that go alone.
    #[inline(always)]
    pub(super) fn pass<L: Lanes, Q: RayQuery>(
        &mut self,
        l: L,
        memory: &mut Memory,
        scene: &'a Scene,
        (together, left): (&mut Vec<ScenePacket<'a>>, &mut Vec<usize>),
        walks: &mut [SceneWalk<'a, Q>],
        most: usize,
    ) {
        memory.hold_filters(if Q::IS_FILTERED { walks.len() } else { 1 });
        memory.hold_packets(together.len());
        while together.len() + left.len() > most {
            self.entered.clear();
            let found = (&mut self.entered, &mut *left);
            ScenePacket::step_all(l, scene, walks, (memory, together), found);
            find_objects(l, &mut memory.walks, scene, left, walks);
            self.alone.clear();
            let mut kept = 0;
            for k in 0..left.len() {
                let index = left[k];
                let in_mesh = if Q::IS_FILTERED { index } else { 0 };
                let for_mesh = (&mut memory.scratch, &mut memory.in_meshes[in_mesh]);
                let walk = &mut walks[index];
                if let Some(instance) = walk.enter(l, for_mesh, scene) {
                    self.alone.push((index, instance));
                }
                left[kept] = index;
                kept += usize::from(walk.is_alone());
            }
            left.truncate(kept);
            self.traverse(l, memory, scene, walks);
        }
    }

    /// Takes rays through the mesh that each has come to. Packets of neighbours are made ready
    /// before, and are the first ones.
    #[inline(always)]
    fn traverse<L: Lanes, Q: RayQuery>(
        &mut self,
        l: L,
        memory: &mut Memory,
        scene: &'a Scene,
        walks: &mut [SceneWalk<'a, Q>],
    ) {
        let Self { entered, alone: instances, packing, trees } = self;
        // Where neighbours go in packets from the start (`ScenePacket::new`), others seldom go
        // together at an object, and trials cost more than they gain.
        let is_grouped = Q::ALL || Q::IS_FILTERED || scene.lists_candidates();
        packing.pack(instances, is_grouped);
        let ready = entered.len();
        memory.hold_packets(ready + packing.packets.len());
        let at_mesh = |lane: usize| {
            let Instance { tree, mesh, .. } = instances[packing.order[lane] as usize].1;
            (tree, mesh)
        };
        let apart = packing.packets.len() - packing.together;
        if trees.len() < apart
            && let Some((_, at)) = instances.first()
        {
            trees.resize(apart, TreePerRay::new((at.tree, at.mesh)));
        }
        for (number, &(first, length)) in packing.packets.iter().enumerate() {
            let packet = &mut memory.packets[ready + number];
            for lane in 0..length {
                let (index, instance) = &instances[packing.order[first + lane] as usize];
                packet.put(lane, &instance.ray);
                if Q::IS_FILTERED {
                    packet.set_filter(lane, &memory.in_meshes[*index]);
                }
            }
            if let Some(apart) = number.checked_sub(packing.together) {
                let each = &mut trees[apart];
                (0..length).for_each(|lane| each.put(lane, at_mesh(first + lane)));
                prepare::<L, Q>(l, packet, &*each, length);
            } else {
                let (tree, _) = at_mesh(first);
                prepare::<L, Q>(l, packet, tree, length);
            }
        }
        let mut packets = Vec::with_capacity(ready + packing.packets.len());
        for (packet, at) in memory.packets.iter().zip(&*entered) {
            packets.push(MeshPacket::new(at.tree, at.mesh, packet).scattered(at.is_scattered));
        }
        let others = memory.packets[ready..].iter().zip(&packing.packets);
        for (number, (packet, &(first, _))) in others.enumerate() {
            packets.push(match number.checked_sub(packing.together) {
                None => {
                    let (tree, mesh) = at_mesh(first);
                    MeshPacket::new(tree, mesh, packet)
                }
                Some(apart) => MeshPacket::apart(&trees[apart], packet),
            });
        }
        let sink = OfInstances { scene, entered, instances, packing, walks };
        dispatch::<L, Q>(l, &mut memory.traversals, &mut packets, sink);
    }
}

/// Finds the next object of each ray, and asks memory for it. Rays without any are dropped.
#[inline(always)]
fn find_objects<'a, L: Lanes, Q: RayQuery>(
    l: L,
    ways: &mut Walks,
    scene: &'a Scene,
    left: &mut Vec<usize>,
    walks: &mut [SceneWalk<'a, Q>],
) {
    let mut tree = None;
    for &index in &*left {
        tree = walks[index].look_ahead(scene, ways).or(tree);
    }
    if let Some(tree) = tree {
        ways.advance(l, tree);
    }
    let mut kept = 0;
    for k in 0..left.len() {
        let index = left[k];
        if let Some(object) = walks[index].arrive(scene, ways) {
            scene.prefetch(l, object);
            left[kept] = index;
            kept += 1;
        }
    }
    left.truncate(kept);
}

#[inline(always)]
fn prepare<L: Lanes, Q: RayQuery>(l: L, packet: &mut Packet, trees: impl Trees, length: usize) {
    if Q::IS_FILTERED {
        packet.prepare_filtered(l, trees, length);
    } else {
        packet.prepare(l, trees, length);
    }
}

/// Takes the answers of meshes: the rays continue to the next one.
struct OfInstances<'r, 'a, Q> {
    scene: &'a Scene,
    entered: &'r [EnteredMesh<'a>],
    instances: &'r [(usize, Instance<'a>)],
    packing: &'r Packing,
    walks: &'r mut [SceneWalk<'a, Q>],
}

impl<Q: RayQuery> accel::Sink<MeshAnswer<Q>> for OfInstances<'_, '_, Q> {
    #[inline(always)]
    fn put(&mut self, packet: usize, lane: usize, found: MeshAnswer<Q>) {
        let (index, object) = match packet.checked_sub(self.entered.len()) {
            None => {
                let EnteredMesh { first, object, .. } = self.entered[packet];
                (first + lane, object)
            }
            Some(packet) => {
                let place = self.packing.packets[packet].0 + lane;
                let (index, instance) = &self.instances[self.packing.order[place] as usize];
                (*index, instance.object)
            }
        };
        self.walks[index].state.take(self.scene, object, found);
    }
}

/// The packets of rays that have each come to a mesh.
#[derive(Default)]
struct Packing {
    /// The instances' objects and indices.
    sorted: Vec<u64>,
    /// The instances' indices, those of a packet side by side.
    order: Vec<u32>,
    /// The indices of those that are in packets with rays at other objects.
    apart: Vec<u32>,
    /// The start in `order` and the number of rays of each packet.
    packets: Vec<(usize, usize)>,
    /// The number of packets, which come first, with all their rays at one object.
    together: usize,
}

impl Packing {
    /// Puts rays into packets as they come, or with `is_grouped` those at one object into packets
    /// of their own, if there are [`FEWEST`] or more. It is compiled once and not for each kernel.
    #[inline(never)]
    #[expect(clippy::cast_possible_truncation, reason = "the lower half is the index")]
    fn pack(&mut self, instances: &[(usize, Instance<'_>)], is_grouped: bool) {
        let Self { sorted, order, apart, packets, together } = self;
        sorted.clear();
        order.clear();
        apart.clear();
        packets.clear();
        let numbered = (0..).zip(instances);
        sorted.extend(numbered.map(|(k, at): (u64, _)| u64::from(at.1.object) << 32 | k));
        let mut fewest = usize::MAX;
        if is_grouped {
            sorted.sort_unstable();
            fewest = FEWEST as usize;
        }
        for same in sorted.chunk_by(|a, b| a >> 32 == b >> 32) {
            for chunk in same.chunks(RAYS) {
                let indices = chunk.iter().map(|&k| k as u32);
                if chunk.len() >= fewest {
                    packets.push((order.len(), chunk.len()));
                    order.extend(indices);
                } else {
                    apart.extend(indices);
                }
            }
        }
        *together = packets.len();
        for chunk in apart.chunks(RAYS) {
            packets.push((order.len(), chunk.len()));
            order.extend(chunk);
        }
    }
}
