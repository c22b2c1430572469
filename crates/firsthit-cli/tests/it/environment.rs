//! Light from all around, asked for on the command line.

use crate::support::{ABOVE, Lab};

/// Four texels, the middle of which is between the second and the third.
fn lab() -> Lab {
    let lab = Lab::with_square();
    let texels: Vec<[u8; 4]> = [32, 64, 96, 128].map(|k| [k, k, k, 128]).to_vec();
    let bytes = [b"#?RADIANCE\n\n-Y 1 +X 4\n", texels.as_flattened()].concat();
    lab.write("a.hdr", bytes);
    lab
}

/// The first and the middle pixel's red, seen from above or as `camera` says.
fn reds(lab: &Lab, options: &str) -> [f64; 2] {
    lab.ok(&format!(
        "render square.ply {ABOVE} --color 1,1,1 --no-ground -o a.npz --channels color {options}"
    ));
    let color = lab.npz("a.npz").remove("color").unwrap();
    [color.values[0], color.values[3 * (12 * 33 + 16)]]
}

#[test]
fn an_environment_is_seen_and_lights_unless_it_is_hidden() {
    let lab = lab();
    lab.write("grey.hdr", b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80");
    assert_eq!(reds(&lab, "--environment grey.hdr"), [0.5, 0.5]);
    let twice = "--environment grey.hdr@70 --environment-strength 2";
    assert_eq!(reds(&lab, twice), [1.0, 1.0]);
    let hidden = "--environment grey.hdr --environment-hidden --background 0,0,0";
    assert_eq!(reds(&lab, hidden), [0.0, 0.5]);
}

#[test]
fn degrees_turn_it_about_up() {
    let lab = lab();
    // Level, along +x: what is missed there is the picture's middle.
    let seen = |turn: &str| {
        lab.ok(&format!(
            "render square.ply --position 0,0,9 --aim 1,0,0 --fov 1 --size 1x1 --samples 1 --no-ground \
             -o a.npz --channels color --environment a.hdr{turn}"
        ));
        lab.npz("a.npz").remove("color").unwrap().values[0]
    };
    let mean = |a: f64, b: f64| 0.5 * (a + b) / 256.0;
    for (turn, expected) in
        [("", mean(64.0, 96.0)), ("@90", mean(96.0, 128.0)), ("@-90", mean(32.0, 64.0))]
    {
        assert!((seen(turn) - expected).abs() < 1e-6, "{turn} {}", seen(turn));
    }
}

#[test]
fn a_day_has_a_sky_and_a_sun() {
    let lab = lab();
    let [_, lit] = reds(&lab, "--environment daylight:40,30 --samples 64");
    assert!((lit - 1.0).abs() < 0.2, "{lit}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let lab = lab();
    lab.write("short.hdr", b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80");
    for (options, code, part) in [
        ("--environment daylight:95", 2, "from 0 to 90"),
        ("--environment a.hdr --light studio", 2, "exclude each other"),
        ("--environment-strength 2", 2, "--environment"),
        ("--environment gone.hdr", 3, "gone.hdr"),
        ("--environment short.hdr", 3, "short.hdr @ byte"),
    ] {
        let outcome = lab.run(&format!("render square.ply -o a.npz {options}"));
        assert_eq!(outcome.code, code, "{options}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(part), "{options}: {}", outcome.stderr);
    }
    // An input is not written over.
    lab.write("a.exr", lab.read("a.hdr"));
    let outcome = lab.run("render square.ply -o a.exr --environment a.exr");
    assert_eq!(outcome.code, 2, "{}", outcome.stderr);
}
