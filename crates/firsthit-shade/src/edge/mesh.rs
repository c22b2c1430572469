//! Chooses the edges of a mesh that are drawn for an eye.

use super::eye::Eye;
use super::settings::{EdgeKind, EdgeKinds, Edges};
use super::table::{EdgeTable, MeshEdge, Neighbour};
use crate::geometry::{DVec3, Side};
use crate::parallel;
use crate::scene::{Catalog, Object};
use crate::shape::Mesh;

/// A mesh as an object of a scene.
pub(super) struct Instance<'a> {
    pub(super) number: usize,
    pub(super) object: &'a Object,
    pub(super) mesh: &'a Mesh,
    pub(super) table: &'a EdgeTable,
    pub(super) catalog: &'a Catalog,
    /// The eye, in object space.
    pub(super) eye: Eye,
    /// The side of surfaces that is culled.
    pub(super) cull: Option<Side>,
}

/// An edge that is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chosen {
    /// The edge's index in the table.
    pub(super) edge: u32,
    /// Whether it is drawn only where another object or nothing is behind it.
    pub(super) is_outline: bool,
}

impl Instance<'_> {
    /// The edges that are drawn, in order.
    pub(super) fn chosen(&self, edges: &Edges) -> Vec<Chosen> {
        let chosen = |(number, edge): (usize, &MeshEdge)| {
            let found = self.kinds(edge, edges)?;
            let is_drawn = !found.common(edges.kinds).is_empty();
            let ends_surface = found.has(EdgeKind::Silhouette) || found.has(EdgeKind::Boundary);
            let may_be_outline = ends_surface && edges.kinds.has(EdgeKind::Object);
            // There are at most three for each triangle that an identifier names, each with two
            // triangles or alone.
            let edge = u32::try_from(number).ok()?;
            (is_drawn || may_be_outline).then_some(Chosen { edge, is_outline: !is_drawn })
        };
        let all: Vec<(usize, &MeshEdge)> = self.table.edges.iter().enumerate().collect();
        parallel::gather(all.chunks(parallel::MANY), |edges| {
            edges.iter().copied().filter_map(chosen).collect()
        })
    }

    /// The kinds of an edge, as far as they matter; `None` where all its faces are culled.
    fn kinds(&self, edge: &MeshEdge, edges: &Edges) -> Option<EdgeKinds> {
        let front = |of: Neighbour| self.eye.sees_front(self.mesh.corners(of.triangle as usize));
        let fronts = edge.neighbours.map(|of| of.map(front));
        let is_passed = |is_front: bool| {
            let side = if is_front { Side::Front } else { Side::Back };
            self.cull == Some(side)
        };
        if fronts.iter().flatten().all(|&is_front| is_passed(is_front)) {
            return None;
        }
        let mut found = EdgeKinds::NONE;
        let mut find = |kind, is_so: bool| {
            if is_so {
                found = found.with(kind);
            }
        };
        if let ([Some(a), Some(b)], [Some(front), Some(other)]) = (edge.neighbours, fronts) {
            let faces_alike = a.is_forward != b.is_forward;
            find(EdgeKind::Silhouette, (front == other) != faces_alike);
            find(EdgeKind::Boundary, edge.is_crowded);
            if edges.kinds.has(EdgeKind::Crease) {
                let turned = if faces_alike { 1.0 } else { -1.0 };
                let normals = [self.normal(a), turned * self.normal(b)];
                find(EdgeKind::Crease, angle(normals) > edges.angle);
            }
            let [x, y] = [a, b].map(|of| self.material(of));
            find(EdgeKind::Material, x != y);
            let [x, y] = [a, b].map(|of| self.mesh.face(of.triangle as usize));
            find(EdgeKind::Wireframe, x != y || edge.is_crowded);
        } else {
            find(EdgeKind::Boundary, true);
            find(EdgeKind::Wireframe, true);
        }
        Some(found)
    }

    fn normal(&self, of: Neighbour) -> DVec3 {
        let normal = self.mesh.normal(of.triangle as usize);
        self.object.transform().normal_in_world(normal)
    }

    fn material(&self, of: Neighbour) -> i32 {
        let triangle = of.triangle.cast_signed();
        self.catalog.material_of(self.number, self.object, triangle)
    }

    /// Whether all triangles at an edge are cut out by their materials at a share of the way along
    /// it.
    pub(super) fn is_cut_out(&self, edge: &MeshEdge, share: f64) -> bool {
        let mut sides = edge.sides.iter().flatten();
        self.object.has_cutouts()
            && sides.all(|side| {
                let triangle = side.triangle as usize;
                self.object.is_cut_out(self.mesh, triangle, side.weights(share))
            })
    }
}

/// The angle between two vectors, in degrees; NaN where one has no direction.
pub(super) fn angle([a, b]: [DVec3; 2]) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b)).to_degrees()
}
