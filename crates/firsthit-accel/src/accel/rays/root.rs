//! Sixteen rays at the root of a tree: which of them meet any of its boxes, and are they so far
//! apart that each meets leaves of its own?
//!
//! 1. Test the root's sixteen boxes against the intervals around the rays' numbers (`slabs.rs`):
//!    most boxes are missed by all.
//! 2. Test each box that is left against the sixteen rays, a ray in each lane. A ray that meets one
//!    box alone begins there.

use super::packet::{Packet, RAYS};
use super::slabs::{Intervals, most, rays_at};
use crate::accel::mesh_tree::MeshTree;
use crate::accel::node::Node;
use crate::shape::Meshes;
use crate::simd::{Lanes, set_bits};

impl Packet {
    /// Leaves out the rays that meet no box of the root, and lets those that meet one alone begin
    /// there. They are [prepared](Packet::prepare).
    #[inline(always)]
    pub fn keep_at_root<L: Lanes>(&mut self, l: L, tree: &MeshTree) {
        let Some(root) = tree.nodes.first().filter(|_| self.alive != 0) else {
            return;
        };
        let zero = l.splat(0.0);
        let around = Intervals::around(l, self.alive, &self.inverse, &self.ends);
        let (candidates, _) = around.boxes(l, root, [0.0, most(l, self.alive, &self.t_max_high)]);
        let is_there = l.le(l.load(&root.planes[0]), l.load(&root.planes[1]));
        let limits = l.load(&self.t_max_high);
        let (mut met, mut several, mut only) = (0, 0, zero);
        for child in set_bits(candidates & is_there) {
            let here = self.meets(l, root, child, limits);
            several |= met & here;
            met |= here;
            only = l.select(here, l.splat(f32::from_bits(root.children[child])), only);
        }
        l.store(l.select(several, zero, only), bytemuck::cast_mut(&mut self.begin));
        self.alive &= met;
    }

    /// The rays that meet the box of a child of a node, which is there, at depths up to `limits`.
    #[inline(always)]
    pub(in crate::accel) fn meets<L: Lanes>(
        &self,
        l: L,
        node: &Node,
        child: usize,
        limits: L::Floats,
    ) -> u16 {
        rays_at(l, (node, child), (&self.inverse, &self.ends), (l.splat(0.0), limits))
    }

    /// Whether the first and the last ray are so far apart at the mesh that each ray meets leaves
    /// of its own, roughly.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "about so much")]
    #[expect(clippy::cast_precision_loss, reason = "likewise")]
    pub fn is_scattered(&self, mesh: Meshes<'_>, tree: &MeshTree) -> bool {
        /// The area that a packet covers, in leaves, for each of its rays.
        const LEAVES: f32 = 0.25;
        if self.alive == 0 {
            return false;
        }
        let (first, last) = (self.alive.trailing_zeros() as usize, self.alive.ilog2() as usize);
        // Where a ray is at the depth of the tree's origin, or where it starts behind that.
        let place = |lane: usize, axis: usize| {
            let [x, depth] = [axis, 2].map(|k| self.start[k][0][lane % RAYS]);
            let ahead = (-depth * self.forwards[lane % RAYS]).max(0.0);
            x + ahead * self.slope[axis][lane % RAYS]
        };
        let apart = [0, 1].map(|axis| place(last, axis) - place(first, axis));
        let size = mesh.bounds().size() * tree.space.scale;
        let surface = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
        let leaf = surface as f32 / tree.leaves.len() as f32;
        let rays = self.alive.count_ones() as f32;
        apart[0] * apart[0] + apart[1] * apart[1] > LEAVES * rays * leaf
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{DVec3, Ray};
    use crate::shape::Mesh;
    use crate::simd::{self, InstructionSet, Kernel};

    /// A sheet of `2 * 40 * 40` triangles from -1 to 1 that is not flat.
    fn sheet() -> Mesh {
        Mesh::sheet(41, |x, y| [x / 20.0 - 1.0, y / 20.0 - 1.0, 0.3 * libm::sin(x + y)])
    }

    /// Sixteen rays at the root of a tree.
    struct AtRoot<'a>(&'a Mesh, &'a MeshTree, [Ray; RAYS]);

    /// The rays that are kept, and where each begins; whether they are scattered; and the children
    /// that each meets, a bit each, by the test of a ray alone.
    struct Outcome {
        kept: u16,
        begin: [u32; RAYS],
        is_scattered: bool,
        met: [u16; RAYS],
    }

    impl Kernel for AtRoot<'_> {
        type Output = Outcome;

        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> Self::Output {
            let Self(mesh, tree, rays) = self;
            let mut packet = Packet::default();
            for (lane, ray) in rays.iter().enumerate() {
                packet.put(lane, ray);
            }
            packet.prepare(l, tree, RAYS);
            let is_scattered = packet.is_scattered(mesh.into(), tree);
            let mut met = [0; RAYS];
            for lane in set_bits(packet.alive) {
                let ray = packet.tree_ray(lane);
                (met[lane], _) = ray.boxes(l, &tree.nodes[0], packet.t_max_high[lane]);
            }
            packet.keep_at_root(l, tree);
            Outcome { kept: packet.alive, begin: packet.begin, is_scattered, met }
        }
    }

    /// Neighbours from outside and inside, in all octants and across them, some of them short.
    #[test]
    fn rays_are_kept_that_meet_a_box_of_the_root() {
        let mesh = sheet();
        let tree = MeshTree::build(&mesh);
        let mut parted = 0;
        for k in 0..2000_u32 {
            let number = |n: u32| libm::sin(f64::from(k) * (1.3 + f64::from(n)));
            let point = |n: u32| DVec3::new(number(n), number(n + 1), number(n + 2));
            let (start, towards) = (4.0 * number(9) * point(0), 1.2 * point(3));
            let apart = [0.02, 0.5, 0.0][k as usize % 3];
            let rays = [0; RAYS].map(|_| Ray::new(start, towards - start));
            let mut lane = 0.0;
            let rays = rays.map(|ray| {
                lane += 1.0;
                let aside = apart * DVec3::new(libm::sin(lane), libm::cos(2.0 * lane), 0.3);
                let reach = if k % 5 == 0 { 0.1 * lane } else { f64::INFINITY };
                Ray::new(ray.origin, ray.direction + aside).up_to(reach)
            });
            for set in InstructionSet::available() {
                let Outcome { kept, begin, met, .. } = simd::run(set, AtRoot(&mesh, &tree, rays));
                for lane in 0..RAYS {
                    assert_eq!(kept >> lane & 1 == 1, met[lane] != 0, "{set:?} {rays:?}");
                    let only = met[lane].trailing_zeros() as usize % RAYS;
                    let first =
                        if met[lane].is_power_of_two() { tree.nodes[0].children[only] } else { 0 };
                    assert!(met[lane] == 0 || begin[lane] == first, "{set:?} {rays:?}");
                }
                parted += u32::from(kept != 0 && kept != u16::MAX);
            }
        }
        assert!(parted > 500, "{parted}");
    }

    /// A leaf of the sheet is about 0.15 wide.
    #[test]
    fn rays_are_scattered_that_are_farther_apart_than_leaves() {
        let mesh = sheet();
        let tree = MeshTree::build(&mesh);
        for (apart, is_scattered) in [(0.001, false), (0.03, false), (0.3, true), (1.2, true)] {
            let mut lane = 0;
            let rays = [0; RAYS].map(|_| {
                let [x, y] = [lane % 4, lane / 4].map(|k| apart * (f64::from(k) - 1.5));
                lane += 1;
                // All from one point, which is three units before the sheet.
                Ray::new(DVec3::new(0.0, 0.0, 3.0), DVec3::new(x, y, -3.0))
            });
            for set in InstructionSet::available() {
                let outcome = simd::run(set, AtRoot(&mesh, &tree, rays));
                assert_eq!(outcome.is_scattered, is_scattered, "{set:?} {apart}");
            }
        }
    }
}
