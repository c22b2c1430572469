//! Long work tells of its steps, and ends when it is asked to.

use std::fs;
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
use firsthit::{DVec3, Object, Scene};

use crate::support::{bumpy_sphere, mesh};

/// Keeps each step with its total and what was done of it, and stops at one of the questions whether to.
#[derive(Default)]
struct Kept {
    steps: Mutex<Vec<(String, u64, u64)>>,
    questions: AtomicUsize,
    stops_at: Option<usize>,
}

impl Watch for Kept {
    fn begin(&self, step: &str, total: u64, _: &'static str) {
        self.steps.lock().unwrap().push((step.to_owned(), total, 0));
    }

    fn advance(&self, count: u64) {
        let mut steps = self.steps.lock().unwrap();
        steps.last_mut().expect("a step has begun").2 += count;
    }

    fn is_stopped(&self) -> bool {
        let question = self.questions.fetch_add(1, Relaxed);
        self.stops_at.is_some_and(|at| question >= at)
    }
}

fn ball() -> Vec<Object> {
    let (points, triangles) = bumpy_sphere(80, 3);
    vec![Object::new(mesh(&points, triangles))]
}

fn built(watch: &dyn Watch) -> Result<Scene> {
    Scene::build_watched(ball(), BuildSettings::default(), watch)
}

/// The steps of some work, each of which must be done to its end, and which must end where it is stopped.
fn steps<T: Send>(work: impl Fn(&dyn Watch) -> Result<T> + Sync) -> Vec<String> {
    // By one thread, so that there are as many questions each time.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let work = |watch: &Kept| pool.install(|| work(watch));
    let whole = Kept::default();
    work(&whole).unwrap();
    let told = whole.steps.into_inner().unwrap();
    for (step, total, done) in &told {
        assert_eq!(done, total, "{step}");
    }
    let questions = whole.questions.into_inner();
    assert!(questions > 0);
    for at in (0..questions)
        .step_by(questions.div_ceil(40))
        .chain([questions - 1])
    {
        let stopping = Kept {
            stops_at: Some(at),
            ..Kept::default()
        };
        let ended = work(&stopping);
        assert!(matches!(ended, Err(Error::Interrupted)), "question {at}");
    }
    told.into_iter().map(|(step, ..)| step).collect()
}

/// The ball as a file of each format that is text, or has no other way to be told of.
fn files(folder: &Path) -> [std::path::PathBuf; 4] {
    let [object] = &ball()[..] else { panic!() };
    let mesh = object.mesh().unwrap();
    let count = u32::try_from(mesh.positions().len()).unwrap();
    let points: Vec<DVec3> = (0..count).map(|k| mesh.positions().get(k)).collect();
    let triangles = mesh.triangles();
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
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {p}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {t}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    let corner = |k: &u32| {
        let p = points[*k as usize];
        format!("vertex {} {} {}\n", p.x, p.y, p.z)
    };
    let facet = |corners: &[u32; 3]| {
        let corners: String = corners.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let facets: String = triangles.iter().map(facet).collect();
    let contents = [
        ("obj", lines("v ") + &faces("f ", 1)),
        ("ply", ply + &lines("") + &faces("3 ", 0)),
        (
            "off",
            format!("OFF\n{p} {t} 0\n") + &lines("") + &faces("3 ", 0),
        ),
        ("stl", format!("solid ball\n{facets}endsolid ball\n")),
    ];
    contents.map(|(extension, text)| {
        let path = folder.join("ball").with_extension(extension);
        fs::write(&path, text).unwrap();
        path
    })
}

#[test]
fn files_are_read_and_parsed_to_their_ends_or_stopped() {
    let folder = tempfile::tempdir().unwrap();
    for path in files(folder.path()) {
        let told = steps(|watch| load_watched(&path, &LoadSettings::default(), watch));
        let name = path.display();
        assert_eq!(told, [format!("reading {name}"), format!("parsing {name}")]);
    }
}

#[test]
fn trees_are_built_of_every_triangle_or_stopped() {
    assert_eq!(steps(built), ["building trees"]);
    let scene = built(&()).unwrap();
    // What is there is not built again.
    let same = Kept::default();
    scene
        .with_objects_watched(scene.objects().to_vec(), &same)
        .unwrap();
    assert!(same.steps.into_inner().unwrap().is_empty());
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
    assert_eq!(steps(save), [format!("writing {name}")]);
    fhs::save(&path, &scene, &World::default(), &()).unwrap();
    let told = steps(|watch| fhs::open_watched(&path, true, watch));
    let [compared, opened] = &told[..] else {
        panic!("{told:?}")
    };
    assert_eq!(*compared, format!("comparing checksums of {name}"));
    assert_eq!(*opened, format!("opening {name}"));
}

#[test]
fn checks_and_cuts_are_followed_to_their_ends_or_stopped() {
    let scene = built(&()).unwrap();
    let told = steps(|watch| lint(&scene, &LintSettings::default(), watch));
    assert_eq!(told, ["checking meshes"]);
    let plane = SectionPlane::new(DVec3::ZERO, DVec3::Z).unwrap();
    assert_eq!(steps(|watch| section(&scene, plane, watch)), ["cutting"]);
}
