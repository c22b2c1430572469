//! The list of what is looked for.

use std::sync::OnceLock;

use super::holes::BoundaryEdge;
use super::report::FindingCollector;
use super::subject::Subject;
use super::{Facts, edges, faces, holes, overlaps, scale, self_intersections, shells, vertices};
use crate::error::{Error, Result};
use crate::parallel;
use crate::watch::Watch;

/// Something that can be wrong with a mesh or a scene.
#[derive(Debug, Clone, Copy)]
pub struct FindingKind {
    /// The name.
    pub name: &'static str,
    /// The counted thing, in the singular.
    pub counted: &'static str,
    /// The meaning, in a sentence.
    pub about: &'static str,
    /// The colour of its faces where they are marked, sRGB.
    pub color: [u8; 3],
    pub(super) check: Check,
}

impl PartialEq for FindingKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

type OfMesh = fn(&Subject<'_>, &mut FindingCollector<'_>, &dyn Watch) -> Result<()>;
type OfBoundaryEdges = fn(&mut [BoundaryEdge], &mut FindingCollector<'_>, &dyn Watch) -> Result<()>;
type OfScene = fn(&Facts<'_>, &mut FindingCollector<'_>, &dyn Watch) -> Result<()>;

/// The check that looks for a kind.
#[derive(Debug, Clone, Copy)]
pub(super) enum Check {
    /// A check of each mesh alone.
    Mesh(OfMesh),
    /// Among the boundary edges of all objects, afterwards.
    BoundaryEdges(OfBoundaryEdges),
    /// A check of all meshes together, afterwards.
    Scene(OfScene),
}

/// All kinds. A face of several is marked as the first of them.
pub const KINDS: &[FindingKind] = &[
    FindingKind {
        name: "self-intersection",
        counted: "face",
        about: "faces that meet other faces of the mesh elsewhere than at the vertices and edges they share",
        color: [220, 30, 30],
        check: Check::Mesh(self_intersections::check),
    },
    FindingKind {
        name: "non-manifold",
        counted: "edge",
        about: "edges at which more than two faces meet",
        color: [230, 120, 20],
        check: Check::Mesh(edges::non_manifold),
    },
    FindingKind {
        name: "winding",
        counted: "edge",
        about: "edges at which two faces meet whose windings disagree: one of them is flipped",
        color: [230, 200, 20],
        check: Check::Mesh(edges::winding),
    },
    FindingKind {
        name: "inside-out",
        counted: "shell",
        about: "closed surfaces with a negative volume that are no cavity of another",
        color: [150, 60, 200],
        check: Check::Mesh(shells::inside_out),
    },
    FindingKind {
        name: "overlap",
        counted: "shell",
        about: "closed surfaces that cut others of their mesh, or are within some that face the same way: the rule decides what is inside",
        color: [120, 200, 60],
        check: Check::Mesh(overlaps::check),
    },
    FindingKind {
        name: "duplicate",
        counted: "face",
        about: "faces whose corners are those of an earlier face, in any order",
        color: [40, 170, 200],
        check: Check::Mesh(faces::duplicate),
    },
    FindingKind {
        name: "degenerate",
        counted: "face",
        about: "faces whose area is exactly zero",
        color: [230, 60, 180],
        check: Check::Mesh(faces::degenerate),
    },
    FindingKind {
        name: "hole",
        counted: "edge",
        about: "edges with one face only, unless the face at the other side belongs to another object",
        color: [40, 90, 220],
        check: Check::BoundaryEdges(holes::check),
    },
    FindingKind {
        name: "non-finite",
        counted: "vertex",
        about: "vertices with a coordinate that is NaN or infinite",
        color: [0, 0, 0],
        check: Check::Scene(vertices::non_finite),
    },
    FindingKind {
        name: "unreferenced",
        counted: "vertex",
        about: "vertices that no face uses",
        color: [0, 0, 0],
        check: Check::Scene(vertices::unreferenced),
    },
    FindingKind {
        name: "far",
        counted: "mesh",
        about: "float32 meshes so far from the origin that neighbouring float32 coordinates are more than 1/16384 of their size apart",
        color: [0, 0, 0],
        check: Check::Mesh(scale::far),
    },
    FindingKind {
        name: "units",
        counted: "scene",
        about: "a scene that is smaller than a thousandth of its unit, or larger than a million: the unit may be mistaken",
        color: [0, 0, 0],
        check: Check::Scene(scale::units),
    },
];

/// The names of all.
fn names() -> &'static str {
    static NAMES: OnceLock<String> = OnceLock::new();
    parallel::once::<String>(&NAMES, || {
        let names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
        format!("one of {}", names.join(", "))
    })
}

impl FindingKind {
    /// The kind of that name.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] where there is none.
    pub fn named(name: &str) -> Result<&'static Self> {
        let found = KINDS.iter().find(|kind| kind.name == name);
        found.ok_or_else(|| Error::argument("kind", names(), name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_found_by_its_name_and_offered() {
        let error = FindingKind::named("leak").unwrap_err().to_string();
        for kind in KINDS {
            assert_eq!(FindingKind::named(kind.name).unwrap(), kind);
            assert!(error.contains(kind.name), "{error}");
        }
    }
}
