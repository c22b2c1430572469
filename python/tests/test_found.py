"""Faults that people found who tried to break questions about rays, each once."""

from __future__ import annotations

import math
import threading
import time

import firsthit as fh
import numpy as np
import pytest
from support import ball


def sheet(height: float) -> fh.Mesh:
    return fh.Mesh([[-99, -99, height], [99, -99, height], [0, 99, height]], [[0, 1, 2]])


@pytest.mark.parametrize("height", [0.0, 0.1, 1.1, 7.3])
def test_a_surface_exactly_at_an_end_hides_nothing(height: float) -> None:
    scene = fh.Scene()
    scene.add(sheet(height))
    rng = np.random.default_rng(1)
    above, on = rng.uniform(-5, 5, (2, 4000, 3))
    above[:, 2], on[:, 2] = height + rng.uniform(1, 9, 4000), height
    assert scene.visible(above, on).all()
    assert scene.visible(on, above).all()
    below = on - [0, 0, 1e-9]
    assert not scene.visible(above, below).any()


def test_hits_on_the_diagonal_of_a_wall_see_who_shot_them() -> None:
    scene = fh.Scene()
    corners = np.array([[0, 0, 0], [1, 0, 0.3], [1, 1, 0.7], [0, 1, 0.4]])
    scene.add(fh.Mesh(corners, [[0, 1, 2], [0, 2, 3]]))
    eye = np.array([0.2, 0.7, 5.0])
    hits = scene.shoot(eye, np.linspace(0.01, 0.99, 99)[:, None] * corners[2] - eye)
    assert (hits.object == 0).all()
    assert scene.visible(hits, [0.9, 0.1, 4]).all()
    assert scene.visible(eye, hits).all()


def test_corners_of_a_solid_see_each_other_and_not_what_is_behind() -> None:
    scene = fh.Scene()
    box = fh.Box((0.1, 0.2, 0.3), (1.7, 1.9, 2.3))
    corners = np.array([[x, y, z] for x in (0.1, 1.7) for y in (0.2, 1.9) for z in (0.3, 2.3)])
    faces = [[0, 1, 3], [0, 3, 2], [4, 7, 5], [4, 6, 7], [0, 5, 1], [0, 4, 5], [2, 3, 7], [2, 7, 6]]
    scene.add(fh.Mesh(corners, [*faces, [1, 5, 7], [1, 7, 3], [0, 2, 6], [0, 6, 4]]))
    assert scene.visible(corners[:, None], corners).all()
    ahead = corners + 0.3 * (corners - (0.9, 1.05, 1.3))
    # Through the body, a diagonal comes out at the other corner: nothing is strictly between.
    outside = np.array([9.0, 8.0, 7.0])
    seen = scene.visible(corners, outside)
    other = fh.Scene()
    other.add(box)
    assert (seen == other.visible(0.999999 * corners + 0.000001 * ahead, outside)).all()
    assert 0 < seen.sum() < 8


@pytest.mark.parametrize("length", [1e-300, 1e-160, 1e-9, 1.0, 1e160, 1e300])
def test_thickness_along_directions_of_any_length(length: float) -> None:
    scene = fh.Scene()
    scene.add(fh.Box((0, 0, 0), (4, 4, 0.5)))
    hit = scene.shoot([1, 1, 5.0], [0, 0, -1.0])
    assert scene.thickness(hit, [0, 0, -length]) == 0.5


def test_thickness_passes_through_other_objects() -> None:
    # Two squares in the shape of an L; at the inner edge a ray grazes the solid.
    outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    points = [(x, y, z) for z in (0, 1) for x, y in outline]
    lid = [(0, 1, 3), (1, 2, 3), (0, 3, 5), (3, 4, 5)]
    faces = [(c, b, a) for a, b, c in lid] + [(a + 6, b + 6, c + 6) for a, b, c in lid]
    for k in range(6):
        m = (k + 1) % 6
        faces += [(k, m, m + 6), (k, m + 6, k + 6)]
    mesh = fh.Mesh(points, faces)
    assert mesh.is_closed
    alone, crowded = fh.Scene(), fh.Scene()
    alone.add(mesh)
    crowded.add(mesh)
    for x in np.linspace(0.1, 1.9, 7):
        crowded.add(fh.Sphere((x, 1, 0.5), 0.05))
    start = np.array([0.0, 1.0, 0.5])
    hit = alone.shoot(start - [1, 0, 0], [1, 0, 0])
    rest = crowded.shoot(start - [1, 0, 0], [1, 0, 0])
    assert hit.object == rest.object == 0
    assert alone.thickness(hit, [1, 0, 0]) == crowded.thickness(rest, [1, 0, 0])
    across = alone.shoot([[-1, 0.3, 0.4]], [1, 0, 0])
    assert crowded.thickness(across, [1, 0, 0]) == 2.0


def test_thickness_of_many_points_within_many_objects_takes_little_memory() -> None:
    scene = fh.Scene()
    scene.add(fh.Box((0, 0, 0), (4, 4, 4)))
    for height in np.linspace(0.5, 3.5, 300):
        scene.add(fh.Box((1, 1, height), (3, 3, height + 0.001)))
    starts = np.random.default_rng(2).uniform([1, 1, 9], [3, 3, 12], (1000, 3))
    hits = scene.shoot(starts, [0, 0, -1.0])
    assert np.array_equal(scene.thickness(hits), np.full(1000, 4.0))


def test_threads_do_not_lose_each_others_changes() -> None:

    def keep_moving(scene: fh.Scene, end: threading.Event) -> None:
        while not end.is_set():
            scene.move(0, np.eye(4))

    for _ in range(40):
        scene, end = fh.Scene(), threading.Event()
        scene.add(fh.Sphere((0, 0, 0), 1))
        thread = threading.Thread(target=keep_moving, args=(scene, end))
        thread.start()
        time.sleep(0.0007)
        scene.hide(0)
        time.sleep(0.0007)
        end.set()
        thread.join()
        assert scene.objects[0].hidden


def test_hits_are_no_points() -> None:
    scene = ball()
    hits = scene.shoot([[0.3, 0.4, 5], [3, 0, 5], [9, 9, 9]], [0, 0, -1])
    for ask in (scene.inside, scene.closest_point, scene.signed_distance):
        with pytest.raises(ValueError, match=r"hits\.position"):
            ask(hits)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"hits\.position"):
        scene.shoot(hits, [0, 0, 1])  # type: ignore[arg-type]
    assert scene.inside(hits.position).shape == (3,)


def test_a_disc_keeps_its_bits_when_it_is_built_again() -> None:
    rng = np.random.default_rng(3)
    origins, directions = rng.uniform(-2, 2, (2, 2000, 3))
    for normal in rng.normal(size=(20, 3)):
        scene, again = fh.Scene(), fh.Scene()
        scene.add(fh.Disc((0.5, 0.5, 0.5), normal, 0.7))
        first = scene.objects[0].shape
        assert isinstance(first, fh.Disc)
        again.add(fh.Disc(first.center, first.normal, first.radius))
        met, over = (made.shoot(origins, directions).t for made in (scene, again))
        assert np.array_equal(met, over)


def test_limits_of_a_camera_have_its_shape() -> None:
    scene = ball()
    camera = fh.Camera((0, 0, 5), (0, 0, -1), (0, 1, 0), 2, 1.8, 1.4, 7, 9)
    for shape in ((3, 3), (5,), (0,), (2, 7, 9)):
        for fill in (np.zeros, np.ones):
            with pytest.raises(ValueError, match="t_min"):
                scene.shoot(camera, t_min=fill(shape))
    near = scene.shoot(camera, t_min=np.zeros((7, 9)))
    assert np.array_equal(near.t, scene.shoot(camera).t)
    assert np.array_equal(near.t, scene.shoot(camera, t_min=np.zeros(9)).t)


def test_misuse_is_told() -> None:
    scene = ball()
    with pytest.raises(ValueError, match="cull must be"):
        scene.shoot((0, 0, 5), (0, 0, -1), cull=np.array("front"))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="identifiers or names"):
        scene.shoot((0, 0, 5), (0, 0, -1), objects=b"ball")  # type: ignore[arg-type]


def test_a_name_stands_for_an_object() -> None:
    scene = ball()
    scene.add(fh.Sphere((5, 0, 0), 1), name="twin")
    scene.add(fh.Sphere((9, 0, 0), 1), name="twin")
    scene.move("ball", [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2]])
    assert scene.shoot((0, 0, 9), (0, 0, -1)).t == 6.0
    scene.replace("ball", fh.Box((-1, -1, -1), (1, 1, 2)))
    assert scene.shoot((0, 0, 9), (0, 0, -1)).t == 5.0
    with pytest.raises(ValueError, match="2 objects have the name 'twin'"):
        scene.move("twin", None)
    with pytest.raises(ValueError, match="no object with the name"):
        scene.replace("cup", fh.Sphere((0, 0, 0), 1))


def test_questions_about_some_objects_only() -> None:
    scene = ball()
    scene.add(fh.Box((2, -1, -1), (3, 1, 1)), name="box")
    points = [[0, 0, 0.25], [2.5, 0, 0]]
    assert scene.inside(points, objects="ball").tolist() == [True, False]
    assert scene.inside(points, by="object", objects="box").tolist() == [
        [False, False],
        [False, True],
    ]
    assert scene.closest_point(points, objects="box").object.tolist() == [1, 1]
    assert scene.signed_distance(points, objects="ball").tolist() == [-0.75, 1.5]
    along = scene.path_length([-5, 0, 0], [1, 0, 0], objects="box")
    assert along.tolist() == [0.0, 1.0]
    assert not scene.visible([-5, 0, 0], [5, 0, 0], objects="box")
    assert scene.visible([-5, 0, 0], [1.5, 0, 0], objects="box")
    assert not scene.visible([-5, 0, 0], [1.5, 0, 0])
    assert scene.thickness([[2.5, 0, 5]], objects="box").tolist() == [2.0]
    hit = scene.shoot([0, 0, 5], [0, 0, -1])
    assert math.isinf(scene.thickness(hit, objects="box"))


@pytest.mark.parametrize("flags", [[True, False, True], np.array([True, False, True])])
def test_flags_are_properties(flags: list[bool] | np.ndarray) -> None:
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    scene = fh.Scene()
    scene.add(fh.Mesh(corners, [[0, 1, 2]], vertex_properties={"flag": flags}))
    hits = scene.shoot([[0.05, 0.05, 1], [0.9, 0.05, 1]], [0, 0, -1])
    assert hits["flag"].tolist() == [1.0, 0.0]
