//! Files that say one thing in several ways mean one thing, and one under a wrong name is called
//! what it is.

use std::fs;
use std::path::Path;

use firsthit::geometry::{Color, DVec3, srgb_decode};
use firsthit::load::{LoadSettings, Loaded, UNITS, load, load_bytes};
use firsthit::scene::Light;
use firsthit::{Object, Ray, Scene, shoot};

fn read(name: &str, content: &[u8]) -> Loaded {
    load_bytes(Path::new(name), content, &LoadSettings::default()).unwrap()
}

fn refusal(name: &str, content: &[u8]) -> String {
    let read = load_bytes(Path::new(name), content, &LoadSettings::default());
    read.unwrap_err().to_string()
}

/// The colour that a ray down onto (x, y) sees.
fn seen(model: &Loaded, x: f64, y: f64) -> Color {
    let scene = Scene::new(model.world.objects.clone()).unwrap();
    let ray = Ray::new(DVec3::new(x, y, 9.0), DVec3::NEG_Z);
    let hit = shoot(&scene, ray.origin, ray.direction);
    scene.interaction(&ray, &hit).unwrap().color()
}

fn is_near(model: &Loaded, expected: [f64; 3]) {
    let color = seen(model, 0.25, 0.25);
    let expected = Color::from(expected.map(srgb_decode));
    assert!(color.abs_diff_eq(expected, 1e-6), "{color} {expected}");
}

/// A triangle whose vertices have these numbers after their coordinates.
fn painted(extra: &str) -> Loaded {
    let text = format!("v 0 0 0 {extra}\nv 1 0 0 {extra}\nv 0 1 0 {extra}\nf 1 2 3\n");
    read("a.obj", text.as_bytes())
}

#[test]
fn a_weight_before_the_colour_of_a_vertex_is_not_its_red() {
    for (extra, color, warns) in [
        ("0.2 0.4 0.6", [0.2, 0.4, 0.6], false),
        ("1.0 0.2 0.4 0.6", [0.2, 0.4, 0.6], false),
        ("0.2 0.4 0.6 1.0", [0.2, 0.4, 0.6], false),
        ("51 102 153 255", [0.2, 0.4, 0.6], true),
        ("1 51 102 153", [0.2, 0.4, 0.6], true),
        ("1 0.5 0.5 1", [0.5, 0.5, 1.0], true),
        ("2 0.2 0.4 0.6", [0.2, 0.4, 0.6], true),
        ("1 1 1 1", [1.0; 3], true),
    ] {
        let model = painted(extra);
        assert_eq!(model.warnings.is_empty(), !warns, "{extra}: {:?}", model.warnings);
        is_near(&model, color);
    }
    // One vertex of several tells: red is not one everywhere.
    let text = b"v 0 0 0 1 0 0 1\nv 1 0 0 0 1 0 1\nv 0 1 0 1 0 0 1\nf 1 2 3\n";
    let model = read("a.obj", text);
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    assert!(seen(&model, 0.01, 0.01).x > 0.9);
}

#[test]
fn colours_of_obj_and_ply_files_that_count_to_255_are_not_white() {
    let model = painted("51 102 255");
    assert!(model.warnings[0].contains("colours reach 255"), "{:?}", model.warnings);
    is_near(&model, [0.2, 0.4, 1.0]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float red\nproperty float green\nproperty float blue\nelement face 1\nproperty list uchar int vertex_indices\n\
        end_header\n0 0 0 51 0 255\n1 0 0 51 0 255\n0 1 0 51 0 255\n3 0 1 2\n";
    let model = read("a.ply", ply.as_bytes());
    assert!(model.warnings[0].contains("colours reach 255"), "{:?}", model.warnings);
    is_near(&model, [0.2, 0.0, 1.0]);
    // A little above one is one.
    let model = painted("1.25 0.5 0.25");
    assert!(model.warnings[0].contains("not from 0 to 1"), "{:?}", model.warnings);
    is_near(&model, [1.0, 0.5, 0.25]);
    assert!(painted("1 0.5 0").warnings.is_empty());
}

#[test]
fn a_material_that_gives_more_light_than_it_gets_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    fs::write(folder.path().join("a.obj"), obj).unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl m\nKd 204 102 51\n").unwrap();
    let model = load(&folder.path().join("a.obj"), &LoadSettings::default()).unwrap();
    assert!(model.warnings[0].contains("a.mtl:2: Kd is from 0 to 1"), "{:?}", model.warnings);
}

/// A binary STL of two facets with these attributes.
fn facets(header: &[u8], attributes: [u16; 2]) -> Vec<u8> {
    let mut stl = vec![0; 80];
    stl[..header.len()].copy_from_slice(header);
    stl.extend(2_u32.to_le_bytes());
    let corners = [[0, 0, 1, 0, 0, 1], [5, 5, 6, 5, 5, 6]];
    for (corners, attribute) in corners.into_iter().zip(attributes) {
        stl.extend([0; 12]);
        for [x, y] in corners.as_chunks::<2>().0 {
            for number in [*x as f32, *y as f32, 0.0] {
                stl.extend(number.to_le_bytes());
            }
        }
        stl.extend(attribute.to_le_bytes());
    }
    stl
}

#[test]
fn facets_of_an_stl_have_their_colours_in_both_layouts() {
    let red_high = 0x8000 | 31 << 10 | 15;
    let model = read("a.stl", &facets(b"VisCAM", [red_high, 0]));
    let decoded = |level: u8| srgb_decode(f64::from(level) / 31.0);
    let near = |x: f64, color: Color| {
        let found = seen(&model, x, x);
        assert!(found.abs_diff_eq(color, 1e-6), "{found} {color}");
    };
    near(0.25, Color::new(1.0, 0.0, decoded(15)));
    near(5.25, Object::NEUTRAL);
    let red_low = 31 | 15 << 10;
    let model = read("a.stl", &facets(b"COLOR=\x33\xff\x00\xff,MATERIAL=", [red_low, 0x8000]));
    let near = |x: f64, color: Color| {
        let found = seen(&model, x, x);
        assert!(found.abs_diff_eq(color, 1e-6), "{found} {color}");
    };
    near(0.25, Color::new(1.0, 0.0, decoded(15)));
    near(5.25, Color::new(srgb_decode(0.2), 1.0, 0.0));
    // Attributes that are not marked are none.
    let model = read("a.stl", &facets(b"", [7, 300]));
    assert!(model.world.objects[0].materials().is_empty());
}

#[test]
fn a_file_under_a_wrong_name_is_called_what_it_is() {
    let off = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    for name in ["a.stl", "a.ply", "a.obj", "a.gltf"] {
        let refused = refusal(name, off);
        assert!(refused.ends_with("by its content this is OFF: name it .off"), "{refused}");
    }
    let long = [&off[..], &[b'#'; 200]].concat();
    assert!(refusal("a.stl", &long).contains("name it .off"));
    assert!(refusal("a.obj", b"ISO-10303-21;\nHEADER;\n").contains("FreeCAD opens .step"));
    assert!(refusal("a.stl", b"# .PCD v0.7\n").contains("points without a surface"));
}

#[test]
fn formats_that_are_not_read_name_a_way() {
    for (name, said) in [
        ("a.step", "FreeCAD opens .step and exports"),
        ("a.STP", "FreeCAD opens .stp"),
        ("a.usdz", "usdcat"),
        ("a.3mf", "trimesh reads .3mf"),
        ("a.fbx.gz", "Blender opens .fbx"),
        ("a.vtp", "meshio reads .vtp"),
        ("a.las", ".las holds points without a surface"),
    ] {
        let refused = refusal(name, b"");
        assert!(refused.contains(said), "{refused}");
    }
    assert!(refusal("a.nothing", b"").ends_with(".toml (scene file)"));
}

#[test]
fn units_and_scale_multiply_objects_cameras_and_lights() {
    let text = b"v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n";
    let &(_, millimetre) = UNITS.iter().find(|(name, _)| *name == "mm").unwrap();
    let scaled = |name: &str, content: &[u8], scale| {
        let settings = LoadSettings { scale, ..LoadSettings::default() };
        load_bytes(Path::new(name), content, &settings)
    };
    let model = scaled("a.obj", text, millimetre).unwrap();
    assert_eq!(model.into_scene().unwrap().bounds().high, DVec3::new(1.0, 1.0, 0.0));
    let gltf = br#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"camera": 0, "translation": [0, 0, 4]}, {"translation": [0, 2, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 3, "znear": 0, "zfar": 9}}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 1}]}}}"#;
    let world = scaled("a.gltf", gltf, 10.0).unwrap().world;
    let plain = scaled("a.gltf", gltf, 1.0).unwrap().world;
    assert_eq!(world.cameras[0].view.position, DVec3::new(0.0, 0.0, 40.0));
    assert_eq!(world.cameras[0].view.lens.viewplane().unwrap().height, 60.0);
    let (Light::Point(lamp), Light::Point(before)) = (&world.lights[0], &plain.lights[0]) else {
        panic!("two lamps");
    };
    assert_eq!(lamp.position, DVec3::new(0.0, 20.0, 0.0));
    assert!(lamp.intensity.abs_diff_eq(100.0 * before.intensity, 1e-12));
    for (name, scale) in
        [("a.obj", 0.0), ("a.obj", f64::NAN), ("a.obj", -1.0), ("a.toml", 2.0), ("a.fhs", 2.0)]
    {
        let error = scaled(name, text, scale).unwrap_err().to_string();
        assert!(error.starts_with("scale must be"), "{error}");
    }
}

#[test]
fn a_scene_file_says_the_unit_of_each_file() {
    let folder = tempfile::tempdir().unwrap();
    let part = "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n";
    fs::write(folder.path().join("a.obj"), part).unwrap();
    let scene = "[[objects]]\nfile = \"a.obj\"\nunits = \"mm\"\nscale = 2\ntranslate = [0, 0, 5]\n";
    let path = folder.path().join("s.toml");
    fs::write(&path, scene).unwrap();
    let model = load(&path, &LoadSettings::default()).unwrap();
    assert_eq!(model.into_scene().unwrap().bounds().high, DVec3::new(2.0, 2.0, 5.0));
    fs::write(&path, scene.replace("\"mm\"", "\"furlong\"")).unwrap();
    let error = load(&path, &LoadSettings::default()).unwrap_err().to_string();
    assert!(error.contains("\"mm\""), "{error}");
}

const TEXTURED: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
    mtllib a.mtl\nusemtl m\nf 1/1 2/2 3/3\n";

#[test]
fn textures_above_the_folder_are_read_where_it_is_allowed_and_else_the_material_keeps_its_name() {
    let top = tempfile::tempdir().unwrap();
    let (model, textures) = (top.path().join("model"), top.path().join("textures"));
    fs::create_dir(&model).unwrap();
    fs::create_dir(&textures).unwrap();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[255, 0, 0]).unwrap();
    writer.finish().unwrap();
    fs::write(textures.join("red.png"), png).unwrap();
    fs::write(model.join("a.obj"), TEXTURED).unwrap();
    let allowed = LoadSettings { resources: vec![textures], ..LoadSettings::default() };
    for name in ["../textures/red.png", "..\\textures\\red.png", "D:\\work\\red.png"] {
        fs::write(model.join("a.mtl"), format!("newmtl m\nmap_Kd {name}\n")).unwrap();
        let found = load(&model.join("a.obj"), &allowed).unwrap();
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        assert_eq!(seen(&found, 0.25, 0.25), Color::X);
        let refused = load(&model.join("a.obj"), &LoadSettings::default()).unwrap();
        assert!(refused.warnings[0].contains("refused"), "{:?}", refused.warnings);
        assert_eq!(&*refused.world.objects[0].materials()[0].name, "m");
        assert_eq!(seen(&refused, 0.25, 0.25), Object::NEUTRAL);
    }
}

#[test]
fn backslashes_separate_folders() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("sub/a.mtl"), "newmtl m\nKd 1 0 0\n").unwrap();
    let text = TEXTURED.replace("a.mtl", "sub\\a.mtl");
    fs::write(folder.path().join("a.obj"), text).unwrap();
    let model = load(&folder.path().join("a.obj"), &LoadSettings::default()).unwrap();
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    assert_eq!(seen(&model, 0.25, 0.25), Color::X);
}

/// A picture of 1 x 1 texel: TIFF, little-endian, RGB of 8 bits without compression.
fn tiff() -> Vec<u8> {
    let mut file = b"II*\0\x08\0\0\0".to_vec();
    let entries: [[u32; 4]; 9] = [
        [256, 3, 1, 1],
        [257, 3, 1, 1],
        [258, 3, 1, 8],
        [259, 3, 1, 1],
        [262, 3, 1, 2],
        [273, 4, 1, 8 + 2 + 9 * 12 + 4],
        [277, 3, 1, 3],
        [278, 3, 1, 1],
        [279, 4, 1, 3],
    ];
    file.extend((entries.len() as u16).to_le_bytes());
    for [tag, kind, count, value] in entries {
        file.extend((tag as u16).to_le_bytes());
        file.extend((kind as u16).to_le_bytes());
        file.extend(count.to_le_bytes());
        file.extend(value.to_le_bytes());
    }
    file.extend([0; 4]);
    file.extend([0, 255, 0]);
    file
}

/// A picture of 1 x 1 texel, green.
const GIF: &[u8] =
    b"GIF89a\x01\0\x01\0\x80\0\0\0\xff\0\0\0\0,\0\0\0\0\x01\0\x01\0\0\x02\x02D\x01\0;";

#[test]
fn textures_in_tiff_and_gif_are_read() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.obj"), TEXTURED).unwrap();
    for (name, content) in [("t.tif", tiff()), ("t.gif", GIF.to_vec())] {
        fs::write(folder.path().join(name), content).unwrap();
        let library = format!("newmtl m\nmap_Kd {name}\n");
        fs::write(folder.path().join("a.mtl"), library).unwrap();
        let model = load(&folder.path().join("a.obj"), &LoadSettings::default()).unwrap();
        assert!(model.warnings.is_empty(), "{:?}", model.warnings);
        assert_eq!(seen(&model, 0.25, 0.25), Color::Y);
    }
}
