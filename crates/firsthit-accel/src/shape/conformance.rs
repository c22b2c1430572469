//! Tests of the contract of [`Surface`] for every registered shape.
//!
//! The independent reference is the distance to the surface, written in another way than the
//! intersection; walking along a ray by that distance (Hart, "Sphere Tracing", The Visual Computer
//! 12, 1996) finds the first crossing without solving anything.

use super::{Crossing, Nearest, Shape, Surface};
use crate::geometry::{Bounds, DAffine3, DMat3, DQuat, DVec3, Ray, Transform};

/// The test data of a shape.
pub(super) trait Conforming: Sized {
    fn examples() -> Vec<Self>;

    /// The distance to the surface, negative inside (or, for an open surface, behind it or
    /// positive).
    fn distance(&self, point: DVec3) -> f64;
}

/// The examples are a few units large and at most a few from the origin.
const TOLERANCE: f64 = 1e-12;

/// Reproducible numbers between -1 and 1 (a linear congruential generator of Knuth's).
struct RandomNumbers(u64);

impl RandomNumbers {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn point(&mut self, reach: f64) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * reach
    }
}

/// Rays from all around and from inside, most of them towards the shape, some along the axes.
fn rays(shape: &Shape) -> Vec<Ray> {
    let bounds = if shape.bounds().is_finite() {
        shape.bounds()
    } else {
        Bounds::of([-DVec3::ONE, DVec3::ONE])
    };
    let mut numbers = RandomNumbers(1);
    let mut rays = Vec::new();
    for k in 0..4000 {
        let target = bounds.centre() + 0.55 * bounds.size() * numbers.point(1.0);
        let origin = if k % 3 == 0 { target } else { numbers.point(6.0) };
        let axis = [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z][k / 4 % 4];
        rays.push(match k % 4 {
            0 => Ray::new(target - 3.0 * axis, axis),
            1 => Ray::new(origin, numbers.point(1.0)),
            _ if origin == target => Ray::new(origin, axis),
            _ => Ray::new(origin, target - origin),
        });
    }
    rays
}

/// Calls `check` for every ray that meets its shape, with where it does so.
fn each_hit(mut check: impl FnMut(&Shape, &Ray, Crossing)) {
    for shape in Shape::examples() {
        for ray in rays(&shape) {
            if let Some(hit) = shape.intersect(&ray) {
                check(&shape, &ray, hit);
            }
        }
    }
}

/// The end of a walk along a ray.
enum Walk {
    Surface(f64),
    Nothing,
    /// The ray grazes the surface.
    TooCloseToCall,
}

/// The end of a walk along a ray.
const FAR: f64 = 1e3;

fn walk(shape: &Shape, ray: &Ray) -> Walk {
    let length = ray.direction.length();
    let mut t = 1e-9;
    let mut grazing = false;
    for _ in 0..4000 {
        let distance = shape.distance(ray.at(t)).abs();
        if distance < 1e-11 {
            return Walk::Surface(t);
        }
        grazing |= distance < 1e-6;
        if t * length > FAR {
            return if grazing { Walk::TooCloseToCall } else { Walk::Nothing };
        }
        t += distance / length;
    }
    Walk::TooCloseToCall
}

#[test]
fn hits_lie_on_the_surface_and_in_the_bounds() {
    for shape in Shape::examples() {
        let bounds = shape.bounds();
        let mut hits = 0;
        for ray in rays(&shape) {
            let Some(hit) = shape.intersect(&ray) else {
                continue;
            };
            let point = ray.at(hit.t);
            hits += 1;
            let scale = 1.0 + ray.origin.length() + point.length();
            assert!(shape.distance(point).abs() < TOLERANCE * scale, "{shape:?} {ray:?} {hit:?}");
            assert!(bounds.low.cmple(point + TOLERANCE * scale).all(), "{shape:?} {ray:?}");
            assert!(bounds.high.cmpge(point - TOLERANCE * scale).all(), "{shape:?} {ray:?}");
        }
        assert!(hits > 100, "{shape:?} was hit {hits} times");
    }
}

/// Seen from far away along `direction`, the distance to a shape is the distance to its supporting
/// plane: the error falls off with the distance, and rounding grows with it.
#[test]
fn the_distance_from_far_away_is_that_to_the_supporting_plane() {
    const AWAY: f64 = 1e7;
    for shape in Shape::examples() {
        let mut numbers = RandomNumbers(2);
        let axes = [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let any = std::iter::repeat_with(|| numbers.point(1.0)).take(200);
        for direction in axes.into_iter().chain(any) {
            let support = shape.support(direction);
            if !shape.bounds().is_finite() {
                assert_eq!(support, f64::INFINITY, "{shape:?} {direction}");
                continue;
            }
            let far = AWAY * direction.normalize();
            let arrived = AWAY - shape.distance(far);
            let off = support / direction.length() - arrived;
            assert!(off.abs() < 1e-5, "{shape:?} {direction}: {off}");
        }
        for ray in rays(&shape) {
            if let Some(hit) = shape.intersect(&ray) {
                let reach = ray.at(hit.t).dot(ray.direction);
                let slack = TOLERANCE * (1.0 + ray.origin.length() + reach.abs());
                let support = shape.support(ray.direction);
                assert!(reach <= support + slack, "{shape:?} {ray:?}");
            }
        }
    }
}

#[test]
fn the_first_crossing_is_the_one_that_walking_finds() {
    for shape in Shape::examples() {
        let mut compared = 0;
        for ray in rays(&shape) {
            let hit = shape.intersect(&ray).map(|hit| hit.t);
            match (walk(&shape, &ray), hit) {
                (Walk::Surface(walked), Some(hit)) => {
                    // Walking stops 1e-11 before the surface, more along a grazing ray.
                    let slack = 1e-5 / ray.direction.length();
                    assert!(
                        (walked - hit).abs() < slack,
                        "{shape:?} {ray:?}: {hit}, walked {walked}"
                    );
                    compared += 1;
                }
                // Walking counts as a hit what grazes.
                (Walk::Surface(walked), None) => {
                    let grazing = shape.distance(ray.at(walked + 1e-6)).abs() < 1e-7;
                    assert!(grazing, "{shape:?} {ray:?}: missed, walked {walked}");
                }
                (Walk::Nothing, Some(hit)) => {
                    let beyond = hit * ray.direction.length() > 0.99 * FAR;
                    assert!(beyond, "{shape:?} {ray:?}: {hit}, but walking found nothing");
                }
                (Walk::Nothing, None) | (Walk::TooCloseToCall, _) => {}
            }
        }
        assert!(compared > 100, "{shape:?}: {compared}");
    }
}

#[test]
fn normals_have_length_one_and_point_away_from_the_inside() {
    each_hit(|shape, ray, hit| {
        let point = ray.at(hit.t);
        let normal = shape.normal(point, hit.primitive);
        assert!((normal.length() - 1.0).abs() < TOLERANCE, "{shape:?} {ray:?}");
        let front = ray.direction.dot(normal) < 0.0;
        let step = 1e-6 / ray.direction.length();
        let (before, after) =
            (shape.distance(ray.at(hit.t - step)), shape.distance(ray.at(hit.t + step)));
        // Grazing rays and thin edges are on neither side for long enough to tell.
        if before * after < 0.0 {
            assert_eq!(front, before > after, "{shape:?} {ray:?} {hit:?}");
        }
    });
}

#[test]
fn closed_shapes_are_left_through_the_other_side() {
    each_hit(|shape, ray, first| {
        let depth = 1e-7 / ray.direction.length();
        let inside = Ray::new(ray.at(first.t + depth), ray.direction);
        if shape.distance(inside.origin) > -1e-9
            || matches!(shape, Shape::Plane(_) | Shape::Disc(_))
        {
            return;
        }
        let second = shape.intersect(&inside).unwrap_or_else(|| panic!("{shape:?} {ray:?} leaks"));
        let back = Ray::new(inside.at(second.t + 10.0), -ray.direction);
        let again =
            shape.intersect(&back).unwrap_or_else(|| panic!("{shape:?} {ray:?} from behind"));
        let rounding =
            TOLERANCE * 1e3 * (1.0 + ray.origin.length()) / ray.direction.length().min(1.0);
        let grazing =
            ray.direction.dot(shape.normal(back.at(again.t), again.primitive)).abs() < 1e-3;
        assert!(grazing || (again.t - 10.0).abs() < rounding, "{shape:?} {ray:?} {again:?}");
    });
}

#[test]
fn t_counts_in_lengths_of_the_direction_and_t_max_is_included() {
    each_hit(|shape, ray, hit| {
        let fast = shape.intersect(&Ray::new(ray.origin, 4.0 * ray.direction)).unwrap();
        assert!((4.0 * fast.t - hit.t).abs() <= 1e-12 * hit.t.max(1.0), "{shape:?} {ray:?}");
        let included = shape.intersect(&ray.up_to(hit.t)).map(|hit| (hit.t, hit.primitive));
        assert_eq!(included, Some((hit.t, hit.primitive)), "{shape:?} {ray:?}");
        let before = shape.intersect(&ray.up_to(hit.t.next_down()));
        assert!(before.is_none(), "{shape:?} {ray:?} {before:?}");
    });
}

/// All crossings are the first one, and what a ray meets that begins there.
#[test]
fn all_crossings_are_those_met_one_after_another() {
    each_hit(|shape, ray, hit| {
        if matches!(shape, Shape::Mesh(_)) {
            return;
        }
        let all: Vec<f64> = shape.crossings(ray).iter().flatten().map(|at| at.t).collect();
        let next = shape.intersect(&ray.beyond(hit.t)).map(|next| next.t);
        // Both ends of a solid in one place are both there.
        let last = next.or((all.len() == 2).then_some(hit.t));
        let expected: Vec<f64> = [Some(hit.t), last].into_iter().flatten().collect();
        assert_eq!(all, expected, "{shape:?} {ray:?}");
    });
}

/// A ray that begins at its first crossing meets the second one, as seen from the other end.
#[test]
fn t_min_is_not_included_and_lets_the_next_crossing_through() {
    let mut passed = 0;
    each_hit(|shape, ray, hit| {
        let same = |t_min: f64| shape.intersect(&ray.beyond(t_min)).map(|hit| hit.t);
        assert_eq!(same(hit.t.next_down()), Some(hit.t), "{shape:?} {ray:?}");
        let behind = same(-1.0).unwrap();
        let is_first = behind == hit.t || (behind > -1.0 && behind <= 0.0);
        assert!(is_first, "{shape:?} {ray:?} {behind}");
        assert_eq!(same(1e9), None, "{shape:?} {ray:?}");
        let Some(next) = shape.intersect(&ray.beyond(hit.t)) else {
            return;
        };
        assert!(next.t > hit.t, "{shape:?} {ray:?}");
        let back = Ray::new(ray.at(2.0 * next.t), -ray.direction);
        let last = shape.intersect(&back).map_or(0.0, |hit| 2.0 * next.t - hit.t);
        let rounding = 1e-7 * next.t.max(1.0);
        assert!((last - next.t).abs() <= rounding, "{shape:?} {ray:?} {next:?} {last}");
        passed += 1;
    });
    assert!(passed > 100, "{passed}");
}

#[test]
fn what_is_behind_the_start_is_not_met() {
    for shape in Shape::examples() {
        for ray in rays(&shape) {
            let beyond = Ray::new(ray.at(-1e3 / ray.direction.length()), -ray.direction);
            // All examples are near the origin, and so is everything these rays have behind them.
            if beyond.origin.length() > 50.0 && !matches!(shape, Shape::Plane(_)) {
                assert!(shape.intersect(&beyond).is_none(), "{shape:?} {beyond:?}");
            }
        }
    }
}

/// The error at 10^7 units, from the rounding of the start's coordinates, is about 2e-9.
#[test]
fn shapes_are_met_from_ten_million_units_away() {
    each_hit(|shape, ray, hit| {
        let normal = shape.normal(ray.at(hit.t), hit.primitive);
        let direction = ray.direction.normalize();
        if direction.dot(normal).abs() < 0.1 {
            return;
        }
        let far = Ray::new(ray.at(hit.t) - 1e7 * direction, direction);
        let Some(hit) = shape.intersect(&far) else { panic!("{shape:?} {ray:?}") };
        let off = shape.distance(far.at(hit.t)).abs();
        assert!(off < 1e-7, "{shape:?} {ray:?} {off}");
    });
}

#[test]
fn lines_that_touch_a_round_shape_meet_it_just_inside_and_pass_it_just_outside() {
    let sphere = Shape::from(super::Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let cylinder = Shape::from(super::Cylinder::new(DVec3::NEG_Z, DVec3::Z, 1.0).unwrap());
    for shape in [sphere, cylinder] {
        let beside = |y| shape.intersect(&Ray::new(DVec3::new(-3.0, y, 0.0), DVec3::X));
        assert!(beside(1.0 - 1e-15).is_some(), "{shape:?}");
        assert!(beside(1.0 + 1e-15).is_none(), "{shape:?}");
    }
}

/// The nearest point is on the surface, as far away as it says, and as far as the distance that the
/// shape brings; of a primitive that has it. Under a transform that turns and scales, all is as
/// before, elsewhere and larger.
#[test]
fn the_nearest_point_is_at_the_distance() {
    let turned = DAffine3::from_scale_rotation_translation(
        DVec3::splat(2.5),
        DQuat::from_rotation_y(0.7) * DQuat::from_rotation_x(-1.1),
        DVec3::new(3.0, -8.0, 0.5),
    );
    let turned = Transform::new(turned).unwrap();
    for shape in Shape::examples() {
        let mut numbers = RandomNumbers(7);
        for k in 0..2000 {
            let from = numbers.point([1.0, 4.0, 40.0][k % 3]);
            let scale = 1.0 + from.length();
            let nearest = |from: DVec3, place: &Transform| {
                let mut all = Vec::new();
                shape.nearest(from, place, &mut |nearest| all.push(nearest));
                all.into_iter().reduce(Nearest::or).unwrap()
            };
            let found = nearest(from, &Transform::IDENTITY);
            let what = || format!("{shape:?} {from}: {found:?}");
            let (distance, expected) = (found.squared.sqrt(), shape.distance(from).abs());
            assert!((distance - expected).abs() < TOLERANCE * scale, "{}", what());
            let on = shape.distance(found.point).abs();
            assert!(on < TOLERANCE * scale, "{}: {on}", what());
            let apart = found.point.distance(from);
            assert!((apart - distance).abs() < TOLERANCE * scale, "{}", what());
            let onto = shape.onto(found.point, found.primitive);
            assert!(onto.distance(found.point) < TOLERANCE * scale, "{}", what());

            let elsewhere = nearest(turned.point_in_world(from), &turned);
            let off = elsewhere.squared.sqrt() - 2.5 * distance;
            assert!(off.abs() < 4.0 * TOLERANCE * scale, "{}: {elsewhere:?}", what());
        }
    }
}

/// The reference under a transform that stretches: the smallest distance to many points of the
/// surface, which rays find.
#[test]
fn stretched_shapes_are_measured_in_the_world() {
    let stretch = DMat3::from_cols_array(&[2.0, 0.1, 0.0, -0.5, 0.7, 0.3, 0.0, 0.2, 1.3]);
    let place = DAffine3::from_mat3_translation(stretch, DVec3::new(0.5, -0.2, 0.1));
    let place = Transform::new(place).unwrap();
    for shape in Shape::examples() {
        if !shape.is_measurable(&place) {
            shape.nearest(DVec3::ONE, &place, &mut |_| panic!("{shape:?}"));
            continue;
        }
        let mut numbers = RandomNumbers(3);
        let surface: Vec<DVec3> = rays(&shape)
            .iter()
            .filter_map(|ray| Some(place.point_in_world(ray.at(shape.intersect(ray)?.t))))
            .collect();
        let mut smallest = f64::INFINITY;
        for k in 0..100 {
            let from = numbers.point([1.0, 4.0][k % 2]);
            let mut found: Option<Nearest> = None;
            shape.nearest(from, &place, &mut |nearest| {
                found = Some(found.map_or(nearest, |found| found.or(nearest)));
            });
            let found = found.unwrap();
            let distance = found.squared.sqrt();
            let seen = surface.iter().map(|point| point.distance(from));
            let seen = seen.fold(f64::INFINITY, f64::min);
            assert!(distance <= seen + TOLERANCE, "{shape:?} {from}: {seen} {found:?}");
            smallest = smallest.min(seen - distance);
            // And it is a point of the surface.
            let back = place.object_from_world().transform_point3(found.point);
            assert!(shape.distance(back).abs() < 10.0 * TOLERANCE, "{shape:?} {from}: {found:?}");
            assert!((found.point.distance(from) - distance).abs() < 10.0 * TOLERANCE);
        }
        // Some of the many points are about as near.
        assert!(smallest < 0.02, "{shape:?}: {smallest}");
    }
}
