//! Cameras from files: matrices, poses, COLMAP, outputs and scene files.

use crate::camera::middle;
use crate::support::Lab;

/// A camera 5 above the square, looking down with x to the right and y down, as OpenCV writes it.
const ABOVE_IN_OPENCV: &str = "1 0 0 0\n0 -1 0 0\n0, 0, -1, 5\n";

#[test]
fn an_intrinsic_matrix_and_a_pose_make_the_camera() {
    let lab = Lab::with_square();
    lab.write("pose.txt", ABOVE_IN_OPENCV);
    // The principal point is the centre of the middle pixel.
    let given = "--intrinsics 4,4,2,1 --pose pose.txt --convention opencv";
    assert_eq!(middle(&lab, "z", given), 5.0);
    assert_eq!(middle(&lab, "range", given), 5.0);
    // With COLMAP's pixel coordinates it is half a pixel off.
    let range = middle(&lab, "range", &given.replace("opencv", "colmap"));
    let expected = 5.0 * (1.0_f64 + 2.0 * 0.125 * 0.125).sqrt();
    assert!((range - expected).abs() < 1e-14, "{range}");
    // The inverse pose, as ROS has it.
    lab.write("pose.txt", "[[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 5], [0, 0, 0, 1]]");
    assert_eq!(middle(&lab, "z", &given.replace("opencv", "ros")), 5.0);
    // A lens with distortion.
    let distorted = "--intrinsics 4,4,2.5,1.5 --pose pose.txt --convention gltf --projection opencv --parameters k1=-0.1";
    lab.write("pose.txt", "1 0 0 0 0 1 0 0 0 0 1 5");
    assert_eq!(middle(&lab, "z", distorted), 5.0);
}

#[test]
fn what_makes_no_camera_is_told() {
    let lab = Lab::with_square();
    lab.write("pose.txt", ABOVE_IN_OPENCV);
    let render = "render square.ply -o x.png --size 5x3";
    for (options, words) in [
        ("--intrinsics 4,4,2,1", "--convention"),
        ("--intrinsics 4,4,2 --convention ros", "fx,fy,cx,cy"),
        ("--pose pose.txt --convention ros --aim 1,0,0", "cannot be used with"),
        ("--projection opencv", "intrinsics must be given with a calibrated lens"),
        (
            "--projection eucm --intrinsics 4,4,2,1 --convention ros --parameters k1=1",
            "there are fx, fy, cx, cy, skew, alpha, beta",
        ),
        ("--projection equidistant --fov 361", "up to 360"),
        ("--projection cube_map --size 5x3", "6 faces wide"),
    ] {
        let arguments = format!("{render} {options}")
            .replace("--size 5x3 --projection cube_map", "--projection cube_map");
        lab.fails(&arguments, 2, words);
    }
    lab.write("pose.txt", "1 2 3");
    let pose = format!("{render} --pose pose.txt --convention ros");
    lab.fails(&pose, 3, "expected the 12 or 16 numbers");
    lab.write("pose.txt", "2 0 0 0 0 2 0 0 0 0 2 0");
    lab.fails(&pose, 3, "without a scale or a mirror");
}

#[test]
fn a_pose_of_three_decimals_is_taken_with_a_warning() {
    let lab = Lab::with_square();
    let render =
        "render square.ply -o x.npy --channels z --size 5x3 --pose pose.txt --convention ros";
    lab.write("pose.txt", "0.867 0.5 0 1\n-0.5 0.867 0 2\n0 0 1 3\n");
    let outcome = lab.ok(render);
    let expected =
        "pose.txt: the rotation is rounded, and the nearest one is taken: numbers change by up to";
    assert!(outcome.stderr.contains(expected), "{}", outcome.stderr);
    lab.write("pose.txt", "0.866 0.5 0 1\n-0.5 0.866 0 2\n0 0 1 3\n");
    assert!(!lab.ok(render).stderr.contains("rounded"));
    lab.write("pose.txt", "0.87 0.5 0 1\n-0.5 0.87 0 2\n0 0 1 3\n");
    let far = "up to 3.0e-3 off the nearest rotation, and what is rounded by up to 1e-3 is mended";
    lab.fails(render, 3, far);
}

/// Two images of the camera of `an_intrinsic_matrix_and_a_pose_make_the_camera`: from above and
/// from nearer.
const CAMERAS_OF_COLMAP: &str = "1 PINHOLE 5 3 4 4 2.5 1.5\n2 FOV 5 3 4 4 2.5 1.5 0.9\n";
const IMAGES_OF_COLMAP: &str =
    "1 0 1 0 0 0 0 5 1 from above.png\n\n2 0 1 0 0 0 0 3 2 near/by.png\n1 2 -1\n";

/// A folder with those cameras and images.
fn reconstruction(lab: &Lab, folder: &str, images: &str) {
    std::fs::create_dir(lab.path(folder)).unwrap();
    lab.write(&format!("{folder}/cameras.txt"), CAMERAS_OF_COLMAP);
    lab.write(&format!("{folder}/images.txt"), images);
}

#[test]
fn an_image_of_a_colmap_reconstruction_is_a_camera() {
    let lab = Lab::with_square();
    reconstruction(&lab, "sparse", IMAGES_OF_COLMAP);
    let of = |name: &str, options: &str| {
        let render = "render square.ply --channels z,range -o z.npz -q --colmap sparse";
        let mut command = lab.command(&format!("{render} {options}"));
        let ran = command.arg("--image").arg(name).output().unwrap();
        let ran = crate::support::Outcome::of(ran);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        lab.npz("z.npz")
    };
    let above = of("from above.png", "");
    assert_eq!(above["z"].shape, [3, 5]);
    assert_eq!(above["z"].values[7], 5.0);
    assert_eq!(of("near/by.png", "")["z"].values[7], 3.0);
    // The same camera by its numbers.
    lab.write("pose.txt", ABOVE_IN_OPENCV);
    lab.ok("render square.ply --channels z,range -o same.npz -q --size 5x3 --intrinsics 4,4,2.5,1.5 --pose pose.txt --convention colmap");
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let same = lab.npz("same.npz");
    assert_eq!(bits(&above["range"].values), bits(&same["range"].values));
    // Its picture in another size, and options that override it.
    assert_eq!(of("from above.png", "--size 10x6")["z"].shape, [6, 10]);
    assert_eq!(of("from above.png", "--position 0,0,7")["z"].values[7], 7.0);
    let probed = lab.ok("probe square.ply --pixel 1,2 --colmap sparse --image near/by.png --json");
    let probed = String::from_utf8_lossy(&probed.stdout).into_owned();
    assert!(probed.contains("\"z\": 3") || probed.contains("\"z\":3"), "{probed}");
}

#[test]
fn what_is_no_image_of_a_reconstruction_is_told() {
    let lab = Lab::with_square();
    reconstruction(&lab, "sparse", IMAGES_OF_COLMAP);
    let render = "render square.ply -o x.png";
    for (options, code, words) in [
        (
            "--colmap sparse --image by.png",
            2,
            "--image 'by.png': sparse/images.txt has from above.png, near/by.png",
        ),
        (
            "--colmap sparse",
            2,
            "--colmap needs --image: sparse/images.txt has from above.png, near/by.png",
        ),
        ("--image by.png", 2, "--colmap"),
        ("--colmap sparse --camera 0", 2, "cannot be used with"),
        ("--colmap nowhere --image a", 3, "nowhere"),
        ("--colmap square.ply --image a", 3, "expected the folder"),
        (
            "--colmap . --image a",
            3,
            "expected cameras.bin and images.bin, or cameras.txt and images.txt",
        ),
    ] {
        lab.fails(&format!("{render} {options}"), code, words);
    }
    // Binary files come first, and half of a pair is none.
    lab.write("sparse/cameras.bin", [1]);
    lab.ok(&format!("{render} -q --colmap sparse --image near/by.png"));
    lab.write("sparse/images.bin", [1]);
    lab.fails(
        &format!("{render} --colmap sparse --image near/by.png"),
        3,
        "sparse/cameras.bin @ byte 0: the file is cut off",
    );
    for (folder, images, words) in [
        (
            "twice",
            "1 0 1 0 0 0 0 5 1 a\n\n2 0 1 0 0 0 0 3 1 a\n",
            "twice/images.txt:3: image 'a': the name is there twice",
        ),
        ("nan", "1 0 1 0 0 nan 0 5 1 a\n", "nan/images.txt:1: a pose must be"),
        ("none", "1 0 1 0 0 0 0 5 9 a\n", "none/images.txt:1: image 'a': there is no camera 9"),
        ("empty", "", "--image 'a': empty/images.txt has no images"),
    ] {
        reconstruction(&lab, folder, images);
        let code = if folder == "empty" { 2 } else { 3 };
        lab.fails(&format!("{render} --colmap {folder} --image a"), code, words);
    }
}

#[cfg(unix)]
#[test]
fn no_file_outside_a_reconstructions_folder_is_opened() {
    let lab = Lab::with_square();
    reconstruction(&lab, "elsewhere", IMAGES_OF_COLMAP);
    reconstruction(&lab, "sparse", IMAGES_OF_COLMAP);
    let link = lab.path("sparse/cameras.txt");
    std::fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink("../elsewhere/cameras.txt", link).unwrap();
    lab.fails(
        "render square.ply -o x.png --colmap sparse --image near/by.png",
        3,
        "sparse/cameras.txt: refused: it leads outside the reconstruction's folder",
    );
}

#[test]
fn an_output_is_a_camera() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    let first =
        "render part.stl --projection equidistant --fov 100 --size 40x30 --channels range,valid";
    lab.ok(&format!("{first} -o first.npz -q"));
    lab.ok("render part.stl --camera first.npz --channels range,valid -o second.npz -q");
    let (first, second) = (lab.npz("first.npz"), lab.npz("second.npz"));
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&first["range"].values), bits(&second["range"].values));
    let seen = first["valid"].values.iter().filter(|&&x| x == 1.0).count();
    assert!(seen > 400 && seen < 1200, "{seen}");
    // Half the size: a matrix of half the numbers.
    lab.ok("render part.stl --camera first.npz --size 20x15 --channels range -o third.npz -q");
    assert_eq!(lab.npz("third.npz")["range"].shape, [15, 20]);
    lab.write("none.npy", crate::support::npy("<f8", false, "(2, 2)", &[0; 32]));
    lab.fails("render part.stl --camera none.npy -o x.png", 3, "does not say which camera");
}

#[test]
fn a_scene_file_has_calibrated_cameras() {
    let lab = Lab::with_square();
    lab.write("pose.txt", "1 0 0 0 0 1 0 0 0 0 1 5");
    for (options, keys) in [
        ("--intrinsics 4,4,2,1 --convention ros --pose pose.txt", ""),
        (
            "--intrinsics 4,4,2,1 --convention ros --pose pose.txt --projection opencv --parameters k1=-0.1,p1=0.01",
            "projection = \"opencv\"\nk1 = -0.1\np1 = 0.01\n",
        ),
        (
            "--intrinsics 4,4,2,1 --convention ros --pose pose.txt --projection mei --parameters xi=1.1",
            "projection = \"mei\"\nxi = 1.1\n",
        ),
    ] {
        let toml = format!(
            "[camera]\n{keys}columns = 5\nrows = 3\nfx = 4\nfy = 4\ncx = 2\ncy = 1\nconvention = \"ros\"\n\
             pose = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5]]\n[[objects]]\nfile = \"square.ply\"\n"
        );
        lab.write("scene.toml", &toml);
        lab.ok("render scene.toml --channels range -o file.npz -q");
        lab.ok(&format!("render square.ply --size 5x3 --channels range -o words.npz -q {options}"));
        let (file, words) = (lab.npz("file.npz"), lab.npz("words.npz"));
        assert_eq!(file["range"].values, words["range"].values, "{options}");
        // It stands in a built scene too.
        lab.ok("build scene.toml -o built.fhs -q");
        lab.ok("render built.fhs --channels range -o built.npz -q");
        assert_eq!(file["range"].values, lab.npz("built.npz")["range"].values, "{options}");
    }
}
