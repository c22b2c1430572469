"""What is inside: closed forms, rules, shapes of arrays, and other packages."""

import pickle

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, ball, bumpy_sphere, output

#: More than goes to the native half at a time.
LONG = (1 << 19) + 1000


def three():
    """A ball, a closed mesh beside it that overlaps it, and a plane."""
    scene = ball()
    there = np.eye(4)
    there[0, 3] = 1
    scene.add(fh.Mesh(*bumpy_sphere(10, 1)), transform=there)
    scene.add(fh.Plane((0, 0, 0), (0, 0, 1)))
    return scene


def points(count, seed=1):
    return np.random.default_rng(seed).uniform(-2, 3, (count, 3))


def test_a_ball_holds_what_is_near_its_middle():
    asked = points(3000)
    each, rules = three().inside(asked, by="object", return_rules=True)
    assert rules == ("parity", "parity", "none")
    assert each.shape == (3000, 3)
    np.testing.assert_array_equal(each[:, 0], np.linalg.norm(asked, axis=-1) < 1)
    # The mesh's radii are from 0.7 to 1.3.
    away = np.linalg.norm(asked - [1, 0, 0], axis=-1)
    assert each[away < 0.6, 1].all()
    assert not each[away > 1.3, 1].any()
    assert not each[:, 2].any()
    np.testing.assert_array_equal(three().inside(asked), each.any(-1))


@pytest.mark.parametrize("shape", [(), (0,), (5,), (700,), (4, 0), (2, 3)])
@pytest.mark.parametrize("dtype", ["f8", "f4", ">f8", "i4"])
def test_answers_have_the_shape_of_what_is_asked(shape, dtype):
    scene = three()
    asked = np.resize(points(700) * 2, (*shape, 3)).astype(dtype)
    union, each = scene.inside(asked), scene.inside(asked, "object")
    assert (union.shape, each.shape) == (shape, (*shape, 3))
    flat = asked.reshape(-1, 3)
    alone = [scene.inside(point) for point in flat.astype("f8")]
    np.testing.assert_array_equal(union.reshape(-1), np.reshape(alone, -1))
    lengths = scene.path_length(asked, [0, 0, 1])
    assert (lengths.shape, lengths.dtype) == ((*shape, 3), np.float64)
    assert scene.path_length(asked, [0, 0, 1], by=None).shape == shape
    assert fh.Scene().inside(asked, "object").shape == (*shape, 0)
    assert not fh.Scene().inside(asked).any()
    strided = np.repeat(asked, 2, -1)[..., ::2]
    np.testing.assert_array_equal(scene.inside(strided), union)


def test_chords_of_a_ball_are_as_long_as_they_are():
    origins = points(2000)
    directions = points(2000, 2)
    lengths = three().path_length(origins, directions)
    unit = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    along = -(origins * unit).sum(-1)
    half = np.sqrt(np.maximum(1 - ((origins + along[:, None] * unit) ** 2).sum(-1), 0))
    chords = np.maximum(along + half, 0) - np.maximum(along - half, 0)
    np.testing.assert_allclose(lengths[:, 0], chords, atol=1e-7)
    assert (lengths[:, 2] == 0).all()
    union = three().path_length(origins, directions, by=None)
    assert (union <= lengths.sum(-1) + 1e-12).all()
    assert (union >= lengths.max(-1) - 1e-12).all()
    # Parts add up to the whole.
    ends = np.linspace(0.1, 1, 2000)
    parts = [
        three().path_length(origins, directions, by=None, t_max=ends),
        three().path_length(origins, directions, by=None, t_min=ends),
    ]
    np.testing.assert_allclose(sum(parts), union, atol=1e-12)


def test_an_open_mesh_says_so():
    vertices, triangles = bumpy_sphere(10, 1)
    closed, opened = fh.Mesh(vertices, triangles), fh.Mesh(vertices, triangles[3:])
    assert (closed.is_closed, opened.is_closed) == (True, False)
    assert fh.Mesh(
        vertices[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3)
    ).is_closed
    assert pickle.loads(pickle.dumps(closed)).is_closed
    scene = fh.Scene()
    scene.add(opened)
    scene.add(fh.Mesh(*SQUARE))
    found, rules = scene.inside([[0, 0, 0], [0, 0, 3], [0.2, 0.1, 0]], return_rules=True)
    assert found.tolist() == [True, False, True]
    assert rules == ("winding", "winding")
    # In through the hole in the top and out at the bottom; and across.
    lengths = scene.path_length([[0.04, 0.02, 5], [5, 0, -0.2]], [[0, 0, -1], [-1, 0, 0]])
    assert np.isnan(lengths[0, 0])
    assert 1.4 < lengths[1, 0] < 2.6


def test_few_and_many_come_to_the_same():
    scene = three()
    asked = points(3000)
    many = scene.inside(asked, "object", threads=3)
    for start in range(0, 3000, 500):
        part = slice(start, start + 500)
        np.testing.assert_array_equal(scene.inside(asked[part], "object"), many[part])
    long = np.resize(asked.astype("f4"), (LONG, 3))
    told = []
    found = scene.inside(long, progress=lambda *numbers: told.append(numbers))
    np.testing.assert_array_equal(found[:3000], scene.inside(long[:3000]))
    np.testing.assert_array_equal(found[-9:], scene.inside(long[-9:]))
    assert told[-1] == (LONG, LONG)
    assert told == sorted(told)


def test_what_makes_no_sense_is_refused_by_name():
    scene = ball()
    for wrong in ([1, 2], 3, [[1, 2, 3, 4]]):
        with pytest.raises(ValueError, match="points must have the shape"):
            scene.inside(wrong)
    for call in (lambda: scene.inside([0, 0, 0], "union"), lambda: scene.path_length(0, 0, "o")):
        with pytest.raises(ValueError, match="by must be 'object' or None"):
            call()
    with pytest.raises(ValueError, match="directions"):
        scene.path_length([0, 0, 0], [0, 0])
    assert scene.inside([[np.nan, 0, 0], [np.inf, 0, 0]]).tolist() == [False, False]
    assert scene.path_length([0, 0, 0], [0, 0, 0]).tolist() == [0]


def test_ctrl_c_ends_it():
    script = """
from support import bumpy_sphere
vertices, triangles = bumpy_sphere(200, 1)
scene = fh.Scene()
scene.add(fh.Mesh(vertices, triangles[1:]))
before = time.monotonic()
threading.Timer(1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    scene.inside(np.zeros((1_000_000, 3)))
except KeyboardInterrupt:
    print("stopped", time.monotonic() - before < 20)
"""
    assert output(script) == ["stopped", "True"]


def test_trimesh_agrees():
    trimesh = pytest.importorskip("trimesh")
    vertices, triangles = bumpy_sphere(10, 1)
    scene = fh.Scene()
    scene.add(fh.Mesh(vertices, triangles))
    asked = points(2000) / 2
    try:
        expected = trimesh.Trimesh(vertices, triangles, process=False).contains(asked)
    except ImportError:
        pytest.skip("trimesh lacks rtree")
    np.testing.assert_array_equal(scene.inside(asked), expected)
