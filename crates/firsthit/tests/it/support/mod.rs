//! Helpers of several tests: reproducible numbers, closed meshes, the reference data, and the
//! judge's words.

pub(crate) mod generators;
pub(crate) mod npz;
pub(crate) mod rational;

use std::ops::{Add, Div, Range};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use firsthit::explain::{ExplainSettings, Explanation, explain};
use firsthit::lint::{LintSettings, Report, lint};
use firsthit::section::{Section, SectionPlane, section};
use firsthit::shoot::{BruteForce, Cpu, Engine};
use firsthit::{Camera, DVec2, DVec3, Hit, Mesh, Object, Positions, Ray, Result, Scene};

/// Does `work` in a pool of so many threads.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap().install(work)
}

/// Questions to a scene with the settings that most tests have.
pub(crate) trait Ask {
    fn explain(&self, ray: &Ray) -> Result<Explanation<'_>>;
    fn lint(&self) -> Result<Report>;
    fn section(&self, origin: DVec3, normal: DVec3) -> Result<Section>;
}

impl Ask for Scene {
    fn explain(&self, ray: &Ray) -> Result<Explanation<'_>> {
        explain(self, ray, &ExplainSettings::default(), &())
    }

    fn lint(&self) -> Result<Report> {
        lint(self, &LintSettings::default(), &())
    }

    fn section(&self, origin: DVec3, normal: DVec3) -> Result<Section> {
        section(self, SectionPlane::new(origin, normal)?, &())
    }
}

/// Reproducible numbers (a linear congruential generator of Knuth's).
pub(crate) struct Numbers(u64);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        let mut numbers = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        numbers.unit();
        numbers
    }

    /// From 0 up to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    /// In the cube from -1 to 1.
    pub(crate) fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

pub(crate) fn mesh(points: &[DVec3], triangles: Vec<[u32; 3]>) -> Arc<Mesh> {
    let points = points.iter().map(DVec3::to_array).collect();
    Arc::new(Mesh::new(Positions::compact(points), triangles).unwrap())
}

/// A closed mesh around the origin, star-shaped: a sphere of `rings` times `2 * rings` patches with
/// bumps.
pub(crate) fn bumpy_sphere(rings: u32, seed: u64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut numbers = Numbers::new(seed);
    let around = 2 * rings;
    let mut points = vec![DVec3::Z, DVec3::NEG_Z];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for k in 0..around {
            let turn = std::f64::consts::TAU * f64::from(k) / f64::from(around);
            let direction = DVec3::new(
                libm::sin(polar) * libm::cos(turn),
                libm::sin(polar) * libm::sin(turn),
                libm::cos(polar),
            );
            // Rounded to float32, as most files are.
            points.push((direction * (0.7 + 0.6 * numbers.unit())).as_vec3().as_dvec3());
        }
    }
    let at = |ring: u32, k: u32| 2 + (ring - 1) * around + k % around;
    let mut triangles = Vec::new();
    for k in 0..around {
        triangles.push([0, at(1, k), at(1, k + 1)]);
        triangles.push([1, at(rings - 1, k + 1), at(rings - 1, k)]);
        for ring in 1..rings - 1 {
            let [a, b, c, d] = [at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (points, triangles)
}

/// Random tests take one of so many cases, unless `FIRSTHIT_TEST` is `full` (`make test-full`). It
/// has no factor in common with the numbers of kinds that rounds have by turns: where there are so
/// many rounds for each kind, all kinds remain. Others take all rounds.
const FEWER: u8 = 7;

/// Whether random tests take all cases.
///
/// # Panics
///
/// Where `FIRSTHIT_TEST` says something else: nobody shall take a part of the tests for all.
pub(crate) fn is_full() -> bool {
    match std::env::var("FIRSTHIT_TEST").as_deref() {
        Ok("full") => true,
        Err(_) | Ok("") => false,
        Ok(other) => panic!("FIRSTHIT_TEST must be full or not be set, got {other}"),
    }
}

/// A seventh of `all`, rounded up, or `all` for `make test-full`: how many cases a test takes, and
/// how many answers of a kind they must give.
pub(crate) fn cases<N: From<u8> + Add<Output = N> + Div<Output = N>>(all: N) -> N {
    let share = if is_full() { 1 } else { FEWER };
    (all + N::from(share - 1)) / N::from(share)
}

/// The rounds of a test that has `all`, each with its own seed.
pub(crate) fn rounds<N>(all: N) -> std::iter::StepBy<Range<N>>
where
    N: From<u8>,
    Range<N>: Iterator,
{
    (N::from(0)..all).step_by(if is_full() { 1 } else { FEWER.into() })
}

/// The reference data beside the clone. Tests that use it are ignored unless `make test` finds it.
///
/// # Panics
///
/// Without it: a test that was asked for must not pass unseen.
pub(crate) fn refdata() -> PathBuf {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/refdata/public");
    assert!(path.is_dir(), "needs ../shared/refdata beside the clone");
    path
}

/// How many rays a soak shoots: `FIRSTHIT_SOAK`, see the Makefile.
pub(crate) fn soak_rays() -> usize {
    let rays = std::env::var("FIRSTHIT_SOAK").map_or(1_000_000, |text| text.parse().unwrap());
    assert!(rays > 0, "a soak without rays");
    rays
}

/// The faces of a box whose corner `k` has the upper x, y and z where the bits 0, 1 and 2 of `k`
/// are set.
pub(crate) const CUBE: [[u32; 3]; 12] = [
    [0, 3, 1],
    [0, 2, 3],
    [0, 1, 5],
    [0, 5, 4],
    [1, 3, 7],
    [1, 7, 5],
    [3, 2, 6],
    [3, 6, 7],
    [2, 0, 4],
    [2, 4, 6],
    [4, 5, 7],
    [4, 7, 6],
];

pub(crate) fn scene(objects: Vec<Object>) -> Scene {
    Scene::new(objects).unwrap()
}

/// The bits of a hit: those of equal hits are equal.
pub(crate) fn bits(hit: &Hit) -> (u64, i32, i32, [u64; 2]) {
    (hit.t.to_bits(), hit.object, hit.primitive, hit.barycentric.to_array().map(f64::to_bits))
}

/// The hit that trees and brute force agree about.
pub(crate) fn agree(scene: &Scene, ray: &Ray) -> Hit {
    let (fast, judge) = (Cpu::default().first_hit(scene, ray), BruteForce.first_hit(scene, ray));
    assert_eq!(bits(&fast), bits(&judge), "{ray:?}: {fast:?}, the judge says {judge:?}");
    assert_eq!(Cpu::default().any_hit(scene, ray), !judge.is_miss(), "{ray:?}");
    judge
}

/// Random rays, rays at corners and edges, rays along the axes through corners.
pub(crate) fn rays(points: &[DVec3], count: usize, seed: u64) -> Vec<Ray> {
    let mut numbers = Numbers::new(seed);
    (0..count)
        .map(|k| {
            let [a, b] = [0, 1].map(|_| points[numbers.below(points.len())]);
            let origin = 3.0 * numbers.point();
            let axis = [DVec3::X, DVec3::NEG_Y, DVec3::Z][k / 5 % 3];
            match k % 5 {
                0 => Ray::new(origin, numbers.point()),
                1 => Ray::new(origin, a - origin),
                2 => Ray::new(origin, a.lerp(b, numbers.unit()) - origin),
                3 => Ray::new(a - 2.0 * axis, axis),
                _ => Ray::new(a, numbers.point()).up_to(numbers.unit()),
            }
        })
        .collect()
}

/// Where a point is in the picture: from -1 at the left and the lower edge to 1 at the right and
/// the upper one.
pub(crate) fn seen(camera: &Camera, point: DVec3) -> DVec2 {
    let view = camera.view();
    let v = point - camera.position();
    let depth = v.dot(camera.aim());
    assert!(depth > 0.0, "{point} is behind the camera");
    let scale = if view.lens.viewplane().unwrap().parallel {
        1.0
    } else {
        view.lens.viewplane().unwrap().focal_length / depth
    };
    let size =
        DVec2::new(view.lens.viewplane().unwrap().width, view.lens.viewplane().unwrap().height);
    2.0 * scale * DVec2::new(v.dot(camera.right()), v.dot(camera.upwards())) / size
}
