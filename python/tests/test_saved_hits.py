"""Files of hits and frames, and refusals before anything is written."""

import json
import pickle

import firsthit as fh
import numpy as np
import pytest
from support import ball

CAMERA = fh.Camera.look_at((0.2, 0, 5), (0, 0, 0), (0, 1, 0), 30, rows=6, columns=8)
RAYS = ([[0, 0, 5], [0, 3, 5]], [0, 0, -1])


def names_in(path):
    return [channel["name"] for channel in fh.read_metadata(path)["channels"]]


@pytest.mark.parametrize("channels", [["position"], ["position", "color"], ["position", "t"]])
@pytest.mark.parametrize("name", ["a.ply", "a.pcd", "A.PLY"])
def test_a_point_cloud_is_no_picture_whatever_it_holds(channels, name, tmp_path):
    fh.render(ball(), CAMERA, channels=channels, samples=1).save(tmp_path / name)
    with pytest.raises(ValueError, match="must hold a picture, got a point cloud, which is a list"):
        fh.Frame.load(tmp_path / name)
    assert sorted(names_in(tmp_path / name)) == sorted(channels)


@pytest.mark.parametrize("name", ["h.png", "h.npy"])
def test_a_file_of_one_channel_holds_t(name, tmp_path):
    hits = ball().shoot(CAMERA)
    hits.save(tmp_path / name)
    assert names_in(tmp_path / name) == ["t"]
    if name == "h.npy":
        np.testing.assert_array_equal(np.load(tmp_path / name), hits.t)


def test_each_channel_of_hits_has_a_file_of_its_own(tmp_path):
    hits = ball().shoot(CAMERA)
    hits.save(tmp_path / "{channel}.npy")
    hits.save(tmp_path / "all-{channel}.npz", ["normal", "z", "normal"])
    files = {path.name for path in tmp_path.iterdir() if path.suffix != ".json"}
    assert files == {"t.npy", "object.npy", "primitive.npy", "all-normal.npz", "all-z.npz"}
    np.testing.assert_array_equal(np.load(tmp_path / "object.npy"), hits.object)
    np.testing.assert_array_equal(np.load(tmp_path / "all-z.npz")["z"], hits.z)


def test_a_name_counts_once(tmp_path):
    hits = ball().shoot(*RAYS)
    hits.save(tmp_path / "a.npz", ["t", "normal", "t"])
    assert names_in(tmp_path / "a.npz") == ["t", "normal"]
    hits.save(tmp_path / "a.npy", ["t", "t"])
    np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), hits.t)


@pytest.mark.parametrize(
    ("save", "words"),
    [
        (lambda path: ball().shoot(*RAYS).save(path / "a.npz", []), "one or more of t, object"),
        (lambda path: ball().shoot(*RAYS).save(path / "a.ply", []), "one or more of t, object"),
        (lambda path: ball().shoot(*RAYS).save(path / "a.npz", ["z"]), "among .*, got 'z'"),
        (lambda path: ball().shoot(*RAYS).save(path / "a.npz", "range"), "among .*, got 'range'"),
        (lambda path: ball().shoot(*RAYS).save(path / "{channel}.ply"), "a point cloud holds all"),
        (
            lambda path: fh.render(ball(), CAMERA, channels=["position", "t"]).save(
                path / "x-{channel}.ply"
            ),
            "a point cloud holds all channels",
        ),
        (lambda path: fh.render(ball(), CAMERA, channels=[]), "one or more of color, t"),
    ],
)
def test_what_is_wrong_is_refused_before_anything_is_written(save, words, tmp_path):
    with pytest.raises(ValueError, match=words):
        save(tmp_path)
    assert not list(tmp_path.iterdir())


def test_hits_and_pictures_of_some_objects_name_the_scene_in_which_the_others_are_hidden(tmp_path):
    def scene_of(path):
        return fh.read_metadata(path)["scene"]

    scene = ball()
    scene.add(fh.Box((-3, -3, -3), (3, 3, -2)), name="floor", mask=2)
    scene.shoot(CAMERA).save(tmp_path / "all.npz")
    told = []
    for some in (
        scene.shoot(CAMERA, objects="ball"),
        scene.shoot(CAMERA, mask=4),
        scene.shoot(*RAYS, mask=4)[:1],
        scene.shoot_all(*RAYS, objects=0).hits,
        fh.render(scene, CAMERA, channels="t", objects=0),
    ):
        some.save(tmp_path / "some.npz")
        told.append(scene_of(tmp_path / "some.npz"))
    # A mask of each ray is no part of the scene.
    scene.shoot(*RAYS, mask=[1, 2]).save(tmp_path / "each.npz")
    assert scene_of(tmp_path / "each.npz") == scene_of(tmp_path / "all.npz") != told[0]
    again = pickle.loads(pickle.dumps(scene.shoot(CAMERA, objects="ball")))
    again.save(tmp_path / "again.npz")
    scene.hide("floor")
    scene.shoot(CAMERA).save(tmp_path / "hidden.npz")
    assert {*told} == {scene_of(tmp_path / "again.npz"), scene_of(tmp_path / "hidden.npz")}


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "x-{channel}.npy",
            "'attribute:a b' and 'attribute:a_b' would both be written to .*a_b.npy",
        ),
        ("x.npz", "name the frame does not have yet, got attribute:a_b"),
        ("x.exr", "name the frame does not have yet, got attribute:a_b"),
        ("x.ply", "name the frame does not have yet, got attribute:a_b"),
    ],
)
def test_two_channels_that_a_file_calls_alike_are_refused(name, words, tmp_path):
    scene = fh.Scene()
    corners = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]
    named = {"a b": [1, 2, 3.5], "a_b": [4, 5, 6.5]}
    scene.add(fh.Mesh(corners, [[0, 1, 2]], vertex_properties=named))
    hits = scene.shoot(CAMERA)
    with pytest.raises(ValueError, match=words):
        hits.save(tmp_path / name, ["attribute:a b", "attribute:a_b"])
    assert not list(tmp_path.iterdir())


def test_a_part_of_a_camera_s_hits_does_not_have_its_matrix(tmp_path):
    hits = ball().shoot(CAMERA)
    hits.save(tmp_path / "whole.npz")
    assert fh.read_metadata(tmp_path / "whole.npz")["camera"]["rows"] == 6
    for part in (hits[::2], hits[::-1], hits[hits.object >= 0]):
        part.save(tmp_path / "part.npz", ["t", "range", "z", "normal"])
        assert fh.read_metadata(tmp_path / "part.npz")["camera"] is None
        np.testing.assert_array_equal(np.load(tmp_path / "part.npz")["z"], part.z)
    # Points need no grid.
    hits[::2].save(tmp_path / "part.ply")
    assert fh.read_metadata(tmp_path / "part.ply")["camera"]["rows"] == 6


def test_hits_are_saved_as_steps_and_labels_too(tmp_path):
    hits = ball().shoot(CAMERA)
    hits.save(tmp_path / "t.png", "t", png_scale=0.001)
    np.testing.assert_allclose(fh.Frame.load(tmp_path / "t.png")["t"], hits.t, atol=0.0005001)
    hits.save(tmp_path / "object.png", "object", png_labels=True)
    np.testing.assert_array_equal(fh.Frame.load(tmp_path / "object.png")["object"], hits.object)
    hits.save(tmp_path / "far.png", "t", png_scale=1e-5, far="zero")
    assert np.isinf(fh.Frame.load(tmp_path / "far.png")["t"]).all()
    hits.save(tmp_path / "all.npz", compress=True)
    with np.load(tmp_path / "all.npz") as arrays:
        np.testing.assert_array_equal(arrays["t"], hits.t)


def test_few_hits_among_thousands_of_names_are_a_small_file(tmp_path):
    scene = fh.Scene()
    for k in range(3000):
        scene.add(fh.Box((3 * k, 0, 0), (3 * k + 1, 1, 1)), name=f"Gebäude {k:05d}/Wand")
    hits = scene.shoot([[0.5, 0.5, 9], [3.5, 0.5, 9]], (0, 0, -1))
    hits.save(tmp_path / "few.npz")
    assert (tmp_path / "few.npz").stat().st_size < 100_000
    said = json.loads(str(np.load(tmp_path / "few.npz")["metadata"]))
    assert said == fh.read_metadata(tmp_path / "few.npz")
    assert said["names"]["object"][2999]["name"] == "Gebäude 02999/Wand"
