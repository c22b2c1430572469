"""Laser scanners against closed forms, and their files in independent readers."""

import io
import json
import pickle
import statistics
import warnings

import firsthit as fh
import numpy as np
import pytest


def room():
    made = fh.Scene()
    made.add(fh.Box((-4, -3, -1), (4, 3, 2)), material=fh.Material(color=(0.5, 0.5, 0.5)))
    return made


def in_room(at, directions):
    """Return the distances from inside to the walls, floor and ceiling."""
    low, high = np.array([-4, -3, -1]), np.array([4, 3, 2])
    ahead = np.where(directions > 0, high - at, low - at)
    far = np.full(ahead.shape, np.inf)
    return np.divide(ahead, directions, out=far, where=directions != 0).min(axis=-1)


def pointing(azimuth, elevation):
    a, e = np.broadcast_arrays(np.radians(azimuth), np.radians(elevation))
    return np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)], axis=-1)


def test_a_spinning_lidar_in_a_room_has_the_ranges_of_the_closed_form():
    at = np.array([1, -0.5, 0.25])
    elevations = np.linspace(-60, 70, 27)
    lidar = fh.Lidar.spinning(elevations, columns=180, position=at)
    scan = lidar.scan(room())
    assert len(scan) == 27 * 180
    azimuth = 180 - 2 * np.arange(180.0)
    directions = pointing(azimuth, elevations[::-1, None]).reshape(-1, 3)
    np.testing.assert_allclose(scan.range, in_room(at, directions), rtol=0, atol=1e-12)
    np.testing.assert_allclose(scan.point, at + scan.range[:, None] * directions, atol=1e-12)
    np.testing.assert_allclose(scan.sensor_point, scan.point - at, atol=1e-12)
    np.testing.assert_array_equal(scan.ring, np.repeat(np.arange(27)[::-1], 180))
    np.testing.assert_allclose(scan.time, np.tile(np.arange(180) / 1800, 27), atol=1e-15)
    # Walls are axes: the cosine of incidence is the component along that of the one that is met.
    wall = np.abs(directions)
    cosine = np.cos(scan.incidence)
    assert np.abs(wall - cosine[:, None]).min(axis=1).max() < 1e-12
    np.testing.assert_array_equal(scan.to_image(), room().shoot(lidar).range)
    assert scan.return_number.tolist() == [1] * len(scan)


def test_the_vlp_16_has_the_angles_and_times_of_its_manual():
    lidar = fh.Lidar.named("vlp-16", rate=10)
    assert lidar.shape == (16, 1808)
    assert lidar.elevation[:, 0].tolist() == list(range(15, -16, -2))
    # Laser 0 is the lowest, laser 1 the first above level.
    assert lidar.ring[15, 0] == 0
    assert lidar.ring[7, 0] == 1
    after = lidar.time[:, 1] - lidar.time[:, 0]
    np.testing.assert_allclose(after, 55.296e-6, rtol=1e-9)
    np.testing.assert_allclose(lidar.time[:, 0], 2.304e-6 * lidar.ring[:, 0], atol=1e-18)
    np.testing.assert_allclose(
        lidar.azimuth[:, 0], 180 - 3600 * 2.304e-6 * lidar.ring[:, 0], rtol=1e-12
    )


def test_other_models_have_their_makers_angles():
    assert fh.Lidar.named("hdl-32e").elevation[[0, -1], 0].tolist() == [10.67, -30.67]
    ultra = fh.Lidar.named("vlp-32c", columns=8)
    assert ultra.elevation[[0, -1], 0].tolist() == [15, -25]
    # Laser 0 points 1.4 degrees clockwise.
    assert ultra.azimuth[31, 0] == pytest.approx(178.6, abs=1e-12)
    ouster = fh.Lidar.named("os1-64")
    assert ouster.shape == (64, 1024)
    np.testing.assert_allclose(np.diff(ouster.elevation[:, 0]), -45 / 63)
    with pytest.raises(ValueError, match=r"lidar model must be one of vlp-16, .*; did you mean"):
        fh.Lidar.named("vlp16")


def test_a_lidar_that_drives_measures_from_where_it_is():
    body = fh.Trajectory([0, 1], [(-2, 0, 0), (2, 0, 0)], body="forwards-left-up")
    lidar = fh.Lidar.spinning([0], columns=100, rate=1, trajectory=body)
    scan = lidar.scan(room())
    at = np.stack([-2 + 4 * scan.time, 0 * scan.time, 0 * scan.time], axis=-1)
    directions = lidar.direction.reshape(-1, 3)
    np.testing.assert_allclose(scan.range, in_room(at, directions), atol=1e-12)
    np.testing.assert_allclose(scan.point, at + scan.sensor_point, atol=1e-12)
    np.testing.assert_allclose(lidar.poses()[0, :, 0, 3], at[:, 0], atol=1e-15)
    # On a body with a camera's axes it looks where the camera does.
    camera = fh.Trajectory([0, 1], [(0, 0, 0)] * 2, body="right-down-forwards")
    forwards = fh.Lidar([0], [0], trajectory=camera).rays()[1][0, 0]
    np.testing.assert_array_equal(forwards, (0, 0, 1))
    # A scanner that is turned to the left has its own frame.
    pose = [[0, -1, 0, 1], [1, 0, 0, 0], [0, 0, 1, 0]]
    turned = fh.Lidar.spinning([0, 5], columns=9, pose=pose)
    scan = turned.scan(room())
    own = scan.sensor_point @ np.array(pose)[:, :3].T + (1, 0, 0)
    np.testing.assert_allclose(own, scan.point, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(scan.sensor_point, axis=1), scan.range, rtol=1e-15)
    mounted = fh.Lidar([0], [0], trajectory=body, pose=np.eye(4)[:3] + [[0, 0, 0, 5]] * 3)
    np.testing.assert_array_equal(mounted.rays()[0][0, 0], (3, 5, 5))


def layers():
    """Sheets across the beam, at 4 and 6, and a wall at 10."""
    made = fh.Scene()
    for x, half in ((4, 1.0), (6, 2.0), (10, 50.0)):
        low, high = (x, -half, -half), (x + 0.001, half, half)
        made.add(fh.Box(low, high), material=fh.Material(color=(x / 20,) * 3))
    return made


def test_returns_of_a_line_are_what_it_crosses():
    lidar = fh.Lidar([0, 15], [0, 0])
    every = lidar.scan(layers(), returns="all", range_gate=0.01)
    # The mean of the sheet's front and back.
    np.testing.assert_allclose(every.range[:3], [4.0005, 6.0005, 10.0005], rtol=1e-15)
    assert every.return_number.tolist() == [1, 2, 3, 1, 2]
    assert every.number_of_returns.tolist() == [3, 3, 3, 2, 2]
    assert every.column.tolist() == [0, 0, 0, 1, 1]
    last = lidar.scan(layers(), returns="last", range_gate=0.01)
    assert last.object.tolist() == [2, 2]
    assert last.return_number.tolist() == [3, 2]
    strongest = lidar.scan(layers(), returns="strongest", range_gate=0.01)
    # 0.2 / 16, 0.3 / 36, 0.5 / 100.
    assert strongest.object.tolist() == [0, 1]
    assert lidar.scan(layers()).range.tolist()[0] == 4
    few = lidar.scan(layers(), returns="all", max_returns=1, range_gate=0.01)
    assert few.return_number.tolist() == [1, 1]
    within = lidar.scan(layers(), returns="all", min_range=3, max_range=7, range_gate=0.01)
    assert within.object.tolist() == [0, 1, 1]


@pytest.mark.parametrize("returns", ["first", "last", "strongest", "all"])
@pytest.mark.parametrize("how", [{}, {"range_gate": 0.1}, {"divergence": 0.001, "range_gate": 1}])
def test_a_ball_within_min_range_blocks_the_beam(returns, how):
    made = room()
    made.add(fh.Sphere((0.3, 0, 0), 0.05))
    lidar = fh.Lidar([0, 90, 180], [0, 0, 0])
    scan = lidar.scan(made, returns=returns, min_range=0.5, **how)
    # The ball is 0.25 ahead; to the left and behind there are walls.
    assert scan.column.tolist() == [1, 2]
    assert scan.range == pytest.approx([3, 4])
    # What is beyond the limit goes on as before, and so does a limit of zero.
    assert lidar.scan(made, returns=returns, min_range=0.2, **how).column[0] == 0
    assert lidar.scan(made, returns=returns, **how).column[0] == 0


def test_a_cone_s_lines_pass_beside_what_is_within_min_range():
    made = room()
    # It covers the lower half of the cone.
    made.add(fh.Box((0.2, -1, -1), (0.3, 1, 0)))
    cone = {"divergence": 0.1, "subrays": 200, "range_gate": 1, "intensity": True}
    lidar = fh.Lidar([0], [0.001])
    free, half = (lidar.scan(scene, min_range=0.5, **cone) for scene in (room(), made))
    assert half.object.tolist() == [0]
    assert half.intensity / free.intensity == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("limits", [{}, {"min_range": 3.2, "max_range": 4.5}])
def test_noise_leads_to_no_range_of_zero_and_to_none_out_of_the_limits(limits):
    lidar = fh.Lidar.named("vlp-16", columns=360)
    plain, noisy = (lidar.scan(room(), seed=3, noise=n, **limits) for n in (0.0, 2.0))
    assert len(noisy) < len(plain)
    assert noisy.range.min() > limits.get("min_range", 0)
    assert noisy.range.max() <= limits.get("max_range", np.inf)
    # Those that stay are where they would be without limits.
    free = lidar.scan(room(), seed=3, noise=2.0)
    beams = [scan.row * 360 + scan.column for scan in (free, noisy)]
    np.testing.assert_array_equal(noisy.range, free.range[np.isin(*beams)])
    # And all that may stay do.
    allowed = (free.range > limits.get("min_range", 0)) & (
        free.range <= limits.get("max_range", np.inf)
    )
    reached = np.isin(beams[0], plain.row * 360 + plain.column)
    assert len(noisy) == (allowed & reached).sum()


def test_of_three_returns_two_are_told_as_of_two():
    lidar = fh.Lidar([0], [0])
    two = lidar.scan(layers(), returns="all", max_returns=2, range_gate=0.01)
    assert two.return_number.tolist() == [1, 2]
    assert two.number_of_returns.tolist() == [2, 2]
    five = lidar.scan(layers(), returns="all", max_returns=5, range_gate=0.01)
    assert five.number_of_returns.tolist() == [3, 3, 3]


def test_a_cone_at_an_edge_has_two_returns_and_one_on_a_wall_has_one():
    # The edge of the sheet at 4 is at atan(1 / 4) = 14.036 degrees.
    edge = np.degrees(np.arctan2(1, 4))
    lidar = fh.Lidar([0, edge], [0, 0])
    how = {"divergence": 0.02, "subrays": 200, "range_gate": 0.5}
    every = lidar.scan(layers(), returns="all", intensity=True, **how)
    assert every.column.tolist() == [0, 1, 1]
    assert every.object.tolist() == [0, 0, 1]
    # Half of the lines are on each side; they see luminances of 0.2 and 0.3.
    shares = every.intensity / np.cos(every.incidence) / [0.2, 0.2, 0.3]
    np.testing.assert_allclose(shares, [1, 0.5, 0.5], atol=0.04)
    first = lidar.scan(layers(), returns="first", **how)
    last = lidar.scan(layers(), returns="last", **how)
    np.testing.assert_array_equal(first.range, every.range[[0, 1]])
    np.testing.assert_array_equal(last.range, every.range[[0, 2]])
    assert last.number_of_returns.tolist() == [1, 2]
    # A wide gate does not tell them apart.
    blurred = lidar.scan(layers(), returns="all", **{**how, "range_gate": 5})
    assert blurred.number_of_returns.tolist() == [1, 1]
    assert every.range[1] < blurred.range[1] < every.range[2]
    one = lidar.scan(layers(), divergence=0.02, subrays=1)
    np.testing.assert_array_equal(one.range, lidar.scan(layers()).range)


def test_returns_are_clustered_as_a_loop_does_it():
    made, rng = fh.Scene(), np.random.default_rng(7)
    for center in rng.uniform(-6, 6, (60, 3)):
        made.add(fh.Sphere(center, 0.6))
    lidar = fh.Lidar.raster(60, 40, 12, 16)
    scan = lidar.scan(made, returns="all", range_gate=0.7)
    expected = []
    for beam in lidar.rays()[1].reshape(-1, 3):
        t = made.shoot_all((0, 0, 0), beam).t
        groups = []
        for far in t:
            if groups and far - groups[-1][0] <= 0.7:
                groups[-1].append(far)
            else:
                groups.append([far])
        expected += [np.mean(group) for group in groups]
    np.testing.assert_allclose(scan.range, expected, rtol=1e-14)


def test_noise_and_dropout_are_those_of_the_seed_and_of_each_return_alone():
    lidar = fh.Lidar.named("vlp-16", columns=360)
    plain = lidar.scan(room())
    noisy = lidar.scan(room(), noise=0.02, seed=1)
    again = lidar.scan(room(), noise=0.02, seed=1, threads=1)
    np.testing.assert_array_equal(noisy.range, again.range)
    off = noisy.range - plain.range
    assert abs(off.mean()) < 0.002
    assert off.std() == pytest.approx(0.02, rel=0.05)
    relative = lidar.scan(room(), noise=(0, 0.01), seed=1)
    np.testing.assert_allclose(relative.range, plain.range * (1 + off / 2), rtol=1e-12)
    lost = lidar.scan(room(), noise=0.02, dropout=0.25, seed=1)
    assert len(lost) == pytest.approx(0.75 * len(plain), rel=0.05)
    at = lost.row * 360 + lost.column
    np.testing.assert_array_equal(lost.range, noisy.range[at])
    assert not np.array_equal(lidar.scan(room(), noise=0.02, seed=2).range, noisy.range)
    beams = lidar.rays()[1][lost.row, lost.column]
    np.testing.assert_allclose(lost.point, lost.range[:, None] * beams)
    # Another beam's miss changes nothing.
    part = lidar.scan(room(), noise=0.02, seed=1, max_range=4)
    near = (plain.range <= 4) & (noisy.range <= 4)
    np.testing.assert_array_equal(part.range, noisy.range[near])


def test_noise_is_normal_and_independent_of_everything_else():
    """By the moments and the quantiles of many returns, and by correlations."""
    lidar = fh.Lidar.named("os1-64", columns=4096)
    plain = lidar.scan(room())
    normal = {
        seed: (lidar.scan(room(), noise=0.01, seed=seed).range - plain.range).reshape(64, -1) / 0.01
        for seed in (0, 1, 2**63 - 1)
    }
    count = 64 * 4096
    quantiles = np.linspace(0.01, 0.99, 99)
    expected = np.array([statistics.NormalDist().inv_cdf(each) for each in quantiles])
    for each in normal.values():
        assert abs(each.mean()) < 5 / count**0.5
        assert each.std() == pytest.approx(1, abs=5 / (2 * count) ** 0.5)
        assert abs((each**3).mean()) < 5 * (15 / count) ** 0.5
        assert (each**4).mean() == pytest.approx(3, abs=5 * (96 / count) ** 0.5)
        np.testing.assert_allclose(np.quantile(each, quantiles), expected, atol=0.02)
        for a, b in ((each[1:], each[:-1]), (each[:, 1:], each[:, :-1])):
            assert abs((a * b).mean()) < 5 / count**0.5
    assert abs((normal[0] * normal[1]).mean()) < 5 / count**0.5
    # Nor do the returns of a beam, and the chance that one is lost.
    sheets = fh.Scene()
    sheets.add(fh.Sphere((0, 0, 0), 5))
    sheets.add(fh.Sphere((0, 0, 0), 6))
    two = lidar.scan(sheets, returns="all", noise=0.01, seed=1)
    off = (two.range - lidar.scan(sheets, returns="all").range) / 0.01
    assert abs((off[0::2] * off[1::2]).mean()) < 5 / count**0.5
    lost = np.ones(count, np.bool_)
    kept = lidar.scan(room(), dropout=0.3, seed=1)
    lost[kept.row * 4096 + kept.column] = False
    assert lost.mean() == pytest.approx(0.3, abs=5 * (0.21 / count) ** 0.5)
    assert abs(normal[1].reshape(-1)[lost].mean()) < 5 / lost.sum() ** 0.5


def test_intensity_is_the_luminance_times_the_cosine():
    scan = fh.Lidar.named("vlp-16", columns=90).scan(room(), intensity=True)
    np.testing.assert_allclose(scan.intensity, 0.5 * np.cos(scan.incidence), rtol=1e-12)
    assert fh.Lidar([0], [0]).scan(room()).intensity is None


@pytest.mark.parametrize("how", [{}, {"returns": "all"}, {"divergence": 0.01, "subrays": 3}])
def test_a_scan_tells_how_far_it_is(how):
    told = []
    lidar = fh.Lidar.named("vlp-16", columns=60)
    lidar.scan(room(), progress=lambda done, total: told.append((done, total)), **how)
    lines = 960 * how.get("subrays", 1)
    assert told[-1] == (lines, lines)
    assert told == sorted(told)


def test_solid_state_patterns_follow_their_formulas():
    raster = fh.Lidar.raster(40, 20, 10, 20, rate=5)
    assert raster.azimuth[0].tolist() == [40 * (0.5 - (c + 0.5) / 20) for c in range(20)]
    assert raster.time[1, 0] == pytest.approx(20 / 200 / 5)
    rose = fh.Lidar.rosette(38.4, (70, -40), points=1000, point_rate=1e5)
    time = np.arange(1000) / 1e5
    vector = sum(
        9.6 * np.stack([np.cos(2 * np.pi * f * time), np.sin(2 * np.pi * f * time)])
        for f in (70, -40)
    )
    angle = np.degrees(np.arccos(rose.direction[0, :, 0]))
    np.testing.assert_allclose(angle, np.hypot(*vector), atol=1e-6)
    left, up = rose.direction[0, :, 1], rose.direction[0, :, 2]
    np.testing.assert_allclose(left * vector[1], up * vector[0], atol=1e-12)
    figure = fh.Lidar.lissajous(60, 20, (3, 5), points=500, point_rate=1e3)
    time = np.arange(500) / 1e3
    np.testing.assert_allclose(figure.azimuth[0], 30 * np.sin(6 * np.pi * time), atol=1e-12)
    np.testing.assert_allclose(
        figure.elevation[0], 10 * np.sin(10 * np.pi * time + np.pi / 2), atol=1e-12
    )


def test_beams_come_from_a_csv(tmp_path):
    (tmp_path / "beams.csv").write_text("ring,azimuth,elevation,time\n5,90,0,0.5\n6,0,90,1\n")
    lidar = fh.Lidar.from_csv(tmp_path / "beams.csv", position=(0, 0, 1))
    np.testing.assert_allclose(lidar.rays()[1][0], [(0, 1, 0), (0, 0, 1)], atol=1e-15)
    assert lidar.ring.tolist() == [[5, 6]]
    assert lidar.time.tolist() == [[0.5, 1]]
    again = pickle.loads(pickle.dumps(lidar))
    np.testing.assert_array_equal(again.rays(), lidar.rays())
    (tmp_path / "bad.csv").write_text("azimuth,elevation\n1,x\n")
    with pytest.raises(fh.FileFormatError, match=r"bad\.csv:2: elevation must be a number"):
        fh.Lidar.from_csv(tmp_path / "bad.csv")


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"noise": 0.1}, "seed must be given"),
        ({"dropout": 0.1}, "seed must be given"),
        ({"dropout": 1.5, "seed": 1}, "dropout must be from 0 to 1"),
        ({"noise": -1, "seed": 1}, "noise must be from 0"),
        ({"noise": (1, 2, 3), "seed": 1}, "noise must be one number or two"),
        ({"returns": "second"}, "returns must be one of"),
        ({"divergence": 4}, "divergence must be from 0"),
        ({"divergence": 0.1, "subrays": 0}, "subrays must be from 1 to 65536"),
        ({"subrays": 4}, "subrays must be left out unless there is a divergence, got 4"),
        ({"returns": "all", "max_returns": 0}, "max_returns must be 1 or more, got 0"),
        (
            {"returns": "all", "max_returns": 2**70},
            rf"max_returns must be below 2\^63, got {2**70}",
        ),
        (
            {"max_returns": 2},
            "max_returns must be left out unless returns is all, got returns first",
        ),
        ({"returns": "last", "max_returns": 2}, "max_returns must be left out unless"),
        ({"noise": 0.1, "seed": -1}, "seed must be zero or more, got -1"),
        ({"noise": 0.1, "seed": 2**63}, rf"seed must be below 2\^63, got {2**63}"),
        ({"min_range": 2, "max_range": 1}, "min_range and max_range"),
        ({"range_gate": float("nan")}, "range_gate must be from 0"),
    ],
)
def test_scans_that_make_no_sense_are_refused(how, message):
    with pytest.raises(ValueError, match=message):
        fh.Lidar([0], [0]).scan(room(), **how)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fh.Lidar([], []), "columns must be at least 1"),
        (lambda: fh.Lidar([0], [0, 1]), "elevations must be as many as azimuths"),
        (lambda: fh.Lidar([np.nan], [0]), "azimuth must be finite"),
        (lambda: fh.Lidar([0], [0], rings=[0.5]), "rings must be whole numbers"),
        (lambda: fh.Lidar([0], [0], position=(0, 0, 0), pose=np.eye(4)), "position must be left"),
        (lambda: fh.Lidar.spinning([]), "elevations must be at least one"),
        (lambda: fh.Lidar.spinning([91]), "elevations must be from -90 to 90"),
        (lambda: fh.Lidar.spinning([1], azimuth_offsets=[1, 2]), "azimuth_offsets must be one"),
        (lambda: fh.Lidar.spinning([1], direction="up"), "direction must be one of"),
        (lambda: fh.Lidar.named("vlp-16", rate=0), "rate must be positive"),
        (lambda: fh.Lidar.named("vlp-16", rate=1e9), "columns must be at least 1"),
        (lambda: fh.Lidar.spinning([1], columns=2**40), "beams must be at most 2"),
        (lambda: fh.Lidar.raster(0, 10, 1, 1), "horizontal_fov must be above 0"),
        (lambda: fh.Lidar.rosette(10, (1, 2), 0, 10), "points must be 1 or more"),
    ],
)
def test_patterns_that_make_no_sense_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_scan_of_nothing_is_empty_and_can_be_saved(tmp_path):
    for how in ({}, {"returns": "all"}, {"divergence": 0.01}, {"noise": 1, "seed": 1}):
        scan = fh.Lidar([0, 1], [0, 0]).scan(fh.Scene(), **how)
        assert len(scan) == 0
        assert np.isinf(scan.to_image()).all()
        assert (scan.to_image("object") == -1).all()
        assert np.isnan(scan.to_image("point")).all()
    for name in ("a.npz", "a.ply", "a.pcd", "a.las"):
        scan.save(tmp_path / name)


@pytest.fixture
def scan():
    lidar = fh.Lidar.named("vlp-16", columns=50, position=(0.5, 0.25, 0.125), start=100)
    return lidar.scan(layers(), returns="all", intensity=True, range_gate=0.01)


def test_an_npz_is_read_by_numpy(scan, tmp_path):
    scan.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as read:
        for name in list(scan.keys()):
            np.testing.assert_array_equal(read[name], scan[name])
        said = json.loads(str(read["metadata"]))
    assert said["sensor"]["words"] == {"pattern": "vlp-16"}
    units = {channel["name"]: channel["unit"] for channel in said["channels"]}
    assert units["time"] == "second"
    assert said["scan"]["returns"] == "all"
    assert {channel.pop("stored")["encoding"] for channel in said["channels"]} == {"exact"}
    assert said == json.loads(json.dumps(scan.metadata))


@pytest.mark.parametrize("extension", [".npz", ".ply", ".pcd"])
def test_what_files_of_scans_say_is_read_as_that_of_frames(scan, tmp_path, extension):
    path = tmp_path / f"a{extension}"
    scan.save(path)
    said = fh.read_metadata(path)
    assert said["sensor"] == scan.metadata["sensor"]
    assert [channel["name"] for channel in said["channels"]] == list(scan.keys())


def test_las_counts_no_further_than_it_can(tmp_path):
    laspy = pytest.importorskip("laspy")
    scene = fh.Scene()
    for k in range(20):
        scene.add(fh.Box((3 + k, -9, -9), (3.5 + k, 9, 9)))
    beam = fh.Lidar.spinning([0.0], columns=4, azimuth_start=-1, azimuth_end=1)
    scan = beam.scan(scene, returns="all")
    assert scan.number_of_returns.max() == 40
    scan.save(tmp_path / "a.las")
    read = laspy.read(tmp_path / "a.las")
    np.testing.assert_array_equal(read.return_number, np.minimum(scan.return_number, 15))
    assert set(np.asarray(read.number_of_returns)) == {15}


def test_a_laz_has_no_day(scan, tmp_path):
    pytest.importorskip("lazrs")
    scan.save(tmp_path / "a.laz")
    assert (tmp_path / "a.laz").read_bytes()[90:94] == bytes(4)


def test_a_ply_is_read_by_trimesh(scan, tmp_path):
    trimesh = pytest.importorskip("trimesh")
    scan.save(tmp_path / "a.ply")
    cloud = trimesh.load(tmp_path / "a.ply")
    np.testing.assert_array_equal(cloud.vertices, scan.point)
    data = cloud.metadata["_ply_raw"]["vertex"]["data"]
    np.testing.assert_array_equal(data["time"], scan.time)
    np.testing.assert_array_equal(data["ring"], scan.ring)


def test_a_pcd_is_what_its_header_says(scan, tmp_path):
    scan.save(tmp_path / "a.pcd")
    content = (tmp_path / "a.pcd").read_bytes()
    header, body = content.split(b"DATA binary\n", 1)
    said = dict(line.split(" ", 1) for line in header.decode().splitlines()[1:])
    fields, kinds, sizes = (said[name].split() for name in ("FIELDS", "TYPE", "SIZE"))
    columns = [
        (field, f"<{kind.lower()}{size}")
        for field, kind, size in zip(fields, kinds, sizes, strict=True)
    ]
    read = np.frombuffer(body, columns)
    assert len(read) == len(scan) == int(said["POINTS"])
    np.testing.assert_array_equal(read["x"], scan.point[:, 0].astype(np.float32))
    np.testing.assert_array_equal(read["return_number"], scan.return_number)
    np.testing.assert_array_equal(read["time"], scan.time)


@pytest.mark.parametrize("name", ["a.las", "a.laz"])
def test_a_las_and_a_laz_are_read_by_laspy(name, scan, tmp_path):
    laspy = pytest.importorskip("laspy")
    if name == "a.laz":
        pytest.importorskip("lazrs")
    scan.save(tmp_path / name)
    read = laspy.read(tmp_path / name)
    assert (str(read.header.version), read.header.point_format.id) == ("1.4", 6)
    assert len(read) == len(scan)
    np.testing.assert_allclose(read.xyz, scan.point, atol=0.50001e-4)
    np.testing.assert_array_equal(read.header.mins, read.xyz.min(axis=0))
    np.testing.assert_array_equal(read.header.maxs, read.xyz.max(axis=0))
    np.testing.assert_array_equal(read.gps_time, scan.time)
    np.testing.assert_array_equal(read.return_number, scan.return_number)
    np.testing.assert_array_equal(read.number_of_returns, scan.number_of_returns)
    np.testing.assert_allclose(read.intensity / 65535, scan.intensity, atol=0.51 / 65535)
    np.testing.assert_array_equal(read["range"], scan.range)
    for extra in ("ring", "object", "row", "column"):
        np.testing.assert_array_equal(read[extra], scan[extra])
    by_return = [np.count_nonzero(scan.return_number == k + 1) for k in range(15)]
    assert list(read.header.number_of_points_by_return) == by_return


def test_a_parquet_is_read_by_pyarrow(scan, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    scan.save(tmp_path / "a.parquet")
    table = parquet.read_table(tmp_path / "a.parquet")
    for name, column in scan.to_dict().items():
        np.testing.assert_array_equal(table[name].to_numpy(), column)
    assert json.loads(table.schema.metadata[b"firsthit"]) == scan.metadata


def test_a_las_of_a_far_place_has_the_steps_that_reach(tmp_path):
    pattern = {"azimuths": [0, 90], "elevations": [0, 0]}
    made = fh.Scene()
    made.add(fh.Box((-3e6, -3e6, -3e6), (3e6, 3e6, 3e6)))
    scan = fh.Lidar(**pattern, position=(1e5, 0, 0)).scan(made)
    laspy = pytest.importorskip("laspy")
    scan.save(tmp_path / "a.las")
    read = laspy.read(tmp_path / "a.las")
    assert read.header.scales.tolist() == [0.01] * 3
    np.testing.assert_allclose(read.xyz, scan.point, atol=0.00501)


def test_packages_that_are_missing_are_named(scan, tmp_path, without):
    without("pyarrow")
    with pytest.raises(ImportError, match="pip install pyarrow"):
        scan.save(tmp_path / "a.parquet")
    with pytest.raises(ValueError, match=r"path must end in one of \.npz"):
        scan.save(tmp_path / "a.e57")
    assert list(tmp_path.iterdir()) == []


def test_the_same_scan_has_the_same_bytes_and_writing_is_whole(scan, tmp_path):
    for name in ("a.ply", "a.pcd", "a.las"):
        scan.save(tmp_path / name)
        first = (tmp_path / name).read_bytes()
        pickle.loads(pickle.dumps(scan)).save(tmp_path / name)
        assert (tmp_path / name).read_bytes() == first
    with pytest.raises(fh.FileWriteError):
        scan.save(tmp_path / "none" / "a.las")
    out = io.BytesIO((tmp_path / "a.las").read_bytes())
    assert out.read(4) == b"LASF"


def test_an_npz_is_read_back_as_it_was(scan, tmp_path):
    other = fh.Lidar.named("vlp-16", columns=18).scan(
        layers(), returns="all", intensity=True, noise=0.1, seed=2
    )
    for written in (scan, other, fh.LidarScan.joined([other, other])):
        written.save(tmp_path / "a.npz")
        read = fh.LidarScan.load(tmp_path / "a.npz")
        assert (read.shape, read.keys(), read.metadata) == (
            written.shape,
            written.keys(),
            written.metadata,
        )
        for name in written.keys():  # noqa: SIM118 - a scan has no other names
            assert read[name].dtype == written[name].dtype
            np.testing.assert_array_equal(read[name], written[name])
        np.testing.assert_array_equal(read.to_image("time"), written.to_image("time"))
        again = fh.LidarScan.joined([read, written])
        assert again.shape[1] == 2 * written.shape[1]
        assert not read.range.flags.writeable


def test_what_is_no_npz_of_a_scan_is_refused(scan, tmp_path):
    scan.save(tmp_path / "good.npz")
    with np.load(tmp_path / "good.npz") as file:
        good = {name: file[name] for name in file.files}
    said = json.loads(str(good["metadata"]))

    def refused(what, **changed):
        arrays = {name: array for name, array in {**good, **changed}.items() if array is not None}
        np.savez(tmp_path / "bad.npz", **arrays)
        with pytest.raises(fh.FileFormatError, match=what):
            fh.LidarScan.load(tmp_path / "bad.npz")

    def with_words(**changed):
        return np.array(json.dumps({**said, **changed}))

    refused("lack a lidar", metadata=None)
    refused("lack a lidar", metadata=with_words(sensor=None))
    refused(
        r"\[1099511627776\] columns",
        metadata=with_words(sensor=said["sensor"] | {"columns": 1 << 40}),
    )
    refused(
        "4611686018427387904 x ", metadata=with_words(sensor=said["sensor"] | {"rows": 1 << 62})
    )
    refused("scans have no columns", metadata=with_words(scans=[{}]))
    refused("row must be from 0", metadata=with_words(sensor={**said["sensor"], "rows": 1}))
    refused("column must be from 0", column=np.full_like(good["column"], -1))
    refused("it has no ring", ring=None)
    refused("time must be float64", time=good["time"].astype(np.float32))
    refused(r"point must be float64 of the shape \(\d+, 3\)", point=good["point"][1:])
    with pytest.raises(fh.FileError):
        fh.LidarScan.load(tmp_path / "none.npz")
    with pytest.raises(
        fh.FileFormatError, match=r"good\.ply: a scan is .*; read_points reads \.ply"
    ):
        fh.LidarScan.load(tmp_path / "good.ply")


def test_a_las_says_what_it_is(tmp_path):
    laspy = pytest.importorskip("laspy")
    # So many turns that the metadata are longer than the 64 KiB of a record before the points.
    turn = fh.Lidar.named("vlp-16", columns=2).scan(layers())
    scan = fh.LidarScan.joined([turn] * 400)
    for name in ("a.las", "a.laz") if laspy.LazBackend.detect_available() else ("a.las",):
        scan.save(tmp_path / name)
        records = laspy.read(tmp_path / name).evlrs
        (own,) = (record for record in records if record.user_id == "firsthit")
        assert json.loads(own.record_data) == scan.metadata
    assert len(json.dumps(scan.metadata)) > 1 << 16


@pytest.mark.parametrize(
    ("how", "warns"),
    [
        ({"returns": "all"}, True),
        ({"intensity": True}, True),
        ({}, False),
        ({"returns": "all", "range_gate": 0.2}, False),
        ({"returns": "all", "subrays": 1}, False),
    ],
)
def test_a_cone_without_a_gate_warns_where_it_is_seen(how, warns):
    lidar = fh.Lidar.named("vlp-16", columns=18)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        lidar.scan(layers(), divergence=0.01, **how)
    assert [("range_gate" in str(each.message)) for each in caught] == [True] * warns


def test_rings_count_from_the_lowest_on_request():
    lidar = fh.Lidar.named("vlp-16", columns=9)
    maker, lowest = (lidar.scan(room(), rings=rings) for rings in ("maker", "lowest-first"))
    np.testing.assert_array_equal(maker.ring, lidar.ring.reshape(-1))
    # The maker numbers -15, 1, -13, 3, ...; drivers of ROS number by the angle.
    np.testing.assert_array_equal(lowest.ring, 15 - lowest.row)
    assert lowest.metadata["scan"]["rings"] == "lowest-first"
    assert "rings" not in maker.metadata["scan"]
    raster = fh.Lidar.raster(20, 10, 3, 4).scan(room(), rings="lowest-first")
    np.testing.assert_array_equal(raster.ring, 2 - raster.row)
    table = fh.Lidar([0, 1, 2, 3], [5, -5, 5, 0], rings=[7, 3, 7, 9])
    assert table.scan(room(), rings="lowest-first").ring.tolist() == [2, 0, 2, 1]
    with pytest.raises(ValueError, match="rings must be one of maker, lowest-first, got 'ros'"):
        table.scan(room(), rings="ros")


def test_las_has_the_classes_of_objects(tmp_path):
    laspy = pytest.importorskip("laspy")
    made = layers()
    made.add(fh.Box((-9, -9, -3), (9, 9, -2)), name="ground")
    lidar = fh.Lidar.named("vlp-16", columns=90)
    scan = lidar.scan(made, classes={"ground": 2, 0: 6, 1: 255})
    wanted = np.array([6, 255, 0, 2])[scan.object]
    np.testing.assert_array_equal(scan.classification, wanted)
    assert set(scan.classification.tolist()) == {0, 2, 6, 255}
    for name in ("a.las", "a.npz", "a.ply", "a.pcd"):
        scan.save(tmp_path / name)
    np.testing.assert_array_equal(laspy.read(tmp_path / "a.las").classification, wanted)
    read = fh.LidarScan.load(tmp_path / "a.npz")
    np.testing.assert_array_equal(read.classification, wanted)
    assert fh.read_metadata(tmp_path / "a.ply")["channels"][-1]["name"] == "classification"
    assert lidar.scan(made).classification is None
    for classes, error, message in (
        ({"none": 2}, ValueError, "no object with the name 'none'"),
        ({9: 2}, IndexError, "there is no object 9"),
        ({0: 256}, ValueError, r"classes\[0\] must be from 0 to 255, got 256"),
        ([2], TypeError, "classes must be a dict"),
    ):
        with pytest.raises(error, match=message):
            lidar.scan(made, classes=classes)


def test_hits_of_a_lidar_are_its_scan():
    body = fh.Trajectory([0, 1], [(-2, 0, 0), (2, 0, 0)], body="forwards-left-up")
    lidar = fh.Lidar.named("vlp-16", columns=36, trajectory=body)
    own, scan = fh.LidarScan.from_hits(layers().shoot(lidar)), lidar.scan(layers())
    assert own.keys() == scan.keys()
    assert own.shape == scan.shape
    for name in scan.keys():  # noqa: SIM118 - a scan has no other names
        np.testing.assert_allclose(own[name], scan[name], atol=1e-12, err_msg=name)
    assert own.metadata["sensor"] == scan.metadata["sensor"]


def test_rays_of_one_s_own_make_a_scan_with_its_files(tmp_path):
    made = layers()
    origins = np.array([[0, 0, k] for k in (0, 0.5, 60)], float)
    times, rings = np.array([[0.1, 0.2, 0.3]] * 2), [[5], [6]]
    rays = np.stack([origins, origins + np.array([0, 0.1, 0])]), (2, 0, 0)
    pose = [[0, -1, 0, 1], [1, 0, 0, 0], [0, 0, 1, 0]]
    how = {"time": times, "ring": rings, "intensity": 0.5, "pose": pose, "classes": {0: 4}}
    scan = fh.LidarScan.from_hits(made.shoot(*rays), **how)
    assert scan.shape == (2, 3)
    # The third ray of each row meets nothing.
    assert scan.column.tolist() == [0, 1, 0, 1]
    assert scan.range.tolist() == [4] * 4
    assert scan.ring.tolist() == [5, 5, 6, 6]
    assert scan.time.tolist() == [0.1, 0.2] * 2
    assert scan.intensity.tolist() == [0.5] * 4
    assert scan.classification.tolist() == [4] * 4
    world = scan.sensor_point @ np.array(pose)[:, :3].T + (1, 0, 0)
    np.testing.assert_allclose(world, scan.point, atol=1e-12)
    np.testing.assert_allclose(scan.point[:, 0], 4)
    np.testing.assert_array_equal(np.isinf(scan.to_image()), [[False, False, True]] * 2)
    each = np.broadcast_to(pose, (2, 3, 3, 4))
    again = fh.LidarScan.from_hits(made.shoot(*rays), **{**how, "pose": each})
    np.testing.assert_allclose(again.sensor_point, scan.sensor_point, atol=1e-12)
    for name in ("a.npz", "a.las", "a.ply", "a.pcd", "a.csv"):
        scan.save(tmp_path / name)
    read = fh.LidarScan.load(tmp_path / "a.npz")
    assert read.metadata == scan.metadata
    assert read.metadata["sensor"]["kind"] == "rays"
    assert fh.LidarScan.joined([scan, read]).shape == (2, 6)
    every = fh.LidarScan.from_hits(made.shoot_all(*rays))
    assert every.return_number.tolist()[:6] == [1, 2, 3, 4, 5, 6]
    assert every.number_of_returns.tolist()[:6] == [6] * 6
    assert every.range[:2].tolist() == pytest.approx([4, 4.001])
    one = fh.LidarScan.from_hits(made.shoot((0, 0, 0), (1, 0, 0)))
    assert (one.shape, len(one)) == ((1, 1), 1)
    assert len(fh.LidarScan.from_hits(made.shoot((0, 0, 0), (-1, 0, 0)))) == 0


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"time": [1, 2]}, r"time must broadcast to \(3,\), got \(2,\)"),
        ({"time": np.nan}, "time must be finite"),
        ({"ring": 0.5}, "ring must be whole numbers"),
        ({"ring": -1}, "ring must be whole numbers from 0 on"),
        ({"pose": np.diag([1, 1, 2, 1])}, "pose must be a rotation"),
        ({"pose": np.zeros((2, 4, 4))}, r"pose must have the shape \(4, 4\)"),
        ({"intensity": "a"}, "intensity must be"),
    ],
)
def test_scans_of_rays_of_one_s_own_that_make_no_sense_are_refused(how, message):
    hits = room().shoot([[0, 0, 0]] * 3, (1, 0, 0))
    with pytest.raises(ValueError, match=message):
        fh.LidarScan.from_hits(hits, **how)
    with pytest.raises(ValueError, match="hits must have the shape"):
        fh.LidarScan.from_hits(room().shoot(np.zeros((2, 2, 2, 3)), (1, 0, 0)))
    with pytest.raises(TypeError, match="hits must be Hits"):
        fh.LidarScan.from_hits([1])


def test_scans_that_do_not_fit_are_not_joined():
    one = fh.Lidar.spinning([0, 1], 8).scan(room())
    with pytest.raises(ValueError, match="as many rows, got 2 and 1"):
        fh.LidarScan.joined([one, fh.Lidar.spinning([0], 8).scan(room())])
    with pytest.raises(ValueError, match="the same arrays"):
        fh.LidarScan.joined([one, fh.Lidar.spinning([0, 1], 8).scan(room(), intensity=True)])
    with pytest.raises(ValueError, match="at least one"):
        fh.LidarScan.joined([])
    with pytest.raises(TypeError, match="LidarScan"):
        fh.LidarScan.joined([room()])


def test_a_joined_scan_says_of_what_it_is():
    scans = [fh.Lidar.spinning([0, 1], 8, start=turn).scan(room()) for turn in range(3)]
    joined = fh.LidarScan.joined([fh.LidarScan.joined(scans[:2]), scans[2]])
    expected = [
        {
            "sensor": scan.metadata["sensor"]["digest"],
            "columns": 8,
            "scene": scan.metadata["scene"],
            "scan": scan.metadata["scan"],
        }
        for scan in scans
    ]
    assert joined.metadata["scans"] == expected
    assert len({each["sensor"] for each in expected}) == 1  # times are not in the digest
    assert joined.metadata["sensor"] == scans[0].metadata["sensor"]
    assert "scans" not in scans[0].metadata
    np.testing.assert_array_equal(joined.to_image()[:, 16:], scans[2].to_image())
    assert not joined.column.flags.writeable
