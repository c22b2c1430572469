//! First steps: every name at the crate's root shows how it is used, and debug output is short.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use firsthit::load::{LoadSettings, Loaded, load_bytes};
use firsthit::render::framing_camera;
use firsthit::scene::{ColorBy, Coloring, MapRole, Maps};
use firsthit::shade::{BACKGROUND, Ground, LightRig, Lighting, RANDOM_SAMPLES};
use firsthit::shoot::{First, trace};
use firsthit::world::World;
use firsthit::{
    Background, Camera, Color, DVec3, Hit, Material, Mesh, Object, Positions, Render, Scene,
    Shader, Shading, Sphere, Texture, TextureMap, View, camera::StandardView, channel, image,
    render,
};

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let nested = paths.map(|path| if path.is_dir() { sources(&path) } else { vec![path] });
    nested.flatten().collect()
}

/// The names that `lib.rs` has at the crate's root, but for the vector maths, which is another
/// crate's.
fn names(lib: &str) -> Vec<String> {
    let lists = lib.split("#[doc(no_inline)]\npub use ").skip(1);
    let lists = lists.map(|list| list.split(';').next().unwrap());
    let named = lists.flat_map(|list| {
        let words = list.split("::").last().unwrap();
        words.split(['{', '}', ',', ' ', '\n']).map(str::to_owned).collect::<Vec<_>>()
    });
    let is_foreign = |name: &str| ["DAffine3", "DMat3", "DQuat", "DVec2", "DVec3"].contains(&name);
    named.filter(|name| !name.is_empty() && !is_foreign(name)).collect()
}

/// Whether the item `name` has an example in what stands above it.
fn has_example(name: &str, files: &[String]) -> bool {
    let kinds = ["struct", "enum", "trait", "fn", "type"];
    let starts: Vec<String> = kinds.iter().map(|kind| format!("pub {kind} {name}")).collect();
    let is_it = |line: &str| {
        let line = line.trim_start();
        let rest = starts.iter().find_map(|start| line.strip_prefix(start.as_str()));
        rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    };
    files.iter().any(|file| {
        let lines: Vec<&str> = file.lines().collect();
        let found = lines.iter().position(|line| is_it(line));
        found.is_some_and(|end| {
            let above = lines[..end].iter().rev().map(|line| line.trim_start());
            let mut above =
                above.take_while(|line| line.starts_with("//") || line.starts_with('#'));
            above.any(|line| line.starts_with("/// ```"))
        })
    })
}

#[test]
fn every_name_at_the_root_has_an_example() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = sources(folder.parent().unwrap());
    let is_rust = |path: &&PathBuf| path.extension().is_some_and(|extension| extension == "rs");
    let files: Vec<_> =
        files.iter().filter(is_rust).map(|path| fs::read_to_string(path).unwrap()).collect();
    let names = names(&fs::read_to_string(folder.join("src/lib.rs")).unwrap());
    assert!(names.len() > 30, "{names:?}");
    let without: Vec<_> = names.iter().filter(|name| !has_example(name, &files)).collect();
    assert!(without.is_empty(), "no example: {without:?}");
}

/// A mesh of many triangles with all that a mesh can have.
fn large() -> Arc<Mesh> {
    let points: Vec<[f64; 3]> = (0..30_000).map(|k| [f64::from(k), 0.5, 0.1]).collect();
    let triangles = (0..10_000).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mesh = Mesh::new(Positions::compact(points), triangles).unwrap();
    let normals = firsthit::shape::Attribute::per_vertex(vec![[0.0, 0.0, 1.0]; 30_000]);
    Arc::new(mesh.with_normals(normals).unwrap().with_slots(vec![0; 10_000]).unwrap())
}

#[test]
fn what_is_printed_of_large_things_is_a_summary() {
    let texture = Arc::new(Texture::new(512, 512, vec![[0; 4]; 512 * 512]).unwrap());
    let material = Material {
        maps: Maps::default()
            .with(MapRole::Color, TextureMap::new(Arc::clone(&texture), TextureMap::V_UP)),
        ..Material::default()
    };
    let mesh = large();
    let object = Object::new(Arc::clone(&mesh)).named("n".repeat(100_000));
    let object = object.with_materials(vec![material; 50]);
    let objects = vec![object.clone(); 1000];
    let loaded = Loaded {
        variants: Vec::new(),
        world: World { objects: objects.clone(), ..World::default() },
        files: Vec::new(),
        warnings: vec!["w".repeat(1000); 100],
        vertices: None,
        scene: None,
    };
    let scene = Scene::new(objects).unwrap();
    let camera = framing_camera(&scene, DVec3::Z, StandardView::Iso, [50, 60]).unwrap();
    let hits = trace(&scene, &camera, First, &()).unwrap();
    let channels: Vec<_> = channel::KINDS.iter().map(|kind| &*kind.name).collect();
    let frame = Render::new(&scene).size(50, 60).channels(&channels).samples(1).frame().unwrap();
    for (name, text) in [
        ("Loaded", format!("{loaded:?}")),
        ("Mesh", format!("{mesh:?}")),
        ("Object", format!("{object:?}")),
        ("Scene", format!("{scene:?}")),
        ("Texture", format!("{texture:?}")),
        ("Frame", format!("{frame:?}")),
        ("Hits", format!("{hits:?}")),
        ("Positions", format!("{:?}", mesh.positions())),
        ("Attribute", format!("{:?}", mesh.normals())),
        ("Loaded, in lines", format!("{loaded:#?}")),
        ("Scene, in lines", format!("{scene:#?}")),
    ] {
        assert!(text.len() < 2000 + 2000 * usize::from(name.contains("lines")), "{name}: {text}");
    }
    assert!(format!("{mesh:?}").contains("triangles: 10000, vertices: 30000"));
    assert!(format!("{scene:?}").contains("... of 1000"), "{scene:?}");
    let shown = format!("{frame:?}");
    assert!(shown.contains("\"color\": 9000 float32"), "{shown}");
    assert!(format!("{hits:?}").starts_with("Hits { rays: 3000, hit: "));
}

fn balls() -> Scene {
    let ball = |x: f64, name: &str| {
        let ball = Sphere::new(DVec3::new(x, 0.0, 0.0), 1.0).unwrap();
        Object::new(ball).named(name).colored(Color::new(0.8, 0.3, 0.1))
    };
    Scene::new(vec![ball(0.0, "left"), ball(2.5, "right")]).unwrap()
}

#[test]
fn a_picture_of_which_nothing_is_said_is_the_full_form_with_the_defaults() {
    let scene = balls();
    let short = Render::new(&scene).size(48, 64).frame().unwrap();
    let camera = framing_camera(&scene, DVec3::Z, StandardView::Iso, [48, 64]).unwrap();
    let Lighting { lights, environment } = LightRig::Auto.lighting(&camera, DVec3::Z);
    let lit = scene.clone().with_automatic_lights(lights);
    let lit = lit.with_borrowed_environment(environment);
    let shade = Shading {
        upwards: camera.upwards(),
        background: BACKGROUND,
        ground: Ground::under(&scene, DVec3::Z),
        ..Shader::named("direct").unwrap().on(&lit)
    };
    let kinds = [channel::kind("color").unwrap()];
    let full = render(&scene, &camera, &shade, &kinds, RANDOM_SAMPLES, &()).unwrap();
    assert_eq!(short.channels(), full.channels());
    assert_eq!(short.metadata().to_json(), full.metadata().to_json());
}

#[test]
fn everything_said_of_a_picture_shows_in_it() {
    let scene = balls();
    let small = Render::new(&scene).size(12, 16).samples(1);
    let data = |picture: Render<'_>| picture.frame().unwrap().channels()[0].data.clone();
    let plain = data(small.clone());
    let camera = Camera::new(View {
        position: DVec3::new(1.0, 0.0, 9.0),
        rows: 12,
        columns: 16,
        ..View::default()
    });
    let white = |_: f64, _: DVec3, _: DVec3, _: &Hit| Color::ONE;
    for changed in [
        small.clone().view(StandardView::Top),
        small.clone().up(DVec3::X),
        small.clone().size(13, 16),
        small.clone().samples(5),
        small.clone().background(Background::default()),
        small.clone().shade(Shader::named("unlit").unwrap()),
        small.clone().shade(&white),
        small.clone().channels(&["z"]),
        small.clone().camera(camera.unwrap()),
    ] {
        let told = format!("{changed:?}");
        assert_ne!(data(changed), plain, "{told}");
    }
    let frame = small.clone().channels(&["t", "object", "color"]).frame().unwrap();
    let names: Vec<_> = frame.channels().iter().map(|channel| &*channel.name).collect();
    assert_eq!(names, ["t", "object", "color"]);
    let error = small.channels(&["depth"]).frame().unwrap_err().to_string();
    assert!(error.starts_with("channel must be "), "{error}");
}

/// It makes its colours without them.
#[test]
fn what_a_shade_of_one_s_own_would_ignore_is_refused() {
    let scene = balls();
    let fog = |t: f64, _p: DVec3, _u_r: DVec3, _o: &Hit| Color::splat(libm::exp(-t));
    let small = Render::new(&scene).size(3, 4).shade(&fog);
    assert!(small.clone().samples(2).frame().is_ok());
    for (name, picture) in [
        ("light", small.clone().light(LightRig::Sun)),
        ("background", small.clone().background(Background::Transparent)),
        ("ground", small.clone().ground(false)),
        ("color_by", small.clone().color_by(Coloring::new(ColorBy::Height))),
    ] {
        let why = picture.frame().unwrap_err().to_string();
        assert!(why.contains(name), "{why}");
    }
}

#[test]
fn a_shader_is_a_shade_once_it_has_a_scene() {
    let scene = balls();
    let camera = framing_camera(&scene, DVec3::Z, StandardView::Front, [12, 16]).unwrap();
    let kinds = [channel::kind("color").unwrap()];
    let unlit = || Shader::named("unlit").unwrap();
    let full = render(&scene, &camera, &unlit().on(&scene), &kinds, 1, &()).unwrap();
    let short = Render::new(&scene).camera(camera).shade(unlit()).samples(1);
    assert_eq!(full.channels(), short.frame().unwrap().channels());
}

#[test]
fn a_frame_is_saved_in_the_format_of_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let scene = balls();
    let frame = Render::new(&scene).size(6, 8).channels(&["color", "z"]);
    let frame = frame.frame().unwrap();
    for name in ["all.exr", "all.npz"] {
        frame.save(folder.path().join(name)).unwrap();
        let read = image::read(&folder.path().join(name)).unwrap();
        assert_eq!(read.arrays.len(), 2, "{name}");
    }
    for name in ["z.png", "z.npy"] {
        let path = folder.path().join(name);
        let error = frame.save(&path).unwrap_err().to_string();
        assert!(error.starts_with("channel must be the single one"), "{error}");
        frame.save_channel("z", &path).unwrap();
        assert!(path.is_file());
    }
    let error = frame.save(folder.path().join("z.gif")).unwrap_err().to_string();
    assert!(error.contains("known: .png, .exr, .npy, .npz"), "{error}");
}

#[test]
fn a_model_is_a_scene_in_one_call() {
    let stl = include_bytes!("../../../../testdata/cube_binary.stl");
    let model = load_bytes(Path::new("cube.stl"), stl, &LoadSettings::default()).unwrap();
    assert!(model.world.up_is_guessed);
    let objects = model.world.objects.len();
    let scene = model.into_scene().unwrap();
    assert_eq!((scene.objects().len(), scene.triangles()), (objects, 12));
}

/// A pyramid on its base, its tip along +z, in a format whose convention is +y: the program sees it
/// upright.
#[test]
fn a_scene_of_a_file_is_upright() {
    let obj = b"v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0.1 0.2 3\n\
        f 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    let model = load_bytes(Path::new("a.obj"), obj, &LoadSettings::default()).unwrap();
    assert_eq!(model.world.up, DVec3::Y);
    let scene = model.into_scene().unwrap();
    assert_eq!(scene.up(), DVec3::Z);
    assert_eq!(scene.with_up(DVec3::X).up(), DVec3::X);
}
