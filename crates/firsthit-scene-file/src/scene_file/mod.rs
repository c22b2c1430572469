//! The scene file: TOML with cameras, objects, lights, an environment, a background and outputs.
//!
//! Tables list the keys: in `records`, and beside each reader. The reader checks a file against
//! them, and [`schema`] is made from them.

// A loader that panics is a loader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

mod background;
mod camera;
mod colors;
mod display;
mod document;
mod edges;
mod environment;
mod form;
mod labels;
mod levels;
mod light;
mod material;
mod object;
mod output;
mod placement;
mod plan;
mod plan_output;
mod plan_text;
mod records;
mod schema;
mod section;
mod settings;
mod shading;
mod suggest;
mod table;
mod variant;

#[doc(hidden)]
pub use plan_text::{Mistake, place_in_plan, plan_file, read_plan};
#[doc(hidden)]
pub use schema::plan_schema;
pub use schema::schema;
pub use suggest::nearest_word;

use std::sync::Arc;

use crate::geometry::{DVec3, DisplayTransform};
use crate::io::fault::Checked;
use crate::io::{Format, Report};
use crate::shade::Appearance;
use crate::world::{World, WorldFormat};
use display::DISPLAY;
use document::Text;
use light::LIGHT;
use object::EXTENSIONS;
use output::OUTPUT;
use records::SCENE;
use section::Section;
use shading::SHADING;

/// The row of the list of formats.
pub(crate) static FORMAT: WorldFormat = WorldFormat {
    format: Format { name: "scene file", extensions: EXTENSIONS, up: DVec3::Z, rules_up: true },
    read,
};

fn read(bytes: &[u8], report: &mut Report) -> Checked<World> {
    let text = Text::new(bytes)?;
    let needed = text.needed() as u64;
    (report.budget).charge_content(needed, "its text, parsed,")?;
    let document = text.parse()?;
    let scene = Section::new(text, document.get_ref(), 0, &SCENE)?;
    levels::warn(text, document.get_ref(), report);
    let up = scene.vector("up").unwrap_or(FORMAT.format.up);
    let lights = scene.list("lights", &LIGHT)?;
    let shading = match scene.table("shading", &SHADING)? {
        Some(section) => {
            if section.has("light") && scene.has("environment") {
                let what = "light and [environment] exclude each other: either lights the scene";
                return Err(section.fault_at("light", what));
            }
            shading::read(&section)?
        }
        None => Appearance::default(),
    };
    let display = match scene.table("display", &DISPLAY)? {
        Some(section) => display::read(&section)?,
        None => DisplayTransform::default(),
    };
    let outputs = scene.list("outputs", &OUTPUT)?;
    let outputs = outputs.iter().map(|output| output::read(output, report));
    let mut world = World {
        lights: lights.iter().map(light::read).collect::<Checked<_>>()?,
        appearance: Appearance {
            background: background::read(&scene, up)?,
            coloring: colors::read(&scene)?,
            ..shading
        },
        display,
        edges: edges::read(&scene)?,
        outputs: outputs.collect::<Checked<_>>()?,
        up,
        ..World::default()
    };
    // The cameras' own values are checked before large files are read, each of which is a step of
    // its own.
    let cameras = camera::read(&scene, report)?;
    report.advance_until(0)?;
    let (environment, sun) = environment::read(&scene, up, report)?.unzip();
    world.environment = environment.map(Arc::new);
    world.lights.extend(sun.flatten());
    world.objects = object::read(&scene, report)?;
    world.cameras = camera::settle(cameras, &world)?;
    world.has_view = !world.cameras.is_empty();
    Ok(world)
}
