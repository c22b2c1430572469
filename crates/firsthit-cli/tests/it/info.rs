//! The contents of a file, as `firsthit info` tells them.

use std::io::{Cursor, Write};

use serde_json::{Value, json};

use crate::support::{Lab, Outcome, SQUARE, npy};

fn info(lab: &Lab, file: &str) -> Value {
    let outcome = lab.ok(&format!("info {file} --json"));
    assert_eq!(outcome.stderr, "");
    serde_json::from_slice(&outcome.stdout).unwrap()
}

#[test]
fn json_has_the_counts_and_the_bounds() {
    let lab = Lab::with_square();
    let square = info(&lab, "square.ply");
    assert_eq!(square["triangles"], 2);
    assert_eq!(square["vertices"], 4);
    assert_eq!(square["bounds"], json!([[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]]));
    assert_eq!(square["objects"].as_array().unwrap().len(), 1);
    assert_eq!(square["objects"][0]["name"], "square");
    assert_eq!(square["objects"][0]["bounds"], square["bounds"]);
    assert_eq!(square["warnings"], json!([]));
}

#[test]
fn objects_come_in_the_order_of_the_file() {
    let lab = Lab::new();
    lab.write(
        "two.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 5\no b\nf 1 2 3\no a\nf 1 2 4\nf 2 3 4\n",
    );
    let two = info(&lab, "two.obj");
    let objects = two["objects"].as_array().unwrap();
    let of = |k: usize| {
        (objects[k]["name"].as_str().unwrap(), objects[k]["triangles"].as_u64().unwrap())
    };
    assert_eq!((of(0), of(1)), (("b", 1), ("a", 2)));
    assert_eq!(two["up"], json!([0.0, 1.0, 0.0]));
}

#[test]
fn up_is_that_of_the_picture_with_its_source() {
    let lab = Lab::with_square();
    let said = |file: &str| lab.ok(&format!("info {file}")).text().to_owned();
    assert!(said("square.ply").contains("up         0,0,1 (by the format's convention)"));
    // A column on a base: a file of a format with y up that stands on z.
    lab.write(
        "column.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 3\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n",
    );
    assert!(said("column.obj").contains("up         0,0,1 (guessed from a flat base)"));
    lab.write(
        "scene.toml",
        "up = [1, 0, 0]\n[[objects]]\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n",
    );
    assert!(said("scene.toml").contains("up         1,0,0 (as the file says)"));
}

#[test]
fn text_says_the_same() {
    let lab = Lab::with_square();
    let outcome = lab.ok("info square.ply");
    let text = outcome.text();
    for line in [
        "triangles  2",
        "vertices   4",
        "bounds     -1,-1,0 to 1,1,0",
        "size       2 x 2 x 0",
        "objects    1",
        "  0  square  (mesh, 2 triangles)",
    ] {
        assert!(text.lines().any(|other| other == line), "{line}: {text}");
    }
    let kernels = text.lines().find_map(|line| line.strip_prefix("kernels    "));
    assert!(["avx512", "avx2", "neon", "portable"].contains(&kernels.unwrap()), "{text}");
    assert_eq!(outcome.stderr, "");
}

#[test]
fn an_empty_file_has_no_bounds() {
    let lab = Lab::new();
    lab.write("empty.stl", "solid nothing\nendsolid nothing\n");
    let empty = info(&lab, "empty.stl");
    assert_eq!((&empty["triangles"], &empty["bounds"]), (&json!(0), &Value::Null));
    assert_eq!(empty["warnings"].as_array().unwrap().len(), 1);
    assert!(lab.ok("info empty.stl").text().contains("bounds     none"));
    let outcome = lab.ok("render empty.stl --size 32x24");
    assert!(
        outcome.stderr.contains("nothing was hit: there is nothing to see"),
        "{}",
        outcome.stderr
    );
}

#[test]
fn unusable_triangles_are_a_warning_and_an_error_when_strict() {
    let lab = Lab::new();
    lab.write("nan.ply", SQUARE.replace("-1 1 0\n", "nan 1 0\n"));
    let nan = info(&lab, "nan.ply");
    assert_eq!(nan["triangles"], 1);
    assert_eq!(nan["warnings"].as_array().unwrap().len(), 1);
    for command in ["info nan.ply", "render nan.ply --size 8x6 -o x.png"] {
        let outcome = lab.ok(command);
        assert!(outcome.stderr.starts_with("firsthit: warning: nan.ply"), "{}", outcome.stderr);
    }
    std::fs::remove_file(lab.path("x.png")).unwrap();
    for command in ["info nan.ply", "render nan.ply"] {
        lab.fails(&format!("{command} --strict"), 3, "nan.ply");
    }
    assert_eq!(lab.run("info nan.ply --json --strict").code, 3);
}

#[test]
fn the_environment_chooses_the_instruction_set() {
    let lab = Lab::with_square();
    let run = |set: &str| {
        let mut command = lab.command("info square.ply");
        Outcome::of(command.env("FIRSTHIT_ISA", set).output().unwrap())
    };
    let portable = run("portable");
    assert_eq!(portable.code, 0, "{}", portable.stderr);
    assert!(portable.text().contains("kernels    portable"));
    let unknown = run("sse9");
    assert_eq!(unknown.code, 2);
    let message = "firsthit: error: FIRSTHIT_ISA must be ";
    assert!(unknown.stderr.starts_with(message), "{}", unknown.stderr);
    assert_eq!(unknown.stderr.lines().count(), 1, "{}", unknown.stderr);
}

/// The lines of JSON and text about the environment of a scene file.
fn environment_of(lab: &Lab, text: &str) -> (Value, String) {
    lab.write("around.toml", text);
    let line = |said: &str| {
        let mut lines = said.lines();
        lines.find_map(|line| line.strip_prefix("environment ").map(str::to_owned))
    };
    let said = lab.ok("info around.toml");
    let listed = info(lab, "around.toml")["environment"].take();
    (listed, line(said.text()).unwrap_or_default())
}

#[test]
fn a_map_is_told_with_its_size_and_by_how_much_it_is_turned() {
    let lab = Lab::new();
    lab.write("a.hdr", b"#?RADIANCE\n\n-Y 1 +X 2\n\x80\x80\x80\x80\x80\x80\x80\x80");
    let about = |direction: [f64; 3], degrees: f64| json!({"axis": direction, "degrees": degrees});
    for (keys, rotate, words) in [
        ("", about([0.0, 0.0, 1.0], 0.0), ""),
        ("rotate = 30", about([0.0, 0.0, 1.0], 30.0), ", turned by 30 degrees"),
        ("rotate = 270", about([0.0, 0.0, 1.0], -90.0), ", turned by -90 degrees"),
        (
            "rotate = { axis = [0, -2, 0], degrees = 20 }",
            about([0.0, -1.0, 0.0], 20.0),
            ", turned by 20 degrees about 0,-1,0",
        ),
    ] {
        let text = format!("[environment]\nfile = 'a.hdr'\nstrength = 2.5\nseen = false\n{keys}\n");
        let (listed, line) = environment_of(&lab, &text);
        assert_eq!(line, format!("map, 2 x 1 texels{words}, strength 2.5, not seen"));
        let numbers = |value: &Value| -> Vec<f64> {
            let axis = value["axis"].as_array().unwrap().iter();
            axis.chain([&value["degrees"]]).map(|x| x.as_f64().unwrap()).collect()
        };
        for (got, expected) in numbers(&listed["rotate"]).into_iter().zip(numbers(&rotate)) {
            assert!((got - expected).abs() < 1e-9, "{keys}: {listed}");
        }
        assert_eq!((&listed["kind"], &listed["seen"]), (&json!("map"), &json!(false)));
        assert_eq!((&listed["columns"], &listed["rows"]), (&json!(2), &json!(1)));
        assert_eq!(listed["strength"], json!(2.5));
    }
    lab.ok("build around.toml -o around.fhs");
    let built = info(&lab, "around.fhs");
    assert_eq!(built["environment"]["columns"], json!(2));
    assert_eq!(built["environment"]["strength"], json!(2.5));
}

#[test]
fn other_environments_are_told_by_their_colours_and_their_sun_is_a_light() {
    let lab = Lab::new();
    let (listed, line) = environment_of(&lab, "[environment]\ncolor = [1, 2, 3]\n");
    assert_eq!(line, "uniform, 1,2,3, strength 1");
    let color = json!([1.0, 2.0, 3.0]);
    assert_eq!(listed, json!({"kind": "uniform", "color": color, "strength": 1.0, "seen": true}));
    let (listed, line) = environment_of(&lab, "[environment]\nabove = 'white'\nbelow = 'black'\n");
    assert_eq!(line, "hemispheres, above 1,1,1, below 0,0,0, strength 1");
    assert_eq!(listed["up"], json!([0.0, 0.0, 1.0]));
    let (listed, line) =
        environment_of(&lab, "[environment]\nhorizon = 'white'\nzenith = 'blue'\n");
    assert_eq!(line, "gradient, horizon 1,1,1, zenith 0,0,1, strength 1");
    assert_eq!(listed["zenith"], json!([0.0, 0.0, 1.0]));
    let (listed, line) = environment_of(&lab, "[environment]\ndaylight = { elevation = 35 }\n");
    assert_eq!(line, "daylight, elevation 35, azimuth 0, turbidity 3, strength 1");
    assert_eq!(listed["elevation"], json!(35.0));
    assert_eq!(info(&lab, "around.toml")["lights"][0]["kind"], "directional");
    let (listed, line) = environment_of(&lab, "");
    assert_eq!((listed, &*line), (Value::Null, ""));
}

/// `count` triangles, each an object.
fn crowd(count: usize) -> String {
    (0..count).fold(String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n"), |text, k| {
        text + &format!("o part {k}\nf 1 2 3\n")
    })
}

#[test]
fn text_lists_the_first_twenty_of_each_kind_and_says_how_many_more() {
    let lab = Lab::new();
    lab.write("crowd.obj", crowd(25));
    let lights = "[[lights]]\nkind = 'point'\nposition = [0, 0, 1]\n".repeat(22);
    lab.write("crowd.toml", format!("{lights}[[objects]]\nfile = 'crowd.obj'\n"));
    let said = lab.ok("info crowd.toml");
    let lines: Vec<&str> = said.text().lines().collect();
    let at = |line: &str| lines.iter().position(|&other| other == line);
    let objects = at("objects    25").unwrap();
    assert_eq!(lines[objects + 20], "  19  part 19  (mesh, 1 triangle)");
    assert_eq!(lines[objects + 21], "  ... and 5 more (--all lists them)");
    let lights = at("lights     22").unwrap();
    assert_eq!(lines[lights + 21], "  ... and 2 more (--all lists them)");
    let all = lab.ok("info crowd.toml --all");
    assert!(!all.text().contains("more"), "{}", all.text());
    assert!(all.text().contains("  24  part 24  (mesh, 1 triangle)"));
    lab.write("twenty.obj", crowd(20));
    assert!(!lab.ok("info twenty.obj").text().contains("more"));
}

#[test]
fn json_lists_the_first_ten_thousand_of_each_kind_and_counts_all() {
    let lab = Lab::new();
    lab.write("crowd.obj", crowd(10_003));
    let listed = info(&lab, "crowd.obj");
    assert_eq!(listed["objects"].as_array().unwrap().len(), 10_000);
    assert_eq!(
        listed["counts"],
        json!({"objects": 10_003, "cameras": 0, "lights": 0, "materials": 0, "textures": 0, "variants": 0})
    );
    let all = info(&lab, "crowd.obj --all");
    assert_eq!(all["objects"].as_array().unwrap().len(), 10_003);
    let square = Lab::with_square();
    square.ok("render square.ply --size 8x6 -o a.npz --channels z,t");
    assert_eq!(info(&square, "a.npz")["counts"], json!({"arrays": 2}));
}

/// A mark that reorders the text after it, one that ends a line on some terminals, and one that is
/// not seen.
const TRICK: &str = "a\u{202e}gnp\u{9b}31m\u{200b}b";

#[test]
fn names_in_files_reach_no_terminal_as_they_are() {
    let lab = Lab::new();
    let ascii_only = |outcome: &Outcome| {
        let text = format!("{}{}", outcome.text(), outcome.stderr);
        assert!(text.is_ascii(), "{text}");
    };
    // Of a camera, of a property, of an object.
    lab.write(
        "camera.gltf",
        format!(
            "{{\"asset\": {{\"version\": \"2.0\"}}, \"nodes\": [{{\"camera\": 0, \"name\": \"{TRICK}\"}}], \
             \"cameras\": [{{\"type\": \"perspective\", \"perspective\": {{\"yfov\": 1, \"znear\": 1}}}}]}}"
        ),
    );
    let property = format!("property float z\nproperty float {TRICK}");
    lab.write(
        "property.ply",
        SQUARE.replace("property float z", &property).replace(" 0\n", " 0 7\n"),
    );
    lab.write(
        "object.toml",
        "[[objects]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nname = \"\"\"a\u{202e}\u{200b}b\"\"\"\n",
    );
    for file in ["camera.gltf", "property.ply", "object.toml"] {
        ascii_only(&lab.ok(&format!("info {file}")));
        ascii_only(&lab.ok(&format!("info {file} --json")));
    }
    // An array of an archive, in a list, in a comparison, and in a failure.
    let array = npy("<f8", false, "(1,)", &[0; 8]);
    lab.write("a.npz", npz(&format!("{TRICK}.npy"), &array));
    ascii_only(&lab.ok("info a.npz"));
    ascii_only(&lab.ok("info a.npz --json"));
    // A program gets the name itself.
    assert_eq!(info(&lab, "a.npz")["arrays"][0]["name"], TRICK);
    ascii_only(&lab.ok("diff a.npz a.npz --json"));
    ascii_only(&lab.ok("diff a.npz a.npz"));
    lab.write("square.ply", SQUARE);
    for json in ["", "--json"] {
        let failed = lab.run(&format!("shoot square.ply a.npz -o b.npz {json}"));
        assert_eq!(failed.code, 3);
        ascii_only(&failed);
    }
}

/// An archive of one entry.
fn npz(name: &str, content: &[u8]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
    archive.write_all(content).unwrap();
    archive.finish().unwrap().into_inner()
}

/// A cube from `low` on, as faces of an OBJ whose vertices are numbered from `first` on.
fn cube(low: f64, size: f64, first: u32) -> String {
    let vertex = |k: u32| {
        let [x, y, z] = [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| low + size * f64::from(bit));
        format!("v {x} {y} {z}\n")
    };
    let faces = ["1 3 4 2", "1 2 6 5", "2 4 8 6", "4 3 7 8", "3 1 5 7", "5 6 8 7"];
    let face = |face: &&str| {
        let numbers = face.split(' ').map(|k| k.parse::<u32>().unwrap() - 1 + first);
        let numbers: Vec<String> = numbers.map(|k| k.to_string()).collect();
        format!("f {}\n", numbers.join(" "))
    };
    (0..8).map(vertex).chain(faces.iter().map(face)).collect()
}

#[test]
fn a_mesh_has_its_area_its_volume_and_its_shells() {
    let lab = Lab::new();
    lab.write("two.obj", cube(0.0, 2.0, 1) + &cube(5.0, 1.0, 9));
    let text = lab.ok("info two.obj").text().to_owned();
    for line in [
        "       closed, area 30, volume 9, 2 shells",
        "         shell  12 triangles, closed, area 24, volume 8, 0,0,0 to 2,2,2",
        "         shell  12 triangles, closed, area 6, volume 1, 5,5,5 to 6,6,6",
    ] {
        assert!(text.lines().any(|other| other == line), "{line}: {text}");
    }
    let object = &info(&lab, "two.obj")["objects"][0];
    assert_eq!(object["is_closed"], true);
    assert_eq!((&object["area"], &object["volume"]), (&json!(30.0), &json!(9.0)));
    assert_eq!((&object["shell_count"], &object["shells"][1]["volume"]), (&json!(2), &json!(1.0)));
    lab.write("moved.toml", "[[objects]]\nfile = 'two.obj'\nscale = 2\n");
    let object = &info(&lab, "moved.toml")["objects"][0];
    assert_eq!((&object["area"], &object["volume"]), (&json!(120.0), &json!(72.0)));
    lab.write("open.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    assert!(lab.ok("info open.obj").text().contains("\n       open, area 1\n"));
    assert_eq!(info(&lab, "open.obj")["objects"][0]["volume"], Value::Null);
}
