"""Arrays of every kind go in, or are refused by name."""

import firsthit as fh
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import Dlpack, ball


def rays(n=50):
    rng = np.random.default_rng(1)
    origins = rng.uniform(-3, 3, (n, 3))
    return origins, rng.uniform(-1, 1, (n, 3)) - origins


@pytest.mark.parametrize(
    "change",
    [
        lambda a: a[::2],
        lambda a: a[::-1],
        np.asfortranarray,
        lambda a: a.astype(">f8"),
        lambda a: np.repeat(a, 2, axis=1)[:, ::2],
        lambda a: a.reshape(5, 10, 3).swapaxes(0, 1),
        lambda a: a.reshape(5, 2, 5, 3)[:, :, ::-1],
        lambda a: a.tolist(),
        lambda a: a[:0],
        lambda a: a[7],
    ],
)
def test_every_layout_gives_what_a_plain_copy_gives(change):
    origins, directions = (change(array) for array in rays())
    hits = ball().shoot(origins, directions)
    plain = [np.array(array, dtype=float, order="C") for array in (origins, directions)]
    expected = ball().shoot(*plain)
    assert hits.t.shape == plain[0].shape[:-1]
    assert hits.t.dtype == np.float64
    for name in ("t", "object", "primitive", "position", "normal", "front"):
        np.testing.assert_array_equal(getattr(hits, name), getattr(expected, name))


def test_read_only_arrays_work_and_inputs_are_not_changed():
    origins, directions = rays()
    before = origins.copy()
    origins.flags.writeable = False
    ball().shoot(origins, directions)
    np.testing.assert_array_equal(origins, before)


def test_rays_broadcast_against_each_other_and_t_max():
    origins = np.tile([0.0, 0, 5], (4, 1, 1))
    directions = np.array([[0, 0, -1], [0, 0, 1.0], [0, 0, -2]])
    hits = ball().shoot(origins, directions)
    assert hits.t.shape == (4, 3)
    np.testing.assert_array_equal(hits.t[2], [4, np.inf, 2])
    limited = ball().shoot(origins, directions, t_max=np.array([[3.9], [4], [1.9], [2]]))
    np.testing.assert_array_equal(limited.t[:, 0], [np.inf, 4, np.inf, np.inf])
    np.testing.assert_array_equal(limited.t[:, 2], [2, 2, np.inf, 2])
    np.testing.assert_array_equal(
        ball().occluded(origins, directions, t_max=3), [[False, False, True]] * 4
    )


def test_rays_begin_beyond_t_min():
    """The ball of radius 1 is met at 4 and, from inside, at 6."""
    origins, directions = np.tile([0.0, 0, 5], (6, 1)), [0, 0, -1]
    begins = [0.0, -3, 3.9, 4, 5.9, 6]
    hits = ball().shoot(origins, directions, t_min=begins)
    np.testing.assert_array_equal(hits.t, [4, 4, 4, 6, 6, np.inf])
    np.testing.assert_allclose(hits.position[3], [0, 0, -1])
    np.testing.assert_array_equal(
        ball().occluded(origins, directions, t_min=begins, t_max=5), [True] * 3 + [False] * 3
    )
    assert np.isinf(ball().shoot(origins, directions, t_min=np.nan).t).all()


@pytest.mark.parametrize(
    ("origins", "directions", "words"),
    [
        (np.zeros((3, 2)), np.zeros(3), r"origins must have the shape \(\.\.\., 3\), got \(3, 2\)"),
        (np.zeros(3), 5.0, r"directions must have the shape \(\.\.\., 3\), got \(\)"),
        (np.zeros((2, 3)), np.zeros((4, 3)), r"origins \(2, 3\), directions \(4, 3\).*broadcast"),
        (
            np.zeros(3, complex),
            np.zeros(3),
            "origins must be an array of real numbers, got dtype c",
        ),
        (np.zeros(3), "abc", "directions must be an array of numbers, got str"),
        (np.zeros(3), [[1, 2, 3], [1, 2]], "directions must be an array of numbers"),
        (np.zeros(3), None, "directions must be given"),
        (np.ma.masked_equal([0, 0, 9], 9), np.zeros(3), "origins must not be masked, got 1 masked"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_by_name(origins, directions, words):
    with pytest.raises(ValueError, match=words):
        ball().shoot(origins, directions)


def test_rays_that_make_no_sense_miss_alone():
    origins = np.array([[0, 0, 5.0]] * 4)
    directions = np.array([[0, 0, -1], [0, 0, 0], [np.nan, 0, -1], [0, np.inf, -1.0]])
    hits = ball().shoot(origins, directions)
    np.testing.assert_array_equal(hits.t, [4, np.inf, np.inf, np.inf])
    np.testing.assert_array_equal(hits.object, [0, -1, -1, -1])
    assert np.isnan(hits.position[1:]).all()
    assert np.isnan(hits.normal[1:]).all()
    assert not hits.front[1:].any()


@settings(max_examples=40, deadline=None)
@given(
    n=st.integers(0, 700),
    threads=st.sampled_from([1, 2, 7]),
    seed=st.integers(0, 99),
)
def test_batches_of_any_size_and_threads_give_what_single_rays_give(n, threads, seed):
    rng = np.random.default_rng(seed)
    origins, directions = rng.normal(size=(2, n, 3))
    scene = ball()
    hits = scene.shoot(origins * 2, directions, threads=threads)
    for k in range(0, n, 97):
        one = scene.shoot(origins[k] * 2, directions[k])
        assert one.t.shape == ()
        assert one.t == hits.t[k]
        assert one.object == hits.object[k]


def test_a_batch_longer_than_a_chunk_is_in_order():
    n = (1 << 19) + 77
    origins = np.zeros((n, 3), np.float32)
    origins[:, 2] = 3 + np.arange(n) % 5
    hits = ball().shoot(origins, np.float32([0, 0, -1]))
    np.testing.assert_array_equal(hits.t, 2 + np.arange(n) % 5)
    np.testing.assert_array_equal(hits.position[:, 2], 1)


class Foreign:
    """A mesh as trimesh and its like have it."""

    def __init__(self):
        self.vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        self.faces = np.array([[0, 1, 2]])


def test_foreign_meshes_and_arrays_are_taken():
    scene = fh.Scene()
    scene.add(Foreign())
    scene.add(fh.Mesh(Foreign()))
    foreign = Foreign()
    scene.add(fh.Mesh(Dlpack(foreign.vertices.astype(float)), Dlpack(foreign.faces)))
    assert [made.triangles for made in scene.objects] == [1, 1, 1]
    with pytest.raises(TypeError, match="shape must be a shape"):
        scene.add(object())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ([[0, 0, 0]] * 3, [[0, 1, 3]]),
            "triangles must be indices of 3 vertices, got from 0 to 3",
        ),
        (([[0, 0, 0]] * 3, [[0, 1, -1]]), "triangles must be indices of 3 vertices, got from -1"),
        (([[0, 0, 0]] * 3, [[0, 1, 1.5]]), "triangles must be whole numbers"),
        (([[0, 0]] * 3, [[0, 1, 2]]), r"vertices must have the shape \(n, 3\), got \(3, 2\)"),
        (([[0, 0, 0]] * 3, [0, 1, 2]), r"triangles must have the shape \(n, 3\), got \(3,\)"),
        (([[0, 0, np.nan]] * 3, [[0, 1, 2]]), "vertices must be finite"),
        (([[0, 0, 0]] * 3, [[0, 1, 2]], [[0, 0, 1]]), "normals must be as many as vertices, got 1"),
        (([[0, 0, 0]] * 3,), "triangles must be given"),
    ],
)
def test_meshes_that_make_no_sense_are_refused_by_name(arguments, words):
    with pytest.raises(ValueError, match=words):
        fh.Mesh(*arguments)


def many(offset):
    """Rays down onto the ball, enough for memory that is used again."""
    origins = np.zeros((1 << 16, 3))
    origins[:, 2] = 3 + offset
    return origins


def test_hits_that_are_held_stay_what_they_are():
    scene, down = ball(), np.array([0, 0, -1.0])
    first = scene.shoot(many(0), down)
    t, objects = first.t[100:200], memoryview(first.object)
    del first
    for offset in (1, 2):
        other = scene.shoot(many(offset), down)
        np.testing.assert_array_equal(other.t, 2 + offset)
        misses = scene.shoot(many(offset), -down)
        assert np.isinf(misses.t).all()
        assert (misses.object == -1).all()
    np.testing.assert_array_equal(t, 2)
    assert (np.asarray(objects) == 0).all()


def test_memory_of_hits_that_nobody_holds_is_used_again():
    scene, down = ball(), np.array([0, 0, -1.0])
    hits = scene.shoot(many(0), down)
    places = {array.ctypes.data for array in (hits.t, hits.object, hits.primitive)}
    del hits
    # Object and primitive are alike, and may change places.
    hits = scene.shoot(many(1), down)
    assert places == {array.ctypes.data for array in (hits.t, hits.object, hits.primitive)}


def test_rays_need_not_be_aligned():
    raw = np.zeros(1 + 24 * 3, np.uint8)[1:].view(np.float64).reshape(3, 3)
    assert not raw.flags.aligned
    raw[:, 2] = 3
    np.testing.assert_array_equal(ball().shoot(raw, np.array([[0, 0, -1.0]] * 3)).t, 2)
