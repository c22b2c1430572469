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
    (all.remove("color").unwrap(), all.remove("position").unwrap())
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
    // Positions are those of the pixels' centres.
    let light = "--samples 1 --light directional:0,0,-1 --ambient 0.1,0.1,0.1 --color 0.5,0.5,0.5";
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
    let (color, position) =
        colours(&lab, "--light directional:0,0,1 --ambient 0.5,0.25,0 --color 1,0.5,1");
    let k = 12 * 32 + 16;
    assert!(position.values[3 * k].is_finite());
    assert_eq!(color.values[3 * k..][..3], [0.5, 0.125, 0.0]);
}

#[test]
fn the_sky_goes_from_the_horizon_to_the_zenith() {
    let lab = Lab::with_square();
    lab.ok("render square.ply --position 0,0,50 --aim 1,0,0 --up 0,0,1 --fov 90 --size 5x9 \
        --sky 1,0,0:0,0,1 --samples 1 --channels color -o s.npz --quiet");
    let color = &lab.npz("s.npz")["color"];
    let blue = |row: usize| color.values[3 * (5 * row + 2) + 2];
    assert!(blue(0) > 0.4, "{}", blue(0));
    assert!((0..4).all(|row| blue(row) > blue(row + 1)));
    let horizon = &color.values[3 * (5 * 4 + 2)..][..3];
    assert!(close(horizon[0], 1.0) && close(horizon[2], 0.0), "{horizon:?}");
}

#[test]
fn the_normal_shader_shows_directions() {
    let lab = Lab::with_square();
    lab.ok(&format!("render square.ply {ABOVE} --shader normal --channels color -o n.npz"));
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
    assert_eq!(lab.png("square.png").2[3 * (12 * 33 + 16)..][..3], [255, 0, 0]);
}

#[test]
fn options_that_would_do_nothing_say_so() {
    let lab = Lab::with_square();
    let warns = |arguments: &str, words: &str| {
        let text = lab.ok(arguments).stderr;
        assert!(text.contains(&format!("warning: {words}")), "{arguments}: {text}");
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
        warns(&format!("render square.ply --size 8x8 --channels t {option}"), &words);
    }
    for shader in ["unlit", "normal"] {
        for option in ["--light point:0,0,1", "--ambient 1,1,1", "--no-shadows"] {
            let name = option.split(' ').next().unwrap();
            let words = format!("{name} does nothing with --shader {shader}");
            warns(&format!("render square.ply --size 8x8 --shader {shader} {option}"), &words);
        }
    }
    warns("render square.ply --size 8x8 --shader normal --color 1,0,0", "--color does nothing");
    lab.write("a.mtl", "newmtl m\nKd 1 0 0\n");
    lab.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    warns(
        "render a.obj --size 8x8 --color red",
        "--color does nothing here: every object has a material of its own",
    );
    warns("demo --size 8x8 --samples 4 --channels t", "--samples does nothing");
}

#[test]
fn a_background_and_a_sky_exclude_each_other() {
    let lab = Lab::with_square();
    lab.fails("render square.ply --background 1,1,1 --sky 1,1,1:0,0,0", 2, "cannot be used with");
}

#[test]
fn wrong_colours_and_lights_are_refused() {
    let lab = Lab::with_square();
    for (option, words) in [
        ("--color 1,0", "linear red, green and blue"),
        ("--background -1,0,0", "none of them negative"),
        ("--sky 1,1,1", "the horizon and the zenith"),
        ("--light 1,2,3", "such as point:1,2,3"),
        ("--light -1,0,0", "such as point:1,2,3"),
        ("--light directional:0,0,0", "not all zero"),
        ("--light point:1e300,0,0", "no farther away than 1e150"),
        ("--shader gold", "[possible values: direct, path, whitted, lambert,"),
        ("--samples 0", "1..=65536"),
        ("--threads 0", "1..=1024"),
    ] {
        lab.fails(&format!("render square.ply {option}"), 2, words);
    }
}

#[test]
fn colours_have_names_and_levels_that_are_decoded_from_srgb() {
    let lab = Lab::with_square();
    let corner_and_middle = |options: &[&str]| {
        let mut command = lab.command(&format!("render square.ply {ABOVE} --shader unlit"));
        let output = command.args(options).output().unwrap();
        assert!(output.status.success() && !output.stderr.windows(7).any(|w| w == b"warning"));
        let (_, _, bytes) = lab.png("square.png");
        let middle = 3 * (12 * 33 + 16);
        [[bytes[0], bytes[1], bytes[2]], [bytes[middle], bytes[middle + 1], bytes[middle + 2]]]
    };
    // Levels come back as the bytes that they are.
    let seen = corner_and_middle(&["--background", "SteelBlue", "--color", "#123456"]);
    assert_eq!(seen, [[0x46, 0x82, 0xb4], [0x12, 0x34, 0x56]]);
    let seen = corner_and_middle(&["--sky", "Gold:#ff0000", "--color", "rebeccapurple"]);
    assert_eq!(seen[1], [0x66, 0x33, 0x99]);
    let gray = corner_and_middle(&["--background", "0.5,0.5,0.5", "--color", "gray"]);
    assert_eq!(gray, [[188; 3], [128; 3]]);
    for (wrong, words) in [
        ("--color stelblue", "did you mean steelblue?"),
        ("--color #12345", "or sRGB as '#rrggbb'"),
        ("--background stelblue", "or transparent; did you mean steelblue?"),
        ("--color transparent", "only a background can be transparent"),
        ("--sky white:transparent", "only a background can be transparent"),
    ] {
        lab.fails(&format!("render square.ply {wrong}"), 2, words);
    }
}

#[test]
fn levels_in_place_of_linear_numbers_are_a_warning() {
    let lab = Lab::with_square();
    let said = lab.ok("render square.ply --size 8x8 --color 255,0,0 --ambient 1,1,1").stderr;
    assert!(
        said.contains("warning: --color 255,0,0: colours are linear, from 0 to 1; levels from 0 to 255 are written '#ff0000'"),
        "{said}"
    );
    assert_eq!(said.matches("warning").count(), 1, "{said}");
    let bright = lab.ok("render square.ply --size 8x8 --background 1.5,1,1 --color 1,0,1").stderr;
    assert!(!bright.contains("warning"), "{bright}");
    lab.write(
        "scene.toml",
        "[background]\ncolor = [255, 128, 0]\n[[lights]]\nkind = \"directional\"\ndirection = [0, 0, -1]\ncolor = [3, 3, 3]\n",
    );
    let said = lab.ok("info scene.toml").stderr;
    assert!(said.contains("scene.toml:2:9: the colour [255, 128, 0]"), "{said}");
    assert_eq!(said.matches("warning").count(), 1, "{said}");
}

#[test]
fn a_transparent_background_is_seen_through_and_edges_are_covered_in_part() {
    let lab = Lab::with_square();
    let options = "--shader unlit --color 0.5,0.25,1 --background transparent --samples 16";
    lab.ok(&format!("render square.ply {ABOVE} {options} --channels color,t -o a.exr -o a.npz"));
    lab.ok(&format!("render square.ply {ABOVE} {options} -o a.png"));
    let color = &lab.npz("a.npz")["color"];
    assert_eq!(color.shape, [25, 33, 4]);
    let pixels: Vec<&[f64]> = color.values.chunks_exact(4).collect();
    let mut partly = 0;
    for pixel in &pixels {
        let alpha = pixel[3];
        // Sixteen points, each covered or not; the colour is multiplied by their share.
        assert_eq!((alpha * 16.0).fract(), 0.0);
        assert_eq!(pixel[..3], [0.5 * alpha, 0.25 * alpha, alpha]);
        partly += usize::from(alpha > 0.0 && alpha < 1.0);
    }
    assert_eq!(pixels[0], [0.0; 4]);
    assert_eq!(pixels[12 * 33 + 16][3], 1.0);
    assert!(partly > 8, "{partly}");
    // A PNG has the whole colour beside its alpha.
    let mut reader =
        png::Decoder::new(std::io::Cursor::new(lab.read("a.png"))).read_info().unwrap();
    assert_eq!(reader.info().color_type, png::ColorType::Rgba);
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    for (pixel, bytes) in pixels.iter().zip(bytes.chunks_exact(4)) {
        let expected = (pixel[3] * 255.0).round();
        assert_eq!(f64::from(bytes[3]), expected);
        let color = if pixel[3] > 0.0 { [188, 137, 255] } else { [0; 3] };
        assert_eq!(bytes[..3], color);
    }
    let info = lab.ok("info a.exr");
    assert!(info.text().contains("R G B A"), "{}", info.text());
    assert!(info.text().contains("a miss is transparent"), "{}", info.text());
    lab.ok("diff a.exr a.npz");
    // With one point for each pixel it is there or not; a scene file may say the same.
    lab.write(
        "scene.toml",
        "[background]\ncolor = \"transparent\"\n[[objects]]\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\ncolor = \"tomato\"\n",
    );
    lab.ok("render scene.toml --size 16x12 --samples 1 --no-ground -o b.npz");
    let color = &lab.npz("b.npz")["color"];
    assert_eq!(color.shape, [12, 16, 4]);
    assert!(color.values.chunks_exact(4).all(|pixel| pixel[3] == 0.0 || pixel[3] == 1.0));
}
