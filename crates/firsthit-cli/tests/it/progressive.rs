//! `--resume` and `--noise`.

use serde_json::Value;

use crate::support::{ABOVE, Lab};

/// The square in the middle of six tiles, of which the first and the last are quiet.
const WIDE: &str = "--position 0,0,5 --aim 0,0,-3 --up 0,2,0 --focal-length 2 --viewplane 24x4 --size 96x16 \
    --shader unlit --color 0.1,0.1,0.1 --background 1,1,1";

fn report(lab: &Lab, arguments: &str) -> Value {
    let outcome = lab.ok(&format!("{arguments} --json"));
    serde_json::from_slice(&outcome.stdout).unwrap()
}

/// Mattes and occlusion had all samples, where one run had ended them with the colours.
#[test]
fn several_runs_have_the_bytes_of_one_with_and_without_a_noise() {
    for noise in ["", "--noise 0.001", "--noise 0.9"] {
        let lab = Lab::with_square();
        let render = |samples: u32, more: &str| {
            lab.ok(&format!(
                "render square.ply {WIDE} {noise} --samples {samples} --channels object,color,samples,crypto_object,ao {more}"
            ));
        };
        render(70, "-o once.npz");
        render(40, "-o part.npz --resume s.npz");
        render(70, "-o twice.npz --resume s.npz --threads 3");
        assert!(lab.read("once.npz") == lab.read("twice.npz"), "{noise}");
        let counts = &lab.npz("once.npz")["samples"].values;
        let expected = match noise {
            "" => [70.0, 70.0],
            "--noise 0.001" => [32.0, 70.0],
            _ => [32.0, 32.0],
        };
        assert_eq!([counts[0], counts[48]], expected, "{noise}");
    }
}

#[test]
fn the_number_of_samples_is_that_of_the_picture() {
    let lab = Lab::with_square();
    let render = format!("render square.ply {WIDE} --channels color,samples -o a.npz");
    let said = report(&lab, &format!("{render} --samples 70 --noise 0.9"));
    assert_eq!(said["samples"], 32);
    let shares = ["mean_samples", "share_with_all_samples"].map(|name| said[name].as_f64());
    assert_eq!(shares, [Some(32.0), Some(0.0)]);
    let said = report(&lab, &format!("{render} --samples 3"));
    assert_eq!(said["samples"], 3);
    assert!(said["mean_samples"].is_null());
    let said = report(&lab, &format!("{render} --samples 70 --noise 0.9 --resume s.npz"));
    assert_eq!(said["samples"], 32);
}

/// It was the mean of 8, and said to be that of 4.
#[test]
fn a_state_of_more_samples_than_are_asked_for_is_refused() {
    let lab = Lab::with_square();
    let render = format!("render square.ply {ABOVE} --shader unlit -o a.png --resume s.npz");
    lab.ok(&format!("{render} --samples 8"));
    lab.fails(
        &format!("{render} --samples 4"),
        2,
        "samples must be at least as many as the state has, got 4, and s.npz has 8",
    );
    lab.ok(&format!("{render} --samples 8"));
    lab.fails(
        &format!("{render} --samples 16 --shader matcap").replace("--shader unlit", ""),
        2,
        "which has another shader, other light, another background, or another noise",
    );
}

/// They failed after the rendering, or wrote what nothing reads.
#[test]
fn a_file_that_cannot_keep_a_state_is_told_before_the_file_is_read() {
    let lab = Lab::new();
    lab.write("scene.npz", "");
    for (options, code, words) in [
        ("--resume state", 2, "resume must be a file whose name ends in .npz, got state"),
        ("--resume st.png", 2, "must be a file whose name ends in .npz"),
        ("-o a.exr --resume st.exr", 2, "must be a file whose name ends in .npz"),
        ("-o a.exr --resume nope/s.npz", 4, "nope/s.npz: the folder does not exist"),
        ("-o c.npz --resume c.npz", 2, "c.npz is named twice"),
        (
            "-o a.npz --resume s.npz --channels z,crypto_object",
            2,
            "--resume is of colours: it needs color, alpha or samples",
        ),
    ] {
        lab.fails(&format!("render gone.ply {options}"), code, words);
    }
    // What only the file says is told once it is read.
    let lab = Lab::with_square();
    lab.write(
        "a.toml",
        "[[objects]]\nfile = \"square.ply\"\n[[outputs]]\nfile = \"a.npz\"\nchannels = [\"z\"]\n",
    );
    lab.fails("render a.toml --resume s.npz", 2, "--resume is of colours");
    lab.write("b.toml", "[[objects]]\nfile = \"square.ply\"\n[[outputs]]\nfile = \"s.npz\"\n");
    lab.fails("render b.toml --resume s.npz", 2, "s.npz is named twice");
}

/// It made a pinhole's picture.
#[test]
fn a_single_sample_of_a_lens_is_refused_with_a_state_too() {
    let lab = Lab::with_square();
    for more in ["", "--resume s.npz"] {
        lab.fails(
            &format!("render square.ply {ABOVE} --aperture .3 --focus 3 --samples 1 {more}"),
            2,
            "samples must be at least 2 for colours and mattes of a camera with an aperture",
        );
    }
}

/// It panicked.
#[test]
fn a_noise_without_colours_does_nothing() {
    let lab = Lab::with_square();
    let render = format!("render square.ply {ABOVE} --channels t,crypto_object --samples 40");
    let outcome = lab.ok(&format!("{render} --noise 0.01 -o a.npz"));
    let words = "warning: --noise does nothing without color among the --channels";
    assert!(outcome.stderr.contains(words), "{}", outcome.stderr);
    lab.ok(&format!("{render} -o b.npz"));
    assert!(lab.read("a.npz") == lab.read("b.npz"));
}

#[test]
fn a_noise_has_the_samples_to_act_on_or_says_so() {
    let lab = Lab::with_square();
    let render = format!("render square.ply {WIDE} --channels color,samples -o a.npz --noise");
    let outcome = lab.ok(&format!("{render} 0.9"));
    assert!(
        outcome.stderr.contains("guessed: up to 256 samples (--samples)"),
        "{}",
        outcome.stderr
    );
    let noisy = lab.ok(&format!("{render} 0.001"));
    let counts = &lab.npz("a.npz")["samples"].values;
    assert_eq!([counts[0], counts[48]], [32.0, 256.0]);
    let (pixels, mean) = (counts.len() as f64, counts.iter().sum::<f64>() / counts.len() as f64);
    let all = 100.0 * counts.iter().filter(|&&count| count == 256.0).count() as f64 / pixels;
    let told = format!("{mean:.1} samples a pixel ({all:.1} % took all 256)");
    assert!(noisy.stderr.contains(&told), "{told}: {}", noisy.stderr);
    let idle = "warning: --noise does nothing with";
    let few = lab.ok(&format!("{render} 0.9 --samples 32")).stderr;
    assert!(few.contains(&format!("{idle} 32 samples")), "{few}");
    let enough = lab.ok(&format!("{render} 0.9 --samples 33")).stderr;
    assert!(!enough.contains("warning") && !enough.contains("guessed"), "{enough}");
    lab.write("a.toml", "[shading]\nsamples = 8\n[[objects]]\nfile = \"square.ply\"\n");
    let of_file = lab.ok(&format!("{render} 0.9").replace("square.ply", "a.toml"));
    assert!(of_file.stderr.contains(&format!("{idle} 8 samples")), "{}", of_file.stderr);
}
