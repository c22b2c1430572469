//! Distances to triangles against rational arithmetic.

use firsthit::nearest::{Method, NearestSettings, closest_points_with};
use firsthit::{DVec3, Object};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use crate::support::rational::{Exact, cross, dot, exact, minus, number};
use crate::support::{Numbers, cases, mesh, rounds, scene};

/// The nearest point of a triangle: the square of its distance, and the weights of the corners 1
/// and 2.
fn judged(point: &Exact, [a, b, c]: [&Exact; 3]) -> (BigRational, [BigRational; 2]) {
    let zero = BigRational::zero;
    let one = BigRational::one;
    let squared = |p: &Exact| dot(p, p);
    let normal = cross(&minus(b, a), &minus(c, a));
    let area = squared(&normal);
    let side = |p: &Exact, q: &Exact| dot(&normal, &cross(&minus(p, point), &minus(q, p)));
    let (u, v, w) = (side(b, c), side(c, a), side(a, b));
    if area.is_positive() && !u.is_negative() && !v.is_negative() && !w.is_negative() {
        let way = dot(&minus(a, point), &normal);
        return (&way * &way / &area, [v / &area, w / &area]);
    }
    let edge = |p: &Exact, q: &Exact| {
        let (edge, length) = (minus(q, p), squared(&minus(q, p)));
        let share = if length.is_zero() { zero() } else { dot(&minus(point, p), &edge) / length };
        let share = share.max(zero()).min(one());
        let offset: Exact = std::array::from_fn(|k| &p[k] + &share * &edge[k] - &point[k]);
        (squared(&offset), share)
    };
    let [first, second, third] = [edge(a, b), edge(b, c), edge(c, a)];
    let mut nearest = (first.0, [first.1, zero()]);
    if second.0 < nearest.0 {
        nearest = (second.0, [one() - &second.1, second.1]);
    }
    if third.0 < nearest.0 {
        nearest = (third.0, [zero(), one() - third.1]);
    }
    nearest
}

/// Triangles of all kinds: large, small, needles, slivers, flat ones, points; with few digits and
/// with many.
fn triangle(k: usize, numbers: &mut Numbers) -> [DVec3; 3] {
    let [mut a, mut b, mut c] = [0; 3].map(|_| numbers.point());
    match k % 8 {
        1 => c = a.lerp(b, numbers.unit()) + 1e-9 * numbers.point(),
        2 => c = a + 1e-7 * numbers.point(),
        3 => (b, c) = (a + 1e-4 * numbers.point(), a + 1e-4 * numbers.point()),
        4 => [a, b, c] = [a, b, c].map(|p| (4.0 * p).round()),
        5 => [a, b, c] = [a, b, c].map(|p| 1e4 + p),
        6 => c = a + (b - a) * (1.0 + 1e-12),
        _ if k % 80 == 7 => b = a,
        _ if k % 80 == 15 => (b, c) = (a, a),
        _ => {}
    }
    let scale = [1.0, 1e-60, 1e50, 1e-3][k / 8 % 4];
    [scale * a, scale * b, scale * c]
}

/// A point near or far, above the inside, the edges and the corners, or hardly beside the regions'
/// borders.
fn point(k: usize, [a, b, c]: [DVec3; 3], numbers: &mut Numbers) -> DVec3 {
    let size = (b - a).length().max((c - a).length()).max(1e-70);
    let on = match k % 5 {
        0 => a.lerp(b, numbers.unit()).lerp(c, numbers.unit()),
        1 => a.lerp(b, 0.5),
        2 => b,
        3 => b.lerp(c, 3.0 * numbers.unit() - 1.0),
        _ => a + (b - a) + (c - a),
    };
    let height = [0.0, 1e-16, 1e-12, 1e-6, 1e-2, 1.0, 1e3, 1e9][k / 5 % 8] * size;
    let normal = (b - a).cross(c - a) / size;
    let beside = [0.0, 0.0, 1e-15, 1e-3][k / 40 % 4] * size;
    on + height * [normal / size, numbers.point()][k / 160 % 2] + beside * numbers.point()
}

#[test]
fn distances_are_off_by_a_few_units_in_the_last_place() {
    let mut numbers = Numbers::new(1);
    let mut worst: f64 = 0.0;
    let mut regions = [0; 3];
    for k in 0..cases(12_000) {
        let corners = triangle(k / 3, &mut numbers);
        let from = point(k, corners, &mut numbers);
        let of_one = scene(vec![Object::new(mesh(&corners, vec![[0, 1, 2]]))]);
        let found = [Method::BruteForce, Method::default()].map(|method| {
            let points = [from.to_array()];
            closest_points_with(method, &of_one, &points, NearestSettings::default(), &()).unwrap()
        });
        assert_eq!(found[0].distance, found[1].distance);
        let found = found[0].get(0, 0).unwrap();
        let of_mesh = of_one.objects()[0].mesh().unwrap().corners(0);
        let [a, b, c] = of_mesh.map(exact);
        let (squared, weights) = judged(&exact(from), [&a, &b, &c]);
        // Twice the relative error, and twice the distance times what is lost by cancellation; of a
        // triangle that is thinner than 2^-50, all of that. In exact arithmetic, as the root is
        // irrational.
        let distance = number(found.distance);
        let off = (&distance * &distance - &squared).abs();
        let distances = of_mesh.map(|p| p.distance(from));
        let size = distances.into_iter().fold(0.0, f64::max);
        let edges = [minus(&b, &a), minus(&c, &a), minus(&c, &b)];
        let longest = edges.iter().map(|edge| dot(edge, edge)).max().unwrap();
        let normal = cross(&edges[0], &edges[1]);
        let is_thin = dot(&normal, &normal) < &longest * &longest * number(1.6e-30);
        let lost = number(size * if is_thin { 1.8e-15 } else { 8.1e-28 });
        let negligible = (&distance + &distance + &lost) * &lost;
        if off > negligible {
            let ulps = ((&off - &negligible) / &squared).to_f64().unwrap() / f64::EPSILON;
            worst = worst.max(ulps);
            assert!(ulps < 40.0, "{k} {of_mesh:?} {from}: {found:?} off by {ulps}");
        }
        // The point is in the triangle, and as far away as it says.
        let largest = of_mesh.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let largest = largest.max(from.abs().max_element());
        let apart = (found.point.distance(from) - found.distance).abs();
        assert!(apart <= 16.0 * f64::EPSILON * largest, "{k} {of_mesh:?} {from}: {found:?}");
        // The feature is the exact one: a weight that is zero, or not. (On the border of two
        // regions both are.)
        let zeros = |v: f64, w: f64| [v == 0.0, w == 0.0, v + w == 1.0];
        let [v, w] = [0, 1].map(|k| weights[k].to_f64().unwrap());
        let (exactly, here) = (zeros(v, w), zeros(found.barycentric.x, found.barycentric.y));
        let least = v.min(w).min(1.0 - v - w);
        let is_inside = !exactly.contains(&true);
        if is_inside && least > 1e-6 && !is_thin {
            assert_eq!(here, exactly, "{k} {of_mesh:?} {from}: {found:?} {v} {w}");
        }
        regions[exactly.iter().filter(|&&zero| zero).count().min(2)] += 1;
    }
    let enough = cases(500);
    assert!(regions.iter().all(|&count| count > enough), "{regions:?}");
    assert!(worst > 0.4, "{worst}: were distances compared at all?");
}

/// Of a mesh too: the nearest triangle is exactly the nearest, or off by what the distances are.
#[test]
fn the_nearest_triangle_is_the_nearest() {
    let mut numbers = Numbers::new(8);
    for round in rounds(40) {
        let mut corners = Vec::new();
        for k in 0..30 {
            corners.extend(triangle(8 * 4 * k + [0, 1, 2, 4][k % 4], &mut numbers));
        }
        let triangles = (0..30).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let soup = scene(vec![Object::new(mesh(&corners, triangles))]);
        let shape = soup.objects()[0].mesh().unwrap().clone();
        for _ in 0..4 {
            let from = numbers.point() * [1.0, 3.0][round % 2];
            let points = [from.to_array()];
            let wanted = NearestSettings::default();
            let found = closest_points_with(Method::default(), &soup, &points, wanted, &());
            let found = found.unwrap().get(0, 0).unwrap();
            let squared = |triangle: usize| {
                let [a, b, c] = shape.corners(triangle).map(exact);
                judged(&exact(from), [&a, &b, &c]).0
            };
            let all: Vec<BigRational> = (0..30).map(squared).collect();
            let least = all.iter().min().unwrap();
            let own = &all[found.primitive as usize];
            let slack = number(80.0 * f64::EPSILON);
            assert!((own - least) <= slack * least, "{from} {found:?}");
        }
    }
}
