//! Files that may be anything: refused in a line, or of no harm.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use firsthit::load::{LoadSettings, load, load_bytes};
use firsthit::measure::{Grouping, inside, thickness};
use firsthit::nearest::{NearestSettings, closest_points, signed_distances};
use firsthit::shape::Attribute;
use firsthit::shoot::{All, Count, Cpu, First, trace_with};
use firsthit::{
    Camera, Cuboid, DVec3, Filtered, InstructionSet, Material, Object, Positions, Ray, RayFilter,
    Scene, Side, Sphere, fhs,
};

use super::{Folder, materials, turned, world};
use crate::support::{Ask, Numbers, bumpy_sphere, mesh};

/// Reads a file that may be anything. If it is not refused, it can be shot at and looked at.
fn attack(bytes: &[u8], verify: bool) -> Result<(), String> {
    let settings = LoadSettings { verify, ..LoadSettings::default() };
    let loaded =
        load_bytes(Path::new("a.fhs"), bytes, &settings).map_err(|error| error.to_string())?;
    let Ok(mut scene) = loaded.into_scene() else {
        return Ok(());
    };
    let ray = Ray::new(DVec3::new(0.1, 0.2, 9.0), DVec3::NEG_Z);
    for set in InstructionSet::available() {
        let engine = Cpu::with(set);
        let hits = trace_with(&engine, &scene, &[ray; 3][..], First, &()).unwrap();
        let hit = hits.get(0);
        if let Some(surface) = scene.interaction(&ray, &hit) {
            std::hint::black_box((surface.color(), surface.shading_normal(), surface.uv()));
        }
        trace_with(&engine, &scene, &[ray; 3][..], Count, &()).unwrap();
    }
    let camera = Camera::look_at(DVec3::new(5.0, 6.0, 7.0), DVec3::ZERO, DVec3::Z, 30.0, 16, 16);
    trace_with(&Cpu::default(), &scene, &camera.unwrap(), First, &()).unwrap();
    for object in 0..scene.objects().len() {
        scene.move_object(object, turned(1.0, DVec3::ONE)).unwrap();
    }
    // The others take longer.
    if bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte)) % 8 == 0 {
        ask_everything(&scene);
    }
    Ok(())
}

/// All other questions. Their answers do not matter, nor what is refused.
fn ask_everything(scene: &Scene) {
    let mut numbers = Numbers::new(3);
    let vectors: Vec<DVec3> = (0..5).map(|_| 2.0 * numbers.point()).collect();
    let points: Vec<[f64; 3]> = vectors.iter().map(DVec3::to_array).collect();
    let rays: Vec<Ray> = (vectors.iter()).map(|&point| Ray::new(point, -point)).collect();
    let culls = RayFilter { cull: Some(Side::Back), ..RayFilter::NONE };
    for set in InstructionSet::available() {
        let engine = Cpu::with(set);
        trace_with(&engine, scene, &rays, All::default(), &()).unwrap();
        let filtered = Filtered::new(&rays[..], culls);
        trace_with(&engine, scene, &filtered, First, &()).unwrap();
        trace_with(&engine, scene, &filtered, All::default(), &()).unwrap();
    }
    let _ = std::hint::black_box((
        closest_points(scene, &points, NearestSettings::default(), &()),
        signed_distances(scene, &points, &()),
        inside(scene, &vectors, Grouping::Object, &()),
        thickness(scene, &points, &()),
        scene.section(DVec3::ZERO, DVec3::Z),
        scene.lint(),
        scene.explain(&rays[0]),
        scene.fingerprint(),
    ));
    let moved = scene.objects().iter().map(|object| {
        let Some(mesh) = object.mesh() else {
            return object.clone();
        };
        let mesh = Arc::unwrap_or_clone(Arc::clone(mesh));
        let mut points = Vec::new();
        for k in 0..mesh.positions().len() as u32 {
            points.push((1.1 * mesh.positions().get(k)).to_array());
        }
        match mesh.with_positions(Positions::Double(points.into())) {
            Ok(moved) => Object::new(Arc::new(moved)),
            Err(_) => object.clone(),
        }
    });
    let _ = scene.with_objects(moved.collect());
}

/// A small file with everything in it.
fn small() -> Vec<u8> {
    let folder = Folder::new("small");
    let path = folder.path("a.fhs");
    let (points, triangles) = bumpy_sphere(3, 3);
    let plain = mesh(&points, triangles);
    let looks: Arc<[Material]> = materials().into();
    let uvs = Attribute::per_vertex(vec![[0.5, 0.5]; points.len()]);
    let cut = Arc::unwrap_or_clone(Arc::clone(&plain)).with_uvs(uvs).unwrap();
    let objects = vec![
        Object::new(Arc::new(cut)).with_materials(looks),
        Object::new(Arc::clone(&plain)).placed(turned(0.3, DVec3::X)),
        Object::new(Arc::clone(&plain)).placed(turned(0.3, DVec3::X)),
        Object::new(plain).named("plain"),
        Object::new(Sphere::new(DVec3::ZERO, 2.0).unwrap()),
        Object::new(Cuboid::new(DVec3::ZERO, DVec3::ONE).unwrap()),
        // They share a tree.
        Object::new(mesh(&points[..3], vec![[0, 1, 2]])),
        Object::new(mesh(&points[1..5], vec![[0, 1, 2], [1, 2, 3]])),
    ];
    fhs::save(&path, &Scene::new(objects).unwrap(), &world(), &()).unwrap();
    fs::read(path).unwrap()
}

#[test]
fn a_truncated_file_is_refused_at_every_length() {
    let bytes = small();
    assert_eq!(attack(&bytes, true), Ok(()));
    for length in 0..bytes.len() {
        let why = attack(&bytes[..length], false).unwrap_err();
        assert!(!why.contains('\n') && why.starts_with("a.fhs"), "{why}");
    }
    let longer = [&bytes[..], &[0; 64]].concat();
    assert!(attack(&longer, false).unwrap_err().contains("truncated, or has grown"));
}

/// Of three ways to change a byte: the checksums find each, and without them nothing bad happens.
#[test]
fn a_changed_byte_is_found_and_does_no_harm() {
    let bytes = small();
    let mut numbers = Numbers::new(1);
    let mut accepted = 0;
    for at in 0..bytes.len() {
        let flip = [0x01, 0x80, 0xff][numbers.below(3)];
        let mut changed = bytes.clone();
        changed[at] ^= flip;
        let why = attack(&changed, true).unwrap_err();
        assert!(!why.contains('\n'), "{why}");
        accepted += usize::from(attack(&changed, false).is_ok());
    }
    // Boxes are not checked, and of vertices only that they are in the tree's space.
    assert!(accepted > bytes.len() / 5, "{accepted} of {}", bytes.len());
}

/// Makes the checksum of the header, the table and the record right again.
fn mend(changed: &mut [u8], start: usize, sections: usize) {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&changed[..32]);
    hasher.update(&changed[64..64 * (sections + 1)]);
    let length = u64::from_le_bytes(changed[80..88].try_into().unwrap()) as usize;
    if let Some(record) = changed.get(start..start.saturating_add(length)) {
        hasher.update(record);
    }
    let sum = *hasher.finalize().as_bytes();
    changed[32..64].copy_from_slice(&sum);
}

#[test]
fn a_camera_of_impossible_numbers_is_a_fault_of_the_file() {
    let bytes = small();
    let start = u64::from_le_bytes(bytes[72..80].try_into().unwrap()) as usize;
    let sections = u64::from_le_bytes(bytes[24..32].try_into().unwrap()) as usize;
    let key = b"],\"rows\":";
    let at = bytes.windows(key.len()).position(|piece| piece == key);
    let at = at.unwrap() + key.len();
    let digits = bytes[at..].iter().take_while(|byte| byte.is_ascii_digit());
    let digits = digits.count();
    let mut changed = bytes.clone();
    changed[at..at + digits].fill(b' ');
    changed[at] = b'0';
    mend(&mut changed, start, sections);
    let error = load_bytes(Path::new("a.fhs"), &changed, &LoadSettings::default()).unwrap_err();
    assert!(matches!(error, firsthit::Error::Parse { .. }), "{error}");
    let said = error.to_string();
    assert!(said.starts_with("a.fhs: the record: rows must be"), "{said}");
}

/// With the checksums of the header and the record made right again, so that the reader sees what
/// is there.
#[test]
fn a_record_of_anything_does_no_harm() {
    let bytes = small();
    let start = u64::from_le_bytes(bytes[72..80].try_into().unwrap()) as usize;
    let length = u64::from_le_bytes(bytes[80..88].try_into().unwrap()) as usize;
    let sections = u64::from_le_bytes(bytes[24..32].try_into().unwrap()) as usize;
    let mend = |changed: &mut [u8]| mend(changed, start, sections);
    let mut same = bytes.clone();
    mend(&mut same);
    assert!(same == bytes, "the checksum is as the format says");
    let mut numbers = Numbers::new(2);
    let (mut refused, mut tried) = (0, 0);
    for at in (8..32).chain(64..start + length) {
        let mut changed = bytes.clone();
        let is_digit = changed[at].is_ascii_digit() && at >= start;
        changed[at] = if is_digit {
            b'0' + numbers.below(10) as u8
        } else {
            changed[at] ^ 1 << numbers.below(8)
        };
        mend(&mut changed);
        tried += 1;
        refused += usize::from(attack(&changed, false).is_err());
    }
    assert!(refused > tried / 4 && refused < tried, "{refused} of {tried}");
}

#[test]
fn what_is_no_built_scene_is_refused_in_a_line() {
    let folder = Folder::new("foreign");
    let path = folder.path("a.fhs");
    for (content, why) in [
        (&b""[..], "does not begin as one"),
        (b"solid a stl", "does not begin as one"),
        (b"\x89fhs\r\n\x1a\n", "ends too early"),
        (b"\x89fhs\n\x1a\n", "does not begin as one"),
    ] {
        fs::write(&path, content).unwrap();
        let error = load(&path, &LoadSettings::default()).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
    let mut other = small();
    other[8] = 1;
    let error = attack(&other, false).unwrap_err();
    assert!(error.contains("version 1, where this firsthit reads version 5"), "{error}");
    assert!(fhs::open(&folder.path("missing.fhs"), false).is_err());
    assert!(fhs::open(&folder.0, false).unwrap_err().to_string().ends_with("a folder, not a file"));
}
