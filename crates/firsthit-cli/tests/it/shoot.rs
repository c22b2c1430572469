//! Rays of the user's own.

use std::io::{BufRead, BufReader, Read};

use crate::support::{Lab, array, arrays, rays_npy};

const DOWN: &str = "0.5,0.25,10,0,0,-1\n";

fn csv(lab: &Lab, options: &str, rays: &str) -> String {
    let outcome = lab.pipe(&format!("shoot square.ply - {options}"), rays.as_bytes());
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    outcome.text().to_owned()
}

#[test]
fn pipes_work_both_ways() {
    let lab = Lab::with_square();
    assert_eq!(csv(&lab, "", DOWN), "t,object,primitive\n10,0,0\n");
    assert_eq!(csv(&lab, "-o -", DOWN), "t,object,primitive\n10,0,0\n");
    let outcome = lab.pipe("shoot square.ply - --format npz", DOWN.as_bytes());
    assert_eq!(outcome.stderr.lines().count(), 1);
    assert_eq!(arrays(outcome.stdout)["t"].values, [10.0]);
    let outcome = lab.pipe("shoot square.ply - --format npy --channels position", DOWN.as_bytes());
    let position = array(&outcome.stdout);
    assert_eq!((&position.shape[..], &position.values[..]), (&[1, 3][..], &[0.5, 0.25, 0.0][..]));
    // What one run writes, the next one reads.
    let rays = rays_npy(&[[0.5, 0.25, 10.0, 0.0, 0.0, -2.0]]);
    assert_eq!(lab.pipe("shoot square.ply - --quiet", &rays).text(), "t,object,primitive\n5,0,0\n");
}

#[test]
fn every_channel_of_a_list_has_its_columns() {
    let lab = Lab::with_square();
    let text = csv(
        &lab,
        "--channels t,object,primitive,face,normal,position,barycentric,uv,front",
        "0.5,0.25,10,0,0,-1\n9,9,9,0,0,1\n",
    );
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "t,object,primitive,face,normal_x,normal_y,normal_z,position_x,position_y,position_z,\
         barycentric_0,barycentric_1,barycentric_2,uv_u,uv_v,front"
    );
    assert_eq!(lines[1], "10,0,0,0,0,0,1,0.5,0.25,0,0.25,0.125,0.625,nan,nan,1");
    assert_eq!(lines[2], "inf,-1,-1,-1,nan,nan,nan,nan,nan,nan,nan,nan,nan,nan,nan,0");
}

#[test]
fn numbers_in_csv_are_short_and_exact() {
    let lab = Lab::with_square();
    let rays = "0,0,1e149,0,0,-1\n0,0,1e-30,0,0,-1\n0.1,0.1,0.1,0,0,-0.3\n";
    let text = csv(&lab, "--channels t", rays);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[..3], ["t", "1e149", "1e-30"]);
    let third: f64 = lines[3].parse().unwrap();
    assert!((third - 0.1 / 0.3).abs() <= f64::EPSILON, "{third}");
}

#[test]
fn t_max_ends_rays_and_is_a_hit_itself() {
    let lab = Lab::with_square();
    let t = |t_max: &str| csv(&lab, &format!("--channels t --t-max {t_max}"), DOWN);
    assert_eq!(t("9.999"), "t\ninf\n");
    assert_eq!(t("10"), "t\n10\n");
    assert_eq!(t("inf"), "t\n10\n");
    lab.fails(
        "shoot square.ply - --t-max 0",
        2,
        "--t-max must be above --t-min, which is 0 if not given",
    );
    lab.fails("shoot square.ply - --t-max nan", 2, "expected a number, or inf");
}

#[test]
fn t_min_begins_rays_and_is_no_hit_itself() {
    let lab = Lab::with_square();
    let t = |t_min: &str| csv(&lab, &format!("--channels t --t-min {t_min}"), DOWN);
    assert_eq!(t("0"), "t\n10\n");
    assert_eq!(t("9.999"), "t\n10\n");
    assert_eq!(t("10"), "t\ninf\n");
    // A negative one lets a ray meet what it starts on, and what is behind.
    let on = |t_min: &str| {
        let rays = "0,0,0,0,0,1\n0,0,3,0,0,1\n";
        csv(&lab, &format!("--channels t --t-min {t_min}"), rays)
    };
    assert_eq!(on("0"), "t\ninf\ninf\n");
    assert_eq!(on("-1"), "t\n0\ninf\n");
    assert_eq!(on("-inf"), "t\n0\n-3\n");
    assert_eq!(on("-4 --t-max 0"), "t\n0\n-3\n");
    assert_eq!(on("-4 --t-max -1"), "t\ninf\n-3\n");
    for wrong in ["inf", "nan", "one"] {
        lab.fails(&format!("shoot square.ply - --t-min {wrong}"), 2, "expected a number, or -inf");
    }
    lab.fails("shoot square.ply - --t-min 3 --t-max 2", 2, "--t-max must be above --t-min");
}

#[test]
fn every_hit_is_there_with_the_number_of_its_ray() {
    let lab = Lab::with("cube_binary.stl", "cube.stl");
    // Down through the cube, past it, and from its middle; the first one through a diagonal of two
    // faces.
    let info: serde_json::Value =
        serde_json::from_str(lab.ok("info cube.stl --json").text()).unwrap();
    let bounds = |end: usize, axis: usize| info["bounds"][end][axis].as_f64().unwrap();
    let [x, y, z] = [0, 1, 2].map(|axis| 0.5 * (bounds(0, axis) + bounds(1, axis)));
    let height = bounds(1, 2) - bounds(0, 2);
    let above = bounds(1, 2) + 1.0;
    let rays = format!("{x},{y},{above},0,0,-1\n1e3,1e3,0,0,0,1\n{x},{y},{z},0,0,1\n");
    lab.write("rays.csv", &rays);
    let outcome = lab.pipe("shoot cube.stl - --all --channels t,front", rays.as_bytes());
    let far = 1.0 + height;
    let half = 0.5 * height;
    let lines = format!("ray,t,front\n0,1,1\n0,{far},0\n2,{half},0\n");
    assert_eq!(outcome.text(), lines);
    assert!(outcome.stderr.contains("3 rays, 66.7 % hit, 3 hits, "), "{}", outcome.stderr);
    let outcome = lab.ok("shoot cube.stl rays.csv --nearest 1 -o a.npz -o a.csv -o a.ply --json");
    let said: serde_json::Value = serde_json::from_str(outcome.text()).unwrap();
    assert_eq!(
        (&said["rays"], &said["hits"], &said["crossings"]),
        (&3.into(), &2.into(), &2.into())
    );
    assert_eq!(said["outputs"][0]["channels"][0], "ray");
    let arrays = lab.npz("a.npz");
    assert_eq!(arrays["ray"].values, [0.0, 2.0]);
    assert_eq!(arrays["t"].values, [1.0, half]);
    assert_eq!(String::from_utf8(lab.read("a.csv")).unwrap().lines().count(), 3);
    lab.ok("shoot cube.stl rays.csv --all -o {channel}.npy");
    assert_eq!(array(&lab.read("ray.npy")).values, [0.0, 0.0, 2.0]);
    assert!(lab.ok("info a.ply").text().contains("ray"));
    lab.fails("shoot cube.stl rays.csv --all --nearest 2", 2, "--nearest");
    lab.fails("shoot cube.stl rays.csv --nearest 0", 2, "--nearest");
    lab.fails(
        "shoot cube.stl rays.csv --all -o t.npy --channels t",
        2,
        "holds one channel of several",
    );
}

#[test]
fn rays_that_make_no_sense_miss_alone() {
    let lab = Lab::with_square();
    let rays = "0,0,1,0,0,-1\nnan,0,1,0,0,-1\n0,0,1,0,0,0\n0,0,1,0,inf,-1\n0,0,2,0,0,-1\n";
    assert_eq!(csv(&lab, "--channels t", rays), "t\n1\ninf\ninf\ninf\n2\n");
}

#[test]
fn no_rays_are_no_hits() {
    let lab = Lab::with_square();
    for rays in ["", "x,y,z,dx,dy,dz\n", "# nothing\n"] {
        assert_eq!(csv(&lab, "", rays), "t,object,primitive\n", "{rays:?}");
    }
    lab.write("none.npy", rays_npy(&[]));
    let outcome = lab.ok("shoot square.ply none.npy -o hits.npz --channels t,normal");
    assert!(outcome.stderr.starts_with("hits.npz: 0 rays, 0.0 % hit"), "{}", outcome.stderr);
    let hits = lab.npz("hits.npz");
    assert_eq!((&hits["t"].shape[..], &hits["normal"].shape[..]), (&[0][..], &[0, 3][..]));
}

#[test]
fn several_files_and_standard_output_get_the_same() {
    let lab = Lab::with_square();
    let outcome = lab.pipe(
        "shoot square.ply - -o hits.csv -o {channel}.npy -o all.npz -o - --channels t,object",
        DOWN.as_bytes(),
    );
    assert_eq!(outcome.text(), "t,object\n10,0\n");
    assert!(
        outcome.stderr.starts_with(
            "standard output, hits.csv, t.npy, object.npy, all.npz: 1 ray, 100.0 % hit"
        ),
        "{}",
        outcome.stderr
    );
    assert_eq!(lab.read("hits.csv"), outcome.stdout);
    assert_eq!(array(&lab.read("t.npy")), lab.npz("all.npz")["t"]);
    assert_eq!(
        lab.names(),
        [
            "all.npz",
            "hits.csv",
            "object.npy",
            "object.npy.json",
            "square.ply",
            "t.npy",
            "t.npy.json"
        ]
    );
}

#[test]
fn what_needs_a_camera_or_would_be_ignored_is_refused() {
    let lab = Lab::with_square();
    lab.write("rays.csv", DOWN);
    for (options, words) in [
        ("--channels t,range", "range takes a camera, and is for firsthit render"),
        ("--channels color", "color takes a camera"),
        ("--channels depth", "z takes a camera"),
        ("--channels nope", "no channel \"nope\", only t, object,"),
        ("--format npz -o hits.csv", "--format is for standard output"),
        ("--format npy", "--format npy holds one channel"),
        ("-o hits.npy", "holds one channel of several"),
        ("-o - -o -", "named twice"),
        ("-o hits.csv -o ./hits.csv", "named twice"),
        ("-o hits.png", "must end in one of .npy, .npz, .ply, .pcd, .csv"),
        ("-o hits", "must end in one of .npy, .npz, .ply, .pcd, .csv"),
        ("-o rays.csv", "rays.csv is an input"),
        ("-o ./rays.csv", "./rays.csv is an input"),
        ("rays.csv", "the same file"),
        ("--format xml", "[possible values: csv, npy, npz]"),
    ] {
        lab.fails(&format!("shoot square.ply rays.csv {options}"), 2, words);
    }
    assert_eq!(lab.read("rays.csv"), DOWN.as_bytes());
}

#[test]
fn a_reader_who_has_had_enough_is_no_failure() {
    let lab = Lab::with_square();
    lab.write("rays.csv", DOWN.repeat(50_000));
    let mut child = lab.start("shoot square.ply rays.csv -o hits.npz -o -");
    let mut line = String::new();
    BufReader::with_capacity(64, child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    assert_eq!(line, "t,object,primitive\n");
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!((child.wait().unwrap().code(), stderr.as_str()), (Some(0), ""));
    assert_eq!(lab.npz("hits.npz")["t"].values.len(), 50_000);
}

#[test]
fn nobody_listening_on_standard_error_is_no_failure() {
    let lab = Lab::with_square();
    let mut child =
        lab.start("render square.ply --size 32x24 --position 0,0,5 --aim 0,0,1 --up 0,1,0");
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(lab.png("square.png").0, 32);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_a_failure() {
    let lab = Lab::with_square();
    lab.write("rays.csv", DOWN);
    for arguments in
        ["shoot square.ply rays.csv", "shoot square.ply rays.csv --format npz", "info square.ply"]
    {
        let full = std::fs::File::create("/dev/full").unwrap();
        let output = lab.command(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(4), "{arguments}");
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(stderr.starts_with("firsthit: error: standard output: "), "{stderr}");
    }
}
