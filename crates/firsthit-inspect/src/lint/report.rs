//! The report: counts, places, and the faces that are concerned.

use std::fmt::{self, Debug, Formatter};

use super::kinds::FindingKind;
use super::subject::Subject;
use crate::geometry::DVec3;

/// The findings about a scene, from [`lint`](super::lint).
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub(super) findings: Vec<Finding>,
    pub(super) checked: Vec<&'static FindingKind>,
    pub(super) marks: Vec<Marks>,
    /// The index of the marks of each object's mesh.
    pub(super) of_objects: Vec<Option<u32>>,
}

impl Report {
    /// The findings: one for each kind that there is, in the order of [`KINDS`](super::KINDS).
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// Whether nothing was found.
    pub fn is_clean(&self) -> bool {
        self.findings.is_empty()
    }

    /// The kinds that were looked for.
    pub fn checked(&self) -> &[&'static FindingKind] {
        &self.checked
    }

    /// The first kind of which each triangle of an object's mesh is a part, in the order of
    /// [`KINDS`](super::KINDS). Objects that share a mesh have equal ones. `None` for an object
    /// without a mesh.
    pub fn marked(
        &self,
        object: usize,
    ) -> Option<impl ExactSizeIterator<Item = Option<&'static FindingKind>>> {
        let index = (*self.of_objects.get(object)?)?;
        let marks = self.marks.get(index as usize)?;
        let kind = |&mark: &u8| super::KINDS.get(usize::from(mark));
        Some(marks.of_triangles.iter().map(kind))
    }
}

/// The first kind of each triangle of a mesh, [`NO_MARK`] for none.
#[derive(Clone, PartialEq)]
pub(super) struct Marks {
    /// The objects with the mesh.
    pub(super) objects: Vec<i32>,
    pub(super) of_triangles: Vec<u8>,
}

/// The mark of no kind.
pub(super) const NO_MARK: u8 = u8::MAX;

/// A summary: triangles are many.
impl Debug for Marks {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let marked = self.of_triangles.iter().filter(|&&mark| mark != NO_MARK);
        f.debug_struct("Marks")
            .field("objects", &self.objects.len())
            .field("marked", &marked.count())
            .finish_non_exhaustive()
    }
}

/// All of one kind that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The kind.
    pub kind: &'static FindingKind,
    /// The number of things found; the kind says of what.
    pub count: u64,
    /// The first of them, as many as were asked for.
    pub places: Vec<Place>,
    /// A note on all of them, in words; may be empty.
    pub note: String,
}

/// The place of a finding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The object's identifier; of objects that share a mesh the first in which it is found. `None`
    /// where it is about the whole scene.
    pub object: Option<i32>,
    /// A triangle of its mesh, if it is about one.
    pub primitive: Option<i32>,
    /// A point in world space. It is NaN where the finding is that a vertex is nowhere.
    pub position: DVec3,
}

/// Collects what a check finds.
pub(super) struct FindingCollector<'a> {
    pub(super) mark: u8,
    pub(super) most_places: usize,
    pub(super) marks: &'a mut [Marks],
    pub(super) count: u64,
    pub(super) places: Vec<Place>,
    pub(super) note: String,
}

impl FindingCollector<'_> {
    /// Counts one in a subject, at a point of object space, and marks its triangles, of which the
    /// first is its place.
    pub(super) fn add(&mut self, subject: &Subject<'_>, triangles: &[u32], position: DVec3) {
        let place = || Place {
            object: Some(subject.object),
            primitive: triangles.first().map(|&triangle| primitive(triangle)),
            position: subject.in_world(position),
        };
        self.add_at(subject.index, triangles, place);
    }

    /// Adds a finding of the subject that has an index.
    pub(super) fn add_at(
        &mut self,
        subject: usize,
        triangles: &[u32],
        place: impl FnOnce() -> Place,
    ) {
        self.count += 1;
        if self.places.len() < self.most_places {
            self.places.push(place());
        }
        for &triangle in triangles {
            let mark = &mut self.marks[subject].of_triangles[triangle as usize];
            *mark = self.mark.min(*mark);
        }
    }

    /// Counts one that is about no triangle, or about no object either.
    pub(super) fn add_elsewhere(&mut self, object: Option<i32>, position: DVec3) {
        self.count += 1;
        if self.places.len() < self.most_places {
            self.places.push(Place { object, primitive: None, position });
        }
    }
}

pub(super) fn primitive(triangle: u32) -> i32 {
    i32::try_from(triangle).unwrap_or(i32::MAX)
}
