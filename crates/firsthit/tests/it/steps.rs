//! Long work tells of its steps, and ends when it is asked to.

use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use firsthit::error::{Error, Result};
use firsthit::fhs;
use firsthit::lint::{LintSettings, lint};
use firsthit::load::{LoadSettings, load_watched};
use firsthit::scene::BuildSettings;
use firsthit::section::{SectionPlane, section};
use firsthit::watch::Watch;
use firsthit::world::World;
use firsthit::{DVec3, Object, Scene, Transform};
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::support::{bumpy_sphere, mesh};

/// Keeps each step with its total and what was done of it, and stops at some of the questions
/// whether to.
#[derive(Default)]
struct Kept {
    steps: Mutex<Vec<(String, u64, u64)>>,
    questions: AtomicUsize,
    /// The questions that came when the last step was done.
    late_questions: AtomicUsize,
    stops: Range<usize>,
}

impl Watch for Kept {
    fn begin(&self, step: &str, total: u64, _: &'static str) {
        self.steps.lock().unwrap().push((step.to_owned(), total, 0));
    }

    fn advance(&self, count: u64) {
        let mut steps = self.steps.lock().unwrap();
        let (step, total, done) = steps.last_mut().expect("a step has begun");
        *done += count;
        assert!(done <= total, "{step}: {done} of {total}");
    }

    fn is_stopped(&self) -> bool {
        let steps = self.steps.lock().unwrap();
        let is_late = steps.last().is_some_and(|(_, total, done)| done == total);
        self.late_questions.fetch_add(usize::from(is_late), Relaxed);
        let question = self.questions.fetch_add(1, Relaxed);
        self.stops.contains(&question)
    }
}

fn ball() -> Vec<Object> {
    let (points, triangles) = bumpy_sphere(80, 3);
    vec![Object::new(mesh(&points, triangles))]
}

fn built(watch: &dyn Watch) -> Result<Scene> {
    Scene::build_watched(ball(), BuildSettings::default(), watch)
}

/// The steps of some work, each of which must be done to its end, and which must end where it is
/// stopped.
fn steps<T: Send>(work: impl Fn(&dyn Watch) -> Result<T> + Sync) -> Vec<String> {
    // By one thread, so that there are as many questions each time.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let work = |watch: &Kept| pool.install(|| work(watch));
    let whole = Kept::default();
    work(&whole).unwrap();
    let told = whole.steps.into_inner().unwrap();
    for (step, total, done) in &told {
        assert_eq!(done, total, "{step}");
    }
    let questions = whole.questions.into_inner();
    assert!(questions > 0, "{told:?}");
    for at in (0..questions).step_by(questions.div_ceil(40)).chain([questions - 1]) {
        let stopping = Kept { stops: at..usize::MAX, ..Kept::default() };
        let ended = work(&stopping);
        assert!(matches!(ended, Err(Error::Interrupted)), "question {at}");
    }
    told.into_iter().map(|(step, ..)| step).collect()
}

/// The ball as files that are text, by their extensions.
fn texts(points: &[DVec3], triangles: &[[u32; 3]]) -> [(&'static str, String); 4] {
    let lines = |start: &str| -> String {
        let line = |p: &DVec3| format!("{start}{} {} {}\n", p.x, p.y, p.z);
        points.iter().map(line).collect()
    };
    let faces = |start: &str, first: u32| -> String {
        let face =
            |[a, b, c]: &[u32; 3]| format!("{start}{} {} {}\n", a + first, b + first, c + first);
        triangles.iter().map(face).collect()
    };
    let (p, t) = (points.len(), triangles.len());
    let corner = |k: &u32| {
        let p = points[*k as usize];
        format!("vertex {} {} {}\n", p.x, p.y, p.z)
    };
    let facet = |corners: &[u32; 3]| {
        let corners: String = corners.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let facets: String = triangles.iter().map(facet).collect();
    let off = format!("OFF\n{p} {t} 0\n");
    [
        ("obj", lines("v ") + &faces("f ", 1)),
        ("ply", ply("ascii", p, t) + &lines("") + &faces("3 ", 0)),
        ("off", off + &lines("") + &faces("3 ", 0)),
        ("stl", format!("solid ball\n{facets}endsolid ball\n")),
    ]
}

fn ply(format: &str, vertices: usize, faces: usize) -> String {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    format!(
        "ply\nformat {format} 1.0\nelement vertex {vertices}\n{xyz}\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

/// The document of a glTF file with these buffers, of positions and then triangles.
fn gltf(buffer: &str, vertices: usize, triangles: usize) -> String {
    let [places, corners] = [12 * vertices, 12 * triangles];
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": {vertices}, "type": "VEC3",
              "min": [-9, -9, -9], "max": [9, 9, 9]}},
            {{"bufferView": 1, "componentType": 5125, "count": {}, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": {places}}},
            {{"buffer": 0, "byteOffset": {places}, "byteLength": {corners}}}],
        "buffers": [{{{buffer}"byteLength": {}}}]}}"#,
        3 * triangles,
        places + corners
    )
}

fn glb(document: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = document.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8; 4], content: &[u8]| {
        let length = u32::try_from(content.len()).unwrap().to_le_bytes();
        [&length[..], kind, content].concat()
    };
    let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", binary)].concat();
    let length = u32::try_from(12 + chunks.len()).unwrap().to_le_bytes();
    [b"glTF".as_slice(), &[2, 0, 0, 0], &length, &chunks].concat()
}

/// Writes the ball as files of all formats, and one that names some of them.
fn write_files(folder: &Path) {
    let [object] = &ball()[..] else { panic!() };
    let mesh = object.mesh().unwrap();
    let count = u32::try_from(mesh.positions().len()).unwrap();
    let points: Vec<DVec3> = (0..count).map(|k| mesh.positions().get(k)).collect();
    let triangles = mesh.triangles();
    let write = |name: &str, content: &[u8]| fs::write(folder.join(name), content).unwrap();
    for (extension, text) in texts(&points, triangles) {
        write(&format!("ball.{extension}"), text.as_bytes());
    }
    let (p, t) = (points.len(), triangles.len());
    let bytes = |point: &DVec3| point.as_vec3().to_array().map(f32::to_le_bytes).concat();
    let places: Vec<u8> = points.iter().flat_map(bytes).collect();
    let corners = |corners: &[u32; 3]| corners.map(u32::to_le_bytes).concat();
    let corners_of_all: Vec<u8> = triangles.iter().flat_map(corners).collect();
    let binary = [places.clone(), corners_of_all].concat();
    write("ball.bin", &binary);
    let named = gltf(r#""uri": "ball.bin", "#, p, t);
    write("ball.gltf", named.as_bytes());
    write("ball.glb", &glb(&gltf("", p, t), &binary));
    let face = |face: &[u32; 3]| [&[3][..], &corners(face)].concat();
    let faces: Vec<u8> = triangles.iter().flat_map(face).collect();
    let header = ply("binary_little_endian", p, t);
    write("packed.ply", &[header.as_bytes(), &places, &faces].concat());
    let facet = |corners: &[u32; 3]| {
        let corners = corners.map(|k| bytes(&points[k as usize])).concat();
        [&[0; 12][..], &corners, &[0; 2]].concat()
    };
    let facets: Vec<u8> = triangles.iter().flat_map(facet).collect();
    let count = u32::try_from(t).unwrap().to_le_bytes();
    write("packed.stl", &[&[0; 80][..], &count, &facets].concat());
    let fhs = fhs::encode(&built(&()).unwrap(), &World::default(), &()).unwrap();
    write("ball.fhs", &fhs);
    for name in ["ball.obj", "ball.fhs"] {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        let content = fs::read(folder.join(name)).unwrap();
        encoder.write_all(&content).unwrap();
        write(&format!("{name}.gz"), &encoder.finish().unwrap());
    }
    let sky = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x80\x80\x80\x80\x80";
    write("sky.hdr", sky);
    let parts = ["ball.ply", "ball.fhs", "ball.fhs.gz"];
    let objects = parts.map(|name| format!("[[objects]]\nfile = \"{name}\"\n"));
    let scene = format!("[environment]\nfile = \"sky.hdr\"\n{}", objects.concat());
    write("scene.toml", scene.as_bytes());
}

#[test]
fn files_are_read_and_parsed_to_their_ends_or_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    write_files(&folder);
    let read: &[&str] = &["reading ", "parsing "];
    for (name, expected) in [
        ("ball.obj", read),
        ("ball.ply", read),
        ("ball.off", read),
        ("ball.stl", read),
        ("packed.ply", read),
        ("packed.stl", read),
        ("ball.glb", read),
        ("ball.gltf", &["reading ", "parsing ", "parsing buffers of "]),
        ("ball.obj.gz", read),
        ("ball.fhs", &["opening "]),
        ("ball.fhs.gz", &["reading ", "parsing ", "opening "]),
    ] {
        let path = folder.join(name);
        let told = steps(|watch| load_watched(&path, &LoadSettings::default(), watch));
        let name = path.display();
        let expected = expected.iter().map(|step| format!("{step}{name}"));
        assert_eq!(told, expected.collect::<Vec<_>>());
    }
    let path = folder.join("scene.toml");
    let told = steps(|watch| load_watched(&path, &LoadSettings::default(), watch));
    let names = told.iter().map(|step| step.replace(&format!("{}/", folder.display()), ""));
    let expected = [
        "reading scene.toml",
        "parsing scene.toml",
        "reading sky.hdr",
        "reading ball.ply",
        "parsing ball.ply",
        "opening ball.fhs",
        "reading ball.fhs.gz",
        "parsing ball.fhs.gz",
        "opening ball.fhs.gz",
    ];
    assert_eq!(names.collect::<Vec<_>>(), expected);
}

#[test]
fn trees_are_built_of_every_triangle_or_stopped() {
    assert_eq!(steps(built), ["building trees"]);
    let scene = built(&()).unwrap();
    // What is there is not built again.
    let same = Kept::default();
    scene.with_objects_watched(scene.objects().to_vec(), &same).unwrap();
    assert!(same.steps.into_inner().unwrap().is_empty());
}

/// The ball with its points moved by `place`.
fn other_ball(place: impl Fn(DVec3) -> DVec3) -> Object {
    let (points, triangles) = bumpy_sphere(80, 3);
    let points: Vec<DVec3> = points.into_iter().map(place).collect();
    Object::new(mesh(&points, triangles))
}

#[test]
fn trees_that_are_fitted_are_told_of_with_those_that_are_built() {
    let scene = built(&()).unwrap();
    let objects = [|p: DVec3| 1.01 * p, |p: DVec3| p + 3.0 * DVec3::X].map(other_ball);
    let change = |watch: &dyn Watch| scene.with_objects_watched(objects.to_vec(), watch);
    assert_eq!(steps(change), ["building trees"]);
}

/// Two balls, and a triangle of the first one so often that no leaf has room for all: what is built
/// of the three is built again of two.
fn joined(watch: &dyn Watch) -> Result<Scene> {
    let (points, triangles) = bumpy_sphere(80, 3);
    let often = Object::new(mesh(&points, vec![triangles[0]; 40]));
    let objects = vec![other_ball(|p| p), other_ball(|p| 2.0 * p), often];
    Scene::build_watched(objects, BuildSettings::default(), watch)
}

#[test]
fn objects_that_join_and_part_are_told_of_once_or_stay_as_they_were() {
    assert_eq!(steps(joined), ["building trees"]);
    let scene = joined(&()).unwrap();
    let [group] = scene.groups().collect::<Vec<_>>()[..] else { panic!() };
    let members: Vec<u32> = group.members().map(|(object, _)| object).collect();
    assert_eq!(members, [0, 1]);
    let change = |scene: &Scene, change: &dyn Fn(&mut Scene) -> Result<()>| {
        let mut changed = scene.clone();
        let ended = change(&mut changed);
        assert_eq!(ended.is_err(), changed.objects() == scene.objects());
        ended
    };
    let away = Transform::translation(DVec3::X).unwrap();
    let moved =
        steps(|watch| change(&scene, &|scene| scene.move_objects_watched(&[(1, away)], watch)));
    assert_eq!(moved, ["building trees"]);
    let mut hidden = scene.clone();
    hidden.hide_objects(&[(1, true)]).unwrap();
    let shown =
        steps(|watch| change(&hidden, &|scene| scene.hide_objects_watched(&[(1, false)], watch)));
    assert_eq!(shown, ["building trees"]);
}

#[test]
fn objects_whose_joining_is_stopped_are_not_built_one_by_one() {
    let watch = Kept { stops: 2..3, ..Kept::default() };
    assert!(matches!(joined(&watch), Err(Error::Interrupted)));
}

#[test]
fn built_scenes_are_written_and_opened_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let (path, scene) = (folder.path().join("ball.fhs"), built(&()).unwrap());
    let name = path.display();
    let save = |watch: &dyn Watch| {
        let saved = fhs::save(&path, &scene, &World::default(), watch);
        assert_eq!(saved.is_ok(), path.exists());
        if saved.is_ok() {
            fs::remove_file(&path).unwrap();
        }
        assert!(fs::read_dir(folder.path()).unwrap().next().is_none());
        saved
    };
    let both =
        |name: &str| ["computing checksums of", "writing"].map(|step| format!("{step} {name}"));
    assert_eq!(steps(save), both(&name.to_string()));
    let encode = |watch: &dyn Watch| fhs::encode(&scene, &World::default(), watch);
    assert_eq!(steps(encode), both("the scene"));
    fhs::save(&path, &scene, &World::default(), &()).unwrap();
    let told = steps(|watch| fhs::open_watched(&path, true, watch));
    let [compared, opened] = &told[..] else { panic!("{told:?}") };
    assert_eq!(*compared, format!("comparing checksums of {name}"));
    assert_eq!(*opened, format!("opening {name}"));
}

#[test]
fn checks_and_cuts_are_followed_to_their_ends_or_stopped() {
    let scene = joined(&()).unwrap();
    let settings = LintSettings::default();
    let told = steps(|watch| lint(&scene, &settings, watch));
    assert_eq!(told, ["checking meshes"]);
    let watch = Kept::default();
    lint(&scene, &settings, &watch).unwrap();
    assert_eq!(watch.late_questions.into_inner(), 0);
    let plane = SectionPlane::new(DVec3::ZERO, DVec3::Z).unwrap();
    assert_eq!(steps(|watch| section(&scene, plane, watch)), ["cutting"]);
}
