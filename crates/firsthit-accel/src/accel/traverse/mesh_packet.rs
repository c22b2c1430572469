//! A packet of rays at a mesh, and one of its rays: what a traversal works with.

use crate::accel::mesh_tree::MeshTree;
use crate::accel::meshlet::Meshlet;
use crate::accel::rays::limits::Limits;
use crate::accel::rays::packet::{Packet, RAYS};
use crate::accel::rays::trees::TreePerRay;
use crate::geometry::Ray;
use crate::shape::triangle::{self, Doubtful, EdgeRule, MeshFilter, Shear, TriangleHit};
use crate::shape::{Crossing, Meshes};
use crate::simd::{Kernel, Lanes};

/// A packet with fewer rays than this is left to [`interleaved`](super::interleaved).
#[doc(hidden)]
pub const FEWEST: u32 = 4;

/// A packet of rays that is [prepared](Packet::prepare) for the tree of a mesh, or for one each.
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct MeshPacket<'a> {
    pub(super) tree: &'a MeshTree,
    pub(super) mesh: Meshes<'a>,
    pub(super) packet: &'a Packet,
    /// The trees and meshes of rays that are at different ones.
    each: Option<&'a TreePerRay<'a>>,
    /// Whether each ray meets leaves of its own.
    is_scattered: bool,
    /// The rays without an answer yet, a bit each.
    pub(super) open: u16,
}

impl<'a> MeshPacket<'a> {
    pub fn new(tree: &'a MeshTree, mesh: impl Into<Meshes<'a>>, packet: &'a Packet) -> Self {
        let (mesh, open) = (mesh.into(), packet.alive);
        Self { tree, mesh, packet, each: None, is_scattered: false, open }
    }

    /// The packet, with what is known of its rays: whether each meets leaves of its own.
    #[must_use]
    pub fn scattered(self, is_scattered: bool) -> Self {
        Self { is_scattered, ..self }
    }

    /// A packet of rays that are at different meshes.
    pub fn apart(each: &'a TreePerRay<'a>, packet: &'a Packet) -> Self {
        let (tree, mesh) = each.at(0);
        Self { each: Some(each), ..Self::new(tree, mesh, packet) }
    }

    /// Whether enough of the rays are at one mesh, and near one another, for traversals of packets
    /// to pay.
    #[inline(always)]
    pub(super) fn goes_together(&self) -> bool {
        self.each.is_none() && !self.is_scattered && self.open.count_ones() >= FEWEST
    }

    /// One of its rays.
    #[inline(always)]
    pub(super) fn ray(&self, lane: usize) -> MeshRay<'a> {
        let at_mesh = (self.tree, self.mesh);
        let (tree, mesh) = self.each.map_or(at_mesh, |each| each.at(lane));
        MeshRay { tree, mesh, packet: self.packet, lane, limits: self.packet.limits(lane) }
    }
}

/// A ray of a packet, at a mesh with its tree.
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct MeshRay<'a> {
    pub(super) tree: &'a MeshTree,
    pub(super) mesh: Meshes<'a>,
    pub(super) packet: &'a Packet,
    pub(super) lane: usize,
    /// The bounds of the ray's ends as depths.
    pub(super) limits: Limits,
}

impl MeshRay<'_> {
    /// The exact test: where the ray meets the triangle in a lane of a leaf, if it does.
    #[inline(always)]
    pub(super) fn intersect<L: Lanes>(
        &self,
        l: L,
        edges: EdgeRule,
        leaf: &Meshlet,
        lane: usize,
    ) -> Option<Crossing> {
        let corners = self.tree.corners(self.mesh, leaf, lane);
        let ray = self.packet.ray(self.lane);
        let settle = |doubtful| settle_within(l, &ray, doubtful);
        let hit = Shear::new(&ray).intersect_by(edges, corners, settle)?;
        ray.holds(hit.t).then(|| self.crossing(leaf, lane, hit))
    }

    /// The filter of the ray.
    #[inline(always)]
    pub(super) fn filter(&self) -> &MeshFilter {
        &self.packet.filters[self.lane % RAYS]
    }

    /// The exact test for a triangle of the mesh that the ray's filter may leave out.
    #[inline(always)]
    pub(super) fn intersect_filtered<L: Lanes>(
        &self,
        l: L,
        edges: EdgeRule,
        triangle: u32,
    ) -> Option<Crossing> {
        let corners = self.mesh.corners(triangle);
        let ray = self.packet.ray(self.lane);
        let settle = |doubtful| settle_within(l, &ray, doubtful);
        let ray_and_shear = (&ray, &Shear::new(&ray));
        let hit = self.filter().intersect(ray_and_shear, edges, (triangle, corners), settle)?;
        let farthest = || self.mesh.farthest(triangle);
        let is_met = ray.holds(hit.t) && self.filter().has_begun(hit.t, farthest);
        is_met.then(|| hit.crossing(triangle.cast_signed()))
    }

    /// The crossing with a triangle of a leaf that the ray meets for certain.
    #[inline(always)]
    pub(super) fn locate<L: Lanes>(&self, l: L, leaf_lane: u32) -> Option<Crossing> {
        let corners = self.tree.corners_at(self.mesh, leaf_lane);
        let ray = self.packet.ray(self.lane);
        let hit = triangle::locate(&ray, corners, |doubtful| l.call(SettleExactly(doubtful)))?;
        let triangle = self.tree.triangle_at(leaf_lane).cast_signed();
        ray.holds(hit.t).then(|| hit.crossing(triangle))
    }

    /// Whether `new` comes before `old`: by the float64 nearest to the exact `t`, then by the
    /// triangle's index. Of a ray that leaves a surface, by `t` as it is: it is measured from the
    /// rounded start.
    #[inline(always)]
    pub(super) fn precedes<L: Lanes>(&self, l: L, new: &Crossing, old: &Crossing) -> bool {
        if triangle::are_close(new.t, old.t) {
            if self.is_departing() {
                return (new.t, new.primitive) < (old.t, old.primitive);
            }
            let [one, other] = [new, old].map(|crossing| crossing.primitive.cast_unsigned());
            self.mesh.ask_for_planes(one, other);
            let ray = self.packet.ray(self.lane);
            let nearest = |crossing| l.call(NearestT(self.mesh, &ray, crossing));
            (nearest(new), new.primitive) < (nearest(old), old.primitive)
        } else {
            new.t < old.t
        }
    }

    /// Whether a triangle is known to come after another, which the ray meets: in one plane the
    /// exact `t` are one, and nearly there heights tell.
    #[inline(always)]
    pub(super) fn is_known_to_follow<L: Lanes>(&self, l: L, new: u32, old: u32) -> bool {
        if self.is_departing() {
            return false;
        }
        if old < new && self.mesh.are_in_one_plane(old, new) {
            return true;
        }
        let crowds = self.mesh.crowds();
        crowds.is_some_and(|crowds| crowds.are_together(new, old))
            && l.call(IsAfter(self.mesh, &self.packet.ray(self.lane), [new, old]))
    }

    /// Whether a triangle is known not to be ahead of the one that the ray leaves.
    #[inline(always)]
    pub(super) fn leaves_behind(&self, triangle: u32) -> bool {
        let direction = self.packet.ray(self.lane).direction;
        self.filter().leaves_behind(self.mesh, direction, triangle)
    }

    /// Whether the ray leaves a surface.
    #[inline(always)]
    fn is_departing(&self) -> bool {
        self.packet.departing >> (self.lane % RAYS) & 1 == 1
    }

    #[inline(always)]
    fn crossing(&self, leaf: &Meshlet, lane: usize, hit: TriangleHit) -> Crossing {
        hit.crossing(self.tree.triangle(leaf, lane).cast_signed())
    }
}

/// The exact test's hit, unless it is certain to lie beyond the ray's ends.
#[inline(always)]
fn settle_within<L: Lanes>(l: L, ray: &Ray, doubtful: Doubtful) -> Option<TriangleHit> {
    if doubtful.is_outside(ray.t_min, ray.t_max) {
        return None;
    }
    l.call(SettleExactly(doubtful))
}

/// Exact arithmetic for a triangle that float64 could not decide, as a function of its own: it is
/// rarely called.
#[doc(hidden)]
pub struct SettleExactly(pub Doubtful);

impl Kernel for SettleExactly {
    type Output = Option<TriangleHit>;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Self::Output {
        self.0.settle_inlined()
    }
}

/// Whether one of two triangles of a crowd surely comes after the other, likewise.
pub struct IsAfter<'a>(pub Meshes<'a>, pub &'a Ray, pub [u32; 2]);

impl Kernel for IsAfter<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> bool {
        let Self(mesh, ray, [new, old]) = self;
        let old = (old, mesh.corners(old));
        mesh.crowds().is_some_and(|crowds| crowds.is_after(ray, new, old))
    }
}

/// The float64 nearest to the exact `t` of a crossing, likewise.
struct NearestT<'a>(Meshes<'a>, &'a Ray, &'a Crossing);

impl Kernel for NearestT<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> f64 {
        self.0.nearest_t(self.1, self.2)
    }
}
