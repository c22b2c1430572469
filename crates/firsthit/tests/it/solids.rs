//! Every measure of solids has the same inside, for both rules. The judge is counting: a solid is
//! made of boxes, and how often it goes around a point is how many of them hold it, those that face
//! inwards less those that face outwards.

use firsthit::measure::{
    FillRule, Grouping, Rule, Towards, inside_with, path_lengths_with, rules_with, thickness_along,
    thickness_with,
};
use firsthit::nearest::{SignSettings, closest_point, signed_distances, signed_distances_with};
use firsthit::section::{Section, SectionPlane, section_with};
use firsthit::{
    DAffine3, DMat3, DQuat, DVec2, DVec3, Filtered, Mesh, Object, Ray, RayFilter, Scene, Transform,
    shoot,
};

use crate::support::{Ask, CUBE, Numbers, mesh, scene};

const RULES: [FillRule; 2] = [FillRule::Nonzero, FillRule::Parity];

/// A box, and how often its surface goes around what is in it.
#[derive(Clone, Copy)]
struct Part {
    low: DVec3,
    high: DVec3,
    turns: i32,
}

fn part(low: [f64; 3], high: [f64; 3], turns: i32) -> Part {
    let [low, high] = [low, high].map(DVec3::from);
    Part { low, high, turns }
}

impl Part {
    fn holds(&self, p: DVec3) -> bool {
        self.low.cmplt(p).all() && p.cmplt(self.high).all()
    }

    /// Where a ray goes in, and where it comes out.
    fn stretch(&self, origin: DVec3, way: DVec3) -> Option<[f64; 2]> {
        let [a, b] = [self.low, self.high].map(|corner| (corner - origin) / way);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        (enter < leave).then_some([enter, leave])
    }
}

struct Solid {
    name: &'static str,
    parts: Vec<Part>,
    /// Triangles that are flipped.
    flipped: Vec<usize>,
}

/// Solids as files have them, and their usual defects.
fn solids() -> Vec<Solid> {
    let plate = |turns| part([0.0; 3], [10.0, 10.0, 1.0], turns);
    let cube = |turns| part([-1.0; 3], [1.0; 3], turns);
    let inner = |turns| part([-0.2; 3], [0.2; 3], turns);
    let aside = |turns| part([0.0, -0.5, -1.0], [2.0, 0.75, 1.0], turns);
    let table = [
        ("plate", vec![plate(1)], vec![]),
        ("inside out", vec![plate(-1)], vec![]),
        ("one facet flipped", vec![plate(1)], vec![4]),
        ("inside out but for one facet", vec![plate(-1)], vec![4]),
        ("half of the facets flipped", vec![cube(1)], vec![1, 3, 5, 7, 9, 11]),
        ("twice", vec![cube(1), cube(1)], vec![]),
        ("three times", vec![cube(1), cube(1), cube(1)], vec![]),
        ("twice, one facet flipped", vec![cube(1), cube(1)], vec![17]),
        ("twice, back to back", vec![cube(1), cube(-1)], vec![]),
        ("overlapping", vec![cube(1), aside(1)], vec![]),
        ("overlapping, inside out", vec![cube(-1), aside(-1)], vec![]),
        ("overlapping, one inside out", vec![cube(1), aside(-1)], vec![]),
        ("overlapping, a facet of each flipped", vec![cube(1), aside(1)], vec![3, 19]),
        (
            "three overlapping",
            vec![cube(1), aside(1), part([-0.5; 3], [0.25, 3.0, 0.5], 1)],
            vec![],
        ),
        ("side by side", vec![cube(1), part([1.0, -1.0, -1.0], [2.0, 1.0, 1.0], 1)], vec![]),
        ("in part side by side", vec![cube(1), part([1.0, -0.5, 0.0], [2.0, 3.0, 2.0], 1)], vec![]),
        ("side by side at an edge", vec![cube(1), part([1.0; 3], [2.0; 3], 1)], vec![]),
        ("cavity", vec![cube(1), inner(-1)], vec![]),
        ("cavity that faces outwards", vec![cube(1), inner(1)], vec![]),
        ("inside out with a cavity", vec![cube(-1), inner(1)], vec![]),
        ("cavity with a flipped facet", vec![cube(1), inner(-1)], vec![14]),
        (
            "cavity that touches the side",
            vec![cube(1), part([-1.0, -0.2, -0.2], [0.0, 0.2, 0.2], -1)],
            vec![],
        ),
        ("apart", vec![cube(1), part([3.0; 3], [4.0; 3], 1)], vec![]),
    ];
    let solid = |(name, parts, flipped)| Solid { name, parts, flipped };
    table.into_iter().map(solid).collect()
}

/// The solid as it is, and what places its points in the world.
struct Placed {
    scene: Scene,
    world_from_solid: DAffine3,
    scale: f64,
}

impl Solid {
    fn mesh(&self, place: DAffine3) -> std::sync::Arc<Mesh> {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for part in &self.parts {
            let first = points.len() as u32;
            points.extend((0..8).map(|k| {
                let upper = |bit: usize| k >> bit & 1 == 1;
                let pick = |axis: usize| [part.low, part.high][usize::from(upper(axis))][axis];
                place.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
            }));
            triangles.extend(CUBE.map(|[a, b, c]| {
                let [a, b, c] = [a, b, c].map(|k| k + first);
                if part.turns > 0 { [a, b, c] } else { [a, c, b] }
            }));
        }
        for &k in &self.flipped {
            triangles[k].swap(0, 1);
        }
        mesh(&points, triangles)
    }

    /// As it stands; its vertices turned, moved and rounded; and its object turned, mirrored and
    /// scaled.
    fn placed(&self) -> [Placed; 3] {
        let turn = DQuat::from_rotation_x(0.4)
            * DQuat::from_rotation_y(1.1)
            * DQuat::from_rotation_z(-0.7);
        let moved = DAffine3::from_rotation_translation(turn, DVec3::new(3.0, -7.0, 0.5));
        let mirrored = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(-2.0, 2.0, 2.0)));
        let mirrored = moved * mirrored;
        let own = |mesh| Object::new(mesh);
        let by = |object: Object, transform| object.placed(Transform::new(transform).unwrap());
        [
            (own(self.mesh(DAffine3::IDENTITY)), DAffine3::IDENTITY, 1.0),
            (own(self.mesh(moved)), moved, 1.0),
            (by(own(self.mesh(DAffine3::IDENTITY)), mirrored), mirrored, 2.0),
        ]
        .map(|(object, world_from_solid, scale)| Placed {
            scene: scene(vec![object]),
            world_from_solid,
            scale,
        })
    }

    fn is_inside(&self, rule: FillRule, p: DVec3) -> bool {
        let turns = self.parts.iter().filter(|part| part.holds(p));
        let turns: i32 = turns.map(|part| part.turns).sum();
        match rule {
            FillRule::Nonzero => turns != 0,
            FillRule::Parity => turns % 2 != 0,
        }
    }

    /// The stretches of an endless line that are inside, in order, those that touch in one.
    fn stretches(&self, rule: FillRule, origin: DVec3, way: DVec3) -> Vec<[f64; 2]> {
        let stretches = self.parts.iter().filter_map(|part| part.stretch(origin, way));
        let mut ends: Vec<f64> = stretches.flatten().collect();
        ends.sort_by(f64::total_cmp);
        let mut inside: Vec<[f64; 2]> = Vec::new();
        for two in ends.windows(2).filter(|two| two[1] - two[0] > 1e-9) {
            if self.is_inside(rule, origin + 0.5 * (two[0] + two[1]) * way) {
                match inside.last_mut() {
                    Some(last) if two[0] - last[1] < 1e-9 => last[1] = two[1],
                    _ => inside.push([two[0], two[1]]),
                }
            }
        }
        inside
    }

    fn box_around(&self) -> [DVec3; 2] {
        let low = self.parts.iter().map(|part| part.low).reduce(DVec3::min);
        let high = self.parts.iter().map(|part| part.high).reduce(DVec3::max);
        [low.unwrap(), high.unwrap()]
    }

    /// The area across an axis: of all cells between the boxes' sides.
    fn area_across(&self, rule: FillRule, axis: usize, place: f64) -> f64 {
        let (k, l) = ((axis + 1) % 3, (axis + 2) % 3);
        let sides = |axis: usize| {
            let sides = self.parts.iter().flat_map(|part| [part.low[axis], part.high[axis]]);
            let mut sides: Vec<f64> = sides.collect();
            sides.sort_by(f64::total_cmp);
            sides
        };
        let (across, along) = (sides(k), sides(l));
        let mut area = 0.0;
        for x in across.windows(2) {
            for y in along.windows(2) {
                let mut p = DVec3::ZERO;
                (p[axis], p[k], p[l]) = (place, 0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]));
                if self.is_inside(rule, p) {
                    area += (x[1] - x[0]) * (y[1] - y[0]);
                }
            }
        }
        area
    }
}

/// How much of a line in the plane is inside its outlines: what is between each second crossing.
fn length_in(section: &Section, origin: DVec3, way: DVec3) -> f64 {
    let plane = section.plane();
    let place = |p: DVec3| plane.coordinates(p);
    let (start, way_2d) = (place(origin), place(origin + way) - place(origin));
    let side = |p: DVec2| way_2d.perp_dot(p - start);
    let mut crossings = Vec::new();
    for polyline in section.polylines() {
        let points: Vec<DVec2> = polyline.points.iter().map(|&p| place(p)).collect();
        for k in 0..points.len() {
            let [p, q] = [points[k], points[(k + 1) % points.len()]];
            let [a, b] = [side(p), side(q)];
            if (a < 0.0) != (b < 0.0) {
                crossings.push(way_2d.dot(p.lerp(q, a / (a - b)) - start));
            }
        }
    }
    crossings.sort_by(f64::total_cmp);
    crossings.chunks(2).map(|two| two[1] - two[0]).sum()
}

fn near(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() < 1e-9
}

#[test]
fn all_measures_have_the_same_inside_by_either_rule() {
    let mut numbers = Numbers::new(46);
    for solid in solids() {
        let [low, high] = solid.box_around();
        let points: Vec<DVec3> = (0..60)
            .map(|_| {
                let [x, y, z] = [numbers.unit(), numbers.unit(), numbers.unit()];
                low - 0.25 + (high - low + 0.5) * DVec3::new(x, y, z)
            })
            .collect();
        for (variant, placed) in solid.placed().iter().enumerate() {
            let Placed { scene, world_from_solid: place, scale } = placed;
            let in_world: Vec<DVec3> = points.iter().map(|&p| place.transform_point3(p)).collect();
            for rule in RULES {
                let name = format!("{} {variant} {}", solid.name, rule.name());
                let expected: Vec<bool> =
                    points.iter().map(|&p| solid.is_inside(rule, p)).collect();
                let found = inside_with(rule, scene, &in_world, Grouping::Union, &()).unwrap();
                assert_eq!(found.is_inside, expected, "{name}");
                let arrays: Vec<_> = in_world.iter().map(DVec3::to_array).collect();
                let settings = SignSettings { rule, ..SignSettings::default() };
                let signed = signed_distances_with(settings, scene, &arrays, &()).unwrap();
                for ((&distance, &is_inside), &p) in signed.iter().zip(&expected).zip(&in_world) {
                    assert_eq!(distance < 0.0, is_inside, "{name} {p}");
                    let nearest = closest_point(scene, p).unwrap().unwrap();
                    assert_eq!(distance.abs(), nearest.distance, "{name} {p}");
                }
                judge_lengths(&solid, placed, rule, &points, &name);
                judge_thickness(&solid, placed, rule, &points, &name);
                for axis in 0..3 {
                    for k in 0..4 {
                        let at = low + (high - low) * (0.0371 + 0.3 * f64::from(k));
                        let normal = place.transform_vector3(DVec3::AXES[axis]);
                        let plane = SectionPlane::new(place.transform_point3(at), normal).unwrap();
                        let cut = section_with(rule, scene, plane, &()).unwrap();
                        assert_eq!(cut.warnings().is_empty(), !cut.is_empty());
                        assert!(cut.polylines().all(|one| one.is_closed));
                        let area = solid.area_across(rule, axis, at[axis]) * scale * scale;
                        assert!(near(cut.area(), area), "{name} {axis} {k}: {} {area}", cut.area());
                    }
                }
            }
        }
    }
}

/// Along rays: what they meet, and the lines in which sections have them.
fn judge_lengths(solid: &Solid, placed: &Placed, rule: FillRule, points: &[DVec3], name: &str) {
    let Placed { scene, world_from_solid: place, scale } = placed;
    for two in points.chunks_exact(2).take(12) {
        let (origin, way) = (two[0], (two[1] - two[0]).normalize());
        let stretches = solid.stretches(rule, origin, way);
        let expected: f64 = stretches.iter().map(|[a, b]| b.max(0.0) - a.max(0.0)).sum();
        let [start, along] = [place.transform_point3(origin), place.transform_vector3(way)];
        let ray = [Ray::new(start, along)];
        for by in [Grouping::Union, Grouping::Object] {
            let length = path_lengths_with(rule, scene, &ray, by, &()).unwrap()[0];
            assert!(near(length, scale * expected), "{name}: {length} {expected}");
        }
        let whole: f64 = stretches.iter().map(|[a, b]| b - a).sum();
        let plane = SectionPlane::new(start, along.cross(DVec3::new(0.3, 0.7, -0.2))).unwrap();
        let cut = section_with(rule, scene, plane, &()).unwrap();
        let length = length_in(&cut, start, along.normalize());
        assert!(near(length, scale * whole), "{name}: {length} {whole}");
        assert!(cut.area() >= 0.0 && cut.polylines().all(|one| one.is_closed), "{name}");
    }
}

/// From points of the surface inwards: at places that are on one part's surface alone.
fn judge_thickness(solid: &Solid, placed: &Placed, rule: FillRule, points: &[DVec3], name: &str) {
    let Placed { scene, world_from_solid: place, scale } = placed;
    for (k, &p) in points.iter().enumerate() {
        let part = solid.parts[k % solid.parts.len()];
        let axis = k % 3;
        let mut on = p.clamp(part.low + 0.013, part.high - 0.017);
        on[axis] = [part.low, part.high][k / 3 % 2][axis];
        let normal = DVec3::AXES[axis];
        let [below, above] = [-1e-7, 1e-7].map(|off| solid.is_inside(rule, on + off * normal));
        // Both sides are inside: either way is as good.
        let ways = match (below, above) {
            (true, false) => vec![-normal],
            (false, true) => vec![normal],
            (true, true) => vec![normal, -normal],
            (false, false) => vec![],
        };
        let ends = ways.iter().map(|&way| {
            let stretches = solid.stretches(rule, on + 1e-7 * way, way);
            stretches.iter().find(|[a, b]| *a < 0.0 && *b > 0.0).map_or(0.0, |[_, b]| b + 1e-7)
        });
        let mut ends: Vec<f64> = ends.collect();
        if ends.is_empty() {
            ends.push(0.0);
        }
        // Where vertices are rounded, parts that touch have gaps or overlaps of a rounding.
        if *scale == 1.0 && *place != DAffine3::IDENTITY {
            let stretches = |part: &Part| part.stretch(on + 1e-7 * ways.first()?, *ways.first()?);
            ends.extend(solid.parts.iter().filter_map(stretches).map(|[_, b]| b + 1e-7));
            ends.push(0.0);
        }
        let asked = place.transform_point3(on).to_array();
        let found = thickness_with(rule, scene, &[asked], &()).unwrap()[0];
        let is_it = |end: &f64| near(found, scale * end);
        assert!(ends.iter().any(is_it), "{name} {on}: {found} {ends:?}");
    }
}

/// A box around the origin, of which each face is there twice.
fn twice() -> Scene {
    let solid = solids().into_iter().find(|solid| solid.name == "twice").unwrap();
    scene(vec![Object::new(solid.mesh(DAffine3::from_scale(DVec3::splat(0.5))))])
}

#[test]
fn a_box_that_is_there_twice_holds_its_middle_and_has_its_own_size() {
    let scene = twice();
    let middle = [[0.1, 0.0, 0.0]];
    assert_eq!(signed_distances(&scene, &middle, &()).unwrap(), [-0.4]);
    let cut = scene.section(DVec3::ZERO, DVec3::Z).unwrap();
    assert_eq!((cut.area(), cut.len(), cut.perimeter()), (1.0, 1, 4.0));
    let ray = [Ray::new(DVec3::new(0.1, 0.2, 5.0), DVec3::NEG_Z)];
    let rule = FillRule::default();
    assert_eq!(path_lengths_with(rule, &scene, &ray, Grouping::Union, &()).unwrap(), [1.0]);
    assert_eq!(thickness_with(rule, &scene, &[[0.1, 0.2, 0.5]], &()).unwrap(), [1.0]);
}

/// Inwards from there a ray runs along faces and edges.
#[test]
fn a_cube_is_as_thick_at_its_corners_and_edges_as_in_its_faces() {
    let corner = |k: u32| DVec3::new((k & 1).into(), (k >> 1 & 1).into(), (k >> 2).into());
    let corners: Vec<DVec3> = (0..8).map(|k| 10.0 * corner(k)).collect();
    let mut points: Vec<[f64; 3]> = corners.iter().map(DVec3::to_array).collect();
    for a in &corners {
        // Of edges, and of the diagonals of faces.
        let others = corners.iter().filter(|&b| b.distance(*a) < 15.0);
        points.extend(others.map(|b| a.lerp(*b, 0.375).to_array()));
    }
    for faces in [
        CUBE.to_vec(),
        CUBE.map(|[a, b, c]| [a, c, b]).to_vec(),
        CUBE.map(|[a, b, c]| [c, a, b]).to_vec(),
    ] {
        let cube = scene(vec![Object::new(mesh(&corners, faces))]);
        for rule in RULES {
            let found = thickness_with(rule, &cube, &points, &()).unwrap();
            assert!(found.iter().all(|&t| near(t, 10.0)), "{rule:?} {found:?}");
        }
    }
}

#[test]
fn a_thickness_along_a_way_outwards_is_the_gap_to_the_same_object() {
    let solid = solids().into_iter().find(|solid| solid.name == "apart").unwrap();
    let scene = scene(vec![Object::new(solid.mesh(DAffine3::IDENTITY))]);
    let way = DVec3::ONE.normalize();
    let from = Ray::new(DVec3::new(0.5, 0.4, 9.0), DVec3::NEG_Z);
    let hit = shoot(&scene, from.origin, from.direction);
    let surface = scene.interaction(&from, &hit).unwrap();
    let (ray, filter) = surface.leave(way);
    let filter = RayFilter { only: Some(hit.object), ..filter };
    let rays = [ray];
    let along = |towards| {
        let rays = Filtered::new(&rays, filter);
        thickness_along(FillRule::Nonzero, &scene, &rays, towards, &()).unwrap()[0]
    };
    // From (0.5, 0.4, 1) to the plane x = 3, as y is 2.9 there: not met; y = 3 is, where x is 3.1.
    assert!(near(along(Towards::Given), 2.6 * 3.0_f64.sqrt()), "{}", along(Towards::Given));
    let back = along(Towards::Inside);
    assert!(near(back, 1.4 * 3.0_f64.sqrt()), "{back}");
}

#[test]
fn a_surface_with_one_side_goes_by_parity() {
    // Two boxes, and a projective plane with six vertices far away.
    let solid = solids().into_iter().find(|solid| solid.name == "overlapping").unwrap();
    let boxes = solid.mesh(DAffine3::IDENTITY);
    let mut points: Vec<DVec3> = (0..16).map(|k| boxes.positions().get(k)).collect();
    let mut triangles = boxes.triangles().to_vec();
    points.extend([
        DVec3::new(9.0, 0.0, 0.0),
        DVec3::new(10.0, 0.0, 0.0),
        DVec3::new(9.0, 1.0, 0.0),
        DVec3::new(9.0, 0.0, 1.0),
        DVec3::new(10.0, 1.0, 0.5),
        DVec3::new(9.2, 0.7, 1.1),
    ]);
    let plane = [
        [0, 1, 2],
        [0, 2, 3],
        [0, 3, 4],
        [0, 4, 5],
        [0, 5, 1],
        [1, 2, 4],
        [2, 3, 5],
        [3, 4, 1],
        [4, 5, 2],
        [5, 1, 3],
    ];
    triangles.extend(plane.map(|corners: [u32; 3]| corners.map(|k| k + 16)));
    let scene = scene(vec![Object::new(mesh(&points, triangles))]);
    assert_eq!(rules_with(FillRule::Nonzero, &scene).unwrap(), [Rule::Parity]);
    let overlap = DVec3::new(0.5, 0.1, 0.2);
    let plane = SectionPlane::new(overlap, DVec3::Z).unwrap();
    for rule in RULES {
        let found = inside_with(rule, &scene, &[overlap], Grouping::Union, &()).unwrap();
        assert_eq!(found.is_inside, [false]);
        let cut = section_with(rule, &scene, plane, &()).unwrap();
        assert!(length_in(&cut, overlap - DVec3::X * 9.0, DVec3::X) < 4.0);
        let ray = Ray::new(overlap - DVec3::X * 9.0, DVec3::X);
        let length = path_lengths_with(rule, &scene, &[ray], Grouping::Union, &()).unwrap()[0];
        assert!(near(length, length_in(&cut, ray.origin, ray.direction)), "{length}");
    }
}

#[test]
fn an_open_box_has_a_sign_on_request() {
    let solid = &solids()[0];
    let boxes = solid.mesh(DAffine3::IDENTITY);
    let points: Vec<DVec3> = (0..8).map(|k| boxes.positions().get(k)).collect();
    let scene = scene(vec![Object::new(mesh(&points, boxes.triangles()[..10].to_vec()))]);
    let asked = [[5.0, 5.0, 0.25], [5.0, 5.0, -0.5]];
    assert!(signed_distances(&scene, &asked, &()).is_err());
    let settings = SignSettings { allow_open: true, ..SignSettings::default() };
    assert_eq!(signed_distances_with(settings, &scene, &asked, &()).unwrap(), [-0.25, 0.5]);
}

/// Boxes in random places, whose sides are often in one plane: the section's outlines are closed,
/// simple, and as large as what is counted.
#[test]
fn sections_of_many_overlapping_boxes_are_what_is_counted() {
    let mut numbers = Numbers::new(5);
    for round in 0..crate::support::cases(40) {
        let mut number = || (numbers.unit() * 9.0).floor() / [1.0, 3.0][round % 2];
        let parts = (0..12).map(|k| {
            let low = DVec3::new(number(), number(), number());
            let size = DVec3::new(number(), number(), number()) + 0.5;
            Part { low, high: low + size, turns: if k % 5 == 4 { -1 } else { 1 } }
        });
        let solid = Solid { name: "many", parts: parts.collect(), flipped: vec![] };
        for Placed { scene, world_from_solid: place, scale } in solid.placed() {
            for rule in RULES {
                for axis in 0..3 {
                    let at = DVec3::splat(3.137);
                    let normal = place.transform_vector3(DVec3::AXES[axis]);
                    let plane = SectionPlane::new(place.transform_point3(at), normal).unwrap();
                    let cut = section_with(rule, &scene, plane, &()).unwrap();
                    assert_eq!(cut.warnings().is_empty(), !cut.is_empty());
                    let area = solid.area_across(rule, axis, at[axis]) * scale * scale;
                    assert!((cut.area() - area).abs() < 1e-7, "{} {area}", cut.area());
                }
            }
        }
    }
}
