//! Attributes of meshes as channels, and names of what identifiers stand for.

use serde_json::{Value, json};

use crate::support::Lab;

/// A triangle in the plane z = 0 with a number at each corner.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    property float quality\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 1\n4 0 0 3\n0 4 0 9\n3 0 1 2\n";

fn lab() -> Lab {
    let lab = Lab::new();
    lab.write("a.ply", PLY);
    lab
}

#[test]
fn rays_get_attributes_by_name() {
    let lab = lab();
    lab.write("rays.csv", "1,1,5,0,0,-1\n9,9,5,0,0,-1\n");
    let shot = lab.ok("shoot a.ply rays.csv --channels t,attribute:quality");
    // 1 + 2/4 + 8/4 at (1, 1).
    assert_eq!(shot.text(), "t,attribute:quality\n5,3.5\ninf,nan\n");
    let piped = lab.pipe("shoot a.ply - --channels attribute:quality", b"2,1,5,0,0,-1\n");
    assert_eq!(piped.text(), "attribute:quality\n4\n");
    let all = lab.ok("shoot a.ply rays.csv --all --channels attribute:quality");
    assert_eq!(all.text(), "ray,attribute:quality\n0,3.5\n");
    let unknown = "there are quality";
    lab.fails("shoot a.ply rays.csv --channels attribute:heat", 2, unknown);
    lab.fails("shoot a.ply rays.csv --channels attribute:", 2, "the name of an attribute");
}

#[test]
fn pictures_get_attributes_by_name() {
    let lab = lab();
    lab.ok("render a.ply --size 30x20 --channels position,attribute:quality -o all.npz -o {channel}.npy");
    let all = lab.npz("all.npz");
    let (places, quality) = (&all["position"].values, &all["attribute:quality"].values);
    assert!(quality.iter().any(|value| !value.is_nan()));
    for (place, value) in places.chunks(3).zip(quality) {
        let expected = 1.0 + 0.5 * place[0] + 2.0 * place[1];
        assert!((value - expected).abs() < 1e-12 || (place[0].is_nan() && value.is_nan()));
    }
    assert!(lab.names().contains(&"attribute-quality.npy".to_owned()));
    lab.fails("render a.ply --channels attribute:heat -o a.npz", 2, "there are quality");
    lab.write(
        "a.toml",
        "[[objects]]\nfile = \"a.ply\"\n[[outputs]]\nfile = \"of.npz\"\nchannels = [\"t\", \"attribute:quality\"]\n",
    );
    lab.ok("render a.toml --size 30x20");
    assert!(lab.npz("of.npz").contains_key("attribute:quality"));
}

/// A name that is no name of a file cannot lead out of the folder.
#[test]
fn names_of_attributes_are_no_paths() {
    let lab = Lab::new();
    lab.write("a.ply", PLY.replace("quality", "../quality"));
    lab.ok("render a.ply --size 9x6 --channels attribute:../quality -o {channel}.npy");
    assert!(lab.names().contains(&"attribute-.._quality.npy".to_owned()));
}

#[test]
fn info_says_what_identifiers_stand_for() {
    let lab = Lab::new();
    let document = json!({
        "asset": {"version": "2.0"},
        "nodes": [{"name": "truck", "children": [1, 2]}, {"name": "wheel", "mesh": 0}, {"name": "wheel", "mesh": 0}],
        "meshes": [{"name": "Wheel", "primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"name": "rubber"}],
        "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}],
    });
    lab.write("a.gltf", document.to_string());
    let said: Value = serde_json::from_str(lab.ok("info a.gltf --json").text()).unwrap();
    let objects = said["objects"].as_array().unwrap();
    assert_eq!(objects.len(), 2);
    for (k, object) in objects.iter().enumerate() {
        let part = |key: &str| object[key].clone();
        assert_eq!(
            [part("node"), part("mesh"), part("materials")],
            [
                json!({"id": k, "name": "truck/wheel"}),
                json!({"id": 0, "name": "Wheel"}),
                json!([0])
            ]
        );
    }
    assert_eq!(said["materials"][0]["name"], "rubber");
    lab.ok("render a.gltf --size 9x6 --channels node -o a.npz");
    let said: Value = serde_json::from_str(lab.ok("info a.npz --json").text()).unwrap();
    assert_eq!(said["metadata"]["names"]["node"], json!(["truck/wheel", "truck/wheel"]));
}
