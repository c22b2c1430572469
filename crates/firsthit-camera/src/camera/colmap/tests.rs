//! The contents of the two files, and the errors of wrong ones.

use std::path::Path;

use super::*;
use crate::camera::View;
use crate::geometry::DVec3;

const CAMERAS: &str = "\
# Camera list
1 PINHOLE 640 480 500 510 320 240

2 FOV 64 48 50 51 32 24 0.9
7 SIMPLE_RADIAL 640 480 500 320 240 -0.1
";
const IMAGES: &str = "\
# Image list
1 1 0 0 0 0 0 5 1 front.jpg
10.5 20.5 -1 30 40 7

2 0 0 0 2 1 2 3 7 left  side/a b.jpg

3 0.5 0.5 0.5 0.5 0 0 0 2 c.jpg
";

fn text(cameras: &str, images: &str) -> Result<ColmapImages> {
    let paths = [Path::new("cameras.txt"), Path::new("images.txt")];
    ColmapImages::read([cameras.as_bytes(), images.as_bytes()], paths)
}

fn binary(cameras: &[u8], images: &[u8]) -> Result<ColmapImages> {
    let paths = [Path::new("cameras.bin"), Path::new("images.bin")];
    ColmapImages::read([cameras, images], paths)
}

/// The binary files that say what the text files do.
fn as_binary(images: &ColmapImages) -> [Vec<u8>; 2] {
    let mut of_cameras = (images.cameras.len() as u64).to_le_bytes().to_vec();
    for (number, camera) in &images.cameras {
        of_cameras.extend(number.to_le_bytes());
        of_cameras.extend(number_of(camera.model).to_le_bytes());
        let [rows, columns] = camera.size;
        of_cameras.extend((columns as u64).to_le_bytes());
        of_cameras.extend((rows as u64).to_le_bytes());
        of_cameras.extend(camera.numbers.iter().flat_map(|x| x.to_le_bytes()));
    }
    let mut of_images = (images.images.len() as u64).to_le_bytes().to_vec();
    for (k, image) in images.images.iter().enumerate() {
        of_images.extend([9; 4]);
        of_images.extend(image.pose.iter().flat_map(|x| x.to_le_bytes()));
        of_images.extend(image.camera.to_le_bytes());
        of_images.extend(image.name.as_bytes());
        of_images.push(0);
        of_images.extend((k as u64).to_le_bytes());
        of_images.extend(vec![9; 24 * k]);
    }
    [of_cameras, of_images]
}

fn number_of(model: Model) -> i32 {
    match model {
        Model::Known(model) => model.number,
        Model::Other((number, ..)) => *number,
    }
}

#[test]
fn text_and_binary_say_the_same() {
    let images = text(CAMERAS, IMAGES).unwrap();
    let names: Vec<&str> = images.names().collect();
    assert_eq!(names, ["front.jpg", "left  side/a b.jpg", "c.jpg"]);
    let [of_cameras, of_images] = as_binary(&images);
    let again = binary(&of_cameras, &of_images).unwrap();
    let cameras: Vec<Camera> = images.cameras().map(Result::unwrap).collect();
    let others: Vec<Camera> = again.cameras().map(Result::unwrap).collect();
    assert_eq!(cameras, others);
    assert_eq!(again.names().collect::<Vec<_>>(), names);
    for (name, camera) in names.iter().zip(&cameras) {
        assert_eq!(images.camera(name).unwrap().unwrap(), *camera);
    }
    assert!(images.camera("front").is_none());
    let [front, side, turned] = cameras[..] else {
        panic!("{}", cameras.len());
    };
    // (0, 0, 5) from the world to the camera, which looks along z with y down.
    assert_eq!(front.position(), DVec3::new(0.0, 0.0, -5.0));
    assert_eq!((front.aim(), front.upwards()), (DVec3::Z, DVec3::NEG_Y));
    assert_eq!((front.rows(), front.columns()), (480, 640));
    // A quaternion of length two, half a turn about z: x and y change their signs, so minus R' t is
    // (1, 2, -3).
    assert_eq!(side.position(), DVec3::new(1.0, 2.0, -3.0));
    assert_eq!((side.aim(), side.upwards()), (DVec3::Z, DVec3::Y));
    let parameters = side.lens().parameters();
    assert!(parameters.contains(&("fy", 500.0)) && parameters.contains(&("k1", -0.1)));
    // A third of a turn about (1, 1, 1): what the camera has as z is the world's y.
    assert!(turned.aim().abs_diff_eq(DVec3::Y, 1e-15));
    assert_eq!(turned.lens().projection(), Projection::Fov);
}

#[test]
fn images_without_second_lines_are_all_there() {
    let with = "1 1 0 0 0 0 0 5 1 a b 7\n1 2 3 4 5 6\n2 1 0 0 0 0 0 6 1 2.jpg\n\n3 1 0 0 0 0 0 7 1 0003\n1.5 2.5 -1\n4 1 0 0 0 0 0 8 1 d";
    let without = "1 1 0 0 0 0 0 5 1 a b 7\n2 1 0 0 0 0 0 6 1 2.jpg\n3 1 0 0 0 0 0 7 1 0003\n4 1 0 0 0 0 0 8 1 d\n";
    for images in [with, without] {
        let images = text(ONE, images).unwrap();
        let names: Vec<&str> = images.names().collect();
        assert_eq!(names, ["a b 7", "2.jpg", "0003", "d"]);
    }
}

#[test]
fn every_model_is_a_lens_that_has_its_parameters() {
    for (k, model) in ColmapModel::ALL.iter().enumerate() {
        let numbers = model.parameters.iter().map(|name| match *name {
            "f" | "fx" | "fy" => "50".to_owned(),
            "cx" | "cy" => "20".to_owned(),
            "beta" => "1.1".to_owned(),
            _ => "0.01".to_owned(),
        });
        let numbers: Vec<String> = numbers.collect();
        let cameras = format!("{k} {} 40 40 {}\n", model.name, numbers.join(" "));
        let images = text(&cameras, &format!("1 1 0 0 0 0 0 0 {k} a\n\n")).unwrap();
        let camera = images.camera("a").unwrap().unwrap();
        assert_eq!(camera.lens().projection(), model.projection, "{model:?}");
        let ray = camera.ray_within(19, 20, crate::geometry::DVec2::ZERO);
        assert!(ray.direction.abs_diff_eq(DVec3::Z, 1e-12), "{model:?}");
    }
}

const ONE: &str = "1 PINHOLE 640 480 500 510 320 240\n";

#[test]
fn what_is_wrong_in_cameras_is_told_with_its_line() {
    for (cameras, said) in [
        ("1 PINHOLE 640\n", ":1: expected CAMERA_ID MODEL WIDTH"),
        (
            "\n1 PINHOLE 640 480 1 2 3\n",
            ":2: PINHOLE must have 4 parameters (fx, fy, cx, cy), got 3",
        ),
        ("1 NO 640 480 1\n", "RADIAL_FISHEYE"),
        ("1 NO 640 480 1\n", ", EUCM, got 'NO'"),
        (
            "1 DIVISION 6 4 1 1 1\n",
            ":1: DIVISION must have 5 parameters (fx, fy, cx, cy, k), got 3",
        ),
        ("1 PINHOLE 6 4 5 nan 3 2\n", ":1: parameters must be finite"),
        ("1 PINHOLE 6 4 5 x 3 2\n", "expected a number, got 'x'"),
        ("1 PINHOLE 6 -1 5 1 3 2\n", "a whole number, got '-1'"),
        ("1 PINHOLE 6 0 5 1 3 2\n", "positive, got 6 and 0"),
        ("1 PINHOLE 99999999999999999999 1 5 1 3 2\n", "a whole number"),
        ("-1 PINHOLE 6 4 5 5 3 2\n", "a whole number, got '-1'"),
        (&ONE.repeat(2), ":2: camera 1 is there twice"),
    ] {
        let error = text(cameras, "").unwrap_err().to_string();
        assert!(error.starts_with("cameras.txt:"), "{error}");
        assert!(error.contains(said), "{error}");
    }
    let paths = [Path::new("cameras.txt"), Path::new("images.txt")];
    let error = ColmapImages::read([b"1 P\xffN", b""], paths).unwrap_err();
    assert!(error.to_string().ends_with("the file must be UTF-8 text"), "{error}");
}

#[test]
fn what_is_wrong_in_images_is_told_with_its_line() {
    for (images, said) in [
        ("1 1 0 0 0 0 0 5 1\n", ":1: expected a NAME"),
        ("1 1 0 0 0 0 0 5\n", ":1: expected IMAGE_ID"),
        ("1 0 0 0 0 0 0 5 1 a\n", ":1: a pose must be a quaternion"),
        ("1 1 0 0 0 0 inf 5 1 a\n", ":1: a pose must be"),
        ("1 1 nan 0 0 0 0 5 1 a\n", ":1: a pose must be"),
        ("1 1e200 0 0 0 0 0 5 1 a\n", ":1: a pose must be"),
        ("1 1 0 0 0 0 0 5 3 a\n", ":1: image 'a': there is no camera 3"),
        (
            "1 1 0 0 0 0 0 5 1 a\n\n2 1 0 0 0 0 0 6 1 b\n\n3 1 0 0 0 0 0 7 1 a\n",
            ":5: image 'a': the name is there twice",
        ),
    ] {
        let error = text(ONE, images).unwrap_err().to_string();
        assert!(error.starts_with("images.txt:"), "{error}");
        assert!(error.contains(said), "{error}");
    }
}

/// The error of a lens that no camera can have names the camera's line, when the camera is made.
#[test]
fn a_lens_that_is_none_is_told_of_its_line() {
    for (line, said) in [
        ("1 PINHOLE 640 480 -500 510 320 240", "cameras.txt:2: fx must be a positive"),
        ("1 FOV 64 48 50 51 32 24 4", "cameras.txt:2: omega must be a number between -pi and pi"),
        ("1 EUCM 64 48 50 51 32 24 0.5 -1", "cameras.txt:2: beta must be a positive"),
    ] {
        let cameras = format!("# one\n{line}\n");
        let images = text(&cameras, "1 1 0 0 0 0 0 5 1 a.jpg\n\n").unwrap();
        let error = images.camera("a.jpg").unwrap().unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
    let images =
        text("1 PINHOLE 640 480 5 5 3 2", "1 0.5 0.5 0.5 0.5 1.7e308 1.7e308 1.7e308 1 a\n");
    let camera = images.unwrap().camera("a").unwrap();
    // Of a turn by a third the place is finite: axes change places.
    assert!(camera.is_ok());
    let images = text("1 PINHOLE 640 480 5 5 3 2", "1 1 0.3 0.2 0.1 1.7e308 1.7e308 1.7e308 1 a\n");
    let error = images.unwrap().camera("a").unwrap().unwrap_err().to_string();
    assert!(error.contains("images.txt:1: image 'a': position must be"), "{error}");
}

#[test]
fn a_binary_file_that_is_cut_off_anywhere_is_refused() {
    let [cameras, images] = as_binary(&text(CAMERAS, IMAGES).unwrap());
    for end in 0..cameras.len() {
        let error = binary(&cameras[..end], &images).unwrap_err().to_string();
        assert!(error.starts_with("cameras.bin @ byte "), "{end}: {error}");
    }
    for end in 0..images.len() {
        let error = binary(&cameras, &images[..end]).unwrap_err().to_string();
        assert!(error.starts_with("images.bin @ byte "), "{end}: {error}");
    }
}

#[test]
fn counts_that_the_file_has_no_room_for_are_refused_at_once() {
    let [cameras, images] = as_binary(&text(CAMERAS, IMAGES).unwrap());
    for count in [u64::MAX, 1 << 61, 1 << 40, 9] {
        let count = count.to_le_bytes();
        let wrong = [&count[..], &cameras[8..]].concat();
        let error = binary(&wrong, &images).unwrap_err().to_string();
        assert!(error.contains("entries, and is too short for them"), "{error}");
        let wrong = [&count[..], &images[8..]].concat();
        let error = binary(&cameras, &wrong).unwrap_err().to_string();
        assert!(error.contains("entries, and is too short for them"), "{error}");
    }
    // The points of the first image: those of the last would be beyond the file's end.
    let at = images.iter().position(|&byte| byte == b'f').unwrap() + "front.jpg".len() + 1;
    for points in [u64::MAX, u64::MAX / 24, 1 << 50, 1000] {
        let mut wrong = images.clone();
        wrong[at..at + 8].copy_from_slice(&points.to_le_bytes());
        let error = binary(&cameras, &wrong).unwrap_err().to_string();
        assert!(error.ends_with("the file is cut off"), "{error}");
    }
    let mut wrong = cameras.clone();
    wrong[12..16].copy_from_slice(&(-1_i32).to_le_bytes());
    let error = binary(&wrong, &images).unwrap_err().to_string();
    assert!(error.ends_with(", got number -1"), "{error}");
}

/// COLMAP has models that are no lens here. Images of other cameras can be used all the same.
#[test]
fn cameras_of_other_models_are_passed_over() {
    let cameras = "\
1 SIMPLE_DIVISION 640 480 500 320 240 -0.1
2 DIVISION 640 480 500 510 320 240 -0.1
3 EQUIRECTANGULAR 640 320 640 320
4 PINHOLE 640 480 500 510 320 240
";
    let lines = (1..5).map(|k| format!("{k} 1 0 0 0 0 0 0 {k} {k}.jpg\n\n"));
    let of_text = text(cameras, &lines.collect::<String>()).unwrap();
    let [of_cameras, of_images] = as_binary(&of_text);
    let of_binary = binary(&of_cameras, &of_images).unwrap();
    for images in [of_text, of_binary] {
        for (name, model) in
            [("1.jpg", "SIMPLE_DIVISION"), ("2.jpg", "DIVISION"), ("3.jpg", "EQUIRECTANGULAR")]
        {
            let error = images.camera(name).unwrap().unwrap_err().to_string();
            assert!(error.starts_with("cameras."), "{error}");
            let said = format!(": the model {model} of image '{name}' is not supported");
            assert!(error.ends_with(&said), "{error}");
        }
        assert!(images.camera("4.jpg").unwrap().is_ok());
        assert_eq!(images.cameras().flatten().count(), 1);
    }
}

/// Bytes that are changed, cut out and put in anywhere are read or refused, in a line.
#[test]
fn files_with_changed_bytes_are_read_or_refused() {
    let [cameras, images] = as_binary(&text(CAMERAS, IMAGES).unwrap());
    let mut state = 1_u64;
    let mut random = |below: usize| {
        // Knuth's MMIX generator; its high bits are the good ones.
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % below.max(1)
    };
    let (mut read, mut refused) = (0, 0);
    for round in 0..8000 {
        let mut files = if round % 2 == 0 {
            [cameras.clone(), images.clone()]
        } else {
            [CAMERAS, IMAGES].map(|text| text.as_bytes().to_vec())
        };
        for _ in 0..=random(3) {
            let file = &mut files[random(2)];
            let at = random(file.len());
            let byte = [0, 9, 10, b' ', b'-', b'1', 127, 255][random(8)];
            match random(3) {
                0 => file[at] = byte,
                1 => file.insert(at, byte),
                _ => drop(file.remove(at)),
            }
        }
        let made = if round % 2 == 0 {
            binary(&files[0], &files[1])
        } else {
            let paths = [Path::new("cameras.txt"), Path::new("images.txt")];
            ColmapImages::read([&files[0], &files[1]], paths)
        };
        let error = match made {
            Ok(images) => {
                read += 1;
                images.cameras().find_map(Result::err)
            }
            Err(error) => Some(error),
        };
        if let Some(error) = error {
            refused += 1;
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
        }
    }
    assert!(read > 500 && refused > 500, "{read} {refused}");
}

/// Every camera that is written is read back, to the last bit, by both of the readers of files.
#[test]
fn cameras_in_colmaps_words_are_read_back() {
    let models = ColmapModel::ALL.iter();
    for model in models.filter(|model| model.parameters.contains(&"fx")) {
        let distortion = (1..).zip(model.parameters.iter().skip(4));
        let others: Vec<(&str, f64)> =
            distortion.map(|(k, name)| (*name, 0.003 * f64::from(k))).collect();
        let [fx, fy, cx, cy] = [500.0, 510.0, 321.5, 239.0];
        let matrix = PixelMatrix { fx, fy, cx, cy, skew: 0.0 };
        let lens = matrix.lens(model.projection, &others, [480, 640]).unwrap();
        for aim in [-DVec3::Z, DVec3::new(0.3, -1.0, 2.0), DVec3::new(-9.0, 1.0, 0.5)] {
            let view = View { position: DVec3::new(1.0, -2.0, 0.1), aim, lens, ..View::default() };
            let given = ColmapCamera::of(&Camera::new(view).unwrap()).unwrap();
            assert!(given.qvec[0] >= 0.0 && given.model.projection == model.projection);
            let lines = [given.camera_line(7), given.image_lines("a b.png", 3, 7)];
            let read = text(&lines[0], &lines[1]).unwrap();
            let image = &read.images[0];
            assert_eq!(image.pose.to_vec(), [&given.qvec[..], &given.tvec].concat());
            assert_eq!(read.cameras[&7].numbers, given.params);
            let again = read.camera("a b.png").unwrap().unwrap();
            let off =
                again.position().distance(view.position) + again.aim().distance(aim.normalize());
            assert!(off < 1e-14, "{off}");
        }
    }
}

#[test]
fn cameras_without_a_model_of_colmap_are_refused_with_what_they_have() {
    let matrix = PixelMatrix { fx: 9.0, fy: 9.0, cx: 3.0, cy: 3.0, skew: 0.0 };
    let others = [("xi", 0.1), ("alpha", 0.5)];
    let sphere = matrix.lens(Projection::DoubleSphere, &others, [480, 640]).unwrap();
    let parallel = Lens::named(Projection::Orthographic, &[]).unwrap();
    for (lens, expected) in [
        (parallel, "got orthographic with skew 0 and rays from the viewplane"),
        (sphere, "got double_sphere with alpha, xi"),
    ] {
        let camera = Camera::new(View { lens, ..View::default() }).unwrap();
        let error = ColmapCamera::of(&camera).unwrap_err().to_string();
        assert!(error.ends_with(expected), "{error}");
    }
}
