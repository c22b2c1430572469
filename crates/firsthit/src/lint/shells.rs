//! Closed surfaces that are inside out.
//!
//! 1. Faces that meet at an edge of two faces, wound consistently, are of one shell. A shell is closed if along each of its edges as
//!    many faces go one way as the other.
//! 2. Decide the sign of a closed shell's volume: by float64 and an error bound, or without rounding.
//! 3. A cavity is a shell with a negative volume too, but within another one. So a shell is inside out if its volume is negative and
//!    its box is in the box of no shell with a positive volume.

use std::cmp::Ordering;

use super::report::Found;
use super::subject::{CHUNK, Subject, stop_if_asked};
use crate::accel::Bvh;
use crate::error::Result;
use crate::geometry::exact_sum::ExactSum;
use crate::geometry::orientation::add_determinant;
use crate::geometry::{Bounds, DVec3};
use crate::shape::DisjointSets;
use crate::watch::Watch;

pub(super) fn inside_out(
    subject: &Subject<'_>,
    found: &mut Found<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    let shells = closed_shells(subject);
    let mut signs = Vec::new();
    for (k, shell) in shells.iter().enumerate() {
        if k.is_multiple_of(CHUNK) {
            stop_if_asked(watch)?;
        }
        signs.push(sign_of_volume(subject, shell));
    }
    let boxes: Vec<Bounds> = shells.iter().map(|shell| around(subject, shell)).collect();
    let of_sign = |wanted: Ordering| {
        let numbers = 0..signs.len();
        numbers.filter(|&k| signs[k] == wanted).collect::<Vec<_>>()
    };
    let outer = of_sign(Ordering::Greater);
    let count = u32::try_from(outer.len()).unwrap_or(u32::MAX);
    let tree = Bvh::build(count, |k| boxes[outer[k as usize]], 0.0);
    let mut stack = Vec::new();
    for k in of_sign(Ordering::Less) {
        stop_if_asked(watch)?;
        let inner = boxes[k];
        let is_cavity = tree.any_overlapping(inner, &mut stack, |other| {
            let outer = boxes[outer[other as usize]];
            outer.contains(inner.low) && outer.contains(inner.high)
        });
        if !is_cavity {
            found.add(subject, &shells[k], subject.middle(shells[k][0]));
        }
    }
    Ok(())
}

pub(super) fn around(subject: &Subject<'_>, shell: &[u32]) -> Bounds {
    Bounds::of(shell.iter().flat_map(|&triangle| subject.corners(triangle)))
}

/// The triangles of each closed shell, in order; the shells by their lowest triangle.
pub(super) fn closed_shells(subject: &Subject<'_>) -> Vec<Vec<u32>> {
    let mut sets = DisjointSets::new(subject.welded.len());
    for uses in subject.edge_uses() {
        if let [a, b] = uses
            && a.is_forward != b.is_forward
        {
            sets.unite(a.triangle, b.triangle);
        }
    }
    let mut is_closed = vec![true; subject.welded.len()];
    let mut is_used = vec![false; subject.welded.len()];
    for uses in subject.edge_uses() {
        let forward = uses.iter().filter(|edge| edge.is_forward).count();
        for edge in uses {
            let first = sets.first(edge.triangle) as usize;
            is_closed[first] &= 2 * forward == uses.len();
            is_used[edge.triangle as usize] = true;
        }
    }
    let mut members: Vec<(u32, u32)> = (0..subject.len())
        .filter(|&triangle| is_used[triangle as usize])
        .map(|triangle| (sets.first(triangle), triangle))
        .filter(|&(first, _)| is_closed[first as usize])
        .collect();
    members.sort_unstable();
    let shells = members.chunk_by(|a, b| a.0 == b.0);
    shells
        .map(|shell| shell.iter().map(|&(_, triangle)| triangle).collect())
        .collect()
}

/// The sign of the volume that a closed shell is around.
pub(super) fn sign_of_volume(subject: &Subject<'_>, shell: &[u32]) -> Ordering {
    let [origin, ..] = subject.corners(shell[0]);
    let (mut volume, mut size) = (0.0, 0.0);
    for &triangle in shell {
        let [a, b, c] = subject.corners(triangle).map(|corner| corner - origin);
        volume += a.cross(b).dot(c);
        let [a, b, c] = [a, b, c].map(DVec3::abs);
        let minors = DVec3::new(
            b.y * c.z + b.z * c.y,
            b.z * c.x + b.x * c.z,
            b.x * c.y + b.y * c.x,
        );
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
        add_determinant(&mut exact, subject.corners(triangle), 1.0);
    }
    exact.sign()
}
