"""Point clouds, read with NumPy and with trimesh."""

import json
import warnings
from pathlib import Path

import firsthit as fh
import numpy as np
import pytest
from support import ball

trimesh = pytest.importorskip("trimesh")

TYPES = {"double": "<f8", "float": "<f4", "int": "<i4", "uchar": "u1"}


@pytest.fixture
def scene():
    scene = ball()
    scene.add(fh.Box((2, -1, -1), (4, 1, 1)), color=(0.2, 0.5, 0.8))
    return scene


@pytest.fixture
def camera():
    return fh.Camera.look_at((2, -12, 1), (1, 0, 0), (0, 0, 1), 40, 30, 50)


def ply(path):
    """The points of a PLY as a structured array: a reader that knows nothing of the writer."""
    header, data = path.read_bytes().split(b"end_header\n", 1)
    words = [line.split() for line in header.decode().splitlines()]
    dtype = [(line[2], TYPES[line[1]]) for line in words if line[0] == "property"]
    points = np.frombuffer(data, dtype)
    assert ["element", "vertex", str(len(points))] in words
    return points


def test_a_picture_s_cloud_holds_its_numbers(scene, camera, tmp_path):
    channels = ["position", "normal", "color", "object", "z"]
    frame = fh.render(scene, camera, channels=channels, samples=1)
    frame.save(tmp_path / "a.ply")
    points = ply(tmp_path / "a.ply")
    hit = frame["object"] >= 0
    assert 0 < hit.sum() < hit.size
    for k, axis in enumerate("xyz"):
        np.testing.assert_array_equal(points[axis], frame["position"][hit][:, k])
        np.testing.assert_array_equal(points[f"n{axis}"], frame["normal"][hit][:, k])
    np.testing.assert_array_equal(points["object"], frame["object"][hit])
    np.testing.assert_array_equal(points["depth"], frame["z"][hit])
    linear = frame["color"][hit]
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    colors = np.stack([points[name] for name in ("red", "green", "blue")], 1)
    np.testing.assert_array_equal(colors, np.floor(255 * srgb.clip(0, 1) + 0.5).astype(np.uint8))


def test_others_read_it(scene, camera, tmp_path):
    channels = ["position", "normal", "color", "object"]
    frame = fh.render(scene, camera, channels=channels)
    frame.save(tmp_path / "a.ply")
    cloud = trimesh.load(tmp_path / "a.ply")
    hit = frame["object"] >= 0
    np.testing.assert_array_equal(cloud.vertices, frame["position"][hit])
    assert len(cloud.colors) == hit.sum()


@pytest.mark.parametrize("name", ["a.ply", "a.pcd"])
def test_it_says_where_it_comes_from(scene, camera, tmp_path, name):
    frame = fh.render(scene, camera, channels=["position", "object", "t"])
    frame.save(tmp_path / name)
    said = fh.read_metadata(tmp_path / name)
    assert said["shape"] == [(frame["object"] >= 0).sum()]
    assert said["camera"] == frame.metadata["camera"]
    # A frame is a picture.
    with pytest.raises(ValueError, match="must hold a picture"):
        fh.Frame.load(tmp_path / name)


def test_hits_are_saved_too(scene, tmp_path):
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(20, 30, 3))
    hits = scene.shoot((1.5, 0, 0), directions)
    hit = hits.object >= 0
    assert 0 < hit.sum() < hit.size
    hits.save(tmp_path / "a.ply")
    points = ply(tmp_path / "a.ply")
    assert points.dtype.names == (
        *("x", "y", "z", "nx", "ny", "nz"),
        *("t", "object", "primitive"),
    )
    np.testing.assert_array_equal(points["x"], hits.position[hit][:, 0])
    np.testing.assert_array_equal(points["t"], hits.t[hit])
    hits.save(tmp_path / "b.ply", "object")
    assert ply(tmp_path / "b.ply").dtype.names == ("x", "y", "z", "object")
    hits.save(tmp_path / "all.npz")
    table = np.load(tmp_path / "all.npz")
    np.testing.assert_array_equal(table["t"], hits.t)
    assert table["object"].shape == (20, 30)
    said = json.loads(str(table["metadata"]))
    assert said["scene"].startswith("blake3:")
    assert said["camera"] is None


def test_a_camera_s_hits_say_which_camera(scene, camera, tmp_path):
    scene.shoot(camera).save(tmp_path / "a.ply", ["object", "range"])
    said = fh.read_metadata(tmp_path / "a.ply")
    assert said["camera"]["position"] == [2, -12, 1]
    assert [channel["name"] for channel in said["channels"]] == ["position", "object", "range"]


def test_what_is_wrong_is_said(scene, camera, tmp_path):
    frame = fh.render(scene, camera, channels=["color", "object"])
    with pytest.raises(ValueError, match="position, and any others, for a point cloud"):
        frame.save(tmp_path / "a.ply")
    hits = scene.shoot([0, 0, 9], [0, 0, -1])
    with pytest.raises(ValueError, match="holds; name it, or choose"):
        hits.save(tmp_path / "a.npy", ["t", "object"])
    with pytest.raises(ValueError, match="known:"):
        hits.save(tmp_path / "a.xyz")
    with pytest.raises(ValueError, match="channel"):
        hits.save(tmp_path / "a.ply", ["color"])
    assert not list(tmp_path.iterdir())


def test_positions_of_a_country_are_not_rounded_without_a_word(tmp_path: Path) -> None:
    scene = fh.Scene()
    scene.add(fh.Sphere(center=(500000.3, 4500000.2, 10), radius=3))
    camera = fh.Camera.look_at(
        (500000.3, 4500000.2, 20), (500000.3, 4500000.2, 10), (0, 1, 0), 45, rows=8, columns=8
    )
    frame = fh.render(scene, camera, channels="position")
    with pytest.warns(fh.FirsthitWarning, match=r"a.exr: position as float32 is off by up to 0\.2"):
        frame.save(tmp_path / "a.exr")
    hits = scene.shoot(camera)
    scan = fh.Lidar.named("vlp-16", columns=36, position=(500000.3, 4499990.2, 10)).scan(
        scene, max_range=90
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        frame.save(tmp_path / "a.pcd")
        hits.save(tmp_path / "b.pcd")
        scan.save(tmp_path / "c.pcd")
    found = frame.to_points()["position"]
    for name, expected in (("a", found), ("b", found), ("c", scan.point)):
        positions, _ = fh.read_points(tmp_path / f"{name}.pcd")
        assert len(positions) > 0
        np.testing.assert_array_equal(positions, expected)
