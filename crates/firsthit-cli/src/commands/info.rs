use std::collections::HashMap;
use std::sync::Arc;

use firsthit::error::escape_controls;
use firsthit::image::{format_of, is_point_cloud, known_extensions};
use firsthit::load::LoadSettings;
use firsthit::shape::Property;
use firsthit::shoot::Cpu;
use firsthit::watch::Watch as _;
use firsthit::{Bounds, Object, Scene, Shape};
use serde_json::{Value, json};

use super::info_looks::Looks;
use super::info_solids::Solids;
use super::listing::{listed, most_listed};
use super::{info_las, info_output};
use crate::args::InfoArgs;
use crate::console::{counted, json_text, print, warn};
use crate::failure::Failure;
use crate::hints::{number, span, triple};
use crate::loading::{self, Loaded, NO_RAYS, has_model_extension};
use crate::progress::Progress;
use crate::threads::with_threads;

pub(crate) fn run(args: &InfoArgs, progress: &Progress) -> Result<(), Failure> {
    print(&text(args, progress)?)
}

/// The report as text or as JSON, with a line break at the end.
pub(crate) fn text(args: &InfoArgs, progress: &Progress) -> Result<String, Failure> {
    match format_of(&args.file) {
        // A PLY may be either.
        Ok(format) if !has_model_extension(&args.file) || is_point_cloud(&args.file) => {
            info_output::text(args, format)
        }
        _ if info_las::is_las(&args.file) => info_las::text(args),
        Err(_) if !has_model_extension(&args.file) => of_model(args, progress).map_err(|failure| {
            failure.with(&format!("; or an output: {}, .las, .laz", known_extensions()))
        }),
        _ => of_model(args, progress),
    }
}

fn of_model(args: &InfoArgs, progress: &Progress) -> Result<String, Failure> {
    let settings = LoadSettings { verify: true, ..loading::settings(&args.file, &args.load) };
    let read = || loading::read_with(&args.file, &settings, |_| NO_RAYS, None, progress);
    let loaded = with_threads(None, read)?;
    let most = most_listed(args);
    if !args.json {
        warn(&loaded.warnings);
    }
    let listed = loaded.scene.objects().iter().take(most);
    let triangles = listed.map(|object| object.triangles() as u64).sum();
    progress.begin("measuring", triangles, "triangles");
    with_threads(None, || {
        Ok(if args.json {
            json_text(&as_json(&loaded, most, progress)) + "\n"
        } else {
            as_text(&loaded, most, progress)
        })
    })
}

fn as_json(loaded: &Loaded, most: usize, progress: &Progress) -> Value {
    let Loaded { scene, warnings, model, .. } = loaded;
    // Objects of one mesh have the same properties, so that the lists of all objects count
    // together.
    let (mut room, mut shell_room, mut solids) = (most, most, Solids::default());
    let catalog = scene.catalog();
    let mut object = |(number, object): (usize, &Object)| {
        let names = properties(object);
        let listed = names.iter().take(room);
        let listed: Vec<Value> = listed
            .map(|property| json!({"name": property.name, "of": property.of.name()}))
            .collect();
        room -= listed.len();
        let mut described = json!({
            "name": object.name(),
            "shape": object.shape().name(),
            "node": named(catalog.node_of(number), catalog.nodes()),
            "mesh": named(catalog.mesh_of(number), catalog.meshes()),
            "materials": catalog.materials_of(number),
            "triangles": object.triangles(),
            "bounds": corners(object.bounds()),
            "properties": listed,
            "property_count": names.len(),
        });
        for (name, value) in solids.as_json(object, &mut shell_room) {
            described[name] = value;
        }
        progress.advance(object.triangles() as u64);
        described
    };
    let objects = scene.objects().iter().enumerate().take(most);
    let objects: Vec<Value> = objects.map(&mut object).collect();
    let looks = Looks::of(model, scene);
    json!({
        "triangles": scene.triangles(),
        "vertices": vertices(loaded),
        "bounds": corners(scene.bounds()),
        "objects": objects,
        "up": model.up_in(scene).to_array(),
        "instruction_set": Cpu::default().instruction_set().name(),
        "cameras": looks.cameras_as_json(most),
        "lights": looks.lights_as_json(most),
        "environment": looks.environment_as_json(),
        "materials": looks.materials_as_json(most),
        "textures": looks.textures_as_json(most),
        "variants": loaded.variants.iter().take(most).collect::<Vec<_>>(),
        "counts": {
            "objects": scene.objects().len(),
            "cameras": looks.cameras.len(),
            "lights": looks.lights.len(),
            "materials": looks.materials.len(),
            "textures": looks.textures.len(),
            "variants": loaded.variants.len(),
        },
        "warnings": warnings,
    })
}

/// An identifier and what it stands for, if it stands for anything.
fn named(identifier: i32, names: &[Arc<str>]) -> Value {
    let name = usize::try_from(identifier).ok().and_then(|k| names.get(k));
    name.map_or(Value::Null, |name| json!({"id": identifier, "name": &**name}))
}

fn corners(bounds: Bounds) -> Value {
    if bounds.is_empty() {
        Value::Null
    } else {
        json!([bounds.low.to_array(), bounds.high.to_array()])
    }
}

fn as_text(loaded: &Loaded, most: usize, progress: &Progress) -> String {
    let Loaded { scene, model, .. } = loaded;
    let mut lines = vec![
        format!("triangles  {}", scene.triangles()),
        format!("vertices   {}", vertices(loaded)),
    ];
    if scene.bounds().is_empty() {
        lines.push("bounds     none".into());
    } else {
        let [x, y, z] = scene.bounds().size().to_array().map(number);
        lines.push(format!("bounds     {}", span(scene.bounds())));
        lines.push(format!("size       {x} x {y} x {z}"));
    }
    let up = model.up_in(scene);
    let source = if !model.up_is_guessed {
        "as the file says"
    } else if up == model.up {
        "by the format's convention"
    } else {
        "guessed from a flat base"
    };
    lines.push(format!("up         {} ({source})", triple(up)));
    let set = Cpu::default().instruction_set().name();
    lines.push(format!("kernels    {set}"));
    lines.push(format!("objects    {}", scene.objects().len()));
    let objects = scene.objects().iter().enumerate();
    let mut solids = Solids::default();
    let object = |(identifier, object): (usize, &Object)| {
        let mut entry = vec![format!(
            "{identifier}  {}  ({}, {}{})",
            escape_controls(object.name()),
            object.shape().name(),
            counted(object.triangles() as u64, "triangle"),
            origin(identifier, scene)
        )];
        entry.extend(solids.as_text(object, most, "       "));
        let property = |property: &Property| {
            let (of, name) = (property.of.name(), escape_controls(&property.name));
            match property.components {
                1 => format!("{name}, a number for each of the {of}"),
                several => format!("{name}, {several} numbers for each of the {of}"),
            }
        };
        let properties = properties(object).iter().map(property);
        entry.extend(listed(most, "       ", properties));
        progress.advance(object.triangles() as u64);
        entry.join("\n")
    };
    lines.extend(listed(most, "  ", objects.map(object)));
    if !loaded.variants.is_empty() {
        lines.push(format!("variants   {}", loaded.variants.len()));
        let names = loaded.variants.iter().map(|name| escape_controls(name));
        lines.extend(listed(most, "  ", names));
    }
    lines.extend(Looks::of(model, scene).as_text(most));
    lines.join("\n") + "\n"
}

/// The node and the materials of an object, as far as they have names. They tell apart objects that
/// are called alike.
fn origin(object: usize, scene: &Scene) -> String {
    /// The most materials that are listed: a real object has few, but a file may say otherwise.
    const MOST: usize = 3;
    let catalog = scene.catalog();
    let name = |identifier: i32, names: &[Arc<str>]| {
        let name = usize::try_from(identifier).ok().and_then(|k| names.get(k));
        name.filter(|name| !name.is_empty()).map(|name| escape_controls(name))
    };
    let node = name(catalog.node_of(object), catalog.nodes());
    let identifiers = catalog.materials_of(object);
    let mut materials: Vec<String> = (identifiers.iter().take(MOST))
        .filter_map(|&identifier| name(identifier, catalog.materials()))
        .collect();
    if identifiers.len() > MOST && !materials.is_empty() {
        materials.push("...".into());
    }
    let node = node.map(|node| format!(", node {node}"));
    let has_names = !materials.is_empty();
    let materials = has_names.then(|| format!(", material {}", materials.join(", ")));
    node.unwrap_or_default() + &materials.unwrap_or_default()
}

/// The numbers that an object's mesh has by name.
fn properties(object: &Object) -> &[Property] {
    object.mesh().map_or(&[], |mesh| mesh.properties())
}

/// The number of vertices in the file: where it does not count them itself, those that objects
/// share count once.
fn vertices(loaded: &Loaded) -> u64 {
    let count = || {
        let mut buffers = HashMap::new();
        for object in loaded.scene.objects() {
            if let Shape::Mesh(mesh) = object.shape() {
                let count = mesh.positions().len() as u64;
                buffers.insert(Arc::as_ptr(mesh.positions()), count);
            }
        }
        buffers.values().sum()
    };
    loaded.vertices.unwrap_or_else(count)
}
