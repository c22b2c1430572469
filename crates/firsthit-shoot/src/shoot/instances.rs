//! Rays through the meshes that they have come to, among many objects.
//!
//! 1. Neighbours that go together are in packets already (`scene_packet.rs`). Others at one object
//!    go into a packet, which may be traversed together. Most rays are alone at their objects where
//!    there are thousands: sixteen of them share a packet, with a tree for each lane, and are
//!    interleaved.
//! 2. Make the others ready too, and traverse them.
//! 3. Hand the answers to the rays' walks, which continue with the next objects.

use super::batch::{Memory, MeshAnswer, dispatch};
use super::ray_query::RayQuery;
use super::scene_packet::{EnteredMesh, ScenePacket};
use super::scene_walk::{Instance, SceneWalk};
use crate::accel::{self, FEWEST, MeshPacket, Packet, RAYS, TreePerRay, Trees};
use crate::scene::Scene;
use crate::simd::Lanes;

/// Takes rays from mesh to mesh until none may meet more: packets of neighbours that go together,
/// and those that go alone.
#[inline(always)]
pub(super) fn through_objects<'a, L: Lanes, Q: RayQuery>(
    l: L,
    memory: &mut Memory,
    scene: &'a Scene,
    (mut together, mut left): (Vec<ScenePacket<'a>>, Vec<usize>),
    walks: &mut [SceneWalk<'a, Q>],
) {
    let is_filtered = Q::IS_FILTERED;
    memory.hold_filters(if is_filtered { walks.len() } else { 1 });
    memory.hold_packets(together.len());
    let mut entered: Vec<EnteredMesh<'_>> = Vec::with_capacity(together.len());
    let mut instances = Vec::with_capacity(left.len());
    loop {
        entered.clear();
        instances.clear();
        let found = (&mut entered, &mut left);
        ScenePacket::step_all(l, scene, walks, (memory, &mut together), found);
        for &index in &left {
            walks[index].look_ahead(l, scene, &mut memory.walk_stacks[index]);
        }
        for index in left.drain(..) {
            let in_mesh = if Q::IS_FILTERED { index } else { 0 };
            let for_mesh = (&mut memory.scratch, &mut memory.in_meshes[in_mesh]);
            let scene_and_stack = (scene, &mut memory.walk_stacks[index]);
            if let Some(next) = walks[index].next(l, for_mesh, scene_and_stack, |_| true) {
                instances.push((index, next));
            }
        }
        if entered.is_empty() && instances.is_empty() && together.is_empty() {
            break;
        }
        through_instances(l, memory, scene, (&entered, &instances), walks);
        left.extend(instances.iter().map(|(index, _)| index));
    }
}

/// Takes rays through the mesh that each has come to. Packets of neighbours are made ready before,
/// and are the first ones.
#[inline(always)]
fn through_instances<'a, L: Lanes, Q: RayQuery>(
    l: L,
    memory: &mut Memory,
    scene: &'a Scene,
    (entered, instances): (&[EnteredMesh<'a>], &[(usize, Instance<'a>)]),
    walks: &mut [SceneWalk<'a, Q>],
) {
    let packing = Packing::new(instances);
    let ready = entered.len();
    memory.hold_packets(ready + packing.packets.len());
    let at_mesh = |lane: usize| {
        let Instance { tree, mesh, .. } = instances[packing.order[lane]].1;
        (tree, mesh)
    };
    let mut trees = Vec::with_capacity(packing.packets.len() - packing.together);
    for (number, &(first, length)) in packing.packets.iter().enumerate() {
        let packet = &mut memory.packets[ready + number];
        for lane in 0..length {
            let (index, instance) = &instances[packing.order[first + lane]];
            packet.put(lane, &instance.ray);
            if Q::IS_FILTERED {
                packet.set_filter(lane, &memory.in_meshes[*index]);
            }
        }
        if number < packing.together {
            let (tree, _) = at_mesh(first);
            prepare::<L, Q>(l, packet, tree, length);
        } else {
            let mut each = TreePerRay::new(at_mesh(first));
            (1..length).for_each(|lane| each.put(lane, at_mesh(first + lane)));
            prepare::<L, Q>(l, packet, &each, length);
            trees.push(each);
        }
    }
    let mut packets = Vec::with_capacity(ready + packing.packets.len());
    for (packet, at) in memory.packets.iter().zip(entered) {
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
    let sink = OfInstances { scene, entered, instances, packing: &packing, walks };
    dispatch::<L, Q>(l, &mut memory.traversals, &mut packets, sink);
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
                let (index, instance) = &self.instances[self.packing.order[place]];
                (*index, instance.object)
            }
        };
        self.walks[index].state.take(self.scene, object, found);
    }
}

/// The packets of rays that have each come to a mesh.
#[derive(Default)]
struct Packing {
    /// The instances' indices, those of a packet side by side.
    order: Vec<usize>,
    /// The start in `order` and the number of rays of each packet.
    packets: Vec<(usize, usize)>,
    /// The number of packets, which come first, with all their rays at one object.
    together: usize,
}

impl Packing {
    /// Puts rays at one object into packets of their own, if there are [`FEWEST`] or more; all
    /// others share packets. It is compiled once and not for each kernel.
    #[inline(never)]
    fn new(instances: &[(usize, Instance<'_>)]) -> Self {
        let object = |k: usize| instances[k].1.object;
        let mut sorted: Vec<(u32, usize)> = (0..instances.len()).map(|k| (object(k), k)).collect();
        sorted.sort_unstable();
        let (mut packing, mut apart) = (Self::default(), Vec::new());
        for same in sorted.chunk_by(|(a, _), (b, _)| a == b) {
            for chunk in same.chunks(RAYS) {
                let indices = chunk.iter().map(|&(_, k)| k);
                if chunk.len() >= FEWEST as usize {
                    packing.add(indices);
                } else {
                    apart.extend(indices);
                }
            }
        }
        packing.together = packing.packets.len();
        for chunk in apart.chunks(RAYS) {
            packing.add(chunk.iter().copied());
        }
        packing
    }

    fn add(&mut self, indices: impl Iterator<Item = usize>) {
        let first = self.order.len();
        self.order.extend(indices);
        self.packets.push((first, self.order.len() - first));
    }
}
