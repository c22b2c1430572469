//! Boundary edges: those with one face only.
//!
//! What is one surface in a file may be several objects, one for each material for example. So an edge is no part of a hole if another
//! object has an edge in its place, to the last bit, with another face: a copy of the face closes nothing.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::disjoint_sets::DisjointSets;
use super::report::{Found, Place, primitive};
use super::subject::{Subject, stop_if_asked};
use crate::error::Result;
use crate::geometry::{DVec3, Transform, compare_points};
use crate::watch::Watch;

/// An edge of one face, of an object.
#[derive(Debug, Clone, Copy)]
pub(super) struct Border {
    /// Its ends in world space, the lower one first.
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

impl Border {
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
pub(super) fn borders(
    subject: &Subject<'_>,
    object: i32,
    transform: &Transform,
) -> impl Iterator<Item = Border> {
    let single = subject.edge_uses().filter(|uses| uses.len() == 1);
    single.map(move |uses| {
        let edge = uses[0];
        let corners = subject.welded[edge.triangle as usize];
        let opposite = corners.into_iter().find(|place| !edge.ends.contains(place));
        let in_world = |place: u32| transform.point_in_world(subject.point(place));
        let [a, b] = edge.ends.map(in_world);
        let is_turned = compare_points(a, b) == Ordering::Greater;
        Border {
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

/// Looks at those of all objects.
pub(super) fn check(
    borders: &mut [Border],
    found: &mut Found<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    borders.par_sort_unstable_by(|a, b| {
        let by_triangle =
            || (a.object, a.triangle, a.places).cmp(&(b.object, b.triangle, b.places));
        a.by_ends(b).then_with(by_triangle)
    });
    stop_if_asked(watch)?;
    let same = borders.chunk_by(|a, b| a.by_ends(b) == Ordering::Equal);
    let alone = same.filter(|same| {
        let is_of_one_object = same.iter().all(|border| border.object == same[0].object);
        is_of_one_object || same.iter().all(|border| border.has_face_of(&same[0]))
    });
    let mut open: Vec<Border> = alone.flatten().copied().collect();
    // Of objects that share a mesh the first is told of that has the hole.
    open.par_sort_unstable_by_key(|border| {
        (
            border.subject,
            border.triangle,
            border.places,
            border.object,
        )
    });
    open.dedup_by_key(|border| (border.subject, border.triangle, border.places));
    for border in &open {
        let [a, b] = border.ends;
        found.add_at(border.subject, &[border.triangle], || Place {
            object: Some(border.object),
            primitive: Some(primitive(border.triangle)),
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

/// How many connected components boundary edges have. A hole is one; two that have a vertex in common are one together.
fn components(open: &[Border]) -> usize {
    let ends = open
        .iter()
        .flat_map(|border| border.places.map(|place| (border.subject, place)));
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
