//! Lines over pictures, along edges of what is there: from surfaces, not from pixels.
//!
//! 1. Find the edges of every object that have lines: of a mesh from its triangles (`table.rs`, `mesh.rs`), of other shapes in closed
//!    form (`curves.rs`).
//! 2. Cut their lines into pieces of half a pixel (`pieces.rs`).
//! 3. Ask an engine for each piece whether something is between it and the eye (`sight.rs`).
//! 4. Add up how much of each pixel the lines cover (`coverage.rs`).
//!
//! Step 1 is as Markosian and others have it, "Real-time nonphotorealistic rendering", SIGGRAPH 1997, but for looking at all edges; rays
//! for step 3 are from Appel, "The notion of quantitative invisibility and the machine rendering of solids", ACM 1967.
//!
//! Where two objects intersect there is no line, for neither has an edge there.

mod chain;
mod coverage;
mod curves;
mod eye;
mod mesh;
mod pieces;
mod settings;
mod sight;
mod strokes;
mod table;

pub use settings::{Dash, EdgeKind, EdgeKinds, Edges};

use std::fmt::{self, Debug, Formatter};
use std::ops::Range;
use std::sync::Arc;

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::geometry::{DVec2, Side};
use crate::scene::{Object, Scene};
use crate::shoot::Engine;
use crate::watch::Watch;
use coverage::Drawing;
use eye::View;
use pieces::Window;
use sight::Sight;
use strokes::Strokes;
use table::EdgeTable;

/// What lines are drawn of.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// What is seen.
    pub scene: &'a Scene,
    /// Who sees it. One with an aperture is taken for a pinhole.
    pub camera: &'a Camera,
    /// What finds out what is hidden.
    pub engine: &'a dyn Engine,
    /// The side of surfaces that the camera's rays pass through.
    pub cull: Option<Side>,
}

impl Debug for Subject<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Subject")
            .field("scene", &self.scene)
            .field("camera", &self.camera)
            .field("cull", &self.cull)
            .finish_non_exhaustive()
    }
}

/// The lines of a picture's edges.
///
/// ```
/// use firsthit::edge::{Edges, Lines, Subject};
/// use firsthit::shoot::Cpu;
/// use firsthit::{Camera, DVec3, Object, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, 45.0, 100, 100)?;
/// let subject = Subject { scene: &scene, camera: &camera, engine: Cpu::shared(), cull: None };
/// let lines = Lines::new(&subject, &Edges::default(), [0..100, 0..100], &())?;
/// let covered: f32 = lines.coverage(0..100, 0..100)?.iter().sum();
/// // The sphere is seen as a circle.
/// let radius = 50.0 / 22.5_f32.to_radians().tan() / 24_f32.sqrt();
/// assert!((covered / (std::f32::consts::TAU * radius) - 1.0).abs() < 0.01);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone)]
pub struct Lines(Drawing);

impl Debug for Lines {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let pieces = self.0.pieces().len();
        f.debug_struct("Lines")
            .field("pieces", &pieces)
            .finish_non_exhaustive()
    }
}

impl Lines {
    /// Those that some rows and columns of the picture need. What they cover there does not depend on which rows and columns.
    ///
    /// # Errors
    ///
    /// Those of [`Edges::check`], [`Error::Limit`] when there is not enough memory, and [`Error::Interrupted`] when `watch` stops it.
    pub fn new(
        subject: &Subject<'_>,
        edges: &Edges,
        [rows, columns]: [Range<usize>; 2],
        watch: &dyn Watch,
    ) -> Result<Self> {
        edges.check()?;
        let &Subject {
            scene,
            camera,
            engine,
            cull,
        } = subject;
        let reach = 0.5 * (edges.width + 1.0);
        let window = |rows: Range<usize>, columns: Range<usize>| Window {
            low: DVec2::new(columns.start as f64, rows.start as f64) - reach,
            high: DVec2::new(columns.end as f64, rows.end as f64) + reach,
        };
        let strokes = Strokes {
            scene,
            view: View::new(camera),
            edges,
            cull,
            picture: window(0..camera.rows(), 0..camera.columns()),
            part: window(rows, columns),
        };
        let mut sight = Sight::new(scene, engine, cull, edges.hidden);
        let mut table: Option<(*const _, EdgeTable)> = None;
        for number in by_mesh(scene.objects()) {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let Some(mesh) = scene.objects()[number].mesh() else {
                strokes.of_shape(number, &mut sight, watch)?;
                continue;
            };
            let known = table.take();
            let known = known.filter(|(of, _)| *of == Arc::as_ptr(mesh));
            let known = match known {
                Some(known) => known,
                None => (Arc::as_ptr(mesh), EdgeTable::new(mesh)?),
            };
            strokes.of_mesh(number, mesh, &known.1, &mut sight, watch)?;
            table = Some(known);
        }
        Ok(Self(Drawing::new(sight.finish(watch)?, edges.width)))
    }

    /// The pieces of the lines: columns from the picture's left edge, rows from its upper edge, as [`Camera::project`] has them.
    pub fn pieces(&self) -> &[[DVec2; 2]] {
        self.0.pieces()
    }

    /// How much of each pixel of some rows and columns is covered, from 0 to 1, row by row. They must be among those that the lines
    /// were made for.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] when there is not enough memory.
    pub fn coverage(&self, rows: Range<usize>, columns: Range<usize>) -> Result<Vec<f32>> {
        self.0.coverage(rows, columns)
    }
}

/// The numbers of the objects that are there, those that share a mesh one after the other.
fn by_mesh(objects: &[Object]) -> Vec<usize> {
    let is_there = |object: &Object| !object.is_hidden() && !object.is_out_of_range();
    let mut numbers: Vec<usize> = (0..objects.len())
        .filter(|&number| is_there(&objects[number]))
        .collect();
    // Where meshes are in memory changes the order, but no picture: of all that covers a pixel the most counts.
    numbers.sort_by_key(|&number| objects[number].mesh().map(Arc::as_ptr));
    numbers
}
