//! Checks meshes for likely faults: holes, flipped faces, self-intersections and more.
//!
//! A [`FindingKind`] is a row of [`KINDS`]. Most look at each mesh by itself; objects that share a
//! mesh are looked at once. Vertices in one place are one, to the last bit, whether or not
//! triangles share them by index. All that decides is exact: areas, volumes and whether triangles
//! meet are signs of determinants on the float64 numbers.

mod edges;
mod faces;
mod holes;
mod kinds;
#[cfg(feature = "frame")]
mod marked;
mod meeting;
mod overlaps;
mod report;
mod scale;
mod self_intersections;
mod shells;
mod subject;
mod vertices;

use std::collections::HashMap;
use std::sync::Arc;

pub use kinds::{FindingKind, KINDS};
#[cfg(feature = "frame")]
pub use marked::save_marked;
pub use report::{Finding, Place, Report};

use crate::error::Result;
use crate::geometry::Transform;
use crate::memory;
use crate::scene::{Object, Scene};
use crate::shape::Mesh;
use crate::watch::Watch;
use holes::BoundaryEdge;
use kinds::Check;
use report::{FindingCollector, Marks, NO_MARK};
use subject::Subject;

/// The kinds to look for, and the number of places to tell.
#[derive(Debug, Clone, PartialEq)]
pub struct LintSettings {
    /// Kinds that are not looked for.
    pub ignore: Vec<&'static FindingKind>,
    /// The number of places of each kind that are told.
    pub places: usize,
}

impl Default for LintSettings {
    /// Every kind, with ten places.
    fn default() -> Self {
        Self { ignore: Vec::new(), places: 10 }
    }
}

/// The input of the checks of the whole scene.
struct Facts<'a> {
    scene: &'a Scene,
    /// The distinct meshes, each with the first object that has it.
    meshes: Vec<(i32, &'a Mesh)>,
}

/// Checks the meshes of `scene` for likely faults: see [`KINDS`]. `watch` may end it.
///
/// ```
/// use std::sync::Arc;
///
/// use firsthit::lint::{LintSettings, lint};
/// use firsthit::{Mesh, Object, Positions, Scene};
///
/// // A tetrahedron without one of its faces.
/// let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
/// let mesh = Mesh::new(Positions::compact(corners), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]])?;
/// let scene = Scene::new(vec![Object::new(Arc::new(mesh))])?;
/// let report = lint(&scene, &LintSettings::default(), &())?;
/// let [hole] = report.findings() else { panic!("one finding") };
/// assert_eq!((hole.kind.name, hole.count, &*hole.note), ("hole", 3, "around 1 hole"));
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Limit`](crate::error::Error::Limit) when memory is short, and
/// [`Error::Interrupted`](crate::error::Error::Interrupted).
pub fn lint(scene: &Scene, settings: &LintSettings, watch: &dyn Watch) -> Result<Report> {
    let is_wanted = |kind: &&FindingKind| !settings.ignore.contains(kind);
    let checked: Vec<&'static FindingKind> = KINDS.iter().filter(is_wanted).collect();
    let (mut marks, of_objects) = distinct(scene)?;
    let mut drafts: Vec<Draft> = checked.iter().map(|&kind| Draft::new(kind)).collect();
    let mut facts = Facts { scene, meshes: Vec::new() };
    let of_boundary_edges = |kind: &&FindingKind| matches!(kind.check, Check::BoundaryEdges(_));
    let wants_boundary_edges = checked.iter().any(of_boundary_edges);
    let mut boundary_edges = Vec::new();
    let checks = checked.len() as u64 + 1;
    let all: u64 = (marks.iter().map(|marks| marks.of_triangles.len() as u64)).sum();
    watch.begin("checking meshes", checks * all, "checks");
    for index in 0..marks.len() {
        let object = usize::try_from(marks[index].objects[0]).unwrap_or(0);
        let Some((object, mesh)) = with_mesh(scene, object) else {
            continue;
        };
        let subject = Subject::new([index, object.0], mesh, object.1.transform(), watch)?;
        let triangles = u64::from(subject.len());
        watch.advance(triangles);
        facts.meshes.push((marks[index].objects[0], mesh));
        if wants_boundary_edges {
            add_boundary_edges(scene, (&subject, &marks[index].objects), &mut boundary_edges)?;
        }
        for draft in &mut drafts {
            if let Check::Mesh(check) = draft.kind.check {
                draft.take(&mut marks, settings, |found| check(&subject, found, watch))?;
                watch.advance(triangles);
            }
        }
    }
    for draft in &mut drafts {
        match draft.kind.check {
            Check::Mesh(_) => continue,
            Check::BoundaryEdges(check) => draft
                .take(&mut marks, settings, |found| check(&mut boundary_edges, found, watch))?,
            Check::Scene(check) => {
                draft.take(&mut marks, settings, |found| check(&facts, found, watch))?;
            }
        }
        watch.advance(all);
    }
    let findings = drafts.into_iter().filter_map(Draft::finding).collect();
    Ok(Report { findings, checked, marks, of_objects })
}

/// Adds the edges with one face, of all objects that have a mesh.
fn add_boundary_edges(
    scene: &Scene,
    (subject, objects): (&Subject<'_>, &[i32]),
    all: &mut Vec<BoundaryEdge>,
) -> Result<()> {
    let single = holes::boundary_edges(subject, 0, &Transform::IDENTITY).count();
    let count = single.saturating_mul(objects.len());
    // They are copied once more, and sorted by their places.
    let bytes = count.saturating_add(all.len()).saturating_mul(3 * size_of::<BoundaryEdge>());
    memory::check("the edges of holes", bytes)?;
    for &object in objects {
        let placed = with_mesh(scene, usize::try_from(object).unwrap_or(0));
        let transform = placed.map_or(subject.transform, |((_, object), _)| object.transform());
        all.extend(holes::boundary_edges(subject, object, transform));
    }
    Ok(())
}

fn with_mesh(scene: &Scene, object: usize) -> Option<((usize, &Object), &Arc<Mesh>)> {
    let it = scene.objects().get(object)?;
    Some(((object, it), it.mesh()?))
}

/// The distinct meshes, with nothing marked, and which of them each object has.
fn distinct(scene: &Scene) -> Result<(Vec<Marks>, Vec<Option<u32>>)> {
    let mut known: HashMap<*const Mesh, u32> = HashMap::new();
    let mut distinct: Vec<Marks> = Vec::new();
    let mut of_objects = memory::filled(scene.objects().len(), None)?;
    for ((identifier, object), of_object) in (0..).zip(scene.objects()).zip(&mut of_objects) {
        let Some(mesh) = object.mesh() else {
            continue;
        };
        let next = u32::try_from(distinct.len()).unwrap_or(u32::MAX);
        let index = *known.entry(Arc::as_ptr(mesh)).or_insert(next);
        *of_object = Some(index);
        if let Some(marks) = distinct.get_mut(index as usize) {
            marks.objects.push(identifier);
            continue;
        }
        distinct.push(Marks {
            objects: vec![identifier],
            of_triangles: memory::filled(mesh.triangles().len(), NO_MARK)?,
        });
    }
    Ok((distinct, of_objects))
}

/// A finding in the making.
struct Draft {
    kind: &'static FindingKind,
    mark: u8,
    count: u64,
    places: Vec<Place>,
    note: String,
}

impl Draft {
    fn new(kind: &'static FindingKind) -> Self {
        let mark = KINDS.iter().position(|other| other == kind);
        Self {
            kind,
            mark: mark.and_then(|k| u8::try_from(k).ok()).unwrap_or(NO_MARK),
            count: 0,
            places: Vec::new(),
            note: String::new(),
        }
    }

    /// Adds what a check finds.
    fn take(
        &mut self,
        marks: &mut [Marks],
        settings: &LintSettings,
        check: impl FnOnce(&mut FindingCollector<'_>) -> Result<()>,
    ) -> Result<()> {
        let mut found = FindingCollector {
            mark: self.mark,
            most_places: settings.places,
            marks,
            count: self.count,
            places: std::mem::take(&mut self.places),
            note: std::mem::take(&mut self.note),
        };
        check(&mut found)?;
        (self.count, self.places, self.note) = (found.count, found.places, found.note);
        Ok(())
    }

    fn finding(self) -> Option<Finding> {
        (self.count > 0).then_some(Finding {
            kind: self.kind,
            count: self.count,
            places: self.places,
            note: self.note,
        })
    }
}
