//! Default cameras: the whole model is in the picture and fills it.

use std::collections::HashSet;
use std::sync::Arc;

use firsthit::camera::{Aim, Description, FovAxis, StandardView};
use firsthit::{
    Bounds, Camera, Cone, Cuboid, Cylinder, DAffine3, DQuat, DVec2, DVec3, Disc, Lens, Mesh,
    Object, Plane, Positions, Projection, Scene, Shape, Sphere, Transform, View, Viewplane,
    example, render, shoot,
};

use crate::support::seen;

/// A plate, a needle, and triangles here and there: all far from round.
fn meshes() -> [Arc<Mesh>; 3] {
    let mesh = |points: Vec<[f64; 3]>| {
        let count = u32::try_from(points.len()).unwrap();
        let triangles = (0..count / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        Arc::new(Mesh::new(Positions::compact(points), triangles.collect()).unwrap())
    };
    let at = |k: i32, scale: [f64; 3]| {
        let wave = |step: f64| libm::sin(f64::from(k) * step);
        [1.3 * scale[0] * wave(1.7), scale[1] * wave(2.9), scale[2] * wave(4.3)]
    };
    let scattered = |scale| mesh((0..600).map(|k| at(k, scale)).collect());
    [scattered([1.0, 3.0, 0.02]), scattered([0.05, 0.05, 7.0]), scattered([1.0, 1.0, 1.0])]
}

/// Every shape, as it is, and turned, squeezed and far away.
fn objects() -> Vec<Object> {
    let mut shapes: Vec<Shape> = vec![
        Sphere::new(DVec3::new(4.0, 1.0, -2.0), 0.7).unwrap().into(),
        Disc::new(DVec3::ZERO, DVec3::new(0.0, 1.0, 0.0), 2.0).unwrap().into(),
        Disc::new(DVec3::ONE, DVec3::new(0.3, -1.0, 0.6), 2.0).unwrap().into(),
        Cuboid::new(DVec3::ZERO, DVec3::new(1.0, 5.0, 0.5)).unwrap().into(),
        Cylinder::new(DVec3::NEG_Y, 3.0 * DVec3::Z, 0.4).unwrap().into(),
        Cone::new(DVec3::ZERO, DVec3::new(0.0, 0.5, 2.0), 1.0, 0.0).unwrap().into(),
        Plane::new(DVec3::ZERO, DVec3::Z).unwrap().into(),
    ];
    shapes.extend(meshes().map(Shape::from));
    let named: HashSet<_> = shapes.iter().map(Shape::name).collect();
    assert_eq!(named, Shape::NAMES.iter().copied().collect(), "a shape is not tried");
    let turned = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.2, 1.0, 2.0),
        DQuat::from_rotation_x(0.6) * DQuat::from_rotation_z(1.1),
        DVec3::new(1e6, -2e6, 5.0),
    );
    let turned = Transform::new(turned).unwrap();
    let objects = shapes.into_iter().map(Object::new);
    objects.flat_map(|object| [object.clone(), object.placed(turned)]).collect()
}

/// Points of the scene's surface, infinite planes left out: met by rays from all around, and the
/// corners of meshes, which they seldom meet.
fn points(scene: &Scene) -> Vec<DVec3> {
    let bounds = scene.bounds();
    let radius = bounds.size().length();
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let met = (0..4000).filter_map(|k| {
        let height = 1.0 - (2.0 * f64::from(k) + 1.0) / 4000.0;
        let (sin, cos) = libm::sincos(golden * f64::from(k));
        let ring = (1.0 - height * height).sqrt();
        let origin = bounds.centre() + radius * DVec3::new(ring * cos, ring * sin, height);
        let wave = |step: f64| 0.5 * libm::sin(f64::from(k) * step);
        let target = bounds.centre() + bounds.size() * DVec3::new(wave(0.7), wave(1.3), wave(2.1));
        let hit = shoot(scene, origin, target - origin);
        let is_finite = scene.object(&hit)?.bounds().is_finite();
        is_finite.then(|| origin + hit.t * (target - origin))
    });
    met.chain(scene.objects().iter().flat_map(corners)).collect()
}

fn corners(object: &Object) -> Vec<DVec3> {
    let world_from_object = object.transform().world_from_object();
    let Some(mesh) = object.mesh() else {
        return vec![];
    };
    let corners = (0..mesh.triangles().len()).flat_map(|triangle| mesh.corners(triangle));
    corners.map(|corner| world_from_object.transform_point3(corner)).collect()
}

#[test]
fn the_model_fills_sixty_percent_of_the_picture_in_every_view() {
    let mut scenes: Vec<_> = objects().into_iter().map(|object| vec![object]).collect();
    scenes.push(objects());
    scenes.push(example::scene().unwrap().objects().to_vec());
    let mut pictures = 0;
    for objects in scenes {
        let scene = Scene::new(objects).unwrap();
        if scene.bounds().is_empty() {
            continue;
        }
        let points = points(&scene);
        for &standard in StandardView::ALL {
            for projection in [Projection::Perspective, Projection::Orthographic] {
                for up in [DVec3::Y, DVec3::Z] {
                    let description = Description {
                        aim: Some(Aim::View(standard)),
                        projection: Some(projection),
                        ..Description::default()
                    };
                    let support = |direction| scene.support(direction);
                    let camera = description.camera(scene.bounds(), support, up).unwrap();
                    let seen = points.iter().map(|&point| seen(&camera, point));
                    let (low, high) = seen
                        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), at| {
                            (low.min(at), high.max(at))
                        });
                    let shape = scene.objects()[0].shape().name();
                    let told = format!("{standard:?} {projection:?} {shape} {low} {high}");
                    assert!(low.min_element() > -1.0 && high.max_element() < 1.0, "{told}");
                    assert!((high - low).max_element() >= 2.0 * 0.6, "{told}");
                    pictures += 1;
                }
            }
        }
    }
    assert!(pictures > 500, "{pictures}");
}

#[test]
fn the_default_camera_is_the_description_of_a_view() {
    let scene = Scene::new(objects()).unwrap();
    let camera = render::framing_camera(&scene, DVec3::Z, StandardView::Iso, [768, 1024]).unwrap();
    let described = Description::default();
    let support = |direction| scene.support(direction);
    let other = described.camera(scene.bounds(), support, DVec3::Z).unwrap();
    assert_eq!(camera, other);
    assert!(camera.aim().z < -0.3, "from above: {}", camera.aim());
}

#[test]
fn a_scene_without_anything_finite_has_a_camera_too() {
    let plane = Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap());
    for objects in [vec![], vec![plane]] {
        let scene = Scene::new(objects).unwrap();
        assert_eq!(scene.support(DVec3::X), f64::NEG_INFINITY);
        let camera = render::framing_camera(&scene, DVec3::Y, StandardView::Top, [3, 4]).unwrap();
        assert!(camera.position().is_finite());
    }
}

#[test]
fn an_extent_is_that_of_the_bounds_along_the_axes_of_meshes() {
    let scene = Scene::new(meshes().map(Object::new).to_vec()).unwrap();
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        assert_eq!(scene.support(axis), scene.bounds().high.dot(axis));
        assert_eq!(scene.support(-axis), -scene.bounds().low.dot(axis));
    }
    let ball = Object::new(Sphere::new(DVec3::ZERO, 2.0).unwrap());
    let squeezed = Transform::new(DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.5))).unwrap();
    let scene = Scene::new(vec![ball.placed(squeezed)]).unwrap();
    // An ellipsoid: the box around it reaches farther.
    let diagonal = scene.support(DVec3::new(1.0, 0.0, 1.0));
    assert!((diagonal - 5.0_f64.sqrt()).abs() < 1e-15, "{diagonal}");
}

/// The support function of a box.
fn support_of(bounds: Bounds) -> impl Fn(DVec3) -> f64 {
    move |direction| {
        let along = bounds.corners().map(|corner| corner.dot(direction));
        along.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }
}

#[test]
fn framing_touches_the_margin_on_opposite_sides_and_centres_the_rest() {
    let bounds = Bounds::of([DVec3::new(-3.0, 10.0, 2.0), DVec3::new(5.0, 11.0, 8.0)]);
    let aims = [
        DVec3::new(0.3, -1.0, 0.4),
        DVec3::new(1.0, 0.2, -0.1),
        DVec3::Y,
        DVec3::new(-3.0, 0.01, 0.02),
    ];
    for parallel in [false, true] {
        for aim in aims {
            for (rows, columns) in [(480, 640), (100, 1000), (900, 300)] {
                let view = View {
                    aim,
                    up: DVec3::Z,
                    rows,
                    columns,
                    lens: Lens::Flat(Viewplane {
                        parallel,
                        ..Viewplane::with_fov(45.0, FovAxis::Vertical, rows, columns).unwrap()
                    }),
                    ..View::default()
                };
                let camera = Camera::framing(view, support_of(bounds)).unwrap();
                let corners = bounds.corners().map(|corner| seen(&camera, corner));
                let low = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
                let high = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
                let told = format!("{parallel} {aim} {columns} x {rows}: {low} {high}");
                assert!((high.max_element() - 1.0 / 1.05).abs() < 1e-9, "{told}");
                assert!((low.min_element() + 1.0 / 1.05).abs() < 1e-9, "{told}");
                // False position stops where nobody sees the rest.
                assert!((low + high).abs().max_element() < 0.01, "{told}");
            }
        }
    }
}

#[test]
fn a_point_and_a_line_along_the_aim_are_framed_too() {
    for parallel in [false, true] {
        for (low, high) in [(5.0, 5.0), (-4.0, 9.0)] {
            let view = View {
                lens: Lens::Flat(Viewplane { parallel, ..Viewplane::default() }),
                ..View::default()
            };
            let ends = [low, high].map(|z| DVec3::new(1.0, 2.0, z));
            let camera = Camera::framing(view, support_of(Bounds::of(ends))).unwrap();
            for end in ends {
                assert!(seen(&camera, end).abs().max_element() < 1.0, "{camera:?}");
            }
        }
    }
}

#[test]
fn what_reaches_nowhere_or_everywhere_is_not_framed() {
    for support in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let error = Camera::framing(View::default(), |_| support).unwrap_err();
        let message = error.to_string();
        assert!(message.starts_with("support must be finite, to be framed, got "), "{message}");
    }
}

#[test]
fn framing_does_not_depend_on_where_the_model_is() {
    let view = View { aim: DVec3::new(-1.0, -2.0, -3.0), ..View::default() };
    let distance = |far: f64| {
        let place = DVec3::splat(far);
        let bounds = Bounds { low: place - DVec3::ONE, high: place + DVec3::ONE };
        let camera = Camera::framing(view, support_of(bounds)).unwrap();
        (camera.position() - place).length()
    };
    for far in [1e5, 1e7, 1e9] {
        assert!((distance(far) - distance(0.0)).abs() < 1e-6, "{far}");
    }
}

/// The ground of a picture stands at this height, and its sign is in a digest.
#[test]
fn of_zeros_with_two_signs_the_support_is_the_positive_one() {
    for heights in [[0.0, -0.0, 0.0], [-0.0, 0.0, -0.0], [-0.0, -0.0, -0.0]] {
        let [a, b, c] = heights;
        let corners = vec![[0.0, 0.0, a], [1.0, 0.0, b], [0.0, 1.0, c]];
        let mesh = Mesh::new(Positions::Double(corners.into()), vec![[0, 1, 2]]).unwrap();
        let bounds = mesh.bounds();
        let scene = Scene::new(vec![Object::new(Arc::new(mesh))]).unwrap();
        for direction in [DVec3::Z, DVec3::NEG_Z] {
            assert!(scene.support(direction).is_sign_positive(), "{heights:?}");
        }
        assert!(bounds.low.z.is_sign_positive() && bounds.high.z.is_sign_positive());
    }
}
