//! Scene files: what they say is what is there, and what is wrong in them is told with its place.

mod mistakes;

use std::fs;
use std::path::Path;
use std::sync::Arc;

use firsthit::camera::Projection;
use firsthit::load::{LoadSettings, Loaded, load};
use firsthit::scene::{DirectionalLight, PointLight};
use firsthit::{
    Background, Color, DQuat, DVec3, DisplayTransform, Error, Light, RayStart, Result, Scene,
    Shader, ToneMap, shoot,
};

/// Loads a scene file among other files.
fn read(text: &str, files: &[(&str, &str)]) -> Result<Loaded> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, content) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("room for a folder");
        fs::write(path, content).expect("room for a small file");
    }
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).expect("room for a small file");
    load(&path, &LoadSettings::default())
}

fn model(text: &str) -> Loaded {
    read(text, &[]).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The error about a text, from the file's name on.
fn refusal(text: &str) -> String {
    let error = read(text, &[]).err().unwrap_or_else(|| panic!("accepted: {text:.200}"));
    assert!(matches!(error, Error::Parse { .. }), "{error:?}");
    let said = error.to_string();
    assert!(!said.contains('\n'), "{said}");
    let start = said.find("scene.toml").expect("the file's name");
    said[start..].to_owned()
}

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n\
    o a\nf 1 3 2\nf 1 2 4\no b\nf 2 3 4\nf 1 4 3\n";

#[test]
fn every_shape_is_met_where_its_keys_put_it() {
    // Each is 1 high above (0, 0), and 2 with the translation.
    for shape in [
        "shape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1",
        "shape = 'plane'\npoint = [0, 0, 1]\nnormal = [0, 0, 3]",
        "shape = 'disc'\ncenter = [0, 0, 1]\nnormal = [0, 0, 1]\nradius = 0.5",
        "shape = 'box'\nlow = [-1, -1, -1]\nhigh = [1, 1, 1]",
        "shape = 'cylinder'\nbottom = [0, 0, -1]\ntop = [0, 0, 1]\nradius = 0.5",
        "shape = 'cone'\nbottom = [0, 0, -1]\ntop = [0, 0, 1]\nbottom_radius = 1\ntop_radius = 0.25",
        "shape = 'mesh'\nvertices = [[-1, -1, 1], [1, -1, 1], [0, 1, 1]]\ntriangles = [[0, 1, 2]]",
    ] {
        for (placed, height) in [("", 1.0), ("\ntranslate = [0, 0, 1]", 2.0), ("\nscale = 2", 2.0)]
        {
            let objects = model(&format!("[[objects]]\n{shape}{placed}\n")).world.objects;
            let scene = Scene::new(objects).expect("one object");
            let hit = shoot(&scene, DVec3::new(0.0, 0.0, 10.0), DVec3::NEG_Z);
            assert_eq!((hit.object, hit.t), (0, 10.0 - height), "{shape}{placed}");
        }
    }
}

#[test]
fn objects_are_scaled_then_rotated_then_translated() {
    let placed = |keys: &str| {
        let text = format!("[[objects]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\n{keys}");
        let map = *model(&text).world.objects[0].transform().world_from_object();
        map.transform_point3(DVec3::new(1.0, 2.0, 3.0))
    };
    assert_eq!(placed(""), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(placed("scale = [2, 1, -1]"), DVec3::new(2.0, 2.0, -3.0));
    // (1, 2, 3) -> (10, 2, 3) -> (-2, 10, 3) -> (-1, 10, 3).
    let all =
        "scale = [10, 1, 1]\nrotate = { axis = [0, 0, 7], degrees = 90 }\ntranslate = [1, 0, 0]";
    assert_eq!(placed(all), DVec3::new(-1.0, 10.0, 3.0));
    // Around x first: (1, -3, 2); then around z.
    let two = "rotate = [{ axis = [1, 0, 0], degrees = 90 }, { axis = [0, 0, 1], degrees = 90 }]";
    assert_eq!(placed(two), DVec3::new(3.0, 1.0, 2.0));
    let quaternion = placed("rotate = { quaternion = [2e200, 0, 0, 2e200] }");
    assert!((quaternion - DVec3::new(1.0, -3.0, 2.0)).length() < 1e-14);
    let theirs = DQuat::from_xyzw(0.1, -0.2, 0.3, 0.9).normalize() * DVec3::new(1.0, 2.0, 3.0);
    let ours = placed("rotate.quaternion = [0.1, -0.2, 0.3, 0.9]");
    assert!((ours - theirs).length() < 1e-14);
    let rows = "matrix = [[0, 0, 1, 5], [1, 0, 0, 6], [0, 1, 0, 7]]";
    assert_eq!(placed(rows), DVec3::new(8.0, 7.0, 9.0));
    let four = "matrix = [[0, 0, 1, 5], [1, 0, 0, 6], [0, 1, 0, 7], [0, 0, 0, 1]]";
    assert_eq!(placed(four), placed(rows));
}

#[test]
fn numbers_keep_every_digit() {
    let text = "[[objects]]\nshape = 'plane'\npoint = [0, 0, 0.1234567890123456789]\n\
        normal = [0, 0, 1]\n[[lights]]\nkind = 'point'\nposition = [0x10, 1_000.5, -9007199254740993]\n";
    let model = model(text);
    let scene = Scene::new(model.world.objects).expect("one object");
    let hit = shoot(&scene, DVec3::new(0.0, 0.0, 1.0), DVec3::NEG_Z);
    assert_eq!(hit.t, 1.0 - 0.123_456_789_012_345_68);
    let white = Color::ONE;
    let place = DVec3::new(16.0, 1000.5, -9_007_199_254_740_992.0);
    assert_eq!(model.world.lights, [Light::from(PointLight { position: place, intensity: white })]);
}

#[test]
fn cameras_are_what_their_words_say() {
    let text = "[camera]\nposition = [1, 2, 3]\naim = [0, 0, -2]\nup = [0, 1, 0]\nfocal_length = 35\n\
        width = 36\nheight = 24\ncolumns = 720\nrows = 100\nray_start = 'viewplane'\n\
        [cameras.side]\nposition = [5, 0, 1]\nlook_at = [0, 0, 1]\nfov = 60\n\
        [cameras.flat]\nprojection = 'orthographic'\nposition = [0, 0, 9]\naim = [0, 0, -1]\nup = [0, 1, 0]\n\
        width = 4\nheight = 2\n";
    let model = model(text);
    let names: Vec<&str> = model.world.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["camera", "side", "flat"]);
    assert!(model.world.has_view);
    let view = model.world.cameras[0].view;
    assert_eq!(
        (view.position, view.aim, view.up),
        (DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Z, DVec3::Y)
    );
    assert_eq!(
        (
            view.lens.viewplane().unwrap().focal_length,
            view.lens.viewplane().unwrap().width,
            view.lens.viewplane().unwrap().height
        ),
        (35.0, 36.0, 24.0)
    );
    assert_eq!(
        (view.columns, view.rows, view.lens.viewplane().unwrap().ray_start),
        (720, 100, RayStart::Viewplane)
    );
    let side = &model.world.cameras[1];
    assert_eq!((side.view.aim, side.view.up, side.has_size), (DVec3::NEG_X, DVec3::Z, false));
    assert!((side.view.lens.viewplane().unwrap().height - 2.0 / 3.0_f64.sqrt()).abs() < 1e-15);
    // The specification: cameras of a scene file start their rays at the eye.
    assert_eq!(side.view.lens.viewplane().unwrap().ray_start, RayStart::Eye);
    let flat = model.world.cameras[2].view;
    let viewplane = flat.lens.viewplane().unwrap();
    assert_eq!(
        (flat.lens.projection(), viewplane.width, viewplane.height),
        (Projection::Orthographic, 4.0, 2.0)
    );
    assert_eq!((flat.columns, flat.rows), (1024, 512));
}

#[test]
fn cameras_have_a_thin_lens_in_focus_at_a_distance_or_a_point() {
    let at = "position = [1, 2, 3]\naim = [0, 0, -2]\nup = [0, 1, 0]\naperture = 0.25\n";
    let matrix =
        "fx = 50\nfy = 50\ncx = 20\ncy = 20\ncolumns = 40\nrows = 40\nconvention = 'opencv'\n";
    let text = format!(
        "[camera]\n{at}focus = 4\n[cameras.point]\n{at}focus = [9, 9, -2]\n[cameras.matrix]\n{at}{matrix}focus = 6\n"
    );
    let lenses = model(&text).world.cameras.into_iter().map(|camera| {
        let viewplane = *camera.view.lens.viewplane().unwrap();
        (viewplane.aperture, viewplane.focus)
    });
    assert_eq!(lenses.collect::<Vec<_>>(), [(0.25, 4.0), (0.25, 5.0), (0.25, 6.0)]);
}

#[test]
fn what_a_camera_leaves_open_the_objects_decide() {
    let ball = "[[objects]]\nshape = 'sphere'\ncenter = [10, 0, 0]\nradius = 2\n";
    let model = model(&format!("up = [0, 1, 0]\n[camera]\ncolumns = 80\n{ball}"));
    let view = model.world.cameras[0].view;
    assert_eq!((view.columns, view.rows, view.up), (80, 60, DVec3::Y));
    let to_ball = DVec3::new(10.0, 0.0, 0.0) - view.position;
    assert!(to_ball.normalize().dot(view.aim) > 1.0 - 1e-12);
    assert_eq!(model.world.up, DVec3::Y);
}

#[test]
fn how_colours_are_shown_is_read() {
    let shown = |text: &str| model(text).world.display;
    assert_eq!(shown(""), DisplayTransform::default());
    let both = DisplayTransform { exposure: -1.5, tone_map: ToneMap::Neutral };
    assert_eq!(shown("[display]\nexposure = -1.5\ntone_map = 'neutral'\n"), both);
    let brighter = DisplayTransform { exposure: 2.0, tone_map: ToneMap::None };
    assert_eq!(shown("[display]\nexposure = 2\n"), brighter);
}

#[test]
fn lights_background_and_shading_are_read() {
    let text = "[sky]\nhorizon = '#ffffff'\nzenith = [0, 0, 0.5]\n[[lights]]\nkind = 'directional'\n\
        direction = [0, 0, -1]\ncolor = [1, 0.5, 0]\n[shading]\nambient = [0, 0, 0]\nshadows = false\nsamples = 16\n";
    let lit = model(text);
    let sky = Background::Gradient {
        horizon: Color::ONE,
        zenith: Color::new(0.0, 0.0, 0.5),
        up: DVec3::Z,
    };
    assert_eq!(lit.world.appearance.background, Some(sky));
    let color = Color::new(1.0, 0.5, 0.0);
    assert_eq!(
        lit.world.lights,
        [Light::from(DirectionalLight { direction: DVec3::NEG_Z, color, angle_degrees: 0.0 })]
    );
    let Some(Shader::Lambert(lambert)) = lit.world.appearance.shader else {
        panic!("{:?}", lit.world.appearance.shader);
    };
    assert_eq!(
        (lambert.ambient, lambert.shadows, lit.world.appearance.samples),
        (Color::ZERO, false, Some(16))
    );
    let plain = model("[background]\ncolor = '#bc0000'\n[shading]\nshader = 'unlit'\n");
    assert_eq!(plain.world.appearance.shader.map(|shader| shader.name()), Some("unlit"));
    let Some(Background::Uniform(red)) = plain.world.appearance.background else {
        panic!("{:?}", plain.world.appearance.background);
    };
    // Byte 188 of sRGB is half the light, to half a byte.
    assert!((red.x - 0.5).abs() < 0.005 && red.y == 0.0);
    let empty = model("");
    assert!(
        empty.world.appearance.shader.is_none()
            && empty.world.appearance.background.is_none()
            && !empty.world.has_view
    );
}

#[test]
fn a_file_named_twice_is_read_once_and_shared() {
    let text = "[[objects]]\nfile = 'parts/t.obj'\nname = 'left'\n[[objects]]\nfile = 'parts/../parts/t.obj'\n";
    assert!(read(text, &[("parts/t.obj", TETRAHEDRON)]).is_err(), "no way upwards");
    let text = "[[objects]]\nfile = 'parts/t.obj'\nname = 'left'\n\
        [[objects]]\nfile = './parts/t.obj'\ntranslate = [9, 0, 0]\ncolor = [1, 0, 0]\n";
    let model = read(text, &[("parts/t.obj", TETRAHEDRON)]).expect("a scene");
    let names: Vec<&str> = model.world.objects.iter().map(firsthit::Object::name).collect();
    assert_eq!(names, ["left/a", "left/b", "a", "b"]);
    let mesh = |k: usize| model.world.objects[k].mesh().expect("a mesh");
    assert!(Arc::ptr_eq(mesh(0), mesh(2)) && Arc::ptr_eq(mesh(1), mesh(3)));
    assert_eq!(model.world.objects[2].color(), Color::X);
    assert_eq!(model.world.objects[2].bounds().low, DVec3::new(9.0, 0.0, 0.0));
    assert_eq!(model.files.len(), 2);
}

#[test]
fn doubts_about_a_named_file_are_passed_on() {
    let text = "[[objects]]\nfile = 't.obj'\n";
    let bad = "v 0 0 0\nv 1 0 0\nv nan 1 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n";
    let model = read(text, &[("t.obj", bad)]).expect("a scene");
    assert!(model.warnings[0].contains("t.obj: dropped: 1 triangle"), "{:?}", model.warnings);
    let error = read(text, &[("t.obj", "v 0 0 0\nf 1 2 3\n")]).expect_err("an index of nothing");
    let said = error.to_string();
    assert!(
        said.contains("scene.toml:2:8: 't.obj' is not read: ") && said.contains("t.obj:2: "),
        "{said}"
    );
}

#[test]
fn no_file_outside_the_folder_is_read_or_written() {
    for name in [
        "/etc/passwd",
        "../t.obj",
        "a/../../t.obj",
        "http://host/t.obj",
        "c:t.obj",
        "a\\\\b.obj",
        "",
    ] {
        for table in ["objects", "outputs"] {
            let text = format!("[[{table}]]\nfile = \"{name}\"\n");
            let said = refusal(&text);
            assert!(said.starts_with("scene.toml:2:8: "), "{said}");
        }
    }
    assert_eq!(
        refusal("[[outputs]]\nfile = '../a.png'"),
        "scene.toml:2:8: '../a.png' is not written: refused: the path has ..; only files in the same folder and below are read and written"
    );
    assert!(
        refusal("[[objects]]\nfile = 'scene.toml'")
            .ends_with("a scene file holds no other scene files")
    );
    assert!(
        refusal("[[outputs]]\nfile = 'a.sh'")
            .contains("'a.sh' is not written: it must end in one of .png")
    );
}

#[cfg(unix)]
#[test]
fn outputs_do_not_follow_links_out_of_the_folder() {
    let top = tempfile::tempdir().expect("a temporary folder");
    let folder = top.path().join("scene");
    fs::create_dir(&folder).expect("room for a folder");
    fs::write(top.path().join("kept.png"), "kept").expect("room for a file");
    let link =
        |to: &str, name: &str| std::os::unix::fs::symlink(to, folder.join(name)).expect("a link");
    link("../kept.png", "file.png");
    link("..", "up");
    link("../missing.png", "dangling.png");
    link("../missing", "nowhere");
    let path = folder.join("scene.toml");
    for name in ["file.png", "up/new.png", "up/kept.png", "dangling.png", "nowhere/a.png"] {
        fs::write(&path, format!("[[outputs]]\nfile = '{name}'\n")).expect("room for a file");
        let error = load(&path, &LoadSettings::default()).expect_err(name).to_string();
        assert!(error.contains("leads outside"), "{name}: {error}");
    }
    // Files beside the one that is named, and files of channels.
    link("../missing.json", "beside.npy.json");
    link("../kept.png", "z.png");
    link("../missing.json", "z.npy.json");
    for (name, channels) in [
        ("beside.npy", "'color'"),
        ("{channel}.png", "'color', 'z'"),
        ("{channel}.npy", "'color', 'z'"),
    ] {
        let text = format!("[[outputs]]\nfile = '{name}'\nchannels = [{channels}]\n");
        fs::write(&path, text).expect("room for a file");
        let error = load(&path, &LoadSettings::default()).expect_err(name);
        let error = error.to_string();
        assert!(error.contains("leads outside"), "{name}: {error}");
    }
    let fifo = std::process::Command::new("mkfifo").arg(folder.join("fifo.png")).status();
    assert!(fifo.expect("mkfifo").success());
    fs::write(&path, "[[outputs]]\nfile = 'fifo.png'\n").expect("room for a file");
    let error = load(&path, &LoadSettings::default()).expect_err("a FIFO");
    assert!(error.to_string().contains("no regular file"), "{error}");
    fs::write(&path, "[[outputs]]\nfile = 'new/a.png'\n").expect("room for a file");
    let model = load(&path, &LoadSettings::default()).expect("a scene");
    assert_eq!(model.world.outputs[0].path, folder.join("new/a.png"));
    assert_eq!(model.world.outputs[0].channels, ["color"]);
}

#[test]
fn the_path_is_taken_as_it_is_given() {
    let error =
        load(Path::new("nowhere/scene.toml"), &LoadSettings::default()).expect_err("nothing there");
    assert!(error.to_string().starts_with("nowhere/scene.toml: "), "{error}");
}

#[test]
fn a_mesh_with_a_corner_that_is_too_far_is_refused_by_its_place() {
    let refused = refusal(
        "[[objects]]\nshape = \"mesh\"\nvertices = [[0,0,0],[1,0,0],[0,1,1e31]]\ntriangles = [[0,1,2]]\n",
    );
    assert!(
        refused.contains(":3:29: vertex 2 has a coordinate that is not below 1e30"),
        "{refused}"
    );
}

#[test]
fn colours_have_names_and_a_background_may_be_transparent() {
    let model = model("[background]\ncolor = 'transparent'\n[shading]\nambient = 'white'\n");
    assert_eq!(model.world.appearance.background, Some(Background::Transparent));
    let named = self::model("[background]\ncolor = 'tomato'\n").world.appearance.background;
    assert_eq!(named, self::model("[background]\ncolor = '#ff6347'\n").world.appearance.background);
}
