//! The settings of a frame that a page may ask for beside its camera, by their names.

use std::io::Cursor;
use std::sync::Arc;

use firsthit::camera::StandardView;
use firsthit::render::framing_camera;
use firsthit::scene::{ColorBy, Coloring, Environment, EnvironmentKind, EnvironmentMap};
use firsthit::shade::Appearance;
use firsthit::{DMat3, DVec3, Mesh, Object, Positions, Scene, Sphere};
use firsthit_view::{
    Answer, AnswerError, Cut, EnvironmentChoice, EnvironmentRequest, FrameRequest, Pixels, Probe,
    SectionRequest, Viewer, Visibility,
};
use serde_json::{Value, json};

const SHAPE: [usize; 2] = [30, 60];

/// Two balls side by side, seen from the front.
fn viewer(environment: Option<Environment>) -> Viewer {
    let ball = |x: f64| Object::new(Sphere::new(DVec3::new(x, 0.0, 0.0), 1.0).unwrap());
    let scene = Scene::new(vec![ball(-1.2), ball(1.2)]).unwrap();
    let scene = scene.with_environment(environment.map(Arc::new));
    let camera = framing_camera(&scene, DVec3::Z, StandardView::Front, SHAPE).unwrap();
    Viewer::new("two balls", scene, Appearance::default(), &camera).unwrap()
}

fn request(viewer: &Viewer) -> FrameRequest {
    let camera = viewer.info()["camera"].take();
    FrameRequest {
        is_lit: true,
        samples: Some(1),
        ..FrameRequest::new(serde_json::from_value(camera).unwrap())
    }
}

/// Its colours, row by row.
fn colors(viewer: &Viewer, request: &FrameRequest) -> Vec<[u8; 3]> {
    let Pixels::Png(png) = viewer.frame(request, &()).unwrap().pixels else {
        panic!("colours are a PNG");
    };
    let mut reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let size = reader.next_frame(&mut bytes).unwrap().buffer_size();
    bytes.truncate(size);
    bytes.as_chunks::<3>().0.to_vec()
}

/// The colour in the middle of a ball.
fn middle(colors: &[[u8; 3]], ball: usize) -> [u8; 3] {
    let [rows, columns] = SHAPE;
    colors[rows / 2 * columns + [columns / 4, columns * 3 / 4][ball]]
}

#[test]
fn an_object_in_another_colour_changes_nothing_else() {
    let viewer = viewer(None);
    let plain = request(&viewer);
    let red = FrameRequest { colors: vec![(1, [1.0, 0.0, 0.0])], ..plain.clone() };
    let (before, painted) = (colors(&viewer, &plain), colors(&viewer, &red));
    assert_eq!(middle(&before, 0), middle(&painted, 0));
    let [r, g, b] = middle(&painted, 1);
    assert!(r > 100 && g < 10 && b < 10, "{:?}", middle(&painted, 1));
    assert_eq!(colors(&viewer, &plain), before);
    for (wrong, why) in [((2, [0.0; 3]), "identifiers"), ((0, [0.0, f64::NAN, 0.0]), "from 0 to 1")]
    {
        let wrong = FrameRequest { colors: vec![wrong], ..plain.clone() };
        assert!(viewer.frame(&wrong, &()).unwrap_err().to_string().contains(why));
    }
}

fn with(choice: EnvironmentChoice, strength: f64, turn: f64) -> EnvironmentRequest {
    EnvironmentRequest { choice, strength, turn }
}

fn brightness(colors: &[[u8; 3]], ball: usize) -> u32 {
    middle(colors, ball).iter().copied().map(u32::from).sum()
}

#[test]
fn the_environment_of_the_scene_is_turned_and_scaled() {
    // Bright where +x is.
    let texels: Vec<[f32; 3]> = [0.05, 0.05, 0.9, 0.05, 0.05, 0.05].map(|x| [x; 3]).to_vec();
    let map = Arc::new(EnvironmentMap::new(6, 1, texels).unwrap());
    let kind = EnvironmentKind::of_map(map, DVec3::Z, &DMat3::IDENTITY);
    let viewer = viewer(Some(Environment::new(kind)));
    let plain = FrameRequest { samples: Some(64), ..request(&viewer) };
    let own = |strength, turn| FrameRequest {
        environment: Some(with(EnvironmentChoice::Own, strength, turn)),
        ..plain.clone()
    };
    let before = colors(&viewer, &plain);
    assert_eq!(colors(&viewer, &own(1.0, 0.0)), before);
    assert_eq!(colors(&viewer, &own(1.0, 360.0)), before);
    assert!(brightness(&colors(&viewer, &own(2.0, 0.0)), 0) > brightness(&before, 0) + 20);
    // The camera looks along +y: from behind it comes more light than from the side.
    assert!(brightness(&colors(&viewer, &own(1.0, -90.0)), 1) > brightness(&before, 1) + 20);
    for (strength, turn) in [(-1.0, 0.0), (f64::NAN, 0.0), (1.0, f64::INFINITY)] {
        assert!(viewer.frame(&own(strength, turn), &()).is_err());
    }
    // Without it there is the automatic light.
    let none = FrameRequest {
        environment: Some(with(EnvironmentChoice::None, 1.0, 0.0)),
        ..plain.clone()
    };
    assert_ne!(colors(&viewer, &none), before);
}

#[test]
fn daylight_has_its_sun_where_the_page_has_it() {
    let viewer = viewer(None);
    let day = |sun: Option<[f64; 3]>| FrameRequest {
        samples: Some(16),
        sun,
        environment: Some(with(EnvironmentChoice::Daylight, 1.0, 0.0)),
        ..request(&viewer)
    };
    let front = colors(&viewer, &day(Some([0.0, 1.0, -0.5])));
    let behind = colors(&viewer, &day(Some([0.0, -1.0, -0.5])));
    assert!(brightness(&front, 0) > brightness(&behind, 0) + 50);
    assert!(viewer.frame(&day(None), &()).is_ok());
    let night = viewer.frame(&day(Some([0.0, 1.0, 0.5])), &()).unwrap_err();
    assert!(night.to_string().contains("elevation"), "{night}");
}

#[test]
fn questions_are_answered_by_their_names() {
    let viewer = viewer(None);
    let ask = |name: &str, about: &Value| viewer.answer(name, about.to_string().as_bytes(), &());
    assert_eq!(ask("info", &Value::Null).unwrap().json, viewer.info());
    let camera = viewer.info()["camera"].take();
    let Answer { json, pixels } = ask("frame", &json!({"camera": camera, "channel": "t"})).unwrap();
    let expected = json!({"rows": 30, "columns": 60, "samples": 1, "full_samples": 16, "components": 1, "dtype": "float32"});
    assert_eq!(json, expected);
    assert!(!pixels.is_empty());
    let probed = ask("probe", &json!({"camera": camera, "pixel": [15, 15]})).unwrap();
    assert_eq!(probed.json["hit"]["object"], 0);
    assert!(ask("camera", &json!({"camera": camera})).unwrap().json["toml"].is_string());
    assert!(matches!(ask("open", &json!({})), Err(AnswerError::Unknown(_))));
    assert!(matches!(ask("frame", &json!({})), Err(AnswerError::Malformed(_))));
    let outside = ask("probe", &json!({"camera": camera, "pixel": [0, 60]}));
    assert!(matches!(outside, Err(AnswerError::Failed(_))));
}

/// The page asks for as many in steps: soft light needs more than hard light.
#[test]
fn a_first_frame_tells_how_many_samples_there_will_be() {
    let viewer = viewer(None);
    for (light, expected) in [("studio", 16), ("shoulder", 4)] {
        let whole =
            FrameRequest { samples: None, light: Some(light.to_owned()), ..request(&viewer) };
        let first = FrameRequest { samples: Some(1), is_lit: false, ..whole.clone() };
        let told = viewer.frame(&first, &()).unwrap();
        assert_eq!((told.samples, told.full_samples), (1, expected), "{light}");
        assert_eq!(viewer.frame(&whole, &()).unwrap().samples, expected);
    }
    assert_eq!(viewer.info()["environment"], false);
}

/// A tetrahedron of some of its sides, cut across, in red.
fn cut_tetrahedron(sides: &[[u32; 3]]) -> (Viewer, FrameRequest) {
    let tips = vec![[-1.0, -1.0, -1.0], [1.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]];
    let mesh = Mesh::new(Positions::compact(tips), sides.to_vec()).unwrap();
    let scene = Scene::new(vec![Object::new(Arc::new(mesh))]).unwrap();
    let camera = framing_camera(&scene, DVec3::Z, StandardView::Top, SHAPE).unwrap();
    let viewer = Viewer::new("tetrahedron", scene, Appearance::default(), &camera).unwrap();
    let cut = Cut { normal: [0.0, 0.0, 1.0], offset: 0.0 };
    let request = FrameRequest {
        colors: vec![(0, [1.0, 0.0, 0.0])],
        part: Visibility { cut: Some(cut), ..Visibility::default() },
        ..request(&viewer)
    };
    (viewer, request)
}

#[test]
fn cut_faces_have_the_colour_that_is_asked_for_and_their_areas() {
    let (viewer, mut request) = cut_tetrahedron(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    request.cut_color = Some([0.0, 0.0, 1.0]);
    let [rows, columns] = SHAPE;
    let [red, _, blue] = colors(&viewer, &request)[rows / 2 * columns + columns / 2];
    assert!(red == 0 && blue > 200);
    request.cut_color = Some([0.0, 0.0, 2.0]);
    let error = viewer.frame(&request, &()).unwrap_err();
    assert!(error.to_string().contains("cut_color"), "{error}");
    let asked = |part, svg| viewer.section(&SectionRequest { part, svg }, &());
    // Half of each edge is cut off, and so three quarters of the area.
    let told = asked(request.part, true).unwrap();
    assert_eq!(told["area"], 0.5);
    assert_eq!(told["faces"][0]["area"], 0.5);
    assert!(told["svg"].as_str().unwrap().contains("<path"));
    let error = asked(Visibility::default(), false).unwrap_err();
    assert!(error.to_string().contains("cut must be a plane"), "{error}");
}

#[test]
fn a_mesh_with_a_gap_on_the_plane_has_no_area() {
    let (viewer, request) = cut_tetrahedron(&[[0, 2, 1], [0, 1, 3], [1, 2, 3]]);
    let (part, svg) = (request.part, false);
    let told = viewer.section(&SectionRequest { part, svg }, &()).unwrap();
    assert_eq!(told["faces"][0]["area"], Value::Null);
    assert_eq!(told["svg"], Value::Null);
}

#[test]
fn colours_by_numbers_tell_their_range() {
    let coloring = Coloring::new(ColorBy::Height);
    let appearance = Appearance { coloring: Some(coloring), ..Appearance::default() };
    let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 2.0).unwrap())]).unwrap();
    let camera = framing_camera(&scene, DVec3::Z, StandardView::Iso, SHAPE).unwrap();
    let viewer = Viewer::new("ball", scene, appearance, &camera).unwrap();
    let info = viewer.info();
    assert_eq!(info["colors"]["by"], "height");
    assert_eq!(info["colors"]["below"], Value::Null);
    let painted = viewer.frame(&request(&viewer), &()).unwrap();
    assert_eq!(painted.range, Some([-2.0, 2.0]));
    let channel = "t".to_owned();
    let distances = FrameRequest { channel, ..request(&viewer) };
    assert_eq!(viewer.frame(&distances, &()).unwrap().range, None);
}

#[test]
fn a_plane_through_a_solid_shows_a_face_in_its_colour() {
    let sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let of_sides = |sides: &[[u32; 3]]| {
        let (viewer, request) = cut_tetrahedron(sides);
        colors(&viewer, &request)
    };
    let cut = of_sides(&sides);
    // Half of each edge is cut off: the face is a triangle in the middle.
    let [rows, columns] = SHAPE;
    let across = |colors: &[[u8; 3]]| colors[rows / 2 * columns..][columns / 2 - 4..][..8].to_vec();
    let spread = |face: &[[u8; 3]]| {
        assert!(face.iter().all(|&[r, g, b]| r > 200 && g == 0 && b == 0), "{face:?}");
        face.iter().max().unwrap()[0] - face.iter().min().unwrap()[0]
    };
    let face = across(&cut);
    assert!(spread(&face) > 10, "it has stripes: {face:?}");
    // The direction in which triangles face does not matter.
    let turned = sides.map(|[a, b, c]| [a, c, b]);
    assert_eq!(across(&of_sides(&turned)), face);
    // An open mesh has no inside. A side at which the rays do not look is missing.
    let open = across(&of_sides(&sides[..3]));
    assert!(spread(&open) < 10, "{open:?}");
}

/// Boxes from a height to another, each as wide, cut at a height: red the first, blue the second.
fn cut_boxes(boxes: [[f64; 3]; 2], height: f64, view: StandardView) -> (Viewer, FrameRequest) {
    let object = |[low, high, wide]: [f64; 3]| {
        let corner = |k: usize| {
            [0, 1, 2].map(|axis| [[-wide, wide], [-wide, wide], [low, high]][axis][k >> axis & 1])
        };
        let corners = Positions::compact((0..8).map(corner).collect());
        let sides =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Object::new(Arc::new(Mesh::new(corners, triangles.collect()).unwrap()))
    };
    let scene = Scene::new(boxes.map(object).into()).unwrap();
    let camera = framing_camera(&scene, DVec3::Z, view, SHAPE).unwrap();
    let viewer = Viewer::new("boxes", scene, Appearance::default(), &camera).unwrap();
    let cut = Cut { normal: [0.0, 0.0, 1.0], offset: height };
    let request = FrameRequest {
        colors: vec![(0, [1.0, 0.0, 0.0]), (1, [0.0, 0.0, 1.0])],
        part: Visibility { cut: Some(cut), ..Visibility::default() },
        ..request(&viewer)
    };
    (viewer, request)
}

#[test]
fn a_plane_in_a_common_face_shows_one_of_the_solids() {
    for height in [0.1, 0.3, 1e6 + 0.1] {
        let base = height - 1.1;
        let (viewer, request) = cut_boxes(
            [[base, height, 1.0], [height, height + 0.9, 1.0]],
            height,
            StandardView::Iso,
        );
        let colors = colors(&viewer, &request);
        let red = colors.iter().filter(|[red, _, blue]| *red > 150 && *blue == 0);
        assert!(red.count() > 200);
        // The other one is cut away.
        let blue = colors.iter().filter(|[red, _, blue]| blue > red && *blue > 160);
        assert_eq!(blue.count(), 0);
    }
}

#[test]
fn of_nested_solids_the_innermost_is_seen_and_told() {
    let (outer, inner) = ([-1.0, 1.0, 1.0], [-0.5, 0.5, 0.5]);
    for (boxes, object) in [([outer, inner], 1), ([inner, outer], 0)] {
        let (viewer, request) = cut_boxes(boxes, 0.0, StandardView::Top);
        let [rows, columns] = SHAPE;
        // It looks down at the middle.
        let probe = Probe {
            camera: request.camera,
            pixel: [rows / 2, columns / 2],
            part: request.part.clone(),
        };
        let told = viewer.probe(&probe, &()).unwrap();
        let face = &told["cut_face"];
        assert_eq!(face["object"], object);
        assert!(face["position"][2].as_f64().unwrap().abs() < 1e-12);
        assert_eq!(face["normal"], json!([0.0, 0.0, 1.0]));
        assert!(told["hit"]["t"].as_f64() > face["t"].as_f64());
        let seen = colors(&viewer, &request)[rows / 2 * columns + columns / 2];
        let [full, none] = [seen[2 * object], seen[2 - 2 * object]];
        assert!(full > 200 && none == 0, "{seen:?}");
    }
}
