"""Names of what objects come from, and attributes as channels of pictures and files."""

import json
import pickle

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE

TRUCK = {
    "asset": {"version": "2.0"},
    "scenes": [{"nodes": [0]}],
    "nodes": [
        {"name": "truck", "children": [1, 2]},
        {"name": "wheel", "mesh": 0},
        {"name": "wheel", "mesh": 0, "translation": [5, 0, 0]},
    ],
    "meshes": [
        {"name": "Wheel", "primitives": [{"attributes": {"POSITION": 0}, "mode": 5, "material": 0}]}
    ],
    "materials": [{"name": "rubber"}],
    # -1 -1 0, 1 -1 0, -1 1 0, 1 1 0
    "accessors": [{"bufferView": 0, "componentType": 5120, "count": 4, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 16, "byteStride": 4}],
    "buffers": [{"byteLength": 16, "uri": "data:;base64,//8AAAH/AAD/AQAAAQEAAA=="}],
}


def truck(tmp_path):
    path = tmp_path / "truck.gltf"
    path.write_text(json.dumps(TRUCK))
    return fh.load(path)


def down(*places):
    return [[x, y, 5.0] for x, y in places], [0, 0, -1]


def test_objects_of_a_file_know_their_node_mesh_and_material(tmp_path):
    scene = truck(tmp_path)
    for made in scene.objects:
        assert (made.name, made.node, made.mesh_name) == ("wheel", "truck/wheel", "Wheel")
        assert [look.name for look in made.materials] == ["rubber"]
    hits = scene.shoot(*down((0, 0), (5, 0), (9, 9)))
    assert hits.object.tolist() == hits["node"].tolist() == [0, 1, -1]
    assert hits.mesh.tolist() == hits.material.tolist() == [0, 0, -1]
    assert hits.node.dtype == hits.mesh.dtype == hits.material.dtype == np.int32
    assert hits.names("node") == ("truck/wheel", "truck/wheel")
    assert hits.names("object") == ("wheel", "wheel")
    assert (hits.names("mesh"), hits.names("material")) == (("Wheel",), ("rubber",))
    with pytest.raises(ValueError, match="channel must be one of object"):
        hits.names("face")


def test_names_survive_pickles_built_scenes_and_changes(tmp_path):
    scene = truck(tmp_path)
    scene.save(tmp_path / "truck.fhs")
    for again in (pickle.loads(pickle.dumps(scene)), fh.open(tmp_path / "truck.fhs")):
        assert again.objects[1].node == "truck/wheel"
        hits = again.shoot(*down((0, 0), (5, 0)))
        assert (hits.node.tolist(), hits.mesh.tolist()) == ([0, 1], [0, 0])
        assert hits.names("material") == ("rubber",)
    scene.replace(1, fh.Mesh(*SQUARE))
    assert (scene.objects[1].node, scene.objects[1].mesh_name) == ("truck/wheel", None)
    hits = scene.shoot(*down((0, 0), (5, 0)))
    assert (hits.node.tolist(), hits.mesh.tolist()) == ([0, 1], [0, 1])
    assert hits.names("mesh") == ("Wheel", "")
    scene.move(0, np.eye(4))
    assert scene.shoot(*down((0, 0))).node.tolist() == [0]
    scene.remove(0)
    assert scene.objects[0].node is None


def test_materials_are_one_where_name_and_look_are():
    scene = fh.Scene()
    looks = [
        fh.Material(color="red", name="a"),
        fh.Material(color="red", name="b"),
        fh.Material(color="red", name="a"),
        fh.Material(color="blue", name="a"),
        None,
    ]
    for x, look in enumerate(looks):
        scene.add(fh.Sphere(center=(3 * x, 0, 0), radius=1), material=look)
    hits = scene.shoot(*down(*((3 * x, 0) for x in range(5))))
    assert hits.material.tolist() == [0, 1, 0, 2, -1]
    assert hits.names("material") == ("a", "b", "a")
    assert looks[0] == looks[2] != looks[1]
    assert hits.mesh.tolist() == hits.node.tolist() == [-1] * 5


def test_metadata_have_the_names(tmp_path):
    scene = truck(tmp_path)
    wheel = {"name": "wheel", "mesh": 0, "materials": [0]}
    names = {
        "object": [{**wheel, "node": 0}, {**wheel, "node": 1}],
        "node": ["truck/wheel", "truck/wheel"],
        "mesh": ["Wheel"],
        "material": ["rubber"],
    }
    frame = fh.render(scene, channels=["object", "material"])
    assert frame.metadata["names"] == names
    for name in ("a.exr", "a.npz"):
        frame.save(tmp_path / name)
        assert fh.read_metadata(tmp_path / name)["names"] == names
    hits = scene.shoot(*down((0, 0)))
    hits.save(tmp_path / "b.npz", ["t", "material"])
    assert fh.read_metadata(tmp_path / "b.npz")["names"] == {"material": ["rubber"]}
    hits.save(tmp_path / "c.npz", "t")
    assert "names" not in fh.read_metadata(tmp_path / "c.npz")


def plate():
    vertices, faces = SQUARE
    heat = np.arange(len(vertices)) * 10.0
    pairs = np.arange(2 * len(vertices)).reshape(-1, 2) + 0.5
    properties = {"heat": heat, "a b": pairs}
    scene = fh.Scene()
    scene.add(fh.Mesh(vertices, faces, vertex_properties=properties))
    return scene


def test_pictures_and_files_have_attributes_as_channels(tmp_path):
    scene = plate()
    camera = fh.Camera.framing(scene, rows=9, columns=12)
    frame = fh.render(scene, camera, channels=["position", "attribute:heat", "attribute:a b"])
    hits = scene.shoot(camera)
    for name in ("heat", "a b"):
        np.testing.assert_array_equal(frame[f"attribute:{name}"], hits.attribute(name))
    assert np.isfinite(frame["attribute:heat"]).any()
    part = fh.render(scene, camera, channels="attribute:heat", region=np.s_[2:5, 3:])
    np.testing.assert_array_equal(part["attribute:heat"], frame["attribute:heat"][2:5, 3:])
    frame.save(tmp_path / "a.npz")
    hits.save(tmp_path / "b.npz", ["position", "attribute:heat", "attribute:a b"])
    for name in ("a.npz", "b.npz"):
        saved = np.load(tmp_path / name)
        np.testing.assert_array_equal(saved["attribute:heat"], frame["attribute:heat"])
        np.testing.assert_array_equal(saved["attribute:a_b"], frame["attribute:a b"])
    frame.save(tmp_path / "{channel}.png")
    assert (tmp_path / "attribute-a_b.png").exists()
    with pytest.raises(ValueError, match="'cold'; there are a b, heat"):
        fh.render(scene, camera, channels="attribute:cold")
    with pytest.raises(ValueError, match="channels must be among"):
        fh.render(scene, camera, channels="attribute:")
