"""Lines of sight and thickness: closed forms, and the same answers by other calls."""

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, ball, bumpy_sphere

RNG = np.random.default_rng(8)


def test_points_see_each_other_where_the_segment_misses_the_ball():
    a, b = RNG.uniform(-3, 3, (2, 4000, 3))
    way = b - a
    # Where the line is nearest to the middle, within the segment.
    t = np.clip(-(a * way).sum(-1) / (way * way).sum(-1), 0, 1)
    apart = np.linalg.norm(a + t[:, None] * way, axis=-1) > 1
    inside = (np.linalg.norm(a, axis=-1) < 1) & (np.linalg.norm(b, axis=-1) < 1)
    seen = ball().visible(a, b)
    np.testing.assert_array_equal(seen, apart | inside)
    np.testing.assert_array_equal(ball().visible(b, a), seen)
    assert 0 < seen.sum() < 4000


def test_all_pairs_are_a_symmetric_matrix():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(15, 4)))
    points = np.vstack([RNG.uniform(-2, 2, (800, 3)), [[np.nan, 0, 0], [np.inf, 0, 0]]])
    seen = scene.visible(points[:, None], points)
    assert seen.shape == (802, 802)
    np.testing.assert_array_equal(seen, seen.T)
    assert seen.diagonal()[:800].all()
    assert not seen[800:].any()
    part = scene.visible(points[700], points)
    np.testing.assert_array_equal(part, seen[700])


def test_the_surfaces_at_the_ends_hide_nothing():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(20, 6)))
    eye = np.array([5.0, 1, 2])
    targets = RNG.uniform(-0.5, 0.5, (5000, 3))
    hits = scene.shoot(eye, targets - eye)
    assert (hits.object >= 0).all()
    assert scene.visible(hits, eye).all()
    assert scene.visible(eye, hits).all()
    surfaces = hits.object, hits.primitive
    assert scene.visible(hits.position, eye, skip_a=surfaces).all()
    # Rounded, some lie behind what they are on.
    assert scene.visible(hits.position, eye).all()
    # What they are on hides them from a little farther away, unless it is skipped.
    behind = hits.position - 1e-9 * hits.normal
    assert not scene.visible(behind, eye).any()
    assert scene.visible(behind, eye, skip_a=surfaces).mean() > 0.99
    # From behind, all are hidden.
    behind = -20 * eye
    far = scene.shoot(behind, hits.position - behind)
    hidden = far.primitive != hits.primitive
    np.testing.assert_array_equal(scene.visible(hits[hidden], behind), np.zeros(hidden.sum(), bool))


def test_wrong_ends_are_refused():
    scene = ball()
    hits = scene.shoot([[0, 0, 5]], [0, 0, -1])
    for a, b, kept, match in [
        ([1, 2], [0, 0, 0], {}, "a must have the shape"),
        ([0, 0, 0], [[0, 0]], {}, "b must have the shape"),
        (np.zeros((2, 3)), np.zeros((3, 3)), {}, "must broadcast"),
        (np.zeros((2, 3)), np.zeros(3), {"skip_b": ([0] * 3, 0)}, "must broadcast"),
        (hits, [0, 0, 0], {"skip_a": (0, 0)}, "skip_a must be left out"),
        ([0, 0, 0], [0, 0, 1], {"skip_a": 0}, "skip_a must be a pair"),
    ]:
        with pytest.raises(ValueError, match=match):
            scene.visible(a, b, **kept)


def test_more_pairs_than_go_at_a_time_are_followed():
    points = RNG.uniform(-2, 2, (800, 3))
    calls = []
    seen = ball().visible(points[:, None], points, progress=lambda *done: calls.append(done))
    assert calls[-1] == (640_000, 640_000)
    np.testing.assert_array_equal(seen[799], ball().visible(points[799], points))


def test_thickness_is_that_of_balls_and_boxes_and_shells():
    scene = ball()
    there = np.eye(4)
    there[0, 3] = 10
    scene.add(fh.Box((-1, -2, -3), (1, 2, 3)), transform=there)
    hits = scene.shoot([[0, 0, 5], [10.5, 0.25, 9], [10, 0, 0.5], [5, 0, 9]], [0, 0, -1])
    np.testing.assert_array_equal(scene.thickness(hits), [2, 6, 6, np.nan])
    points = [[0, 0, 1], [11, 0.5, 0.5], [10, -2, 1], [np.nan, 0, 0]]
    np.testing.assert_array_equal(scene.thickness(points), [2, 2, 4, np.nan])
    # Along other directions, of any length.
    slanted = scene.thickness([[11, 0, 0]], [[-3, 0, 0], [-2, -2, 0], [1, 0, 0]])
    np.testing.assert_allclose(slanted, [2, np.sqrt(8), np.inf], rtol=1e-15)
    assert scene.thickness(np.zeros((4, 0, 3))).shape == (4, 0)


def test_what_is_embedded_does_not_count():
    scene = fh.Scene()
    scene.add(fh.Box((-2, -2, -2), (2, 2, 2)))
    scene.add(fh.Sphere((0, 0, 0), 1))
    scene.add(fh.Mesh(*SQUARE))
    points = np.array([[0.5, 0.25, 2], [1.5, 0.5, 2], [0, 0, -2]])
    np.testing.assert_array_equal(scene.thickness(points), [4, 4, 4])
    np.testing.assert_array_equal(scene.thickness([[0, 0, 0.999]]), [2])
    assert float(scene.thickness([0.5, 0.25, 2])) == 4
    # A sheet has nothing behind it.
    np.testing.assert_array_equal(scene.thickness([[0.5, 0.25, 0.01]]), [np.inf])


def test_the_thickness_at_a_triangle_without_an_area_is_nan():
    scene = fh.Scene()
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    scene.add(fh.Mesh(corners, [[0, 1, 0], [0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    thick = scene.thickness([[0.5, -1, -1], [0.25, 0.25, -1]])
    np.testing.assert_array_equal(thick, [np.nan, 0.5])


def test_the_thickness_of_a_bumpy_mesh_is_where_a_ray_next_meets_it():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(20, 9)))
    hits = scene.shoot(*(np.float64([[0, 0, 5]]), RNG.uniform(-1, 1, (3000, 3)) - [0, 0, 5]))
    hits = hits[hits.object >= 0]
    thick = scene.thickness(hits)
    assert np.isfinite(thick).all()
    # From a point that is a little way in, the same.
    h = 1e-9
    inner = scene.shoot(hits.position - h * hits.normal, -hits.normal)
    np.testing.assert_allclose(thick, inner.t + h, atol=1e-12)


def test_hits_on_objects_that_are_not_asked_for_have_no_thickness():
    scene = ball()
    scene.add(fh.Box((4, -1, -1), (6, 1, 1)), name="box")
    hits = scene.shoot([[0, 0, 9], [5, 0, 9], [9, 9, 9]], [0, 0, -1])
    np.testing.assert_array_equal(scene.thickness(hits, objects="box"), [np.inf, 2, np.nan])
    assert scene.thickness([5, 0, 9], objects="box") == 2


def test_points_a_float32_step_inside_a_wall_see_each_other_with_a_tolerance():
    rng = np.random.default_rng(5)
    on = rng.normal(size=(500, 3))
    on = (on / np.linalg.norm(on, axis=-1, keepdims=True)).astype(np.float32)
    outside = 3.0 * on.astype(float)
    exactly = ball().visible(on, outside)
    assert 0 < exactly.sum() < 500
    assert ball().visible(on, outside, tolerance=1e-6).all()
    assert ball().visible(outside, on, tolerance=1e-6).all()
    assert not ball().visible(-outside, outside, tolerance=1.9).any()
    for wrong in (-1, np.nan, np.inf):
        with pytest.raises(ValueError, match="tolerance must be 0 or more, and finite, got"):
            ball().visible(on, outside, tolerance=wrong)
