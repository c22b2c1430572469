//! Boundary edges: those with one face only.
//!
//! One surface of a file may be several objects, one for each material for example. So an
//! edge is no part of a hole if another object has an edge in its place, to the last bit, with
//! another face: a copy of the face closes nothing.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::report::{FindingCollector, Place, primitive};
use super::subject::Subject;
use crate::error::Result;
use crate::geometry::{DVec3, Transform, compare_points};
use crate::shape::DisjointSets;
use crate::watch::{Watch, stop_if_asked};

/// An edge of one face, of an object.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoundaryEdge {
    /// The ends in world space, the lower one first.
    ends: [DVec3; 2],
    /// The face's other corner.
    opposite: DVec3,
    /// Whether the face goes from the lower end to the higher one.
    is_forward: bool,
    subject: usize,
    object: i32,
    triangle: u32,
    /// The places of its ends in the mesh.
    places: [u32; 2],
}

impl BoundaryEdge {
    fn by_ends(&self, other: &Self) -> Ordering {
        let by_end = |k: usize| compare_points(self.ends[k], other.ends[k]);
        by_end(0).then_with(|| by_end(1))
    }

    /// Whether it has the face of another edge in its place, or one that is a copy.
    fn has_face_of(&self, other: &Self) -> bool {
        self.is_forward == other.is_forward
            && compare_points(self.opposite, other.opposite) == Ordering::Equal
    }
}

/// The edges with one face, of an object that has a mesh.
pub(super) fn boundary_edges(
    subject: &Subject<'_>,
    object: i32,
    transform: &Transform,
) -> impl Iterator<Item = BoundaryEdge> {
    let single = subject.edge_uses().filter(|uses| uses.len() == 1);
    single.map(move |uses| {
        let edge = uses[0];
        let corners = subject.welded[edge.triangle as usize];
        let opposite = corners.into_iter().find(|place| !edge.ends.contains(place));
        let in_world = |place: u32| transform.point_in_world(subject.point(place));
        let [a, b] = edge.ends.map(in_world);
        let is_turned = compare_points(a, b) == Ordering::Greater;
        BoundaryEdge {
            ends: if is_turned { [b, a] } else { [a, b] },
            opposite: opposite.map_or(a, in_world),
            is_forward: edge.is_forward != is_turned,
            subject: subject.index,
            object,
            triangle: edge.triangle,
            places: edge.ends,
        }
    })
}

/// Finds the holes among the boundary edges of all objects.
pub(super) fn check(
    boundary_edges: &mut [BoundaryEdge],
    found: &mut FindingCollector<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    boundary_edges.par_sort_unstable_by(|a, b| {
        let by_triangle =
            || (a.object, a.triangle, a.places).cmp(&(b.object, b.triangle, b.places));
        a.by_ends(b).then_with(by_triangle)
    });
    stop_if_asked(watch)?;
    let same = boundary_edges.chunk_by(|a, b| a.by_ends(b) == Ordering::Equal);
    let alone = same.filter(|same| {
        let is_of_one_object = same.iter().all(|edge| edge.object == same[0].object);
        is_of_one_object || same.iter().all(|edge| edge.has_face_of(&same[0]))
    });
    let mut open: Vec<BoundaryEdge> = alone.flatten().copied().collect();
    // A hole of a mesh is reported once, for the first object that has it.
    open.par_sort_unstable_by_key(|edge| (edge.subject, edge.triangle, edge.places, edge.object));
    open.dedup_by_key(|edge| (edge.subject, edge.triangle, edge.places));
    for edge in &open {
        let [a, b] = edge.ends;
        found.add_at(edge.subject, &[edge.triangle], || Place {
            object: Some(edge.object),
            primitive: Some(primitive(edge.triangle)),
            position: 0.5 * a + 0.5 * b,
        });
    }
    if !open.is_empty() {
        let components = components(&open);
        let plural = if components == 1 { "hole" } else { "holes" };
        found.note = format!("around {components} {plural}");
    }
    Ok(())
}

/// The number of connected components of boundary edges. A hole is one; two that have a vertex in
/// common are one together.
fn components(open: &[BoundaryEdge]) -> usize {
    let ends = open.iter().flat_map(|edge| edge.places.map(|place| (edge.subject, place)));
    let mut order: Vec<((usize, u32), u32)> = ends.zip(0..).collect();
    order.par_sort_unstable();
    let mut sets = DisjointSets::new(open.len());
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        for end in same {
            sets.unite(same[0].1 / 2, end.1 / 2);
        }
    }
    let count = u32::try_from(open.len()).unwrap_or(u32::MAX);
    (0..count).filter(|&k| sets.first(k) == k).count()
}
