//! Objects in one space share a tree. Their answers are those of each alone, to the bit:
//! brute force asks object by object.

use std::path::Path;
use std::sync::Arc;

use firsthit::load::{LoadSettings, load_bytes};
use firsthit::shoot::{All, Any, BruteForce, Count, Cpu, Engine, First, trace, trace_with};
use firsthit::world::World;
use firsthit::{
    Camera, Cuboid, DAffine3, DQuat, DVec2, DVec3, Departure, Filtered, InstructionSet, Mesh,
    Object, Ray, RayFilter, Rays, Scene, Sphere, SurfaceId, Transform, fhs,
};

use crate::filters::{filtered, leaving_together, same};
use crate::nearest::checked;
use crate::support::generators::{PLACES, cloud, placed, soup};
use crate::support::{Numbers, agree, bits, bumpy_sphere, cases, mesh, scene};

type Triangles = (Vec<DVec3>, Vec<[u32; 3]>);

/// Triangles dealt out to so many meshes at random, none of which is empty.
fn dealt((points, triangles): &Triangles, parts: usize, numbers: &mut Numbers) -> Vec<Arc<Mesh>> {
    let mut lists = vec![Vec::new(); parts];
    for (k, triangle) in triangles.iter().enumerate() {
        let part = if k < parts { k } else { numbers.below(parts) };
        lists[part].push(*triangle);
    }
    let whole = mesh(points, triangles.clone());
    let part = |(k, list): (usize, Vec<[u32; 3]>)| {
        if k % 2 == 0 {
            // As the groups of an OBJ file.
            return Arc::new(Mesh::new(Arc::clone(whole.positions()), list).unwrap());
        }
        let corners = list.iter().flatten().map(|&k| points[k as usize]);
        let own = (0..list.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        mesh(&corners.collect::<Vec<_>>(), own.collect())
    };
    lists.into_iter().enumerate().map(part).collect()
}

fn turned() -> Transform {
    let place = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.7, -1.2, 1.0),
        DQuat::from_rotation_y(0.7),
        DVec3::new(0.3, 0.1, -0.2),
    );
    Transform::new(place).unwrap()
}

/// Pieces in the world's space and in another one, among objects that are not joined.
pub(crate) fn pieces(seed: u64) -> Vec<Object> {
    let mut numbers = Numbers::new(seed);
    let kind = |numbers: &mut Numbers| match seed % 3 {
        0 => bumpy_sphere(9, seed),
        1 => cloud(150, numbers),
        // With triangles in one place, and some without an area.
        _ => soup(60, numbers),
    };
    let (here, there) = (kind(&mut numbers), kind(&mut numbers));
    let mut objects: Vec<Object> =
        dealt(&here, 9, &mut numbers).into_iter().map(Object::new).collect();
    let there = dealt(&there, 4, &mut numbers).into_iter();
    objects.extend(there.map(|mesh| Object::new(mesh).placed(turned())));
    objects.push(Object::new(Sphere::new(0.5 * numbers.point(), 0.5).unwrap()));
    objects.push(Object::new(Cuboid::new(DVec3::splat(-0.4), DVec3::splat(0.3)).unwrap()));
    let beside = Transform::translation(0.1 * numbers.point()).unwrap();
    objects.push(objects[3].clone().placed(beside));
    // In any order.
    for k in (1..objects.len()).rev() {
        objects.swap(k, numbers.below(k + 1));
    }
    objects
}

fn check_queries<R: Rays + ?Sized>(scene: &Scene, rays: &R) -> usize {
    let first = trace_with(&BruteForce, scene, rays, First, &()).unwrap();
    let any = trace_with(&BruteForce, scene, rays, Any, &()).unwrap();
    let count = trace_with(&BruteForce, scene, rays, Count, &()).unwrap();
    let all = trace_with(&BruteForce, scene, rays, All::default(), &()).unwrap();
    for set in InstructionSet::available() {
        let cpu = Cpu::with(set);
        same(&trace_with(&cpu, scene, rays, First, &()).unwrap(), &first);
        assert_eq!(trace_with(&cpu, scene, rays, Any, &()).unwrap(), any);
        assert_eq!(trace_with(&cpu, scene, rays, Count, &()).unwrap(), count);
        let fast = trace_with(&cpu, scene, rays, All::default(), &()).unwrap();
        assert_eq!(fast.offsets, all.offsets);
        same(&fast.hits, &all.hits);
    }
    any.iter().filter(|&&is_met| is_met).count()
}

fn check_pictures(scene: &Scene) {
    let (eye, up) = (DVec3::new(1.0, -3.0, 1.5), DVec3::Z);
    let camera = Camera::look_at(eye, DVec3::ZERO, up, 45.0, 40, 33).unwrap();
    let slow = trace_with(&BruteForce, scene, &camera, First, &()).unwrap();
    for set in InstructionSet::available() {
        same(&trace_with(&Cpu::with(set), scene, &camera, First, &()).unwrap(), &slow);
    }
}

#[test]
fn joined_objects_answer_as_each_does_alone() {
    let mut met = 0;
    for seed in 0..6 {
        let scene = scene(pieces(seed));
        let (rays, _) = filtered(&scene, cases(600), seed);
        met += check_queries(&scene, &rays[..]);
        let (rays, filters) = filtered(&scene, cases(1000), seed + 50);
        met += check_queries(&scene, &Filtered::each(&rays, &filters));
        let (rays, filters) = leaving_together(&scene);
        met += check_queries(&scene, &Filtered::each(&rays, &filters));
        check_pictures(&scene);
    }
    assert!(met > cases(6000), "{met}");
}

#[test]
fn objects_that_share_a_tree_have_one_of_the_size_of_one_mesh() {
    let (points, triangles) = bumpy_sphere(20, 3);
    let whole = mesh(&points, triangles.clone());
    let parts = triangles.chunks(40).map(|part| {
        let positions = Arc::clone(whole.positions());
        Object::new(Arc::new(Mesh::new(positions, part.to_vec()).unwrap()))
    });
    let joined = scene(parts.collect());
    let one = scene(vec![Object::new(whole)]);
    assert!(joined.objects().len() > 30);
    assert!(joined.tree_bytes() < one.tree_bytes() + 1000);
}

#[test]
fn rays_that_ask_for_one_of_joined_objects_meet_no_other() {
    let mut met = 0;
    for seed in 0..3 {
        let scene = scene(pieces(seed));
        let (rays, mut filters) = filtered(&scene, cases(1500), seed);
        let mut numbers = Numbers::new(seed);
        let crossings = trace(&scene, &rays, All::default(), &()).unwrap();
        for (k, filter) in filters.iter_mut().enumerate() {
            let on_the_way = crossings.offsets[k]..crossings.offsets[k + 1];
            filter.only = Some(match on_the_way.len() {
                0 => numbers.below(scene.objects().len()) as i32,
                count => crossings.hits.object[on_the_way.start + numbers.below(count)],
            });
        }
        met += check_queries(&scene, &Filtered::each(&rays, &filters));
    }
    assert!(met > cases(100), "{met}");
}

/// All of a scene in one tree, which needs no tree over objects, at every place and scale.
#[test]
fn a_scene_that_is_all_joined_is_one_mesh_to_its_rays() {
    for (seed, (scale, offset)) in (0..).zip(PLACES) {
        let mut numbers = Numbers::new(seed);
        let (points, triangles) = cloud(400, &mut numbers);
        let mut points = placed(&points, scale, offset);
        if seed % 2 == 0 {
            points = points.iter().map(|p| p.as_vec3().as_dvec3()).collect();
        }
        let one = scene(vec![Object::new(mesh(&points, triangles.clone()))]);
        let parts = dealt(&(points.clone(), triangles), 20, &mut numbers);
        let joined = scene(parts.into_iter().map(Object::new).collect());
        let rays = crate::support::generators::rays(&points, scale, cases(2000), &mut numbers);
        check_queries(&joined, &rays[..]);
        // As one mesh they have the same `t`.
        let (of_parts, of_one) =
            (trace(&joined, &rays, First, &()).unwrap(), trace(&one, &rays, First, &()).unwrap());
        for (t, other) in of_parts.t.iter().zip(&of_one.t) {
            assert!(t == other || (t - other).abs() <= 4.0 * f64::EPSILON * t.abs());
        }
    }
}

/// A level rectangle, from x on so wide, at a height.
fn tile(x: f64, width: f64, height: f64) -> Object {
    let points = [[0.0, 0.0], [width, 0.0], [width, 1.0], [0.0, 1.0]];
    let points = points.map(|[u, v]| DVec3::new(x + u, v, height));
    Object::new(mesh(&points, vec![[0, 1, 2], [0, 2, 3]]))
}

/// A triangle in a space of its own, and a ray that leaves it upwards where it is object 0.
fn leaving_upwards() -> (Object, Ray, RayFilter) {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|corner| 0.5 * corner);
    let raised = Transform::translation(DVec3::new(0.1, 0.1, 1e-30)).unwrap();
    let left = Object::new(mesh(&corners, vec![[0, 1, 2]])).placed(raised);
    let departure = Departure {
        surface: SurfaceId { object: 0, primitive: 0 },
        barycentric: DVec2::splat(0.25),
        side: None,
    };
    let filter = RayFilter { departure: Some(departure), ..RayFilter::NONE };
    let start = DVec3::new(0.225, 0.225, 1e-30);
    (left, Ray::new(start, DVec3::new(0.01, 0.02, 1.0)), filter)
}

/// A ray that leaves another space begins a little beyond its start, by the numbers of each object:
/// those that reach far have more.
#[test]
fn rays_from_another_space_begin_at_each_joined_object_where_they_do_alone() {
    let mut numbers = Numbers::new(3);
    // By the width of the tile that is a little above the start.
    let (mut near, mut beyond) = ([0; 2], [0; 2]);
    for round in 0..cases(2000) {
        let height = 4e-12 * numbers.unit();
        let widths = [[1.0, 2.2], [2.2, 1.0]][round % 2];
        let (left, ray, filter) = leaving_upwards();
        let scene = scene(vec![
            left,
            tile(0.0, widths[0], height),
            // Not in float32, as the lower one: meshes of one type of vertices are joined.
            tile(0.0, widths[1], 1.1),
        ]);
        let rays = [ray];
        let rays = Filtered::new(&rays, filter);
        check_queries(&scene, &rays);
        let first = trace(&scene, &rays, First, &()).unwrap();
        near[round % 2] += usize::from(first.object == [1]);
        beyond[round % 2] += usize::from(first.object == [2]);
    }
    let both = [near, beyond].concat();
    assert!(both.iter().all(|&count| count > cases(20)), "{both:?}");
    // What begins after 1 and after 2.2.
    assert!(near[0] > near[1], "{near:?}");
}

#[test]
fn objects_that_move_or_hide_leave_those_that_they_were_joined_with() {
    for seed in 0..cases(12) {
        let mut numbers = Numbers::new(seed);
        let mut changed = scene(pieces(seed));
        for step in 0..8 {
            let objects = changed.objects().len();
            let some: Vec<usize> = (0..=numbers.below(4)).map(|_| numbers.below(objects)).collect();
            let before = changed.clone();
            match step % 3 {
                0 => {
                    let to = |k| (k, Transform::translation(0.3 * numbers.point()).unwrap());
                    let places: Vec<_> = some.iter().copied().map(to).collect();
                    changed.move_objects(&places).unwrap();
                }
                1 => {
                    let all: Vec<_> = some.iter().map(|&k| (k, step != 4)).collect();
                    changed.hide_objects(&all).unwrap();
                }
                _ => {
                    let kept = |k: &usize| !some.contains(k);
                    let objects = (0..objects).filter(kept).map(|k| changed.objects()[k].clone());
                    let mut objects: Vec<Object> = objects.collect();
                    objects.push(Object::new(mesh(
                        &[numbers.point(), numbers.point(), numbers.point()],
                        vec![[0, 1, 2]],
                    )));
                    changed = changed.with_objects(objects).unwrap();
                }
            }
            let anew = scene(changed.objects().to_vec());
            let (rays, filters) = filtered(&anew, cases(400), seed + step);
            check_queries(&changed, &rays[..]);
            check_queries(&changed, &Filtered::each(&rays, &filters));
            check_pictures(&changed);
            // The scene that it was made of has not changed.
            let ray = Ray::new(DVec3::new(0.1, 0.2, 5.0), DVec3::NEG_Z);
            agree(&before, &ray);
            assert_eq!(
                bits(&Cpu::default().first_hit(&changed, &ray)),
                bits(&Cpu::default().first_hit(&anew, &ray))
            );
        }
    }
}

/// Asks all of a changed scene, and one opened from its file.
fn check_changed(changed: &Scene, seed: u64) {
    let anew = scene(changed.objects().to_vec());
    let (rays, filters) = filtered(&anew, cases(300), seed);
    let filters = Filtered::each(&rays, &filters);
    let mut numbers = Numbers::new(seed);
    let mut points: Vec<[f64; 3]> =
        (0..cases(60)).map(|_| (2.0 * numbers.point()).to_array()).collect();
    points.extend([[0.0, 0.0, 1e10], [1e300, 0.0, 0.0]]);
    let world = World::default();
    let bytes = fhs::encode(changed, &world, &()).unwrap();
    let opened = load_bytes(Path::new("a.fhs"), &bytes, &LoadSettings::default()).unwrap();
    for scene in [changed, &opened.into_scene().unwrap()] {
        check_queries(scene, &rays[..]);
        check_queries(scene, &filters);
        checked(scene, &points);
    }
}

/// An animation sets all poses at each step, of what stands still, too.
#[test]
fn objects_that_are_moved_to_where_they_are_stay_with_the_others() {
    for seed in 0..3 {
        let mut changed = scene(pieces(seed));
        let places = changed.objects().iter().map(|object| *object.transform());
        let places: Vec<_> = places.enumerate().collect();
        for &place in &places {
            changed.move_objects(&[place]).unwrap();
        }
        check_changed(&changed, seed);
        let mut all = places;
        all[2].1 = Transform::translation(DVec3::X).unwrap();
        changed.move_objects(&all).unwrap();
        check_changed(&changed, seed);
    }
}

#[test]
fn an_object_is_hidden_and_shown_in_one_call_and_in_several() {
    let mut changed = scene(pieces(1));
    changed.hide_objects(&[(2, true), (2, false), (4, false), (4, true)]).unwrap();
    assert!(!changed.objects()[2].is_hidden() && changed.objects()[4].is_hidden());
    check_changed(&changed, 1);
    let all: Vec<_> = (0..changed.objects().len()).map(|k| (k, true)).collect();
    changed.hide_objects(&all).unwrap();
    check_changed(&changed, 2);
    changed.hide_objects(&[(3, false), (5, false), (6, false)]).unwrap();
    check_changed(&changed, 3);
}

#[test]
fn a_mesh_that_is_moved_onto_a_joined_one_hides_no_other() {
    let beside = Transform::translation(DVec3::new(0.0, 0.0, 3.0)).unwrap();
    let loose = tile(0.0, 1.0, 0.0).placed(beside);
    let tiles = || [0.0, 1.25, 2.5].map(|x| tile(x, 1.0, 0.0)).to_vec();
    for objects in [[vec![loose.clone()], tiles()].concat(), [tiles(), vec![loose]].concat()] {
        let mut changed = scene(objects);
        let all = changed.objects().iter();
        let mover = all.enumerate().find(|(_, object)| !object.transform().is_identity());
        changed.move_object(mover.unwrap().0, Transform::IDENTITY).unwrap();
        check_changed(&changed, 4);
        // The tree over the objects is built anew.
        changed.hide_objects(&[]).unwrap();
        check_changed(&changed, 5);
        let rays = [0.5, 1.75, 3.0].map(|x| Ray::new(DVec3::new(x, 0.3, 5.0), DVec3::NEG_Z));
        assert!(trace(&changed, &rays[..], Any, &()).unwrap().iter().all(|&met| met));
    }
}

/// All of a group with another transform: what a start is computed from is another number then.
#[test]
fn a_group_whose_objects_all_move_begins_anew() {
    let (left, ray, filter) = leaving_upwards();
    let far = Transform::translation(DVec3::new(1e6, 0.0, 0.0)).unwrap();
    // In float32, both.
    let height = 1.0 / f64::from(1 << 30);
    let tiles = [tile(0.0, 1.0, height), tile(0.0, 1.0, 1.0)];
    let [low, high] = tiles.clone().map(|tile| tile.placed(far));
    let before = scene(vec![left.clone(), low, high]);
    let [low, high] = tiles;
    let after = before.with_objects(vec![left, low, high]).unwrap();
    let rays = [ray];
    let rays = Filtered::new(&rays, filter);
    check_queries(&after, &rays);
    assert_eq!(trace(&after, &rays, First, &()).unwrap().object, [1]);
    check_changed(&after, 7);
}

#[test]
fn the_nearest_points_of_joined_objects_are_those_of_each() {
    for seed in 0..6 {
        let scene = scene(pieces(seed));
        let mut numbers = Numbers::new(seed);
        let points: Vec<[f64; 3]> =
            (0..cases(500)).map(|_| (2.0 * numbers.point()).to_array()).collect();
        checked(&scene, &points);
    }
}
