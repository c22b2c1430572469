use std::collections::HashMap;
use std::io::Write;
use std::sync::Arc;

use firsthit::error::escape_controls;
use firsthit::{Bounds, DVec3, Object, Scene, Shape};
use serde_json::{Value, json};

use crate::args::InfoArgs;
use crate::failure::Failure;
use crate::hints::span;
use crate::loading::{self, Loaded};

pub(crate) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let loaded = loading::read(&args.file, &args.load, None)?;
    let text = if args.json {
        format!("{:#}\n", as_json(&loaded))
    } else {
        loading::warn(&loaded.warnings);
        as_text(&loaded)
    };
    std::io::stdout()
        .write_all(text.as_bytes())
        .map_err(|error| Failure::stdout(&error))
}

fn as_json(loaded: &Loaded) -> Value {
    let Loaded {
        scene,
        up,
        warnings,
    } = loaded;
    let object = |object: &Object| {
        json!({
            "name": object.name(),
            "shape": object.shape().name(),
            "triangles": object.triangles(),
            "bounds": corners(object.bounds()),
        })
    };
    json!({
        "triangles": scene.triangles(),
        "vertices": vertices(scene),
        "bounds": corners(scene.bounds()),
        "objects": scene.objects().iter().map(object).collect::<Vec<_>>(),
        "up": up.to_array(),
        "warnings": warnings,
    })
}

fn corners(bounds: Bounds) -> Value {
    if bounds.is_empty() {
        Value::Null
    } else {
        json!([bounds.low.to_array(), bounds.high.to_array()])
    }
}

fn as_text(loaded: &Loaded) -> String {
    let Loaded { scene, up, .. } = loaded;
    let mut text = format!(
        "triangles  {}\nvertices   {}\n",
        scene.triangles(),
        vertices(scene)
    );
    if !scene.bounds().is_empty() {
        let DVec3 { x, y, z } = scene.bounds().size();
        text += &format!(
            "bounds     {}\nsize       {x} x {y} x {z}\n",
            span(scene.bounds())
        );
    }
    text += &format!(
        "up         {},{},{} (by the format's custom)\n",
        up.x, up.y, up.z
    );
    text += &format!("objects    {}\n", scene.objects().len());
    for (identifier, object) in scene.objects().iter().enumerate() {
        let name = escape_controls(object.name());
        text += &format!(
            "  {identifier}  {name}  ({}, {} triangles)\n",
            object.shape().name(),
            object.triangles()
        );
    }
    text
}

/// How many vertices the file has: those that objects share count once.
fn vertices(scene: &Scene) -> usize {
    let mut buffers = HashMap::new();
    for object in scene.objects() {
        if let Shape::Mesh(mesh) = object.shape() {
            buffers.insert(Arc::as_ptr(mesh.positions()), mesh.positions().len());
        }
    }
    buffers.values().sum()
}
