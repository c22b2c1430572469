//! Light, colours and backgrounds.

use crate::support::{ABOVE, Array, Lab, SQUARE};

/// A floor from -2 to 2 with a small square floating one above it.
fn floor() -> Lab {
    let lab = Lab::new();
    let both = SQUARE
        .replace("vertex 4", "vertex 8")
        .replace("face 1", "face 2")
        .replace(
            "-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n4 0 1 2 3\n",
            "-2 -2 0\n2 -2 0\n2 2 0\n-2 2 0\n-.5 -.5 1\n.5 -.5 1\n.5 .5 1\n-.5 .5 1\n4 0 1 2 3\n4 4 5 6 7\n",
        );
    lab.write("floor.ply", both);
    lab
}

fn close(got: f64, expected: f64) -> bool {
    // Colours are stored as float32.
    (got - expected).abs() <= f64::from(f32::EPSILON) * expected.max(1.0)
}

/// The colour and the position of every pixel.
fn colours(lab: &Lab, options: &str) -> (Array, Array) {
    lab.ok(&format!(
        "render floor.ply --position 0,-6,3 --look-at 0,0,0 --size 32x24 --fov 30 \
         --channels color,position -o a.npz {options}"
    ));
    let mut all = lab.npz("a.npz");
    (
        all.remove("color").unwrap(),
        all.remove("position").unwrap(),
    )
}

#[test]
fn unlit_colours_and_the_background_are_exact_srgb() {
    let lab = Lab::with_square();
    lab.ok(&format!(
        "render square.ply {ABOVE} --shader unlit --color 0.2,0.5,1 --background 0,1,0.25"
    ));
    let (_, _, bytes) = lab.png("square.png");
    // The sRGB curve: 0.2 -> 0.4845, 0.5 -> 0.7354, 0.25 -> 0.5371.
    assert_eq!(bytes[..3], [0, 255, 137]);
    assert_eq!(bytes[3 * (12 * 33 + 16)..][..3], [124, 188, 255]);
}

#[test]
fn a_floating_square_throws_a_shadow() {
    let lab = floor();
    let light = "--light directional:0,0,-1 --ambient 0.1,0.1,0.1 --color 0.5,0.5,0.5";
    let (shadows, position) = colours(&lab, light);
    let (none, _) = colours(&lab, &format!("{light} --no-shadows"));
    let (mut dark, mut lit) = (0, 0);
    for (k, p) in position.values.chunks_exact(3).enumerate() {
        if p[0].is_nan() {
            continue;
        }
        let (shadow, without) = (shadows.values[3 * k], none.values[3 * k]);
        if p[2].abs() < 1e-9 && p[0].abs() < 0.5 && p[1].abs() < 0.5 {
            assert!(close(shadow, 0.05), "{p:?} {shadow}");
            assert!(without > 0.4, "{p:?} {without}");
            dark += 1;
        } else {
            assert_eq!(shadow, without, "{p:?}");
            lit += 1;
        }
    }
    assert!(dark > 10 && lit > 100, "{dark} {lit}");
}

#[test]
fn light_adds_up_and_comes_from_where_it_is() {
    let lab = floor();
    let centre = |options: &str| {
        let more = format!("--no-shadows --color 1,1,1 --ambient 0,0,0 {options}");
        let (color, _) = colours(&lab, &more);
        color.values[3 * (12 * 32 + 16)]
    };
    let below = centre("--light directional:0,0,1");
    let above = centre("--light directional:0,0,-1");
    let slanted = centre("--light directional:0,3,-4");
    assert_eq!(below, 0.0, "the camera sees the other side");
    assert!(close(slanted, 0.8 * above), "{slanted} {above}");
    let both = centre("--light directional:0,0,-1 --light directional:0,3,-4");
    assert!(close(both, above + slanted), "{both}");
    assert!(centre("--light point:0,-1,4") > 0.1);
    assert_eq!(centre("--light point:0,-1,-4"), 0.0);
}

#[test]
fn ambient_light_reaches_everything() {
    let lab = floor();
    let (color, position) = colours(
        &lab,
        "--light directional:0,0,1 --ambient 0.5,0.25,0 --color 1,0.5,1",
    );
    let k = 12 * 32 + 16;
    assert!(position.values[3 * k].is_finite());
    assert_eq!(color.values[3 * k..][..3], [0.5, 0.125, 0.0]);
}

#[test]
fn the_sky_goes_from_the_horizon_to_the_zenith() {
    let lab = Lab::with_square();
    lab.ok(
        "render square.ply --position 0,0,50 --aim 1,0,0 --up 0,0,1 --fov 90 --size 5x9 \
        --sky 1,0,0:0,0,1 --channels color -o s.npz --quiet",
    );
    let color = &lab.npz("s.npz")["color"];
    let blue = |row: usize| color.values[3 * (5 * row + 2) + 2];
    assert!(blue(0) > 0.4, "{}", blue(0));
    assert!((0..4).all(|row| blue(row) > blue(row + 1)));
    let horizon = &color.values[3 * (5 * 4 + 2)..][..3];
    assert!(
        close(horizon[0], 1.0) && close(horizon[2], 0.0),
        "{horizon:?}"
    );
}

#[test]
fn the_normal_shader_shows_directions() {
    let lab = Lab::with_square();
    lab.ok(&format!(
        "render square.ply {ABOVE} --shader normal --channels color -o n.npz"
    ));
    let color = &lab.npz("n.npz")["color"];
    assert_eq!(color.values[3 * (12 * 33 + 16)..][..3], [0.5, 0.5, 1.0]);
}

#[test]
fn the_files_own_colours_win() {
    let lab = Lab::new();
    let red = SQUARE
        .replace(
            "property float z\n",
            "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n",
        )
        .replace(" 0\n", " 0 255 0 0\n");
    lab.write("square.ply", red);
    lab.ok(&format!("render square.ply {ABOVE} --shader unlit"));
    assert_eq!(
        lab.png("square.png").2[3 * (12 * 33 + 16)..][..3],
        [255, 0, 0]
    );
}

#[test]
fn options_that_would_do_nothing_say_so() {
    let lab = Lab::with_square();
    let warns = |arguments: &str, words: &str| {
        let text = lab.ok(arguments).stderr;
        assert!(
            text.contains(&format!("warning: {words}")),
            "{arguments}: {text}"
        );
    };
    for option in [
        "--samples 4",
        "--shader unlit",
        "--light directional:0,0,-1",
        "--ambient 1,1,1",
        "--no-shadows",
        "--color 1,0,0",
        "--background 1,0,0",
        "--sky 1,1,1:0,0,1",
    ] {
        let name = option.split(' ').next().unwrap();
        let words = format!("{name} does nothing without color");
        warns(
            &format!("render square.ply --size 8x8 --channels t {option}"),
            &words,
        );
    }
    for shader in ["unlit", "normal"] {
        for option in ["--light point:0,0,1", "--ambient 1,1,1", "--no-shadows"] {
            let name = option.split(' ').next().unwrap();
            let words = format!("{name} does nothing with --shader {shader}");
            warns(
                &format!("render square.ply --size 8x8 --shader {shader} {option}"),
                &words,
            );
        }
    }
    warns(
        "render square.ply --size 8x8 --shader normal --color 1,0,0",
        "--color does nothing",
    );
    warns(
        "demo --size 8x8 --samples 4 --channels t",
        "--samples does nothing",
    );
}

#[test]
fn a_background_and_a_sky_exclude_each_other() {
    let lab = Lab::with_square();
    lab.fails(
        "render square.ply --background 1,1,1 --sky 1,1,1:0,0,0",
        2,
        "cannot be used with",
    );
}

#[test]
fn wrong_colours_and_lights_are_refused() {
    let lab = Lab::with_square();
    for (option, words) in [
        ("--color 1,0", "linear red, green and blue"),
        ("--background -1,0,0", "none of them negative"),
        ("--sky 1,1,1", "the horizon and the zenith"),
        ("--light 1,2,3", "expected directional:X,Y,Z"),
        ("--light -1,0,0", "expected directional:X,Y,Z"),
        ("--light directional:0,0,0", "a direction that is not zero"),
        ("--light point:1e300,0,0", "no farther away than 1e150"),
        ("--shader gold", "[possible values: lambert, unlit, normal]"),
        ("--samples 0", "1..=65536"),
        ("--threads 0", "1..=1024"),
    ] {
        lab.fails(&format!("render square.ply {option}"), 2, words);
    }
}
