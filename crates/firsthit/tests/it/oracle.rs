//! The oracle's answers, pixel by pixel, and its rays from inside a closed mesh, all of which hit.
//! They stand beside the clone, in ../shared/refdata.

use std::collections::HashMap;
use std::path::Path;

use firsthit::load::{LoadSettings, load};
use firsthit::shoot::{BruteForce, Cpu, Engine};
use firsthit::{
    Camera, DVec3, Lens, Object, Plane, Projection, Ray, Scene, Sphere, View, Viewplane,
};
use serde_json::Value;

use crate::support::{npz, refdata};

/// The arrays of an NPZ file, whatever their type, as float64.
fn arrays(path: &Path) -> HashMap<String, Vec<f64>> {
    let arrays = npz::arrays(std::fs::read(path).unwrap()).into_iter();
    let arrays = arrays.filter_map(|(name, array)| Some((name, array.numbers()?)));
    arrays.collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}

fn camera(case: &Value) -> Camera {
    let number = |key: &str| case[key].as_f64().unwrap();
    let count = |key: &str| usize::try_from(case[key].as_u64().unwrap()).unwrap();
    let orthographic = case["ortho"].as_bool().unwrap_or(false);
    Camera::new(View {
        position: vector(&case["x_c"]),
        aim: vector(&case["u_c"]),
        up: vector(&case["v_up"]),
        rows: count("M"),
        columns: count("N"),
        lens: Lens::Flat(Viewplane {
            focal_length: number("z_p"),
            width: number("w"),
            height: number("h"),
            parallel: if orthographic { Projection::Orthographic } else { Projection::Perspective }
                == Projection::Orthographic,
            ..Viewplane::default()
        }),
    })
    .unwrap()
}

fn mesh_objects(path: &Path) -> Vec<Object> {
    load(path, &LoadSettings::default()).unwrap().world.objects
}

fn objects(case: &Value, folder: &Path) -> Vec<Object> {
    if let Some(mesh) = case["mesh"].as_str() {
        return mesh_objects(&folder.join(mesh));
    }
    let object = |object: &Value| {
        if object["sphere"].is_array() {
            let at = numbers(&object["sphere"]);
            Object::new(Sphere::new(DVec3::from_slice(&at), at[3]).unwrap())
        } else if object["plane"].is_array() {
            let at = numbers(&object["plane"]);
            Object::new(Plane::new(DVec3::from_slice(&at), DVec3::from_slice(&at[3..])).unwrap())
        } else {
            panic!("no case has such an object yet: {object}")
        }
    };
    case["objects"].as_array().unwrap().iter().map(object).collect()
}

/// The oracle counts primitives through all objects.
fn numbers_before(scene: &Scene) -> Vec<i32> {
    let mut before = 0;
    scene
        .objects()
        .iter()
        .map(|object| {
            let first = before;
            before += object.triangles().max(1) as i32;
            first
        })
        .collect()
}

#[test]
#[ignore = "needs ../shared/refdata"]
fn every_pixel_of_every_case_agrees() {
    let folder = refdata().join("oracle");
    let mut cases = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "json") {
            check_case(&path, &folder);
            cases += 1;
        }
    }
    assert!(cases >= 4, "{cases} cases");
}

fn check_case(path: &Path, folder: &Path) {
    let case: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let answer = arrays(&path.with_extension("npz"));
    let camera = camera(&case["camera"]);
    let scene = Scene::new(objects(&case, folder)).unwrap();
    let before = numbers_before(&scene);
    let mut clear = 0;
    for row in 0..camera.rows() {
        for column in 0..camera.columns() {
            let hit = Cpu::default().first_hit(&scene, &camera.ray(row, column));
            let number = before.get(hit.object as usize).map_or(-1, |first| first + hit.primitive);
            // The oracle's row 0 is the bottom one.
            let k = (camera.rows() - 1 - row) * camera.columns() + column;
            let place = format!("{} row {row} column {column}: {hit:?}", path.display());
            let is = |t: f64| (hit.t - t).abs() <= 1e-9 * t || hit.t == t;
            let candidate = answer["cand"][16 * k..16 * k + 16].contains(&f64::from(number));
            match answer["amb"][k] {
                0.0 => {
                    clear += 1;
                    assert!(
                        is(answer["t"][k]) && f64::from(number) == answer["prim"][k],
                        "{place}"
                    );
                }
                1.0 => assert!(is(answer["t"][k]) && candidate, "{place}"),
                _ => assert!(answer["alts"][8 * k..8 * k + 8].iter().any(|&t| is(t)), "{place}"),
            }
        }
    }
    assert!(clear > 100, "{}: {clear} clear pixels", path.display());
}

#[test]
#[ignore = "needs ../shared/refdata"]
fn every_ray_from_inside_hits() {
    let folder = refdata().join("oracle");
    let rays = arrays(&folder.join("rays_ico3.npz"));
    let scene = Scene::new(mesh_objects(&folder.join("ico3.ply"))).unwrap();
    let (origins, directions) = (&rays["origin"], &rays["dir"]);
    for k in 0..origins.len() / 3 {
        let at = |array: &[f64]| DVec3::from_slice(&array[3 * k..]);
        let ray = Ray::new(at(origins), at(directions));
        let hit = Cpu::default().first_hit(&scene, &ray);
        assert!(!hit.is_miss(), "{ray:?}");
        if k % 50 == 0 {
            assert_eq!(hit.t.to_bits(), BruteForce.first_hit(&scene, &ray).t.to_bits(), "{ray:?}");
        }
    }
    assert!(origins.len() / 3 > 10_000);
}
