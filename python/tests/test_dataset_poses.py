"""Poses of data sets: the numbers that they are made from, their distributions, and rigs."""

import math

import firsthit as fh
import numpy as np
import pytest
from dataset_support import PLANS, plan, record
from firsthit.datasets._sampling import Uniforms

MASK = 2**64 - 1


def philox(key, counter):
    """Philox 4x64-10 as Salmon and others (2011) write it; low words first."""
    x, k = list(counter), list(key)
    for _ in range(10):
        first, second = 0xD2E7470EE14C6C93 * x[0], 0xCA5A826395121157 * x[2]
        x = [
            (second >> 64) ^ x[1] ^ k[0],
            second & MASK,
            (first >> 64) ^ x[3] ^ k[1],
            first & MASK,
        ]
        k = [(k[0] + 0x9E3779B97F4A7C15) & MASK, (k[1] + 0xBB67AE8584CAA73B) & MASK]
    return x


@pytest.mark.parametrize(("seed", "frame", "stream"), [(0, 0, 0), (3, 12, 0), (2**63 - 1, 9, 5)])
def test_the_numbers_are_those_of_philox(seed, frame, stream):
    uniforms = Uniforms(seed, frame, stream)
    # The counter is raised before it is used.
    wanted = [word for k in (1, 2, 3) for word in philox((seed, frame), (k, 0, 0, stream))]
    assert [uniforms.raw() for _ in wanted] == wanted
    again = Uniforms(seed, frame, stream)
    assert [again.next() for _ in wanted] == [(word >> 11) / 2**53 for word in wanted]


def places(poses, count, scene=None):
    """The matrices of the rig in so many frames."""
    made = fh.Plan.from_dict(plan(lambda it: it.update(poses=poses | {"count": count})), PLANS)
    scene = fh.Scene() if scene is None else scene
    found = [made._poses.place(made._seed, frame, frame, scene) for frame in range(count)]
    return np.array([place.pose for place in found])


def is_mean(values, mean, variance):
    """Whether a mean is within five standard deviations of what it should be."""
    return abs(values.mean() - mean) < 5 * math.sqrt(variance / len(values))


COUNT = 20_000
AROUND = {"kind": "sphere", "seed": 11, "center": [1, 2, 3], "radius": [2, 5]}


def test_positions_are_uniform_on_the_sphere():
    offsets = places(AROUND, COUNT)[:, :3, 3] - (1, 2, 3)
    radii = np.linalg.norm(offsets, axis=1)
    directions = offsets / radii[:, None]
    for axis in range(3):
        # Of a coordinate of a uniform direction: mean 0, mean square 1/3, mean fourth power 1/5.
        x = directions[:, axis]
        assert is_mean(x, 0, 1 / 3)
        assert is_mean(x**2, 1 / 3, 1 / 5 - 1 / 9)
        assert is_mean(x * directions[:, axis - 1], 0, 1 / 15)
    # Radii are uniform, and have nothing to do with the direction.
    assert radii.min() >= 2 - 1e-12
    assert radii.max() <= 5 + 1e-12
    assert is_mean(radii, 3.5, 9 / 12)
    assert is_mean((radii - 3.5) * directions[:, 2], 0, 9 / 12 / 3)


def test_elevations_have_their_limits_and_the_areas_between_are_as_likely():
    # From 30 to 90 degrees: the sine is uniform from 1/2 to 1.
    offsets = places(AROUND | {"elevation": [30, 90], "azimuth": [0, 90]}, COUNT)[:, :3, 3]
    offsets -= (1, 2, 3)
    sines = offsets[:, 2] / np.linalg.norm(offsets, axis=1)
    assert sines.min() >= 0.5 - 1e-12
    assert is_mean(sines, 0.75, 0.25 / 12)
    azimuths = np.degrees(np.arctan2(offsets[:, 1], offsets[:, 0]))
    assert azimuths.min() >= -1e-9
    assert azimuths.max() <= 90 + 1e-9
    assert is_mean(azimuths, 45, 90**2 / 12)


def test_the_rig_looks_at_the_centre_with_its_left_level():
    poses = places(AROUND | {"up": [0, 1, 0]}, 200)
    turns, positions = poses[:, :3, :3], poses[:, :3, 3]
    aims = (1, 2, 3) - positions
    aims /= np.linalg.norm(aims, axis=1)[:, None]
    np.testing.assert_allclose(turns[:, :, 0], aims, atol=1e-14)
    np.testing.assert_allclose(turns[:, 1, 1], 0, atol=1e-14)  # left is level
    assert (turns[:, 1, 2] > 0).all()  # and up is up
    np.testing.assert_allclose(turns.transpose(0, 2, 1) @ turns, [np.eye(3)] * 200, atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(turns), 1, atol=1e-14)


def test_straight_down_is_no_exception():
    poses = places(AROUND | {"elevation": 90, "roll": 30}, 20)
    np.testing.assert_allclose(poses[:, :3, 0], [(0, 0, -1)] * 20, atol=1e-12)
    assert np.isfinite(poses).all()


def test_a_roll_turns_about_the_forwards():
    level, rolled = places(AROUND, 50), places(AROUND | {"roll": 90}, 50)
    np.testing.assert_allclose(rolled[:, :3, 0], level[:, :3, 0], atol=1e-15)
    np.testing.assert_allclose(rolled[:, :3, 1], level[:, :3, 2], atol=1e-15)


BOX = {"kind": "inside", "seed": 2, "low": [0, 0, 0], "high": [1, 2, 4]}


def test_places_inside_are_uniform_in_the_box_and_directions_on_the_sphere():
    poses = places(BOX | {"pitch": [-90, 90]}, COUNT)
    for axis, side in enumerate((1, 2, 4)):
        values = poses[:, axis, 3]
        assert values.min() >= 0
        assert values.max() <= side
        assert is_mean(values, side / 2, side**2 / 12)
        assert is_mean((values - side / 2) ** 2, side**2 / 12, side**4 / 180)
        assert is_mean(poses[:, axis, 0], 0, 1 / 3)
        assert is_mean(poses[:, axis, 0] ** 2, 1 / 3, 1 / 5 - 1 / 9)


def test_yaw_and_pitch_are_those_of_the_forwards():
    poses = places(BOX | {"yaw": 90, "pitch": 30}, 3)
    np.testing.assert_allclose(poses[0, :3, 0], (0, math.sqrt(0.75), 0.5), atol=1e-15)
    np.testing.assert_allclose(poses[0, :3, 1], (-1, 0, 0), atol=1e-15)
    np.testing.assert_allclose(poses[0, :3, 2], (0, -0.5, math.sqrt(0.75)), atol=1e-15)


def test_a_clearance_is_kept_and_what_is_too_narrow_is_an_error():
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 1))
    box = {"kind": "inside", "low": [-2, -2, -2], "high": [2, 2, 2], "clearance": 0.3}
    positions = places(box, 300, scene)[:, :3, 3]
    away = np.abs(np.linalg.norm(positions, axis=1) - 1)
    assert away.min() >= 0.3
    assert (np.linalg.norm(positions, axis=1) < 0.7).any()  # within the ball, far from its surface
    outside = places(box | {"outside_objects": True}, 300, scene)[:, :3, 3]
    assert (np.linalg.norm(outside, axis=1) >= 1.3).all()
    with pytest.raises(ValueError, match="none of 7 places has a clearance of 5"):
        places(box | {"clearance": 5, "tries": 7}, 1, scene)


def test_without_a_box_it_is_that_of_the_scene():
    scene = fh.Scene()
    scene.add(fh.Box((1, 2, 3), (2, 4, 7)))
    positions = places({"kind": "inside"}, 500, scene)[:, :3, 3]
    assert (positions >= (1, 2, 3)).all()
    assert (positions <= (2, 4, 7)).all()
    assert (positions.max(axis=0) > (1.9, 3.8, 6.6)).all()
    endless = fh.Scene()
    endless.add(fh.Plane((0, 0, 0), (0, 0, 1)))
    with pytest.raises(ValueError, match="no finite bounds"):
        places({"kind": "inside"}, 1, endless)


def test_a_frame_depends_on_its_number_and_on_no_other_frame():
    made = fh.Plan.from_dict(plan(), PLANS)
    place = made._poses.place
    alone = place(3, 5, 5, fh.Scene()).pose
    every = [place(3, frame, frame, fh.Scene()).pose for frame in range(7)]
    assert every[5] == alone
    assert len({str(pose) for pose in every}) == 7


def ball_ahead(sensors, poses, **output):
    """A plan with a ball of radius 1 at (6, 0, 0)."""
    return {
        "scenes": [{"file": "ball.fhs"}],
        "sensors": sensors,
        "poses": poses,
        "output": output,
    }


@pytest.fixture
def ball(tmp_path):
    scene = fh.Scene()
    scene.add(fh.Sphere((6, 0, 0), 1), name="ball")
    scene.save(tmp_path / "ball.fhs")
    return scene


TURNED = [[0, -1, 0, 6], [1, 0, 0, -10], [0, 0, 1, 0], [0, 0, 0, 1]]  # looks along y


def test_a_rig_carries_a_camera_and_a_lidar(tmp_path, ball):
    camera = {"kind": "camera", "columns": 5, "rows": 5, "fov": 20, "position": [1, 0, 0]}
    left = {"kind": "lidar", "pattern": "spinning", "elevations": [0], "columns": 4}
    left |= {"position": [3, 0, 0]}
    back = {"name": "back", "kind": "camera", "columns": 5, "rows": 5, "aim": [-1, 0, 0]}
    poses = {"kind": "list", "body": "forwards-left-up", "matrices": [np.eye(4).tolist(), TURNED]}
    asked = ball_ahead([camera, left, back], poses, channels=["range", "z"])
    fh.dataset(fh.Plan.from_dict(asked, tmp_path), tmp_path / "out")
    for frame, distance in ((0, 6), (1, 10)):
        folder = tmp_path / "out" / "frames" / f"{frame:06d}"
        picture, scan = fh.Frame.load(folder / "camera.npz"), np.load(folder / "lidar.npz")
        assert picture["range"][2, 2] == pytest.approx(distance - 1 - 1, abs=1e-12)
        # One of its four beams goes forwards.
        assert scan["range"].tolist() == [pytest.approx(distance - 3 - 1, abs=1e-12)]
        np.testing.assert_allclose(scan["sensor_point"], [(distance - 4, 0, 0)], atol=1e-12)
        assert np.isinf(fh.Frame.load(folder / "back.npz")["z"]).all()
        pose = record(tmp_path / "out", frame)["world_from_rig"]
        mounted = fh.Camera.look_at((1, 0, 0), (2, 0, 0), (0, 0, 1), 20, rows=5, columns=5)
        rig = fh.Rig({"camera": mounted}, pose)
        there = fh.Camera.load(folder / "camera.npz")
        np.testing.assert_allclose(there.position, rig["camera"].position, atol=1e-12)
        np.testing.assert_allclose(there.aim, rig["camera"].aim, atol=1e-12)
        np.testing.assert_allclose(there.up, rig["camera"].up, atol=1e-12)


def test_poses_of_a_camera_in_opencv_s_axes_are_those_of_opencv(tmp_path, ball):
    # Right, down, forwards: the camera looks along its own z, which is the world's x.
    pose = [[0, 0, 1, 0.5], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]]
    np.save(tmp_path / "poses.npy", np.array([pose], float))
    k = {"fx": 50.0, "fy": 50.0, "cx": 9.5, "cy": 9.5, "convention": "opencv"}
    camera = {"kind": "camera", "columns": 20, "rows": 20} | k
    poses = {"kind": "list", "body": "right-down-forwards", "file": "poses.npy"}
    plan = fh.Plan.from_dict(ball_ahead([camera], poses, channels=["object", "z"]), tmp_path)
    fh.dataset(plan, tmp_path / "out")
    direct = fh.Camera.from_intrinsics(
        [50, 50, 9.5, 9.5], rows=20, columns=20, convention="ros", pose=pose
    )
    wanted = fh.render(ball, direct, channels=("object", "z"))
    got = fh.Frame.load(tmp_path / "out" / "frames" / "000000" / "camera.npz")
    np.testing.assert_array_equal(got["object"], wanted["object"])
    np.testing.assert_allclose(got["z"], wanted["z"], rtol=1e-12)
    assert (got["object"] == 0).sum() > 10


def test_a_pose_on_the_rig_is_in_its_convention(tmp_path, ball):
    # The inverse of a camera that looks along the rig's -x from (20, 0, 0).
    pose = [[0, 1, 0, 0], [0, 0, -1, 0], [-1, 0, 0, 20], [0, 0, 0, 1]]
    camera = {"kind": "camera", "columns": 3, "rows": 3, "fov": 5}
    camera |= {"pose": pose, "convention": "opencv"}
    poses = {"kind": "list", "body": "forwards-left-up", "matrices": [np.eye(4).tolist()]}
    made = fh.Plan.from_dict(ball_ahead([camera], poses, channels=["z"]), tmp_path)
    fh.dataset(made, tmp_path / "out")
    got = fh.Frame.load(tmp_path / "out" / "frames" / "000000" / "camera.npz")
    assert got["z"][1, 1] == pytest.approx(20 - 7, abs=1e-12)


def test_sensors_move_along_the_path_while_they_see(tmp_path, ball):
    drive = fh.Trajectory([0, 1, 2], [(0, 0, 0), (0, 1, 0), (0, 0, 0)], body="forwards-left-up")
    drive.save(tmp_path / "drive.csv")
    lens = {"columns": 12, "fov": 30}
    sensors = [
        {"kind": "rolling_shutter", "rows": 9, "readout": 0.4, "direction": "bottom_up"} | lens,
        {"kind": "pushbroom", "lines": 7, "line_rate": 20.0} | lens | {"fov": 3},
        {"kind": "lidar", "model": "vlp-16", "columns": 36, "moving": True, "max_range": 50.0},
    ]
    given = {"body": "forwards-left-up", "file": "drive.csv", "format": "csv"}
    poses = {"kind": "path", "trajectory": given, "rate": 4, "start": 0.5, "end": 1.5}
    asked = ball_ahead(sensors, poses, channels=["range", "object"], clouds=["npz"])
    plan = fh.Plan.from_dict(asked, tmp_path)
    assert plan.frames == 5
    assert fh.dataset(plan, tmp_path / "out").made == 5
    for frame, time in ((0, 0.5), (3, 1.25)):
        folder = tmp_path / "out" / "frames" / f"{frame:06d}"
        assert record(tmp_path / "out", frame)["time"] == time
        eye = fh.Camera.look_at((0, 0, 0), (1, 0, 0), (0, 0, 1), 30, rows=9, columns=12)
        rolling = fh.RollingShutter(eye, drive, start=time, readout=0.4, direction="bottom_up")
        line = fh.Camera.look_at((0, 0, 0), (1, 0, 0), (0, 0, 1), 3, rows=1, columns=12)
        swept = fh.Pushbroom(line, drive, time + np.arange(7) / 20)
        for name, sensor in (("rolling_shutter", rolling), ("pushbroom", swept)):
            got = fh.Frame.load(folder / f"{name}.npz")
            wanted = fh.render(ball, sensor, channels=("range", "object"))
            np.testing.assert_array_equal(got["object"], wanted["object"])
            np.testing.assert_allclose(got["range"], wanted["range"], rtol=1e-12)
            assert (got["object"] == 0).any()
        lidar = fh.Lidar.named("vlp-16", columns=36, start=time, trajectory=drive)
        scan, got = lidar.scan(ball, max_range=50.0), np.load(folder / "lidar.npz")
        assert len(scan) > 0
        for name in ("time", "range", "point"):
            np.testing.assert_allclose(got[name], scan[name], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("how", "times"),
    [
        ({}, [0, 1, 3]),
        ({"times": [2.5, 0.5]}, [2.5, 0.5]),
        ({"count": 4}, [0, 1, 2, 3]),
        ({"count": 1}, [0]),
        ({"rate": 10 / 3, "end": 0.9}, [0, 0.3, 0.6, 0.9]),
        ({"rate": 2, "start": 1.5, "end": 2.2}, [1.5, 2]),
    ],
)
def test_a_path_has_frames_at_its_poses_at_times_by_count_or_by_rate(how, times):
    given = {"body": "forwards-left-up", "times": [0, 1, 3], "positions": [[0, 0, 0]] * 3}
    poses = {"kind": "path", "trajectory": given} | how
    made = fh.Plan.from_dict(plan(lambda it: it.update(poses=poses)), PLANS)
    assert made.poses_per_scene == len(times)
    got = [made._poses.place(0, k, k, fh.Scene()).time for k in range(len(times))]
    np.testing.assert_allclose(got, times, atol=1e-12)


def test_a_scene_s_up_is_the_plan_s_where_it_has_one(tmp_path):
    """An OBJ file does not say it, and is taken for +y."""
    (tmp_path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n")

    def rig(**keys):
        data = {"scenes": [{"file": "one.obj"} | keys], "sensors": [{"columns": 8, "rows": 6}]}
        data["poses"] = {"kind": "sphere", "count": 1, "radius": 9, "elevation": 0}
        made = fh.Plan.from_dict(data, tmp_path)
        scene = made._scenes[0].load()
        folder = tmp_path / f"out{len(keys)}"
        fh.dataset(made, folder)
        return tuple(scene.up), np.array(record(folder, 0)["world_from_rig"])[:3, 2]

    up, leaning = rig()
    assert up == (0, 1, 0)
    np.testing.assert_allclose(leaning, up, atol=1e-12)
    up, leaning = rig(up=[0, 0, 2])
    assert up == (0, 0, 2)
    np.testing.assert_allclose(leaning, (0, 0, 1), atol=1e-12)
