//! Probes a pixel.

use firsthit::Result;
use firsthit::explain::{ExplainSettings, explain_pixel};
use firsthit::watch::Watch;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::cut::CutPlane;
use crate::explanation;
use crate::look::{FlatCamera, Visibility};
use crate::viewer::Viewer;
use firsthit::measure::innermost;

/// A question about a pixel.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// The camera.
    pub camera: FlatCamera,
    /// The row from the top and the column from the left.
    pub pixel: [usize; 2],
    /// The part of the scene that is seen.
    #[serde(default)]
    pub part: Visibility,
}

impl Viewer {
    /// Everything about the ray through a pixel's centre: what `firsthit probe --json` prints but
    /// for the list of objects that were not met, which is as long as the scene. Where the section
    /// plane cuts through a solid, `cut_face` is the point of the plane, and the hit is what would
    /// be met inside.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](firsthit::Error::Argument) for a camera that makes no sense, and for a
    /// pixel outside of the picture.
    pub fn probe(&self, asked: &Probe, watch: &dyn Watch) -> Result<Value> {
        let camera = asked.camera.camera()?;
        let scene = self.scene_of(&asked.part, &[])?;
        let mut settings = ExplainSettings::default();
        let [row, column] = asked.pixel;
        let is_inside = column < camera.columns() && row < camera.rows();
        let mut face = Value::Null;
        if let Some(cut) = asked.part.cut.as_ref().filter(|_| is_inside) {
            let (plane, whole) = (CutPlane::new(cut)?, camera.ray(row, column));
            let ray = plane.behind(whole);
            (settings.t_min, settings.t_max) = (Some(ray.t_min), Some(ray.t_max));
            if CutPlane::is_begin(&ray)
                && let [Some(object)] = innermost(&scene, &[ray], &())?[..]
            {
                let t = plane.crossing(&whole);
                face = json!({
                    "t": t,
                    "object": object,
                    "name": scene.objects()[object].name(),
                    "shape": scene.objects()[object].shape().name(),
                    "position": whole.at(t).to_array(),
                    "normal": plane.normal().to_array(),
                });
            }
        }
        let explained = explain_pixel(&scene, &camera, asked.pixel, &settings, watch)?;
        let mut told = explanation::json(&explained);
        if let Some(fields) = told.as_object_mut() {
            fields.remove("candidates");
        }
        told["cut_face"] = face;
        Ok(told)
    }
}
