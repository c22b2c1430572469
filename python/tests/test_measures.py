"""Insides of objects: closed forms, rules, shapes of arrays, and other packages."""

import math
import pickle
from typing import Any

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
    assert rules == ("nonzero", "nonzero", "none")
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


def _box(low: Any, high: Any, turns: int = 1) -> tuple[Any, Any]:
    """Return the vertices and triangles of a box that faces outwards, or with -1 inwards."""
    corners = np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])
    each = "031 023 015 054 137 175 326 367 204 246 457 476"
    faces = np.array([[int(k) for k in face] for face in each.split()])
    return corners, faces if turns > 0 else faces[:, ::-1]


def _boxes(*boxes: tuple[Any, Any]) -> fh.Mesh:
    vertices = np.concatenate([box[0] for box in boxes]).astype(float)
    return fh.Mesh(vertices, np.concatenate([box[1] + 8 * k for k, box in enumerate(boxes)]))


def _scene(*boxes: tuple[Any, Any], flip: int | None = None) -> fh.Scene:
    mesh = _boxes(*boxes)
    if flip is not None:
        triangles = mesh.triangles.copy()
        triangles[flip] = triangles[flip, ::-1]
        mesh = fh.Mesh(mesh.vertices, triangles)
    scene = fh.Scene()
    scene.add(mesh)
    return scene


CUBE = ([-1] * 3, [1] * 3)
HALF = ([-0.5] * 3, [0.5] * 3)


@pytest.mark.parametrize("flip", [None, 4])
@pytest.mark.parametrize("turns", [1, -1])
@pytest.mark.parametrize("rule", ["nonzero", "parity"])
def test_a_plate_inside_out_or_with_a_flipped_facet_is_as_thick_as_the_plate(rule, turns, flip):
    scene = _scene(_box((0, 0, 0), (10, 10, 1), turns), flip=flip)
    places = [[2.3, 4.1, 1], [2.3, 4.1, 0], [6.6, 1.2, 1.2]]
    assert scene.thickness(places, rule=rule).tolist() == [1, 1, 1]
    for hits in (scene.shoot([2.3, 4.1, 9], [0, 0, -1]), scene.shoot([2.3, 1, -9], [0, 0, 1])):
        assert scene.thickness(hits, rule=rule) == 1
    cut = scene.section((5, 5, 0.5), (0, 0, 1), rule=rule)
    assert (cut.area, cut.perimeter, len(cut)) == (100, 40, 1)
    assert scene.inside([5, 5, 0.5], rule=rule)
    assert scene.signed_distance([5, 5, 0.75], rule=rule) == -0.25
    assert scene.path_length([2.3, 4.1, 9], [0, 0, -2], rule=rule).tolist() == [1]


def test_every_face_twice_is_the_solid_by_nonzero_and_nothing_by_parity():
    scene = _scene(_box(*HALF), _box(*HALF))
    ray = [0.1, 0.2, 5], [0, 0, -1]
    assert scene.inside([0.1, 0, 0])
    assert scene.signed_distance([0.1, 0, 0]) == -0.4
    assert scene.path_length(*ray).tolist() == [1]
    assert scene.thickness(scene.shoot(*ray)) == 1
    assert scene.section((0, 0, 0), (0, 0, 1)).area == 1
    assert scene.inside([0.1, 0, 0], return_rules=True)[1] == ("nonzero",)
    parity: Any = {"rule": "parity"}
    assert not scene.inside([0.1, 0, 0], **parity)
    assert scene.signed_distance([0.1, 0, 0], **parity) == 0.4
    assert scene.path_length(*ray, **parity).tolist() == [0]
    assert scene.thickness(scene.shoot(*ray), **parity) == 0
    with pytest.warns(fh.FirsthitWarning, match="cuts nothing"):
        assert scene.section((0, 0, 0), (0, 0, 1), **parity).area == 0


def test_boxes_that_overlap_in_one_mesh_are_one_solid():
    scene = _scene(_box(*HALF), _box((-0.05, -0.5, -0.5), (0.95, 0.5, 0.5)))
    assert scene.inside([0.2, 0, 0])
    assert not scene.inside([0.2, 0, 0], rule="parity")
    cut = scene.section((0, 0, 0), (0, 0, 1))
    assert cut.area == pytest.approx(1.45, abs=1e-15)
    assert len(cut) == 1
    assert scene.section((0, 0, 0), (0, 0, 1), rule="parity").area == pytest.approx(0.9)
    assert scene.thickness([[-0.5, 0.1, 0.2]]) == pytest.approx(1.45)
    assert [part.volume for part in scene.objects[0].shape.split()] == pytest.approx([1, 1])


def test_a_cavity_is_hollow_where_the_rule_says_so_in_all_measures():
    for turns, rule, area in [(-1, "nonzero", 3.84), (1, "parity", 3.84), (1, "nonzero", 4.0)]:
        scene = _scene(_box(*CUBE), _box([-0.2] * 3, [0.2] * 3, turns))
        choice: Any = {"rule": rule}
        is_solid = area == 4.0
        assert scene.section((0, 0, 0), (0, 0, 1), **choice).area == pytest.approx(area)
        assert scene.inside([0.0, 0, 0], **choice) == is_solid
        assert (scene.signed_distance([0.0, 0, 0], **choice) < 0) == is_solid
        expected = 2.0 if is_solid else 0.8
        assert scene.thickness([[-1, 0.1, 0.05]], **choice) == pytest.approx(expected)
        length = scene.path_length([-5, 0.1, 0.05], [1, 0, 0], None, **choice)
        assert length == pytest.approx(2.0 if is_solid else 1.6)


def test_a_rule_that_is_none_is_refused_by_name():
    scene = _scene(_box(*CUBE))
    wrong: Any = {"rule": "evenodd"}
    for ask in (
        lambda: scene.inside([0, 0, 0], **wrong),
        lambda: scene.path_length([0, 0, 0], [0, 0, 1], **wrong),
        lambda: scene.thickness([0, 0, 1], **wrong),
        lambda: scene.signed_distance([0, 0, 0], **wrong),
        lambda: scene.section((0, 0, 0), (0, 0, 1), **wrong),
    ):
        with pytest.raises(ValueError, match="rule must be one of nonzero, parity, got 'evenodd'"):
            ask()


def test_an_open_box_has_distances_with_a_sign_on_request():
    mesh = _boxes(_box(*CUBE))
    scene = fh.Scene()
    scene.add(fh.Mesh(mesh.vertices, mesh.triangles[:10]))
    with pytest.raises(ValueError, match="closed"):
        scene.signed_distance([0, 0, -0.5])
    assert scene.signed_distance([0, 0, -0.5], allow_open=True) == -0.5
    assert scene.signed_distance([0, 0, -2], allow_open=True) == 1


def test_a_mesh_has_an_area_a_volume_and_parts():
    mesh = _boxes(_box(*CUBE), _box([-0.5] * 3, [0.5] * 3, -1), _box((3, 3, 3), (4, 4, 5)))
    assert mesh.area == pytest.approx(24 + 6 + 10)
    assert mesh.volume == pytest.approx(8 - 1 + 2)
    parts = mesh.split()
    assert [part.triangles.shape for part in parts] == [(12, 3)] * 3
    assert [part.volume for part in parts] == pytest.approx([8, 1, 2])
    assert all(part.vertices.shape == (8, 3) and part.is_closed for part in parts)
    one_side = fh.Mesh(mesh.vertices, mesh.triangles[:2])
    assert math.isnan(one_side.volume)
    assert one_side.area == pytest.approx(4)
    assert fh.Mesh(mesh.vertices, np.empty((0, 3), int)).split() == []


def test_the_parts_of_a_mesh_keep_what_it_knows():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 0, 0], [6, 0, 0], [5, 1, 0.0]])
    weights = np.arange(6.0)
    mesh = fh.Mesh(
        corners,
        [[3, 4, 5], [0, 1, 2]],
        uvs=np.arange(12).reshape(2, 3, 2),
        faces=[7, 9],
        slots=[1, 0],
        vertex_properties={"weight": weights},
        face_properties={"zone": np.arange(10.0)},
    )
    first, second = mesh.split()
    assert first.vertices.tolist() == corners[3:].tolist()
    assert first.vertex_properties["weight"].tolist() == [3, 4, 5]
    assert second.face_properties["zone"].tolist() == [9]
    assert second.faces is not None
    assert second.faces.tolist() == [0]
    assert first.slots is not None
    assert first.slots.tolist() == [1]
    assert second.uvs is not None
    assert second.uvs.reshape(-1, 2)[0].tolist() == [6, 7]
