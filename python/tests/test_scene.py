"""Scenes, shapes and hits against closed forms."""

import copy
import pickle

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, TESTDATA, ball, bumpy_sphere

SHAPES = [
    fh.Sphere(center=(0, 0, 0), radius=1),
    fh.Plane(point=(0, 0, 1), normal=(0, 0, 2)),
    fh.Disc(center=(0, 0, 1), normal=(0, 0, 1), radius=1),
    fh.Box(low=(-1, -1, -1), high=(1, 1, 1)),
    fh.Cylinder(bottom=(0, 0, -1), top=(0, 0, 1), radius=1),
    fh.Cone(bottom=(0, 0, -1), top=(0, 0, 1), radius=1, top_radius=0.5),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
def test_shapes_are_met_where_they_are(shape):
    scene = fh.Scene()
    assert scene.add(shape, name="it") == 0
    hits = scene.shoot([0, 0, 5], [0, 0, -2])
    assert hits.t == 2
    np.testing.assert_array_equal(hits.position, [0, 0, 1])
    np.testing.assert_allclose(hits.normal, [0, 0, 1], atol=1e-15)
    assert hits.front
    assert np.isnan(hits.barycentric).all()
    assert scene.objects[0].shape == shape


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fh.Sphere((0, 0, 0), 0), "radius must be positive and finite, got 0"),
        (lambda: fh.Sphere((0, 0), 1), "center must be three numbers"),
        (lambda: fh.Plane((0, 0, 0), (0, 0, 0)), "normal must be a finite direction, not zero"),
        (lambda: fh.Box((0, 0, 0), (1, 1, 0)), "high must be above low"),
        (lambda: fh.Cylinder((0, 0, 0), (0, 0, 0), 1), "top must be another point than bottom"),
        (lambda: fh.Cone((0, 0, 0), (0, 0, 1), -1), "bottom_radius must be zero or positive"),
        (lambda: fh.Disc((0, 0, 0), (0, 0, 1), np.nan), "radius must be positive and finite"),
    ],
)
def test_shapes_that_make_no_sense_are_refused_by_name(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_objects_come_back_as_they_were_added():
    scene = fh.Scene()
    mesh = fh.Mesh(*SQUARE)
    move = np.eye(4)
    move[:3, 3] = [1, 2, 3]
    assert scene.add(mesh, name="part", transform=move, color=(0.8, 0.2, 0.1)) == 0
    assert scene.add(mesh, transform=move[:3] * [1, 1, 1, 2]) == 1
    part = scene.objects[0]
    assert (part.name, part.shape, part.triangles) == ("part", mesh, 2)
    assert part.color == (0.8, 0.2, 0.1)
    np.testing.assert_array_equal(part.transform, move)
    np.testing.assert_array_equal(scene.bounds, [[1, 2, 3], [3, 5, 6]])
    np.testing.assert_array_equal(mesh.vertices, SQUARE[0])
    np.testing.assert_array_equal(mesh.triangles, SQUARE[1])
    assert scene.shoot([1.5, 2.5, 9], [0, 0, -1]).object == 0
    assert scene.shoot([2.5, 4.5, 9], [0, 0, -1]).object == 1


@pytest.mark.parametrize(
    ("transform", "words"),
    [
        (np.zeros((4, 4)) + np.diag([0, 0, 0, 1.0]), "transform must be an affine map"),
        (np.eye(3), r"transform must have the shape \(4, 4\) or \(3, 4\), got \(3, 3\)"),
        (np.full((4, 4), 1.0), "last row"),
        (np.eye(4) * [1, 1, np.nan, 1], "transform must"),
        (np.full((4, 4), np.nan), "transform must be finite, got"),
    ],
)
def test_transforms_that_make_no_sense_are_refused_at_once(transform, words):
    scene = fh.Scene()
    with pytest.raises(ValueError, match=words):
        scene.add(fh.Sphere((0, 0, 0), 1), transform=transform)
    assert len(scene.objects) == 0


def test_weights_uvs_and_faces_are_the_meshs():
    scene = fh.Scene()
    uvs = np.array(SQUARE[0])[:, :2] * 2
    scene.add(fh.Mesh(*SQUARE, uvs=uvs))
    hits = scene.shoot([[0.75, 0.25, 1], [0.25, 0.5, 1]], [0, 0, -1])
    np.testing.assert_array_equal(hits.primitive, [0, 1])
    np.testing.assert_array_equal(hits.face, [0, 1])
    np.testing.assert_allclose(hits.barycentric, [[0.25, 0.5, 0.25], [0.5, 0.25, 0.25]])
    np.testing.assert_allclose(hits.uv, [[1.5, 0.5], [0.5, 1]])
    corners = np.array(SQUARE[0])[np.array(SQUARE[1])[hits.primitive]]
    np.testing.assert_allclose(np.einsum("nk,nkc->nc", hits.barycentric, corners), hits.position)


def test_hits_are_a_pair_and_say_what_they_are():
    hits = ball().shoot([[0, 0, 5], [5, 5, 5]], [0, 0, -1])
    t, o = hits
    assert (t.tolist(), o.tolist()) == ([4, np.inf], [0, -1])
    assert repr(hits) == "Hits(shape=(2,), 1 of 2 rays hit)"
    np.testing.assert_array_equal(hits.origin, [[0, 0, 5], [5, 5, 5]])
    np.testing.assert_array_equal(hits.direction, [[0, 0, -1], [0, 0, -1]])
    with pytest.raises(AttributeError, match="z is for hits of a camera"):
        _ = hits.z


def test_a_scene_goes_on_after_its_first_shot_and_keeps_old_hits_right():
    scene = ball()
    old = scene.shoot([0, 0, 5], [0, 0, -1])
    scene.add(fh.Sphere((0, 0, 3), 1))
    assert scene.shoot([0, 0, 5], [0, 0, -1]).t == 1
    np.testing.assert_array_equal(old.normal, [0, 0, 1])
    assert repr(scene) == "Scene(2 objects, 0 triangles)"


def test_an_empty_scene_is_missed():
    scene = fh.Scene()
    assert np.isnan(scene.bounds).all()
    assert scene.shoot([0, 0, 0], [0, 0, 1]).t == np.inf
    assert not scene.occluded([0, 0, 0], [0, 0, 1])


def test_answers_are_the_same_however_trees_are_built(tmp_path):
    points, triangles = bumpy_sphere(60, 3)
    origins = np.random.default_rng(5).uniform(-3, 3, (500, 3))
    answers = []
    for build in ("auto", "fast", "best"):
        scene = fh.Scene(build=build)
        scene.add(fh.Mesh(points, triangles))
        assert copy.copy(scene)._build_as == build
        hits = scene.shoot(origins, -origins)
        scene.save(tmp_path / f"{build}.fhs")
        answers.append((hits.t.tobytes(), hits.primitive.tobytes()))
    assert answers[0] == answers[1] == answers[2]
    assert (tmp_path / "fast.fhs").read_bytes() == (tmp_path / "best.fhs").read_bytes()
    with pytest.raises(ValueError, match="build must be one of"):
        fh.Scene(build="worst")


def test_closed_meshes_do_not_leak():
    points, triangles = bumpy_sphere(60, 3)
    scene = fh.Scene()
    scene.add(fh.Mesh(points, triangles))
    inside = np.array([0.05, -0.1, 0.02])
    edges = points[triangles[:, 0]] * 0.5 + points[triangles[:, 1]] * 0.5
    for targets in (points.astype(float), edges.astype(float)):
        assert (scene.shoot(inside, targets - inside).object == 0).all()


@pytest.mark.parametrize(
    "make", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))]
)
def test_everything_copies_and_pickles(make):
    scene = ball()
    scene.add(fh.Mesh(*SQUARE, colors=[[1, 0, 0]] * 4), transform=np.diag([2, 2, 2, 1]), name="m")
    scene.add_light(fh.PointLight((0, 0, 9)))
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, 6, 8)
    hits = scene.shoot(camera)
    again = make(scene)
    assert repr(again) == repr(scene)
    assert again.lights == scene.lights
    np.testing.assert_array_equal(again.shoot(camera).t, hits.t)
    again.add(fh.Sphere((0, 0, 2), 1))
    assert len(scene.objects) == 2
    assert make(camera) == camera
    other = make(hits)
    for name in ("t", "object", "primitive", "normal", "z", "range", "position"):
        np.testing.assert_array_equal(getattr(other, name), getattr(hits, name))
    for shape in SHAPES:
        assert make(shape) == shape
    np.testing.assert_array_equal(make(scene.objects[1].shape).vertices, SQUARE[0])
    frame = fh.render(scene, camera)
    np.testing.assert_array_equal(make(frame)["color"], frame["color"])


def test_files_give_scenes_and_errors_their_place(tmp_path):
    with pytest.warns(fh.FirsthitWarning, match="unknown material 'none'"):
        scene = fh.load(TESTDATA / "cube_relative_mixed.obj")
    assert [made.name for made in scene.objects] == ["a", "b c"]
    assert sum(made.triangles for made in scene.objects) == 12
    with pytest.raises(fh.FileError) as missing:
        fh.load(tmp_path / "none.ply")
    assert isinstance(missing.value, OSError)
    broken = tmp_path / "broken.obj"
    broken.write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(fh.FileFormatError, match=r"broken.obj:2: ") as bad:
        fh.load(broken)
    assert isinstance(bad.value, ValueError)
    assert (bad.value.path, bad.value.place) == (str(broken), "line 2")
    assert str(pickle.loads(pickle.dumps(bad.value))) == str(bad.value)
    doubtful = tmp_path / "doubtful.obj"
    doubtful.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n")
    with pytest.warns(fh.FirsthitWarning):
        assert fh.load(doubtful).objects[0].triangles == 1
    with pytest.raises(fh.FileFormatError):
        fh.load(doubtful, strict=True)


def test_info_says_what_is_in_use():
    assert set(fh.info()) == {"version", "instruction_set", "threads"}
    assert fh.__version__ == fh.info()["version"]


@pytest.mark.parametrize("name", ["section", "shoot", "inside", "add"])
def test_errors_of_calls_name_the_scene_and_methods_are_pickled(name):
    method = getattr(fh.Scene, name)
    with pytest.raises(TypeError, match=rf"^Scene\.{name}\(\) missing"):
        method(fh.Scene())
    assert pickle.loads(pickle.dumps(method)) is method
