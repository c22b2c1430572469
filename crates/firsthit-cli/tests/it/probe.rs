//! The explanation of one ray.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::support::Lab;

/// Three squares across the z axis, the upper two in one place, and a small one far away.
const SQUARES: &str = "\
o low\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n\
o high\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\nf 5 6 7 8\n\
o copy\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\nf 9 10 11 12\n\
o far\nv 8 8 0\nv 9 8 0\nv 9 9 0\nf 13 14 15\n";

fn lab() -> Lab {
    let lab = Lab::new();
    lab.write("squares.obj", SQUARES);
    lab
}

fn story(lab: &Lab, arguments: &str) -> Value {
    let outcome = lab.ok(&format!("probe {arguments} --json"));
    serde_json::from_slice(&outcome.stdout).unwrap()
}

#[test]
fn a_ray_is_told_in_words() {
    let lab = lab();
    let outcome = lab.ok("probe squares.obj --ray 0.5,0.25,5,0,0,-1");
    assert_eq!(outcome.stderr, "");
    assert_eq!(
        outcome.text(),
        "\
ray        from 0.5,0.25,5 along 0,0,-1, 0 < t <= inf
hit        t 3
           object 1 'high' (mesh), triangle 0, face 0
           of mesh 1
           position 0.5,0.25,2
           normal 0,0,1, front met
           barycentric 0.25,0.125,0.625
           base colour 0.6,0.6,0.6, linear
           no material
behind     t 3: object 2 'copy' (mesh), triangle 0, front
           t 5: object 0 'low' (mesh), triangle 0, front
objects    4 in all
           object 1 'high' (mesh): the hit, at t 3, triangle 0
           object 2 'copy' (mesh): met at the same t, but with a higher identifier, at t 3, triangle 0
           object 0 'low' (mesh): met behind the hit, at t 5, triangle 0
           1 object: box missed
"
    );
}

#[test]
fn no_option_of_the_camera_goes_with_a_ray_of_ones_own() {
    let lab = lab();
    lab.write("pose.txt", "1 0 0 0 0 1 0 0 0 0 1 0");
    for option in [
        "--aperture 0.1",
        "--focus 2",
        "--aperture 0.1 --focus 2",
        "--convention ros",
        "--convention ros --pose pose.txt",
        "--convention ros --intrinsics 4,4,2,1 --size 4x3",
        "--projection opencv --parameters k1=0.1",
        "--camera 0",
        "--colmap . --image a",
        "--view top",
        "--position 1,2,3",
        "--aim 1,2,3",
        "--look-at auto",
        "--up 0,0,1",
        "--fov 40",
        "--viewplane 1x1 --focal-length 1",
        "--orthographic",
        "--ray-start eye",
        "--size 4x3",
    ] {
        let words = format!("probe squares.obj --ray 0,0,5,0,0,-1 {option}");
        lab.fails(&words, 2, "cannot be used with");
    }
}

#[test]
fn limits_sides_and_hidden_objects_are_reasons() {
    let lab = lab();
    let reasons = |arguments: &str| {
        let story = story(&lab, arguments);
        let candidates = story["candidates"].as_array().unwrap().iter();
        let reasons = candidates.map(|it| it["reason"].as_str().unwrap().to_owned());
        reasons.collect::<Vec<_>>().join(" ")
    };
    let down = "squares.obj --ray 0.5,0.25,5,0,0,-1";
    assert_eq!(
        reasons(&format!("{down} --t-max 2.5 --hide copy")),
        "beyond_end beyond_end hidden box_missed"
    );
    assert_eq!(
        reasons(&format!("{down} --t-min 4 --only low --only high")),
        "hit behind_start hidden hidden"
    );
    assert_eq!(
        reasons(&format!("{down} --cull front")),
        "culled_front culled_front culled_front box_missed"
    );
    // Past the triangle, through its flat box, and beyond that.
    assert_eq!(
        reasons("squares.obj --ray 8.1,8.9,1,0,0,-1"),
        "box_missed box_missed box_missed surface_missed"
    );
    let miss = story(&lab, "squares.obj --ray 8.1,8.9,1,0,0,-1");
    assert_eq!((&miss["hit"], &miss["behind"]), (&Value::Null, &json!([])));
    assert_eq!(miss["counts"], json!({"box_missed": 3, "surface_missed": 1}));
    let outcome = lab.ok("probe squares.obj --ray 8.1,8.9,1,0,0,-1");
    assert!(outcome.text().contains("hit        none\n"));
    let near = "object 3 'far' (mesh): box met, surface missed\n";
    assert!(outcome.text().contains(near), "{}", outcome.text());
    let outcome = lab.ok("probe squares.obj --ray 0,0,0,0,0,0");
    let why = "it meets nothing: its direction is zero\n";
    assert!(outcome.text().contains(why), "{}", outcome.text());
}

#[test]
fn a_pixel_is_that_of_the_picture_with_the_same_options() {
    let lab = lab();
    let camera = "--position 0,0,9 --aim 0,0,-1 --up 0,1,0 --fov 20 --size 8x6 --hide high";
    lab.ok(&format!(
        "render squares.obj {camera} -o all.npz --channels object,primitive,t,range,z,normal,position"
    ));
    let all = lab.npz("all.npz");
    let mut hits = 0;
    for (k, object) in all["object"].values.iter().enumerate() {
        let (row, column) = (k / 8, k % 8);
        let story = story(&lab, &format!("squares.obj {camera} --pixel {row},{column}"));
        let hit = &story["hit"];
        if *object < 0.0 {
            assert_eq!(hit, &Value::Null);
            continue;
        }
        hits += 1;
        let of = |name: &str| all[name].values[k];
        for name in ["object", "primitive", "t"] {
            assert_eq!(hit[name].as_f64(), Some(of(name)), "{name} at {row},{column}");
        }
        for name in ["range", "z"] {
            assert_eq!(story["pixel"][name].as_f64(), Some(of(name)), "{name}");
        }
        for name in ["normal", "position"] {
            let expected = &all[name].values[3 * k..3 * k + 3];
            assert_eq!(hit[name], json!(expected), "{name}");
        }
        assert_eq!(story["pixel"]["columns"], 8);
    }
    assert!(hits > 4, "{hits}");
    lab.fails(
        &format!("probe squares.obj {camera} --pixel 0,8"),
        2,
        "there are 6 rows and 8 columns, from 0,0 to 5,7",
    );
}

#[test]
fn many_objects_are_counted_and_all_are_listed_if_asked() {
    let lab = Lab::new();
    let mut text = String::new();
    for k in 0..40 {
        let corner = 3 * k + 1;
        write!(
            text,
            "o s{k}\nv 0 0 {k}\nv 1 0 {k}\nv 0 1 {k}\nf {corner} {} {}\n",
            corner + 1,
            corner + 2
        )
        .unwrap();
    }
    lab.write("stack.obj", text);
    let ray = "probe stack.obj --ray 0.2,0.3,50,0,0,-1";
    let few = lab.ok(ray);
    let lines: Vec<&str> = few.text().lines().map(str::trim).collect();
    assert!(lines.contains(&"... and 29 crossings"), "{lines:?}");
    assert!(lines.contains(&"34 more objects: met behind the hit"));
    assert!(lines.contains(&"object 38 's38' (mesh): met behind the hit, at t 12, triangle 0"));
    let all = lab.ok(&format!("{ray} --all"));
    let of_objects = all.text().lines().filter(|line| line.contains("object "));
    // The hit, 39 crossings behind it, and all objects.
    assert_eq!(of_objects.count(), 1 + 39 + 40);
    let story = story(&lab, "stack.obj --ray 0.2,0.3,50,0,0,-1");
    assert_eq!(story["candidates"].as_array().unwrap().len(), 40);
    assert_eq!(story["counts"], json!({"hit": 1, "behind_hit": 39}));
    assert_eq!(story["behind_count"], 39);
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let lab = lab();
    lab.fails("probe squares.obj", 2, "<--pixel <ROW,COLUMN>|--ray <RAY>>");
    lab.fails("probe squares.obj --pixel 1,1 --ray 0,0,1,0,0,1", 2, "cannot be used with");
    lab.fails("probe squares.obj --pixel 1", 2, "such as 360,640");
    lab.fails("probe squares.obj --pixel=-1,2", 2, "such as 360,640");
    lab.fails("probe squares.obj --ray 1,2,3", 2, "six finite numbers");
    lab.fails("probe squares.obj --ray 0,0,5,0,0,-1 --view top", 2, "cannot be used with");
    lab.fails(
        "probe squares.obj --ray 0,0,5,0,0,-1 --t-min 3 --t-max 2",
        2,
        "--t-max must be above --t-min",
    );
    lab.fails("probe squares.obj --pixel 0,5000", 2, "768 rows and 1024 columns");
    lab.fails("probe none.obj --pixel 0,0", 3, "none.obj");
}

/// Two wheels called alike, of one mesh with the materials steel and glass; each part of a mesh has
/// one of the file's materials.
fn wheels() -> Value {
    let part =
        |material: usize| json!({"attributes": {"POSITION": material}, "material": material});
    let floats = |values: &[f32]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let near = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let beside = floats(&[2.0, 0.0, 0.0, 3.0, 0.0, 0.0, 2.0, 1.0, 0.0]);
    let hex = |bytes: &[u8]| {
        let mut text = String::new();
        for byte in bytes {
            write!(text, "%{byte:02x}").unwrap();
        }
        text
    };
    let accessor = |view: usize| {
        json!({"bufferView": view, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [3, 1, 0]})
    };
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "nodes": [
            {"name": "truck", "children": [1, 2]},
            {"name": "Wheels", "mesh": 0},
            {"name": "Wheels", "mesh": 0, "translation": [0, 5, 0]},
        ],
        "meshes": [{"name": "Wheel", "primitives": [part(0), part(1)]}],
        "materials": [{"name": "steel"}, {"name": "glass"}],
        "accessors": [accessor(0), accessor(1)],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 36},
        ],
        "buffers": [{
            "byteLength": 72,
            "uri": format!("data:application/octet-stream,{}", hex(&[near, beside].concat())),
        }],
    })
}

#[test]
fn node_mesh_and_material_are_those_of_the_channels() {
    let lab = Lab::new();
    lab.write("wheels.gltf", wheels().to_string());
    let camera = "--view front --size 12x16";
    let channels = ["object", "node", "mesh", "material"];
    lab.ok(&format!("render wheels.gltf {camera} -o all.npz --channels {}", channels.join(",")));
    let all = lab.npz("all.npz");
    let said: Value = serde_json::from_str(lab.ok("info all.npz --json").text()).unwrap();
    let names = &said["metadata"]["names"];
    let mut seen = std::collections::BTreeSet::new();
    for (k, object) in all["object"].values.iter().enumerate() {
        if *object < 0.0 {
            continue;
        }
        let pixel = format!("--pixel {},{}", k / 12, k % 12);
        if !seen.insert(channels.map(|channel| all[channel].values[k].to_bits())) {
            continue;
        }
        let hit = story(&lab, &format!("wheels.gltf {camera} {pixel}"))["hit"].clone();
        let text = lab.ok(&format!("probe wheels.gltf {camera} {pixel}"));
        for channel in ["node", "mesh", "material"] {
            let number = usize::try_from(hit[channel]["id"].as_u64().unwrap()).unwrap();
            assert_eq!(number as f64, all[channel].values[k], "{channel} of {pixel}");
            let name = &names[channel][number];
            assert_eq!(&hit[channel]["name"], name, "{channel} of {pixel}");
            let words = format!("{channel} {number} '{}'", name.as_str().unwrap());
            assert!(text.text().contains(&words), "{words}: {}", text.text());
        }
    }
    // Both wheels, and both materials of each.
    assert_eq!(seen.len(), 4, "{seen:?}");
}

#[test]
fn long_names_are_cut_in_text_and_whole_in_json() {
    let lab = Lab::new();
    let name = "\u{e4}".repeat(70_000);
    let square = format!("o {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    lab.write("long.obj", square);
    let ray = "long.obj --ray 0.2,0.2,5,0,0,-1";
    let outcome = lab.ok(&format!("probe {ray}"));
    let cut = format!("object 0 '{}...' (mesh)", "\u{e4}".repeat(100));
    assert!(outcome.text().contains(&cut));
    let longest = outcome.text().lines().map(|line| line.chars().count()).max();
    assert!(longest < Some(250), "{longest:?}");
    let story = story(&lab, ray);
    assert_eq!(story["hit"]["name"], json!(name));
    assert_eq!(story["candidates"][0]["name"], json!(name));
}
