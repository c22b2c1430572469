"""Laser scanners against closed forms."""

import pickle
import statistics
import warnings

import firsthit as fh
import numpy as np
import pytest
from lidar_support import layers, room


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


def test_hits_of_a_lidar_are_its_scan():
    body = fh.Trajectory([0, 1], [(-2, 0, 0), (2, 0, 0)], body="forwards-left-up")
    lidar = fh.Lidar.named("vlp-16", columns=36, trajectory=body)
    own, scan = fh.LidarScan.from_hits(layers().shoot(lidar)), lidar.scan(layers())
    assert own.keys() == scan.keys()
    assert own.shape == scan.shape
    for name in scan.keys():  # noqa: SIM118 - a scan has no other names
        np.testing.assert_allclose(own[name], scan[name], atol=1e-12, err_msg=name)
    assert own.metadata["sensor"] == scan.metadata["sensor"]
