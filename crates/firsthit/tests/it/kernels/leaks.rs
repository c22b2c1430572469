//! Closed meshes have no holes: rays from inside at corners and edges.

use std::ops::Range;
use std::path::{Path, PathBuf};

use firsthit::shape::triangle::{EdgeRule, Shear};
use firsthit::shoot::{Any, Cpu, First, trace_with};
use firsthit::{DVec3, InstructionSet, Object, Ray, Scene};

use crate::support::{Numbers, cases, mesh, refdata, soak_rays};

/// Aims at each mesh that is closed, from a point inside, where it is, far away and in other sizes:
/// at corners and at edges, so many rays each, other ones in each round. Returns how many rays
/// there were.
fn leaks(round: usize, rays_each: usize) -> usize {
    let folder = refdata();
    let mut numbers = Numbers::new(7 + round as u64);
    let mut shot = 0;
    for path in ["generated", "real"].iter().flat_map(|name| files(&folder.join(name))) {
        let Ok(model) = firsthit::load::load(&path, &firsthit::load::LoadSettings::default())
        else {
            continue;
        };
        for own in model.world.objects.iter().filter_map(Object::mesh) {
            if own.triangles().len() > 200_000 || !is_closed(own.triangles()) {
                continue;
            }
            let size = own.bounds().size().max_element();
            for (scale, sizes) in [(1.0, 0.0), (1.0, 1e5), (1e-4, 0.0), (1e8, 0.0)] {
                let offset = sizes * size * DVec3::new(1.0, -0.7, 0.3);
                let moved = |k: u32| scale * own.positions().get(k) + offset;
                let count = u32::try_from(own.positions().len()).unwrap();
                let points: Vec<DVec3> = (0..count).map(moved).collect();
                let mesh = mesh(&points, own.triangles().to_vec());
                let scene = Scene::new(vec![Object::new(mesh)]).unwrap();
                let rays = round * rays_each..(round + 1) * rays_each;
                shot += aimed(&scene, rays, &mut numbers, &path);
            }
        }
    }
    shot
}

/// Shoots from inside the one closed mesh of a scene at its corners and edges, which are counted on
/// and on, with every instruction set.
fn aimed(scene: &Scene, which: Range<usize>, numbers: &mut Numbers, path: &Path) -> usize {
    let mesh = scene.objects()[0].mesh().unwrap();
    let Some(inside) = point_inside(scene, numbers) else {
        return 0;
    };
    let mut rays = Vec::with_capacity(which.len());
    for k in which {
        let [a, b, _] = mesh.corners(k / 2 % mesh.triangles().len());
        let target = if k % 2 == 0 { a } else { a.lerp(b, numbers.unit()) };
        if target != inside {
            rays.push(Ray::new(inside, target - inside));
        }
    }
    for set in InstructionSet::available() {
        let engine = Cpu::with(set);
        let hits = trace_with(&engine, scene, &rays, First, &()).unwrap();
        let any = trace_with(&engine, scene, &rays, Any, &()).unwrap();
        let missed = (0..rays.len()).find(|&k| hits.get(k).is_miss() || !any[k]);
        let missed = missed.map(|k| rays[k]);
        assert_eq!(missed, None, "{} {set:?}", path.display());
    }
    rays.len()
}

#[test]
#[ignore = "needs ../shared/refdata"]
fn closed_meshes_do_not_leak() {
    let shot = leaks(0, cases(4_000));
    assert!(shot > cases(100_000), "{shot}");
}

/// `FIRSTHIT_SOAK` says how many rays; see the Makefile.
#[test]
#[ignore = "takes long and needs ../shared/refdata: make soak"]
fn soak_of_leaks() {
    let mut shot = 0;
    for round in 0.. {
        let rays = leaks(round, 100_000);
        shot += rays;
        println!("{shot} rays at corners and edges, each with every instruction set");
        if shot >= soak_rays() {
            return;
        }
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(self::files(&path));
        } else {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// A point that the only object, a closed mesh, is met from an odd number of times.
fn point_inside(scene: &Scene, numbers: &mut Numbers) -> Option<DVec3> {
    let mesh = scene.objects()[0].mesh()?;
    let (low, size) = (mesh.bounds().low, mesh.bounds().size());
    (0..50).find_map(|_| {
        let point = low + size * (0.5 + 0.5 * numbers.point());
        let is_odd = |direction: DVec3| {
            let shear = Shear::new(&Ray::new(point, direction));
            let met = (0..mesh.triangles().len())
                .filter_map(|triangle| mesh.intersect_triangle(triangle, EdgeRule::Closed, &shear));
            met.filter(|hit| hit.t > 0.0).count() % 2 == 1
        };
        (0..3).all(|_| is_odd(numbers.point())).then_some(point)
    })
}

/// Whether every edge is met by two triangles, once in each direction.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut edges = std::collections::HashMap::new();
    for &[a, b, c] in triangles {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            *edges.entry((p.min(q), p.max(q))).or_insert(0) += if p < q { 1 } else { -1 };
        }
    }
    !triangles.is_empty() && edges.values().all(|&sum| sum == 0)
}
