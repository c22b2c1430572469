//! The faces that a section plane cuts: how large each object's is, and all of them as a drawing.

use std::collections::BTreeMap;
use std::path::Path;

use firsthit::section::{Section, SectionFormat, SectionPlane, section};
use firsthit::watch::Watch;
use firsthit::{Error, Result, Scene};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::cut::CutPlane;
use crate::look::Visibility;
use crate::viewer::Viewer;

/// A question about the faces that a section plane cuts.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionRequest {
    /// The visible part of the scene; its cut is the plane.
    pub part: Visibility,
    /// Whether the drawing is wanted.
    #[serde(default)]
    pub svg: bool,
}

impl Viewer {
    /// The faces of the section plane, object by object: `area` in squares of scene units, null for
    /// a mesh with a gap on the plane. Objects that are no meshes are left out, and `warnings` says
    /// so. `svg` is the file that `firsthit section` writes of the plane, seen from the side that
    /// is cut away.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] without a cut and for one that makes no sense, and those of [`section`].
    pub fn section(&self, asked: &SectionRequest, watch: &dyn Watch) -> Result<Value> {
        let cut = asked.part.cut.as_ref();
        let cut = cut.ok_or_else(|| Error::argument("cut", "a plane", "none"))?;
        let plane = CutPlane::new(cut)?;
        let scene = self.scene_of(&asked.part, &[])?;
        let plane = SectionPlane::new(plane.origin(), plane.normal())?;
        let section = section(&scene, plane, watch)?;
        Ok(json!({
            "area": section.area(),
            "faces": faces(&section, &scene),
            "warnings": section.warnings(),
            "svg": asked.svg.then(|| svg(&section)).transpose()?,
        }))
    }
}

fn faces(section: &Section, scene: &Scene) -> Vec<Value> {
    let mut areas = BTreeMap::<i32, Option<f64>>::new();
    for polyline in section.polylines() {
        let area = areas.entry(polyline.object).or_insert(Some(0.0));
        *area = area.zip(polyline.area(section.plane())).map(|(sum, more)| sum + more);
    }
    let faces = areas.into_iter().filter_map(|(number, area)| {
        let object = scene.objects().get(usize::try_from(number).ok()?)?;
        Some(json!({
            "object": number,
            "name": object.name(),
            "shape": object.shape().name(),
            "area": area,
        }))
    });
    faces.collect()
}

fn svg(section: &Section) -> Result<String> {
    let mut drawn = Vec::new();
    let format = SectionFormat::of(Path::new("section.svg"))?;
    let written = format.write(section, &mut drawn);
    written.map_err(|error| Error::argument("svg", "one that can be written", error))?;
    Ok(String::from_utf8_lossy(&drawn).into_owned())
}
