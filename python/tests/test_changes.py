"""Scenes that change: the results are those of scenes that are built anew."""

import copy
import pickle

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, bumpy_sphere

RNG = np.random.default_rng(3)


def at(x):
    place = np.eye(4)
    place[0, 3] = x
    return place


def mesh(seed):
    return fh.Mesh(*bumpy_sphere(12, seed))


def row(shapes, hidden=()):
    """Shapes side by side; of the hidden ones none is there."""
    scene = fh.Scene()
    for k, shape in enumerate(shapes):
        scene.add(shape, transform=at(3 * k), name=f"part {k}", mask=0 if k in hidden else 1)
    return scene


def assert_same(scene, other):
    origins = np.random.default_rng(1).uniform([-2, -2, 5], [14, 2, 9], (3000, 3))
    ways = np.random.default_rng(2).uniform(-0.2, 0.2, (3000, 3)) - [0, 0, 1]
    hits, expected = (one.shoot(origins, ways, mask=1) for one in (scene, other))
    assert (expected.object >= 0).any()
    for name in ("t", "object", "primitive", "barycentric", "normal"):
        np.testing.assert_array_equal(getattr(hits, name), getattr(expected, name))
    np.testing.assert_array_equal(
        scene.count(origins, ways, mask=1), other.count(origins, ways, mask=1)
    )
    camera = fh.Camera.look_at((6, -9, 8), (6, 0, 0), (0, 0, 1), 60, 30, 40)
    np.testing.assert_array_equal(
        scene.shoot(camera, mask=1).object, other.shoot(camera, mask=1).object
    )


@pytest.mark.parametrize("built", [False, True])
def test_hidden_removed_and_replaced_objects_are_as_in_a_scene_built_anew(built):
    shapes = [mesh(1), fh.Sphere((0, 0, 0), 1), mesh(2), fh.Box((-1, -1, -1), (1, 1, 1)), mesh(3)]
    scene = row(shapes)
    if built:
        assert_same(scene, row(shapes))
    scene.hide([0, "part 3"])
    assert [made.hidden for made in scene.objects] == [True, False, False, True, False]
    assert_same(scene, row(shapes, hidden=[0, 3]))
    scene.show(0)
    assert_same(scene, row(shapes, hidden=[3]))
    scene.remove("part 2")
    assert [made.removed for made in scene.objects] == [False, False, True, False, False]
    assert_same(scene, row(shapes, hidden=[2, 3]))
    new = fh.Cylinder((0, 0, -1), (0, 0, 1), 0.5)
    scene.replace(1, new)
    scene.show([3])
    assert_same(scene, row([shapes[0], new, shapes[2], shapes[3], shapes[4]], hidden=[2]))
    scene.move(4, at(6))
    moved = row([shapes[0], new, shapes[4], shapes[3]])
    origins = np.random.default_rng(1).uniform([-2, -2, 5], [14, 2, 9], (3000, 3))
    np.testing.assert_array_equal(
        scene.shoot(origins, [0, 0, -1]).t, moved.shoot(origins, [0, 0, -1]).t
    )
    assert scene.add(fh.Sphere((0, 5, 0), 1)) == 5


@pytest.mark.parametrize("size", [0.05, 0.9])
@pytest.mark.parametrize("built", [False, True])
def test_moved_vertices_are_met_as_in_a_new_mesh(built, size):
    points, triangles = bumpy_sphere(30, 1)
    colors = RNG.uniform(size=points.shape)
    scene = fh.Scene()
    soft = scene.add(fh.Mesh(points, triangles, colors=colors), transform=at(3), name="soft")
    scene.add(mesh(2))
    if built:
        scene.shoot((0, 0, 5), (0, 0, -1))
    # Little: the tree is fitted. Much: it is built anew.
    points = points + RNG.uniform(-size, size, points.shape)
    before = scene.objects[soft].shape
    scene.update_vertices(soft, points)
    other = fh.Scene()
    other.add(fh.Mesh(points, triangles, colors=colors), transform=at(3))
    other.add(mesh(2))
    assert_same_rays(scene, other)
    made = scene.objects[soft]
    np.testing.assert_array_equal(made.shape.vertices, points)
    np.testing.assert_array_equal(made.shape.colors, before.colors)
    assert made.name == "soft"
    assert not np.array_equal(before.vertices, points)


def assert_same_rays(scene, other):
    origins = np.random.default_rng(1).uniform([-2, -2, 5], [5, 2, 9], (3000, 3))
    hits, expected = (one.shoot(origins, [0, 0.01, -1]) for one in (scene, other))
    assert len(set(expected.object.tolist())) == 3
    for name in ("t", "object", "primitive", "barycentric"):
        np.testing.assert_array_equal(getattr(hits, name), getattr(expected, name))


def test_hits_are_of_the_scene_before_it_changed():
    scene = row([mesh(1), mesh(2)])
    hits = scene.shoot([[0, 0, 5], [3, 0, 5]], [0, 0, -1])
    normals = row([mesh(1), mesh(2)]).shoot([[0, 0, 5], [3, 0, 5]], [0, 0, -1]).normal
    scene.replace(0, fh.Sphere((0, 0, 0), 1))
    scene.remove(1)
    scene.shoot((0, 0, 5), (0, 0, -1))
    np.testing.assert_array_equal(hits.normal, normals)


@pytest.mark.parametrize("copied", [copy.copy, lambda scene: pickle.loads(pickle.dumps(scene))])
def test_copies_keep_what_is_hidden_and_removed(copied, tmp_path):
    scene = row([mesh(1), mesh(2), mesh(3)])
    scene.hide(0)
    scene.remove(2)
    other = copied(scene)
    assert [made.hidden for made in other.objects] == [True, False, True]
    assert [made.removed for made in other.objects] == [False, False, True]
    assert_same_objects(other, {-1, 1})
    with pytest.raises(IndexError, match="object 2 was removed"):
        other.show(2)
    other.show(0)
    assert_same_objects(other, {-1, 0, 1})
    assert_same_objects(scene, {-1, 1})


def assert_same_objects(scene, expected):
    origins = np.random.default_rng(1).uniform([-2, -2, 5], [14, 2, 9], (3000, 3))
    assert set(scene.shoot(origins, [0, 0, -1]).object.tolist()) == expected


def test_saved_scenes_keep_masks_and_what_is_hidden(tmp_path):
    scene = row([mesh(1), mesh(2), mesh(3)], hidden=[1])
    scene.hide(0)
    scene.save(tmp_path / "row.fhs")
    opened = fh.open(tmp_path / "row.fhs")
    assert [made.mask for made in opened.objects] == [1, 0, 1]
    assert [made.hidden for made in opened.objects] == [True, True, False]
    assert_same(opened, row([mesh(1), mesh(2), mesh(3)], hidden=[0, 1]))
    opened.show("part 0")
    assert_same(opened, row([mesh(1), mesh(2), mesh(3)], hidden=[1]))


def test_wrong_changes_are_refused_and_change_nothing():
    scene = row([mesh(1), fh.Sphere((0, 0, 0), 1)])
    for change, error, match in [
        (lambda: scene.hide(2), IndexError, "no object 2; there are 2"),
        (lambda: scene.hide("no"), ValueError, "no object with the name 'no'"),
        (lambda: scene.remove([0, 7]), IndexError, "no object 7"),
        (lambda: scene.replace(0, "box"), TypeError, "shape must be"),
        (lambda: scene.replace(5, mesh(1)), IndexError, "no object 5"),
        (lambda: scene.update_vertices(1, [[0, 0, 0]]), TypeError, "must be a mesh"),
        (lambda: scene.update_vertices(0, [[0, 0, 0]]), ValueError, "as many as there were"),
        (lambda: scene.update_vertices(0, np.full((266, 3), np.nan)), ValueError, "finite"),
        (lambda: scene.add(mesh(1), mask=-1), ValueError, "mask must be from"),
        (lambda: scene.add(mesh(1), mask=[1, 2]), ValueError, "mask must be one number"),
    ]:
        with pytest.raises(error, match=match):
            change()
    assert_same(scene, row([mesh(1), fh.Sphere((0, 0, 0), 1)]))


def test_another_packages_mesh_can_take_a_place():
    class Other:
        vertices, faces = SQUARE

    scene = row([mesh(1)])
    scene.replace(0, Other())
    assert float(scene.shoot((0.5, 0.25, 5), (0, 0, -1)).t) == 5


def test_show_of_nothing_shows_all_that_are_hidden():
    scene = row([fh.Sphere((0, 0, 0), 1), fh.Sphere((3, 0, 0), 1)])
    scene.hide([0, 1])
    scene.show()
    assert not any(made.hidden for made in scene.objects)
    scene.remove(1)
    with pytest.warns(fh.FirsthitWarning, match=r"to look at the scene: scene\.view\(\) in a note"):
        scene.show()
    assert scene.objects[1].removed
