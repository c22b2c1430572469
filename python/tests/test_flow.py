"""Optical flow, scene flow and disparity: closed forms, finite differences and rays anew."""

import copy
import math

import firsthit as fh
import numpy as np
import pytest
from firsthit._sensors.project import project
from support import SQUARE, bumpy_sphere, things, turned

ROWS, COLUMNS = 60, 80


def crowd():
    """Things in front of a wall that is a mesh."""
    scene = things(18, (-4, -3, -6), (4, 3, 2))
    scene.add(fh.Mesh(*SQUARE), name="wall", transform=turned((1, 0, 0), 0.1, (-7, -5, -7), 14))
    return scene


def camera(position=(0.3, 0.2, 6), projection="perspective", ray_start="eye", aim=(0, 0, -1)):
    if projection == "equirectangular":
        return fh.Camera.equirectangular(position, aim, (0.1, 1, 0), ROWS, COLUMNS)
    lengths = (1, 1.6, 1.2) if projection == "perspective" else (1, 16, 12)
    return fh.Camera(position, aim, (0.1, 1, 0), *lengths, ROWS, COLUMNS, projection, ray_start)


def centres():
    return np.stack(np.meshgrid(np.arange(COLUMNS) + 0.5, np.arange(ROWS) + 0.5), axis=-1)


@pytest.mark.parametrize("projection", ["perspective", "orthographic", "equirectangular"])
@pytest.mark.parametrize("ray_start", ["eye", "viewplane"])
def test_where_nothing_moves_nothing_flows_and_no_surface_hides_itself(projection, ray_start):
    if projection == "equirectangular":
        ray_start = "eye"
    scene, view = crowd(), camera(projection=projection, ray_start=ray_start)
    is_hit = scene.shoot(view).object >= 0
    assert 200 < is_hit.sum() < is_hit.size
    for again in (scene, copy.copy(scene), crowd()):
        found = fh.optical_flow(scene, view, again, view)
        np.testing.assert_allclose(found.flow[is_hit], 0, atol=1e-9)
        assert (found.scene_flow[is_hit] == 0).all()
        assert np.isnan(found.flow[~is_hit]).all()
        assert np.isnan(found.scene_flow[~is_hit]).all()
        assert not found.occluded.any()
        assert not found.outside.any()


def test_a_triangle_that_is_seen_from_its_edge_does_not_hide_itself():
    scene, place = fh.Scene(), turned((1, 2, 3), 1, (30, -20, 10))
    scene.add(fh.Mesh(*SQUARE), transform=place)
    start, aim, up = np.array([0.5, -1, 1.5e-6]), np.array([0, 1, -1e-6]), np.array([0, 0, 1])
    start, aim, up = place[:3, :3] @ start + place[:3, 3], place[:3, :3] @ aim, place[:3, :3] @ up
    view = fh.Camera(start, aim, up, 0.1, 0.8, 8e-7, ROWS, COLUMNS, "orthographic")
    assert (scene.shoot(view).object >= 0).all()
    found = fh.optical_flow(scene, view, scene, view)
    assert not found.occluded.any()


def moved_crowd(scene):
    """Return a copy of the scene with each object moved and turned."""
    after, rng = copy.copy(scene), np.random.default_rng(22)
    for k in range(18):
        change = turned(rng.normal(size=3), 0.4, rng.uniform(-0.6, 0.6, 3))
        after.move(k, change @ scene.objects[k].transform)
    return after


@pytest.mark.parametrize("ray_start", ["eye", "viewplane"])
def test_points_are_where_their_objects_and_the_camera_have_moved(ray_start):
    before = crowd()
    after = moved_crowd(before)
    views = camera(ray_start=ray_start), camera((1, -0.2, 5), aim=(-0.1, 0.1, -1))
    hits = before.shoot(views[0])
    found = fh.optical_flow(before, views[0], after, views[1])
    seen = 0
    for row, column in np.argwhere(hits.object >= 0):
        made, at = hits.object[row, column], hits.position[row, column]
        old, new = before.objects[made].transform, after.objects[made].transform
        point = (new @ np.linalg.solve(old, [*at, 1]))[:3]
        np.testing.assert_allclose(found.scene_flow[row, column], point - at, atol=1e-12)
        pixel = np.array([column + 0.5, row + 0.5]) + found.flow[row, column]
        np.testing.assert_allclose(pixel, project(views[1], point), atol=1e-9)
        is_in = (pixel >= 0).all() and (pixel < (COLUMNS, ROWS)).all()
        assert found.outside[row, column] == (not is_in)
        # By rays anew: what is met on the way from the eye, which the point itself ends.
        way = point - views[1].position
        first = after.shoot(views[1].position, way)
        is_seen = float(first.t) > 1 - 1e-9
        assert found.occluded[row, column] == (not is_seen)
        if is_seen:
            assert int(first.object) == made
            seen += 1
    hidden = found.occluded.sum()
    assert seen > 500
    assert hidden > 100
    assert found.outside.sum() > 20


def test_flow_is_the_derivative_that_finite_differences_give():
    before = fh.Scene()
    ball = before.add(fh.Sphere((0.2, 0.1, 0), 1), name="ball")
    view = camera(position=(0, 0, 5))
    velocity, turn = np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.5, -0.3])
    hits = before.shoot(view)
    is_hit = hits.object >= 0
    speed = velocity + np.cross(turn, hits.position[is_hit])
    # The derivative of the projection, by hand: u = f x / z, v = f y / z in the camera's frame.
    axes = np.stack((view.right, -view.upwards, view.aim))
    seen, seen_speed = (hits.position[is_hit] - view.position) @ axes.T, speed @ axes.T
    z = seen[:, 2]
    focal = COLUMNS / 1.6
    rates = focal * (seen_speed[:, :2] - seen[:, :2] / z[:, None] * seen_speed[:, 2:]) / z[:, None]
    assert np.abs(rates).max() > 5
    flows = []
    for step in (1e-4, -1e-4):
        after = copy.copy(before)
        length = np.linalg.norm(turn)
        after.move(ball, turned(turn, length * step, velocity * step))
        flows.append(fh.optical_flow(before, view, after, view).flow[is_hit])
    np.testing.assert_allclose((flows[0] - flows[1]) / 2e-4, rates, atol=1e-5)


def test_points_of_a_mesh_go_with_its_vertices():
    before = fh.Scene()
    vertices, triangles = bumpy_sphere(10, 5)
    place = turned((1, 2, 3), 0.7, (0.2, -0.1, -1), 0.8)
    ball = before.add(fh.Mesh(vertices, triangles), transform=place)
    view = camera(position=(0, 0, 5))
    hits = before.shoot(view)
    is_hit = hits.object >= 0
    after = copy.copy(before)
    # A linear map takes weights along: every point goes where the map takes it.
    change = np.array([[1.2, 0.3, 0], [0, 0.8, 0.1], [0.2, 0, 1.1]])
    after.update_vertices(ball, np.float64(vertices) @ change.T)
    found = fh.optical_flow(before, view, after, view)
    inner = (hits.position[is_hit] - place[:3, 3]) @ np.linalg.inv(place[:3, :3]).T
    points = (inner @ change.T) @ place[:3, :3].T + place[:3, 3]
    np.testing.assert_allclose(found.scene_flow[is_hit], points - hits.position[is_hit], atol=1e-12)
    expected = project(view, points) - centres()[is_hit]
    np.testing.assert_allclose(found.flow[is_hit], expected, atol=1e-9)
    first = after.shoot(view.position, points - view.position)
    np.testing.assert_array_equal(found.occluded[is_hit], first.t < 1 - 1e-9)


@pytest.mark.parametrize("kind", ["shape", "mesh"])
def test_the_far_side_of_what_has_turned_around_is_hidden(kind):
    scene, view = fh.Scene(), camera(position=(0, 0, 5))
    mesh = fh.Mesh(*bumpy_sphere(12, 1))
    scene.add(fh.Sphere((0, 0, 0), 1) if kind == "shape" else mesh, name="ball")
    after = copy.copy(scene)
    after.move("ball", turned((0, 1, 0), math.pi))
    found = fh.optical_flow(scene, view, after, view)
    is_hit = scene.shoot(view).object >= 0
    if kind == "shape":
        np.testing.assert_array_equal(found.occluded, is_hit)
    else:
        assert found.occluded[is_hit].mean() > 0.97
    # In the middle nothing goes sideways.
    assert not found.outside.any()
    middle = found.scene_flow[ROWS // 2, COLUMNS // 2]
    assert middle[2] < -1.3


def test_what_a_moving_card_covers_is_a_strip_of_its_way():
    # A pixel is 0.1 wide, and the card moves by three of them to the right and one down.
    view = fh.Camera((0, 0, 9), (0, 0, -1), (0, 1, 0), 1, 8, 6, ROWS, COLUMNS, "orthographic")
    before = fh.Scene()
    before.add(fh.Box((-9, -9, -1), (9, 9, 0)), name="wall")
    before.add(fh.Box((-1, -1, 1), (1, 1, 2)), name="card")
    after, place = copy.copy(before), np.eye(4)
    place[:3, 3] = 0.3, -0.1, 0
    after.move("card", place)
    found = fh.optical_flow(before, view, after, view)
    card = before.shoot(view).object == 1
    np.testing.assert_allclose(found.flow[card], [[3, 1]] * 400, atol=1e-9)
    np.testing.assert_allclose(found.scene_flow[card], [[0.3, -0.1, 0]] * 400, atol=1e-12)
    covered = np.roll(card, (1, 3), axis=(0, 1)) & ~card
    np.testing.assert_array_equal(found.occluded, covered)
    assert covered.sum() == 400 - 17 * 19


def test_what_is_removed_hidden_or_not_yet_there_is_gone():
    scene, view = crowd(), camera()
    picture = scene.shoot(view).object
    shown = np.unique(picture[picture >= 0])[:2].tolist()
    after = copy.copy(scene)
    after.remove(shown[0])
    after.hide(shown[1])
    found = fh.optical_flow(scene, view, after, view)
    gone = np.isin(picture, shown)
    assert gone.any()
    assert np.isnan(found.flow[gone]).all()
    assert np.isnan(found.scene_flow[gone]).all()
    assert found.occluded[gone].all()
    assert not found.outside[gone].any()
    assert np.isfinite(found.flow[(picture >= 0) & ~gone]).all()
    # A scene with fewer objects has not got the last ones.
    fewer = fh.Scene()
    fewer.add(scene.objects[0].shape, name="thing 0", transform=scene.objects[0].transform)
    found = fh.optical_flow(scene, view, fewer, view)
    np.testing.assert_array_equal(np.isfinite(found.scene_flow[..., 0]), picture == 0)
    np.testing.assert_array_equal(found.occluded, picture > 0)


def test_what_is_behind_the_second_camera_has_no_flow_and_is_outside():
    scene = crowd()
    views = camera(), camera(position=(0, 0, -9))
    found = fh.optical_flow(scene, views[0], scene, views[1])
    is_hit = scene.shoot(views[0]).object >= 0
    assert np.isnan(found.flow).all()
    np.testing.assert_array_equal(found.outside, is_hit)
    assert not found.occluded.any()
    assert (found.scene_flow[is_hit] == 0).all()


def test_other_objects_in_the_place_of_the_same_are_refused():
    scene, view = fh.Scene(), camera()
    scene.add(fh.Mesh(*SQUARE), name="card", transform=turned((0, 0, 1), 0, (-1, -1, 0), 2))
    renamed, other, flipped = fh.Scene(), fh.Scene(), fh.Scene()
    renamed.add(fh.Mesh(*SQUARE), name="sail")
    other.add(fh.Sphere((0, 0, 0), 1), name="card")
    flipped.add(fh.Mesh(SQUARE[0], [[0, 2, 1], [0, 3, 2]]), name="card")
    for after, match in [
        (renamed, "object 0 must be the same in both scenes, got the names 'card' and 'sail'"),
        (other, "object 0 must have the same triangles or the same shape"),
        (flipped, "object 0 must have the same triangles or the same shape"),
    ]:
        with pytest.raises(ValueError, match=match):
            fh.optical_flow(scene, view, after, view)
    with pytest.raises(TypeError, match="a scene must be a Scene, got 1"):
        fh.optical_flow(scene, view, 1, view)
    with pytest.raises(
        TypeError, match="a camera must be a Camera, a RollingShutter or a Pushbroom, got None"
    ):
        fh.optical_flow(scene, view, scene, None)


def test_disparity_is_focal_length_times_baseline_by_z():
    scene, left = crowd(), camera()
    right = camera(position=left.position + 0.4 * left.right)
    found = fh.disparity(scene, left, right)
    z = scene.shoot(left).z
    expected = np.where(np.isfinite(z), COLUMNS / 1.6 * 0.4 / z, np.nan)
    np.testing.assert_allclose(found.disparity, expected, rtol=1e-9)
    flow = fh.optical_flow(scene, left, scene, right)
    np.testing.assert_allclose(found.disparity, -flow.flow[..., 0], atol=1e-9)
    np.testing.assert_allclose(flow.flow[..., 1][np.isfinite(z)], 0, atol=1e-9)
    np.testing.assert_array_equal(found.occluded, flow.occluded)
    np.testing.assert_array_equal(found.outside, flow.outside)
    assert found.occluded.any()
    assert found.outside.any()


def test_a_card_hides_a_strip_of_the_wall_as_wide_as_the_disparities_differ():
    left = fh.Camera((0, 0, 8), (0, 0, -1), (0, 1, 0), 1, 1.6, 1.2, ROWS, COLUMNS, ray_start="eye")
    right = fh.Camera((1, 0, 8), (0, 0, -1), (0, 1, 0), 1, 1.6, 1.2, ROWS, COLUMNS, ray_start="eye")
    scene = fh.Scene()
    scene.add(fh.Box((-99, -99, -1), (99, 99, 0)), name="wall")
    scene.add(fh.Box((-0.99, -0.99, 3.99), (0.99, 0.99, 4)), name="card")
    found = fh.disparity(scene, left, right)
    picture = scene.shoot(left).object
    near, far = 50 / 4, 50 / 8
    np.testing.assert_allclose(found.disparity, np.where(picture == 1, near, far))
    # To the left of the card, which is a little less than 25 columns wide around the middle.
    hidden = centres()[..., 0] - (40 - 0.99 * near)
    rows = np.abs(centres()[..., 1] - 30) < 0.99 * near
    strip = rows & (-(near - far) < hidden) & (hidden < 0)
    np.testing.assert_array_equal(found.occluded, strip)
    np.testing.assert_array_equal(found.outside, centres()[..., 0] - found.disparity < 0)


def test_cameras_that_are_no_pair_are_refused():
    scene, left = crowd(), camera()
    there = left.position + left.right
    for right, match in [
        (camera(there, "orthographic"), "must have the same projection"),
        (camera(there, ray_start="viewplane"), "must have the same ray_start"),
        (camera(there, aim=(0.01, 0, -1)), "must have the same aim"),
        (camera(left.position - left.right), "right must be to the right of left alone"),
        (camera(there + 0.01 * left.upwards), "right must be to the right of left alone"),
        (left, "right must be to the right of left alone"),
    ]:
        with pytest.raises(ValueError, match=match):
            fh.disparity(scene, left, right)
    panorama = camera(projection="equirectangular")
    with pytest.raises(ValueError, match="left and right must be perspective"):
        fh.disparity(scene, panorama, panorama)
