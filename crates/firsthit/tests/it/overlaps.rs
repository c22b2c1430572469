//! Which shells of a mesh `lint` tells to overlap, whichever way their faces are turned; judged by
//! arithmetic on boxes.

use firsthit::lint::Report;
use firsthit::{DVec3, Object};

use crate::support::{Ask, CUBE, Numbers, cases, mesh, scene};

/// A box, and how often its faces go around what is in it.
#[derive(Debug, Clone, Copy)]
struct Part {
    low: DVec3,
    high: DVec3,
    turns: i32,
    /// So many of its faces are flipped: fewer than half.
    flipped: usize,
}

impl Part {
    fn holds(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && other.high.cmple(self.high).all()
    }

    /// Whether they have some room in common, and each has some for itself.
    fn cuts(&self, other: &Self) -> bool {
        let is_apart = self.high.cmple(other.low).any() || other.high.cmple(self.low).any();
        !is_apart && !self.holds(other) && !other.holds(self)
    }

    /// Whether they have a whole face in common, so that they are one surface.
    fn has_a_face_of(&self, other: &Self) -> bool {
        (0..3).any(|axis| {
            let [own, others] = [self, other].map(|part| [part.low[axis], part.high[axis]]);
            let is_alike = |k| self.low[k] == other.low[k] && self.high[k] == other.high[k];
            own.iter().any(|x| others.contains(x)) && (0..3).filter(|&k| k != axis).all(is_alike)
        })
    }
}

fn part(low: [f64; 3], high: [f64; 3], turns: i32, flipped: usize) -> Part {
    let [low, high] = [low, high].map(DVec3::from);
    Part { low, high, turns, flipped }
}

fn lint(parts: &[Part], numbers: &mut Numbers) -> Report {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for part in parts {
        let first = points.len() as u32;
        points.extend((0..8).map(|k| {
            let pick = |axis: usize| [part.low, part.high][k >> axis & 1][axis];
            DVec3::new(pick(0), pick(1), pick(2))
        }));
        let mut faces = CUBE.map(|face| face.map(|k| k + first));
        let mut is_flipped = [part.turns < 0; 12];
        let mut left = part.flipped;
        while left > 0 {
            let flip = &mut is_flipped[numbers.below(12)];
            left -= usize::from(*flip == (part.turns < 0));
            *flip = part.turns > 0;
        }
        for (face, is_flipped) in faces.iter_mut().zip(is_flipped) {
            if is_flipped {
                face.swap(0, 1);
            }
        }
        triangles.extend(faces);
    }
    scene(vec![Object::new(mesh(&points, triangles))]).lint().unwrap()
}

fn count(report: &Report, kind: &str) -> u64 {
    let mut findings = report.findings().iter();
    findings.find(|f| f.kind.name == kind).map_or(0, |f| f.count)
}

/// The parts that cut others, and those with points that are enclosed more than once by parts
/// around them.
fn overlapping(parts: &[Part]) -> u64 {
    let overlaps = |part: &&Part| {
        let around = parts.iter().filter(|other| other.holds(part) && !std::ptr::eq(*other, *part));
        let turns: i32 = around.map(|other| other.turns).sum();
        let most = turns.abs().max((turns + part.turns).abs());
        most > 1 || parts.iter().any(|other| part.cuts(other) && !std::ptr::eq(*part, other))
    };
    parts.iter().filter(overlaps).count() as u64
}

#[test]
fn boxes_that_overlap_are_told_whichever_faces_of_them_are_flipped() {
    let mut numbers = Numbers::new(461);
    let mut seen = [0; 4];
    for _ in 0..cases(2_000) {
        let parts: Vec<Part> = (0..2 + numbers.below(3))
            .map(|_| {
                let size = [2.0, 0.5, 0.1][numbers.below(3)];
                let low = numbers.point();
                let side = |numbers: &mut Numbers| size * (0.5 + numbers.unit());
                let sides = DVec3::new(side(&mut numbers), side(&mut numbers), side(&mut numbers));
                Part {
                    low: low - 0.5 * sides,
                    high: low + 0.5 * sides,
                    turns: [1, -1][numbers.below(2)],
                    flipped: numbers.below(6),
                }
            })
            .collect();
        let wanted = overlapping(&parts);
        let report = lint(&parts, &mut numbers);
        assert_eq!(count(&report, "overlap"), wanted, "{parts:?}");
        seen[wanted.min(3) as usize] += 1;
    }
    assert!(seen.iter().all(|&cases| cases > 10), "{seen:?}");
}

#[test]
fn boxes_that_only_touch_are_no_overlap() {
    let mut numbers = Numbers::new(462);
    let mut seen = [0; 4];
    for _ in 0..cases(3_000) {
        let parts: Vec<Part> = (0..2 + numbers.below(2))
            .map(|_| {
                let mut place = || DVec3::from([(); 3].map(|()| numbers.below(5) as f64));
                let (low, size) = (place(), place());
                Part {
                    low: low / 3.0,
                    high: (low + size + 1.0) / 3.0,
                    turns: [1, -1][numbers.below(2)],
                    flipped: [0, 3][numbers.below(2)],
                }
            })
            .collect();
        let mut pairs = parts.iter().enumerate();
        if pairs.any(|(k, part)| parts[..k].iter().any(|other| part.has_a_face_of(other))) {
            continue;
        }
        let wanted = overlapping(&parts);
        let report = lint(&parts, &mut numbers);
        assert_eq!(count(&report, "overlap"), wanted, "{parts:?}");
        seen[wanted as usize] += 1;
    }
    assert!(seen.iter().all(|&cases| cases > 0), "{seen:?}");
}

#[test]
fn a_flipped_face_makes_no_overlap_of_nested_boxes_and_of_boxes_that_touch() {
    let outer = |flipped| part([-1.0; 3], [1.0; 3], 1, flipped);
    for (flipped, seed) in (0..6).zip(7..) {
        let mut numbers = Numbers::new(seed);
        for others in [
            // A cavity, a solid in it, and another cavity beside them.
            vec![part([-0.5; 3], [0.5; 3], -1, flipped)],
            vec![
                part([-0.5; 3], [0.5; 3], -1, flipped),
                part([-0.25; 3], [0.25; 3], 1, 5 - flipped),
                part([0.6; 3], [0.8; 3], -1, flipped),
            ],
            // A face, part of a face, an edge and a corner in common, and a cavity at the side.
            vec![part([1.0, -1.0, -1.0], [3.0, 1.0, 1.0], 1, flipped)],
            vec![part([1.0, -0.5, 0.0], [3.0, 4.0, 0.5], 1, flipped)],
            vec![part([-1.0, -0.5, -0.5], [0.5, 0.5, 0.25], -1, flipped)],
            vec![part([1.0, 1.0, -1.0], [3.0, 3.0, 1.0], 1, flipped)],
            vec![part([1.0; 3], [3.0; 3], 1, flipped)],
        ] {
            let parts = [vec![outer(flipped)], others].concat();
            let report = lint(&parts, &mut numbers);
            assert_eq!(count(&report, "overlap"), 0, "{parts:?}");
            assert_eq!(count(&report, "inside-out"), 0, "{parts:?}");
        }
    }
}

#[test]
fn a_box_inside_out_is_told_although_a_face_of_it_is_flipped() {
    for flipped in 0..6 {
        let inwards = part([0.0; 3], [1.0; 3], -1, flipped);
        let report = lint(&[inwards], &mut Numbers::new(3));
        assert_eq!(count(&report, "inside-out"), 1);
        let outwards = part([0.0; 3], [1.0; 3], 1, flipped);
        let report = lint(&[outwards], &mut Numbers::new(3));
        assert_eq!(count(&report, "inside-out"), 0);
    }
}
