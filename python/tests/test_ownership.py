"""Hits compute from arrays that nobody else can change."""

import copy
import pickle

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, Dlpack, ball

CAMERA = fh.Camera.look_at((1, 2, 5), (0, 0, 0), (0, 1, 0), 30, rows=30, columns=40)
NAMES = ("t", "object", "primitive", "position", "normal", "front", "barycentric")


def scene():
    made = ball()
    made.add(fh.Mesh(*SQUARE), transform=np.diag([3, 3, 3, 1.0]))
    return made


def rays(n):
    rng = np.random.default_rng(2)
    origins = rng.uniform(-4, 4, (n, 3))
    return origins, rng.uniform(-1, 1, (n, 3)) - origins


class Convertible:
    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None, copy=None):
        return self.array


@pytest.mark.parametrize("n", [1, 100, 3000, 1 << 16, (1 << 19) + 5])
@pytest.mark.parametrize(
    "given",
    [
        lambda a: a,
        lambda a: a.astype("f4"),
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: np.broadcast_to(a[:1], a.shape),
        lambda a: a[0],
        Dlpack,
        Convertible,
        memoryview,
    ],
    ids=["same", "float32", "strided", "broadcast", "one", "dlpack", "array", "buffer"],
)
def test_what_becomes_of_the_arrays_after_the_shot_changes_nothing(n, given):
    origins, directions = rays(n)
    expected = scene().shoot(given(origins.copy()), directions.copy())
    changed = given(origins)
    ways = directions.copy()
    hits = scene().shoot(changed, ways)
    for array in (origins, changed):
        base = array if isinstance(array, np.ndarray) else origins
        while base.base is not None and isinstance(base.base, np.ndarray):
            base = base.base
        base += 100
    ways *= -1
    for name in NAMES:
        np.testing.assert_array_equal(hits.channel(name), expected.channel(name), name)
    np.testing.assert_array_equal(hits.origin, expected.origin)
    np.testing.assert_array_equal(hits.direction, expected.direction)
    np.testing.assert_array_equal(hits[:1].normal if n > 1 else hits.normal, expected.normal[:1])


def test_rays_of_one_array_for_both_and_of_broadcast_shapes_are_kept():
    both = np.full((1 << 16, 3), 3.0)
    hits = ball().shoot(both, both)
    both[:] = 0
    assert (hits.origin == 3).all()
    assert (hits.direction == 3).all()
    origins, directions = rays(60)
    origins, directions = origins.reshape(60, 1, 3), directions.reshape(1, 60, 3)
    hits = scene().shoot(origins, directions)
    expected = scene().shoot(origins.copy(), directions.copy()).position
    origins += 1
    np.testing.assert_array_equal(hits.position, expected)


def test_rays_keep_their_type_and_what_is_one_for_all():
    origins = np.zeros((1000, 3), np.float32)
    hits = ball().shoot(origins, np.broadcast_to(np.float32([0, 0, 1]), (1000, 3)))
    assert hits.origin.dtype == np.float32
    assert hits._source.rays.arrays[1].base.nbytes == 12


def all_hits():
    hits = scene().shoot(CAMERA)
    yield hits
    yield hits[hits.object >= 0]
    yield scene().shoot(*CAMERA.rays())
    yield scene().shoot(*CAMERA.rays(), dtype=np.float32)
    yield scene().shoot([0, 0, 5], [0, 0, -1])
    yield scene().shoot(*rays(1 << 16))
    yield pickle.loads(pickle.dumps(hits))
    yield copy.copy(hits)
    yield copy.deepcopy(hits)


def test_all_arrays_of_hits_are_read_only():
    for hits in all_hits():
        t, o = hits
        arrays = {**dict(hits.items()), "t of two": t, "object of two": o}
        arrays |= {"origin": hits.origin, "direction": hits.direction}
        for name, array in arrays.items():
            assert not array.flags.writeable, name
            if array.ndim == 0:
                # Of one ray it is a number.
                continue
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 7
            with pytest.raises(ValueError, match="WRITEABLE"):
                array.flags.writeable = True
            assert array.copy().flags.writeable


def test_identifiers_that_were_forced_are_misses_and_no_panic(capfd):
    for origins in ([0, 0, 5], [[0, 0, 5]] * 5000):
        hits = scene().shoot(origins, [0, 0, -1])
        for array, number in zip(hits._arrays[1:3], (1, 99), strict=True):
            array[...] = number
        assert np.isnan(hits.normal).all()
    assert "panicked" not in capfd.readouterr().err


def test_memory_of_hits_and_rays_that_nobody_holds_is_used_again():
    made = scene()
    origins, directions = rays(1 << 16)
    hits = made.shoot(origins, directions)
    places = {array.ctypes.data for array in (hits.t, hits.origin, hits.direction)}
    held = hits.origin[5:6]
    before = held.copy()
    del hits
    hits = made.shoot(origins + 1, directions)
    again = {array.ctypes.data for array in (hits.t, hits.origin, hits.direction)}
    assert len(places & again) >= 1
    np.testing.assert_array_equal(held, before)
    np.testing.assert_array_equal(hits.origin, origins + 1)
