//! The camera's options, and what is hidden from it.

use std::collections::HashSet;

use crate::support::{ABOVE, Lab, array};

/// The z channel of the pixel in the middle of a picture of 5 x 3 pixels.
pub(crate) fn middle(lab: &Lab, channel: &str, options: &str) -> f64 {
    lab.ok(&format!("render square.ply --size 5x3 --channels {channel} -o middle.npy {options}"));
    array(&lab.read("middle.npy")).values[7]
}

#[test]
fn vectors_may_be_negative() {
    let lab = Lab::with_square();
    let z = middle(&lab, "z", "--position -1,-2,-3 --look-at -0.5,-0.5,0 --up -1,0,0");
    let expected = (0.25_f64 + 2.25 + 9.0).sqrt();
    assert!((z - expected).abs() < 1e-14, "{z} {expected}");
}

#[test]
fn the_default_camera_sees_all_of_it() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    for more in ["", "--orthographic", "--aim 1,2,-3", "--look-at auto", "--size 24x64", "--fov 5"]
    {
        lab.ok(&format!("render part.stl --size 64x48 --channels object -o o.npy {more}").replace(
            "--size 64x48 --channels object -o o.npy --size",
            "--channels object -o o.npy --size",
        ));
        let object = array(&lab.read("o.npy"));
        let (rows, columns) = (object.shape[0], object.shape[1]);
        let mut hits = 0;
        for row in 0..rows {
            for column in 0..columns {
                let at_the_edge = row % (rows - 1) == 0 || column % (columns - 1) == 0;
                let value = object.values[usize::try_from(row * columns + column).unwrap()];
                assert!(value == -1.0 || !at_the_edge, "{more}");
                hits += u64::from(value == 0.0);
            }
        }
        assert!(8 * hits > rows * columns, "{more}: {hits}");
    }
}

#[test]
fn look_at_auto_looks_at_the_middle() {
    let lab = Lab::with_square();
    let expected = (9.0_f64 + 16.0 + 144.0).sqrt();
    for target in ["", "--look-at auto", "--look-at 0,0,0", "--aim -3,-4,-12"] {
        let range = middle(&lab, "range", &format!("--position 3,4,12 {target}"));
        assert!((range - expected).abs() < 1e-13, "{target}: {range}");
    }
}

#[test]
fn the_field_of_view_is_vertical() {
    let lab = Lab::with_square();
    // At distance 1 the square's edges are 45 degrees up and down: rows 1 and 2 of 4 see it at 100
    // degrees.
    let hits = |fov: f64| {
        lab.ok(&format!(
            "render square.ply --position 0,0,1 --aim 0,0,-1 --up 0,1,0 --fov {fov} --size 1x1001 \
             --channels object -o o.npy"
        ));
        let object = array(&lab.read("o.npy"));
        object.values.iter().filter(|&&object| object == 0.0).count()
    };
    assert_eq!(hits(90.0), 1001);
    // tan 60 is 1.732: the square has 1001 / 1.732 rows.
    assert_eq!(hits(120.0), 577);
}

#[test]
fn rays_start_on_the_viewplane_only_where_there_is_one() {
    let lab = Lab::with_square();
    let place = "--position 0,0,5 --aim 0,0,-1 --up 0,1,0";
    let t = |more: &str| middle(&lab, "t", &format!("{place} {more}"));
    assert_eq!(t(""), 5.0);
    assert_eq!(t("--focal-length 2 --viewplane 4x3"), 3.0);
    assert_eq!(t("--focal-length 2 --viewplane 4x3 --ray-start eye"), 5.0);
    assert_eq!(t("--focal-length 2 --viewplane 4x3 --ray-start viewplane"), 3.0);
    assert_eq!(t("--orthographic --focal-length 2 --viewplane 4x3"), 3.0);
    assert_eq!(t("--orthographic --focal-length 2 --viewplane 4x3 --ray-start eye"), 5.0);
    assert_eq!(t("--orthographic --viewplane 4x3"), 5.0);
}

#[test]
fn parallel_rays_have_one_direction() {
    let lab = Lab::with_square();
    lab.ok(&format!(
        "render square.ply {ABOVE} --orthographic --channels t,range,z,object -o a.npz"
    ));
    let all = lab.npz("a.npz");
    // 33 columns over 4 units: 17 of them on the square; 25 rows over 3 units: 17.
    let hits = all["object"].values.iter().filter(|&&o| o == 0.0).count();
    assert_eq!(hits, 17 * 17);
    let finite = all["t"].values.iter().filter(|t| t.is_finite());
    assert!(finite.copied().all(|t| (t - 3.0).abs() < 1e-14));
    assert_eq!(all["range"], all["z"]);
}

#[test]
fn straight_from_above_y_is_up_unless_said_otherwise() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    let picture = |options: &str| {
        lab.ok(&format!("render part.stl --size 16x12 {options} --channels primitive -o p.npy"));
        lab.read("p.npy")
    };
    let given = picture("--position 0,0,10 --up 0,1,0 --look-at 0,0,0");
    assert_eq!(picture("--position 0,0,10 --look-at 0,0,0"), given);
    assert_eq!(picture("--aim 0,0,-1"), picture("--aim 0,0,-1 --up 0,1,0"));
}

#[test]
fn the_height_follows_the_viewplane() {
    let lab = Lab::with_square();
    lab.ok("render square.ply --position 0,0,5 --aim 0,0,-1 --focal-length 4 --viewplane 32x1 --ray-start eye");
    let (width, height, _) = lab.png("square.png");
    assert_eq!((width, height), (1024, 32));
}

/// Options that make no camera, and words of the message.
const IMPOSSIBLE: &[(&str, &str)] = &[
    ("--aim 0,0,0", "aim must be"),
    ("--position 0,0,5 --aim 0,0,0", "aim must be"),
    ("--up 0,0,0", "up must be"),
    ("--position 0,0,5 --aim 0,0,-1 --up 0,0,3", "up must be in another direction than aim"),
    (
        "--position 1,2,3 --look-at 1,2,3",
        "--look-at must be another point than --position, got 1,2,3",
    ),
    ("--look-at 1,2,3", "--look-at 1,2,3 needs --position"),
    ("--position 1,2", "'--position <X,Y,Z>': expected three finite numbers"),
    ("--position 1,2,inf", "--position"),
    ("--aim 1,0,0 --look-at 0,0,0", "'--aim <X,Y,Z>' cannot be used with '--look-at"),
    ("--fov 45 --orthographic", "'--fov <DEGREES>' cannot be used with '--orthographic'"),
    ("--fov 45 --viewplane 3x2", "cannot be used with"),
    ("--fov 45 --focal-length 3 --viewplane 3x2", "cannot be used with"),
    ("--fov 180", "degrees between 0 and 180"),
    ("--fov-axis across", "possible values: vertical, horizontal, diagonal"),
    ("--fov-axis diagonal --viewplane 3x2", "cannot be used with"),
    (
        "--fov-axis diagonal --projection equidistant",
        "--fov-axis must be left out of a camera that is not perspective",
    ),
    ("--projection equirectangular --fov 90 --parameters vertical_fov=60", "cannot be used with"),
    ("--convention ros", "--intrinsics <FX,FY,CX,CY[,SKEW]>"),
    ("--focal-length 3", "--viewplane <WIDTHxHEIGHT>"),
    ("--focal-length 0 --viewplane 3x2", "expected a positive number"),
    ("--focal-length -1 --viewplane 3x2", "expected a positive number"),
    ("--viewplane 3x2", "--viewplane needs --focal-length"),
    ("--viewplane 3x-2 --focal-length 1", "both positive"),
    ("--ray-start nose", "[possible values: viewplane, eye]"),
    ("--size 0x10", "at least 1 of each"),
    ("--size 10", "such as 720x480"),
];

#[test]
fn impossible_cameras_are_refused_by_their_parameter() {
    let lab = Lab::with_square();
    for (options, words) in IMPOSSIBLE {
        lab.fails(&format!("render square.ply {options}"), 2, words);
    }
}

#[test]
fn a_camera_that_looks_away_says_so() {
    let lab = Lab::with_square();
    let outcome =
        lab.ok("render square.ply --size 32x24 --position 0,0,5 --aim 0,0,1 --up 0,1,0 --quiet");
    let expected = "firsthit: warning: nothing was hit: the camera looks away from the scene: \
        bounds -1,-1,0 to 1,1,0, try --look-at auto\n";
    assert_eq!(outcome.stderr, expected);
    let past = lab.ok("render square.ply --size 32x24 --position 0,0,5 --aim 1,0,-0.1 --quiet");
    assert!(past.stderr.contains("the camera looks past the scene"), "{}", past.stderr);
}

#[test]
fn what_is_before_the_viewplane_is_not_seen_and_that_is_said() {
    let lab = Lab::with_square();
    let near = "render square.ply --size 32x24 --position 0,0,5 --aim 0,0,-1 --up 0,1,0 \
        --focal-length 7 --viewplane 4x3 --channels object -o o.npy";
    let outcome = lab.ok(near);
    assert!(outcome.stderr.contains("between the eye and the viewplane"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("use --ray-start eye"), "{}", outcome.stderr);
    assert!(array(&lab.read("o.npy")).values.iter().all(|&object| object == -1.0));
    let outcome = lab.ok(&format!("{near} --ray-start eye"));
    assert!(!outcome.stderr.contains("warning"), "{}", outcome.stderr);
    assert!(array(&lab.read("o.npy")).values.contains(&0.0));
}

#[test]
fn a_panorama_sees_all_around_from_the_middle() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    lab.ok("render part.stl --projection equirectangular --channels range,face -o all.npz -q");
    let all = lab.npz("all.npz");
    let range = &all["range"];
    assert_eq!(&*range.shape, &[512, 1024]);
    // From the middle of a box of 2.28 x 3.06 x 1.46 to its faces, and to its corners.
    let corner = (1.14_f64 * 1.14 + 1.53 * 1.53 + 0.73 * 0.73).sqrt();
    let [nearest, farthest] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|choose| range.values.iter().copied().reduce(choose).unwrap());
    assert!((0.73..0.7301).contains(&nearest), "{nearest}");
    assert!((0.995 * corner..corner).contains(&farthest), "{farthest} {corner}");
    // From inside nothing is in the light from outside, so that shadows would hide everything.
    let outcome = lab.ok("render part.stl --projection equirectangular --samples 1 -o seen.npz");
    assert!(outcome.stderr.contains("no shadows"), "{}", outcome.stderr);
    let color = &lab.npz("seen.npz")["color"];
    let different: HashSet<u64> = color.values.iter().map(|value| value.to_bits()).collect();
    assert!(different.len() >= 3, "{}", different.len());
    // The same place said in words, which is no direction to look in.
    let middle = lab.ok("info part.stl --json");
    let middle: serde_json::Value = serde_json::from_slice(&middle.stdout).unwrap();
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let [low, high] = [0, 1].map(|end| middle["bounds"][end][axis].as_f64().unwrap());
        low.midpoint(high)
    });
    lab.ok(&format!(
        "render part.stl --projection equirectangular --position {x},{y},{z} --channels range,face -o there.npz -q"
    ));
    assert!(lab.npz("there.npz")["range"].values == range.values);
    // The scene file's words are the same.
    let toml = "[camera]\nprojection = \"equirectangular\"\n[[objects]]\nfile = \"part.stl\"\n";
    lab.write("around.toml", toml.as_bytes());
    lab.ok("render around.toml --channels range,face -o file.npz -q");
    assert!(lab.npz("file.npz")["range"].values == range.values);
}

#[test]
fn a_panorama_has_no_viewplane() {
    let lab = Lab::with_square();
    let render = "render square.ply -o x.png --projection equirectangular";
    lab.fails(
        &format!("{render} --viewplane 1x1 --focal-length 1"),
        2,
        "--viewplane is for perspective and orthographic cameras",
    );
    lab.fails(&format!("{render} --ray-start viewplane"), 2, "rays start at the eye");
    lab.fails(
        "render square.ply -o x.png --projection fisheye",
        2,
        "[possible values: perspective, orthographic, equirectangular, cylindrical",
    );
}

#[test]
fn an_aperture_blurs_colours_and_nothing_else() {
    let lab = Lab::with_square();
    let made = |name: &str, options: &str| {
        let size = if options.contains("--camera") { "" } else { "--size 24x18" };
        lab.ok(&format!(
            "render square.ply {size} --channels color,z --samples 16 -o {name} {options}"
        ));
        let channels = lab.npz(name);
        ["color", "z"].map(|name| channels[name].values.clone())
    };
    let at = "--position 0.5,0.5,4 --look-at 0.5,0.5,0 --up 0,1,0";
    let [sharp, z] = made("sharp.npz", at);
    let [blurred, z_of_lens] = made("a.npz", &format!("{at} --aperture 1 --focus 2"));
    assert_ne!(sharp, blurred);
    assert_eq!(z, z_of_lens);
    // A point two units ahead is the same as the distance.
    let [same, _] = made("b.npz", &format!("{at} --aperture 1 --focus 0.7,0.1,2"));
    assert_eq!(blurred, same);
    let [again, _] = made("again.npz", "--camera a.npz");
    assert_eq!(again, blurred);
    let [pinhole, _] = made("pinhole.npz", "--camera a.npz --aperture 0");
    assert_eq!(pinhole, sharp);
}

#[test]
fn a_distorted_camera_has_an_aperture_on_the_command_line_and_in_scene_files() {
    let lab = Lab::with_square();
    lab.write("pose.txt", "1 0 0 0 0 1 0 0 0 0 1 5");
    let render = "--channels color,z --samples 16 -q";
    let given =
        "--intrinsics 20,20,12,9 --pose pose.txt --convention gltf --size 24x18 --projection";
    for (projection, parameters, keys) in
        [("opencv", "k1=-0.1", "k1 = -0.1"), ("fov", "omega=0.8", "omega = 0.8")]
    {
        let given = format!("{given} {projection} --parameters {parameters}");
        lab.ok(&format!("render square.ply {render} -o sharp.npz {given}"));
        let lens = "--aperture 1 --focus 2";
        lab.ok(&format!("render square.ply {render} -o a.npz {given} {lens}"));
        lab.ok(&format!("render square.ply {render} -o b.npz --camera a.npz"));
        lab.write(
            "scene.toml",
            format!(
                "[camera]\nprojection = \"{projection}\"\n{keys}\naperture = 1\nfocus = 2\ncolumns = 24\nrows = 18\n\
                 fx = 20\nfy = 20\ncx = 12\ncy = 9\nconvention = \"gltf\"\n\
                 pose = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5]]\n[[objects]]\nfile = \"square.ply\"\n"
            ),
        );
        lab.ok(&format!("render scene.toml {render} -o c.npz --channels z"));
        let [sharp, first, again, scene] =
            ["sharp.npz", "a.npz", "b.npz", "c.npz"].map(|name| lab.npz(name));
        assert_ne!(sharp["color"].values, first["color"].values, "{projection}");
        assert_eq!(sharp["z"].values, first["z"].values);
        assert_eq!(first["color"].values, again["color"].values);
        assert_eq!(first["z"].values, scene["z"].values);
        let said = lab.ok("info scene.toml").stdout;
        let said = String::from_utf8_lossy(&said).into_owned();
        assert!(said.contains("aperture 1 focus 2"), "{said}");
    }
    lab.write(
        "scene.toml",
        "[camera]\nprojection = \"opencv\"\ntau_x = 0.1\naperture = 1\nfocus = 2\ncolumns = 24\nrows = 18\nfx = 20\n\
         fy = 20\ncx = 12\ncy = 9\nconvention = \"gltf\"\n[[objects]]\nfile = \"square.ply\"\n",
    );
    lab.fails("render scene.toml -o d.png", 3, "tau_x");
    lab.fails(
        "render square.ply -o d.png --intrinsics 20,20,12,9 --convention ros --size 24x18 --projection opencv_fisheye --aperture 1 --focus 2",
        2,
        "only perspective cameras, opencv and fov have a thin lens, got opencv_fisheye",
    );
}

#[test]
fn half_a_lens_is_refused() {
    let lab = Lab::with_square();
    for (options, error) in [
        ("--aperture 0.5", "--aperture 0.5 needs --focus, a distance or a point"),
        ("--focus 0.5", "--focus needs --aperture, the lens' diameter"),
        (
            "--aperture 0.5 --focus 3 --samples 1",
            "samples must be at least 2 for colours and mattes of a camera with an aperture, got 1",
        ),
        (
            "--aperture 0.5 --focus 3 --orthographic",
            "aperture must be zero for parallel rays, which come through no lens, got 0.5",
        ),
        (
            "--aperture 0.5 --focus 3 --projection equidistant",
            "aperture must be left out: only perspective cameras, opencv and fov have a thin lens, got equidistant",
        ),
        ("--aperture 0.5 --focus 0", "expected a positive distance, or a point such as 1,2,3"),
        ("--aperture -1 --focus 2", "expected zero or a positive number"),
    ] {
        let outcome = lab.run(&format!("render square.ply --size 8x6 -o a.png {options}"));
        assert_ne!(outcome.code, 0, "{options}");
        assert!(outcome.stderr.contains(error), "{options}: {}", outcome.stderr);
    }
    let idle =
        lab.run("render square.ply --size 8x6 -o z.npy --channels z --aperture 0.5 --focus 3");
    let expected = "--aperture does nothing without color among the --channels";
    assert!(idle.stderr.contains(expected), "{}", idle.stderr);
}
