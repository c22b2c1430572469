//! Edges with one face only.
//!
//! What is one surface in a file may be several objects, one for each material for example. So an edge is no part of a hole if an
//! edge of another object is in its place, to the last bit.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::Facts;
use super::disjoint_sets::DisjointSets;
use super::report::{Found, Place, primitive};
use super::subject::{Subject, stop_if_asked};
use crate::error::Result;
use crate::geometry::{DVec3, Transform, compare_points};
use crate::watch::Watch;

/// An edge of one face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Border {
    /// Its ends in world space, the lower one first.
    ends: [DVec3; 2],
    subject: usize,
    object: i32,
    /// Whether the object is the first that has the mesh.
    is_first: bool,
    triangle: u32,
}

/// The edges with one face, of an object that has a mesh.
pub(super) fn borders(
    subject: &Subject<'_>,
    object: i32,
    transform: &Transform,
) -> impl Iterator<Item = Border> {
    let single = subject.edge_uses().filter(|uses| uses.len() == 1);
    single.map(move |uses| {
        let [a, b] = uses[0]
            .ends
            .map(|place| transform.point_in_world(subject.point(place)));
        Border {
            ends: if compare_points(a, b) == Ordering::Greater {
                [b, a]
            } else {
                [a, b]
            },
            subject: subject.index,
            object,
            is_first: object == subject.object,
            triangle: uses[0].triangle,
        }
    })
}

pub(super) fn check(facts: &Facts<'_>, found: &mut Found<'_>, watch: &dyn Watch) -> Result<()> {
    let mut borders = facts.borders.clone();
    let by_ends = |a: &Border, b: &Border| {
        let by_end = |k: usize| compare_points(a.ends[k], b.ends[k]);
        by_end(0).then_with(|| by_end(1))
    };
    borders.par_sort_unstable_by(|a, b| {
        let by_triangle = || (a.object, a.triangle).cmp(&(b.object, b.triangle));
        by_ends(a, b).then_with(by_triangle)
    });
    stop_if_asked(watch)?;
    let same = borders.chunk_by(|a, b| by_ends(a, b) == Ordering::Equal);
    let alone = same.filter(|same| same.iter().all(|border| border.object == same[0].object));
    // Of objects that share a mesh only the first is told of.
    let is_told = |border: &&Border| border.is_first;
    let mut open: Vec<Border> = alone.flatten().filter(is_told).copied().collect();
    open.sort_unstable_by_key(|border| (border.subject, border.triangle));
    for border in &open {
        let [a, b] = border.ends;
        found.add_at(border.subject, &[border.triangle], || Place {
            object: border.object,
            primitive: Some(primitive(border.triangle)),
            position: 0.5 * a + 0.5 * b,
        });
    }
    if !open.is_empty() {
        let loops = loops(&open);
        let plural = if loops == 1 { "hole" } else { "holes" };
        found.note = format!("around {loops} {plural}");
    }
    Ok(())
}

/// How many sets of edges hang together.
fn loops(open: &[Border]) -> usize {
    let ends = open
        .iter()
        .flat_map(|border| border.ends.map(|end| (end, border.subject)));
    let mut order: Vec<(DVec3, usize, u32)> = ends.zip(0..).map(|((p, s), k)| (p, s, k)).collect();
    let by_place = |a: &(DVec3, usize, u32), b: &(DVec3, usize, u32)| {
        a.1.cmp(&b.1).then_with(|| compare_points(a.0, b.0))
    };
    order.par_sort_unstable_by(|a, b| by_place(a, b).then(a.2.cmp(&b.2)));
    let mut sets = DisjointSets::new(open.len());
    for same in order.chunk_by(|a, b| by_place(a, b) == Ordering::Equal) {
        for end in same {
            sets.unite(same[0].2 / 2, end.2 / 2);
        }
    }
    let count = u32::try_from(open.len()).unwrap_or(u32::MAX);
    (0..count).filter(|&k| sets.first(k) == k).count()
}
