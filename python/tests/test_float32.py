"""Distances are float64 whatever the rays are, and float32 for those who ask for it."""

import pickle

import firsthit as fh
import numpy as np
import pytest
from support import ball, bumpy_sphere

SMALLEST = np.finfo(np.float32).smallest_subnormal
LARGEST = np.finfo(np.float32).max
CAMERA = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 30, rows=30, columns=40)


def wall(z):
    scene = fh.Scene()
    scene.add(fh.Plane((0, 0, z), (0, 0, 1)))
    return scene


@pytest.mark.parametrize("dtype", ["f2", "f4", "f8", "i4", ">f4", "i8"])
def test_distances_are_float64_for_rays_of_every_type(dtype):
    origins = np.array([[0, 0, 5], [1, 1, 4]], dtype)
    hits = ball().shoot(origins, np.array([[0, 0, -1]], dtype))
    assert hits.t.dtype == np.float64
    assert hits[:1].t.dtype == np.float64


def test_single_rays_that_go_on_from_t_do_not_meet_the_same_triangle_again():
    points, triangles = bumpy_sphere(40, 1)
    scene = fh.Scene()
    scene.add(fh.Mesh(points, triangles))
    rng = np.random.default_rng(1)
    origins = rng.uniform(-3, 3, (20000, 3)).astype(np.float32)
    directions = (rng.uniform(-0.5, 0.5, (20000, 3)) - origins).astype(np.float32)
    first = scene.shoot(origins, directions)
    met = first.object == 0
    on = scene.shoot(origins[met], directions[met], t_min=first.t[met])
    assert (on.primitive != first.primitive[met]).all()


def test_asked_for_distances_are_the_nearest_float32_and_the_rest_stays_float64():
    rng = np.random.default_rng(4)
    origins, targets = rng.uniform(-3, 3, (2, 5000, 3))
    expected = ball().shoot(origins, targets - origins)
    hits = ball().shoot(origins, targets - origins, dtype=np.float32)
    assert hits.t.dtype == np.float32
    np.testing.assert_array_equal(hits.t, expected.t.astype(np.float32))
    np.testing.assert_array_equal(hits.position, expected.position)
    assert hits.position.dtype == np.float64
    some = pickle.loads(pickle.dumps(hits))[10:20]
    np.testing.assert_array_equal(some.t, hits.t[10:20])
    assert some.t.dtype == np.float32
    t, _ = hits
    assert t.dtype == hits.to_dict("t")["t"].dtype == np.float32


@pytest.mark.parametrize("dtype", [np.float32, "f4", np.dtype("float32")])
def test_a_camera_s_distances_are_of_one_type(dtype):
    hits, expected = ball().shoot(CAMERA, dtype=dtype), ball().shoot(CAMERA)
    for name in ("t", "range", "z"):
        for some, all_of_it in ((hits, expected), (hits[3:5], expected[3:5])):
            assert some.channel(name).dtype == np.float32
            rounded = all_of_it.channel(name).astype(np.float32)
            np.testing.assert_array_equal(some.channel(name), rounded)


def test_float64_may_be_asked_for_and_nothing_else():
    for dtype in (None, np.float64, "f8", float):
        assert ball().shoot([0, 0, 5], [0, 0, -1], dtype=dtype).t.dtype == np.float64
    for dtype in (np.float16, int, "no type", "O", ">f4", 5):
        with pytest.raises(ValueError, match="dtype must be float32 or float64, got"):
            ball().shoot([0, 0, 5], [0, 0, -1], dtype=dtype)


@pytest.mark.parametrize(
    ("z", "direction", "t", "rounded"),
    [
        (1.0, 1e-60, 1e60, LARGEST),
        (1.0, 1e60, 1e-60, SMALLEST),
        (1.0, 1e44, 1e-44, np.float32(1e-44)),
    ],
)
def test_a_hit_is_neither_infinitely_far_nor_at_zero(z, direction, t, rounded):
    hits = wall(z).shoot([0, 0, 0], [0, 0, direction], dtype=np.float32)
    assert hits.object == 0
    np.testing.assert_allclose(wall(z).shoot([0, 0, 0], [0, 0, direction]).t, t)
    assert hits.t == rounded
    misses = wall(z).shoot([0, 0, 0], [0, 0, -direction], dtype=np.float32)
    assert misses.t == np.inf


def test_rounding_does_not_leave_the_limits():
    down = np.nextafter(np.float32(2), np.float32(0))
    up = np.nextafter(np.float32(2), np.float32(3))
    # The nearest float32 of both is 2.
    low, high = 2 - 1e-9, 2 + 1e-9
    assert wall(low).shoot([0, 0, 0], [0, 0, 1], dtype="f4").t == 2
    assert wall(low).shoot([0, 0, 0], [0, 0, 1], t_max=low, dtype="f4").t == down
    assert wall(high).shoot([0, 0, 0], [0, 0, 1], t_min=2, dtype="f4").t == up
    # Behind the origin too.
    back = {"t_min": -2, "dtype": "f4"}
    assert wall(-low).shoot([0, 0, 0], [0, 0, 1], **back).t == -down
    assert wall(-high).shoot([0, 0, 0], [0, 0, 1], t_min=-3, t_max=-2 - 1e-10, dtype="f4").t == -up
    # No float32 lies between both limits: the one below the end.
    within = {"t_min": 2 + 0.5e-9, "t_max": high}
    assert wall(high).shoot([0, 0, 0], [0, 0, 1], **within, dtype="f4").t == 2


def test_random_limits_hold_for_float32_too():
    rng = np.random.default_rng(7)
    n = 20000
    z = 10 ** rng.uniform(-1, 1)
    speed = 10 ** rng.uniform(-3, 3, (n, 1)) * [0, 0, 1]
    exact = wall(z).shoot([0, 0, 0], speed).t
    for ulps in (0.25, 1, 4):
        slack = np.spacing(exact.astype(np.float32)).astype(float) * ulps
        t_max, t_min = exact + slack * rng.uniform(0, 1, n), exact - slack * rng.uniform(0.1, 1, n)
        hits = wall(z).shoot([0, 0, 0], speed, t_min=t_min, t_max=t_max, dtype=np.float32)
        met = hits.object == 0
        assert met.mean() > 0.9
        t = hits.t[met].astype(float)
        assert (t <= t_max[met]).all()
        assert (np.abs(t - exact[met]) <= 2 * np.spacing(exact[met].astype(np.float32))).all()
        below = np.nextafter(t_max.astype(np.float32), np.float32(0))
        is_possible = (t_max.astype(np.float32).astype(float) <= t_max) & (t_max > t_min)
        fits = np.where(is_possible, t_max.astype(np.float32), below).astype(float) > t_min
        assert (t > t_min[met])[fits[met]].all()
        assert np.isinf(hits.t[~met]).all()
