//! The trees that the rays of a packet are at: one for all, or one each.

use super::packet::{RAYS, of};
use crate::accel::bounds::U;
use crate::accel::mesh_tree::MeshTree;
use crate::geometry::arrays;
use crate::shape::Meshes;
use crate::simd::Lanes;

/// The spaces of the trees that a packet's rays are at. Those of eight rays are asked for at a
/// time: the packet's first `half`, or its second.
#[doc(hidden)]
pub trait Trees: Copy {
    /// Units of a ray's tree in a unit of its mesh.
    fn scale_at(self, lane: usize) -> f64;
    /// Units of the trees of eight rays in units of their meshes.
    fn scale<L: Lanes>(self, l: L, half: usize) -> L::Doubles;
    /// The trees' origins along an axis, in units of the meshes.
    fn origin<L: Lanes>(self, l: L, half: usize, axis: usize) -> L::Doubles;
    /// The blur with the rounding of vertices added, where a tree has them rounded.
    fn with_rounding<L: Lanes>(self, l: L, half: usize, blur: L::Doubles) -> L::Doubles;
}

impl Trees for &MeshTree {
    #[inline(always)]
    fn scale_at(self, _: usize) -> f64 {
        self.space.scale
    }

    #[inline(always)]
    fn scale<L: Lanes>(self, l: L, _: usize) -> L::Doubles {
        l.splat64(self.space.scale)
    }

    #[inline(always)]
    fn origin<L: Lanes>(self, l: L, _: usize, axis: usize) -> L::Doubles {
        l.splat64(self.space.origin[axis])
    }

    #[inline(always)]
    fn with_rounding<L: Lanes>(self, l: L, _: usize, blur: L::Doubles) -> L::Doubles {
        if self.is_exact { blur } else { l.add64(blur, l.splat64(U.into())) }
    }
}

impl MeshTree {
    /// The rounding of vertices, which the blur holds too.
    #[inline(always)]
    fn rounding(&self) -> f64 {
        if self.is_exact { 0.0 } else { U.into() }
    }
}

/// A tree for each ray of a packet.
#[derive(Clone, Copy)]
#[repr(align(64))]
#[doc(hidden)]
pub struct TreePerRay<'a> {
    scale: [f64; RAYS],
    origin: [[f64; RAYS]; 3],
    rounding: [f64; RAYS],
    meshes: [(&'a MeshTree, Meshes<'a>); RAYS],
}

impl<'a> TreePerRay<'a> {
    /// One for all lanes, until others are [put](Self::put).
    pub fn new(at_mesh: (&'a MeshTree, Meshes<'a>)) -> Self {
        let (tree, _) = at_mesh;
        Self {
            scale: [tree.space.scale; RAYS],
            origin: arrays::map(tree.space.origin.to_array(), |along| [along; RAYS]),
            rounding: [tree.rounding(); RAYS],
            meshes: [at_mesh; RAYS],
        }
    }

    /// Puts the ray in a lane to a mesh.
    #[inline]
    pub fn put(&mut self, lane: usize, at_mesh: (&'a MeshTree, Meshes<'a>)) {
        let lane = lane % RAYS;
        let (tree, _) = at_mesh;
        self.scale[lane] = tree.space.scale;
        for axis in 0..3 {
            self.origin[axis][lane] = tree.space.origin[axis];
        }
        self.rounding[lane] = tree.rounding();
        self.meshes[lane] = at_mesh;
    }

    /// The tree and the mesh that the ray in a lane is at.
    #[inline(always)]
    pub(in crate::accel) fn at(&self, lane: usize) -> (&'a MeshTree, Meshes<'a>) {
        self.meshes[lane % RAYS]
    }
}

impl Trees for &TreePerRay<'_> {
    #[inline(always)]
    fn scale_at(self, lane: usize) -> f64 {
        self.scale[lane % RAYS]
    }

    #[inline(always)]
    fn scale<L: Lanes>(self, l: L, half: usize) -> L::Doubles {
        l.load64(of(&self.scale, half))
    }

    #[inline(always)]
    fn origin<L: Lanes>(self, l: L, half: usize, axis: usize) -> L::Doubles {
        l.load64(of(&self.origin[axis], half))
    }

    #[inline(always)]
    fn with_rounding<L: Lanes>(self, l: L, half: usize, blur: L::Doubles) -> L::Doubles {
        l.add64(blur, l.load64(of(&self.rounding, half)))
    }
}
