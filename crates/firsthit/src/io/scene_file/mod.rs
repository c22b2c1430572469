//! The scene file: TOML with cameras, objects, lights, a background and outputs.
//!
//! The tables in [`keys`] and beside the readers say what keys there are; the reader checks a file against
//! them, and [`schema`] is made from them.

mod background;
mod camera;
mod document;
mod form;
mod keys;
mod levels;
mod light;
mod object;
mod output;
mod placement;
mod schema;
mod section;
mod shading;
mod suggest;
mod variant;

pub use schema::schema;
pub use suggest::nearest_word;

use super::report::{Checked, Report};
use super::{Format, Model};
use crate::geometry::DVec3;
use document::Text;
use keys::SCENE;
use light::LIGHT;
use output::OUTPUT;
use section::Section;
use shading::SHADING;

/// The row of the table of formats.
pub(super) const FORMAT: Format = Format {
    name: "scene file",
    extensions: &["toml"],
    up: DVec3::Z,
    rules_up: true,
    read,
};

fn read(bytes: &[u8], report: &mut Report) -> Checked<Model> {
    let text = Text::new(bytes)?;
    let document = text.parse(report)?;
    let scene = Section::new(text, document.get_ref(), 0, &SCENE)?;
    levels::warn(text, document.get_ref(), report);
    let up = scene.vector("up").unwrap_or(FORMAT.up);
    let lights = scene.list("lights", &LIGHT)?;
    let shading = match scene.table("shading", &SHADING)? {
        Some(section) => shading::read(&section)?,
        None => shading::Settings::default(),
    };
    let outputs = scene.list("outputs", &OUTPUT)?;
    let outputs = outputs.iter().map(|output| output::read(output, report));
    let mut model = Model {
        lights: lights.iter().map(light::read).collect::<Checked<_>>()?,
        background: background::read(&scene, up)?,
        shader: shading.shader,
        samples: shading.samples,
        outputs: outputs.collect::<Checked<_>>()?,
        up,
        ..Model::default()
    };
    // What is wrong with the cameras' own values is told before large files are read.
    let cameras = camera::read(&scene)?;
    model.objects = object::read(&scene, report)?;
    model.cameras = camera::settle(cameras, &model)?;
    model.has_view = !model.cameras.is_empty();
    Ok(model)
}
