//! Names of identifiers: in the metadata of outputs, in built scenes, and from each format.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use firsthit::image::{Data, Frame, Names, read};
use firsthit::load::{LoadSettings, load, load_bytes};
use firsthit::render::Region;
use firsthit::scene::Label;
use firsthit::shape::{Property, PropertyOf, PropertyValues};
use firsthit::world::World;
use firsthit::{
    Color, DVec3, Material, Mesh, Object, Positions, Render, Scene, Sphere, Transform, fhs,
};

fn label(number: u64, name: &str) -> Label {
    Label { number, name: name.into() }
}

fn steel() -> Material {
    Material { name: "steel".into(), ..Material::colored(Color::splat(0.3)) }
}

fn triangle() -> Arc<Mesh> {
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    Mesh::new(Positions::compact(corners), vec![[0, 1, 2]]).unwrap().into()
}

/// Two instances of a mesh, a ball, and another mesh.
fn scene() -> Scene {
    let mesh = triangle();
    let moved = Transform::translation(DVec3::new(3.0, 0.0, 0.0)).unwrap();
    let ball = Sphere::new(DVec3::new(-3.0, 0.0, 0.0), 1.0).unwrap();
    let other = Object::new(triangle()).placed(Transform::translation(DVec3::Z).unwrap());
    Scene::new(vec![
        Object::new(Arc::clone(&mesh))
            .named("part")
            .from_node(label(4, "car/part"))
            .from_mesh(label(1, "Part"))
            .with_materials([steel(), Material::default()]),
        Object::new(mesh)
            .named("part")
            .placed(moved)
            .from_node(label(5, "car/part"))
            .from_mesh(label(1, "Part")),
        Object::new(ball).named("ball").with_materials([steel()]),
        other,
    ])
    .unwrap()
}

/// As a reader of the file's JSON has it.
fn names_in(scene: &Scene, channels: &[&str], file: &str) -> Option<Names> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    let mut frame = Render::new(scene).size(6, 8).channels(channels);
    frame = frame.samples(1);
    frame.frame().unwrap().save(&path).unwrap();
    read(&path).unwrap().metadata.unwrap().names
}

#[test]
fn metadata_say_what_identifiers_stand_for() {
    let scene = scene();
    for file in ["a.npz", "a.exr", "a.ply", "a.pcd"] {
        let channels = ["position", "object"];
        let names = names_in(&scene, &channels, file).unwrap();
        let json = serde_json::to_value(&names).unwrap();
        let expected = serde_json::json!({
            "object": [
                {"name": "part", "node": 0, "mesh": 0, "materials": [0, 1]},
                {"name": "part", "node": 1, "mesh": 0, "materials": []},
                {"name": "ball", "node": null, "mesh": null, "materials": [0]},
                {"name": "", "node": null, "mesh": 1, "materials": []},
            ],
            "node": ["car/part", "car/part"],
            "mesh": ["Part", ""],
            "material": ["steel", ""],
        });
        assert_eq!(json, expected, "{file}");
    }
    let of_materials = names_in(&scene, &["material"], "a.png").unwrap();
    let json = serde_json::to_value(&of_materials).unwrap();
    assert_eq!(json, serde_json::json!({"material": ["steel", ""]}));
    assert_eq!(names_in(&scene, &["color", "t"], "a.npz"), None);
}

#[test]
fn built_scenes_keep_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.fhs");
    let scene = scene();
    fhs::save(&path, &scene, &World::default(), &()).unwrap();
    let opened = fhs::open(&path, true).unwrap().into_scene().unwrap();
    assert_eq!(opened.objects(), scene.objects());
    assert_eq!(opened.objects()[1].node(), Some(&label(5, "car/part")));
    assert_eq!(&*opened.objects()[2].materials()[0].name, "steel");
    assert_eq!(firsthit::render::names(&opened), firsthit::render::names(&scene));
}

/// One look under two names is two materials, which look alike.
#[test]
fn materials_of_obj_files_have_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let faces = "usemtl red\nf 1 2 3\nusemtl rouge\nf 2 4 3\n";
    let text = format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\no board\n{faces}");
    fs::write(&path, text).unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl red\nKd 1 0 0\nnewmtl rouge\nKd 1 0 0\n")
        .unwrap();
    let scene = load(&path, &LoadSettings::default()).unwrap().into_scene().unwrap();
    let names: Vec<&str> = (scene.catalog().materials().iter()).map(|name| &**name).collect();
    assert_eq!(names, ["red", "rouge"]);
    let frame = Render::new(&scene).size(40, 40).channels(&["material", "primitive"]);
    let frame = frame.frame().unwrap();
    let data = |name: &str| frame.channel(name).unwrap().data.clone();
    assert_eq!(data("material"), data("primitive"));
}

/// A file that is named twice has its nodes twice, and its meshes once.
#[test]
fn nodes_of_a_scene_file_are_those_of_each_of_its_tables() {
    let folder = tempfile::tempdir().unwrap();
    let gltf = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "car", "children": [1, 2]}, {"name": "wheel", "mesh": 0}, {"mesh": 0, "scale": [2, 1, 1]}],
        "meshes": [{"name": "Wheel", "primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}]}"#;
    fs::write(folder.path().join("car.gltf"), gltf).unwrap();
    fs::copy(folder.path().join("car.gltf"), folder.path().join("van.gltf")).unwrap();
    let text = "[[objects]]\nfile = \"car.gltf\"\nname = \"mine\"\n[[objects]]\nfile = \"car.gltf\"\n\
        [[objects]]\nfile = \"van.gltf\"\n[[objects]]\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n";
    let path = folder.path().join("a.toml");
    fs::write(&path, text).unwrap();
    let scene = load(&path, &LoadSettings::default()).unwrap().into_scene().unwrap();
    let names = firsthit::render::names(&scene);
    let nodes = names.node.unwrap();
    let expected =
        ["mine/car/wheel", "mine/car/node 2", "car/wheel", "car/node 2", "car/wheel", "car/node 2"];
    assert_eq!(nodes, expected);
    assert_eq!(names.mesh.unwrap(), ["Wheel", "Wheel"]);
    let objects = names.object.unwrap();
    let of: Vec<_> = objects.iter().map(|object| (object.node, object.mesh)).collect();
    let pair = |node, mesh| (Some(node), Some(mesh));
    assert_eq!(
        of,
        [pair(0, 0), pair(1, 0), pair(2, 0), pair(3, 0), pair(4, 1), pair(5, 1), (None, None)]
    );
}

/// Some formats keep metadata as ASCII or Latin-1 only.
#[test]
fn names_of_any_script_come_back_from_every_format() {
    let name = "R\u{e4}der \u{8eca}\u{1f69a}\"\\";
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()).named(name);
    let scene = Scene::new(vec![ball]).unwrap();
    for file in ["a.npz", "a.exr", "a.ply", "a.pcd", "a.png"] {
        let channels: &[&str] = match file {
            "a.png" => &["object"],
            _ => &["position", "object"],
        };
        let names = names_in(&scene, channels, file).unwrap();
        assert_eq!(names.object.unwrap()[0].name, name, "{file}");
    }
}

/// A triangle in the plane z = 0 with a number, and with five, at each vertex.
fn plate() -> Scene {
    let heat = PropertyValues::Double(vec![10.0, 20.0, 40.0].into());
    let many = PropertyValues::Double((0..15).map(f64::from).collect::<Vec<_>>().into());
    let heat = Property::new("heat (K)", PropertyOf::Vertices, heat);
    let many = Property { components: 5, ..Property::new("many", PropertyOf::Vertices, many) };
    let mesh = Mesh::clone(&triangle());
    let mesh = mesh.with_properties(vec![heat, many]).unwrap();
    Scene::new(vec![Object::new(Arc::new(mesh))]).unwrap()
}

fn plate_picture(scene: &Scene) -> Render<'_> {
    let channels = &["position", "attribute:heat (K)", "attribute:many"];
    Render::new(scene).size(20, 30).channels(channels)
}

fn doubles<'a>(frame: &'a Frame, name: &str) -> &'a [f64] {
    match frame.channel(name).map(|channel| &channel.data) {
        Some(Data::Float64(values)) => values,
        other => panic!("{name}: {other:?}"),
    }
}

/// The number is linear in the place.
#[test]
fn pictures_have_attributes_as_channels() {
    let scene = plate();
    let frame = plate_picture(&scene).frame().unwrap();
    let heat = doubles(&frame, "attribute:heat__K_");
    let (places, _) = doubles(&frame, "position").as_chunks::<3>();
    let mut hits = 0;
    for (&[x, y, _], heat) in places.iter().zip(heat) {
        let expected = 10.0 + 10.0 * x + 30.0 * y;
        assert!((heat - expected).abs() < 1e-12 || (x.is_nan() && heat.is_nan()));
        hits += usize::from(!x.is_nan());
    }
    assert!(hits > 50, "{hits}");
    assert_eq!(frame.channel("attribute:many").unwrap().components, 5);
    assert_eq!(doubles(&frame, "attribute:many").len(), 5 * 20 * 30);
    let region = Region { rows: 3..9, columns: 5..25 };
    let part = plate_picture(&scene).region(region).frame().unwrap();
    let part = doubles(&part, "attribute:heat__K_");
    assert_eq!(part.len(), 6 * 20);
    assert_eq!(part[0].to_bits(), heat[3 * 30 + 5].to_bits());
}

#[test]
fn files_have_attributes_as_channels() {
    let scene = plate();
    let frame = plate_picture(&scene).frame().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for file in ["a.npz", "a.exr", "a.ply", "a.pcd"] {
        let path = folder.path().join(file);
        frame.save(&path).unwrap();
        let metadata = read(&path).unwrap().metadata.unwrap();
        let many = metadata.channel("attribute:many").unwrap();
        assert_eq!(many.components, 5, "{file}");
    }
    let png = folder.path().join("a.png");
    frame.save_channel("attribute:heat__K_", &png).unwrap();
    let refused = frame.save_channel("attribute:many", &png).unwrap_err();
    assert!(refused.to_string().contains("one to three numbers"), "{refused}");
}

#[test]
fn unknown_attributes_are_refused_with_those_there_are() {
    let scene = plate();
    let refused = |name| {
        let error = Render::new(&scene).channels(&[name]).frame().unwrap_err();
        error.to_string()
    };
    let unknown = refused("attribute:cold");
    assert!(unknown.contains("'cold'; there are heat (K), many"), "{unknown}");
    let nameless = refused("attribute:");
    assert!(nameless.contains("an attribute's name"), "{nameless}");
}

#[test]
fn formats_without_nodes_have_meshes_without_names() {
    let stl = b"solid one\nfacet normal 0 0 1\nouter loop\n\
        vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid one\n";
    let loaded = load_bytes(Path::new("one.stl"), stl, &LoadSettings::default()).unwrap();
    let scene = loaded.into_scene().unwrap();
    let catalog = scene.catalog();
    assert_eq!((catalog.nodes().len(), catalog.materials().len()), (0, 0));
    assert_eq!((catalog.mesh_of(0), &*catalog.meshes()[0]), (0, ""));
}
