//! The explanation of a ray agrees with brute force: the hit, what lies behind it, and why each
//! other object is not the hit.

use std::collections::BTreeMap;
use std::sync::Arc;

use firsthit::explain::{Candidate, ExplainSettings, Explanation, Reason, explain, explain_pixel};
use firsthit::shape::Attribute;
use firsthit::shoot::{All, BruteForce, First, trace_with};
use firsthit::{
    AlphaMode, Camera, Cone, Cuboid, Cylinder, DAffine3, DQuat, DVec2, DVec3, Departure, Disc,
    Filtered, Hit, Material, Mesh, Object, Plane, Positions, Ray, RayFilter, Scene, Side, Sphere,
    SurfaceId, Transform,
};

use crate::joined::pieces;
use crate::support::{Ask, Numbers, bits, bumpy_sphere, mesh, scene};

/// A material through which rays pass where alpha is below one half.
fn leaf() -> Material {
    Material { alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..Material::default() }
}

/// A mesh whose vertices have random alphas.
fn leaves(points: &[DVec3], triangles: Vec<[u32; 3]>, numbers: &mut Numbers) -> Arc<Mesh> {
    let alphas = points.iter().map(|_| [numbers.unit() as f32]).collect();
    let positions = Positions::compact(points.iter().map(DVec3::to_array).collect());
    let mesh = Mesh::new(positions, triangles).unwrap();
    Arc::new(mesh.with_alphas(Attribute::per_vertex(alphas)).unwrap())
}

/// Every shape, some turned, in one place, cut out, masked or hidden.
fn everything(seed: u64) -> Scene {
    let mut numbers = Numbers::new(seed);
    let (points, triangles) = bumpy_sphere(5, seed);
    let cut_out = leaves(&points, triangles.clone(), &mut numbers);
    let bumpy = mesh(&points, triangles);
    let mut soup: Vec<DVec3> = (0..60).map(|_| 1.5 * numbers.point()).collect();
    let again: Vec<DVec3> = soup[..30].to_vec();
    soup.extend(again);
    let corners: Vec<[u32; 3]> = (0..30).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let soup = mesh(&soup, corners);
    let mut objects = vec![
        Object::new(bumpy.clone()),
        Object::new(soup.clone()),
        Object::new(Sphere::new(0.5 * numbers.point(), 0.5).unwrap()),
        Object::new(Cuboid::new(DVec3::splat(-0.4), DVec3::splat(0.3)).unwrap()),
        Object::new(Cone::new(DVec3::ZERO, DVec3::Z, 0.9, 0.3).unwrap()),
        Object::new(Cone::new(numbers.point(), numbers.point(), 0.0, 0.5).unwrap()),
        Object::new(Cylinder::new(numbers.point(), numbers.point(), 0.4).unwrap()),
        Object::new(Plane::new(0.1 * numbers.point(), numbers.point()).unwrap()),
        Object::new(Disc::new(DVec3::ZERO, numbers.point(), 0.6).unwrap()),
        Object::new(cut_out).with_materials([leaf()]),
        Object::new(soup).with_materials([leaf()]),
        Object::new(mesh(&[], Vec::new())),
    ];
    // Everything again, moved, turned and squeezed; and some in their places once more.
    for k in 0..objects.len() {
        let turned = DAffine3::from_scale_rotation_translation(
            DVec3::new(0.2, -0.4, 0.3),
            DQuat::from_rotation_y(numbers.unit()),
            3.0 * numbers.point(),
        );
        let object = objects[k].clone().placed(Transform::new(turned).unwrap());
        objects.push(object);
    }
    for _ in 0..5 {
        objects.push(objects[numbers.below(objects.len())].clone());
    }
    // Float64 cannot tell where in it a ray would be.
    let far = DAffine3::from_translation(DVec3::splat(1e200));
    let far = Transform::new(far).unwrap();
    objects.push(objects[2].clone().placed(far));
    for object in &mut objects {
        let bits = 1 << numbers.below(3) | 1 << numbers.below(3);
        *object = object.clone().masked(bits).hidden(numbers.below(9) == 0);
    }
    scene(objects)
}

/// A ray and what it does not meet.
fn ray(scene: &Scene, numbers: &mut Numbers, k: usize) -> (Ray, RayFilter) {
    let mut ray = Ray::new(3.0 * numbers.point(), numbers.point() - numbers.point());
    let mut filter = RayFilter::NONE;
    let hit = first(scene, &ray, &filter);
    let surface = SurfaceId { object: hit.object, primitive: hit.primitive };
    match k % 8 {
        0 | 6 if !hit.is_miss() => filter.skip = [Some(surface), None],
        1 if !hit.is_miss() => {
            let left = scene.interaction(&ray, &hit).unwrap();
            (ray, filter) = left.leave(numbers.point());
        }
        2 => ray = ray.up_to(2.0 * numbers.unit()),
        3 => ray = ray.beyond(2.0 * numbers.unit() - 1.0),
        4 if !hit.is_miss() => ray = ray.up_to(hit.t),
        5 => filter.only = i32::try_from(numbers.below(scene.objects().len())).ok(),
        // The surface that is skipped is behind the start, or at it.
        7 if !hit.is_miss() => {
            filter.skip = [Some(surface), None];
            ray = ray.beyond(hit.t * (1.0 + numbers.below(2) as f64));
        }
        _ => {}
    }
    if k.is_multiple_of(5) {
        filter.mask = 1 << numbers.below(4);
    }
    if k % 7 < 2 {
        filter.cull = Some([Side::Front, Side::Back][k % 7]);
    }
    if k.is_multiple_of(11) {
        ray.direction *= 1e-120;
    }
    (ray, filter)
}

fn first(scene: &Scene, ray: &Ray, filter: &RayFilter) -> Hit {
    let rays = [*ray];
    let rays = Filtered::new(&rays, *filter);
    trace_with(&BruteForce, scene, &rays, First, &()).unwrap().get(0)
}

/// The scene with one object to be seen.
fn alone(scene: &Scene, object: usize) -> Scene {
    let mut alone = scene.clone();
    let others = (0..scene.objects().len()).filter(|&other| other != object);
    let hidden: Vec<_> = others.map(|other| (other, true)).collect();
    alone.hide_objects(&hidden).unwrap();
    alone
}

/// The scene of an object alone, as it would be if nothing were cut out.
fn opaque(scene: &Scene, object: usize) -> Scene {
    let mut objects = scene.objects().to_vec();
    objects[object] = objects[object].clone().with_materials([Material::default()]);
    alone(&scene.with_objects(objects).unwrap(), object)
}

fn check_candidate(scene: &Scene, story: &Explanation<'_>, candidate: &Candidate<'_>) {
    let index = usize::try_from(candidate.object).unwrap();
    let object = &scene.objects()[index];
    let Explanation { ray, filter, .. } = story;
    let what = format!("{candidate:?} {ray:?} {filter:?}");
    let never = if object.is_hidden() {
        Some(Reason::Hidden)
    } else if filter.only.is_some_and(|only| only != candidate.object) {
        Some(Reason::NotAmong)
    } else {
        (object.mask() & filter.mask == 0).then_some(Reason::Masked)
    };
    if let Some(expected) = never {
        assert_eq!((candidate.reason, candidate.place), (expected, None), "{what}");
        return;
    }
    let by_itself = first(&alone(scene, index), ray, filter);
    let hit = story.hit.as_ref().map_or(Hit::MISS, |hit| hit.hit);
    match candidate.reason {
        Reason::Hit => assert_eq!(bits(&hit), bits(&by_itself), "{what}"),
        Reason::Tied => {
            assert!(candidate.object > hit.object, "{what}");
            assert!((by_itself.t - hit.t).abs() <= 4.0 * f64::EPSILON * hit.t.abs());
        }
        Reason::BehindHit => assert!(by_itself.t >= hit.t && !by_itself.is_miss(), "{what}"),
        _ => assert!(by_itself.is_miss(), "{what}"),
    }
    if !by_itself.is_miss() {
        assert_eq!(bits(&candidate.place.unwrap()), bits(&by_itself), "{what}");
        return;
    }
    if filter.departure.is_none() {
        check_rejected(scene, (ray, filter), candidate, &what);
    } else {
        check_departing(scene, (ray, filter), candidate, &what);
    }
}

/// A ray that leaves a surface: the crossing that is left is the one at the start, and the others
/// are where they seem to be.
fn check_departing(
    scene: &Scene,
    (ray, filter): (&Ray, &RayFilter),
    candidate: &Candidate<'_>,
    what: &str,
) {
    let left = filter.departure.unwrap().surface;
    let Some(place) = candidate.place else {
        assert!(candidate.object != left.object, "{what}");
        return;
    };
    // A start is off by the rounding of coordinates below 8, and of the transforms of the objects.
    let near = 1e-9 / ray.direction.abs().max_element();
    match candidate.reason {
        Reason::Left => {
            assert_eq!(candidate.object, left.object, "{what}");
            assert!(place.t.abs() <= near, "{what}");
        }
        Reason::BehindStart => assert!(place.t <= ray.t_min + near, "{what}"),
        Reason::BeyondEnd => assert!(place.t > ray.t_max, "{what}"),
        Reason::CulledFront | Reason::CulledBack => {
            let but_cull = RayFilter { cull: None, ..*filter };
            let index = usize::try_from(candidate.object).unwrap();
            let met = first(&opaque(scene, index), ray, &but_cull);
            assert!(!met.is_miss() && filter.cull.is_some(), "{what}");
        }
        Reason::CutOut => {
            let index = usize::try_from(candidate.object).unwrap();
            assert!(!first(&opaque(scene, index), ray, filter).is_miss(), "{what}");
        }
        reason => panic!("{reason:?}: {what}"),
    }
}

/// Whether an object that is not met would be with what the reason names out of the way.
fn check_rejected(
    scene: &Scene,
    (ray, filter): (&Ray, &RayFilter),
    candidate: &Candidate<'_>,
    what: &str,
) {
    let index = usize::try_from(candidate.object).unwrap();
    let scene = &opaque(scene, index);
    let meets = |ray: &Ray, filter: &RayFilter| !first(scene, ray, filter).is_miss();
    let but_cull = RayFilter { cull: None, ..*filter };
    let t_min = ray.t_min;
    let place = candidate.place.map(|place| place.t);
    match candidate.reason {
        Reason::CutOut => assert!(meets(ray, filter), "{what}"),
        Reason::CulledFront => {
            assert_eq!(filter.cull, Some(Side::Front));
            assert!(meets(ray, &but_cull), "{what}");
        }
        Reason::CulledBack => {
            assert_eq!(filter.cull, Some(Side::Back));
            assert!(meets(ray, &but_cull), "{what}");
        }
        Reason::Skipped => {
            assert!(filter.skip[0].unwrap().object == candidate.object, "{what}");
            let met = first(scene, ray, &RayFilter::NONE);
            assert_eq!(Some(met.t), place, "{what}");
        }
        _ => assert!(!meets(ray, &RayFilter::NONE), "{what}"),
    }
    let on = Ray { t_max: f64::INFINITY, ..*ray };
    match candidate.reason {
        Reason::BeyondEnd => {
            let met = first(scene, &on, &RayFilter::NONE);
            assert_eq!(Some(met.t), place, "{what}");
        }
        Reason::BehindStart => {
            let back = ray.beyond(f64::NEG_INFINITY).up_to(t_min);
            let all = trace_with(&BruteForce, scene, &[back][..], First, &()).unwrap();
            assert!(place.unwrap() <= t_min && !all.get(0).is_miss(), "{what}");
            assert!(!meets(&on, &RayFilter::NONE), "{what}");
        }
        reason if reason >= Reason::SurfaceMissed => {
            let line = on.beyond(f64::NEG_INFINITY);
            assert!(!meets(&line, &RayFilter::NONE), "{what}");
        }
        _ => {}
    }
}

fn check(scene: &Scene, story: &Explanation<'_>) {
    let rays = [story.ray];
    let rays = Filtered::new(&rays, story.filter);
    let hit = story.hit.as_ref().map_or(Hit::MISS, |hit| hit.hit);
    let judge = first(scene, &story.ray, &story.filter);
    assert_eq!(bits(&hit), bits(&judge), "{:?}", story.ray);
    let all = trace_with(&BruteForce, scene, &rays, All::default(), &()).unwrap();
    let mut all: Vec<Hit> = (0..all.hits.len()).map(|k| all.hits.get(k)).collect();
    let ids = |hit: &Hit| (hit.object, hit.primitive);
    if let Some(own) = all.iter().position(|other| ids(other) == ids(&hit)) {
        all.remove(own);
    }
    assert_eq!(story.behind_count, all.len());
    let behind: Vec<_> = story.behind.iter().map(|place| bits(&place.hit)).collect();
    let expected: Vec<_> = all.iter().map(bits).take(10).collect();
    assert_eq!(behind, expected);
    let close = 4.0 * f64::EPSILON * hit.t.abs();
    assert!(all.iter().all(|place| place.t >= hit.t - close));
    let hits = story.candidates.iter();
    let hits = hits.filter(|candidate| candidate.reason == Reason::Hit);
    assert_eq!(hits.count(), usize::from(!hit.is_miss()));
    let objects: Vec<i32> = story.candidates.iter().map(|it| it.object).collect();
    let expected: Vec<i32> = (0..).take(scene.objects().len()).collect();
    assert_eq!(objects, expected);
    for candidate in &story.candidates {
        check_candidate(scene, story, candidate);
    }
}

#[test]
fn stories_agree_with_brute_force() {
    let mut counts: BTreeMap<Reason, usize> = BTreeMap::new();
    for seed in 0..9 {
        // The last ones with objects that share a tree.
        let scene = if seed < 6 { everything(seed) } else { scene(pieces(seed)) };
        let mut numbers = Numbers::new(seed + 50);
        for k in 0..120 {
            let (ray, filter) = ray(&scene, &mut numbers, k);
            let settings = ExplainSettings { filter, ..ExplainSettings::default() };
            let story = explain(&scene, &ray, &settings, &()).unwrap();
            check(&scene, &story);
            for (reason, count) in story.counts() {
                *counts.entry(reason).or_default() += count;
            }
        }
    }
    for reason in Reason::ALL.iter().filter(|&&reason| reason != Reason::NoRay) {
        let count = counts.get(reason).copied().unwrap_or(0);
        assert!(count >= 5, "{reason:?}: {count} of {counts:?}");
    }
}

#[test]
fn an_object_in_the_place_of_the_hit_is_tied() {
    let (points, triangles) = bumpy_sphere(5, 3);
    let bumpy = mesh(&points, triangles);
    let ball = Sphere::new(DVec3::ZERO, 0.1).unwrap();
    let object = |_| Object::new(bumpy.clone());
    let mut objects: Vec<Object> = (0..3).map(object).collect();
    objects.push(Object::new(ball));
    let scene = scene(objects);
    let story = scene.explain(&Ray::new(5.0 * DVec3::ONE, -DVec3::ONE));
    let story = story.unwrap();
    let reasons: Vec<Reason> = story.candidates.iter().map(|it| it.reason).collect();
    let expected = [Reason::Hit, Reason::Tied, Reason::Tied, Reason::BehindHit];
    assert_eq!(reasons, expected);
    // In and out of the two others, in and out of the ball, and out of the first.
    assert_eq!(story.behind_count, 7);
}

#[test]
fn a_ray_that_is_not_valid_meets_nothing_and_says_why() {
    let ball = || Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let scene = scene(vec![ball(), ball().hidden(true)]);
    let good = Ray::new(DVec3::splat(3.0), DVec3::NEG_ONE);
    let bad = [
        (Ray::new(DVec3::NAN, DVec3::X), "its origin is NaN or beyond 1e150"),
        (Ray::new(DVec3::splat(1e200), DVec3::X), "its origin is NaN or beyond 1e150"),
        (Ray::new(DVec3::X, DVec3::ZERO), "is zero"),
        (Ray::new(DVec3::X, DVec3::NAN), "not finite"),
        (good.beyond(3.0).up_to(3.0), "ends before"),
        (good.up_to(f64::NAN), "t_max is NaN"),
        (good.beyond(f64::NAN), "t_max is NaN"),
    ];
    for (ray, why) in bad {
        let story = scene.explain(&ray).unwrap();
        assert!(story.fault.unwrap().contains(why), "{:?}", story.fault);
        assert!(story.hit.is_none() && story.behind.is_empty());
        assert_eq!(story.counts(), [(Reason::NoRay, 1), (Reason::Hidden, 1)]);
    }
    let story = scene.explain(&good).unwrap();
    assert!(story.fault.is_none() && story.hit.is_some());
}

#[test]
fn only_the_objects_among_which_is_asked_are_met() {
    let ball = |x: f64| Object::new(Sphere::new(DVec3::new(x, 0.0, 0.0), 1.0).unwrap());
    let scene = scene(vec![ball(0.0), ball(4.0), ball(8.0)]);
    let ray = Ray::new(DVec3::new(-5.0, 0.0, 0.0), DVec3::X);
    let settings =
        ExplainSettings { among: Some(vec![2, 1]), behind: 1, ..ExplainSettings::default() };
    let story = explain(&scene, &ray, &settings, &()).unwrap();
    let reasons: Vec<Reason> = story.candidates.iter().map(|it| it.reason).collect();
    let expected = [Reason::NotAmong, Reason::Hit, Reason::BehindHit];
    assert_eq!(reasons, expected);
    assert_eq!((story.behind_count, story.behind[0].hit.t), (3, 10.0));
    let beyond = ExplainSettings { among: Some(vec![3]), ..settings };
    let refused = explain(&scene, &ray, &beyond, &()).unwrap_err();
    assert!(refused.to_string().contains("3; there are 3"), "{refused}");
}

#[test]
fn a_pixel_is_that_of_the_picture() {
    let scene = scene(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap())]);
    let eye = DVec3::new(0.3, -5.0, 0.2);
    let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Z, 30.0, 6, 9).unwrap();
    let frame = firsthit::shoot::trace(&scene, &camera, First, &()).unwrap();
    let settings = ExplainSettings::default();
    for row in 0..6 {
        for column in 0..9 {
            let story = explain_pixel(&scene, &camera, [row, column], &settings, &()).unwrap();
            let expected = frame.get(9 * row + column);
            let found = story.hit.as_ref().map_or(Hit::MISS, |hit| hit.hit);
            assert_eq!(bits(&found), bits(&expected));
            let pixel = story.pixel.unwrap();
            assert_eq!(pixel.range, camera.range(row, column, expected.t));
            assert_eq!(pixel.z, camera.z(row, column, expected.t));
        }
    }
    for outside in [[0, 9], [6, 0], [usize::MAX; 2]] {
        let refused = explain_pixel(&scene, &camera, outside, &settings, &()).unwrap_err();
        let refused = refused.to_string();
        assert!(refused.contains("6 rows and 9 columns, from 0,0 to 5,8"), "{refused}");
    }
    // The ends that are asked for are those of the ray, a pixel's too.
    let settings = ExplainSettings { t_min: Some(-1.0), t_max: Some(2.0), ..settings };
    let story = explain_pixel(&scene, &camera, [2, 4], &settings, &()).unwrap();
    assert_eq!((story.ray.t_min, story.ray.t_max), (-1.0, 2.0));
    assert_eq!(story.counts(), [(Reason::BeyondEnd, 1)]);
    let pixel = story.pixel.unwrap();
    assert_eq!((pixel.range, pixel.z), (f64::INFINITY, f64::INFINITY));
}

#[test]
fn a_copy_of_a_triangle_that_is_skipped_is_the_hit() {
    let mut numbers = Numbers::new(8);
    let points: Vec<DVec3> = (0..90).map(|_| numbers.point()).collect();
    let triangle = |k: u32| [3 * k, 3 * k + 1, 3 * k + 2];
    // More copies than a leaf holds: trees keep them beside the leaves.
    let corners: Vec<[u32; 3]> = (0..630).map(|k| triangle(k % 30)).collect();
    let soup = scene(vec![Object::new(mesh(&points, corners))]);
    for k in 0..30 {
        let [a, b, c] = [0, 1, 2].map(|corner| points[3 * k + corner]);
        let (middle, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a));
        let ray = Ray::new(middle + 1e-6 * normal, -normal);
        let surface = |primitive: usize| {
            let primitive = i32::try_from(primitive).unwrap();
            Some(SurfaceId { object: 0, primitive })
        };
        let skipping = |skip| ExplainSettings {
            filter: RayFilter { skip, ..RayFilter::NONE },
            ..ExplainSettings::default()
        };
        let skips = [[surface(k), None], [surface(k), surface(k + 30)]];
        for (skip, copy) in skips.into_iter().zip([k + 30, k + 60]) {
            let story = explain(&soup, &ray, &skipping(skip), &()).unwrap();
            check(&soup, &story);
            let hit = story.hit.unwrap().hit;
            assert_eq!(hit.primitive, i32::try_from(copy).unwrap());
            assert_eq!(story.candidates[0].reason, Reason::Hit);
        }
    }
}

fn reasons(scene: &Scene, ray: &Ray, filter: RayFilter) -> Vec<(Reason, Option<f64>)> {
    let settings = ExplainSettings { filter, ..ExplainSettings::default() };
    let story = explain(scene, ray, &settings, &()).unwrap();
    let candidates = story.candidates.iter();
    let reasons = candidates.map(|it| (it.reason, it.place.map(|place| place.t)));
    reasons.collect()
}

#[test]
fn the_place_that_a_ray_leaves_is_at_its_start() {
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let block = Object::new(Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap());
    let square = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
    let below = square.map(|point| point - 2.0 * DVec3::Z);
    let corners = [square, below].concat();
    let sheets = Object::new(mesh(&corners, vec![[0, 1, 2], [3, 4, 5]]));
    for (object, primitive) in [(ball, 0), (block, 5), (sheets, 0)] {
        let is_mesh = object.mesh().is_some();
        let scene = scene(vec![object]);
        let surface = SurfaceId { object: 0, primitive };
        // In the triangle, the point (0, 0, 1).
        let barycentric = DVec2::new(0.25, 0.5);
        let departure = Some(Departure { surface, barycentric, side: Some(Side::Front) });
        let filter = RayFilter { departure, ..RayFilter::NONE };
        let out = Ray::new(DVec3::Z, DVec3::Z);
        let found = reasons(&scene, &out, filter);
        assert_eq!(found, [(Reason::Left, Some(0.0))], "mesh: {is_mesh}");
        // Inwards it meets the other end, or nothing before that.
        let inwards = Ray::new(DVec3::Z, DVec3::NEG_Z);
        assert_eq!(reasons(&scene, &inwards, filter), [(Reason::Hit, Some(2.0))]);
        let found = reasons(&scene, &inwards.up_to(1.5), filter);
        assert_eq!(found, [(Reason::Left, Some(0.0))], "mesh: {is_mesh}");
    }
}

#[test]
fn what_is_skipped_is_on_the_ray() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let triangle = Object::new(mesh(&points, vec![[0, 1, 2]]));
    let disc = Object::new(Disc::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap());
    let surface = SurfaceId { object: 0, primitive: 0 };
    let skip = RayFilter { skip: [Some(surface), None], ..RayFilter::NONE };
    for object in [triangle, disc] {
        let scene = scene(vec![object]);
        let down = Ray::new(DVec3::new(0.2, 0.2, 3.0), DVec3::NEG_Z);
        let up = Ray { direction: DVec3::Z, ..down };
        let found = reasons(&scene, &down, skip);
        assert_eq!(found, [(Reason::Skipped, Some(3.0))]);
        let found = reasons(&scene, &up, skip);
        assert_eq!(found, [(Reason::BehindStart, Some(-3.0))]);
        let found = reasons(&scene, &down.up_to(2.0), skip);
        assert_eq!(found, [(Reason::BeyondEnd, Some(3.0))]);
    }
    // The near end of a ball is skipped, so that another reason counts at the far one.
    let ball = scene(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap())]);
    let inside = Ray::new(0.5 * DVec3::NEG_Z, DVec3::Z);
    let culling = RayFilter { cull: Some(Side::Back), ..skip };
    let found = reasons(&ball, &inside, culling);
    assert_eq!(found, [(Reason::CulledBack, Some(1.5))]);
    assert_eq!(reasons(&ball, &inside, skip), [(Reason::Hit, Some(1.5))]);
}

#[test]
fn a_ray_that_meets_one_object_only_says_so_of_the_others() {
    let ball = |x: f64| Object::new(Sphere::new(DVec3::new(x, 0.0, 0.0), 1.0).unwrap());
    let scene = scene(vec![ball(0.0), ball(4.0).masked(2), ball(8.0)]);
    let ray = Ray::new(DVec3::new(-5.0, 0.0, 0.0), DVec3::X);
    let filter = RayFilter { only: Some(2), mask: 1, ..RayFilter::NONE };
    let expected = [(Reason::NotAmong, None), (Reason::NotAmong, None), (Reason::Hit, Some(12.0))];
    assert_eq!(reasons(&scene, &ray, filter), expected);
    let masked = RayFilter { only: None, ..filter };
    assert_eq!(reasons(&scene, &ray, masked)[1], (Reason::Masked, None));
}

/// A ray that goes by a turned rod, within the wider box that the tree has for it.
#[test]
fn the_box_of_a_turned_mesh_is_the_smallest_one() {
    let corner =
        |k: u32| DVec3::splat(f64::from(k) / 150.0 - 1.0) + 0.01 * DVec3::AXES[k as usize % 3];
    let points: Vec<DVec3> = (0..300).map(corner).collect();
    let triangles = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let turn = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::X);
    let along_x = Transform::new(DAffine3::from_quat(turn)).unwrap();
    let rod = Object::new(mesh(&points, triangles));
    let built = Scene::new(vec![rod.clone().placed(along_x)]).unwrap();
    let mut moved = Scene::new(vec![rod]).unwrap();
    moved.move_object(0, along_x).unwrap();
    for scene in [built, moved] {
        for (y, is_outside) in [(0.03, true), (0.0, false)] {
            let beside = Ray::new(DVec3::new(0.1, y, 9.0), DVec3::NEG_Z);
            let [(reason, _)] = reasons(&scene, &beside, RayFilter::NONE)[..] else {
                panic!("there is one object");
            };
            assert_eq!(reason == Reason::BoxMissed, is_outside, "{y}: {reason:?}");
        }
    }
}
