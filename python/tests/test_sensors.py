"""Sensors other than cameras: tables of rays, moving cameras, rigs, and trajectories."""

import contextlib
import copy
import json
import pickle
from pathlib import Path
from typing import get_args

import firsthit as fh
import firsthit.typing
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def scene():
    made = fh.Scene()
    made.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
    made.add(fh.Box((-5, -5, -2), (5, 5, -1)), name="floor")
    made.add(fh.Cone((2, 0, -1), (2, 0, 1), 0.8), name="cone")
    return made


def camera(rows=12, columns=16):
    return fh.Camera.look_at((0.5, -6, 2), (0, 0, 0), (0, 0, 1), 40, rows=rows, columns=columns)


def drive():
    half = np.sqrt(0.5)
    return fh.Trajectory(
        [0, 0.5, 1],
        [(0, 0, 0), (0.2, 0.1, 0), (0.5, 0, 0.1)],
        [(0, 0, 0, 1), (0, 0, 0.1, np.sqrt(0.99)), (0, 0, 0.2 * half, np.sqrt(1 - 0.02))],
        interpolation="spline",
        body="forwards-left-up",
    )


def sensors():
    origins, directions = camera().rays()
    line = camera().resize(1, 16)
    return {
        "rays": fh.RaySensor(origins, 2.5 * directions),
        "rolling": fh.RollingShutter(camera(), drive(), start=0, readout=1),
        "sideways": fh.RollingShutter(
            camera(), drive(), start=0, readout=0.5, direction="right_left"
        ),
        "pushbroom": fh.Pushbroom(line, drive(), np.linspace(0, 1, 12)),
        "lidar": fh.Lidar.named("vlp-16", columns=40, position=(3, -3, 1)),
        "carried": fh.Lidar.named("vlp-16", columns=40, trajectory=drive()),
    }


@pytest.fixture(params=sorted(sensors()))
def sensor(request):
    return sensors()[request.param]


def same(a, b):
    for name in ("t", "object", "primitive"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))


def test_a_sensors_hits_are_those_of_its_rays_in_arrays_bit_for_bit(sensor):
    hits = scene().shoot(sensor)
    assert hits.shape == sensor.shape
    assert np.count_nonzero(hits.object >= 0) > 20
    same(hits, scene().shoot(*sensor.rays()))
    np.testing.assert_array_equal(hits.position, scene().shoot(*sensor.rays()).position)
    np.testing.assert_array_equal(hits.origin, sensor.rays()[0])


def test_a_table_keeps_the_rays_that_were_given_bit_for_bit():
    rng = np.random.default_rng(5)
    origins, directions = rng.normal(size=(2, 7, 9, 3))
    table = fh.RaySensor(origins, directions)
    np.testing.assert_array_equal(table.rays(), (origins, directions))
    same(scene().shoot(table), scene().shoot(origins, directions))
    flat = fh.RaySensor(origins.reshape(-1, 3), directions.reshape(-1, 3), shape=(7, 9))
    same(scene().shoot(table), scene().shoot(flat))
    # What the caller changes later is not the sensor's.
    kept = origins.copy()
    origins[:] = 0
    np.testing.assert_array_equal(table.rays()[0], kept)


def test_distances_are_from_where_the_sensor_is_at_the_time_of_the_ray(sensor):
    hits = scene().shoot(sensor)
    met = hits.object >= 0
    origins, _ = sensor.rays()
    apart = hits.position - origins
    far = np.linalg.norm(apart, axis=-1)
    # Rays of these cameras start at the eye.
    np.testing.assert_allclose(hits.range[met], far[met], rtol=1e-13)
    assert np.isinf(hits.range[~met]).all()
    assert ("z" in hits.channels) == sensor.has_aim
    if not sensor.has_aim:
        with pytest.raises(AttributeError, match="z is along the aim of a camera, and this"):
            hits.z  # noqa: B018
    else:
        assert (hits.z[met] <= hits.range[met]).all()
    # The same of some of the hits, and of those with limits.
    np.testing.assert_array_equal(hits[met].range, hits.range[met])
    limited = scene().shoot(sensor, t_max=1e6)
    np.testing.assert_array_equal(limited.range, hits.range)


def test_a_table_with_an_aim_has_the_z_of_its_camera():
    seen = camera()
    table = fh.RaySensor(*seen.rays(), aim=3 * seen.aim)
    z = scene().shoot(seen).z
    np.testing.assert_allclose(scene().shoot(table).z, z, rtol=1e-14)
    frame = fh.render(scene(), table, channels=("z", "range"))
    np.testing.assert_allclose(frame["z"], z, rtol=1e-14)
    with pytest.raises(ValueError, match="channel must be one that a sensor without an aim has"):
        fh.render(scene(), fh.RaySensor(*seen.rays()), channels="z")


def test_pictures_channels_and_files_of_every_sensor(sensor, tmp_path):
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((ROOT / "docs" / "output-metadata.schema.json").read_text())
    validator = jsonschema.Draft202012Validator(schema)
    names = ("color", "range", "object", "position", "valid")
    frame = fh.render(scene(), sensor, channels=names, samples=2)
    hits = scene().shoot(sensor)
    for name in names[1:]:
        np.testing.assert_array_equal(frame[name], hits.channel(name))
    assert np.isfinite(frame["color"]).all()
    frame.save(tmp_path / "a.npz")
    said = fh.read_metadata(tmp_path / "a.npz")
    validator.validate(said)
    assert said["camera"] is None
    assert (said["sensor"]["rows"], said["sensor"]["columns"]) == sensor.shape
    assert said["sensor"] == frame.metadata["sensor"]
    hits.save(tmp_path / "hits.ply", ["range"])
    assert fh.read_metadata(tmp_path / "hits.ply")["sensor"] == said["sensor"]
    with pytest.raises(ValueError, match="does not say which camera made it"):
        fh.Camera.load(tmp_path / "a.npz")
    whole = fh.render(scene(), sensor, channels="color", samples=3)
    part = fh.render(scene(), sensor, channels="color", samples=3, region=np.s_[2:7, 3:11])
    np.testing.assert_array_equal(part["color"], whole["color"][2:7, 3:11])


@pytest.mark.parametrize("samples", [1, 3])
def test_ones_own_shader_sees_a_sensors_hits(sensor, samples):
    def shade(hits):
        far = np.where(np.isfinite(hits.range), hits.range, 0)
        return np.stack([far] * 3, axis=-1)

    made = fh.render(scene(), sensor, shade=shade, samples=samples)["color"]
    assert made.shape == (*sensor.shape, 3)
    if samples == 1 or not isinstance(sensor, fh.RollingShutter | fh.Pushbroom):
        expected = scene().shoot(sensor).range
        expected = np.where(np.isfinite(expected), expected, 0)
        np.testing.assert_allclose(made[..., 0], expected, rtol=1e-6)


def test_a_moving_camera_is_lit_over_its_shoulder_and_a_table_by_ambient_light_alone():
    still = fh.Trajectory([0, 1], [(0, 0, 0)] * 2)
    moving = fh.RollingShutter(camera(), still, start=0, readout=1)
    lit = fh.render(scene(), camera())["color"]
    np.testing.assert_array_equal(fh.render(scene(), moving)["color"], lit)
    table = fh.RaySensor(*camera().rays())
    dark = fh.render(scene(), table, samples=1, background=(0, 0, 0), shade="lambert")["color"]
    white = fh.render(scene(), table, samples=1, background=(0, 0, 0), shade="unlit")["color"]
    np.testing.assert_allclose(dark, 0.25 * white, rtol=1e-6)


def test_sensors_are_pickled_and_copied(sensor):
    for again in (pickle.loads(pickle.dumps(sensor)), copy.deepcopy(sensor)):
        assert type(again) is type(sensor)
        np.testing.assert_array_equal(again.rays(), sensor.rays())
    hits = scene().shoot(sensor)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(hits)).range, hits.range)


def test_other_queries_take_sensors(sensor):
    rays = sensor.rays()
    np.testing.assert_array_equal(scene().occluded(sensor), scene().occluded(*rays))
    np.testing.assert_array_equal(scene().count(sensor), scene().count(*rays))
    np.testing.assert_array_equal(scene().shoot_all(sensor).t, scene().shoot_all(*rays).t)


def test_a_rolling_shutter_shears_a_vertical_edge_exactly():
    rows, columns, speed = 40, 64, 2.5
    wall = fh.Scene()
    wall.add(fh.Box((0, -50, -11), (50, 50, -10)))
    seen = fh.Camera((0, 0, 0), (0, 0, -1), (0, 1, 0), 1, 2, 1.25, rows, columns, ray_start="eye")
    body = fh.Trajectory([10, 12], [(0, 0, 0), (2 * speed, 0, 0)])
    sensor = fh.RollingShutter(seen, body, start=10.5, readout=1.2)
    times = 10.5 + 1.2 * (np.arange(rows) + 0.5) / rows
    np.testing.assert_allclose(sensor.times, times, rtol=1e-15)
    edge = columns / 2 * (1 - speed * (times - 10) / 10)
    is_wall = np.arange(columns) + 0.5 > edge[:, None]
    hits = wall.shoot(sensor)
    np.testing.assert_array_equal(hits.object >= 0, is_wall)
    np.testing.assert_allclose(hits.z[is_wall], 10, rtol=1e-14)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fh.RaySensor(np.zeros((4, 3)), (0, 0, 1), (2, 3)), "origins must be one vector"),
        (lambda: fh.RaySensor((0, 0, 0), (0, 0, 1)), "shape must be given"),
        (lambda: fh.RaySensor((0, 0, 0), (0, 0, 1), (0, 1)), "rows must be 1 or more"),
        (lambda: fh.RaySensor((0, 0, 0), (0, 0, 1), (1, 1), aim=(0, 0, 0)), "aim must be"),
        (lambda: fh.RollingShutter(camera(), drive(), start=0.5, readout=1), "time must be within"),
        (lambda: fh.RollingShutter(camera(), drive(), start=0, readout=-1), "readout must be"),
        (
            lambda: fh.RollingShutter(camera(), drive(), start=0, readout=1, direction="up"),
            "readout direction must be one of",
        ),
        (lambda: fh.Pushbroom(camera(), drive(), [0]), "camera must be one of a single row"),
        (lambda: fh.Pushbroom(camera().resize(1, 4), drive(), []), "times must be at least one"),
        (lambda: fh.Trajectory([0, 0], [(0, 0, 0)] * 2), "strictly increasing"),
        (lambda: fh.Trajectory([0], [(0, 0, 0)], [(0, 0, 0, 0.5)]), "length one"),
        (lambda: fh.Trajectory([0], [(0, 0, 0)], body="left"), "body must be one of"),
        (lambda: fh.Trajectory.from_matrices([0], [2 * np.eye(4)]), "matrices: at index 0: pose"),
        (lambda: fh.Rig({}), "sensors must be at least one"),
        (lambda: fh.Rig.stereo(camera(), 0), "baseline must be positive"),
        (lambda: camera().moved(2 * np.eye(4)), "pose must be"),
    ],
)
def test_what_makes_no_sense_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("words", "make"),
    [
        (fh.typing.Interpolation, lambda word: fh.Trajectory([0], [(0, 0, 0)], interpolation=word)),
        (fh.typing.Extrapolation, lambda word: fh.Trajectory([0], [(0, 0, 0)], extrapolation=word)),
        (fh.typing.BodyName, lambda word: drive().in_axes(word)),
        (
            fh.typing.Readout,
            lambda word: fh.RollingShutter(camera(), drive(), start=0, readout=1, direction=word),
        ),
        (fh.typing.Turn, lambda word: fh.Lidar.spinning([0], direction=word)),
        (
            fh.typing.TrajectoryFormat,
            lambda word: fh.Trajectory.load("/dev/null", word, body="forwards-left-up"),
        ),
    ],
)
def test_words_that_are_typed_are_those_that_there_are(words, make):
    known = get_args(words)
    for word in known:
        with contextlib.suppress(fh.FileReadError):
            make(word)
    with pytest.raises(ValueError, match="must be one of") as error:
        make("other")
    told = str(error.value).split("must be one of ")[1].split(", got")[0]
    assert told.replace(",", "").split() == list(known)


def test_trajectories_come_from_files_and_go_back_bit_for_bit(tmp_path):
    path = drive()
    for name in ("csv", "tum"):
        file = tmp_path / f"poses.{name}"
        path.save(file, name)
        again = fh.Trajectory.load(
            file, name, body="forwards-left-up", interpolation="spline", extrapolation="hold"
        )
        for what in ("times", "positions", "rotations"):
            np.testing.assert_array_equal(getattr(again, what), getattr(path, what))
        times = np.linspace(0, 1, 7)
        np.testing.assert_array_equal(again.at(times), path.at(times))
        np.testing.assert_array_equal(again.at(9), path.at(1))
    with pytest.raises(ValueError, match="format must be csv or tum"):
        path.save(tmp_path / "poses.txt", "kitti")
    with pytest.raises(ValueError, match="time must be within the times of the trajectory"):
        path.at([0.5, 1.5])


def test_kittis_poses_have_their_times_in_another_file(tmp_path):
    (tmp_path / "00.txt").write_text("1 0 0 1 0 1 0 2 0 0 1 3\n0 0 1 5 0 1 0 2 -1 0 0 3\n")
    (tmp_path / "times.txt").write_text("0\n0.25\n")
    axes = "right-down-forwards"
    plain = fh.Trajectory.load(tmp_path / "00.txt", "kitti", body=axes)
    timed = fh.Trajectory.load(
        tmp_path / "00.txt", "kitti", body=axes, times=tmp_path / "times.txt"
    )
    assert plain.times.tolist() == [0, 0.1]
    assert timed.times.tolist() == [0, 0.25]
    expected = [[0, 0, 1, 5], [0, 1, 0, 2], [-1, 0, 0, 3]]
    np.testing.assert_allclose(timed.at(0.25)[:3], expected, atol=1e-15)
    turned = timed.in_axes("forwards-left-up")
    np.testing.assert_allclose(
        turned.at(0)[:3, :3], [[0, -1, 0], [0, 0, -1], [1, 0, 0]], atol=1e-15
    )
    assert turned.body == "forwards-left-up"


def test_a_topic_of_ros_and_what_is_wrong_in_a_file_say_where(tmp_path):
    header = ",".join(
        ["%time", *(f"field.pose.position.{a}" for a in "xyz")]
        + [f"field.pose.orientation.{a}" for a in "xyzw"]
    )
    (tmp_path / "odom.csv").write_text(f"{header}\n1500000000,1,2,3,0,0,0,1\n")
    made = fh.Trajectory.load(tmp_path / "odom.csv", "ros", body="forwards-left-up")
    assert (made.start, made.positions.tolist()) == (1.5, [[1, 2, 3]])
    (tmp_path / "bad.txt").write_text("0 0 0 0 0 0 0 1\n1 2 3\n")
    with pytest.raises(fh.FileFormatError, match=r"bad\.txt:2: expected 8 numbers") as error:
        fh.Trajectory.load(tmp_path / "bad.txt", "tum", body="right-down-forwards")
    assert error.value.place == "line 2"
    with pytest.raises(fh.FileReadError, match="a device or a pipe"):
        fh.Trajectory.load("/dev/zero", body="right-down-forwards")
    with pytest.raises(fh.FileReadError):
        fh.Trajectory.load(tmp_path / "none.csv", body="right-down-forwards")


def test_matrices_and_quaternions_are_the_same_trajectory():
    path = drive()
    times = path.times
    again = fh.Trajectory.from_matrices(times, path.at(times), interpolation="spline")
    np.testing.assert_allclose(again.at(0.3), path.at(0.3), atol=1e-15)
    turns = fh.Trajectory(times, path.positions, path.at(times)[:, :3, :3])
    np.testing.assert_array_equal(turns.at(times), again.at(times))
    other = pickle.loads(pickle.dumps(path))
    np.testing.assert_array_equal(other.at(0.77), path.at(0.77))
    assert (other.body, other.interpolation) == (path.body, path.interpolation)


def test_a_stereo_pair_has_the_disparity_of_its_baseline():
    eye = fh.Camera.look_at((1, 2, 3), (4, 1, 3), (0, 0, 1), 50, rows=48, columns=64)
    pose = fh.Trajectory([0], [(5, 6, 7)], [(0.1, 0.2, 0.3, np.sqrt(0.86))]).at(0)
    rig = fh.Rig.stereo(eye, baseline=0.3, pose=pose)
    left, right = rig["left"], rig["right"]
    depth = 8.0
    points = left.position + depth * left.aim + left.right * 0.7 + left.upwards * 0.2
    difference = left.project(points) - right.project(points)
    f = eye.intrinsic_matrix[0, 0]
    np.testing.assert_allclose(difference, [0.3 * f / depth, 0], atol=1e-10)
    assert list(rig) == ["left", "right"]
    assert len(rig) == 2
    assert rig.sensors["left"] == eye


def test_a_rig_moves_all_its_sensors_together():
    lidar = fh.Lidar.named("vlp-16", columns=20, position=(0, 0, 1))
    table = fh.RaySensor([(0, 0, 0), (1, 0, 0)], (0, 0, 2), aim=(1, 0, 0))
    rig = fh.Rig({"eye": camera(), "lidar": lidar, "table": table})
    turn = [[0, -1, 0, 3], [1, 0, 0, -2], [0, 0, 1, 0.5], [0, 0, 0, 1]]
    moved = rig.at(turn)
    matrix = np.array(turn, float)
    for name, still in rig.items():
        for k, (before, after) in enumerate(zip(still.rays(), moved[name].rays(), strict=True)):
            expected = before @ matrix[:3, :3].T + (matrix[:3, 3] if k == 0 else 0)
            np.testing.assert_allclose(after, expected, atol=1e-14)
    np.testing.assert_array_equal(moved["table"].aim, (0, 1, 0))
    # Poses are those in the world, not steps.
    np.testing.assert_array_equal(moved.at(np.eye(4))["eye"].rays(), camera().rays())
    frames = moved.render(scene(), channels="range")
    for name, frame in frames.items():
        np.testing.assert_array_equal(frame["range"], scene().shoot(moved[name]).range)
    with pytest.raises(KeyError, match="no sensor 'nose'"):
        rig["nose"]
    with pytest.raises(TypeError, match="sensor 'a' must be"):
        fh.Rig({"a": fh.Lidar.named("vlp-16", trajectory=drive())})


def test_a_camera_that_is_not_turned_keeps_its_bits():
    seen = camera()
    assert seen.moved(np.eye(4)) == seen
    moved = seen.moved([[1, 0, 0, 7], [0, 1, 0, 0], [0, 0, 1, 0]])
    np.testing.assert_array_equal(moved.aim, seen.aim)
    np.testing.assert_array_equal(moved.rays()[1], seen.rays()[1])
    assert pickle.loads(pickle.dumps(moved)) == moved


def test_a_frame_becomes_a_dataset_of_xarray():
    xarray = pytest.importorskip("xarray")
    region = np.s_[2:9, 4:12]
    frame = fh.render(scene(), camera(), channels=("z", "normal", "object"), region=region)
    data = frame.to_xarray()
    assert isinstance(data, xarray.Dataset)
    assert data["z"].dims == ("row", "column")
    assert data["normal"].dims == ("row", "column", "normal_component")
    assert data["row"].values.tolist() == [k + 0.5 for k in range(2, 9)]
    assert data["column"].values.tolist() == [k + 0.5 for k in range(4, 12)]
    assert data["z"].attrs["units"] == "scene length"
    assert data["z"].attrs["frame"] == "camera"
    assert data["object"].attrs["miss"] == "-1"
    np.testing.assert_array_equal(data["normal"].values, frame["normal"])
    assert json.loads(data.attrs["camera"]) == frame.metadata["camera"]
    lidar = fh.Lidar.named("vlp-16", columns=8)
    of_lidar = fh.render(scene(), lidar, channels="range").to_xarray()
    assert json.loads(of_lidar.attrs["sensor"])["kind"] == "lidar"
    plain = fh.Frame((2, 3), {"attribute:a": np.zeros((2, 3))}).to_xarray()
    assert plain["row"].values.tolist() == [0.5, 1.5]


def test_what_is_missing_is_said_with_its_package(without):
    frame = fh.Frame((2, 3), {"z": np.zeros((2, 3))})
    without("xarray")
    with pytest.raises(ImportError, match="pip install xarray"):
        frame.to_xarray()


def test_the_points_of_a_frame_are_the_pixels_that_hit_something():
    frame = fh.render(scene(), camera(), channels=("position", "object", "z"))
    points = frame.to_points()
    met = frame["object"] >= 0
    np.testing.assert_array_equal(points["position"], frame["position"][met])
    np.testing.assert_array_equal(np.stack(np.nonzero(met)), [points["row"], points["column"]])
    with pytest.raises(ValueError, match="the channel position"):
        fh.render(scene(), camera(), channels="z").to_points()
