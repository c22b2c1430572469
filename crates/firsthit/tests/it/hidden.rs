//! Hidden objects: for every query the scene is as if they were not there.

use std::sync::Arc;

use firsthit::measure::{Grouping, Rule, inside, path_lengths, rules};
use firsthit::nearest::{
    Method, NearestSettings, closest_points, closest_points_with, signed_distances,
};
use firsthit::section::{SectionPlane, section};
use firsthit::shoot::{All, Count, First, trace};
use firsthit::{Cone, Cuboid, DAffine3, DVec3, Disc, Object, Plane, Ray, Scene, Sphere, Transform};

use crate::support::{Numbers, bumpy_sphere, mesh};

/// Objects side by side, every kind that hiding could miss.
fn objects() -> Vec<Object> {
    let bumpy = |seed| {
        let (points, triangles) = bumpy_sphere(4, seed);
        mesh(&points, triangles)
    };
    let (points, mut open) = bumpy_sphere(3, 9);
    open.truncate(open.len() - 7);
    let shared = bumpy(1);
    let at = |object: Object, x: f64| {
        let place = DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
        object.placed(Transform::new(place).unwrap())
    };
    let squeezed = DAffine3::from_scale(DVec3::new(1.0, 2.0, 0.5));
    let cone = Cone::new(DVec3::ZERO, DVec3::Z, 0.5, 0.0).unwrap();
    vec![
        Object::new(Arc::clone(&shared)),
        // In the place of the first: a duplicate, until that is hidden.
        Object::new(shared),
        at(Object::new(Sphere::new(DVec3::ZERO, 1.2).unwrap()), 1.0),
        at(Object::new(bumpy(2)), 3.0),
        at(Object::new(mesh(&points, open)), 5.0),
        Object::new(Plane::new(DVec3::new(0.0, 0.0, -0.3), DVec3::Z).unwrap()),
        Object::new(Disc::new(DVec3::new(4.0, 0.0, 0.2), DVec3::Y, 2.0).unwrap()),
        Object::new(Cuboid::new(DVec3::new(2.0, -1.0, -1.0), DVec3::new(2.5, 1.0, 1.0)).unwrap()),
        // No distance to it can be measured.
        Object::new(cone).placed(Transform::new(squeezed).unwrap()),
    ]
}

/// The scene that is asked, and the one that has only the objects which are not hidden, with their
/// identifiers elsewhere.
struct Judge {
    fewer: Scene,
    kept: Vec<usize>,
    points: Vec<[f64; 3]>,
    rays: Vec<Ray>,
}

impl Judge {
    /// Whether identifiers of a scene and those of the fewer objects mean the same.
    fn are_same(&self, found: &[i32], expected: &[i32]) -> bool {
        let number = |object: i32| usize::try_from(object).map_or(-1, |k| self.kept[k] as i32);
        found.iter().copied().eq(expected.iter().map(|&k| number(k)))
    }

    /// Returns how many rays meet something.
    fn rays(&self, scene: &Scene) -> usize {
        let first = |scene| trace(scene, &self.rays, First, &()).unwrap();
        let (hits, expected) = (first(scene), first(&self.fewer));
        assert_eq!(hits.t, expected.t);
        assert!(self.are_same(&hits.object, &expected.object));
        let count = |scene| trace(scene, &self.rays, Count, &()).unwrap();
        assert_eq!(count(scene), count(&self.fewer));
        let every = |scene| trace(scene, &self.rays, All { nearest: None }, &()).unwrap();
        let (every, expected) = (every(scene), every(&self.fewer));
        assert_eq!(every.hits.t, expected.hits.t);
        assert!(self.are_same(&every.hits.object, &expected.hits.object));
        hits.count_hit()
    }

    fn distances(&self, scene: &Scene) {
        let wanted = NearestSettings { count: 3, ..NearestSettings::default() };
        let nearest = |scene| closest_points(scene, &self.points, wanted, &()).unwrap();
        let judged = closest_points_with(Method::BruteForce, scene, &self.points, wanted, &());
        let expected = nearest(&self.fewer);
        for found in [nearest(scene), judged.unwrap()] {
            assert_eq!(found.distance, expected.distance);
            assert!(self.are_same(&found.object, &expected.object));
        }
        let signed = |scene| signed_distances(scene, &self.points, &()).ok();
        assert_eq!(signed(scene), signed(&self.fewer));
    }

    fn insides(&self, scene: &Scene) {
        let points: Vec<DVec3> = self.points.iter().copied().map(DVec3::from).collect();
        let held = |scene| inside(scene, &points, Grouping::Union, &()).unwrap().is_inside;
        assert_eq!(held(scene), held(&self.fewer));
        let lengths = |scene| {
            let lengths = path_lengths(scene, &self.rays, Grouping::Union, &()).unwrap();
            lengths.into_iter().map(f64::to_bits).collect::<Vec<_>>()
        };
        assert_eq!(lengths(scene), lengths(&self.fewer));
        for (k, rule) in rules(scene).unwrap().into_iter().enumerate() {
            assert!(self.kept.contains(&k) || rule == Rule::Nothing);
        }
    }

    fn sections(&self, scene: &Scene) {
        let plane = SectionPlane::new(DVec3::ZERO, DVec3::new(0.1, 0.2, 1.0)).unwrap();
        let cut = |scene| section(scene, plane, &()).unwrap();
        let (cut, expected) = (cut(scene), cut(&self.fewer));
        assert_eq!(cut.area().to_bits(), expected.area().to_bits());
        assert_eq!(cut.perimeter().to_bits(), expected.perimeter().to_bits());
    }
}

/// Points among the objects, and rays from them.
fn asked(numbers: &mut Numbers) -> (Vec<[f64; 3]>, Vec<Ray>) {
    let middle = DVec3::new(2.5, 0.0, 0.0);
    let points: Vec<_> = (0..400).map(|_| 3.0 * numbers.point() + middle).collect();
    let rays = points.iter().map(|&origin| Ray::new(origin, numbers.point()));
    let rays = rays.collect();
    (points.iter().map(DVec3::to_array).collect(), rays)
}

#[test]
fn hidden_objects_are_as_if_they_were_not_there() {
    let all = objects();
    let mut numbers = Numbers::new(7);
    let mut is_met = 0;
    for round in 0..24_usize {
        let (points, rays) = asked(&mut numbers);
        // The cone is always hidden.
        let is_hidden =
            |k: usize, numbers: &mut Numbers| k == 8 || numbers.below(3) == 0 || round == k;
        let is_hidden: Vec<bool> = (0..all.len()).map(|k| is_hidden(k, &mut numbers)).collect();
        let kept: Vec<usize> = (0..all.len()).filter(|&k| !is_hidden[k]).collect();
        let fewer = Scene::new(kept.iter().map(|&k| all[k].clone()).collect()).unwrap();
        let judge = Judge { fewer, kept, points, rays };

        let marked =
            all.iter().zip(&is_hidden).map(|(object, &is_hidden)| match (is_hidden, round % 2) {
                (false, _) => object.clone(),
                (true, 0) => object.clone().masked(0),
                (true, _) => object.clone().hidden(true),
            });
        let built = Scene::new(marked.collect()).unwrap();
        let mut later = Scene::new(all.clone()).unwrap();
        let changes: Vec<(usize, bool)> = is_hidden.iter().copied().enumerate().collect();
        later.hide_objects(&changes).unwrap();
        for scene in [&built, &later] {
            is_met += judge.rays(scene);
            judge.distances(scene);
            judge.insides(scene);
            judge.sections(scene);
            assert_eq!(scene.bounds(), judge.fewer.bounds());
        }
    }
    assert!(is_met > 2000, "{is_met}");
}
