"""The nearest points, against NumPy."""

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, ball, bumpy_sphere


def on_triangles(point, corners):
    """The smallest distance to triangles, by trying all their features."""
    a, b, c = np.moveaxis(corners, 1, 0)

    def to(p, q):
        length = np.maximum(((q - p) ** 2).sum(1), 1e-300)
        share = np.clip(((point - p) * (q - p)).sum(1) / length, 0, 1)
        return np.linalg.norm(p + share[:, None] * (q - p) - point, axis=1)

    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    sides = [(np.cross(q - p, point - p) * normal).sum(1) >= 0 for p, q in ((a, b), (b, c), (c, a))]
    height = np.abs(((point - a) * normal).sum(1))
    edges = np.minimum(np.minimum(to(a, b), to(b, c)), to(c, a))
    return np.where(np.all(sides, axis=0), height, edges)


def test_distances_to_a_mesh_are_those_of_numpy():
    vertices, triangles = bumpy_sphere(8, 3)
    vertices = np.asarray(vertices, float)
    scene = fh.Scene()
    scene.add(fh.Mesh(vertices, triangles), transform=np.diag([2, 1, 0.5, 1.0]))
    points = np.random.default_rng(1).uniform(-2, 2, (300, 3))
    corners = (vertices * [2, 1, 0.5])[np.asarray(triangles)]
    all_of = np.array([on_triangles(point, corners) for point in points])
    found = scene.closest_point(points)
    np.testing.assert_allclose(found.distance, all_of.min(1), rtol=1e-12)
    assert (found.object == 0).all()
    own = corners[found.primitive]
    np.testing.assert_allclose(
        (own * found.barycentric[:, :, None]).sum(1), found.point, atol=1e-14
    )
    np.testing.assert_allclose(np.linalg.norm(found.point - points, axis=1), found.distance)
    several = scene.closest_point(points, k=5)
    np.testing.assert_allclose(several.distance, np.sort(all_of, axis=1)[:, :5], rtol=1e-12)
    assert several.point.shape == (300, 5, 3)
    signed = scene.signed_distance(points)
    np.testing.assert_array_equal(np.abs(signed), found.distance)
    inside = scene.count(points, [0.1, 0.2, 1]) % 2 == 1
    np.testing.assert_array_equal(signed < 0, inside)
    assert 10 < inside.sum() < 290


def test_any_shape_of_array_and_many_points():
    scene = ball()
    one = scene.closest_point((0, 0, 3))
    assert one.distance.shape == ()
    assert one.point.shape == (3,)
    assert float(one.distance) == 2
    grid = np.random.default_rng(2).uniform(-3, 3, (40, 50, 3))
    found = scene.closest_point(grid)
    expected = np.abs(np.linalg.norm(grid, axis=-1) - 1)
    np.testing.assert_allclose(found.distance, expected, atol=1e-15)
    np.testing.assert_array_equal(
        scene.closest_point(grid[::-1, ::2]).distance, found.distance[::-1, ::2]
    )
    np.testing.assert_array_equal(scene.closest_point(grid, threads=1).point, found.point)
    assert scene.closest_point(np.zeros((0, 3)), k=2).point.shape == (0, 2, 3)
    assert np.isnan(found.barycentric).all()


def test_a_radius_includes_itself_and_misses_are_marked():
    found = ball().closest_point([[3, 0, 0], [3.1, 0, 0], [np.nan, 0, 0]], radius=2, k=2)
    np.testing.assert_array_equal(found.object, [[0, -1], [-1, -1], [-1, -1]])
    np.testing.assert_array_equal(found.distance, [[2, np.inf], [np.inf] * 2, [np.inf] * 2])
    assert np.isnan(found.point[1:]).all()


def test_progress_is_in_points():
    told = []
    ball().closest_point(
        np.zeros((5000, 3)), progress=lambda done, total: told.append((done, total))
    )
    assert told[-1] == (5000, 5000)
    told.clear()
    ball().signed_distance(np.zeros((5000, 3)), progress=lambda *told_now: told.append(told_now))
    assert told[-1] == (5000, 5000)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"k": 0}, "k must be from 1"),
        ({"k": 1.5}, "k must be a whole number"),
        ({"k": True}, "k must be a whole number, got True"),
        ({"radius": "0.5"}, "radius must be a number, got '0.5'"),
        ({"radius": True}, "radius must be a number, got True"),
        ({"radius": -1}, "radius must be zero or positive"),
        ({"radius": float("nan")}, "radius must be zero or positive"),
        ({"radius": "far"}, "radius must be a number"),
    ],
)
def test_what_makes_no_sense_is_refused(options, words):
    with pytest.raises(ValueError, match=words):
        ball().closest_point([0, 0, 3], **options)


def test_points_that_are_none_and_objects_that_cannot_be_measured():
    with pytest.raises(ValueError, match=r"points must have the shape \(\.\.\., 3\)"):
        ball().closest_point([1, 2])
    scene = fh.Scene()
    scene.add(fh.Mesh(*SQUARE), name="sheet")
    with pytest.raises(ValueError, match=r'open one: object 0 \(mesh "sheet"\)'):
        scene.signed_distance([0, 0, 1])
    scene = fh.Scene()
    scene.add(fh.Cylinder((0, 0, 0), (0, 0, 1), 1), transform=np.diag([1, 2, 1, 1.0]))
    with pytest.raises(ValueError, match="uniform scale"):
        scene.closest_point([0, 0, 1])
