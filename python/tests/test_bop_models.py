"""BOP's models, what is known of them, and the camera."""

import json

import firsthit as fh
import numpy as np
import pytest
from firsthit.annotations import save_bop, save_bop_models
from firsthit.annotations._bop_models import diameter

trimesh = pytest.importorskip("trimesh")

CAMERA = fh.Camera.look_at((0.1, -0.8, 0.5), (0, 0, 0), (0, 0, 1), 40, rows=60, columns=80)


def scene():
    """A part in millimetres and a box, in a scene in metres."""
    made = fh.Scene()
    part = trimesh.creation.cylinder(40, 120, sections=24)
    part.visual.vertex_colors = [255, 0, 188, 255]
    place = trimesh.transformations.rotation_matrix(0.5, (1, 2, 3), (0, 0, 0))
    place[:3, :3] *= 0.001
    place[:3, 3] = 0.05, 0, 0.02
    made.add(part, name="part", transform=place)
    made.add(fh.Box((-0.2, -0.1, -0.1), (-0.1, 0.1, 0.1)), name="box")
    return made


def test_models_and_their_info_are_in_millimetres_in_the_frame_of_the_poses(tmp_path):
    save_bop_models(tmp_path, scene(), unit="m", camera=CAMERA, depth_scale=0.1)
    info = json.loads((tmp_path / "models" / "models_info.json").read_text())
    assert info.keys() == {"1", "2"}
    part = trimesh.load(tmp_path / "models" / "obj_000001.ply", process=False)
    np.testing.assert_allclose(part.extents, [80, 80, 120], rtol=1e-9)
    assert part.is_watertight
    assert part.visual.vertex_colors[0].tolist()[:3] == [255, 0, 188]
    about = info["1"]
    assert about["diameter"] == pytest.approx(np.hypot(80, 120))
    assert [about[f"min_{axis}"] for axis in "xyz"] == pytest.approx([-40, -40, -60])
    assert [about[f"size_{axis}"] for axis in "xyz"] == pytest.approx([80, 80, 120])
    box = trimesh.load(tmp_path / "models" / "obj_000002.ply", process=False)
    assert box.volume == pytest.approx(100 * 200 * 200)
    assert info["2"]["diameter"] == pytest.approx(300)
    # The normals of corners are unit vectors outwards.
    normals = fh.load(tmp_path / "models" / "obj_000002.ply").objects[0].shape.normals
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-6)
    assert ((normals * (box.vertices - box.centroid)).sum(axis=1) > 0).all()
    camera = json.loads((tmp_path / "camera.json").read_text())
    matrix = CAMERA.intrinsic_matrix
    assert camera == {
        "cx": matrix[0, 2] - 0.5,
        "cy": matrix[1, 2] - 0.5,
        "fx": matrix[0, 0],
        "fy": matrix[1, 1],
        "width": 80,
        "height": 60,
        "depth_scale": 0.1,
    }


def test_models_at_their_poses_are_what_the_camera_sees(tmp_path):
    made = scene()
    save_bop_models(tmp_path, made, unit="m")
    save_bop(tmp_path / "000000", fh.annotate(made, CAMERA), unit="m")
    truth = json.loads((tmp_path / "000000" / "scene_gt.json").read_text())["0"]
    said = json.loads((tmp_path / "000000" / "scene_camera.json").read_text())["0"]
    again = fh.Scene()
    for one in truth:
        pose = np.eye(4)
        pose[:3, :3] = np.reshape(one["cam_R_m2c"], (3, 3))
        pose[:3, 3] = one["cam_t_m2c"]
        model = fh.load(tmp_path / "models" / f"obj_{one['obj_id']:06d}.ply").objects[0].shape
        again.add(model, transform=pose)
    camera = fh.Camera.from_opencv(
        np.reshape(said["cam_K"], (3, 3)), rvec=(0, 0, 0), columns=80, rows=60
    )
    z, seen = made.shoot(CAMERA).z, again.shoot(camera).z
    hit = np.isfinite(z) & np.isfinite(seen)
    assert (np.isfinite(z) == np.isfinite(seen)).mean() > 0.995
    np.testing.assert_allclose(seen[hit], 1000 * z[hit], rtol=1e-3)


@pytest.mark.parametrize("count", [2, 100, 2000, 5000])
def test_a_diameter_is_that_of_all_pairs(count):
    rng = np.random.default_rng(count)
    ball = rng.normal(size=(count, 3))
    shell = ball / np.linalg.norm(ball, axis=1, keepdims=True)
    for points in (ball * (1, 2, 0.5), shell, 1e5 + shell, np.round(ball, 1)):
        rows = [np.linalg.norm(points - point, axis=1).max() for point in points]
        assert diameter(points) == pytest.approx(max(rows), rel=1e-12)


def test_round_shapes_have_models_whose_corners_are_on_them(tmp_path):
    made = fh.Scene()
    shapes = {
        "ball": fh.Sphere((1, 2, 3), 0.5),
        "tube": fh.Cylinder((0, 0, 0), (1, 2, 3), 0.3),
        "hat": fh.Cone((0, 0, 0), (0, 1, 0), 0.5),
        "pot": fh.Cone((0, 0, 1), (0, 0, 2), 0.5, 0.25),
        "coin": fh.Disc((0, 0, 0), (1, 1, 0), 0.5),
        "floor": fh.Plane((0, 0, 0), (0, 0, 1)),
    }
    for name, shape in shapes.items():
        made.add(shape, name=name)
    with pytest.warns(fh.FirsthitWarning, match="the model of 'floor' is left out: a Plane has no"):
        save_bop_models(tmp_path, made, unit="mm")
    volumes = np.pi * np.array([1 / 6, 0.09 * 14**0.5, 0.25 / 3, 0.4375 / 3])
    for k, (name, shape) in enumerate([*shapes.items()][:5]):
        mesh = trimesh.load(tmp_path / "models" / f"obj_{k + 1:06d}.ply", process=False)
        alone = fh.Scene()
        alone.add(shape)
        caps = alone.closest_point(mesh.vertices).distance
        assert caps.max() < 1e-9, name
        if name != "coin":
            assert mesh.is_watertight
            assert mesh.volume == pytest.approx(volumes[k], rel=0.01)
    info = json.loads((tmp_path / "models" / "models_info.json").read_text())
    assert info["1"]["diameter"] == pytest.approx(1)
    assert info["1"]["min_x"] == pytest.approx(0.5)
    assert "6" not in info


def test_objects_of_one_node_are_one_model(tmp_path):
    made = fh.Scene()
    for x in (0, 2):
        place = np.eye(4)
        place[0, 3] = x
        made.add(fh.Box((0, 0, 0), (1, 1, 1)), name="twin", transform=place)
    save_bop_models(tmp_path, made, unit="mm", by=lambda made: made.name)
    info = json.loads((tmp_path / "models" / "models_info.json").read_text())
    assert info["1"]["size_x"] == 3


@pytest.mark.parametrize(
    ("how", "error", "message"),
    [
        (
            {"object_ids": {"part": 1}},
            ValueError,
            "object_ids must have all classes, not only part",
        ),
        ({"camera": CAMERA.shape}, TypeError, "camera must be a Camera"),
        ({"unit": "feet"}, ValueError, "unit must be metres"),
    ],
)
def test_models_that_make_no_sense_are_refused(how, error, message, tmp_path):
    with pytest.raises(error, match=message):
        save_bop_models(tmp_path, scene(), **{"unit": "m", **how})
    with pytest.raises(TypeError, match="scene must be a Scene"):
        save_bop_models(tmp_path, [3], unit="m")
    flat = fh.Scene()
    flat.add(fh.Box((0, 0, 0), (1, 1, 1)), name="box", transform=np.diag([1, 1, 2, 1]))
    with pytest.raises(ValueError, match="its transform scales by"):
        save_bop_models(tmp_path, flat, unit="m")
    assert not list(tmp_path.iterdir())
