"""Flow and disparity of cameras that move while they see: closed forms, and every line tried."""

import copy

import firsthit as fh
import numpy as np
import pytest
from firsthit._sensors.lines import Lines, sight
from support import turned
from test_flow import crowd, moved_crowd

ROWS, COLUMNS = 48, 64
DIRECTIONS = ["top_down", "bottom_up", "left_right", "right_left"]


def view(rows=ROWS, columns=COLUMNS, position=(0, 0, 0)):
    """A camera that looks along -z, with a focal length of half its columns."""
    size = 2.0, 2.0 * rows / columns
    aim, up = (0, 0, -1), (0, 1, 0)
    return fh.Camera(position, aim, up, 1, *size, rows, columns, ray_start="eye")


def shaken(seed, speed=0.4, interpolation="spline", offset=(0, 0, 0)):
    """A body that moves and turns in all directions, from 0 to 1 s, around (0.3, 0.2, 6)."""
    rng = np.random.default_rng(seed)
    matrices = np.array(
        [
            turned(rng.normal(size=3), speed * rng.uniform(0, 0.2), place)
            for place in np.add((0.3, 0.2, 6), offset) + speed * rng.normal(size=(5, 3))
        ]
    )
    return fh.Trajectory.from_matrices(np.linspace(0, 1, 5), matrices, interpolation=interpolation)


def rolling(drive, direction="top_down", start=0.1, readout=0.8, camera=None):
    camera = camera or view()
    return fh.RollingShutter(camera, drive, start=start, readout=readout, direction=direction)


def swept(drive, times, columns=COLUMNS):
    return fh.Pushbroom(view(1, columns), drive, times)


def centres(rows=ROWS, columns=COLUMNS):
    return np.stack(np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5), axis=-1)


def cameras():
    """Moving cameras of all kinds, each with what its name says."""
    made = {name: rolling(shaken(3), name) for name in DIRECTIONS}
    made |= {f"{name} linear": rolling(shaken(4, interpolation="linear"), name) for name in made}
    made["at once"] = rolling(shaken(3), readout=0)
    made["one line"] = rolling(shaken(3), camera=view(1))
    sweep = fh.Trajectory([0, 1], [(0, -4, 6), (0, 4, 6.5)])
    made["pushbroom"] = swept(sweep, np.linspace(0, 1, 90))
    made["pushbroom backwards"] = swept(sweep, np.linspace(1, 0, 20))
    made["pushbroom unequal"] = swept(sweep, np.linspace(0, 1, 40) ** 2)
    made["one row"] = swept(sweep, [0.5])
    return made


@pytest.mark.parametrize("name", cameras())
def test_where_nothing_moves_nothing_flows(name):
    scene, camera = crowd(), cameras()[name]
    is_hit = scene.shoot(camera).object >= 0
    assert is_hit.sum() > 20
    found = fh.optical_flow(scene, camera, scene, camera)
    np.testing.assert_allclose(found.flow[is_hit], 0, atol=1e-8)
    assert np.isnan(found.flow[~is_hit]).all()
    assert not found.occluded.any()
    assert not found.outside.any()
    assert (found.scene_flow[is_hit] == 0).all()


def wall(depth):
    scene = fh.Scene()
    scene.add(fh.Box((-99, -99, -depth - 1), (99, 99, -depth)), name="wall")
    return scene


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_wall_flows_past_a_camera_that_moves_along_it_as_the_formula_says(direction):
    """With the speed v, the focal length f and the depth d, a point goes by f v / d in a second.

    While its line is waited for, the point goes on: the sum is that of a geometric series.
    """
    velocity, depth, readout, later = np.array([0.7, -0.4, 0.0]), 5.0, 0.9, 0.3
    times = np.array([0.0, 4.0])
    drive = fh.Trajectory(times, times[:, None] * velocity)
    scene, focal = wall(depth), COLUMNS / 2
    before, after = (rolling(drive, direction, start, readout) for start in (1.0, 1.0 + later))
    found = fh.optical_flow(scene, before, scene, after)
    # In pixels a second, to the right and down.
    speed = focal / depth * np.array([-velocity[0], velocity[1]])
    axis = 1 if direction in ("top_down", "bottom_up") else 0
    lines = (COLUMNS, ROWS)[axis]
    sign = 1 if direction in ("top_down", "left_right") else -1
    # Between the sights passes the time later + sign * flow along the axis / lines * readout.
    time = later / (1 - sign * speed[axis] / lines * readout)
    flow = speed * time
    pixels = centres() + flow
    inner = (pixels[..., axis] > 0.5) & (pixels[..., axis] < lines - 0.5)
    assert 0.9 < inner.mean() < 1
    np.testing.assert_allclose(found.flow[inner], np.tile(flow, (inner.sum(), 1)), atol=1e-9)
    assert np.abs(flow).min() > 0.5
    # Less than half a line from the border, and beyond it, the camera stands.
    np.testing.assert_allclose(found.flow[~inner], np.tile(flow, ((~inner).sum(), 1)), atol=0.3)
    is_in = (pixels > 0.3).all(axis=-1) & (pixels < np.subtract((COLUMNS, ROWS), 0.3)).all(axis=-1)
    assert not found.outside[is_in].any()
    is_out = (pixels < -0.3).any(axis=-1) | (pixels > np.add((COLUMNS, ROWS), 0.3)).any(axis=-1)
    assert found.outside[is_out].all()
    assert is_out.any()


def test_beyond_the_border_the_camera_stands_as_at_its_first_line():
    """A camera that sinks ever faster, so that no formula for all lines could hold there."""
    drive = fh.Trajectory([0, 1, 2], [(0, 0, 0), (0, -1, 0), (0, -3, 0)])
    camera = rolling(drive, start=0.5, readout=1)
    point = np.array([[0.2, 1.9, -2.0]])
    pose = drive.at(camera.times[0])
    expected = camera.camera.moved(pose).project(point)
    assert expected[0, 1] < 0
    np.testing.assert_allclose(sight(camera, point).pixels, expected, atol=1e-12)


def by_every_line(camera, point):
    """Where a point passes a line, by cameras that stand at each: the lines and pixels before."""
    times = camera.times
    by_rows = camera.reads_rows
    is_backwards = camera.direction in ("bottom_up", "right_left")
    order = range(len(times))[::-1] if is_backwards else range(len(times))
    off = []
    for line in order:
        stands = camera.camera.moved(camera.trajectory.at(times[line]))
        off.append(stands.project(point)[1 if by_rows else 0] - (line + 0.5))
    off = np.array(off) * (-1 if is_backwards else 1)
    return np.flatnonzero((off[1:] > 0) != (off[:-1] > 0)), off


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("speed", [0.4, 6])
def test_points_are_in_the_first_line_that_every_line_tried_finds(direction, speed):
    rng = np.random.default_rng(5)
    before, camera = crowd(), rolling(shaken(8, speed), direction)
    after = moved_crowd(before)
    # It stays with the things, and sees them from afar.
    still = view(position=(0.3, 0.2, 7))
    found = fh.optical_flow(before, still, after, camera)
    pixels = centres() + found.flow
    points = before.shoot(still).position + found.scene_flow
    axis = 1 if direction in ("top_down", "bottom_up") else 0
    lines = (COLUMNS, ROWS)[axis]
    is_backwards = direction in ("bottom_up", "right_left")
    inner = several = 0
    for row, column in rng.permutation(np.argwhere(np.isfinite(points[..., 0])))[:150]:
        passed, off = by_every_line(camera, points[row, column])
        pixel = pixels[row, column]
        if np.isnan(pixel).any():
            assert len(passed) == 0
            continue
        number = lines - pixel[axis] if is_backwards else pixel[axis]
        # The camera as it is at the time of that place sees the point there.
        ordered = np.sort(camera.times)
        time = np.interp(number, np.arange(lines) + 0.5, ordered)
        stands = camera.camera.moved(camera.trajectory.at(time))
        np.testing.assert_allclose(stands.project(points[row, column]), pixel, atol=1e-6)
        is_in = (pixel >= 0).all() and (pixel < (COLUMNS, ROWS)).all()
        assert found.outside[row, column] == (not is_in)
        if not is_in:
            continue
        inner += 1
        several += len(passed) > 1
        if 0.5 < number < lines - 0.5 and off[0] > 0:
            # No earlier one is in the picture.
            across = (ROWS, COLUMNS)[axis]
            for line in passed:
                if line + 1.5 < number:
                    early = np.interp(line + 1, np.arange(lines) + 0.5, ordered)
                    there = camera.camera.moved(camera.trajectory.at(early))
                    beside = there.project(points[row, column])[1 - axis]
                    assert not 1 < beside < across - 1
            assert any(
                line + 0.5 <= number + 1e-9 and number <= line + 1.5 + 1e-9 for line in passed
            )
        # What hides it does so from where the camera is at that time.
        way = points[row, column] - stands.position
        first = float(after.shoot(stands.position, way).t)
        assert found.occluded[row, column] == (first < 1 - 1e-9)
    assert inner > 20
    assert speed == 0.4 or several > 3


def jumpy(aside):
    """A camera before a point that passes its line at the places 13 1/3, 28 and 52.

    The row at which the point is seen is 20 at the place 0, 10 at 20, 55 at 40, and 50 at 60; it is
    aside until the place 20, and there from 40 on.
    """
    rows, focal, depth = 60, 32, 4.0
    at = np.array([20.0, 10.0, 55.0, 50.0])
    y = (at - rows / 2) * depth / focal
    x = np.array([aside, aside, 0, 0])
    drive = fh.Trajectory([0, 20, 40, 60], np.stack([x, y, 0 * y], axis=-1), extrapolation="hold")
    return rolling(drive, start=0, readout=60, camera=view(rows)), np.array([[0.0, 0.0, -depth]])


def test_of_several_sights_the_first_in_the_picture_is_taken():
    camera, point = jumpy(aside=0)
    np.testing.assert_allclose(sight(camera, point).pixels, [[32, 40 / 3]], atol=1e-9)
    camera, point = jumpy(aside=99)
    np.testing.assert_allclose(sight(camera, point).pixels, [[32, 52]], atol=1e-9)
    # Where no sight is in the picture, it is the first beyond the border.
    point[0, 0] = 90
    place = sight(camera, point).pixels
    np.testing.assert_allclose(place, [[32 - 9 * 8, 40 / 3]], atol=1e-9)


def lifted(times, rows, interpolation="linear"):
    """A picture of 6000 lines, a second each, and a point that is in some rows at some times."""
    times, up = np.array(times), (np.array(rows) - 3000.0) / 32
    places = np.stack([0 * times, up, 0 * times], axis=-1)
    drive = fh.Trajectory(times, places, interpolation=interpolation, extrapolation="hold")
    return rolling(drive, start=0, readout=6000, camera=view(6000)), np.array([[0.0, 0.0, -1.0]])


def test_the_pass_of_a_moment_is_found_between_many_lines():
    camera, point = lifted([0, 3190.2, 3191.5, 3193, 6000], [8000, 8000, 3186, 8000, 8000])
    share = (8000 - 3190.2) / (8000 - 3186 + 1.3)
    place = sight(camera, point).pixels[0]
    assert place[1] == pytest.approx(3190.2 + 1.3 * share, abs=1e-6)


def test_a_curve_that_passes_between_poses_is_found():
    """Between two of its poses, at 5 rows before the line, the spline swings 6 rows behind it."""
    times = np.array([375.5, 750.5, 1125.5, 1500.5])
    camera, point = lifted(times, np.add(times, [100, 5, 5, 100]), "spline")
    place = sight(camera, point).pixels[0]
    assert 751 < place[1] < 938
    stands = camera.camera.moved(camera.trajectory.at(place[1]))
    np.testing.assert_allclose(stands.project(point), [place], atol=1e-6)


def test_a_jump_over_a_line_is_no_sight_in_it():
    """A panorama turns so that a point is always 50 columns before its line, or 10 behind it."""
    panorama = fh.Camera.equirectangular((0, 0, 0), (0, 0, -1), (0, 1, 0), 30, 60)
    angles = np.linspace(0, 2 * np.pi, 13)
    drive = fh.Trajectory.from_matrices(
        np.linspace(0, 60, 13), [turned((0, 1, 0), angle) for angle in angles]
    )
    camera = rolling(drive, "left_right", 0, 60, panorama)
    right = np.radians(120)
    point = 5 * np.array([[np.sin(right), 0.1, -np.cos(right)]])
    columns = [panorama.moved(drive.at(t)).project(point)[0, 0] for t in camera.times]
    off = np.array(columns) - camera.times
    np.testing.assert_allclose(off[:9], 50, atol=1e-9)
    np.testing.assert_allclose(off[11:], -10, atol=1e-9)
    assert np.isnan(sight(camera, point).pixels).all()


def test_a_turning_panorama_passes_its_seam():
    camera = fh.Camera.equirectangular((0, 0, 0), (0, 0, -1), (0, 1, 0), 30, 60)
    matrices = [turned((0, 1, 0), 0.8 * k) for k in range(6)]
    drive = fh.Trajectory.from_matrices(range(6), matrices)
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 5))
    for direction in DIRECTIONS:
        panorama = rolling(drive, direction, 0, 5, camera)
        found = fh.optical_flow(scene, panorama, scene, panorama)
        # A point that the turning camera sees twice is told at its first sight.
        is_first = np.abs(found.flow).max(axis=-1) < 1e-6
        assert is_first.mean() > 0.4
        rays = panorama.rays()[1].reshape(-1, 3)
        places = sight(panorama, 5 * rays).pixels
        assert np.isfinite(places).all()
        times = np.sort(panorama.times)
        axis = 1 if direction in ("top_down", "bottom_up") else 0
        lines = (60, 30)[axis]
        number = places[:, axis]
        if direction in ("bottom_up", "right_left"):
            number = lines - number
        seen = np.interp(number, np.arange(lines) + 0.5, times)
        assert (seen <= panorama._times().reshape(-1) + 1e-6).all()
        for place, time, ray in list(zip(places, seen, rays, strict=True))[::37]:
            stands = camera.moved(drive.at(time))
            np.testing.assert_allclose(stands.project(5 * ray), place, atol=1e-6)


def test_a_pushbroom_sees_each_point_when_it_is_above_it():
    """A flight along y at the height h: the row is y by the speed, the column f x / h."""
    speed, height, rate = 3.0, 8.0, 40.0
    flight = fh.Trajectory([0, 9], [(0, 0, height), (0, 9 * speed, height)])
    scene = fh.Scene()
    scene.add(fh.Box((-99, -99, -9), (99, 99, 0)), name="ground")
    scene.add(fh.Box((-1, 2, 0), (1.3, 4, 3)), name="house")
    times = np.arange(100) / rate
    first, second = swept(flight, times), swept(flight, times + 0.11)
    found = fh.optical_flow(scene, first, scene, second)
    np.testing.assert_allclose(found.flow[5:, :, 1], -0.11 * rate, atol=1e-8)
    np.testing.assert_allclose(found.flow[5:, :, 0], 0, atol=1e-8)
    assert not found.outside[5:].any()
    # The second one has not seen the first four rows at all, but for half a row.
    assert np.isnan(found.flow[:4]).all()
    assert found.outside[:4].all()
    assert not found.occluded[:4].any()
    # A house that drives on along the flight is seen later, and one that rises is larger.
    after, up = copy.copy(scene), np.eye(4)
    up[:3, 3] = 0.1, 0.6, 0.5
    after.move("house", up)
    hits = scene.shoot(first)
    moved = fh.optical_flow(scene, first, after, first)
    point = hits.position + moved.scene_flow
    roof = (hits.object == 1) & (hits.position[..., 2] > 2.9)
    assert roof.sum() > 100
    column = COLUMNS / 2 + COLUMNS / 2 * point[..., 0] / (height - point[..., 2])
    row = point[..., 1] / speed * rate + 0.5
    expected = np.stack((column, row), axis=-1) - centres(100)
    np.testing.assert_allclose(moved.flow[roof], expected[roof], atol=1e-8)
    # Straight below, nothing hides the ground along the flight; the walls to the sides do.
    ground = hits.object == 0
    x, y = hits.position[..., 0], hits.position[..., 1]
    edge = np.where(x > 0.1, 1.4 / (height - 3.5), -0.9 / (height - 3.5)) * height
    hidden = ground & (y > 2.6) & (y < 4.6) & (np.abs(x) < np.abs(edge)) & (x * edge > 0)
    np.testing.assert_array_equal(moved.occluded & ground, hidden)
    assert hidden.sum() > 20


def test_times_of_a_pushbroom_that_go_to_and_fro_have_no_row_for_a_point():
    scene, flight = crowd(), fh.Trajectory([0, 9], [(0, 0, 8), (0, 9, 8)])
    camera = swept(flight, [0, 2, 1])
    assert scene.shoot(camera).shape == (3, COLUMNS)
    with pytest.raises(ValueError, match="times of a Pushbroom must increase from row to row"):
        fh.optical_flow(scene, camera, scene, camera)
    # As the first camera it only shows points.
    found = fh.optical_flow(scene, camera, scene, view(position=(0, 0, 8)))
    assert np.isfinite(found.flow).any()


def test_far_from_the_origin_places_are_as_exact_as_coordinates():
    offset = np.array([4e6, -3e6, 5e5])
    camera = rolling(shaken(3, offset=offset))
    origins, directions = camera.rays()
    found = sight(camera, origins + 4 * directions)
    np.testing.assert_allclose(found.pixels, centres(), atol=1e-6)


def moving_pair(kind, direction="top_down"):
    left, right = view(position=(-0.2, 0.1, 0)), view(position=(0.2, 0.1, 0))
    if kind == "rolling":
        drive = shaken(6)
        return tuple(rolling(drive, direction, camera=each) for each in (left, right))
    sweep = fh.Trajectory([0, 1], [(0, -4, 6), (0, 4, 6.5)])
    times = np.linspace(0, 1, 80)
    rows = (view(1, position=each.position) for each in (left, right))
    return tuple(fh.Pushbroom(each, sweep, times) for each in rows)


@pytest.mark.parametrize("kind", ["rolling", "pushbroom"])
def test_the_disparity_of_a_moving_pair_is_that_of_each_row(kind):
    scene, (left, right) = crowd(), moving_pair(kind)
    found = fh.disparity(scene, left, right)
    hits = scene.shoot(left)
    is_hit = hits.object >= 0
    expected = np.where(is_hit, COLUMNS / 2 * 0.4 / hits.z, np.nan)
    np.testing.assert_allclose(found.disparity, expected, rtol=1e-9)
    flow = fh.optical_flow(scene, left, scene, right)
    # A point that is seen in one row only is there in both.
    same = is_hit & (np.abs(flow.flow[..., 1]) < 0.5)
    assert same.sum() > 0.9 * is_hit.sum()
    np.testing.assert_allclose(found.disparity[same], -flow.flow[..., 0][same], atol=1e-8)
    np.testing.assert_array_equal(found.occluded[same], flow.occluded[same])
    for row, column in np.argwhere(is_hit)[::17]:
        stands = right.camera.moved(right.trajectory.at(right.times[row]))
        way = hits.position[row, column] - stands.position
        first = float(scene.shoot(stands.position, way).t)
        assert found.occluded[row, column] == (first < 1 - 1e-9)
        u = column + 0.5 - found.disparity[row, column]
        assert found.outside[row, column] == (not 0 <= u < COLUMNS)
    assert found.occluded.any()


def test_moving_cameras_that_are_no_pair_are_refused():
    scene, (left, right) = crowd(), moving_pair("rolling")
    drive, camera = shaken(6), right.camera
    assert fh.disparity(scene, left, rolling(drive, camera=camera)).disparity.shape == left.shape
    sideways = moving_pair("rolling", "left_right")
    for pair, match in [
        ((left, camera), "of the same type, got RollingShutter and Camera"),
        ((left, moving_pair("pushbroom")[1]), "of the same type"),
        (sideways, "must be read out by rows"),
        ((left, rolling(drive, start=0.11, camera=camera)), "their rows at the same times"),
        ((left, rolling(drive, "bottom_up", camera=camera)), "their rows at the same times"),
        ((left, rolling(shaken(7), camera=camera)), "must have the same trajectory"),
        ((right, left), "right must be to the right of left alone"),
    ]:
        with pytest.raises(ValueError, match=match):
            fh.disparity(scene, *pair)


def test_roots_of_a_smooth_drive_take_few_projections(monkeypatch):
    """Bisection would take some thirty: that of the Illinois method is of order 1.44."""
    projected = []
    whole = Lines._pixels
    monkeypatch.setattr(
        Lines,
        "_pixels",
        lambda self, points, at: projected.append(len(at)) or whole(self, points, at),
    )
    rng = np.random.default_rng(5)
    points = rng.uniform(-2, 2, (2000, 3))
    camera = rolling(shaken(3))
    assert np.isfinite(sight(camera, points).pixels).all(axis=1).sum() > 1000
    assert sum(projected) < 8 * len(points)


def test_times_of_a_pushbroom_matter_only_where_a_row_is_searched_for():
    drive = fh.Trajectory([0, 1], [(0, -4, 6), (0, 4, 6.5)])
    camera = swept(drive, [0.1, 0.1, 0.5, 0.3])
    scene = crowd()
    found = fh.annotate(scene, camera)
    assert found is not None
    right = fh.Pushbroom(view(1, position=(0.1, 0, 0)), drive, camera.times)
    fh.disparity(scene, camera, right)
    with pytest.raises(ValueError, match="times of a Pushbroom must increase"):
        fh.optical_flow(scene, camera, scene, camera)
