"""Numbers of one's own in pictures, point clouds and meshes, by their own names."""

import firsthit as fh
import numpy as np
import pytest
from support import ball

RAYS = ([[0, 0, 5], [0, 3, 5], [0, 0.6, 5]], [0, 0, -1])
SHAPE = (3, 4)
OWN = {
    "quality": np.linspace(0, 1, 12).reshape(SHAPE),
    "label": np.arange(12, dtype=np.int64).reshape(SHAPE),
    "good": np.arange(12).reshape(SHAPE) % 2 == 0,
    "pair": np.arange(24.0).reshape(*SHAPE, 2),
}


@pytest.mark.parametrize("name", ["a.npz", "a.exr"])
def test_a_frame_keeps_numbers_of_one_s_own_by_their_own_name(name, tmp_path):
    fh.Frame(SHAPE, {"t": np.ones(SHAPE), **OWN}).save(tmp_path / name)
    read = fh.Frame.load(tmp_path / name)
    assert read.channels[0] == "t"
    assert {*read.channels} == {"t", *OWN}
    for channel, values in OWN.items():
        np.testing.assert_allclose(read[channel], values, rtol=1e-7)
        kinds = {"quality": "f", "label": "i", "good": "b", "pair": "f"}
        assert read[channel].dtype.kind == kinds[channel]
    records = {record["name"]: record for record in fh.read_metadata(tmp_path / name)["channels"]}
    assert records["quality"]["about"] == "numbers of one's own"
    assert records["pair"]["components"] == 2


def test_each_has_a_file_of_its_own_whose_name_leads_nowhere_else(tmp_path):
    fh.Frame(SHAPE, {"../up/on": OWN["quality"], "good": OWN["good"]}).save(
        tmp_path / "{channel}.npy"
    )
    assert {path.name for path in tmp_path.iterdir() if path.suffix == ".npy"} == {
        ".._up_on.npy",
        "good.npy",
    }
    fh.Frame(SHAPE, {"quality": OWN["quality"]}).save(tmp_path / "a.png")
    assert fh.read_metadata(tmp_path / "a.png")["channels"][0]["name"] == "quality"


def test_a_cloud_has_numbers_of_one_s_own_as_columns(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    hits = ball().shoot(*RAYS)
    own = {"distance": np.array([0.5, 1, 2]), "class id": [3, 4, 5]}
    hits.save(tmp_path / "a.ply", ["position", "t"], own=own)
    data = trimesh.load(tmp_path / "a.ply").metadata["_ply_raw"]["vertex"]["data"]
    # Misses are left out.
    np.testing.assert_array_equal(data["distance"], [0.5, 2])
    np.testing.assert_array_equal(data["class_id"], [3, 5])
    hits.save(tmp_path / "a.npz", "t", own=own)
    with np.load(tmp_path / "a.npz") as read:
        np.testing.assert_array_equal(read["distance"], own["distance"])
    met = ball().shoot_all(*RAYS)
    met.save(tmp_path / "all.npz", "t", own={"part": np.arange(4.0)})
    with np.load(tmp_path / "all.npz") as read:
        assert read["part"].tolist() == [0, 1, 2, 3]
        assert read["ray"].tolist() == [0, 0, 2, 2]
    frame = fh.Frame((1, 3), {"position": hits.position[None], "distance": own["distance"][None]})
    frame.save(tmp_path / "frame.pcd")
    assert b"FIELDS x y z distance\n" in (tmp_path / "frame.pcd").read_bytes()


@pytest.mark.parametrize(
    ("own", "name", "message"),
    [
        ({"z": [1, 2, 3]}, "a.ply", "names that are no channels, got 'z'"),
        ({"ray": [1, 2, 3]}, "a.ply", "names that are no channels, got 'ray'"),
        ({"x": [1.0, 2, 3]}, "a.ply", "x of x and of position"),
        ({"q": [1, 2]}, "a.ply", r"q must have the shape \(3,\) or \(3, k\), got \(2,\)"),
        ({"q": ["a", "b", "c"]}, "a.ply", "q must be bool or real numbers"),
        ({"q": [1, 2, 3]}, "a.npy", "which takes one channel"),
        ({"": [1, 2, 3]}, "a.ply", "channel"),
        ({"crypto_object:7": [1, 2, 3]}, "a.npz", "even number of pairs"),
    ],
)
def test_numbers_of_one_s_own_that_cannot_be_held_are_refused(own, name, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        ball().shoot(*RAYS).save(tmp_path / name, own=own)
    assert not list(tmp_path.iterdir())


def test_a_mesh_with_its_thickness_is_a_ply_that_is_read_again(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    part = trimesh.creation.box((2, 3, 1))
    part.visual.vertex_colors = [0, 188, 255, 255]
    scene = fh.Scene()
    scene.add(part)
    mesh = scene.objects[0].shape
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    thick = scene.thickness(middles)
    heat = np.arange(8.0)
    mesh.save(
        tmp_path / "a.ply",
        vertex_properties={"heat": heat, "label": np.arange(8)},
        face_properties={"thickness": thick, "pair": np.arange(24.0).reshape(12, 2)},
    )
    again = fh.load(tmp_path / "a.ply").objects[0].shape
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.triangles, mesh.triangles)
    np.testing.assert_array_equal(again.colors, mesh.colors)
    np.testing.assert_array_equal(again.vertex_properties["heat"], heat)
    np.testing.assert_array_equal(again.face_properties["thickness"], thick)
    assert {*thick.round(9)} == {1, 2, 3}
    hits = fh.load(tmp_path / "a.ply").shoot((0.1, 0.2, 5), (0, 0, -1))
    assert float(hits["thickness"]) == pytest.approx(1)
    read = trimesh.load(tmp_path / "a.ply", process=False)
    np.testing.assert_array_equal(read.faces, mesh.triangles)
    data = read.metadata["_ply_raw"]["face"]["data"]
    np.testing.assert_array_equal(data["thickness"], thick)
    # Its own numbers go along, also those of polygons.
    again.save(tmp_path / "b.ply", vertex_properties={"heat": heat + 1})
    third = fh.load(tmp_path / "b.ply").objects[0].shape
    assert third.vertex_properties["heat"].tolist() == (heat + 1).tolist()
    assert {*third.face_properties} == {"thickness", "pair_0", "pair_1"}
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]]
    quads = fh.Mesh(corners, [[0, 1, 2, 3], [1, 4, 5, 2]])
    quads.save(tmp_path / "c.ply", face_properties={"area": [1.5, 2.5]})
    read = fh.load(tmp_path / "c.ply").objects[0].shape
    assert read.face_properties["area"].tolist() == [1.5, 1.5, 2.5, 2.5]


@pytest.mark.parametrize(
    ("name", "how", "message"),
    [
        ("a.obj", {}, "path must end in .ply"),
        ("a.ply", {"vertex_properties": {"heat": [1, 2]}}, "heat must be of 3 vertices, got 2"),
        ("a.ply", {"face_properties": {"heat": []}}, "heat must be of 1 faces, got 0"),
        ("a.ply", {"vertex_properties": {"x": [1, 2, 3]}}, "would be called 'x'"),
    ],
)
def test_meshes_that_a_ply_cannot_hold_are_refused(name, how, message, tmp_path):
    mesh = fh.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    with pytest.raises(ValueError, match=message):
        mesh.save(tmp_path / name, **how)
    assert not list(tmp_path.iterdir())


def test_colours_of_corners_are_left_out_of_a_ply_with_a_warning(tmp_path):
    mesh = fh.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], colors=np.ones((1, 3, 3)))
    with pytest.warns(fh.FirsthitWarning, match="colors of corners are left out"):
        mesh.save(tmp_path / "a.ply")
    assert b"red" not in (tmp_path / "a.ply").read_bytes()
