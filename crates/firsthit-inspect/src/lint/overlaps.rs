//! Closed shells that overlap: they cut each other, or one is within another that faces the same
//! way. There the rule decides what is inside.
//!
//! 1. Only shells whose boxes have room in common are looked at.
//! 2. Shells of which an edge goes through a face of the other overlap.
//! 3. Shells that only touch overlap if one is in part within the other, and in part without.
//! 4. Any other is within or without each of the others as a whole: a ray from a face tells, of
//!    which each crossing counts once. How often the others go around it is the sum of their signs.
//!    It fits if they do not at all, or once the other way: a cavity.

use std::cmp::Ordering;
use std::collections::HashSet;

use super::meeting::cross;
use super::report::FindingCollector;
use super::self_intersections::{face, meets};
use super::shells::Shell;
use super::subject::Subject;
use crate::accel::Bvh;
use crate::error::Result;
use crate::geometry::{Bounds, DVec3, Ray};
use crate::memory;
use crate::shape::triangle::{EdgeRule, Shear};
use crate::watch::{Watch, stop_if_asked};

/// The number of no shell that is looked at.
const NONE: u32 = u32::MAX;

/// A shell with fewer faces is looked through.
const FEW: usize = 1000;

pub(super) fn check(
    subject: &Subject<'_>,
    found: &mut FindingCollector<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    let shells = subject.shells(watch)?;
    if shells.len() < 2 {
        return Ok(());
    }
    let boxes: Vec<Bounds> = shells.iter().map(|shell| shell.bounds(subject)).collect();
    let count = u32::try_from(shells.len()).unwrap_or(u32::MAX);
    let tree = Bvh::build_watched(count, |k| boxes[k as usize], 0.0, watch)?;
    let mut stack = Vec::new();
    let mut is_beside = |k: usize| {
        let overlaps = |other: u32| other as usize != k && share(boxes[k], boxes[other as usize]);
        tree.any_overlapping(boxes[k], &mut stack, overlaps)
    };
    let beside: Vec<usize> = (0..shells.len()).filter(|&k| is_beside(k)).collect();
    if beside.is_empty() {
        return Ok(());
    }
    let mut all = Beside::new(subject, shells, &boxes, &beside, watch)?;
    let mut overlaps = vec![false; shells.len()];
    let mut touched = vec![Vec::new(); shells.len()];
    for &k in &beside {
        all.meet(k, &mut overlaps, &mut touched[k], watch)?;
    }
    for &k in &beside {
        stop_if_asked(watch)?;
        if !overlaps[k] {
            all.place(k, &mut overlaps, &touched[k], watch)?;
        }
    }
    for k in (0..shells.len()).filter(|&k| overlaps[k]) {
        let faces = &shells[k].faces;
        found.add(subject, faces, subject.middle(faces[0]));
    }
    Ok(())
}

fn touch(a: Bounds, b: Bounds) -> bool {
    a.low.cmple(b.high).all() && b.low.cmple(a.high).all()
}

/// Whether two boxes have room in common.
fn share(a: Bounds, b: Bounds) -> bool {
    a.low.cmplt(b.high).all() && b.low.cmplt(a.high).all()
}

/// Shells whose boxes have room in common, and a tree over their faces.
struct Beside<'a> {
    subject: &'a Subject<'a>,
    shells: &'a [Shell],
    boxes: &'a [Bounds],
    /// The shell of each triangle, or [`NONE`].
    shell_of: Vec<u32>,
    faces: Vec<u32>,
    tree: Bvh,
    stack: Vec<u32>,
    /// Nearer to a plane than this, rounding may have put a point on the wrong side.
    rounding: f64,
}

impl<'a> Beside<'a> {
    fn new(
        subject: &'a Subject<'a>,
        shells: &'a [Shell],
        boxes: &'a [Bounds],
        beside: &[usize],
        watch: &dyn Watch,
    ) -> Result<Self> {
        let mut shell_of = memory::filled(subject.len() as usize, NONE)?;
        let mut faces = Vec::new();
        for &k in beside {
            for &triangle in &shells[k].faces {
                if subject.has_area[triangle as usize] {
                    shell_of[triangle as usize] = u32::try_from(k).unwrap_or(NONE);
                    faces.push(triangle);
                }
            }
        }
        let count = u32::try_from(faces.len()).unwrap_or(u32::MAX);
        let bounds = |k: u32| Bounds::of(subject.corners(faces[k as usize]));
        let tree = Bvh::build_watched(count, bounds, 0.0, watch)?;
        let Bounds { low, high } = subject.mesh.bounds();
        Ok(Self {
            subject,
            shells,
            boxes,
            shell_of,
            faces,
            tree,
            stack: Vec::new(),
            rounding: 64.0 * f64::EPSILON * low.abs().max(high.abs()).max_element(),
        })
    }

    /// Notes whether a shell is cut by another, and which ones it touches, if it is not.
    fn meet(
        &mut self,
        k: usize,
        overlaps: &mut [bool],
        touched: &mut Vec<u32>,
        watch: &dyn Watch,
    ) -> Result<()> {
        let Self { subject, boxes, shell_of, faces, .. } = self;
        let mut seen: HashSet<u32> = touched.iter().copied().collect();
        for &triangle in &self.shells[k].faces {
            stop_if_asked(watch)?;
            if overlaps[k] || shell_of[triangle as usize] == NONE {
                continue;
            }
            let own = face(subject, triangle);
            let bounds = Bounds::of(own.corners);
            let mut cut_by = None;
            self.tree.any_overlapping(bounds, &mut self.stack, |other| {
                let other = faces[other as usize];
                let shell = shell_of[other as usize];
                if shell as usize == k || !share(boxes[k], boxes[shell as usize]) {
                    return false;
                }
                let is_touched = seen.contains(&shell);
                if is_touched || meets(subject, &own, bounds, other) {
                    if cross(&own, &face(subject, other)) {
                        cut_by = Some(shell);
                    } else if seen.insert(shell) {
                        touched.push(shell);
                    }
                }
                cut_by.is_some()
            });
            if let Some(other) = cut_by {
                (overlaps[k], overlaps[other as usize]) = (true, true);
            }
        }
        Ok(())
    }

    /// Notes whether a shell overlaps others, none of which has an edge that goes through a face of
    /// it.
    fn place(
        &mut self,
        k: usize,
        overlaps: &mut [bool],
        touched: &[u32],
        watch: &dyn Watch,
    ) -> Result<()> {
        for &other in touched {
            stop_if_asked(watch)?;
            let other = other as usize;
            if self.is_parted(k, other) || self.is_parted(other, k) {
                (overlaps[k], overlaps[other]) = (true, true);
            }
        }
        if overlaps[k] {
            return Ok(());
        }
        let (subject, sign) = (self.subject, self.sign(k));
        for &triangle in &self.shells[k].faces {
            let start = subject.middle(triangle);
            if self.shell_of[triangle as usize] != NONE && !self.is_near(start, touched) {
                let around = self.around(start);
                let turns = self.turns(&around) - self.own_turn(k, &around);
                overlaps[k] = sign != 0 && turns != 0 && turns != -sign;
                return Ok(());
            }
        }
        // Others are all around it: what is inside tells.
        let faces = &self.shells[k].faces;
        let sum: DVec3 = faces.iter().map(|&face| subject.middle(face)).sum();
        let around = self.around(sum / faces.len() as f64);
        overlaps[k] = self.own_turn(k, &around) != 0 && self.turns(&around).abs() > 1;
        Ok(())
    }

    /// Whether the surface of a shell is in part within another one, and in part without.
    fn is_parted(&mut self, k: usize, other: usize) -> bool {
        let (own, bounds) = (self.boxes[k], self.boxes[other]);
        let mut is_without = !(bounds.contains(own.low) && bounds.contains(own.high));
        let mut is_within = false;
        let faces = &self.shells[k].faces;
        let is_there = |&face: &u32| {
            let Bounds { low, high } = Bounds::of(self.subject.corners(face));
            low.cmple(bounds.high).all() && bounds.low.cmple(high).all()
        };
        let mut candidates = Vec::new();
        if faces.len() < FEW {
            // Where many small shells are on a large one, its box has all their faces.
            let there = faces.iter().copied().filter(is_there);
            candidates.extend(there.filter(|&face| self.shell_of[face as usize] != NONE));
        } else {
            self.tree.any_overlapping(bounds, &mut self.stack, |face| {
                let face = self.faces[face as usize];
                if self.shell_of[face as usize] as usize == k {
                    candidates.push(face);
                }
                false
            });
        }
        let other = [u32::try_from(other).unwrap_or(NONE)];
        for face in candidates {
            let start = self.subject.middle(face);
            if !bounds.contains(start) || self.is_near(start, &other) {
                continue;
            }
            if self.around(start).contains(&other[0]) {
                is_within = true;
            } else {
                is_without = true;
            }
            if is_within && is_without {
                return true;
            }
        }
        false
    }

    /// Whether rounding decides on which side of a face of some shells a point is.
    fn is_near(&mut self, point: DVec3, shells: &[u32]) -> bool {
        let reach = DVec3::splat(self.rounding);
        let bounds = Bounds { low: point - reach, high: point + reach };
        self.tree.any_overlapping(bounds, &mut self.stack, |other| {
            let other = self.faces[other as usize];
            let corners = self.subject.corners(other);
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a);
            shells.contains(&self.shell_of[other as usize])
                && touch(Bounds::of(corners), bounds)
                && normal.dot(point - a).abs() <= self.rounding * normal.length()
        })
    }

    /// The shells that a point is in, by how often a ray from there crosses each.
    fn around(&mut self, start: DVec3) -> Vec<u32> {
        let shear = Shear::new(&Ray::new(start, DVec3::X));
        let far = DVec3::new(self.subject.mesh.bounds().high.x, start.y, start.z);
        let mut crossings: Vec<u32> = Vec::new();
        let line = Bounds::of([start, far]);
        self.tree.any_overlapping(line, &mut self.stack, |other| {
            let other = self.faces[other as usize];
            let corners = self.subject.corners(other);
            let hit = shear.intersect_with(EdgeRule::Once, corners);
            if hit.is_some_and(|hit| hit.t > 0.0) {
                crossings.push(self.shell_of[other as usize]);
            }
            false
        });
        crossings.sort_unstable();
        let odd = crossings.chunk_by(|a, b| a == b);
        let odd = odd.filter(|same| same.len() % 2 == 1);
        odd.map(|same| same[0]).collect()
    }

    /// The number of times that some shells go around what is in all of them.
    fn turns(&self, shells: &[u32]) -> i32 {
        shells.iter().map(|&shell| self.sign(shell as usize)).sum()
    }

    /// The turns of a shell itself around a point, to be taken from the turns of all.
    fn own_turn(&self, k: usize, around: &[u32]) -> i32 {
        let is_in = around.iter().any(|&shell| shell as usize == k);
        if is_in { self.sign(k) } else { 0 }
    }

    fn sign(&self, k: usize) -> i32 {
        match self.shells[k].sign {
            Ordering::Less => -1,
            Ordering::Equal => 0,
            Ordering::Greater => 1,
        }
    }
}
