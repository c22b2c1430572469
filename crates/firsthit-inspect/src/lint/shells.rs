//! Closed surfaces that are inside out.
//!
//! 1. Faces that meet at an edge of two faces are of one shell. At an edge of more, so are those of
//!    shells that have it an odd number of times. A shell is closed if it has each of its edges an
//!    even number of times.
//! 2. Where its faces do not face alike, the fewer count as turned (`Mesh::turned`).
//! 3. Decide the sign of a closed shell's volume: by float64 and an error bound, or without
//!    rounding. A shell that cannot face one way has none.
//! 4. A cavity is a shell with a negative volume too, but within another one. So a shell is inside
//!    out if its volume is negative and its box is in the box of no shell with a positive volume.

use std::cmp::Ordering;

use super::report::FindingCollector;
use super::subject::{CHUNK, EdgeUse, Subject};
use crate::accel::Bvh;
use crate::error::Result;
use crate::geometry::exact_sum::ExactSum;
use crate::geometry::orientation::add_determinant;
use crate::geometry::{Bounds, DVec3};
use crate::shape::DisjointSets;
use crate::watch::{Watch, stop_if_asked};

pub(super) fn inside_out(
    subject: &Subject<'_>,
    found: &mut FindingCollector<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    let shells = subject.shells(watch)?;
    let boxes: Vec<Bounds> = shells.iter().map(|shell| shell.bounds(subject)).collect();
    let of_sign = |wanted: Ordering| {
        let numbers = 0..shells.len();
        numbers.filter(|&k| shells[k].sign == wanted).collect::<Vec<_>>()
    };
    let outer = of_sign(Ordering::Greater);
    let count = u32::try_from(outer.len()).unwrap_or(u32::MAX);
    let tree = Bvh::build_watched(count, |k| boxes[outer[k as usize]], 0.0, watch)?;
    let mut stack = Vec::new();
    for k in of_sign(Ordering::Less) {
        stop_if_asked(watch)?;
        let inner = boxes[k];
        let is_cavity = tree.any_overlapping(inner, &mut stack, |other| {
            let outer = boxes[outer[other as usize]];
            outer.contains(inner.low) && outer.contains(inner.high)
        });
        if !is_cavity {
            let faces = &shells[k].faces;
            found.add(subject, faces, subject.middle(faces[0]));
        }
    }
    Ok(())
}

/// A closed surface.
#[derive(Debug)]
pub(super) struct Shell {
    /// The triangles, in order.
    pub(super) faces: Vec<u32>,
    /// The sign of the volume that it is around; equal where it cannot face one way, too.
    pub(super) sign: Ordering,
}

impl Shell {
    pub(super) fn bounds(&self, subject: &Subject<'_>) -> Bounds {
        let faces = self.faces.iter();
        Bounds::of(faces.flat_map(|&triangle| subject.corners(triangle)))
    }
}

/// The triangles that edges join.
fn joined(subject: &Subject<'_>, watch: &dyn Watch) -> Result<DisjointSets> {
    let mut sets = DisjointSets::new(subject.welded.len());
    for (k, uses) in subject.edge_uses().enumerate() {
        if k.is_multiple_of(CHUNK) {
            stop_if_asked(watch)?;
        }
        if let [a, b] = uses {
            sets.unite(a.triangle, b.triangle);
        }
    }
    let mut of_sets = Vec::new();
    for uses in subject.edge_uses().filter(|uses| uses.len() > 2) {
        by_set(uses, &mut sets, &mut of_sets);
        let odd = of_sets.chunk_by(|a, b| a.0 == b.0);
        let mut odd = odd.filter(|uses| uses.len() % 2 == 1).map(|uses| uses[0].0);
        if let Some(first) = odd.next() {
            odd.for_each(|other| sets.unite(first, other));
        }
    }
    Ok(sets)
}

/// The state of a set of triangles at its edges, from the best to the worst.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Edges {
    /// There are no edges, or they are not looked at.
    Unused,
    /// The numbers of triangles in both directions are equal at each edge.
    Balanced,
    /// Each edge belongs to an even number of triangles.
    Even,
    Open,
}

/// The state of each set's edges, at its first triangle, some triangles turned.
fn edges_of(
    subject: &Subject<'_>,
    sets: &mut DisjointSets,
    is_turned: impl Fn(u32) -> bool,
    watch: &dyn Watch,
) -> Result<Vec<Edges>> {
    let mut edges = vec![Edges::Unused; subject.welded.len()];
    let mut of_sets = Vec::new();
    for (k, uses) in subject.edge_uses().enumerate() {
        if k.is_multiple_of(CHUNK) {
            stop_if_asked(watch)?;
        }
        by_set(uses, sets, &mut of_sets);
        for uses in of_sets.chunk_by(|a, b| a.0 == b.0) {
            let forward = (uses.iter())
                .filter(|(_, edge)| edge.is_forward != is_turned(edge.triangle))
                .count();
            let edge = match uses.len() {
                count if count % 2 == 1 => Edges::Open,
                count if 2 * forward == count => Edges::Balanced,
                _ => Edges::Even,
            };
            let of_set = &mut edges[uses[0].0 as usize];
            *of_set = (*of_set).max(edge);
        }
    }
    Ok(edges)
}

/// The closed shells, by their lowest triangle.
pub(super) fn closed_shells(subject: &Subject<'_>, watch: &dyn Watch) -> Result<Vec<Shell>> {
    let mut sets = joined(subject, watch)?;
    let mut edges = edges_of(subject, &mut sets, |_| false, watch)?;
    let mut turned = Vec::new();
    if edges.contains(&Edges::Even) {
        turned = subject.mesh.turned()?;
        let is_turned = |triangle: u32| turned[triangle as usize];
        edges = edges_of(subject, &mut sets, is_turned, watch)?;
    }
    let is_turned = |triangle: u32| turned.get(triangle as usize).is_some_and(|&turned| turned);
    let mut members: Vec<(u32, u32)> = (0..subject.len())
        .map(|triangle| (sets.first(triangle), triangle))
        .filter(|&(first, _)| matches!(edges[first as usize], Edges::Balanced | Edges::Even))
        .collect();
    members.sort_unstable();
    let mut shells = Vec::new();
    for (k, shell) in members.chunk_by(|a, b| a.0 == b.0).enumerate() {
        if k.is_multiple_of(CHUNK) {
            stop_if_asked(watch)?;
        }
        let faces: Vec<u32> = shell.iter().map(|&(_, triangle)| triangle).collect();
        let sign = if edges[shell[0].0 as usize] == Edges::Balanced {
            sign_of_volume(subject, &faces, is_turned)
        } else {
            Ordering::Equal
        };
        shells.push(Shell { faces, sign });
    }
    Ok(shells)
}

/// The uses of an edge with the sets of their triangles, those of one set side by side.
fn by_set(uses: &[EdgeUse], sets: &mut DisjointSets, of_sets: &mut Vec<(u32, EdgeUse)>) {
    of_sets.clear();
    of_sets.extend(uses.iter().map(|&edge| (sets.first(edge.triangle), edge)));
    of_sets.sort_unstable_by_key(|&(set, _)| set);
}

/// The sign of the volume that a closed shell is around, some of its triangles turned.
fn sign_of_volume(
    subject: &Subject<'_>,
    shell: &[u32],
    is_turned: impl Fn(u32) -> bool,
) -> Ordering {
    let way = |triangle: u32| if is_turned(triangle) { -1.0 } else { 1.0 };
    let [origin, ..] = subject.corners(shell[0]);
    let (mut volume, mut size) = (0.0, 0.0);
    for &triangle in shell {
        let [a, b, c] = subject.corners(triangle).map(|corner| corner - origin);
        volume += way(triangle) * a.cross(b).dot(c);
        let [a, b, c] = [a, b, c].map(DVec3::abs);
        let minors =
            DVec3::new(b.y * c.z + b.z * c.y, b.z * c.x + b.x * c.z, b.x * c.y + b.y * c.x);
        size += a.dot(minors);
    }
    // A sum of n terms, each off by less than 8 roundings of its permanent.
    let error = (shell.len() as f64 + 16.0) * f64::EPSILON * size;
    // Products that are too small for float64 would be far below.
    let is_moderate = size > 1e-200 && size < 1e200;
    if is_moderate && volume.abs() > error {
        return volume.total_cmp(&0.0);
    }
    // The volume of what is closed does not depend on the point that it is seen from.
    let mut exact = ExactSum::ZERO;
    for &triangle in shell {
        add_determinant(&mut exact, subject.corners(triangle), way(triangle));
    }
    exact.sign()
}
