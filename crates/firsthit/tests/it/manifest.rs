//! Every file of the reference data loads as its manifest says.

use std::fs;
use std::path::Path;

use firsthit::Object;
use firsthit::geometry::{Bounds, DVec3};
use firsthit::load::{LoadSettings, Loaded, load};

/// A row of the manifest.
struct Row<'a> {
    file: &'a str,
    expect: &'a str,
    vertices: &'a str,
    triangles: &'a str,
    area: &'a str,
    low: &'a str,
    high: &'a str,
}

fn row(line: &str) -> Option<Row<'_>> {
    let fields: Vec<_> = line.split('\t').collect();
    let [file, expect, vertices, triangles, _, _, area, _, low, high, ..] = fields[..] else {
        return None;
    };
    let extension = Path::new(file).extension()?.to_ascii_lowercase();
    let is_mesh = ["ply", "stl", "obj", "gltf", "glb"].iter().any(|&mesh| extension == mesh);
    is_mesh.then_some(Row { file, expect, vertices, triangles, area, low, high })
}

fn point(text: &str) -> DVec3 {
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(|word| word.parse().expect("the manifest has numbers"))
        .collect();
    DVec3::from_slice(&numbers)
}

fn triangle_count(model: &Loaded) -> usize {
    let meshes = model.world.objects.iter().filter_map(Object::mesh);
    meshes.map(|mesh| mesh.triangles().len()).sum()
}

fn area(model: &Loaded) -> f64 {
    let triangles = model.world.objects.iter().flat_map(|object| {
        let mesh = object.mesh().expect("files have meshes only");
        let place = *object.transform().world_from_object();
        let corners = move |k| mesh.corners(k).map(|corner| place.transform_point3(corner));
        (0..mesh.triangles().len()).map(corners)
    });
    triangles.map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

/// The difference between the model and its row, if any.
fn compare(model: &Loaded, row: &Row) -> Option<String> {
    let triangles = triangle_count(model).to_string();
    // Its triangles are not finite: all that can be said is how many are left.
    if row.area == "nan" {
        return (triangles == row.triangles).then(|| "unusable triangles are there".to_owned());
    }
    if let Some(vertices) = model.vertices.filter(|count| count.to_string() != row.vertices) {
        return Some(format!("{vertices} vertices, not {}", row.vertices));
    }
    if triangles != row.triangles {
        return Some(format!("{triangles} triangles, not {}", row.triangles));
    }
    if triangles == "0" {
        return None;
    }
    let bounds = model.world.objects.iter().map(Object::bounds);
    let bounds = bounds.fold(Bounds::EMPTY, Bounds::union);
    let (low, high) = (point(row.low), point(row.high));
    // The manifest states nine digits.
    let rounding = 1e-6 * (high - low).max_element();
    let off = (bounds.low - low).abs().max((bounds.high - high).abs()).max_element();
    if off > rounding {
        return Some(format!("{bounds:?}, not {low} to {high}"));
    }
    // The manifest's fans turn triangles of concave polygons over, which adds to the area; and
    // where those are not flat, each triangulation is another surface.
    let expected: f64 = row.area.parse().expect("the manifest has numbers");
    let concave = ["concave", "suzanne.ply"];
    let concave = concave.iter().any(|name| row.file.contains(name));
    (!concave && (area(model) - expected).abs() > 1e-6 * expected)
        .then(|| format!("area {}, not {expected}", area(model)))
}

fn check(root: &Path, row: &Row) -> Option<String> {
    let result = load(&root.join(row.file), &LoadSettings::default());
    match (row.expect, result) {
        ("either", _) | ("error", Err(_)) => None,
        ("error", Ok(_)) => Some("loads".to_owned()),
        (_, Err(error)) => Some(error.to_string()),
        ("warn" | "empty", Ok(model)) if model.warnings.is_empty() => Some("no warning".to_owned()),
        (_, Ok(model)) => compare(&model, row),
    }
}

#[test]
#[ignore = "needs ../shared/refdata"]
fn every_reference_file_loads_as_its_manifest_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/refdata/public");
    let manifest = fs::read_to_string(root.join("MANIFEST.tsv"))
        .expect("needs ../shared/refdata beside the clone");
    let rows: Vec<_> = manifest.lines().filter_map(row).collect();
    let wrong: Vec<_> = rows
        .iter()
        .filter_map(|row| check(&root, row).map(|what| format!("{}: {what}", row.file)))
        .collect();
    println!("{} of {} rows agree", rows.len() - wrong.len(), rows.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
