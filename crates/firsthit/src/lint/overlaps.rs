//! Closed shells that overlap: they cut each other, or one is within another that faces the same way. There the rule decides what is inside.
//!
//! 1. Only shells whose boxes touch are looked at.
//! 2. Shells of which faces meet overlap.
//! 3. Any other is within or without each of the others as a whole: a ray from a face tells, of which each crossing counts once. How
//!    often the others go around it is the sum of their signs. It fits if they do not at all, or once the other way: a cavity.

use std::cmp::Ordering;

use super::report::Found;
use super::self_intersections::{face, meets};
use super::shells::{around, closed_shells, sign_of_volume};
use super::subject::{Subject, stop_if_asked};
use crate::accel::Bvh;
use crate::error::Result;
use crate::geometry::{Bounds, DVec3, Ray};
use crate::memory;
use crate::shape::triangle::{EdgeRule, Shear};
use crate::watch::Watch;

/// In no shell that is looked at.
const NONE: u32 = u32::MAX;

#[expect(clippy::too_many_lines, reason = "its steps are those of the head")]
pub(super) fn check(subject: &Subject<'_>, found: &mut Found<'_>, watch: &dyn Watch) -> Result<()> {
    let shells = closed_shells(subject);
    if shells.len() < 2 {
        return Ok(());
    }
    let boxes: Vec<Bounds> = shells.iter().map(|shell| around(subject, shell)).collect();
    let count = u32::try_from(shells.len()).unwrap_or(u32::MAX);
    let tree = Bvh::build(count, |k| boxes[k as usize], 0.0);
    let mut stack = Vec::new();
    let mut is_beside = |k: usize| {
        let overlaps = |other: u32| other as usize != k && touch(boxes[k], boxes[other as usize]);
        tree.any_overlapping(boxes[k], &mut stack, overlaps)
    };
    let beside: Vec<usize> = (0..shells.len()).filter(|&k| is_beside(k)).collect();
    if beside.is_empty() {
        return Ok(());
    }
    let mut shell_of = memory::filled(subject.len() as usize, NONE)?;
    let mut faces = Vec::new();
    for &k in &beside {
        for &triangle in &shells[k] {
            if subject.has_area[triangle as usize] {
                shell_of[triangle as usize] = u32::try_from(k).unwrap_or(NONE);
                faces.push(triangle);
            }
        }
    }
    let count = u32::try_from(faces.len()).unwrap_or(u32::MAX);
    let bounds = |k: u32| Bounds::of(subject.corners(faces[k as usize]));
    let tree = Bvh::build(count, bounds, 0.0);
    let signs: Vec<i32> = (shells.iter())
        .map(|shell| match sign_of_volume(subject, shell) {
            Ordering::Less => -1,
            Ordering::Equal => 0,
            Ordering::Greater => 1,
        })
        .collect();
    let mut overlaps = vec![false; shells.len()];
    for &k in &beside {
        for &triangle in &shells[k] {
            stop_if_asked(watch)?;
            if overlaps[k] || shell_of[triangle as usize] == NONE {
                continue;
            }
            let own = face(subject, triangle);
            let bounds = Bounds::of(own.corners);
            let mut other_shell = None;
            tree.any_overlapping(bounds, &mut stack, |other| {
                let other = faces[other as usize];
                let shell = shell_of[other as usize] as usize;
                if shell != k && meets(subject, &own, bounds, other) {
                    other_shell = Some(shell);
                }
                other_shell.is_some()
            });
            if let Some(other) = other_shell {
                (overlaps[k], overlaps[other]) = (true, true);
            }
        }
    }
    let mut crossings: Vec<u32> = Vec::new();
    for &k in &beside {
        stop_if_asked(watch)?;
        if !overlaps[k] {
            // Within a face, which meets no other shell.
            let start = subject.middle(shells[k][0]);
            let ray = Ray::new(start, DVec3::X);
            let shear = Shear::new(&ray);
            let far = DVec3::new(subject.mesh.bounds().high.x, start.y, start.z);
            crossings.clear();
            tree.any_overlapping(Bounds::of([start, far]), &mut stack, |other| {
                let other = faces[other as usize];
                let shell = shell_of[other as usize];
                let corners = subject.corners(other);
                if shell as usize != k
                    && (shear.intersect_with(EdgeRule::Once, corners))
                        .is_some_and(|hit| hit.t > 0.0)
                {
                    crossings.push(shell);
                }
                false
            });
            crossings.sort_unstable();
            let odd = crossings.chunk_by(|a, b| a == b);
            let odd = odd.filter(|same| same.len() % 2 == 1);
            let turns: i32 = odd.map(|same| signs[same[0] as usize]).sum();
            overlaps[k] = signs[k] != 0 && turns != 0 && turns != -signs[k];
        }
    }
    for k in (0..shells.len()).filter(|&k| overlaps[k]) {
        found.add(subject, &shells[k], subject.middle(shells[k][0]));
    }
    Ok(())
}

fn touch(a: Bounds, b: Bounds) -> bool {
    a.low.cmple(b.high).all() && b.low.cmple(a.high).all()
}
