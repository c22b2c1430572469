//! Outputs that explain themselves, and how two of them differ.

use std::fs;

use serde_json::{Value, json};

use crate::support::{ABOVE, Lab};

const CHANNELS: &str = "color,t,z,object,normal";

/// The square seen from above, in every format.
fn lab() -> Lab {
    let lab = Lab::with_square();
    lab.ok(&format!(
        "render square.ply {ABOVE} --channels {CHANNELS} -o a.exr -o a.npz -o {{channel}}.npy -o {{channel}}.png"
    ));
    lab
}

fn info(lab: &Lab, file: &str) -> Value {
    let outcome = lab.ok(&format!("info {file} --json"));
    serde_json::from_slice(&outcome.stdout).unwrap()
}

#[test]
fn info_tells_what_a_lens_has_beside_k_and_how_a_scan_was_made() {
    let lab = Lab::with_square();
    let distorted =
        "--intrinsics 20,20,12,9 --convention ros --projection opencv --parameters k1=-0.1,p1=0.01";
    lab.ok(&format!(
        "render square.ply -o a.npz --size 24x18 {distorted} --aperture 0.5 --focus 3"
    ));
    let outcome = lab.ok("info a.npz");
    let text = outcome.text();
    assert!(text.contains("\n  lens         aperture 0.5, focus 3, k1 -0.1, p1 0.01\n"), "{text}");
    lab.ok(&format!("render square.ply {ABOVE} -o b.npz"));
    assert!(!lab.ok("info b.npz").text().contains("\n  lens"));
    // As `firsthit scan` writes it.
    let said = json!({
        "metadata_version": 1, "firsthit": "0.1.0", "scene": null, "shape": [0], "pixels": null, "camera": null,
        "sensor": null, "samples": null, "channels": [],
        "scan": {"returns": "all", "divergence": 0.003, "max_returns": null, "noise": [0.5, 0.25], "seed": 7},
        "scans": [{}, {}],
    });
    lab.write(
        "c.ply",
        format!("ply\nformat binary_little_endian 1.0\ncomment firsthit {said}\nelement vertex 0\nproperty double x\nproperty double y\nproperty double z\nend_header\n"),
    );
    let outcome = lab.ok("info c.ply");
    let text = outcome.text();
    assert!(
        text.contains("\nscan           divergence 0.003, noise 0.5 0.25, returns all, seed 7\nscans          2 put together\n"),
        "{text}"
    );
}

#[test]
fn info_reads_the_camera_and_the_channels_back_from_every_format() {
    let lab = lab();
    let mut scenes = Vec::new();
    for (file, names) in [("a.exr", CHANNELS), ("a.npz", CHANNELS), ("z.npy", "z"), ("z.png", "z")]
    {
        let said = info(&lab, file);
        let metadata = &said["metadata"];
        let camera = &metadata["camera"];
        assert_eq!(camera["position"], json!([0.0, 0.0, 5.0]), "{file}");
        assert_eq!(camera["aim"], json!([0.0, 0.0, -1.0]));
        assert_eq!(camera["focal_length"], 2.0);
        assert_eq!((&camera["width"], &camera["height"]), (&json!(4.0), &json!(3.0)));
        // f N / w, f M / h, and the middle.
        let k = json!([[16.5, 0.0, 16.5], [0.0, 2.0 * 25.0 / 3.0, 12.5], [0.0, 0.0, 1.0]]);
        assert_eq!(camera["intrinsics"]["k"], k);
        let pose = json!([
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 5.0],
            [0.0, 0.0, 0.0, 1.0]
        ]);
        assert_eq!(camera["pose"]["world_from_camera"], pose);
        let channels = metadata["channels"].as_array().unwrap();
        let found: Vec<&str> = channels.iter().map(|c| c["name"].as_str().unwrap()).collect();
        assert_eq!(found.join(","), names, "{file}");
        scenes.push(metadata["scene"].as_str().unwrap().to_owned());
        let text = lab.ok(&format!("info {file}"));
        assert!(text.text().contains("\n  position     0,0,5\n"), "{}", text.text());
        assert_eq!(text.stderr, "");
    }
    scenes.dedup();
    assert_eq!(scenes.len(), 1);
    assert!(scenes[0].starts_with("blake3:"));
}

#[test]
fn a_lit_scene_has_one_fingerprint_in_pictures_scans_and_rays() {
    let lab = Lab::new();
    lab.write(
        "lit.toml",
        "[[objects]]\nshape = \"sphere\"\ncenter = [5, 0, 0]\nradius = 1\n\n[[lights]]\nkind = \"directional\"\ndirection = [0, 0, -1]\n\n[environment]\ncolor = [0.4, 0.1, 0.6]\n",
    );
    lab.write("rays.csv", "0,0,0,1,0,0\n");
    lab.ok("render lit.toml --size 4x3 -o render.npz");
    lab.ok("scan lit.toml --lidar vlp-16 --position 0,0,0 -o scan.npz");
    lab.ok("shoot lit.toml rays.csv -o shoot.npz");
    let scene = |file| info(&lab, file)["metadata"]["scene"].clone();
    for file in ["scan.npz", "shoot.npz"] {
        assert_eq!(scene(file), scene("render.npz"), "{file}");
    }
}

#[test]
fn a_batch_of_rays_says_that_no_camera_made_it() {
    let lab = Lab::with_square();
    lab.write("rays.csv", "0,0,5,0,0,-2\n");
    lab.ok("shoot square.ply rays.csv -o hits.npz");
    let metadata = &info(&lab, "hits.npz")["metadata"];
    assert_eq!((&metadata["camera"], &metadata["pixels"]), (&Value::Null, &Value::Null));
    assert_eq!(metadata["shape"], json!([1]));
    assert_eq!(metadata["channels"][0]["unit"], "length of the ray's direction");
}

#[test]
fn a_file_without_metadata_says_so() {
    let lab = lab();
    fs::remove_file(lab.path("z.npy.json")).unwrap();
    assert_eq!(info(&lab, "z.npy")["metadata"], Value::Null);
    let text = lab.ok("info z.npy");
    assert!(text.text().contains("metadata       none: not written by firsthit, or lost since"));
    assert!(text.text().contains("25 x 33 of float64"), "{}", text.text());
}

/// The distances of the square along the aim are 5, and one rounding less.
const ROUNDED_Z: &str = "z: equal as float32; largest difference 8.88178e-16 (";

#[test]
fn the_same_picture_in_two_formats_is_equal() {
    let lab = lab();
    let outcome = lab.ok("diff a.exr a.npz");
    let [color, t, z, object, normal] = outcome.text().lines().collect::<Vec<_>>()[..] else {
        panic!("{}", outcome.text());
    };
    assert_eq!([color, object, normal], ["color: equal", "object: equal", "normal: equal"]);
    assert!(t.starts_with("t: equal as float32; largest difference 1.14118e-7 ("), "{t}");
    assert!(z.starts_with(ROUNDED_Z), "{z}");
    assert!(lab.ok("diff z.npy a.exr").text().starts_with(ROUNDED_Z));
    assert_eq!(lab.ok("diff color.png color.png").text(), "color: equal\n");
    lab.ok("diff a.exr a.npz --channels object,depth");
}

#[test]
fn a_difference_is_told_with_its_size_and_its_place() {
    let lab = lab();
    let mut z = lab.read("z.npy");
    // Row 12, column 16, the middle: from 5 to 5.25.
    let at = z.len() - 8 * (25 * 33) + 8 * (12 * 33 + 16);
    assert_eq!(z[at..at + 8], 5.0_f64.to_le_bytes());
    z[at..at + 8].copy_from_slice(&5.25_f64.to_le_bytes());
    fs::copy(lab.path("z.npy.json"), lab.path("other.npy.json")).unwrap();
    lab.write("other.npy", z);
    let outcome = lab.run("diff z.npy other.npy");
    assert_eq!((outcome.code, outcome.stderr.as_str()), (1, ""));
    assert_eq!(
        outcome.text(),
        "z: 1 of 825 differ; largest difference 0.25 (5.0 and 5.25) at row 12, column 16, 281474976710656 ulp of float64\n"
    );
    assert_eq!(lab.run("diff a.npz other.npy --tolerance 0.2").code, 1);
    lab.ok("diff a.npz other.npy --tolerance 0.25");
    let outcome = lab.run("diff z.npy other.npy --json");
    let said: Value = serde_json::from_slice(&outcome.stdout).unwrap();
    assert_eq!((outcome.code, &said["equal"]), (1, &json!(false)));
    assert_eq!(said["channels"][0]["at"], json!([12, 16]));
    assert_eq!(said["channels"][0]["values"], json!([5.0, 5.25]));
}

#[test]
fn a_hit_and_a_miss_differ_beyond_every_tolerance() {
    let lab = lab();
    lab.ok(&format!("render square.ply {ABOVE} --position 0.5,0,5 --channels z,object -o b.npz")
        .replace("--position 0,0,5", ""));
    let outcome = lab.run("diff a.npz b.npz --tolerance 1e300 --channels z,object");
    assert_eq!(outcome.code, 1);
    assert!(outcome.text().contains("largest difference inf ("), "{}", outcome.text());
    let outcome = lab.run("diff a.npz b.npz --tolerance 1e300 --json --channels z");
    let said: Value = serde_json::from_slice(&outcome.stdout).unwrap();
    assert_eq!(said["channels"][0]["largest"], "inf");
}

#[test]
fn channels_and_pixels_that_are_missing_are_differences() {
    let lab = lab();
    lab.ok(&format!("render square.ply {ABOVE} --channels z,uv -o b.npz"));
    let outcome = lab.run("diff a.exr b.npz");
    assert_eq!(outcome.code, 1);
    assert!(outcome.text().starts_with(ROUNDED_Z), "{}", outcome.text());
    for line in ["object: only in a.exr", "uv: only in b.npz"] {
        assert!(outcome.text().lines().any(|other| other == line), "{}", outcome.text());
    }
    lab.ok("demo --size 9x8 --samples 1 --channels z -o small.npz");
    let outcome = lab.run("diff a.exr small.npz --channels z");
    assert_eq!(outcome.code, 1);
    assert!(outcome.text().contains("the shapes [25, 33] and [8, 9] differ"));
}

#[test]
fn what_cannot_be_compared_is_wrong_usage_or_bad_input() {
    let lab = lab();
    lab.fails("diff a.exr z.png", 2, "bytes to look at");
    lab.fails("diff a.exr a.npz --channels uv", 2, "a.exr has no channel \"uv\", only color, t,");
    lab.fails("diff z.npy object.npy", 2, "no channel is in both");
    lab.fails("diff a.exr a.npz --tolerance -1", 2, "zero or a positive number");
    lab.fails("diff a.exr none.exr", 3, "none.exr: No such file");
    lab.fails("diff a.exr square.stl", 2, "known: .png, .exr, .npy, .npz");
    for (whole, name, bytes) in [
        ("a.exr", "x.exr", 900),
        ("a.npz", "x.npz", 900),
        ("z.png", "x.png", 60),
        ("z.npy", "x.npy", 500),
    ] {
        lab.write(name, &lab.read(whole)[..bytes]);
        lab.fails(&format!("info {name}"), 3, name);
        lab.fails(&format!("diff a.npz {name}"), 3, name);
    }
}

#[test]
fn distances_in_steps_are_within_half_a_step() {
    let lab = lab();
    let outcome = lab.ok(&format!(
        "render square.ply {ABOVE} --channels z,object -o s-{{channel}}.png --png-scale 0.001"
    ));
    assert!(
        outcome.stderr.contains("s-z.png: z in steps of 0.001, 16 bits; misses 0"),
        "{}",
        outcome.stderr
    );
    lab.ok("diff s-z.png a.npz --tolerance 0.0005000001");
    lab.ok("diff s-object.png object.png");
    let stored = &info(&lab, "s-z.png")["metadata"]["channels"][0]["stored"];
    assert_eq!((&stored["scale"], &stored["dtype"]), (&json!(0.001), &json!("uint16")));
    fs::remove_file(lab.path("s-z.png")).unwrap();
    fs::remove_file(lab.path("s-object.png")).unwrap();
    lab.fails(
        &format!(
            "render square.ply {ABOVE} --channels z -o new.exr -o s-z.png --png-scale 0.00001"
        ),
        2,
        "; a scale of 0.0000764 fits",
    );
    let idle = lab.ok(&format!("render square.ply {ABOVE} -o c.png --png-scale 0.1"));
    assert!(idle.stderr.contains("--png-scale does nothing without t, range or z in a .png"));
}

#[test]
fn far_distances_labels_float32_and_packed_files_are_as_asked() {
    let lab = lab();
    let z = "--channels z,object,position -o n-{channel}.png -o n.npz";
    let outcome = lab.ok(&format!(
        "render square.ply {ABOVE} {z} --png-scale 0.00001 --far saturate --png-labels --dtype float32 --compress"
    ));
    for said in [
        "n-z.png: z in steps of 0.00001, 16 bits; misses 0; what is beyond 65535 steps is 65535",
        "n-object.png: object plus one, 16 bits; misses 0",
    ] {
        assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
    }
    lab.ok("diff n-object.png object.npy");
    lab.ok("diff n.npz a.npz --channels z --tolerance 0.000001");
    let channels = &info(&lab, "n.npz")["metadata"]["channels"];
    let types: Vec<_> = (0..3).map(|k| channels[k]["dtype"].clone()).collect();
    assert_eq!(types, ["float32", "int32", "float32"]);
    let text = lab.ok("info n-z.png");
    assert!(text.text().contains("what is beyond is 65535"), "{}", text.text());
    let idle =
        lab.ok(&format!("render square.ply {ABOVE} --channels z -o c.npy --png-labels --compress"));
    for said in [
        "--png-labels does nothing without an identifier, such as object, in a .png",
        "--compress does nothing without a .npz",
    ] {
        assert!(idle.stderr.contains(said), "{}", idle.stderr);
    }
    let refused = lab.run(&format!("render square.ply {ABOVE} --channels z -o d.png --far zero"));
    assert!(refused.stderr.contains("--png-scale"), "{}", refused.stderr);
}

#[test]
fn an_old_sidecar_never_stays_beside_a_new_array() {
    let lab = lab();
    let before = lab.read("z.npy.json");
    lab.ok(&format!("render square.ply {ABOVE} --focal-length 1 --channels z -o z.npy")
        .replace("--focal-length 2", ""));
    assert_ne!(lab.read("z.npy.json"), before);
    // A sidecar that cannot be written is known before the work, and nothing is touched.
    let z = lab.read("z.npy");
    fs::remove_file(lab.path("z.npy.json")).unwrap();
    fs::create_dir(lab.path("z.npy.json")).unwrap();
    lab.fails(
        &format!("render square.ply {ABOVE} --channels z -o z.npy"),
        4,
        "z.npy.json: is a folder",
    );
    assert_eq!(lab.read("z.npy"), z);
}

/// A square so bright that a PNG shows it white.
const BRIGHT: &str = "--shader unlit --color 3,1.5,0.25 --samples 1";

#[test]
fn exposure_and_tone_map_are_for_pngs_of_colours() {
    let lab = Lab::with_square();
    let made = |options: &str| {
        let outcome = lab.ok(&format!(
            "render square.ply {ABOVE} {BRIGHT} -q -o a.png -o a.exr -o a.npz {options}"
        ));
        assert_eq!(outcome.stderr, "", "{options}");
        (lab.png("a.png"), lab.read("a.exr"), lab.read("a.npz"))
    };
    let usual = made("");
    let mapped = made("--exposure -1 --tone-map neutral");
    assert!(usual.0 != mapped.0);
    assert!((&usual.1, &usual.2) == (&mapped.1, &mapped.2));
    let stored = &info(&lab, "a.png")["metadata"]["channels"][0]["stored"];
    assert_eq!((&stored["exposure"], &stored["tone_map"]), (&json!(-1.0), &json!("neutral")));
    let outcome = lab.ok("info a.png");
    let text = outcome.text();
    assert!(
        text.contains("(uint8, to look at, exposure -1, tone map neutral, a miss is"),
        "{text}"
    );
    // The colour of half of it, without a tone map, is that of half the light.
    let dimmed = made("--exposure -1");
    let half = BRIGHT.replace("3,1.5,0.25", "1.5,0.75,0.125 --background 0.06,0.085,0.12");
    let half = lab.ok(&format!("render square.ply {ABOVE} {half} -q -o half.png"));
    assert_eq!(half.stderr, "");
    assert!(dimmed.0 == lab.png("half.png"));
}

#[test]
fn exposure_and_tone_map_say_where_they_do_nothing() {
    let lab = Lab::with_square();
    let both = "--exposure 1 --tone-map agx";
    for outputs in ["-o a.exr", "--channels z -o z.png", "--channels color,z -o a.npz"] {
        let outcome = lab.ok(&format!("render square.ply {ABOVE} {outputs} {both}"));
        for option in ["--exposure", "--tone-map"] {
            let said = format!("{option} does nothing without color in a .png");
            assert!(outcome.stderr.contains(&said), "{outputs}: {}", outcome.stderr);
        }
    }
    let demo = lab.ok(&format!("demo --size 8x6 --samples 1 -o d.npz {both}"));
    assert!(demo.stderr.contains("--tone-map does nothing"), "{}", demo.stderr);
    let demo = lab.ok(&format!("demo --size 8x6 --samples 1 -q -o d.png -o d.npz {both}"));
    assert_eq!(demo.stderr, "");
    lab.fails("demo -o d.png --exposure inf", 2, "a finite number");
    lab.fails("demo -o d.png --tone-map filmic", 2, "neutral, agx, aces");
}
