//! The command lines that were promised, as they were promised.

use crate::support::{Lab, rays_npy};

/// Runs what must succeed saying one line, all of it on standard error.
fn one_line(lab: &Lab, arguments: &str) {
    let outcome = lab.ok(arguments);
    assert!(outcome.stdout.is_empty(), "{arguments}");
    let stderr = &outcome.stderr;
    assert_eq!(stderr.lines().count(), 1, "{arguments}: {stderr}");
    // Standard error is no terminal here.
    assert!(!stderr.trim_end().contains(char::is_control), "{stderr:?}");
}

#[test]
fn a_model_is_framed_and_its_picture_is_in_the_current_folder() {
    let lab = Lab::with("cube_quads_ascii.ply", "bunny.ply");
    std::fs::create_dir(lab.path("models")).unwrap();
    std::fs::rename(lab.path("bunny.ply"), lab.path("models/bunny.ply")).unwrap();
    one_line(&lab, "render models/bunny.ply --size 64x48 --no-ground");
    assert_eq!(lab.names(), ["bunny.png", "models"]);
    let (width, height, bytes) = lab.png("bunny.png");
    assert_eq!((width, height), (64, 48));
    // Something in the middle, and the background around it.
    let pixel = |column: usize, row: usize| &bytes[3 * (row * 64 + column)..][..3];
    assert_ne!(pixel(32, 24), pixel(0, 0));
    assert_eq!(pixel(0, 0), pixel(63, 47));
}

#[test]
fn a_viewplane_is_rendered_with_parallel_rays_and_from_the_eye_too() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    let line = "render part.stl --position 200,300,100 --aim -2,-3,-1 --up 0,0,1 \
        --focal-length 35 --viewplane 36x24 --size 720x480 --samples 1";
    for more in ["", " --orthographic", " --orthographic --ray-start eye"] {
        one_line(&lab, &format!("{line}{more}"));
        let (width, height, _) = lab.png("part.png");
        assert_eq!((width, height), (720, 480));
    }
}

#[test]
fn a_picture_and_all_channels_are_written_at_once() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    one_line(
        &lab,
        "render part.stl --position 200,300,100 --look-at 0,0,0 --fov 45 --size 320x240 -o color.png \
         -o all.npz --channels color,t,range,z,object,primitive,normal,position",
    );
    assert_eq!(lab.names(), ["all.npz", "color.png", "part.stl"]);
    let mut names: Vec<String> = lab.npz("all.npz").into_keys().collect();
    names.sort();
    let expected = "color,normal,object,position,primitive,range,t,z";
    assert_eq!(names.join(","), expected);
}

#[test]
fn rays_are_shot_and_hits_are_written() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    lab.write("rays.npy", rays_npy(&[[0.3, 0.2, 10.0, 0.0, 0.0, -1.0]]));
    one_line(&lab, "shoot part.stl rays.npy -o hits.npz");
    let hits = lab.npz("hits.npz");
    assert_eq!(hits["t"].values, [10.0 - f64::from(0.73_f32)]);
    assert_eq!(hits["object"].values, [0.0]);
    assert_eq!(hits.len(), 3);
}

#[test]
fn the_demo_needs_no_file() {
    let lab = Lab::new();
    one_line(&lab, "demo --size 32x20 --samples 2");
    assert_eq!(lab.names(), ["demo.png"]);
    assert_eq!(lab.png("demo.png").0, 32);
}
