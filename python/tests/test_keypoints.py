"""Keypoints: where they are, and whether a camera sees them."""

import math

import firsthit as fh
import numpy as np
import pytest
from firsthit._sensors.project import project
from firsthit.annotations import Keypoints
from support import turned
from test_annotations import COLUMNS, PROJECTIONS, ROWS, crowd, seen_by

RNG = np.random.default_rng(14)


def test_keypoints_on_a_surface_are_seen_where_no_ray_meets_anything_before_them():
    scene, camera = crowd(), seen_by(position=(0, 0, 9))
    mesh = scene.objects[0].shape
    names = [f"v{k}" for k in range(len(mesh.vertices))]
    points = dict(zip(names, mesh.vertices, strict=True))
    found = fh.annotate(
        scene,
        camera,
        classes=lambda made: "mesh" if made.shape is mesh else None,
        keypoints={"mesh": points},
        unseen=True,
    )
    assert len(found.instances) == 4
    states = []
    for one in found.instances:
        for point, vertex in zip(one.keypoints, mesh.vertices, strict=True):
            place = one.box3d.world_from_object
            np.testing.assert_allclose(point.position, place[:3, :3] @ vertex + place[:3, 3])
            at = np.array(point.position)
            np.testing.assert_allclose(point.pixel, project(camera, at))
            assert point.z == pytest.approx((at - camera.position) @ camera.aim)
            u, v = point.pixel
            if not (0 <= u < COLUMNS and 0 <= v < ROWS):
                assert point.visibility == 0
                continue
            # An independent way: what is met a little before the point?
            way = at - camera.position
            first = float(scene.shoot(camera.position, way).t)
            assert abs(first - 1) > 1e-9 or abs(first - 1) < 1e-13
            assert point.visibility == (2 if first > 1 - 1e-9 else 1)
            states.append(point.visibility)
    assert states.count(1) > 30
    assert states.count(2) > 30


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_the_surface_of_a_keypoint_does_not_hide_it_and_the_far_side_does(projection):
    camera = seen_by(projection, position=(0, 0, 5))
    scene = fh.Scene()
    ball = scene.add(fh.Sphere((0, 0, 0), 1), transform=turned((1, 2, 3), 1, scale=0.5))
    unit = RNG.normal(size=(300, 3))
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    points = Keypoints({str(k): point for k, point in enumerate(unit)})
    (one,) = fh.annotate(scene, camera, keypoints={ball: points}).instances
    at = np.array([point.position for point in one.keypoints])
    towards = -camera.aim if projection == "orthographic" else camera.position - at
    facing = (towards * at).sum(axis=1)
    assert (np.abs(facing) > 1e-6).all()
    states = np.array([point.visibility for point in one.keypoints])
    np.testing.assert_array_equal(states, np.where(facing > 0, 2, 1))


def test_keypoints_before_the_viewplane_or_beyond_the_border_or_nan_are_not_labelled():
    scene = fh.Scene()
    scene.add(fh.Box((-0.1, -0.1, -1), (0.1, 0.1, 4.9)), name="beam")
    points = {
        "near": (0, 0, 4.6),
        "tip": (0, 0, 4),
        "aside": (9, 0, 0),
        "behind": (0, 0, 6),
        "unknown": (np.nan, 0, 0),
    }
    inner = Keypoints(points, tolerance=math.inf)
    states = {}
    for ray_start in ("eye", "viewplane"):
        camera = seen_by(ray_start=ray_start, position=(0, 0, 5))
        (beam,) = fh.annotate(scene, camera, keypoints={"beam": inner}).instances
        states[ray_start] = [point.visibility for point in beam.keypoints]
    assert states == {"eye": [2, 2, 0, 0, 0], "viewplane": [0, 2, 0, 0, 0]}


def test_a_tolerance_is_for_rounded_points_and_what_is_inside():
    camera = fh.Camera((0, 0, 5), (0, 0, -1), (0, 1, 0), 1, 1, 1, 50, 50, ray_start="eye")
    scene = fh.Scene()
    ball = scene.add(fh.Sphere((0, 0, 0), 1), name="ball")
    names = {"front": (0, 0, 1), "rounded": (0, 0, 0.9999), "middle": (0, 0, 0), "back": (0, 0, -1)}

    def states(**words):
        (one,) = fh.annotate(scene, camera, classes={"ball": "ball"}, **words).instances
        return [point.visibility for point in one.keypoints]

    for tolerance, expected in [(0, [2, 1, 1, 1]), (1e-3, [2, 2, 1, 1]), (math.inf, [2, 2, 2, 2])]:
        given = Keypoints(names, tolerance=tolerance)
        assert states(keypoints={ball: given}) == expected
    # The world's frame stays where it is.
    scene.move(ball, turned((0, 0, 1), 1, (0.2, 0, 0)))
    for frame, x in (("object", 0.2), ("world", 0)):
        given = {ball: Keypoints({"a": (0, 0, 0.5)}, frame=frame)}
        (one,) = fh.annotate(scene, camera, keypoints=given).instances
        assert one.keypoints[0].position == pytest.approx((x, 0, 0.5))
    scene.move(ball, None)
    scene.add(fh.Box((-2, -2, 2), (2, 0.001, 2.5)), name="wall")
    assert states(keypoints={ball: Keypoints(names, tolerance=math.inf)}) == [1, 1, 1, 1]
    # As if the wall were not there.
    given = {"ball": Keypoints(names, frame="world", tolerance=1e-3)}
    assert states(keypoints=given, objects="ball") == [2, 2, 1, 1]


def test_wrong_keypoints_are_refused_by_name():
    for words, error, match in [
        ({"points": [1]}, TypeError, "points must be a dict"),
        ({"points": {"a": (1, 2)}}, ValueError, "keypoint 'a' must be three numbers"),
        ({"points": {}, "frame": "camera"}, ValueError, "frame must be one of object, world"),
        ({"points": {"a": (0, 0, 0)}, "skeleton": [("a", "b")]}, ValueError, "got 'b'"),
        ({"points": {}, "tolerance": -1}, ValueError, "tolerance must be zero or more"),
    ]:
        with pytest.raises(error, match=match):
            Keypoints(**words)
