//! The channels in files, number by number.

use crate::support::{ABOVE, Array, Lab, SQUARE, array};

const COLUMNS: usize = 33;
const ROWS: usize = 25;
/// Distances here are below 8, and a few operations away from the formula's.
const ROUNDING: f64 = 16.0 * 8.0 * f64::EPSILON;

/// A pixel of the viewplane of [`ABOVE`], relative to its centre.
fn place(row: usize, column: usize) -> (f64, f64) {
    let x = -2.0 + 4.0 / COLUMNS as f64 * (column as f64 + 0.5);
    let y = 1.5 - 3.0 / ROWS as f64 * (row as f64 + 0.5);
    (x, y)
}

fn near(array: &Array, index: usize, expected: f64) {
    let got = array.values[index];
    assert!((got - expected).abs() <= ROUNDING, "{index}: {got} {expected}");
}

#[test]
fn every_pixel_has_the_distances_of_the_formula() {
    let lab = Lab::with_square();
    let channels = "t,range,z,object,primitive,face,normal,incidence,position,front";
    lab.ok(&format!("render square.ply {ABOVE} --channels {channels} -o all.npz"));
    let all = lab.npz("all.npz");
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let k = row * COLUMNS + column;
            let (x, y) = place(row, column);
            // From the viewplane at 2 to the square at 5.
            let (hit_x, hit_y) = (2.5 * x, 2.5 * y);
            if hit_x.abs() > 1.0 || hit_y.abs() > 1.0 {
                for name in ["t", "range", "z"] {
                    assert_eq!(all[name].values[k], f64::INFINITY, "{name}");
                }
                for name in ["object", "primitive", "face"] {
                    assert_eq!(all[name].values[k], -1.0, "{name}");
                }
                assert!(all["incidence"].values[k].is_nan());
                for name in ["normal", "position"] {
                    let values = &all[name].values[3 * k..][..3];
                    assert!(values.iter().all(|x| x.is_nan()), "{name}");
                }
                assert_eq!(all["front"].values[k], 0.0);
                continue;
            }
            let to_viewplane = (x * x + y * y + 4.0).sqrt();
            near(&all["t"], k, 1.5 * to_viewplane);
            near(&all["range"], k, 2.5 * to_viewplane);
            near(&all["z"], k, 5.0);
            #[expect(clippy::disallowed_methods, reason = "the test allows for rounding")]
            near(&all["incidence"], k, (2.0 / to_viewplane).acos());
            for (axis, expected) in [hit_x, hit_y, 0.0].into_iter().enumerate() {
                near(&all["position"], 3 * k + axis, expected);
            }
            assert_eq!(all["normal"].values[3 * k..][..3], [0.0, 0.0, 1.0]);
            for (name, expected) in [("object", 0.0), ("face", 0.0), ("front", 1.0)] {
                assert_eq!(all[name].values[k], expected, "{name}");
            }
        }
    }
    // The centre is on the edge that both triangles share: the lower one has it.
    let centre = ROWS / 2 * COLUMNS + COLUMNS / 2;
    assert_eq!(all["primitive"].values[centre], 0.0);
    assert_eq!(all["t"].values[centre], 3.0);
}

#[test]
fn arrays_have_the_types_and_shapes_that_are_documented() {
    let lab = Lab::with_square();
    let names = "color,t,range,z,object,primitive,face,normal,incidence,position,barycentric,uv,base_color,front";
    lab.ok(&format!("render square.ply --size 32x24 --channels {names} -o all.npz"));
    let all = lab.npz("all.npz");
    assert_eq!(all.len(), 14);
    for (name, array) in &all {
        let (dtype, components) = match name.as_str() {
            "color" => ("<f4", 3),
            "t" | "range" | "z" | "incidence" => ("<f8", 1),
            "object" | "primitive" | "face" => ("<i4", 1),
            "uv" => ("<f8", 2),
            "front" => ("|b1", 1),
            _ => ("<f8", 3),
        };
        let shape: &[u64] = match components {
            1 => &[24, 32],
            n => &[24, 32, n],
        };
        assert_eq!((array.dtype.as_str(), &array.shape[..]), (dtype, shape), "{name}");
    }
}

#[test]
fn row_0_is_the_top() {
    let lab = Lab::new();
    // Only the upper half of the square: y from 0 to 1.
    let upper = SQUARE.replace("-1 -1 0\n1 -1 0\n", "-1 0 0\n1 0 0\n");
    lab.write("upper.ply", upper);
    lab.ok("render upper.ply --position 0,0,3 --aim 0,0,-1 --up 0,1,0 --fov 30 --size 9x8 --channels object -o o.npy");
    let object = array(&lab.read("o.npy"));
    assert_eq!(object.shape, [8, 9]);
    assert_eq!(object.values[3 * 9 + 4], 0.0);
    assert_eq!(object.values[4 * 9 + 4], -1.0);
}

#[test]
fn a_placeholder_makes_a_file_of_each_channel() {
    let lab = Lab::with_square();
    lab.ok("render square.ply --size 32x24 --channels z,object,normal -o s-{channel}.png -o {channel}.npy -o all.npz");
    let expected = "all.npz,normal.npy,normal.npy.json,object.npy,object.npy.json,\
        s-normal.png,s-object.png,s-z.png,square.ply,z.npy,z.npy.json";
    assert_eq!(lab.names().join(","), expected);
    assert_eq!(lab.png("s-object.png").1, 24);
    let all = lab.npz("all.npz");
    assert_eq!(array(&lab.read("z.npy")), all["z"]);
    assert_eq!(array(&lab.read("object.npy")), all["object"]);
}

#[test]
fn a_picture_of_distances_comes_with_its_legend() {
    let lab = Lab::with_square();
    let outcome = lab.ok(&format!("render square.ply {ABOVE} --channels t"));
    let lines: Vec<&str> = outcome.stderr.lines().collect();
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[1].starts_with("square.png: t from 3.0 (yellow) to "), "{lines:?}");
}

#[test]
fn depth_is_z_and_says_so() {
    let lab = Lab::with_square();
    let outcome = lab.ok("render square.ply --size 32x24 --channels depth -o d.npz");
    assert!(outcome.stderr.contains("depth is written as z"), "{}", outcome.stderr);
    assert!(lab.npz("d.npz").contains_key("z"));
    let quiet = lab.ok("render square.ply --size 32x24 --channels depth -o d.npz --quiet");
    assert_eq!(quiet.stderr, "");
}

#[test]
fn a_channel_asked_for_twice_is_there_once() {
    let lab = Lab::with_square();
    lab.ok("render square.ply --size 8x6 --channels t,z,depth,t -o d.npz");
    assert_eq!(lab.npz("d.npz").len(), 2);
}

/// The program knew no length, and of two lengths it would have made the first.
#[test]
fn ambient_occlusion_has_a_length() {
    let lab = Lab::with_square();
    let wall = "-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n-1 1 1\n1 1 1\n4 0 1 2 3\n4 3 2 5 4\n";
    let corner = SQUARE.replace("vertex 4", "vertex 6").replace("face 1", "face 2");
    let (head, _) = corner.split_once("end_header\n").unwrap();
    lab.write("corner.ply", format!("{head}end_header\n{wall}"));
    let mean = |channel: &str| {
        lab.ok(&format!("render corner.ply {ABOVE} --samples 16 --channels {channel} -o a.npz"));
        let values = lab.npz("a.npz").remove("ao").unwrap().values;
        values.iter().sum::<f64>() / values.len() as f64
    };
    let [near, far] = ["ao:0.1", "ao"].map(mean);
    assert!(far < near && near < 1.0, "{far} {near}");
    let words = "--channels: two channels would both be called ao";
    lab.fails("render corner.ply --channels ao:1,ao -o b.npz", 2, words);
    lab.fails("render corner.ply --channels ao:-1 -o b.npz", 2, "ao:-1");
}

/// The second file got the numbers of the first.
#[test]
fn two_outputs_of_a_file_cannot_have_other_channels_of_one_name() {
    let lab = Lab::with_square();
    let output = |name: &str, channel: &str| {
        format!("[[outputs]]\nfile = \"{name}.npz\"\nchannels = [\"{channel}\"]\n")
    };
    let outputs = output("c", "attribute:a b") + &output("d", "attribute:a_b");
    lab.write("a.toml", format!("[[objects]]\nfile = \"square.ply\"\n{outputs}"));
    let words = "two attributes would both be called attribute:a_b";
    lab.fails("render a.toml", 3, words);
}

#[test]
fn a_channel_that_would_be_lost_is_refused() {
    let lab = Lab::with_square();
    lab.fails("render square.ply --channels color,t", 2, "the channel t goes to no file");
    lab.fails("render square.ply --channels t,z", 2, "holds one channel of several");
    lab.fails("demo --channels color,object", 2, "the channel object goes to no file");
    lab.fails(
        "render square.ply --channels foo",
        2,
        "no channel \"foo\", only color, t, range, z,",
    );
    lab.fails("render square.ply --channels=", 2, "no channel \"\"");
}

#[test]
fn every_number_of_threads_writes_the_same_bytes() {
    let lab = Lab::new();
    let mut files = Vec::new();
    for threads in [1, 2, 7] {
        lab.ok(&format!(
            "demo --size 48x30 --samples 3 --threads {threads} -o a.png -o a.npz -o a.exr \
             --channels color,t,object,primitive,normal,position,barycentric"
        ));
        files.push(["a.png", "a.npz", "a.exr"].map(|name| lab.read(name)));
    }
    assert_eq!(files[0], files[1]);
    assert_eq!(files[0], files[2]);
}

#[test]
fn samples_change_colours_alone_and_always_alike() {
    let lab = Lab::new();
    let arrays = |samples: u32| {
        lab.ok(&format!(
            "demo --size 32x20 --samples {samples} --channels color,t,object,primitive -o a.npz"
        ));
        lab.npz("a.npz")
    };
    let (one, four, again) = (arrays(1), arrays(4), arrays(4));
    assert_eq!(four["color"], again["color"]);
    assert_ne!(one["color"], four["color"]);
    for name in ["t", "object", "primitive"] {
        assert_eq!(one[name], four[name], "{name}");
    }
}

#[test]
fn a_misspelt_channel_is_told_which_is_meant() {
    let lab = Lab::with_square();
    for (arguments, meant) in [
        ("render square.ply --channels normals", "normal"),
        ("render square.ply --channels color,objects -o a.npz", "object"),
        ("shoot square.ply rays.npy --channels t,postion", "position"),
        ("demo --channels rnage", "range"),
    ] {
        lab.fails(arguments, 2, &format!("did you mean {meant}?"));
    }
    lab.ok("render square.ply --size 8x8 --channels t,object -o a.npz");
    lab.fails("diff a.npz a.npz --channels objct", 2, "did you mean object?");
    lab.fails("render square.ply --channels xyzzy", 2, "only color, t, range");
    // Blanks around names are nobody's mistake.
    let spaced =
        lab.command("render square.ply --size 8x8 -o b.npz --channels").arg("t, object").output();
    assert!(spaced.unwrap().status.success());
}

#[test]
fn numbers_in_sentences_have_few_digits() {
    let lab = Lab::new();
    let third = SQUARE.replace("-1 -1 0", "-1.23456789 -1.000000123 0.333333333333");
    lab.write("square.ply", third);
    let longest = |text: &str| -> usize {
        let pieces = text.split(|c: char| !c.is_ascii_digit() && c != '.');
        let digits = |piece: &str| {
            piece.trim_start_matches(['0', '.']).chars().filter(char::is_ascii_digit).count()
        };
        pieces.map(digits).max().unwrap_or(0)
    };
    for arguments in [
        "render square.ply --size 32x24 --channels z,position,color -o a-{channel}.png",
        "render square.ply --size 32x24 --channels z,normal -o a.exr --position 0.1,0.2,7.123456789 --look-at 0,0,0",
        "render square.ply --size 32x24 --position 0.1,0.2,7.123456789 --aim 0,0.123456789,1",
        "info square.ply",
    ] {
        let outcome = lab.ok(arguments);
        let said = format!("{}{}", outcome.stderr, outcome.text());
        // A place may take one more, to a millionth of the scene's size.
        assert!(longest(&said) <= 7, "{arguments}: {said}");
    }
    // The fingerprint is no number.
    let info = lab.ok("info a.exr");
    let lines = info.text().lines().filter(|line| !line.starts_with("scene"));
    for line in lines {
        assert!(longest(line) <= 6 || line.contains("4294967295"), "{line}");
    }
    let exact = lab.ok("info square.ply --json");
    assert!(exact.text().contains("0.333333333333"), "{}", exact.text());
}

#[test]
fn cryptomattes_go_to_files_that_hold_them() {
    let lab = Lab::with_square();
    lab.ok(&format!(
        "render square.ply {ABOVE} --samples 16 --channels color,crypto_object -o a.exr -o a.npz"
    ));
    let exr = String::from_utf8_lossy(&lab.read("a.exr")).into_owned();
    for words in ["CryptoObject02.A", "cryptomatte/3ae39a5/manifest", "MurmurHash3_32"] {
        assert!(exr.contains(words), "{words}");
    }
    let first = lab.npz("a.npz");
    // The pixel in the middle, and the one in the corner.
    let pairs = &first["crypto_object"].values;
    let middle = &pairs[12 * (12 * COLUMNS + 16)..][..12];
    assert_eq!(middle[1], 1.0);
    assert_eq!(middle[2..], [0.0; 10]);
    assert_eq!(pairs[..12], [0.0; 12]);
    lab.ok(&format!("render square.ply {ABOVE} --channels crypto_object:2 -o two.npy"));
    assert_eq!(array(&lab.read("two.npy")).shape, [25, 33, 4]);
    for (output, channels, words) in [
        ("a.png", "crypto_object", "a.png holds no Cryptomatte (crypto_object); use .exr or .npz"),
        ("a.ply", "crypto_object", "a.ply holds no Cryptomatte"),
        ("{channel}.png", "z,crypto_material", "holds no Cryptomatte (crypto_material)"),
        ("a.exr", "crypto_object:7", "an even number of pairs from 2 to 64, got crypto_object:7"),
    ] {
        let arguments = format!("render square.ply {ABOVE} --channels {channels} -o {output}");
        lab.fails(&arguments, 2, words);
    }
}

#[test]
fn names_beyond_256_kib_that_a_picture_lacks_are_counted_by_info() {
    let lab = Lab::new();
    let name = "x".repeat(200);
    let triangle = |k: usize| format!("o {name}{k}\nf 1 2 3\n");
    let all: String = (0..1500).map(triangle).collect();
    lab.write("many.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{all}"));
    lab.ok("render many.obj --size 4x3 --channels object -o a.exr");
    // Each takes 200 to 204 bytes and 8 more.
    let bytes = |k: usize| name.len() + k.to_string().len() + 8;
    let mut taken = 0;
    let fit = (0..1500).take_while(|&k| {
        taken += bytes(k);
        taken <= 1 << 18
    });
    let lacking = 1500 - fit.count();
    assert!(lacking > 100, "{lacking}");
    let info = lab.ok("info a.exr");
    let line = info.text().lines().find(|line| line.starts_with("names")).unwrap().to_owned();
    let wanted = format!("{lacking} of object: there is room for 256 KiB");
    assert!(line.contains(&wanted), "{line}");
    lab.ok("render many.obj --size 4x3 --channels z -o b.exr");
    assert!(!lab.ok("info b.exr").text().contains("\nnames"));
}
