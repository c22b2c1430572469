//! Closed meshes of real files: every line crosses them an even number of times, and what leaves
//! them does not meet what it leaves.
//!
//! They stand beside the clone, in ../shared/refdata. `make soak` says how many rays.

use std::fs;
use std::path::Path;

use firsthit::load::{LoadSettings, load};
use firsthit::shoot::{Count, First, trace};
use firsthit::{
    DVec2, DVec3, Departure, Filtered, Mesh, Object, Ray, RayFilter, Scene, Side, SurfaceId,
};
use num_traits::Signed;

use crate::support::rational::{cross, dot, exact, minus, point_left};
use crate::support::{Numbers, refdata, soak_rays};

/// Meshes of ten files that the manifest calls closed and without degenerate triangles.
fn meshes() -> Vec<(String, Scene)> {
    let root = refdata();
    let manifest = fs::read_to_string(root.join("MANIFEST.tsv")).unwrap();
    let mut found = Vec::new();
    for line in manifest.lines().filter(|line| !line.starts_with('#')) {
        let columns: Vec<&str> = line.split('\t').collect();
        let [file, expect, _, triangles, degenerate, closed, ..] = columns[..] else {
            continue;
        };
        let is_wanted = expect == "ok" && degenerate == "0" && closed == "yes";
        if !is_wanted || triangles.parse().is_ok_and(|count: usize| count < 100) {
            continue;
        }
        let Some(scene) = only_mesh(&root.join(file)) else {
            continue;
        };
        found.push((file.to_owned(), scene));
        if found.len() == 10 {
            return found;
        }
    }
    panic!("{} closed meshes", found.len());
}

/// A scene of the file's mesh where it lies, if that is its only one and closed.
fn only_mesh(path: &Path) -> Option<Scene> {
    let loaded = load(path, &LoadSettings::default()).unwrap();
    let [object] = &loaded.world.objects[..] else {
        return None;
    };
    let mesh = object.mesh().filter(|mesh| mesh.is_closed().unwrap())?;
    Some(Scene::new(vec![Object::new(mesh.clone())]).unwrap())
}

fn mesh(scene: &Scene) -> &Mesh {
    scene.objects()[0].mesh().unwrap()
}

/// The weights of a corner, the middle of an edge, the middle, and any place of a triangle.
fn place(k: usize, numbers: &mut Numbers) -> DVec2 {
    let halves = [0.0, 0.5, 1.0];
    match k % 4 {
        0 => [DVec2::ZERO, DVec2::X, DVec2::Y][numbers.below(3)],
        1 => [DVec2::new(0.5, 0.5), DVec2::new(0.0, 0.5), DVec2::new(0.5, 0.0)][numbers.below(3)],
        2 => DVec2::splat(1.0 / 3.0),
        _ => 0.5 * DVec2::new(halves[numbers.below(3)], 0.25 + 0.1 * halves[numbers.below(3)]),
    }
}

fn point(mesh: &Mesh, triangle: usize, weights: DVec2) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle);
    (1.0 - weights.x - weights.y) * a + weights.x * b + weights.y * c
}

/// Rays at corners, edges and faces from all around; of every four two come from a corner of the
/// box, so that many lie in faces.
fn lines(scene: &Scene, count: usize, numbers: &mut Numbers) -> Vec<Ray> {
    let mesh = mesh(scene);
    let bounds = mesh.bounds();
    let size = bounds.high - bounds.low;
    let all = (0..count).map(|k| {
        let at = point(mesh, numbers.below(mesh.triangles().len()), place(k / 3, numbers));
        let from = match k % 4 {
            0 => bounds.low - size,
            1 => at + DVec3::AXES[numbers.below(3)] * 4.0 * size.max_element(),
            _ => at + 4.0 * size.max_element() * numbers.point().normalize(),
        };
        Ray::new(from, at - from)
    });
    all.collect()
}

#[test]
#[ignore = "needs ../shared/refdata; takes long: make soak"]
fn soak_lines_cross_closed_meshes_in_pairs() {
    let meshes = meshes();
    let rays = soak_rays() / meshes.len();
    let (mut numbers, mut crossings) = (Numbers::new(11), 0);
    for (file, scene) in &meshes {
        for block in (0..rays).step_by(1 << 18) {
            let lines = lines(scene, (rays - block).min(1 << 18), &mut numbers);
            let counts = trace(scene, &lines, Count, &()).unwrap();
            for (ray, count) in lines.iter().zip(counts) {
                assert!(count % 2 == 0, "{file}: {ray:?} crosses {count} times");
                crossings += u64::from(count);
            }
        }
        println!("{file}: {rays} rays");
    }
    assert!(crossings as usize > rays * meshes.len());
}

/// Rays that leave places of a mesh, each one way and the opposite one.
fn leaving(scene: &Scene, count: usize, numbers: &mut Numbers) -> (Vec<Ray>, Vec<RayFilter>) {
    let mesh = mesh(scene);
    let (mut rays, mut filters) = (Vec::new(), Vec::new());
    for k in 0..count / 2 {
        let triangle = numbers.below(mesh.triangles().len());
        let barycentric = place(k, numbers);
        let surface = SurfaceId { object: 0, primitive: triangle as i32 };
        let departure = Some(Departure { surface, barycentric, side: Some(Side::Front) });
        let filter = RayFilter { departure, ..RayFilter::NONE };
        let (start, way) = (point(mesh, triangle, barycentric), numbers.point());
        rays.extend([Ray::new(start, way), Ray::new(start, -way)]);
        filters.extend([filter; 2]);
    }
    (rays, filters)
}

/// Whether a ray from the exact place meets a triangle ahead of it, in rational arithmetic.
fn is_ahead(mesh: &Mesh, from: &Departure, way: DVec3, triangle: usize) -> bool {
    let left = usize::try_from(from.surface.primitive).unwrap();
    let start = point_left(mesh.corners(left), from.barycentric);
    let [a, b, c] = mesh.corners(triangle).map(|corner| minus(&exact(corner), &start));
    let way = exact(way);
    let sides = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&way, &cross(p, q)));
    let n = cross(&minus(&b, &a), &minus(&c, &a));
    let (height, slope) = (dot(&n, &a), dot(&n, &way));
    let is_within =
        !sides.iter().any(Signed::is_negative) || !sides.iter().any(Signed::is_positive);
    is_within && (height * slope).is_positive()
}

#[test]
#[ignore = "needs ../shared/refdata; takes long: make soak"]
fn soak_rays_that_leave_closed_meshes_do_not_meet_what_they_leave() {
    let meshes = meshes();
    let rays = soak_rays() / meshes.len();
    let mut numbers = Numbers::new(12);
    for (file, scene) in &meshes {
        let (mesh, mut near) = (mesh(scene), 0);
        let size = (mesh.bounds().high - mesh.bounds().low).max_element();
        for block in (0..rays).step_by(1 << 18) {
            let (rays, filters) = leaving(scene, (rays - block).min(1 << 18), &mut numbers);
            let filtered = Filtered::each(&rays, &filters);
            let hits = trace(scene, &filtered, First, &()).unwrap();
            let counts = trace(scene, &filtered, Count, &()).unwrap();
            for (k, ray) in rays.iter().enumerate() {
                let Departure { surface, barycentric, .. } = filters[k].departure.unwrap();
                assert_ne!(hits.primitive[k], surface.primitive, "{file}: {ray:?}");
                if hits.t[k] * ray.direction.length() < 1e-12 * size {
                    // Surfaces that are nearly in one place.
                    let met = usize::try_from(hits.primitive[k]).unwrap();
                    let departure = filters[k].departure.unwrap();
                    assert!(is_ahead(mesh, &departure, ray.direction, met), "{file}: {ray:?}");
                    near += 1;
                }
                // Within a triangle both ways and its own crossing are a line's.
                let weights = [1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y];
                if k % 2 == 0 && weights.iter().all(|&weight| weight > 0.0) {
                    let both = counts[k] + counts[k + 1];
                    assert!(both % 2 == 1, "{file}: {ray:?} crosses {both} more times");
                }
            }
        }
        println!("{file}: {rays} rays, {near} met something at once");
    }
}
