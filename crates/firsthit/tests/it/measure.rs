//! Inside and outside: against rational arithmetic, closed forms, and cells that fill space without
//! a gap.

use std::array::from_fn;

use firsthit::measure::{
    FillRule, Grouping, Rule, inside, inside_with, path_lengths, path_lengths_with, rules,
    thickness, winding_number,
};
use firsthit::shoot::{Count, trace};
use firsthit::watch::Watch;
use firsthit::{
    Cone, Cuboid, Cylinder, DAffine3, DMat3, DVec3, Disc, Error, Mesh, Object, Plane, Ray, Sphere,
    Transform,
};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use crate::support::rational::{Exact, cross, dot, exact, minus};
use crate::support::{CUBE, Numbers, bumpy_sphere, cases, mesh, on_threads, scene, soak_rays};

/// The direction in which a point on the surface is looked ahead.
const AHEAD: DVec3 = DVec3::new(7.0, 10.0, 10.5);

const CORNERS: [DVec3; 8] = [
    DVec3::new(0.0, 0.0, 0.0),
    DVec3::new(1.0, 0.0, 0.0),
    DVec3::new(0.0, 1.0, 0.0),
    DVec3::new(1.0, 1.0, 0.0),
    DVec3::new(0.0, 0.0, 1.0),
    DVec3::new(1.0, 0.0, 1.0),
    DVec3::new(0.0, 1.0, 1.0),
    DVec3::new(1.0, 1.0, 1.0),
];

fn cube(corner: DVec3, size: f64) -> Vec<DVec3> {
    CORNERS.iter().map(|&point| corner + size * point).collect()
}

/// `2^-k`.
fn tiny(k: usize) -> BigRational {
    BigRational::one() / BigRational::from_integer(num_traits::pow(2.into(), k))
}

/// The point that stands for one on the surface: a little ahead, and far less than that beside.
fn just_ahead(point: DVec3) -> Exact {
    let (point, ahead) = (exact(point), exact(AHEAD));
    from_fn(|k| &point[k] + &ahead[k] * tiny(300) + tiny(600 * (k + 1)))
}

/// Whether a point is inside, by the parity of crossings with a ray that meets no edge; `None` on
/// the surface.
fn is_inside_exactly(mesh: &Mesh, point: &Exact, numbers: &mut Numbers) -> Option<bool> {
    'another: loop {
        let way = exact((1e4 * numbers.point()).round());
        let mut is_inside = false;
        for triangle in 0..mesh.triangles().len() {
            let [a, b, c] = mesh.corners(triangle).map(|corner| minus(&exact(corner), point));
            let n = cross(&minus(&b, &a), &minus(&c, &a));
            if n.iter().all(Zero::is_zero) {
                continue;
            }
            let height = dot(&n, &a);
            let sides = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| cross(p, q));
            if height.is_zero() {
                // In the plane: within, if it is on one side of all edges.
                let sides = sides.each_ref().map(|side| dot(&n, side));
                if !sides.iter().any(Signed::is_negative) {
                    return None;
                }
                // A ray from there meets the plane nowhere else.
                continue;
            }
            let sides = sides.map(|side| dot(&way, &side));
            let slope = dot(&n, &way);
            if slope.is_zero() || sides.iter().any(Zero::is_zero) {
                continue 'another;
            }
            let is_through =
                sides.iter().all(Signed::is_positive) || sides.iter().all(Signed::is_negative);
            is_inside ^= is_through && height.is_positive() == slope.is_positive();
        }
        return Some(is_inside);
    }
}

/// The bumpy sphere: with few digits, as a needle, as a leaf, or far from the origin.
fn adversarial(seed: u64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (points, triangles) = bumpy_sphere(3 + (seed % 3) as u32, 5 + seed);
    let few = |v: DVec3, digits: f64| (v * digits).round() / digits;
    let formed = points.iter().map(|&point| match seed % 6 {
        0 => few(3.0 * point, 1.0),
        1 => few(3.0 * point, 8.0),
        2 => point * DVec3::new(1e-9, 1.0, 1e3),
        3 => few(point, 4.0) * DVec3::new(1.0, 1.0, 1e-12),
        4 => few(point, 16.0) + DVec3::new(1e7, -3e8, 1e9),
        _ => 1e-40 * point,
    });
    (formed.collect(), triangles)
}

/// Points on corners, edges and faces, on rays that meet those, next to them, and anywhere.
fn points_for(points: &[DVec3], triangles: &[[u32; 3]], numbers: &mut Numbers) -> Vec<DVec3> {
    let (low, high) = points
        .iter()
        .fold((points[0], points[0]), |(low, high), &point| (low.min(point), high.max(point)));
    let size = high - low;
    let all = (0..90).map(|k| {
        let [p, q, r] = triangles[numbers.below(triangles.len())].map(|k| points[k as usize]);
        let back = AHEAD * size.max_element() / 64.0;
        let at = [p, 0.5 * (p + q), p + 0.25 * (q - p) + 0.5 * (r - p)][k % 3];
        match k / 3 % 5 {
            0 => at,
            1 => at - back,
            2 => at + 0.25 * back,
            // Not 5e-324, which with ordinary numbers leaves the range of products.
            3 => DVec3::new(at.x, at.y.next_up().max(at.y + 1e-100), at.z),
            _ => low + 0.5 * size + 0.5 * size * numbers.point(),
        }
    });
    all.collect()
}

#[test]
fn points_are_inside_as_exact_arithmetic_has_it() {
    let (mut held, mut touched, mut total) = (0, 0, 0);
    for seed in 0..6 {
        let mut numbers = Numbers::new(seed);
        let (points, triangles) = adversarial(seed);
        let mut asked = points_for(&points, &triangles, &mut numbers);
        // At least one of each kind.
        asked.truncate(cases(asked.len()).max(15));
        let scene = scene(vec![Object::new(mesh(&points, triangles))]);
        let mesh = scene.objects()[0].mesh().unwrap();
        let answers = inside(&scene, &asked, Grouping::Union, &()).unwrap();
        assert_eq!(answers.rules, [Rule::Nonzero]);
        for (&point, &answer) in asked.iter().zip(&answers.is_inside) {
            let expected = is_inside_exactly(mesh, &exact(point), &mut numbers);
            let expected = expected.unwrap_or_else(|| {
                touched += 1;
                is_inside_exactly(mesh, &just_ahead(point), &mut numbers).unwrap()
            });
            assert_eq!(answer, expected, "{seed}: {point:?}");
            held += usize::from(answer);
        }
        total += asked.len();
    }
    assert!(
        held > total / 5 && held < total * 4 / 5 && touched > total / 20,
        "{held} and {touched} of {total}"
    );
}

/// 27 cells without a gap, each a mesh or a box of its own.
fn cells() -> Vec<Object> {
    let cell = |k: u32| {
        let corner = DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
        if k.is_multiple_of(2) {
            Object::new(mesh(&cube(corner, 1.0), CUBE.to_vec()))
        } else {
            Object::new(Cuboid::new(corner, corner + 1.0).unwrap())
        }
    };
    (0..27).map(cell).collect()
}

#[test]
fn of_cells_without_a_gap_exactly_one_holds_each_point() {
    let scene = scene(cells());
    let quarters = |k: usize| f64::from(u32::try_from(k).unwrap()) / 4.0;
    let points: Vec<_> = (0..13 * 13 * 13)
        .map(|k| DVec3::new(quarters(k % 13), quarters(k / 13 % 13), quarters(k / 169)))
        .collect();
    let answers = inside(&scene, &points, Grouping::Object, &()).unwrap().is_inside;
    let union = inside(&scene, &points, Grouping::Union, &()).unwrap().is_inside;
    for ((point, of_cells), is_inside) in points.iter().zip(answers.chunks(27)).zip(union) {
        // Looking ahead, all faces behind a point are its own.
        let expected = point.max_element() < 3.0;
        let held = of_cells.iter().filter(|&&held| held).count();
        assert_eq!((held, is_inside), (usize::from(expected), expected), "{point:?}");
        if expected {
            let [x, y, z] = point.floor().to_array().map(|x| x as usize);
            assert!(of_cells[x + 3 * y + 9 * z], "{point:?}");
        }
    }
}

#[test]
fn a_ray_through_cells_without_a_gap_is_inside_all_along() {
    let scene = scene(cells());
    let mut numbers = Numbers::new(4);
    let mut rays = Vec::new();
    while rays.len() < 2000 {
        // Through corners of cells, in their planes and along their edges, too.
        let few = |v: DVec3| (2.0 * v).round() / 2.0;
        let (through, way) = (1.5 + few(1.5 * numbers.point()), few(2.0 * numbers.point()));
        if way != DVec3::ZERO {
            rays.push(Ray::new(through - 8.0 * way, way));
        }
    }
    let each = path_lengths(&scene, &rays, Grouping::Object, &()).unwrap();
    let union = path_lengths(&scene, &rays, Grouping::Union, &()).unwrap();
    let mut inner = 0;
    for ((ray, lengths), union) in rays.iter().zip(each.chunks(27)).zip(union) {
        let ends = [0, 1, 2].map(|k| {
            let (at, along) = (ray.origin[k], ray.direction[k]);
            let ends = [-at / along, (3.0 - at) / along];
            if along == 0.0 {
                // In the lowest plane a ray beside is within, in the highest it is not.
                let is_within = (0.0..3.0).contains(&at);
                return if is_within { (f64::NEG_INFINITY, f64::INFINITY) } else { (0.0, 0.0) };
            }
            (ends[0].min(ends[1]), ends[0].max(ends[1]))
        });
        let enter = ends.iter().fold(0.0, |t: f64, end| t.max(end.0));
        let exit = ends.iter().fold(f64::INFINITY, |t, end| t.min(end.1));
        let expected = (exit - enter).max(0.0) * ray.direction.length();
        // A box holds the planes in which its faces are.
        let is_in_outer_plane =
            (0..3).any(|k| ray.direction[k] == 0.0 && [0.0, 3.0].contains(&ray.origin[k]));
        let is_in_plane = (0..3).any(|k| ray.direction[k] == 0.0 && ray.origin[k].fract() == 0.0);
        if !is_in_outer_plane {
            assert!((union - expected).abs() < 1e-12, "{ray:?} {union} {expected}");
            inner += usize::from(expected > 0.0);
        }
        if !is_in_plane {
            let sum: f64 = lengths.iter().sum();
            assert!((sum - union).abs() < 1e-12, "{ray:?}");
        }
    }
    assert!(inner > 1000, "{inner}");
}

#[test]
fn solids_hold_what_their_formulas_say() {
    let turn = DMat3::from_cols_array(&[0.0, 0.6, -0.8, 1.5, 0.0, 0.0, 0.0, 2.4, 1.8]);
    let place = Transform::new(DAffine3::from_mat3_translation(turn, DVec3::splat(0.25))).unwrap();
    let back = place.object_from_world();
    let z = DVec3::Z;
    let objects = vec![
        Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
        Object::new(Cuboid::new(DVec3::splat(-0.5), DVec3::splat(0.75)).unwrap()),
        Object::new(Cylinder::new(DVec3::ZERO, z, 0.5).unwrap()),
        Object::new(Cone::new(DVec3::ZERO, z, 1.0, 0.5).unwrap()),
        Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()).placed(place),
        Object::new(mesh(&cube(DVec3::ZERO, 1.0), CUBE.to_vec())).placed(place),
        Object::new(Plane::new(DVec3::ZERO, z).unwrap()),
        Object::new(Disc::new(DVec3::ZERO, z, 2.0).unwrap()),
    ];
    // How far inside, in some measure.
    let depths = |p: DVec3| {
        let in_box = |p: DVec3, low: DVec3, high: DVec3| (p - low).min(high - p).min_element();
        let (radius, q) = (p.truncate().length(), back.transform_point3(p));
        [
            1.0 - p.length(),
            in_box(p, DVec3::splat(-0.5), DVec3::splat(0.75)),
            (0.5 - radius).min(p.z).min(1.0 - p.z),
            (1.0 - 0.5 * p.z - radius).min(p.z).min(1.0 - p.z),
            1.0 - q.length(),
            in_box(q, DVec3::ZERO, DVec3::ONE),
            -1.0,
            -1.0,
        ]
    };
    let scene = scene(objects);
    let mut numbers = Numbers::new(9);
    let points: Vec<_> = (0..40_000).map(|_| 1.5 * numbers.point()).collect();
    let answers = inside(&scene, &points, Grouping::Object, &()).unwrap();
    let names: Vec<_> = answers.rules.iter().map(|rule| rule.name()).collect();
    assert_eq!(names.join(" "), "nonzero nonzero nonzero nonzero nonzero nonzero none none");
    let mut held = [0; 8];
    for (&point, row) in points.iter().zip(answers.is_inside.chunks(8)) {
        for (k, depth) in depths(point).into_iter().enumerate() {
            if depth.abs() > 1e-12 {
                assert_eq!(row[k], depth > 0.0, "{k} {point:?}");
            }
            held[k] += usize::from(row[k]);
        }
    }
    assert!(held[..6].iter().all(|&count| count > 100), "{held:?}");
    let nowhere =
        [DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e200), DVec3::new(0.1, 0.1, f64::NAN)];
    let answers = inside(&scene, &nowhere, Grouping::Object, &()).unwrap();
    assert!(!answers.is_inside.contains(&true));
}

/// A torus around the z axis, its radii 2 and 1; a point of it lies by less than `1 - cos(pi / 64)`
/// within the true one.
fn torus() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let count = 64_u32;
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k % count) / f64::from(count);
    let point = |k: u32, l: u32| {
        let ((s, c), (v, u)) = (libm::sincos(angle(k)), libm::sincos(angle(l)));
        DVec3::new(c * (2.0 + u), s * (2.0 + u), v)
    };
    let points = (0..count * count).map(|k| point(k / count, k % count)).collect();
    let at = |k: u32, l: u32| k % count * count + l % count;
    let faces = (0..count * count).flat_map(|k| {
        let (k, l) = (k / count, k % count);
        let [a, b, c, d] = [at(k, l), at(k + 1, l), at(k + 1, l + 1), at(k, l + 1)];
        [[a, b, c], [a, c, d]]
    });
    (points, faces.collect())
}

#[test]
fn a_torus_and_its_chords_are_as_their_formulas() {
    let (points, triangles) = torus();
    let scene = scene(vec![Object::new(mesh(&points, triangles))]);
    let mut numbers = Numbers::new(2);
    let asked: Vec<_> = (0..20_000).map(|_| 3.2 * numbers.point()).collect();
    let answers = inside(&scene, &asked, Grouping::Union, &()).unwrap().is_inside;
    let off = |p: DVec3| {
        let ring = p.truncate().length() - 2.0;
        (ring * ring + p.z * p.z).sqrt() - 1.0
    };
    let mut count = 0;
    for (&point, &answer) in asked.iter().zip(&answers) {
        if !(-0.005..1e-12).contains(&off(point)) {
            assert_eq!(answer, off(point) < 0.0, "{point:?}");
            count += usize::from(answer);
        }
    }
    assert!(count > 1000);
    // Along the x axis: through corners of the mesh, twice in and out, 2 each.
    let along = Ray::new(DVec3::new(9.0, 0.0, 0.0), DVec3::new(-0.5, 0.0, 0.0));
    let rays = [along, along.up_to(14.0), along.beyond(14.0), along.beyond(f64::NEG_INFINITY)];
    let lengths = path_lengths(&scene, &rays, Grouping::Union, &()).unwrap();
    for (length, expected) in lengths.iter().zip([4.0, 1.0, 3.0, 4.0]) {
        assert!((length - expected).abs() < 1e-12, "{lengths:?}");
    }
}

#[test]
fn a_shell_within_a_shell_is_a_hollow() {
    let points = [cube(DVec3::ZERO, 4.0), cube(DVec3::ONE, 2.0)].concat();
    // Inwards; or by parity, where that is of no account.
    for (flip, rule) in
        [(false, FillRule::Parity), (true, FillRule::Parity), (true, FillRule::Nonzero)]
    {
        let inner =
            CUBE.map(|[a, b, c]| if flip { [a + 8, c + 8, b + 8] } else { [a + 8, b + 8, c + 8] });
        let triangles = [CUBE, inner].concat();
        let scene = scene(vec![Object::new(mesh(&points, triangles))]);
        let asked =
            [DVec3::splat(2.0), DVec3::splat(0.5), DVec3::new(2.0, 2.0, 3.5), DVec3::NEG_ONE];
        let answers = inside_with(rule, &scene, &asked, Grouping::Union, &()).unwrap().is_inside;
        assert_eq!(answers, [false, true, true, false]);
        let ray = Ray::new(DVec3::new(-1.0, 2.0, 2.0), DVec3::X);
        let lengths = path_lengths_with(rule, &scene, &[ray], Grouping::Union, &());
        assert_eq!(lengths.unwrap(), [2.0]);
    }
}

/// A cube without its top.
#[test]
fn an_open_mesh_goes_by_its_winding_number_and_says_so() {
    for flip in [false, true] {
        let walls = CUBE[..10].iter().map(|&[a, b, c]| if flip { [a, c, b] } else { [a, b, c] });
        let open = mesh(&cube(DVec3::splat(-1.0), 2.0), walls.collect());
        let number = winding_number(&open, DVec3::ZERO, &()).unwrap();
        assert!((number.abs() - 5.0 / 6.0).abs() < 1e-15, "{number}");
        let place = Transform::translation(DVec3::new(0.0, 0.0, 5.0)).unwrap();
        let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
        let scene = scene(vec![Object::new(open).placed(place), ball]);
        assert_eq!(rules(&scene).unwrap(), [Rule::WindingNumber, Rule::Nonzero]);
        let at = |z| DVec3::new(0.1, 0.2, z);
        let asked = [at(5.0), at(4.1), at(6.5), at(3.5), at(0.0)];
        let union = inside(&scene, &asked, Grouping::Union, &()).unwrap().is_inside;
        assert_eq!(union, [true, true, false, false, true]);
        let each = inside(&scene, &asked, Grouping::Object, &()).unwrap().is_inside;
        assert_eq!(each[..4], [true, false, true, false]);
        assert_eq!(each[8..], [false, true]);
        let rays = [
            // Through two walls; out of a wall; through the bottom alone; out of the top; past.
            Ray::new(DVec3::new(-9.0, 0.1, 5.0), DVec3::X),
            Ray::new(DVec3::new(0.0, 0.1, 5.0), DVec3::X),
            Ray::new(at(9.0), DVec3::NEG_Z).up_to(6.0),
            Ray::new(at(5.0), DVec3::Z),
            Ray::new(at(7.0), DVec3::Z),
        ];
        let lengths = path_lengths(&scene, &rays, Grouping::Object, &()).unwrap();
        let of_open: Vec<_> = lengths.chunks(2).map(|row| row[0]).collect();
        assert_eq!(of_open[..2], [2.0, 1.0]);
        assert!(of_open[2].is_nan() && of_open[3].is_nan());
        assert_eq!((of_open[4], lengths[1]), (0.0, 0.0));
        let union = path_lengths(&scene, &rays, Grouping::Union, &()).unwrap();
        assert!(union[2].is_nan() && union[0] == 2.0);
    }
}

/// Of a closed mesh both rules say the same, away from its surface.
#[test]
fn the_winding_number_of_a_closed_mesh_is_whole() {
    let (points, triangles) = bumpy_sphere(8, 3);
    let closed = mesh(&points, triangles);
    let scene = scene(vec![Object::new(closed.clone())]);
    let mut numbers = Numbers::new(6);
    let asked: Vec<_> = (0..2000).map(|_| 1.4 * numbers.point()).collect();
    let answers = inside(&scene, &asked, Grouping::Union, &()).unwrap().is_inside;
    for (&point, &answer) in asked.iter().zip(&answers) {
        let number = winding_number(&closed, point, &()).unwrap();
        assert!((number - f64::from(u8::from(answer))).abs() < 1e-9, "{point:?} {number}");
    }
    // At every scale.
    for scale in [1e-140, 1e140] {
        let scaled: Vec<_> = points.iter().map(|&point| scale * point).collect();
        let scaled = mesh(&scaled, closed.triangles().to_vec());
        let number = winding_number(&scaled, scale * DVec3::splat(0.01), &()).unwrap();
        assert!((number - 1.0).abs() < 1e-9, "{number}");
    }
}

#[test]
fn parts_of_a_ray_add_up_to_it() {
    let mut numbers = Numbers::new(8);
    let (points, triangles) = bumpy_sphere(6, 1);
    let ball = Sphere::new(DVec3::splat(0.3), 0.8).unwrap();
    let scene = scene(vec![Object::new(mesh(&points, triangles)), Object::new(ball)]);
    let (mut whole, mut before, mut after) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..3000 {
        let ray = Ray::new(2.0 * numbers.point(), 3.0 * numbers.point());
        let t = 1.5 * numbers.unit();
        whole.push(ray);
        before.push(ray.up_to(t));
        after.push(ray.beyond(t));
    }
    for by in [Grouping::Object, Grouping::Union] {
        let [whole, before, after] =
            [&whole, &before, &after].map(|rays| path_lengths(&scene, rays, by, &()).unwrap());
        let mut longest: f64 = 0.0;
        for (whole, (before, after)) in whole.iter().zip(before.iter().zip(&after)) {
            assert!((whole - before - after).abs() < 1e-12);
            longest = longest.max(*whole);
        }
        assert!(longest > 1.0);
    }
    // By object, at least as much as by union, and the ball's as the formula has it.
    let each = path_lengths(&scene, &whole, Grouping::Object, &()).unwrap();
    let union = path_lengths(&scene, &whole, Grouping::Union, &()).unwrap();
    for ((ray, row), union) in whole.iter().zip(each.chunks(2)).zip(union) {
        assert!(row[0].max(row[1]) <= union + 1e-12 && union <= row[0] + row[1] + 1e-12);
        let unit = ray.direction.normalize();
        let along = (ball.center() - ray.origin).dot(unit);
        let off = (ray.origin + along * unit - ball.center()).length_squared();
        let half = (0.64 - off).max(0.0).sqrt();
        let chord = (along + half).max(0.0) - (along - half).max(0.0);
        assert!((row[1] - chord).abs() < 1e-7, "{ray:?}");
    }
}

#[test]
fn the_answers_are_the_same_with_any_number_of_threads() {
    let (points, triangles) = bumpy_sphere(6, 1);
    let mut holed = triangles.clone();
    holed.truncate(60);
    let scene =
        scene(vec![Object::new(mesh(&points, triangles)), Object::new(mesh(&points, holed))]);
    let mut numbers = Numbers::new(5);
    // More than a block.
    let asked: Vec<_> = (0..20_000).map(|_| 1.3 * numbers.point()).collect();
    let rays: Vec<_> = asked.iter().map(|&point| Ray::new(point, numbers.point())).collect();
    let answers = |threads| {
        on_threads(threads, || {
            let lengths = path_lengths(&scene, &rays, Grouping::Object, &()).unwrap();
            let bits: Vec<_> = lengths.iter().map(|length| length.to_bits()).collect();
            (inside(&scene, &asked, Grouping::Object, &()).unwrap(), bits)
        })
    };
    let (one, three) = (answers(1), answers(3));
    assert_eq!(one, three);
    // Few at a time, by one thread alone.
    for (number, few) in asked.chunks(100).enumerate().step_by(20) {
        let few = inside(&scene, few, Grouping::Object, &()).unwrap().is_inside;
        assert_eq!(few, one.0.is_inside[200 * number..][..200]);
    }
}

struct Stopped;

impl Watch for Stopped {
    fn is_stopped(&self) -> bool {
        true
    }
}

#[test]
fn both_can_be_stopped_and_need_no_objects() {
    let full = scene(cells());
    let (points, rays) = ([DVec3::ZERO; 3], [Ray::new(DVec3::ZERO, DVec3::X); 3]);
    let stopped = inside(&full, &points, Grouping::Object, &Stopped).unwrap_err();
    assert!(matches!(stopped, Error::Interrupted));
    assert!(matches!(
        path_lengths(&full, &rays, Grouping::Union, &Stopped),
        Err(Error::Interrupted)
    ));
    let (points_, triangles) = bumpy_sphere(3, 1);
    let open = mesh(&points_, triangles[1..].to_vec());
    assert!(matches!(winding_number(&open, DVec3::ZERO, &Stopped), Err(Error::Interrupted)));
    let empty = scene(Vec::new());
    let of_nothing = inside(&empty, &points, Grouping::Object, &()).unwrap();
    assert!(of_nothing.is_inside.is_empty());
    assert_eq!(inside(&empty, &points, Grouping::Union, &()).unwrap().is_inside, [false; 3]);
    assert_eq!(path_lengths(&empty, &rays, Grouping::Union, &()).unwrap(), [0.0; 3]);
    let none: [Ray; 0] = [];
    let lengths = path_lengths(&full, &none, Grouping::Object, &()).unwrap();
    assert!(lengths.is_empty());
}

#[test]
fn rays_from_outside_cross_closed_meshes_in_pairs() {
    crossed_in_pairs(cases(400_000), cases(50_000));
}

/// `FIRSTHIT_SOAK` says how many rays; see the Makefile.
#[test]
#[ignore = "takes long: make soak"]
fn soak_closed_meshes() {
    crossed_in_pairs(soak_rays(), 100_000);
}

/// Shoots rays through edges and corners, along edges and in planes, so many at once at each mesh.
fn crossed_in_pairs(rays: usize, at_once: usize) {
    let (mut total, mut crossings) = (0_usize, 0_u64);
    for seed in 0.. {
        if total >= rays {
            break;
        }
        let mut numbers = Numbers::new(seed);
        let (points, triangles) = match seed % 8 {
            6 => torus(),
            7 => bumpy_sphere(60, seed),
            _ => adversarial(seed),
        };
        let scene = scene(vec![Object::new(mesh(&points, triangles.clone()))]);
        assert_eq!(rules(&scene).unwrap(), [Rule::Nonzero]);
        let bounds = scene.bounds();
        let size = (bounds.high - bounds.low).max_element();
        let mut asked = Vec::new();
        while asked.len() < at_once {
            let [p, q, r] = triangles[numbers.below(triangles.len())].map(|k| points[k as usize]);
            let other = points[numbers.below(points.len())];
            let (through, way) = match asked.len() % 6 {
                0 => (p, size * numbers.point()),
                1 => (0.5 * (p + q), size * numbers.point()),
                2 => (p, other - p),
                3 => (p, q - p),
                4 => (p, 0.25 * (q - p) + 0.5 * (r - p)),
                _ => (p, size * [DVec3::X, DVec3::Y, DVec3::Z][numbers.below(3)]),
            };
            // A power of two, so that few digits stay few; from beyond the box.
            let back = libm::exp2(libm::log2(4.0 * size / way.length()).ceil());
            let origin = through - back * way;
            let is_outside = !(bounds.low.cmple(origin).all() && origin.cmple(bounds.high).all());
            if way != DVec3::ZERO && way.is_finite() && is_outside {
                asked.push(Ray::new(origin, way));
            }
        }
        let counts = trace(&scene, &asked[..], Count, &()).unwrap();
        for (ray, count) in asked.iter().zip(&counts) {
            assert!(count.is_multiple_of(2), "{seed}: {ray:?} {count}");
            crossings += u64::from(*count);
        }
        total += asked.len();
    }
    println!("{total} rays, {crossings} crossings");
    assert!(crossings > total as u64 / 2);
}

/// Ahead of the surface, what is thick is the object itself, whatever else is in it.
#[test]
fn an_object_is_as_thick_as_it_is_deep() {
    let plate = || Cuboid::new(DVec3::splat(-2.0), DVec3::new(2.0, 2.0, 0.5)).unwrap();
    let ball = Sphere::new(DVec3::new(0.0, 0.0, -1.0), 0.5).unwrap();
    let (points, triangles) = bumpy_sphere(4, 2);
    let bumpy: Vec<DVec3> = points.iter().map(|&p| 0.25 * p).collect();
    let scene =
        scene(vec![Object::new(plate()), Object::new(ball), Object::new(mesh(&bumpy, triangles))]);
    let above = [[0.125, 0.25, 0.75], [1.5, 0.0, 3.0], [0.0, 0.0, -2.25], [3.0, 0.25, -1.0]];
    assert_eq!(thickness(&scene, &above, &()).unwrap(), [2.5, 2.5, 2.5, 4.0]);
    // In the ball, the ball is nearest.
    assert_eq!(thickness(&scene, &[[0.0, 0.0, -1.4375]], &()).unwrap(), [1.0]);
    let odd = [[f64::NAN; 3], [f64::INFINITY, 0.0, 0.0]];
    assert!(thickness(&scene, &odd, &()).unwrap().iter().all(|length| length.is_nan()));
}

/// It was infinite: its ray went nowhere.
#[test]
fn the_thickness_at_a_triangle_without_an_area_is_nan() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let mut faces = vec![[0, 1, 0], [0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let beside = [[0.5, -1.0, -1.0], [0.25, 0.25, -1.0]];
    let of = |faces: Vec<[u32; 3]>| {
        let scene = scene(vec![Object::new(mesh(&corners, faces))]);
        thickness(&scene, &beside, &()).unwrap()
    };
    // The first of all triangles at the edge.
    let found = of(faces.clone());
    assert!(found[0].is_nan() && found[1] == 0.5, "{found:?}");
    faces.rotate_left(1);
    assert!(of(faces).iter().all(|length| length.is_finite()));
}

/// From a face's middle inwards, an exact ray crosses a closed mesh next where it is as far as it
/// is thick there.
#[test]
fn the_thickness_of_a_mesh_is_that_of_rational_arithmetic() {
    let (points, triangles) = bumpy_sphere(3, 4);
    let scene = scene(vec![Object::new(mesh(&points, triangles))]);
    let mesh = scene.objects()[0].mesh().unwrap();
    let count = mesh.triangles().len();
    let middles = (0..count).map(|k| mesh.corners(k).into_iter().sum::<DVec3>() / 3.0);
    let middles: Vec<DVec3> = middles.collect();
    let asked: Vec<_> = middles.iter().map(DVec3::to_array).collect();
    let found = thickness(&scene, &asked, &()).unwrap();
    for (k, (&from, &found)) in middles.iter().zip(&found).enumerate() {
        let (origin, way) = (exact(from), exact(-mesh.normal(k)));
        let others = (0..count).filter(|&other| other != k).filter_map(|other| {
            let [a, b, c] = mesh.corners(other).map(|corner| minus(&exact(corner), &origin));
            let sides = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&way, &cross(p, q)));
            let is_met =
                sides.iter().all(Signed::is_positive) || sides.iter().all(Signed::is_negative);
            let n = cross(&minus(&b, &a), &minus(&c, &a));
            is_met.then(|| dot(&n, &a) / dot(&n, &way)).filter(Signed::is_positive)
        });
        let expected = others.min().unwrap().to_f64().unwrap();
        assert!((found - expected).abs() < 1e-13, "{k}: {found} {expected}");
    }
}
