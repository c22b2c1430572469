//! Colours by numbers: the colours of the map at the values, lit by any shader, with a legend.

use std::f64::consts::PI;
use std::sync::Arc;

use firsthit::channel::kind;
use firsthit::geometry::ColorMap;
use firsthit::image::{Frame, Metadata};
use firsthit::render::{Picture, Region};
use firsthit::scene::{ColorBy, Coloring};
use firsthit::shade::Lambert;
use firsthit::shape::{Property, PropertyOf, PropertyValues};
use firsthit::{
    Camera, Color, Cuboid, DVec3, Mesh, Object, Positions, Scene, Shade, Shader, Sphere, Transform,
    shoot,
};

use crate::support::on_threads;

/// Two triangles on the ground, over the square from 0 to 2.
fn square(properties: Vec<Property>) -> Object {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    let corners = corners.map(|[x, y]| [x, y, 0.0]).to_vec();
    let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let mesh = mesh.with_properties(properties).unwrap();
    Object::new(Arc::new(mesh)).colored(Color::new(0.5, 0.25, 0.125))
}

fn property(name: &str, of: PropertyOf, numbers: &[f64]) -> Property {
    Property::new(name, of, PropertyValues::Double(numbers.to_vec().into()))
}

fn attribute(name: &str) -> Coloring {
    Coloring::new(ColorBy::Attribute(name.into()))
}

fn colored(objects: Vec<Object>, coloring: Coloring) -> Scene {
    let scene = Scene::new(objects).unwrap();
    scene.with_coloring(Some(coloring)).unwrap()
}

/// The colour straight below x and y.
fn seen(scene: &Scene, shader: &str, x: f64, y: f64) -> Color {
    let (p, u_r) = (DVec3::new(x, y, 8.0), DVec3::NEG_Z);
    let hit = shoot(scene, p, u_r);
    let shade = Shader::named(shader).unwrap();
    shade.on(scene).shade(hit.t, p, u_r, &hit)
}

const VIRIDIS: ColorMap = ColorMap::Viridis;

#[test]
fn numbers_of_vertices_corners_and_faces_get_the_colours_of_the_map() {
    let square = square(vec![
        property("heat", PropertyOf::Vertices, &[0.0, 8.0, 16.0, 4.0]),
        property("wear", PropertyOf::Corners, &[1.0, 2.0, 3.0, 4.0, 5.0, 9.0]),
        property("part", PropertyOf::Faces, &[3.0, 7.0]),
    ]);
    let unlit = |name: &str, x, y| {
        let scene = colored(vec![square.clone()], attribute(name));
        seen(&scene, "unlit", x, y)
    };
    // In the first triangle heat is 4 x + 4 y, which goes up to 16.
    assert_eq!(unlit("heat", 1.5, 0.5), VIRIDIS.color(0.5));
    assert_eq!(unlit("heat", 0.75, 0.25), VIRIDIS.color(0.25));
    // At the middle of the second's longest side and its third corner: half of 4, a quarter of 5
    // and of 9.
    assert_eq!(unlit("wear", 0.5, 1.0), VIRIDIS.color((5.5 - 1.0) / 8.0));
    assert_eq!(unlit("part", 1.5, 0.5), VIRIDIS.color(0.0));
    assert_eq!(unlit("part", 0.5, 1.5), VIRIDIS.color(1.0));
}

#[test]
fn of_several_numbers_the_length_of_their_vector_counts() {
    let flow =
        Property { components: 2, ..property("flow", PropertyOf::Faces, &[3.0, 4.0, 0.0, 1.0]) };
    let coloring = Coloring { range: Some([0.0, 10.0]), ..attribute("flow") };
    let scene = colored(vec![square(vec![flow])], coloring);
    assert_eq!(seen(&scene, "unlit", 1.5, 0.5), VIRIDIS.color(0.5));
    assert_eq!(seen(&scene, "unlit", 0.5, 1.5), VIRIDIS.color(0.1));
}

#[test]
fn shaders_light_the_colours_of_numbers_as_they_light_others() {
    let heat = property("heat", PropertyOf::Faces, &[0.0, 1.0]);
    let scene = colored(vec![square(vec![heat])], attribute("heat"));
    let ambient = Lambert::default().ambient;
    assert_eq!(seen(&scene, "lambert", 0.5, 1.5), VIRIDIS.color(1.0) * ambient);
    let plain = scene.clone().with_coloring(None).unwrap();
    for shader in ["phong", "blinn-phong", "hemisphere", "matcap", "ghost"] {
        let [numbered, own] = [&scene, &plain].map(|scene| seen(scene, shader, 0.5, 1.5));
        assert_ne!(numbered, own, "{shader}");
    }
    assert_eq!(scene.fingerprint(), plain.fingerprint());
}

/// An object without the attribute and a NaN.
#[test]
fn where_there_is_no_number_a_surface_has_its_own_colour_or_one_that_is_given() {
    let heat = property("heat", PropertyOf::Faces, &[f64::NAN, 2.0]);
    let ball = Sphere::new(DVec3::new(9.0, 9.0, 0.0), 1.0).unwrap();
    let ball = Object::new(ball).colored(Color::X);
    let objects = vec![square(vec![heat]), ball];
    let own = colored(objects.clone(), attribute("heat"));
    assert_eq!(seen(&own, "unlit", 1.5, 0.5), Color::new(0.5, 0.25, 0.125));
    assert_eq!(seen(&own, "unlit", 9.0, 9.0), Color::X);
    let grey = Coloring { missing: Some(Color::splat(0.5)), ..attribute("heat") };
    let grey = colored(objects, grey);
    assert_eq!(seen(&grey, "unlit", 1.5, 0.5), Color::splat(0.5));
    assert_eq!(seen(&grey, "unlit", 9.0, 9.0), Color::splat(0.5));
    // Of one number the map shows the first colour.
    assert_eq!(seen(&grey, "unlit", 0.5, 1.5), VIRIDIS.color(0.0));
}

#[test]
fn numbers_outside_of_a_range_are_clamped_or_have_colours_of_their_own() {
    let heat = property("heat", PropertyOf::Faces, &[-5.0, 50.0]);
    let given = Coloring { range: Some([0.0, 10.0]), map: ColorMap::CoolWarm, ..attribute("heat") };
    let clamped = colored(vec![square(vec![heat.clone()])], given.clone());
    assert_eq!(seen(&clamped, "unlit", 1.5, 0.5), ColorMap::CoolWarm.color(0.0));
    assert_eq!(seen(&clamped, "unlit", 0.5, 1.5), ColorMap::CoolWarm.color(1.0));
    let marked = Coloring { below: Some(Color::Y), above: Some(Color::Z), ..given };
    let marked = colored(vec![square(vec![heat])], marked);
    assert_eq!(seen(&marked, "unlit", 1.5, 0.5), Color::Y);
    assert_eq!(seen(&marked, "unlit", 0.5, 1.5), Color::Z);
}

/// Three boxes in a row, the first two instances of one mesh.
fn row() -> Vec<Object> {
    let moved = |x: f64| Transform::translation(DVec3::new(x, 0.0, 0.0)).unwrap();
    let square = square(vec![]);
    let cuboid = Cuboid::new(DVec3::new(6.0, 0.0, -1.0), DVec3::new(8.0, 2.0, 3.0)).unwrap();
    vec![square.clone(), square.placed(moved(3.0)), Object::new(cuboid)]
}

#[test]
fn objects_faces_heights_and_angles_are_numbers_too() {
    let at = |by: ColorBy, x| seen(&colored(row(), Coloring::new(by)), "unlit", x, 0.5);
    assert_eq!(at(ColorBy::Object, 4.5), VIRIDIS.color(0.5));
    let values = ColorBy::Values([4.0, 5.0, 6.0].into());
    assert_eq!(at(values, 7.0), VIRIDIS.color(1.0));
    // The top of a box is its face 5, and the first triangle the face 0.
    assert_eq!(at(ColorBy::Face, 7.0), VIRIDIS.color(1.0));
    assert_eq!(at(ColorBy::Face, 1.0), VIRIDIS.color(0.0));
    // From -1 to 3.
    assert_eq!(at(ColorBy::Height, 1.0), VIRIDIS.color(0.25));
    let scene = colored(row(), Coloring::new(ColorBy::Incidence));
    assert_eq!(scene.colored().unwrap().range(), [0.0, PI / 2.0]);
    assert_eq!(seen(&scene, "unlit", 1.0, 0.5), VIRIDIS.color(0.0));
}

#[test]
fn hidden_objects_have_no_numbers() {
    let mut objects = row();
    objects[0] = objects[0].clone().hidden(true);
    objects[2] = objects[2].clone().hidden(true);
    let range = |by: ColorBy| {
        let scene = colored(objects.clone(), Coloring::new(by));
        scene.colored().unwrap().range()
    };
    assert_eq!(range(ColorBy::Object), [1.0, 1.0]);
    assert_eq!(range(ColorBy::Values([4.0, 5.0, 6.0].into())), [5.0, 5.0]);
    // The box has faces up to 5, the square two triangles.
    assert_eq!(range(ColorBy::Face), [0.0, 1.0]);
    objects[1] = objects[1].clone().hidden(true);
    let scene = Scene::new(objects).unwrap();
    let refused = |by: ColorBy| {
        let scene = scene.clone();
        scene.with_coloring(Some(Coloring::new(by))).is_err()
    };
    assert!(refused(ColorBy::Face) && refused(ColorBy::Values([4.0, 5.0, 6.0].into())));
    assert!(!refused(ColorBy::Object));
}

#[test]
fn what_makes_no_sense_is_refused_and_names_what_there_is() {
    let refused = |coloring: Coloring| {
        let heat = property("heat", PropertyOf::Faces, &[f64::NAN, f64::INFINITY]);
        let scene = Scene::new(vec![square(vec![heat])]).unwrap();
        scene.with_coloring(Some(coloring)).unwrap_err().to_string()
    };
    assert!(refused(attribute("heath")).contains("there are heat"));
    assert!(refused(attribute("heat")).contains("attribute:heat"));
    let values = Coloring::new(ColorBy::Values([1.0, 2.0].into()));
    assert!(refused(values).contains("2 for 1 objects"));
    for range in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        let coloring = Coloring { range: Some(range), ..Coloring::new(ColorBy::Object) };
        assert!(refused(coloring).contains("two numbers that rise"), "{range:?}");
    }
    for by in ColorBy::NAMES {
        assert_eq!(by.parse::<ColorBy>().unwrap().text(), by);
    }
    assert!("heat".parse::<ColorBy>().is_err() && "attribute:".parse::<ColorBy>().is_err());
}

#[test]
fn a_scene_of_other_objects_is_coloured_by_their_numbers() {
    let heat = |last: f64| square(vec![property("heat", PropertyOf::Faces, &[0.0, last])]);
    let scene = colored(vec![heat(1.0)], attribute("heat"));
    let other = scene.with_objects(vec![heat(4.0)]).unwrap();
    assert_eq!(other.colored().unwrap().range(), [0.0, 4.0]);
}

fn bits(frame: &Frame) -> Vec<u64> {
    let data = &frame.channel("color").unwrap().data;
    (0..data.len()).map(|k| data.value(k).to_bits()).collect()
}

/// The part sees only the first object, but has the colours that it has in the whole.
#[test]
fn a_picture_has_its_legend_and_the_same_bytes_for_any_threads_and_parts() {
    let coloring = Coloring { above: Some(Color::X), ..Coloring::new(ColorBy::Object) };
    let scene = colored(row(), coloring);
    let (eye, goal) = (DVec3::new(4.0, -9.0, 6.0), DVec3::new(4.0, 1.0, 0.0));
    let camera = Camera::look_at(eye, goal, DVec3::Z, 60.0, 90, 160).unwrap();
    let shade = Shader::default().on(&scene);
    let kinds = ["color", "t"].map(|name| kind(name).unwrap());
    let picture = Picture { samples: 2, ..Picture::new(&scene, &camera, &shade, &kinds) };
    let with = |threads: usize| on_threads(threads, || picture.render(&())).unwrap();
    let mut whole = with(1);
    for threads in [2, 7] {
        assert!(bits(&whole) == bits(&with(threads)), "{threads}");
    }
    for (rows, columns) in [(30..60, 0..50), (20..80, 100..160)] {
        let part = Picture {
            region: Some(Region { rows: rows.clone(), columns: columns.clone() }),
            ..picture.clone()
        };
        let (part, all) = (bits(&part.render(&()).unwrap()), bits(&whole));
        for (k, row) in rows.enumerate() {
            let width = 3 * columns.len();
            let first = 3 * (row * 160 + columns.start);
            assert!(part[k * width..][..width] == all[first..][..width], "{row}");
        }
    }
    let metadata = Metadata::from_json(&whole.metadata().to_json()).unwrap();
    let legend = metadata.colors.unwrap();
    assert_eq!((&*legend.by, &*legend.map), ("object", "viridis"));
    assert_eq!((legend.range, legend.above), ([0.0, 2.0], Some([1.0, 0.0, 0.0])));
    // It goes with colours.
    let distances = whole.select(&["t"], |_| false).unwrap();
    assert_eq!(distances.metadata().colors, None);
}
