//! Sections: the curves in which a plane cuts the meshes of a scene.
//!
//! 1. Decide for each corner of each triangle on which side of the plane it is, in exact arithmetic
//!    on the float64 numbers. A corner on the plane counts as one on the positive side. This is the
//!    simplest case of simulation of simplicity (Edelsbrunner and Mücke, ACM Transactions on
//!    Graphics 9(1), 1990): the plane is moved back by less than any number.
//! 2. Each triangle with corners on both sides gives one segment between two of its edges.
//! 3. Compute the crossing of each edge once, from its two ends in a fixed order.
//! 4. Join segments at the edges that they share (`join.rs`), which are told apart by the places of
//!    their ends. So triangles join that have vertices of their own, as those of STL files have.
//! 5. Where all are closed, they become the outlines of what is inside (`outline.rs`), by the rule
//!    that all measures of solids have.
//!
//! The polylines of a closed mesh are therefore closed, whatever lies on the plane. A face in the
//! plane is cut if the solid is below it, and not if it is above. Where a mesh touches the plane
//! from below, at an edge or at a face of no thickness, a polyline goes there and back; where it
//! touches at a point there is nothing.

mod arrange;
#[cfg(feature = "frame")]
mod format;
mod join;
mod outline;
mod planar;
mod plane;
mod segments;

use std::fmt::{self, Debug, Formatter};

#[cfg(feature = "frame")]
pub use format::{SECTION_FORMATS, SectionFormat};
pub use plane::SectionPlane;

use crate::error::{Result, escape_controls};
use crate::geometry::summary::Count;
use crate::geometry::{DVec2, DVec3};
use crate::scene::{Object, Scene};
use crate::shape::Facing;
use crate::solid::FillRule;
use crate::watch::Watch;
use outline::Outlines;
use segments::Placed;

/// The curves of a plane through a scene, in the order of objects and, of each object, of the
/// lowest primitive.
#[derive(Clone, PartialEq)]
pub struct Section {
    plane: SectionPlane,
    points: Vec<DVec3>,
    primitives: Vec<i32>,
    extents: Vec<Extent>,
    left_out: Vec<i32>,
    warnings: Vec<String>,
}

/// A polyline's object, and which points and primitives are its own, from the first up to the last,
/// that one excluded.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extent {
    object: i32,
    is_closed: bool,
    points: [usize; 2],
    segments: [usize; 2],
}

impl Extent {
    /// The number of points.
    fn len(&self) -> usize {
        self.points[1] - self.points[0]
    }
}

/// A curve of a [`Section`].
///
/// A closed one runs so that the inside of a solid is on its left, seen from where the plane's
/// normal points: counter-clockwise around material, clockwise around holes. An open one runs as
/// its triangle of the lowest number says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polyline<'a> {
    /// The object's identifier.
    pub object: i32,
    /// Whether its last point joins its first. It does so where the mesh is closed.
    pub is_closed: bool,
    /// The points, in world space and scene units; of a closed one the first is not repeated. Each
    /// is the crossing of an edge with the plane, next to the nearest float64, or a vertex that is
    /// exactly on the plane; and where curves of a mesh cross each other, a point on both.
    pub points: &'a [DVec3],
    /// The triangle of each segment, the one that starts at the point of the same index; of several
    /// in one place the lowest. An open polyline has one less than points.
    pub primitives: &'a [i32],
}

impl Polyline<'_> {
    /// The length of all segments, in scene units.
    pub fn length(&self) -> f64 {
        let inner: f64 = self.points.windows(2).map(|two| (two[1] - two[0]).length()).sum();
        match self.points {
            [first, .., last] if self.is_closed => inner + (*first - *last).length(),
            _ => inner,
        }
    }

    /// The area inside, in squares of scene units: positive around material, negative around holes.
    /// `None` for an open one.
    pub fn area(&self, plane: &SectionPlane) -> Option<f64> {
        if !self.is_closed {
            return None;
        }
        let (&first, rest) = self.points.split_first()?;
        // Relative to the first point: far from the plane's origin products would round more.
        let place = |point: &DVec3| {
            let offset = *point - first;
            DVec2::new(plane.u().dot(offset), plane.v().dot(offset))
        };
        let twice: f64 = rest.windows(2).map(|two| place(&two[0]).perp_dot(place(&two[1]))).sum();
        Some(0.5 * twice)
    }
}

/// A summary: points are many.
impl Debug for Section {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Section")
            .field("plane", &self.plane)
            .field("polylines", &Count(self.extents.len(), "polylines"))
            .field("points", &Count(self.points.len(), "points"))
            .field("left_out", &self.left_out.len())
            .finish_non_exhaustive()
    }
}

impl Section {
    /// The plane, with the frame of its own coordinates.
    pub fn plane(&self) -> &SectionPlane {
        &self.plane
    }

    /// The number of polylines.
    pub fn len(&self) -> usize {
        self.extents.len()
    }

    /// Whether the plane cuts nothing.
    pub fn is_empty(&self) -> bool {
        self.extents.is_empty()
    }

    /// The polylines, in the order of objects and, of each object, of the lowest primitive.
    pub fn polylines(&self) -> impl ExactSizeIterator<Item = Polyline<'_>> {
        self.extents.iter().map(|extent| Polyline {
            object: extent.object,
            is_closed: extent.is_closed,
            points: &self.points[extent.points[0]..extent.points[1]],
            primitives: &self.primitives[extent.segments[0]..extent.segments[1]],
        })
    }

    /// The area of all closed polylines, in squares of scene units: outlines less their holes.
    /// Where objects overlap, both count.
    pub fn area(&self) -> f64 {
        let areas = self.polylines().map(|polyline| polyline.area(&self.plane));
        // A sum of nothing is -0.
        0.0 + areas.flatten().sum::<f64>()
    }

    /// The length of all polylines, in scene units.
    pub fn perimeter(&self) -> f64 {
        0.0 + self.polylines().map(|polyline| polyline.length()).sum::<f64>()
    }

    /// The objects that could not be cut, since they are no meshes, or reach beyond 10^150.
    pub fn left_out(&self) -> &[i32] {
        &self.left_out
    }

    /// The doubts about the section, a line for each kind: objects that were left out.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

/// The curves in which a plane cuts all meshes, in world space. `watch` may end it.
///
/// An object with a transform is cut as its vertices are in the world, rounded to float64. Spheres
/// and other shapes that are no meshes are left out, and [`Section::warnings`] says so. See
/// [`section`](crate::section) for what lies on the plane.
///
/// ```
/// use std::sync::Arc;
///
/// use firsthit::section::{SectionPlane, section};
/// use firsthit::{DVec3, Mesh, Object, Positions, Scene};
///
/// let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let mesh = Mesh::new(Positions::compact(corners), faces)?;
/// let scene = Scene::new(vec![Object::new(Arc::new(mesh))])?;
/// let plane = SectionPlane::new(DVec3::new(0.0, 0.0, 1.0), DVec3::Z)?;
/// let section = section(&scene, plane, &())?;
/// let polyline = section.polylines().next().expect("it is cut");
/// assert!(polyline.is_closed);
/// assert_eq!(polyline.points.len(), 3);
/// assert_eq!(section.area(), 0.5);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Limit`](crate::error::Error::Limit) when memory is short, and
/// [`Error::Interrupted`](crate::error::Error::Interrupted).
pub fn section(scene: &Scene, plane: SectionPlane, watch: &dyn Watch) -> Result<Section> {
    section_with(FillRule::default(), scene, plane, watch)
}

/// [`section`] by a rule of the caller's choice for what is inside.
///
/// # Errors
///
/// The errors of [`section`].
pub fn section_with(
    rule: FillRule,
    scene: &Scene,
    plane: SectionPlane,
    watch: &dyn Watch,
) -> Result<Section> {
    let mut section = Section {
        plane,
        points: Vec::new(),
        primitives: Vec::new(),
        extents: Vec::new(),
        left_out: Vec::new(),
        warnings: Vec::new(),
    };
    let mut reasons = [Reason::new("not a mesh"), Reason::new("at coordinates beyond 1e150")];
    let objects = (0..).zip(scene.objects());
    let visible = objects.filter(|(_, object)| !object.is_hidden());
    let triangles = visible.clone().map(|(_, object)| object.triangles() as u64);
    watch.begin("cutting", triangles.sum(), "triangles");
    for (identifier, object) in visible {
        match Placed::new(object) {
            None => reasons[0].add(identifier, object, &mut section),
            Some(placed) if !placed.is_in_range() => {
                reasons[1].add(identifier, object, &mut section);
            }
            Some(placed) => {
                section.cut((identifier, &placed), rule, watch)?;
            }
        }
        watch.advance(object.triangles() as u64);
    }
    section.warnings.extend(reasons.iter().filter_map(Reason::line));
    section.warnings.extend(section.gap_warning());
    if section.is_empty() {
        section.warnings.push("the plane cuts nothing".to_owned());
    }
    Ok(section)
}

impl Section {
    /// Adds the curves of an object.
    fn cut(
        &mut self,
        (identifier, placed): (i32, &Placed<'_>),
        asked: FillRule,
        watch: &dyn Watch,
    ) -> Result<()> {
        let starts = [self.extents.len(), self.points.len(), self.primitives.len()];
        let segments = placed.segments(&self.plane, None, watch)?;
        join::join(identifier, &segments, self, watch)?;
        let is_closed =
            |section: &Self| section.extents[starts[0]..].iter().all(|one| one.is_closed);
        if !is_closed(self) {
            return Ok(());
        }
        let mut outlines = outline::judge(self, starts[0], asked, watch)?;
        let mut rule = asked;
        if !matches!(outlines, Outlines::Done) {
            // Only now it matters how the whole mesh is.
            let facing = placed.facing()?;
            if matches!(facing, Facing::Undecided) && placed.is_closed()? {
                rule = FillRule::Parity;
            }
            if matches!(facing, Facing::Turned(_)) {
                self.extents.truncate(starts[0]);
                self.points.truncate(starts[1]);
                self.primitives.truncate(starts[2]);
                let segments = placed.segments(&self.plane, Some(facing), watch)?;
                join::join(identifier, &segments, self, watch)?;
            }
            outlines = outline::judge(self, starts[0], rule, watch)?;
        }
        let is_arranged = match outlines {
            Outlines::Done => true,
            Outlines::Simple(fates) => {
                outline::apply(self, starts[0], &fates);
                true
            }
            Outlines::Tangled => arrange::arrange(self, starts[0], rule, watch)?,
        };
        if !is_arranged {
            self.warnings.push(format!(
                "the curves of object {identifier} overlap, and their outline could not be found: all of them are there"
            ));
        }
        Ok(())
    }

    /// Adds a closed polyline.
    fn add_closed(&mut self, object: i32, points: &[DVec3], primitives: &[i32]) {
        let [point, segment] = [self.points.len(), self.primitives.len()];
        self.points.extend(points);
        self.primitives.extend(primitives);
        self.extents.push(Extent {
            object,
            is_closed: true,
            points: [point, self.points.len()],
            segments: [segment, self.primitives.len()],
        });
    }

    /// The warning that the area leaves open curves out. There is none where all are open, as those
    /// of a terrain: it encloses nothing.
    fn gap_warning(&self) -> Option<String> {
        let open = self.polylines().filter(|curve| !curve.is_closed).count();
        let is_mixed = open > 0 && open < self.len();
        is_mixed.then(|| {
            let are = if open == 1 { "is" } else { "are" };
            format!(
                "{open} of {} curves {are} open, since the mesh has gaps there: the area is that of the closed ones alone",
                self.len()
            )
        })
    }
}

/// The reason why objects are left out.
struct Reason {
    why: &'static str,
    count: usize,
    first: String,
}

impl Reason {
    fn new(why: &'static str) -> Self {
        let (count, first) = (0, String::new());
        Self { why, count, first }
    }

    fn add(&mut self, identifier: i32, object: &Object, section: &mut Section) {
        if self.count == 0 {
            let (name, shape) = (escape_controls(object.name()), object.shape().name());
            self.first = format!("object {identifier}, '{name}' ({shape})");
        }
        self.count += 1;
        section.left_out.push(identifier);
    }

    fn line(&self) -> Option<String> {
        let Self { why, count, first } = self;
        match count {
            0 => None,
            1 => Some(format!("left out of the section, {why}: {first}")),
            _ => Some(format!(
                "left out of the section, {why}: {count} objects, the first of them {first}"
            )),
        }
    }
}
