//! Attributes where rays met meshes: against rational arithmetic, closed forms, and files whose
//! numbers are known.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use firsthit::channel::{attribute, attributes};
use firsthit::load::{LoadSettings, load_bytes};
use firsthit::shape::{Attribute, Between, Property, PropertyOf, PropertyValues};
use firsthit::shoot::{First, Hits, trace};
use firsthit::watch::Watch;
use firsthit::{
    DAffine3, DVec3, Error, Mesh, Object, Positions, Ray, Scene, Sphere, Transform, fhs,
};
use num_traits::Signed;

use crate::support::rational::number;
use crate::support::{Numbers, bumpy_sphere, mesh, on_threads, rays, scene};

fn doubles(values: impl IntoIterator<Item = f64>) -> PropertyValues {
    PropertyValues::Double(values.into_iter().collect())
}

fn shot(scene: &Scene, rays: &[Ray]) -> Hits {
    trace(scene, rays, First, &()).unwrap()
}

/// The numbers of an attribute, and how many each hit has.
fn values(scene: &Scene, hits: &Hits, name: &str, of: Option<PropertyOf>) -> (usize, Vec<f64>) {
    let made = attribute(name, of, scene, hits, &()).unwrap();
    assert_eq!(made.values.len(), hits.len() * made.components);
    (made.components, made.values)
}

/// A star-shaped mesh whose numbers are of many sizes, twice in a scene, with a ball; and rays that
/// meet its corners and edges too.
fn many() -> (Scene, Vec<Ray>, Vec<f64>, Vec<f64>) {
    let (points, triangles) = bumpy_sphere(12, 4);
    let mut numbers = Numbers::new(31);
    let mut any = |count: usize| -> Vec<f64> {
        let any = |_| (numbers.unit() - 0.5) * (1_u64 << numbers.below(60)) as f64;
        (0..count).map(any).collect()
    };
    let (heat, tints) = (any(points.len()), any(6 * triangles.len()));
    let faces = triangles.len();
    let star = Arc::unwrap_or_clone(mesh(&points, triangles));
    let properties = vec![
        Property::new("heat", PropertyOf::Vertices, doubles(heat.clone())),
        Property {
            between: Between::NearestCorner,
            ..Property::new(
                "place",
                PropertyOf::Vertices,
                doubles((0..points.len()).map(|k| k as f64)),
            )
        },
        Property {
            components: 2,
            ..Property::new("tint", PropertyOf::Corners, doubles(tints.clone()))
        },
        Property::new("heat", PropertyOf::Faces, doubles((0..faces).map(|k| 7.0 * k as f64))),
    ];
    let star = Arc::new(star.with_properties(properties).unwrap());
    let turn = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.5, 2.0, -1.0),
        firsthit::DQuat::from_rotation_x(0.7),
        DVec3::new(0.0, 0.0, 3.0),
    );
    let scene = scene(vec![
        Object::new(Arc::clone(&star)),
        Object::new(star).placed(Transform::new(turn).unwrap()),
        Object::new(Sphere::new(DVec3::new(2.0, 0.0, 0.0), 0.5).unwrap()),
    ]);
    let rays = rays(&points, 12_000, 5);
    (scene, rays, heat, tints)
}

/// More rays than one thread takes at a time. A rounded sum of three rounded products is off by
/// less than 3 * 2^-53 of the sum of the products' sizes (Higham 2002, section 3.1), and the first
/// weight is exact to 2^-53 of one.
#[test]
fn interpolated_numbers_are_those_of_rational_arithmetic() {
    let (scene, rays, heat, tints) = many();
    let hits = shot(&scene, &rays);
    let (one, found) = values(&scene, &hits, "heat", None);
    let (two, pairs) = values(&scene, &hits, "tint", None);
    assert_eq!((one, two), (1, 2));
    let star = scene.objects()[0].mesh().unwrap();
    let (mut met, mut missed) = (0, 0);
    for k in 0..hits.len() {
        let hit = hits.get(k);
        if hit.is_miss() || hit.object == 2 {
            assert!(found[k].is_nan() && pairs[2 * k].is_nan() && pairs[2 * k + 1].is_nan());
            missed += 1;
            continue;
        }
        met += 1;
        let triangle = hit.primitive as usize;
        let vertices = star.triangles()[triangle].map(|vertex| heat[vertex as usize]);
        let corner = |n: usize| [0, 1, 2].map(|corner| tints[2 * (3 * triangle + corner) + n]);
        let judged =
            [(found[k], vertices), (pairs[2 * k], corner(0)), (pairs[2 * k + 1], corner(1))];
        let [b, c] = hit.barycentric.to_array().map(number);
        let weights = [number(1.0) - &b - &c, b, c];
        for (got, values) in judged {
            let terms = values.iter().zip(&weights).map(|(&value, weight)| number(value) * weight);
            let terms: Vec<_> = terms.collect();
            let exact = terms.iter().fold(number(0.0), |sum, term| sum + term);
            let size = terms.iter().fold(number(values[0]).abs(), |sum, term| sum + term.abs());
            let off = (number(got) - exact).abs();
            assert!(
                off <= size * number(4.0 * f64::EPSILON / 2.0),
                "{got} of {values:?} at {hit:?}"
            );
        }
    }
    assert!(met > 4000 && missed > 1000, "{met} and {missed}");
}

#[test]
fn labels_are_those_of_the_nearest_corner_and_faces_have_their_own() {
    let (scene, rays, ..) = many();
    let hits = shot(&scene, &rays);
    let (_, places) = values(&scene, &hits, "place", None);
    let (_, faces) = values(&scene, &hits, "heat", Some(PropertyOf::Faces));
    let star = scene.objects()[0].mesh().unwrap();
    let (mut met, mut tied) = (0, 0);
    for k in (0..hits.len()).filter(|&k| (0..2).contains(&hits.get(k).object)) {
        let hit = hits.get(k);
        assert_eq!(faces[k], 7.0 * f64::from(hit.primitive));
        let [b, c] = hit.barycentric.to_array();
        let weights = [1.0 - b - c, b, c];
        let most = weights.into_iter().fold(0.0, f64::max);
        let first = weights.iter().position(|&weight| weight == most).unwrap();
        tied += usize::from(weights.iter().filter(|&&weight| weight == most).count() > 1);
        met += 1;
        let vertex = star.triangles()[hit.primitive as usize][first];
        assert_eq!(places[k], f64::from(vertex));
    }
    assert!(met > 4000, "{met} met, {tied} tied");
}

/// An attribute that is linear in space is itself wherever a ray meets a flat mesh.
#[test]
fn a_linear_quantity_is_that_of_the_point_that_was_hit() {
    let (points, triangles) = bumpy_sphere(20, 8);
    let linear = |p: DVec3| 3.0 * p.x - 0.5 * p.y + 0.25 * p.z + 11.0;
    let heat = doubles(points.iter().map(|&point| linear(point)));
    let star = Arc::unwrap_or_clone(mesh(&points, triangles));
    let heat = Property::new("heat", PropertyOf::Vertices, heat);
    let scene = scene(vec![Object::new(Arc::new(star.with_properties(vec![heat]).unwrap()))]);
    let rays = rays(&points, 3000, 9);
    let hits = shot(&scene, &rays);
    let (_, found) = values(&scene, &hits, "heat", None);
    let mut met = 0;
    for (k, ray) in rays.iter().enumerate() {
        let hit = hits.get(k);
        let Some(surface) = scene.interaction(ray, &hit) else {
            continue;
        };
        met += 1;
        assert!((found[k] - linear(surface.position())).abs() < 1e-13, "{hit:?}");
    }
    assert!(met > 1000, "{met}");
}

/// A ray at a vertex sees its very number, though others of the triangle are none.
#[test]
fn at_a_vertex_the_number_is_that_of_the_vertex() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let holes = doubles([0.1, f64::NAN, f64::INFINITY]);
    let star = Mesh::new(Positions::compact(points), vec![[0, 1, 2]]).unwrap();
    let holes = Property::new("holes", PropertyOf::Vertices, holes);
    let scene = scene(vec![Object::new(Arc::new(star.with_properties(vec![holes]).unwrap()))]);
    let down = |x, y| Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
    let hits = shot(&scene, &[down(0.0, 0.0), down(0.0, 0.5), down(0.0, 1.0), down(0.5, 0.0)]);
    let (_, found) = values(&scene, &hits, "holes", None);
    assert_eq!(found[..3], [0.1, f64::INFINITY, f64::INFINITY]);
    assert!(found[3].is_nan());
}

#[test]
fn meshes_without_the_attribute_or_with_fewer_numbers_leave_nan() {
    let square = |z: f64| {
        let points = vec![[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
        Mesh::new(Positions::compact(points), vec![[0, 1, 2]]).unwrap()
    };
    let named = |mesh: Mesh, components: usize| {
        let values = doubles((0..components).map(|k| 0.5 + k as f64));
        let property = Property { components, ..Property::new("tone", PropertyOf::Faces, values) };
        mesh.with_properties(vec![property]).unwrap()
    };
    let object = |mesh: Mesh| Object::new(Arc::new(mesh));
    let colored =
        square(0.0).with_colors(Attribute::per_vertex(vec![[0.25, 0.5, 1.0]; 3])).unwrap();
    let scene =
        scene(vec![object(named(square(5.0), 1)), object(colored), object(named(square(9.0), 3))]);
    let down = |z| Ray::new(DVec3::new(0.25, 0.25, z), DVec3::NEG_Z);
    let hits = shot(&scene, &[down(10.0), down(6.0), down(1.0), down(-1.0)]);
    let nan = f64::NAN;
    let same = |(components, found): (usize, Vec<f64>), expected: &[f64]| {
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!((components, bits(&found)), (3, bits(expected)));
    };
    let tones = [0.5, 1.5, 2.5, 0.5, nan, nan, nan, nan, nan, nan, nan, nan];
    same(values(&scene, &hits, "tone", None), &tones);
    let colors = [nan, nan, nan, nan, nan, nan, 0.25, 0.5, 1.0, nan, nan, nan];
    same(values(&scene, &hits, "colors", None), &colors);
    let names: Vec<_> = attributes(&scene)
        .into_iter()
        .map(|found| (found.name, found.of, found.components))
        .collect();
    assert_eq!(names, [("colors", PropertyOf::Vertices, 3), ("tone", PropertyOf::Faces, 3)]);
    let refused = attribute("tine\n", None, &scene, &hits, &()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "attribute must be the name of one that a mesh of the scene has, got 'tine\\u{a}'; there are colors, tone"
    );
    assert!(attribute("tone", Some(PropertyOf::Corners), &scene, &hits, &()).is_err());
    let nothing = attribute("tone", None, &scene, &Hits::default(), &()).unwrap();
    assert!(nothing.values.is_empty());
}

struct Stopping(AtomicU64);

impl Watch for Stopping {
    fn advance(&self, work: u64) {
        self.0.fetch_add(work, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed) >= 4096
    }
}

#[test]
fn the_bits_are_those_of_any_number_of_threads_and_work_can_be_stopped() {
    let (scene, rays, ..) = many();
    let hits = shot(&scene, &rays);
    let by = |threads: usize| {
        let (_, found) = on_threads(threads, || values(&scene, &hits, "tint", None));
        found.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let one = by(1);
    assert!(one == by(2) && one == by(5));
    let stopped = attribute("tint", None, &scene, &hits, &Stopping(AtomicU64::new(0)));
    assert!(matches!(stopped, Err(Error::Interrupted)), "{stopped:?}");
    let told = Stopping(AtomicU64::new(u64::MAX / 2));
    assert!(attribute("tint", None, &scene, &hits, &told).is_err());
}

fn of_file(name: &str, bytes: &[u8]) -> Scene {
    let loaded = load_bytes(Path::new(name), bytes, &LoadSettings::default()).unwrap();
    assert_eq!(loaded.warnings, [""; 0]);
    loaded.into_scene().unwrap()
}

#[test]
fn numbers_of_a_ply_are_met_integers_as_labels() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property double quality\nproperty uint label\nelement face 1\nproperty list uchar int vertex_indices\n\
        property short part\nend_header\n\
        0 0 0 0.5 4000000001\n4 0 0 1.5 4000000002\n4 4 0 2.5 4000000003\n0 4 0 3.5 4000000004\n4 0 1 2 3 -9\n";
    let scene = of_file("a.ply", text.as_bytes());
    let down = |x, y| Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
    let hits = shot(&scene, &[down(3.0, 0.5), down(1.0, 3.5), down(9.0, 9.0)]);
    let met = |name| values(&scene, &hits, name, None).1[..2].to_vec();
    // (0.25, 0.625, 0.125) in the first triangle, (0.125, 0.25, 0.625) in the second.
    assert_eq!(met("quality"), [0.125 + 0.625 * 1.5 + 0.3125, 0.0625 + 0.625 + 0.625 * 3.5]);
    assert_eq!(met("label"), [4_000_000_002.0, 4_000_000_004.0]);
    assert_eq!(met("part"), [-9.0, -9.0]);
    let missed = values(&scene, &hits, "part", None).1[2];
    assert!(missed.is_nan());
}

/// A triangle, and numbers behind its positions: as little-endian bytes, in base64 by the crate.
fn document() -> Vec<u8> {
    use base64::Engine as _;
    let mut bytes = Vec::new();
    let floats = |bytes: &mut Vec<u8>, values: &[f32]| {
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    };
    floats(&mut bytes, &[0., 0., 0., 4., 0., 0., 0., 4., 0.]);
    floats(&mut bytes, &[10., 20., 40.]);
    bytes.extend([u32::MAX, 7, u32::MAX - 1].iter().flat_map(|id| id.to_le_bytes()));
    for color in [[255_u8, 0, 51, 255], [0, 255, 51, 0], [0, 0, 51, 102]] {
        bytes.extend(color);
    }
    floats(&mut bytes, &[1., -1., 2., -2., 4., -4.]);
    let uri = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let view = |start: usize, length: usize| serde_json::json!({"buffer": 0, "byteOffset": start, "byteLength": length});
    let accessor = |view: usize, component: u32, kind: &str, normalized: bool| serde_json::json!({"bufferView": view, "componentType": component, "count": 3, "type": kind, "normalized": normalized});
    let json = serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {
            "POSITION": 0, "_TEMPERATURE": 1, "_ID": 2, "COLOR_1": 3, "_PAIR": 4
        }}]}],
        "bufferViews": [view(0, 36), view(36, 12), view(48, 12), view(60, 12), view(72, 24)],
        "accessors": [
            accessor(0, 5126, "VEC3", false), accessor(1, 5126, "SCALAR", false), accessor(2, 5125, "SCALAR", false),
            accessor(3, 5121, "VEC4", true), accessor(4, 5126, "VEC2", false),
        ],
        "buffers": [{"byteLength": bytes.len(), "uri": format!("data:;base64,{uri}")}],
    });
    json.to_string().into_bytes()
}

/// From the file, and from the built scene that it was saved as.
#[test]
fn attributes_of_a_gltf_are_met_and_stay_in_built_scenes() {
    let scene = of_file("a.gltf", &document());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.fhs");
    fhs::save(&path, &scene, &firsthit::world::World::default(), &()).unwrap();
    let saved = fhs::open(&path, true).unwrap().into_scene().unwrap();
    for scene in [scene, saved] {
        let hits = shot(&scene, &[Ray::new(DVec3::new(1.0, 2.0, 1.0), DVec3::NEG_Z)]);
        let met = |name| values(&scene, &hits, name, None).1;
        assert_eq!(met("_TEMPERATURE"), [2.5 + 5.0 + 20.0]);
        assert_eq!(met("_ID"), [f64::from(u32::MAX - 1)]);
        assert_eq!(met("_PAIR"), [0.25 + 0.5 + 2.0, -0.25 - 0.5 - 2.0]);
        let blue = 51.0 / 255.0;
        let color =
            [0.25, 0.25, 0.25 * blue + 0.25 * blue + 0.5 * blue, 0.25 + 0.5 * (102.0 / 255.0)];
        assert_eq!(met("COLOR_1"), color);
    }
}

#[test]
fn odd_attributes_of_a_gltf_are_left_out_with_a_warning() {
    let mut json: serde_json::Value = serde_json::from_slice(&document()).unwrap();
    json["accessors"][1]["count"] = 2.into();
    json["accessors"][4]["type"] = "MAT2".into();
    json["accessors"][4]["count"] = 1.into();
    let text = json.to_string();
    let loaded =
        load_bytes(Path::new("a.gltf"), text.as_bytes(), &LoadSettings::default()).unwrap();
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    assert!(loaded.warnings[0].contains("is not kept"), "{:?}", loaded.warnings);
    let scene = loaded.into_scene().unwrap();
    let names: Vec<_> = attributes(&scene).into_iter().map(|found| found.name).collect();
    assert_eq!(names, ["COLOR_1", "_ID"]);
}
