"""Annotations of cameras that move while they see: brute force, and every line tried."""

import json
import math

import firsthit as fh
import numpy as np
import pytest
from firsthit.annotations import Keypoints, save_bop, save_coco, save_kitti, save_yolo
from support import turned
from test_annotations import box_of, crowd
from test_moving_flow import (
    COLUMNS,
    DIRECTIONS,
    ROWS,
    cameras,
    rolling,
    shaken,
    swept,
    view,
)


def lenses():
    """Rolling shutters with other lenses, and with a fast body."""
    drive, at = shaken(3), {"position": (0, 0, 0), "aim": (0, 0, -1), "up": (0, 1, 0)}
    fisheye = fh.Camera.fisheye(*at.values(), 180, ROWS, COLUMNS)
    parallel = fh.Camera(
        *at.values(), 1, 8, 6, ROWS, COLUMNS, projection="orthographic", ray_start="eye"
    )
    inner = fh.Camera(*at.values(), 2, 4, 3, ROWS, COLUMNS, parameters={"tilt_x": 9})
    return {
        "fisheye": rolling(drive, camera=fisheye),
        "orthographic": rolling(drive, "right_left", camera=parallel),
        "tilted viewplane": rolling(drive, "bottom_up", camera=inner),
        "fast": rolling(shaken(5, speed=7), "left_right"),
    }


ALL = cameras() | lenses()


@pytest.mark.parametrize("name", ALL)
def test_masks_are_those_of_each_object_in_a_scene_of_its_own(name):
    scene, camera = crowd(), ALL[name]
    found = fh.annotate(scene, camera, unseen=True)
    picture = scene.shoot(camera).object
    assert len(found.instances) == 25
    cut = 0
    for one, made in zip(found.instances, scene.objects, strict=True):
        alone = fh.Scene()
        alone.add(made.shape, transform=made.transform)
        amodal, visible = alone.shoot(camera).object == 0, picture == one.object
        np.testing.assert_array_equal(one.amodal.array, amodal)
        np.testing.assert_array_equal(one.visible.array, visible)
        assert one.amodal_box == box_of(amodal)
        assert one.visible_box == box_of(visible)
        assert (one.whole_pixels, one.whole_box) == (None, None)
        assert math.isnan(one.truncated)
        cut += 0 < amodal.sum() < amodal.size
    assert cut > 0
    np.testing.assert_array_equal(found.instance, picture)
    assert found.camera is camera
    assert found.shape == camera.shape


@pytest.mark.parametrize("name", ["top_down", "right_left", "pushbroom", "pushbroom backwards"])
def test_boxes_in_space_are_those_of_the_middle_line(name):
    scene, camera = crowd(), cameras()[name]
    times = camera.times
    stands = camera.camera.moved(camera.trajectory.at(times[len(times) // 2]))
    # To the right, down and forwards, where the camera's own axes are right, up and backwards.
    to_camera = np.diag([1, -1, -1, 1]) @ np.linalg.inv(stands.world_from_camera)
    compared = 0
    for one in fh.annotate(scene, camera, unseen=True).instances:
        if one.box3d is None:
            continue
        place = scene.objects[one.object].transform
        np.testing.assert_allclose(one.box3d.camera_from_object, to_camera @ place, atol=1e-12)
        still = fh.annotate(scene, stands, unseen=True).instances[one.id].box3d
        np.testing.assert_array_equal(one.box3d.in_world, still.in_world)
        np.testing.assert_array_equal(one.box3d.in_object, still.in_object)
        compared += 1
    assert compared == 24


@pytest.mark.parametrize("name", [*DIRECTIONS, "pushbroom"])
def test_keypoints_are_where_the_line_that_sees_them_has_them(name):
    rng = np.random.default_rng(3)
    scene, camera = fh.Scene(), cameras()[name]
    place = turned((1, 2, 3), 1, (0.3, 0.2, 1), scale=0.9)
    ball = scene.add(fh.Sphere((0, 0, 0), 1), transform=place)
    scene.add(fh.Box((0.4, -0.5, 2.4), (0.8, 0.5, 2.5)), name="before it")
    unit = rng.normal(size=(80, 3))
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    points = Keypoints({str(k): point for k, point in enumerate(unit)})
    one = fh.annotate(scene, camera, keypoints={ball: points}).instances[0]
    is_pushbroom = isinstance(camera, fh.Pushbroom)
    axis = 0 if name in ("left_right", "right_left") else 1
    lines = len(camera.times)
    is_backwards = name in ("bottom_up", "right_left")
    states = []
    for point in one.keypoints:
        at, pixel = np.array(point.position), np.array(point.pixel)
        if np.isnan(pixel).any():
            assert (point.visibility, math.isnan(point.z)) == (0, True)
            continue
        number = lines - pixel[axis] if is_backwards else pixel[axis]
        time = np.interp(number, np.arange(lines) + 0.5, np.sort(camera.times))
        stands = camera.camera.moved(camera.trajectory.at(time))
        expected = [pixel[0], 0.5] if is_pushbroom else pixel
        np.testing.assert_allclose(stands.project(at), expected, atol=1e-6)
        assert point.z == pytest.approx((at - stands.position) @ stands.aim, abs=1e-8)
        if not ((pixel >= 0).all() and (pixel < (camera.columns, camera.rows)).all()):
            assert point.visibility == 0
            continue
        first = float(scene.shoot(stands.position, at - stands.position).t)
        assert point.visibility == (2 if first > 1 - 1e-9 else 1)
        states.append(point.visibility)
    assert states.count(1) > 10
    assert states.count(2) > 10


def test_a_keypoint_that_no_line_sees_is_not_labelled():
    flight = fh.Trajectory([0, 1], [(0, 0, 5), (0, 1, 5)])
    scene = fh.Scene()
    ball = scene.add(fh.Sphere((0, 0.5, 0), 1))
    points = {"under": (0, 0.25, 1), "never": (0, 2, 0)}
    camera = swept(flight, np.linspace(0, 1, 50))
    (one,) = fh.annotate(scene, camera, keypoints={ball: points}).instances
    under, never = one.keypoints
    assert under.visibility == 2
    np.testing.assert_allclose(under.pixel, (COLUMNS / 2, 0.25 * 49 + 0.5), atol=1e-8)
    assert under.z == pytest.approx(4)
    assert never.visibility == 0
    assert np.isnan([*never.pixel, never.z]).all()


def test_a_frame_of_a_moving_camera_is_taken_if_it_is_that_picture(tmp_path):
    scene, camera = crowd(), rolling(shaken(3))
    frame = fh.render(scene, camera, channels=("object", "z"))
    expected = fh.annotate(scene, camera)
    frame.save(tmp_path / "a.exr")
    for given in (frame, fh.Frame.load(tmp_path / "a.exr")):
        found = fh.annotate(scene, camera, frame=given)
        np.testing.assert_array_equal(found.instance, expected.instance)
    stands = camera.camera.moved(camera.trajectory.at(0.5))
    for other in (rolling(shaken(3), start=0.11), rolling(shaken(3), "bottom_up"), stands):
        with pytest.raises(ValueError, match=r"metadata name another (sensor|camera)"):
            fh.annotate(scene, other, frame=frame)
    with pytest.raises(ValueError, match=r"metadata name another (sensor|camera)"):
        fh.annotate(scene, camera, frame=fh.render(scene, stands, channels="object"))


def test_coco_and_yolo_hold_moving_pictures_and_bop_and_kitti_refuse_them(tmp_path):
    scene, camera = crowd(), rolling(shaken(3))
    found = fh.annotate(scene, camera, classes={"ground": None, "*": "thing"})
    save_coco(tmp_path / "coco.json", {"a.png": found})
    held = json.loads((tmp_path / "coco.json").read_text())
    assert len(held["annotations"]) == len(found.instances) > 5
    for entry, one in zip(held["annotations"], found.instances, strict=True):
        assert tuple(entry["bbox"]) == one.visible_box
        assert entry["truncated"] is None
    save_yolo(tmp_path / "yolo", {"a.png": found})
    lines = (tmp_path / "yolo" / "labels" / "train" / "a.txt").read_text().splitlines()
    assert len(lines) == len(found.instances)
    match = "000000.png: {} has one pose for a picture, and a RollingShutter many"
    with pytest.raises(ValueError, match=match.format("BOP")):
        save_bop(tmp_path / "bop", {"000000.png": found}, unit="m")
    with pytest.raises(ValueError, match=match.format("KITTI")):
        save_kitti(tmp_path / "kitti", {"000000.png": found}, unit="m")
    assert not (tmp_path / "bop").exists()
    assert not (tmp_path / "kitti").exists()


def test_sensors_without_a_lens_are_refused():
    scene = crowd()
    for sensor in (fh.Lidar.named("vlp-16"), fh.RaySensor((0, 0, 0), (0, 0, 1), shape=(1, 1)), 3):
        with pytest.raises(TypeError, match="annotate takes a Scene, and a Camera, a Rolling"):
            fh.annotate(scene, sensor)
    with pytest.raises(TypeError, match="annotate takes a Scene"):
        fh.annotate(3, view())
