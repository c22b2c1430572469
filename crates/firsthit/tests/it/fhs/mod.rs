//! Built scenes in files: what is opened is what was saved, and no file does any harm.

mod hostile;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use firsthit::camera::{Aim, Description, Equirectangular, Focus, FovAxis, Opening, StandardView};
use firsthit::edge::{Dash, EdgeKind, EdgeKinds, Edges};
use firsthit::load::{LoadSettings, load, load_bytes};
use firsthit::scene::{Build, BuildSettings, DirectionalLight, PointLight, SpotLight};
use firsthit::scene::{Filter, MapRole, Maps, Wrap};
use firsthit::shade::{Appearance, Lambert, LightRig};
use firsthit::shape::{Attribute, Between, Property, PropertyOf, PropertyValues};
use firsthit::shoot::{All, Any, BruteForce, Count, Cpu, First, trace_with};
use firsthit::world::{NamedCamera, World};
use firsthit::{
    AlphaMode, Background, Camera, Color, Cone, Cuboid, Cylinder, DAffine3, DQuat, DVec3, Disc,
    DisplayTransform, InstructionSet, Lens, Light, Material, Mesh, Object, Plane, Positions, Rays,
    Scene, Shader, Sphere, Texture, TextureMap, ToneMap, Transform, View, Viewplane, fhs,
};

use crate::joined::pieces;
use crate::support::{Numbers, bits, bumpy_sphere, mesh, rays};

/// A folder that is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        // Tests that run at the same time may have the same name for theirs.
        static MADE: AtomicUsize = AtomicUsize::new(0);
        let number = MADE.fetch_add(1, Ordering::Relaxed);
        let name = format!("firsthit-fhs-{name}-{}-{number}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).unwrap();
    }
}

fn turned(angle: f64, by: DVec3) -> Transform {
    let turn = DQuat::from_rotation_x(angle) * DQuat::from_rotation_y(0.5 * angle);
    let scale = DVec3::new(1.0, -0.7, 1.3);
    Transform::new(DAffine3::from_scale_rotation_translation(scale, turn, by)).unwrap()
}

/// A mesh with everything that a mesh can have.
fn rich_mesh() -> Arc<Mesh> {
    let (points, triangles) = bumpy_sphere(5, 3);
    let count = triangles.len() as u32;
    let vertices = points.len();
    let mut numbers = Numbers::new(9);
    let mut triple = || numbers.point().to_array().map(|x| x as f32);
    let normals = (0..vertices).map(|_| triple()).collect();
    let colors = Attribute {
        values: (0..7).map(|_| triple().map(f32::abs)).collect(),
        corners: Some((0..count).map(|k| [k % 7, k % 5, k % 3]).collect()),
    };
    let uvs = (0..vertices).map(|k| [k as f32 / 9.0, k as f32 / 7.0]);
    let alphas = (0..vertices).map(|k| [(k % 4) as f32 / 3.0]).collect();
    let quality = PropertyValues::Double((0..vertices).map(|k| 0.1 * k as f64).collect());
    let of_vertices = Property::new("quality", PropertyOf::Vertices, quality);
    let sizes = PropertyValues::Single((0..count).map(|k| k as f32).collect());
    let of_faces = Property {
        between: Between::NearestCorner,
        ..Property::new("Größe", PropertyOf::Faces, sizes)
    };
    let pairs = PropertyValues::Single((0..6 * count).map(|k| 0.5 * k as f32).collect());
    let of_corners =
        Property { components: 2, ..Property::new("pairs", PropertyOf::Corners, pairs) };
    let mesh = Arc::unwrap_or_clone(mesh(&points, triangles));
    let mesh = mesh.with_normals(Attribute::per_vertex(normals)).unwrap();
    let mesh = mesh.with_uvs(Attribute::per_vertex(uvs.collect())).unwrap();
    let mesh = mesh.with_colors(colors).unwrap();
    let mesh = mesh.with_alphas(Attribute::per_vertex(alphas)).unwrap();
    let mesh = mesh.with_faces((0..count).map(|k| k / 2).collect()).unwrap();
    let mesh = mesh.with_slots((0..count).map(|k| k % 3).collect()).unwrap();
    Arc::new(mesh.with_properties(vec![of_vertices, of_faces, of_corners]).unwrap())
}

fn materials() -> Vec<Material> {
    let texels: Vec<[u8; 4]> = (0..12).map(|k| [20 * k, 255 - 9 * k, 3, 99 + k]).collect();
    let texture = Arc::new(Texture::new(4, 3, texels).unwrap());
    let map = TextureMap {
        wrap: [Wrap::Mirror, Wrap::Clamp],
        filter: Filter::Nearest,
        picture_from_uv: [[0.1, 0.2, 1.0 / 3.0], [-0.0, 2.0, 5.0]],
        ..TextureMap::new(Arc::clone(&texture), TextureMap::V_UP)
    };
    let both = Maps::default().with(MapRole::Color, map.clone());
    let glass = Material {
        maps: both.with(MapRole::Alpha, TextureMap::new(texture, TextureMap::V_DOWN)),
        alpha: 0.9,
        alpha_mode: AlphaMode::Mask { cutoff: 0.3 },
        ..Material::default()
    };
    let plain = Material {
        unlit: true,
        double_sided: false,
        alpha_mode: AlphaMode::Blend,
        ..Material::colored(Color::new(0.1, f64::INFINITY, 2.0))
    };
    vec![glass, plain]
}

/// Every shape, one mesh at several places, one with cut-outs, empty ones, and duplicates.
fn objects() -> Vec<Object> {
    let rich = rich_mesh();
    let (points, triangles) = bumpy_sphere(12, 4);
    let far: Vec<DVec3> = points.iter().map(|p| *p * 0.3 + DVec3::splat(1e5 + 0.1)).collect();
    let plain = mesh(&points, triangles.clone());
    // A second mesh over the same vertices.
    let half = triangles[..triangles.len() / 2].to_vec();
    let half = Arc::new(Mesh::new(Arc::clone(plain.positions()), half).unwrap());
    let twice = [triangles.clone(), triangles[..40].to_vec()].concat();
    let nothing = Mesh::new(Positions::compact(Vec::new()), Vec::new()).unwrap();
    let back = Transform::translation(DVec3::splat(-1e5)).unwrap();
    let looks: Arc<[Material]> = materials().into();
    let mut all = vec![
        Object::new(Arc::clone(&rich)).named("rich").with_materials(Arc::clone(&looks)),
        Object::new(rich).placed(turned(0.4, DVec3::X)).with_materials(looks),
        Object::new(Arc::clone(&plain)).placed(turned(1.0, 2.0 * DVec3::Y)).named("turned"),
        Object::new(Arc::clone(&plain)).placed(turned(1.0, 2.0 * DVec3::Y)).named("again"),
        Object::new(half).colored(Color::new(0.2, 0.3, 0.4)),
        Object::new(mesh(&far, triangles)).placed(back),
        Object::new(mesh(&points, twice)).placed(turned(2.0, DVec3::Z)),
        Object::new(Arc::new(nothing)).named("nothing"),
        Object::new(Plane::new(DVec3::new(0.0, 0.0, -3.0), DVec3::new(0.1, 0.2, 3.0)).unwrap()),
        Object::new(Sphere::new(DVec3::new(2.0, 0.1, 0.0), 0.7).unwrap()).named("ball"),
        Object::new(Disc::new(DVec3::new(-2.0, 0.0, 0.0), DVec3::ONE, 0.8).unwrap()),
        Object::new(Cuboid::new(DVec3::splat(1.5), DVec3::splat(2.5)).unwrap())
            .placed(turned(0.2, DVec3::ZERO)),
        Object::new(Cylinder::new(DVec3::NEG_Y, DVec3::new(0.1, -2.0, 1.0), 0.4).unwrap()),
        Object::new(Cone::new(DVec3::Z, DVec3::new(0.0, 0.2, 3.0), 0.9, 0.2).unwrap()),
    ];
    // Normals of length one that would change if they were made so again.
    for k in 0..40 {
        let normal = Numbers::new(k).point();
        let plane = Plane::new(DVec3::new(0.0, 0.0, -50.0), normal).unwrap();
        let disc = Disc::new(50.0 * normal, normal, 0.5).unwrap();
        all.extend([Object::new(plane), Object::new(disc)]);
    }
    let ball = all[9].clone();
    all.push(ball.named("the same ball"));
    all
}

fn lights() -> [Light; 3] {
    let sun = Light::from(DirectionalLight {
        direction: DVec3::new(0.5, 0.1, -1.0),
        color: Color::splat(0.9),
        angle_degrees: 0.0,
    });
    let lamp = Light::from(PointLight {
        position: DVec3::new(0.0, 1.0, 5.0),
        intensity: Color::splat(9.0),
    });
    let spot = Light::from(SpotLight {
        position: DVec3::new(0.0, 1.0, 5.0),
        direction: DVec3::NEG_Z,
        intensity: Color::splat(5.0),
        inner_angle: 0.2,
        outer_angle: 0.5,
    });
    [sun, lamp, spot]
}

#[expect(clippy::too_many_lines, reason = "all that a world has")]
fn world() -> World {
    let view = View {
        position: DVec3::new(3.0, -9.0, 1.0 / 3.0),
        aim: DVec3::new(-0.3, 1.0, 0.0),
        up: DVec3::Z,
        lens: Lens::Flat(Viewplane { aperture: 0.1, focus: 1.0 / 3.0, ..Viewplane::default() }),
        ..View::default()
    };
    let camera = |name: &str, view: View, description: Option<Description>| NamedCamera {
        name: name.into(),
        own_name: "own".into(),
        view,
        has_size: description.is_none(),
        description,
    };
    let described = Description {
        aim: Some(Aim::View(StandardView::ALL[2])),
        opening: Some(Opening::Viewplane { width: 3.0, height: 2.0, focal_length: None }),
        rows: Some(48),
        aperture: Some(0.3),
        focus: Some(Focus::At(DVec3::new(1.0, 2.0, -3.0))),
        ..Description::default()
    };
    let across = Description {
        opening: Some(Opening::Fov(60.0)),
        fov_axis: Some(FovAxis::Horizontal),
        ..Description::default()
    };
    let panorama = View { lens: Lens::Equirectangular(Equirectangular::default()), ..view };
    World {
        cameras: vec![
            camera("first", view, None),
            camera("second", panorama, Some(described)),
            camera("third", view, Some(across)),
        ],
        lights: lights().to_vec(),
        has_view: true,
        appearance: Appearance {
            background: Some(Background::Gradient {
                horizon: Color::ONE,
                zenith: Color::X,
                up: DVec3::Y,
            }),
            shader: Some(Shader::Lambert(Lambert {
                ambient: Color::splat(0.1),
                shadows: false,
                ..Lambert::default()
            })),
            samples: Some(7),
            rig: Some(LightRig::Studio),
            ground: Some(false),
            coloring: None,
        },
        display: DisplayTransform { exposure: -1.0 / 3.0, tone_map: ToneMap::Agx },
        edges: Some(Edges {
            width: 1.0 / 3.0,
            angle: 12.5,
            kinds: EdgeKinds::of(&[EdgeKind::Object, EdgeKind::Wireframe]),
            hidden: Some(Dash { on: 0.1, off: 7.0 }),
            color: Color::new(0.1, 0.2, 0.3),
        }),
        up: DVec3::new(0.0, 1.0, 0.25),
        up_is_guessed: true,
        ..World::default()
    }
}

#[test]
fn all_of_a_scene_is_in_its_file() {
    let folder = Folder::new("all");
    let path = folder.path("a.fhs");
    let (scene, world) = (Scene::new(objects()).unwrap(), world());
    fhs::save(&path, &scene, &world, &()).unwrap();
    let settings = LoadSettings { verify: true, ..LoadSettings::default() };
    let loaded = load(&path, &settings).unwrap();
    let opened = loaded.scene.as_ref().unwrap();
    assert_eq!(loaded.world.objects, scene.objects());
    assert_eq!(opened.objects(), scene.objects());
    assert_eq!(opened.bounds(), scene.bounds());
    assert_eq!(opened.tree_bytes(), scene.tree_bytes());
    let positions =
        |scene: &Scene, k: usize| Arc::as_ptr(scene.objects()[k].mesh().unwrap().positions());
    assert_eq!(positions(opened, 2), positions(opened, 4), "vertices are shared as before");
    let (read, written) = (&loaded.world, &world);
    assert_eq!(read.cameras, written.cameras);
    assert_eq!(read.lights, written.lights);
    assert!(read.has_view);
    assert_eq!(read.appearance, written.appearance);
    assert_eq!(read.display, written.display);
    assert_eq!(read.edges, written.edges);
    assert_eq!((read.up, read.up_is_guessed), (written.up, true));
    let lit = scene.clone().with_lights(world.lights.clone());
    let again = loaded.clone().into_scene().unwrap();
    assert_eq!(again.fingerprint(), lit.fingerprint());
    // Taken apart again, it is the same file: also from a copy in memory, and packed by nobody.
    let second = folder.path("b.fhs");
    fhs::save(&second, opened, read, &()).unwrap();
    let bytes = fs::read(&path).unwrap();
    assert!(fs::read(&second).unwrap() == bytes);
    let copied = load_bytes(Path::new("c.fhs"), &bytes, &settings).unwrap();
    assert_eq!(copied.world.objects, scene.objects());
}

/// Whoever changed the objects after opening gets those.
#[test]
fn objects_of_an_opened_world_can_be_changed() {
    let folder = Folder::new("changed");
    let path = folder.path("a.fhs");
    fhs::save(&path, &Scene::new(objects()).unwrap(), &world(), &()).unwrap();
    let mut loaded = fhs::open(&path, false).unwrap();
    loaded.world.objects.truncate(3);
    loaded.world.objects[2] = loaded.world.objects[2].clone().placed(Transform::IDENTITY);
    let expected = Scene::new(loaded.world.objects.clone()).unwrap();
    let scene = loaded.into_scene().unwrap();
    assert_eq!(scene.objects(), expected.objects());
    assert_same(&scene, &expected, 300);
}

/// The answers of every query on every instruction set, for scattered rays, for coherent ones, and
/// for a camera's.
fn assert_same(one: &Scene, other: &Scene, count: usize) {
    let points: Vec<DVec3> = (0..40).map(|k| 2.0 * Numbers::new(k).point()).collect();
    let scattered = rays(&points, count, 7);
    let bounds = other.bounds();
    let eye = bounds.centre() + 2.0 * bounds.size();
    let camera = Camera::look_at(eye, bounds.centre(), DVec3::Z, 40.0, 40, 48).unwrap();
    for set in InstructionSet::available() {
        let engine = Cpu::with(set);
        compare(&engine, one, other, &scattered[..]);
        compare(&engine, one, other, &camera);
    }
    for ray in scattered.iter().step_by(16) {
        let hits =
            [one, other].map(|scene| trace_with(&BruteForce, scene, &[*ray][..], First, &()));
        let [first, second] = hits.map(|hits| bits(&hits.unwrap().get(0)));
        assert_eq!(first, second);
    }
}

fn compare<R: Rays + ?Sized>(engine: &Cpu, one: &Scene, other: &Scene, rays: &R) {
    let first = [one, other].map(|scene| trace_with(engine, scene, rays, First, &()).unwrap());
    let any = [one, other].map(|scene| trace_with(engine, scene, rays, Any, &()).unwrap());
    let counts = [one, other].map(|scene| trace_with(engine, scene, rays, Count, &()).unwrap());
    let all =
        [one, other].map(|scene| trace_with(engine, scene, rays, All::default(), &()).unwrap());
    let mut met = 0;
    for k in 0..rays.len() {
        let [hit, expected] = first.each_ref().map(|hits| bits(&hits.get(k)));
        assert_eq!(hit, expected, "{k}");
        met += usize::from(!first[0].get(k).is_miss());
    }
    assert!(met > rays.len() / 32, "{met} of {}", rays.len());
    assert_eq!(any[0], any[1]);
    assert_eq!(counts[0], counts[1]);
    assert_eq!(all[0].offsets, all[1].offsets);
    for k in 0..all[0].offsets[rays.len()] {
        let [hit, expected] = all.each_ref().map(|all| bits(&all.hits.get(k)));
        assert_eq!(hit, expected, "crossing {k}");
    }
}

#[test]
fn a_mapped_scene_is_met_as_the_one_that_was_saved() {
    let folder = Folder::new("met");
    let path = folder.path("a.fhs");
    let mut built = Scene::new(objects()).unwrap();
    fhs::save(&path, &built, &World::default(), &()).unwrap();
    let mut opened = fhs::open(&path, false).unwrap().into_scene().unwrap();
    let mesh = opened.objects()[0].mesh().unwrap();
    assert!(matches!(&**mesh.positions(), Positions::Single(points) if points.is_shared()));
    // The file may be replaced and removed: what is open stays.
    fs::remove_file(&path).unwrap();
    assert_same(&opened, &built, 2000);
    for (k, object) in [(2, 0), (4, 3), (6, 9), (1, 14)] {
        let place = turned(0.3 * f64::from(k), DVec3::new(0.2, 0.1, -0.4));
        built.move_object(object, place).unwrap();
        opened.move_object(object, place).unwrap();
        assert_same(&opened, &built, 300);
    }
    // What moved is saved where it is.
    fhs::save(&path, &opened, &World::default(), &()).unwrap();
    let again = fhs::open(&path, true).unwrap().into_scene().unwrap();
    assert_eq!(again.bounds(), built.bounds());
    assert_same(&again, &Scene::new(built.objects().to_vec()).unwrap(), 300);
}

/// Objects that share a tree, all of them and after some have left.
#[test]
fn joined_objects_are_opened_as_they_were_saved() {
    let folder = Folder::new("joined");
    let path = folder.path("a.fhs");
    for seed in 0..3 {
        let mut built = Scene::new(pieces(seed)).unwrap();
        for step in 0..3 {
            fhs::save(&path, &built, &World::default(), &()).unwrap();
            let mut opened = fhs::open(&path, true).unwrap().into_scene().unwrap();
            if step == 0 {
                assert_eq!(opened.tree_bytes(), built.tree_bytes());
            }
            assert_same(&opened, &built, 500);
            for object in [step, 2 * step + 3] {
                let place = turned(0.3, DVec3::new(0.2, 0.1, -0.4));
                built.move_object(object, place).unwrap();
                opened.move_object(object, place).unwrap();
            }
            assert_same(&opened, &built, 500);
        }
    }
}

/// Whoever opens the file may shoot any number of rays.
#[test]
fn what_is_saved_has_the_best_trees() {
    let (points, triangles) = bumpy_sphere(40, 3);
    let objects = vec![Object::new(mesh(&points, triangles))];
    let built = |build| {
        let settings = BuildSettings { build, rays: None };
        Scene::build(objects.clone(), settings).unwrap()
    };
    let [fast, best] = [Build::Fast, Build::Best].map(built);
    assert_ne!(fast.tree_bytes(), best.tree_bytes());
    let encoded = |scene| fhs::encode(scene, &World::default(), &()).unwrap();
    assert!(encoded(&fast) == encoded(&best));
    // What comes of a scene goes on as it was.
    let same = fast.with_objects(objects.clone()).unwrap();
    assert_eq!(same.tree_bytes(), fast.tree_bytes());
}

/// A tree of a mapped mesh is fitted to other vertices as a built one is.
#[test]
fn a_mapped_tree_is_refitted() {
    let folder = Folder::new("refitted");
    let path = folder.path("a.fhs");
    let (points, triangles) = bumpy_sphere(24, 12);
    let built = Scene::new(vec![Object::new(mesh(&points, triangles.clone()))]).unwrap();
    fhs::save(&path, &built, &World::default(), &()).unwrap();
    let opened = fhs::open(&path, false).unwrap().into_scene().unwrap();
    let moved: Vec<DVec3> = points.iter().map(|p| 1.01 * *p + DVec3::X).collect();
    let moved = vec![Object::new(mesh(&moved, triangles))];
    let [one, other] = [opened, built].map(|scene| scene.with_objects(moved.clone()).unwrap());
    assert_eq!(one.tree_bytes(), other.tree_bytes());
    assert_same(&one, &other, 500);
}

#[test]
fn a_scene_file_names_built_scenes_of_many_objects_and_packed_ones() {
    let folder = Folder::new("many");
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let scene = Scene::new(vec![ball; 60_000]).unwrap();
    let path = folder.path("many.fhs");
    fhs::save(&path, &scene, &World::default(), &()).unwrap();
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, &fs::read(&path).unwrap()).unwrap();
    fs::write(folder.path("many.fhs.gz"), packed.finish().unwrap()).unwrap();
    for name in ["many.fhs", "many.fhs.gz"] {
        let path = folder.path("scene.toml");
        fs::write(&path, format!("[[objects]]\nfile = '{name}'\n")).unwrap();
        let loaded = load(&path, &LoadSettings::default()).unwrap();
        assert_eq!(loaded.world.objects.len(), 60_000, "{name}");
    }
}
