//! Files that other programs packed: meshoptimizer's encoder and Google's Draco encoder, see
//! testdata/README.

use std::collections::HashSet;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use firsthit::load::{LoadSettings, Loaded, load, load_bytes};
use firsthit::{DVec2, DVec3, Mesh};

use super::builder::points;

/// Sections of the torus and corners of each.
const AROUND: [u32; 2] = [12, 8];

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata").join(name)
}

fn torus(name: &str) -> Loaded {
    let model = load(&file(name), &LoadSettings::default()).unwrap();
    assert_eq!(model.warnings, [""; 0]);
    model
}

/// The vertices as they were packed: place, normal, texture coordinates.
fn vertices() -> Vec<(DVec3, DVec3, DVec2)> {
    let [sections, corners] = AROUND;
    let all = (0..=sections).flat_map(|i| (0..=corners).map(move |j| (i, j)));
    all.map(|(i, j)| {
        let [u, v] = [f64::from(i) / f64::from(sections), f64::from(j) / f64::from(corners)];
        let (along, out) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        let normal = DVec3::new(out.1 * along.1, out.1 * along.0, out.0);
        let ring = 2.0 * DVec3::new(along.1, along.0, 0.0);
        (ring + 0.5 * normal, normal, DVec2::new(u, v))
    })
    .collect()
}

fn triangles() -> Vec<[u32; 3]> {
    let [sections, corners] = AROUND;
    let all = (0..sections).flat_map(|i| (0..corners).map(move |j| (i, j)));
    all.flat_map(|(i, j)| {
        let a = i * (corners + 1) + j;
        let b = a + corners + 1;
        [[a, b, b + 1], [a, b + 1, a + 1]]
    })
    .collect()
}

/// A triangle from its lowest corner on: what the packed order may begin with is open.
fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    let lowest = a.min(b).min(c);
    if lowest == a {
        [a, b, c]
    } else if lowest == b {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Checks the attributes of a mesh whose vertices are in the packed order.
fn check(mesh: &Mesh, normals: f64, uvs: f64) {
    let expected = vertices();
    assert_eq!(mesh.positions().len(), expected.len());
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
    for (k, triangle) in mesh.triangles().iter().enumerate() {
        for (&vertex, barycentric) in triangle.iter().zip(corners) {
            let (_, normal, uv) = expected[vertex as usize];
            let got = mesh.shading_normal(k, barycentric).unwrap();
            assert!((got - normal).length() < normals, "{vertex}: {got}, not {normal}");
            let got = mesh.uv(k, barycentric).unwrap();
            assert!((got - uv).length() < uvs, "{vertex}: {got}, not {uv}");
        }
    }
}

#[test]
fn meshopt_streams_unpack_to_what_was_packed() {
    let model = torus("torus_meshopt.glb");
    // Octahedral normals of 8 and of 12 bits; texture coordinates of 15 bits of mantissa.
    for (object, tolerance) in [(0, 0.03), (1, 0.002)] {
        let mesh = model.world.objects[object].mesh().unwrap();
        check(mesh, tolerance, 1e-4);
        for ((place, ..), k) in vertices().into_iter().zip(0..) {
            let got = mesh.positions().get(k);
            assert!((got - place).length() < 1e-6, "{got}, not {place}");
        }
        let got: Vec<_> = mesh.triangles().iter().copied().map(turned).collect();
        let expected: Vec<_> = triangles().into_iter().map(turned).collect();
        assert_eq!(got, expected);
    }
}

/// Turned about z by 30 degrees more each.
#[test]
fn packed_quaternions_turn_instances() {
    let model = torus("torus_meshopt.glb");
    let instances = &model.world.objects[2..];
    assert_eq!(instances.len(), 4);
    for (k, instance) in (0..).zip(instances) {
        let angle = f64::from(k) * TAU / 12.0;
        let place = instance.transform().world_from_object();
        let expected = DVec3::new(angle.cos(), angle.sin(), 0.0);
        assert!((place.transform_vector3(DVec3::X) - expected).length() < 1e-3, "{k}");
        assert_eq!(place.translation, DVec3::new(0.0, 6.0 + 2.0 * f64::from(k), 0.0));
    }
}

/// Four ways to pack float32, and one of int16; the colours are those of `u` and `v`.
#[test]
fn the_newer_meshopt_stream_is_read_too() {
    let model = torus("torus_meshopt_v1.glb");
    assert_eq!(model.world.objects.len(), 5);
    for (object, (tolerance, x)) in
        [(1e-6, 0.0), (1e-6, 6.0), (1e-6, 12.0), (1e-6, 18.0), (1e-4, 0.0)].into_iter().enumerate()
    {
        let moved = DVec3::new(x, 0.0, 0.0);
        for (got, (place, ..)) in points(&model, object).into_iter().zip(vertices()) {
            assert!((got - moved - place).length() < tolerance, "{object}: {got}, not {place}");
        }
        let mesh = model.world.objects[object].mesh().unwrap();
        for (k, &[first, ..]) in mesh.triangles().iter().enumerate() {
            let (_, _, uv) = vertices()[first as usize];
            let color = mesh.color(k, DVec2::ZERO).unwrap();
            assert!((color - DVec3::new(uv.x, uv.y, 0.5)).length() < 0.03, "{color}, not {uv}");
        }
    }
}

/// Draco reorders vertices: each is looked up by its texture coordinates, which tell them apart.
#[test]
fn draco_meshes_unpack_to_what_was_packed() {
    for name in ["torus_draco.glb", "torus_draco_sequential.glb"] {
        let model = torus(name);
        let mesh = model.world.objects[0].mesh().unwrap();
        assert_eq!(mesh.triangles().len(), triangles().len(), "{name}");
        let mut met = HashSet::new();
        for k in 0..mesh.triangles().len() {
            for (corner, barycentric) in [DVec2::ZERO, DVec2::X, DVec2::Y].into_iter().enumerate() {
                let uv = mesh.uv(k, barycentric).unwrap();
                let near = vertices().into_iter().enumerate();
                let (index, (place, normal, _)) = near
                    .min_by(|a, b| (a.1.2 - uv).length().total_cmp(&(b.1.2 - uv).length()))
                    .unwrap();
                met.insert(index);
                assert!((mesh.corners(k)[corner] - place).length() < 1e-3, "{name}");
                assert!(
                    (mesh.shading_normal(k, barycentric).unwrap() - normal).length() < 0.02,
                    "{name}"
                );
                let color = mesh.color(k, barycentric).unwrap();
                assert!((color - DVec3::new(uv.x, uv.y, 0.5)).length() < 0.01, "{name}: {color}");
            }
            assert!(mesh.normal(k).is_finite());
        }
        assert_eq!(met.len(), vertices().len(), "{name}");
    }
}

/// Draws numbers for damage (a linear congruential generator of Knuth's).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, count: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }
}

#[test]
fn damaged_files_are_read_or_refused_in_moments() {
    let settings = LoadSettings { max_memory: 64 << 20, ..LoadSettings::default() };
    let mut numbers = Numbers(1);
    for name in [
        "torus_meshopt.glb",
        "torus_meshopt_v1.glb",
        "torus_draco.glb",
        "torus_draco_sequential.glb",
    ] {
        let whole = std::fs::read(file(name)).unwrap();
        let start = std::time::Instant::now();
        let mut refused = 0;
        for _ in 0..600 {
            let mut bytes = whole.clone();
            for _ in 0..=numbers.below(4) {
                let place = numbers.below(bytes.len());
                bytes[place] = numbers.below(256) as u8;
            }
            refused += usize::from(load_bytes(Path::new("a.glb"), &bytes, &settings).is_err());
        }
        assert!(refused > 0, "{name}");
        assert!(start.elapsed().as_secs() < 60, "{name}: {:?}", start.elapsed());
        for end in (0..whole.len()).step_by(11) {
            assert!(
                load_bytes(Path::new("a.glb"), &whole[..end], &settings).is_err(),
                "{name} {end}"
            );
        }
    }
}
