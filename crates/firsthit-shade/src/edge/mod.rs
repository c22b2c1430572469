//! Lines along edges, drawn over pictures. They are found on surfaces, not in pixels.
//!
//! 1. Find the edges of every object that are drawn: of a mesh from its triangles (`table.rs`,
//!    `mesh.rs`), of other shapes in closed form (`curves.rs`).
//! 2. Cut them into pieces of half a pixel (`pieces.rs`).
//! 3. Trace a ray from each piece to the eye to find out whether it is occluded (`sight.rs`).
//! 4. Compute how much of each pixel the lines cover (`coverage.rs`).
//!
//! Step 1 is that of Markosian and others, "Real-time nonphotorealistic rendering", SIGGRAPH 1997,
//! but deterministic: it looks at all edges. Step 3 is from Appel, "The notion of quantitative
//! invisibility and the machine rendering of solids", ACM 1967.
//!
//! Where two objects intersect there is no line: neither has an edge there.

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

pub use coverage::Lines;
pub use settings::{Dash, EdgeKind, EdgeKinds, Edges};

use std::ops::Range;
use std::sync::Arc;

use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec2, Side};
use crate::scene::{Object, Scene};
use crate::shoot::Engine;
use crate::watch::{Watch, stop_if_asked};
use eye::View;
use pieces::Window;
use sight::Sight;
use strokes::Strokes;
use table::EdgeTable;

/// The scene whose edges are drawn, and the camera that sees it.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The camera. One with an aperture counts as a pinhole.
    pub camera: &'a Camera,
    /// The engine that traces rays for occlusion.
    pub engine: &'a dyn Engine,
    /// The side of surfaces that is culled.
    pub cull: Option<Side>,
}

summary!(Subject<'_>, "Subject", |it| "scene": it.scene, "camera": it.camera, "cull": it.cull);

impl Lines {
    /// The lines for some rows and columns of the picture. Their coverage of a pixel does not
    /// depend on which rows and columns these are.
    ///
    /// # Errors
    ///
    /// The errors of [`Edges::check`], [`Error::Limit`](crate::error::Error::Limit) when there is
    /// not enough memory, and [`Error::Interrupted`](crate::error::Error::Interrupted) when `watch`
    /// stops it.
    pub fn new(
        subject: &Subject<'_>,
        edges: &Edges,
        [rows, columns]: [Range<usize>; 2],
        watch: &dyn Watch,
    ) -> Result<Self> {
        edges.check()?;
        let &Subject { scene, camera, engine, cull } = subject;
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
            stop_if_asked(watch)?;
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
        let mut pieces = sight.finish(watch)?;
        let across: Vec<_> = (pieces.iter()).flat_map(|&ends| strokes.across_seam(ends)).collect();
        pieces.extend(across);
        Ok(Self::of(pieces, edges.width))
    }
}

/// The numbers of the objects that may be seen, those that share a mesh one after the other.
fn by_mesh(objects: &[Object]) -> Vec<usize> {
    let may_be_seen = |object: &Object| !object.is_hidden() && !object.is_out_of_range();
    let mut numbers: Vec<usize> =
        (0..objects.len()).filter(|&number| may_be_seen(&objects[number])).collect();
    // This order depends on where meshes are in memory, but nothing that is made: pieces are sorted
    // at the end.
    numbers.sort_by_key(|&number| objects[number].mesh().map(Arc::as_ptr));
    numbers
}
